"""Compiled kernels: Taylor propagation of rank-one feedback systems, small eigenvalue problems."""
