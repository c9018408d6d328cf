"""How kernels are compiled: one place for the options of Numba.

`error_model="numpy"` lets a division by zero give inf or nan as in NumPy instead of raising in
the middle of a step. `small` asks LLVM to inline: measured in docs/spikes/dispatch.md, without
it a step takes 1.6 times as long.
"""

from numba import njit

kernel = njit(cache=True, error_model="numpy")
small = njit(cache=True, error_model="numpy", forceinline=True)
