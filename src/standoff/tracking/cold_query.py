"""The distance at two poses by themselves, from nothing."""

from __future__ import annotations

from standoff.bodies.body import Body
from standoff.checks.numbers import positive
from standoff.motion import PoseLike
from standoff.tracking.inputs import check_pair
from standoff.tracking.mended_calls import found_anywhere
from standoff.tracking.proximity import Proximity
from standoff.tracking.reached import cold_table


def distance(
    a: Body, b: Body, pose_a: PoseLike, pose_b: PoseLike, *, within: float | None = None
) -> Proximity:
    """The signed minimum distance of two bodies at two poses: cold, global, certified.

    Parameters
    ----------
    a, b : Body
        Two spatial bodies, or two planar ones.
    pose_a, pose_b : Pose or what ``Pose.of`` reads
        World poses of the bodies' frames.
    within : float, optional
        Horizon, length: of bodies farther apart only that is proven, with the status FAR and a
        lower bound, which costs less.

    Returns
    -------
    Proximity
        In penetration ``distance`` is less than 0, the least depth, and ``status`` GLOBAL (or
        LOCAL, where it could not be proven to be the least).

    Raises
    ------
    TypeError
        Not a body.
    ValueError
        No pose; a horizon that is not positive; a planar body with a spatial one or out of its
        plane; two half-spaces.
    """
    horizon = None if within is None else positive(within, "within")
    try:
        table = cold_table(a, b, horizon)
    except TypeError:
        check_pair(a, b)  # what cannot be hashed is no body either
        raise
    return found_anywhere((a, b), table, (pose_a, pose_b, None, None))
