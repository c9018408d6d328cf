"""Planar bodies: closed loops of curves in z = 0."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from standoff.bodies.body import Body
from standoff.bodies.topology import Edge, parts_of
from standoff.checks.real_numbers import shown
from standoff.errors import BodyError, StandoffTypeError
from standoff.geometry.curves import Curve


def planar_loop(curves: Sequence[Curve], rounding: float = 0.0) -> Body:
    """A planar convex body: curves in z = 0, each beginning where the previous one ends.

    A single closed conic (an ellipse) is a loop too.

    Raises BodyError: fewer than two open curves, ends that do not meet, a loop that leaves z = 0 or
    is not convex. Raises TypeError: not a sequence, or something in it is not a `Curve`. Raises
    ValueError: a rounding that is negative or not finite.

    Parameters
    ----------
    curves : sequence of Curve
        Counterclockwise or clockwise, lengths. Ends may miss each other by 1e-9 of the size.
    rounding : float
        Radius of a disc swept over it, length, zero or above: the loop grows by this much on all
        sides, and its corners become round.

    Returns
    -------
    Body
        Planar: its partner must be planar too, or a point or segment in z = 0.
    """
    curves = parts_of(curves, "curves")
    for k, curve in enumerate(curves):
        if not isinstance(curve, Curve):
            raise StandoffTypeError(
                f"Curve {k} of a planar loop is {shown(curve)}: give a Curve.", "curves", curve
            )
    if len(curves) == 1 and curves[0].closed:
        edges = [Edge(curves[0])]
        return Body.from_brep(edges=edges, dimension=2, rounding=rounding, name="planar loop")
    if len(curves) < 2:
        raise BodyError(f"A planar loop of {len(curves)} open curves: give at least two.")
    vertices = np.array([c.point(c.first) for c in curves])
    n = len(curves)
    edges = [Edge(c, i, (i + 1) % n) for i, c in enumerate(curves)]
    return Body.from_brep(vertices, edges, dimension=2, rounding=rounding, name="planar loop")
