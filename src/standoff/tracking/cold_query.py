"""The distance at two poses by themselves, from nothing."""

from __future__ import annotations

from typing import Any, Protocol, TypeVar, overload, runtime_checkable

from standoff.bodies.body import Body
from standoff.checks.numbers import positive
from standoff.motion import PoseLike
from standoff.tracking.inputs import check_pair
from standoff.tracking.mended_calls import found_anywhere
from standoff.tracking.proximity import Proximity
from standoff.tracking.reached import cold_table

T_co = TypeVar("T_co", covariant=True)


@runtime_checkable
class AnswersItself(Protocol[T_co]):
    """What is no `Body`, and answers a cold query with another by itself: a solid, a compound."""

    def cold_query(
        self, a: Any, b: Any, pose_a: PoseLike, pose_b: PoseLike, within: float | None
    ) -> T_co:
        """The answer of A and B, one of which is this one; `within` is the horizon."""
        ...


@overload
def distance(
    a: Body, b: Body, pose_a: PoseLike, pose_b: PoseLike, *, within: float | None = None
) -> Proximity: ...


@overload
def distance(
    a: AnswersItself[T_co],
    b: Body | AnswersItself[T_co],
    pose_a: PoseLike,
    pose_b: PoseLike,
    *,
    within: float | None = None,
) -> T_co: ...


@overload
def distance(
    a: Body,
    b: AnswersItself[T_co],
    pose_a: PoseLike,
    pose_b: PoseLike,
    *,
    within: float | None = None,
) -> T_co: ...


def distance(
    a: Any, b: Any, pose_a: PoseLike, pose_b: PoseLike, *, within: float | None = None
) -> Any:
    """The signed minimum distance of two bodies at two poses: cold, global, certified.

    Raises TypeError: neither a body nor a solid nor a compound. Raises ValueError: no pose; a
    horizon that is not positive; a planar body with a spatial one or out of its plane; two
    half-spaces.

    Parameters
    ----------
    a, b : Body, Solid, PlanarSolid or Compound
        Two spatial ones, or two planar ones.
    pose_a, pose_b : Pose or what ``Pose.of`` reads
        World poses of the bodies' frames.
    within : float, optional
        Horizon, length: of bodies farther apart only that is proven, with the status FAR and a
        lower bound, which costs less.

    Returns
    -------
    Proximity, or SolidProximity where one of them is a solid or has one among its pieces
        Of compounds that of the nearest pieces, which ``pieces`` names; of two with convex pieces
        alone it is a `PairAnswer`, as in a world.
        In penetration ``distance`` is less than 0, the least depth, and ``status`` GLOBAL (or
        LOCAL, where it could not be proven to be the least).
    """
    horizon = None if within is None else positive(within, "within")
    try:
        table = cold_table(a, b, horizon)
    except TypeError:
        asked = [each for each in (a, b) if isinstance(each, AnswersItself)]
        if asked:
            # a compound asks its pieces, which know nothing of compounds
            first = max(asked, key=lambda each: hasattr(each, "pieces"))
            return first.cold_query(a, b, pose_a, pose_b, horizon)
        check_pair(a, b)  # what cannot be hashed is no body either
        raise
    return found_anywhere((a, b), table, (pose_a, pose_b, None, None))
