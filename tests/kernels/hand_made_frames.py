"""What a frame is given, made by hand: the state before it, its motion, its options."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from pointed import pointed

from standoff.kernels.frame.inputs import N_CHANGE, Inputs
from standoff.kernels.state.arrays import DEPTH_GLOBAL, N_OPTIONS, PREDICT_FEEDFORWARD
from standoff.kernels.state.options import Options
from standoff.kernels.state.state import Integrated, State, fresh_state
from standoff.kernels.values import NO_RATES, Motion, Place, Pose

Array = NDArray[np.float64]

TOLERANCE = 1e-10
NO_DEADLINE = 1 << 40
NOT_INTEGRATED = Integrated(NO_RATES, NO_RATES, 0.0)


def options(
    predictor: int = PREDICT_FEEDFORWARD,
    tolerance: float = TOLERANCE,
    depth: int = DEPTH_GLOBAL,
    deadline: int = NO_DEADLINE,
) -> Options:
    """Those of the predictor-corrector; the paper's law has the rest."""
    unused = 0
    return Options(
        False,
        False,
        predictor,
        unused,
        0.0,
        tolerance,
        *7 * (unused,),
        True,
        depth,
        deadline,
        0,
        0,
        pointed(np.zeros(N_OPTIONS)),
    )


def state_at(place: Place, **known: object) -> State:
    """A state of witness points, without a history unless one is given."""
    return fresh_state(place, NOT_INTEGRATED)._replace(**known)


def motion_of(
    pose: Pose, v: Sequence[float] = (0.0, 0.0, 0.0), w: Sequence[float] = (0.0, 0.0, 0.0)
) -> Motion:
    return Motion(pose, tuple(map(float, v)), tuple(map(float, w)))


def flat(R: Sequence[float], p: Sequence[float]) -> Array:
    """A pose as twelve numbers."""
    return np.array([*R, *p], dtype=float)


def inputs(
    pose_a: Array, pose_b: Array, twist_a: Sequence[float], twist_b: Sequence[float], told: bool
) -> Inputs:
    """In world axes, with or without twists; no law reads a change of the parameters."""
    twists, unused = (np.array(x, float) for x in (twist_a, twist_b)), np.full(N_CHANGE, np.nan)
    return Inputs(*map(pointed, (pose_a, pose_b, *twists, unused)), told)
