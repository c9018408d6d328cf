"""The compiled loop over many frames without Python around it: what the others are measured by."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

import standoff as so
from standoff.kernels.entries.tracker import values
from standoff.kernels.pair.polytope_layout import N_POLYTOPE
from standoff.kernels.state import arrays as K
from standoff.tracking.calls import matrices
from standoff.tracking.inputs import ABSENT

Array = NDArray[np.float64]


def compiled_run(
    tracker: so.Tracker,
    begin: so.TrackerState,
    motions: Array,
    steps: Array,
    *,
    twists: bool = True,
) -> tuple[Callable[[], None], Array]:
    """What runs all frames from a state, and the answers (n, N_OUT) that it writes.

    Parameters
    ----------
    motions : (n, N_MOTION) array
        Poses and twists, a row a frame.
    steps : (n,) array
        Time since the frame before [s].
    twists : bool
        Are the twists given?
    """
    n = len(motions)
    blocks, polytopes = np.zeros((n + 1, K.N_BLOCK)), np.zeros((2, N_POLYTOPE))
    poses = [matrices(motions[:, o : o + 12]) for o in (K.POSE_A, K.POSE_B)]
    given = [np.ascontiguousarray(motions[:, o : o + 6]) for o in (K.TWIST_A, K.TWIST_B)]
    if not twists:
        given = [np.tile(ABSENT, (n, 1))] * 2
    first = begin.proximity._out[: K.N_BLOCK]

    def run() -> None:
        blocks[0] = first
        polytopes[:] = 0.0
        at, why = values(tracker.table.address, *poses, *given, steps, 0, (blocks, polytopes))
        if at < n:
            raise RuntimeError(f"frame {at} was refused: {why}")

    return run, blocks[1:, : K.N_OUT]
