"""The distance at two poses by themselves, from nothing."""

from __future__ import annotations

from standoff.bodies.body import Body
from standoff.motion import PoseLike
from standoff.tracking.proximity import Proximity
from standoff.tracking.tracker import Tracker


class ColdQuery(Tracker):
    """A tracker that is asked for starts only: what frames need is neither found nor compiled."""

    def _reach(self) -> None:
        self.packed = self.a.ints, self.a.reals, self.b.ints, self.b.reals

    def _prepare(self) -> None:
        pass


def distance(a: Body, b: Body, pose_a: PoseLike, pose_b: PoseLike) -> Proximity:
    """The signed minimum distance of two bodies at two poses: cold, global, certified.

    Parameters
    ----------
    a, b : Body
        Two spatial bodies, or two planar ones.
    pose_a, pose_b : Pose or what ``Pose.of`` reads
        World poses of the bodies' frames.

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
        No pose; a planar body with a spatial one or out of its plane; two half-spaces.
    """
    return ColdQuery(a, b).start(pose_a, pose_b).proximity
