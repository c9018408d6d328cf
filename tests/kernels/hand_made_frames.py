"""What a frame is given, made by hand: the state before it, its motion, its options."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from pointed import pointed

from standoff.kernels.frame.inputs import N_CHANGE, Inputs
from standoff.kernels.state.arrays import (
    DEPTH_GLOBAL,
    LAW_PC,
    N_OPTIONS,
    O_DEADLINE,
    O_DEPTH,
    O_LAW,
    O_PREDICTOR,
    O_RESTARTS,
    O_TOLERANCE,
    PREDICT_FEEDFORWARD,
)
from standoff.kernels.state.options import Options, read_options
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
    restarts: bool = True,
) -> Options:
    """Those of the predictor-corrector; all else is 0."""
    numbers = np.zeros(N_OPTIONS)
    numbers[O_LAW], numbers[O_PREDICTOR] = LAW_PC, predictor
    numbers[O_TOLERANCE], numbers[O_DEPTH], numbers[O_DEADLINE] = tolerance, depth, deadline
    numbers[O_RESTARTS] = restarts
    # a pointer cannot be handed back to Python
    read = getattr(read_options, "py_func", read_options)
    return read(pointed(numbers))


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
    """In world axes, with or without twists."""
    twists = np.array(twist_a, float), np.array(twist_b, float)
    return Inputs(*map(pointed, (pose_a, pose_b, *twists, np.zeros(N_CHANGE))), told)
