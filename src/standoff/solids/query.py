"""The distance of two solids, with all that may be asked of it."""

from __future__ import annotations

from typing import Any

from standoff.checks.numbers import positive, whole_number
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError
from standoff.motion import PoseLike
from standoff.solids.answer import SolidProximity
from standoff.solids.asked import DEADLINE, PATCH_ALONE, QueryOptions
from standoff.solids.planar.query import planar_distance
from standoff.solids.planar.solid import PlanarSolid
from standoff.solids.spatial.distance import spatial_distance


def distance(  # noqa: PLR0913 - all but four are keywords with defaults
    a: Any,
    b: Any,
    pose_a: PoseLike,
    pose_b: PoseLike,
    *,
    within: float | None = None,
    tolerance: float | None = None,
    minima: float | None = None,
    deadline: int = DEADLINE,
    patch: float | None = None,
) -> SolidProximity:
    """The proven distance of two solids at two poses: cold, global.

    Raises TypeError: neither a solid nor a body. Raises ValueError: no pose, one out of the plane,
    a number that is not positive, or `patch` alone.

    Parameters
    ----------
    a, b : Solid, PlanarSolid, Boundary or Body
        Two spatial ones, or two planar ones.
    pose_a, pose_b : Pose or what ``Pose.of`` reads
        World poses of the solids' frames; planar ones turn about z and move in x and y.
    within : float, optional
        Horizon, length: of solids farther apart only that is proven, with the status FAR.
    tolerance : float, optional
        To what the distance is to be proven, length. By default 1e-10 of the larger size in the
        plane, of both sizes together in space; less than some roundings is raised to these.
    minima : float, optional
        Keep all local minima of the distance below this one that are found, length. Each is one to
        first order, and its `lower_bound` is that of the pieces of boundary around it.
    deadline : int, optional
        Most evaluations of points and of bounds, as ``counts.evaluations`` tells them: points of
        the boundaries, pairs of boxes, and boxes of potentials, each counted once. What is then
        open stays an interval, with the status DEADLINE.
    patch : float, optional
        Of each of `minima`, in space: up to four pairs of points that span the region around it in
        which the boundaries are farther apart by no more than this, length.

    Returns
    -------
    SolidProximity
    """
    asked = QueryOptions(
        None if within is None else positive(within, "within"),
        None if tolerance is None else positive(tolerance, "tolerance"),
        None if minima is None else positive(minima, "minima"),
        whole_number(deadline, "deadline"),
        None if patch is None else positive(patch, "patch"),
    )
    if asked.patch is not None and (asked.minima is None or _planar(a) or _planar(b)):
        raise StandoffError(PATCH_ALONE.format(patch=shown(patch)), "patch", patch)
    if not (_planar(a) or _planar(b)):
        return spatial_distance(a, b, pose_a, pose_b, asked)
    return planar_distance(PlanarSolid.of(a, "a"), PlanarSolid.of(b, "b"), pose_a, pose_b, asked)


def _planar(given: Any) -> bool:
    return isinstance(given, PlanarSolid) or getattr(given, "dimension", 3) == 2
