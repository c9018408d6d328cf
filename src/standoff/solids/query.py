"""The distance of two solids, with all that may be asked of it."""

from __future__ import annotations

from typing import Any

from standoff.checks.numbers import positive, whole_number
from standoff.motion import PoseLike
from standoff.solids.answer import SolidProximity
from standoff.solids.planar.query import Asked, planar_distance
from standoff.solids.planar.solid import PlanarSolid


def distance(
    a: Any,
    b: Any,
    pose_a: PoseLike,
    pose_b: PoseLike,
    *,
    within: float | None = None,
    tolerance: float | None = None,
    minima: float | None = None,
    deadline: int | None = None,
) -> SolidProximity:
    """The proven distance of two solids at two poses: cold, global.

    Parameters
    ----------
    a, b : PlanarSolid or planar Body
    pose_a, pose_b : Pose or what ``Pose.of`` reads
        World poses of the solids' frames; planar ones turn about z and move in x and y.
    within : float, optional
        Horizon, length: of solids farther apart only that is proven, with the status FAR.
    tolerance : float, optional
        To what the distance is to be proven, length; 1e-10 of the larger size by default.
    minima : float, optional
        Keep all local minima of the distance below this one, length.
    deadline : int, optional
        Most evaluations of points and jets; 4 million by default.

    Returns
    -------
    SolidProximity

    Raises
    ------
    TypeError
        Neither a solid nor a body.
    ValueError
        No pose, one out of the plane, a number that is not positive.
    """
    asked = Asked(
        None if within is None else positive(within, "within"),
        None if tolerance is None else positive(tolerance, "tolerance"),
        None if minima is None else positive(minima, "minima"),
        None if deadline is None else whole_number(deadline, "deadline"),
    )
    return planar_distance(PlanarSolid.of(a, "a"), PlanarSolid.of(b, "b"), pose_a, pose_b, asked)
