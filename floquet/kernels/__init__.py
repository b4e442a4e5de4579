"""Compiled kernels. numba's cache looks at the file of each kernel, not at what it calls in other files.

After editing one of them delete ``floquet/kernels/__pycache__``, or its callers may keep the old code.
"""
