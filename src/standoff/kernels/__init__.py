"""Compiled kernels: Numba over tuples and flat arrays, in the order of the paper.

``compiling`` has their decorators, ``modules`` says how they become machine code, ``cache`` where
that is kept.
"""
