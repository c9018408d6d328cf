"""Tolerances of tracking a point, each with its unit and reason."""

from __future__ import annotations

from typing import Final

import numpy as np

SHORTEST_CHORD: Final = 1e-8
"""Shortest chord to be halved, in sizes of the body: its arc is off it by roundoff alone."""

ON_BOUNDARY: Final = 16.0 * float(np.finfo(float).eps)
"""A point this near to the boundary, in sizes of the body, is on no side of it: roundoff."""

SETTLED_RESIDUAL: Final = 1e-3
"""Residual, in sizes of the body, below which the paper's law counts as having settled on a
minimum: far above its steady error, far below a start that is still on its way."""

SAME_PARAMETER: Final = 1e-6
"""Two minima of a curve whose parameters differ by less, in parts of its range, are one."""

RELEASE_SLOPES: Final = 4.0
"""A feature is released at so many times the least slope (a sine) that counts, with roundoff, at
most."""

TIE: Final = 4.0 * float(np.finfo(float).eps)
"""Two distances or depths that differ by less, in sizes of the body, are equal: the active one
stays."""

ENTRY_INSTANT: Final = 1e-9
"""Part of the tracker's frame in which the automaton outside switches, but hardly moves, when it is
entered."""

EQUAL_DEPTHS: Final = 1e-11
"""Part of the body's size by which two depths may differ at a switch: roundoff."""

SAME_NORMAL: Final = 1e-6
"""Two minima whose unit normals differ by less (chord) are one: the normal fixes the depth."""

DEPTH_ROUNDOFF: Final = 1e-12
"""Part of the body's size by which a depth may change beyond the point's way: roundoff."""

RAY_WITHIN: Final = 1e-6
"""How near to the boundary a ray is followed, in parts of the size and of the way: where a face is
met so near, no other is nearer but at an edge."""

PARAMETER_AT_REST: Final = 4.0 * float(np.finfo(float).eps)
"""Part of a curve's range that a parameter at rest may still move by: roundoff."""
