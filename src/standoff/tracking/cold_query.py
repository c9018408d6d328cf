"""The distance at two poses by themselves, from nothing."""

from __future__ import annotations

import numpy as np

from standoff.bodies.body import Body
from standoff.kernels.compiler.entry import WrongKind
from standoff.kernels.entries.tracker import query_anywhere
from standoff.kernels.state import arrays as K
from standoff.motion import PoseLike
from standoff.tracking.inputs import check_pair, plain
from standoff.tracking.mended_calls import started
from standoff.tracking.proximity import Proximity
from standoff.tracking.reached import cold_table
from standoff.tracking.rows import StateRow


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
    check_pair(a, b)
    table = cold_table(a, b)
    given = pose_a, pose_b, None, None
    numbers, repaired = plain(*given)
    block = np.empty(K.N_BLOCK)
    try:
        done = query_anywhere(table.address, *numbers, block)
    except WrongKind:
        done = K.BAD_ARRAYS
    if done != K.FINE:
        made, repaired = started(table, given, StateRow().data, K.START_ANYWHERE)
        block = made.kept()
    return Proximity(a, b, block, repaired)
