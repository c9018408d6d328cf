"""Compiled kernels: Numba over tuples and flat arrays, in the order of the paper.

From below: ``compiler`` makes machine code; ``values`` and ``tolerances`` are common to all
kernels; ``algebra``, ``body`` and ``pair`` evaluate; ``depth`` is for bodies that overlap;
``state``, ``frame`` and ``paper`` make one frame of each law; ``entries`` is what Python calls.
"""
