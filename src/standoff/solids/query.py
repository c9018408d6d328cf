"""The distance of two solids, with all that may be asked of it."""

from __future__ import annotations

from typing import Any

from standoff.checks.numbers import positive, whole_number
from standoff.errors import StandoffError
from standoff.motion import PoseLike
from standoff.solids.answer import SolidProximity
from standoff.solids.planar.query import Asked, planar_distance
from standoff.solids.planar.solid import PlanarSolid
from standoff.solids.spatial.distance import spatial_distance
from standoff.solids.spatial.minimum import BUDGET


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
    a, b : Solid, PlanarSolid, Boundary or Body
        Two spatial ones, or two planar ones.
    pose_a, pose_b : Pose or what ``Pose.of`` reads
        World poses of the solids' frames; planar ones turn about z and move in x and y.
    within : float, optional
        Horizon, length: of solids farther apart only that is proven, with the status FAR.
    tolerance : float, optional
        Of planar solids: to what the distance is to be proven, length; 1e-10 of the larger size
        by default. In space it is 1e-10 of both sizes together.
    minima : float, optional
        Of planar solids: keep all local minima of the distance below this one, length. In space
        all pairs at the least distance are kept.
    deadline : int, optional
        Most evaluations of points and jets; 4 million by default. In space, most boxes that
        potentials are bounded over; 400,000 by default.

    Returns
    -------
    SolidProximity

    Raises
    ------
    TypeError
        Neither a solid nor a body.
    ValueError
        No pose, one out of the plane, a number that is not positive; a tolerance or minima of
        solids in space.
    """
    asked = Asked(
        None if within is None else positive(within, "within"),
        None if tolerance is None else positive(tolerance, "tolerance"),
        None if minima is None else positive(minima, "minima"),
        None if deadline is None else whole_number(deadline, "deadline"),
    )
    if not (_planar(a) or _planar(b)):
        if asked.tolerance is not None or asked.minima is not None:
            raise StandoffError(
                "tolerance and minima are options of planar solids: leave them out in space."
            )
        budget = BUDGET if asked.deadline is None else asked.deadline
        return spatial_distance(a, b, pose_a, pose_b, evaluations=budget, within=asked.within)
    return planar_distance(PlanarSolid.of(a, "a"), PlanarSolid.of(b, "b"), pose_a, pose_b, asked)


def _planar(given: Any) -> bool:
    return isinstance(given, PlanarSolid) or getattr(given, "dimension", 3) == 2
