"""Compiled kernels of the general engine."""
