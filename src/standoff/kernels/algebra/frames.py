"""A frame across a direction."""

from typing import Any, NamedTuple

from standoff.kernels.algebra.vectors import cross, unit
from standoff.kernels.compiler.decorators import kernel


class Frame(NamedTuple):
    """Axes across the normal, and the normal."""

    e: Any
    f: Any
    n: Any


@kernel
def frame_across(n):
    small = (1.0, 0.0, 0.0)
    if abs(n[1]) <= abs(n[0]) and abs(n[1]) <= abs(n[2]):
        small = (0.0, 1.0, 0.0)
    elif abs(n[2]) <= abs(n[0]) and abs(n[2]) <= abs(n[1]):
        small = (0.0, 0.0, 1.0)
    e = unit(cross(small, n))
    return Frame(e, cross(n, e), n)
