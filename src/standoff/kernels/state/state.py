"""The tracker's state as kernels read it, by name: the only place that indexes its array."""

from __future__ import annotations

from typing import NamedTuple

from standoff.kernels.algebra.rigid import read_rotation, read_vector
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.state import arrays as F
from standoff.kernels.values import NO_RATES, Motion, Place, Pose, Vector

Four = tuple[float, float, float, float]


class Integrated(NamedTuple):
    """What the paper's law integrates beside the parameters."""

    errors: Four  # projection errors, length² per parameter (Fig. 3)
    integral: Four  # their time integral (PI feedback)
    gain: float  # K of the last stage, 1/s


class State(NamedTuple):
    """What a frame keeps for the next one, in A's frame."""

    place: Place
    rates: Four  # of the parameters, 1/s: this frame's feedforward or secant
    last_rates: Four  # those of the frame before
    last_step: float  # s
    history: int  # how many of the two rates are valid
    motion: Motion
    fed: bool  # are the rates a feedforward? else a secant
    time: float  # s
    lost: bool  # no certified witness points: start globally
    integrated: Integrated
    normal: Vector
    distance: float  # of the cores, signed
    inside: bool  # solved in contact: the next frame begins there
    lower: float  # lower bound of that distance
    cut: int  # how many frames in a row ran out of evaluations, this one included


@kernel
def moved_to(state, place, integrated):
    """The state with other witness points."""
    return State(
        place,
        state.rates,
        state.last_rates,
        state.last_step,
        state.history,
        state.motion,
        state.fed,
        state.time,
        state.lost,
        integrated,
        state.normal,
        state.distance,
        state.inside,
        state.lower,
        state.cut,
    )


@kernel
def read_four(numbers, o):
    return (numbers[o], numbers[o + 1], numbers[o + 2], numbers[o + 3])


@kernel
def read_place(state):
    return Place(
        int(state[F.MODE]),
        int(state[F.MODE + 1]),
        int(state[F.MODE + 2]),
        int(state[F.MODE + 3]),
        state[F.Q],
        state[F.Q + 1],
        state[F.Q + 2],
        state[F.Q + 3],
    )


@kernel
def read_state(state):
    pose = Pose(read_rotation(state, F.POSE), read_vector(state, F.POSE + 9))
    return State(
        read_place(state),
        read_four(state, F.RATE),
        read_four(state, F.LAST_RATE),
        state[F.LAST_STEP],
        int(state[F.HISTORY]),
        Motion(pose, read_vector(state, F.TWIST), read_vector(state, F.TWIST + 3)),
        state[F.HAS_TWIST] != 0.0,
        state[F.TIME],
        state[F.LOST] != 0.0,
        Integrated(read_four(state, F.ERRORS), read_four(state, F.INTEGRAL), state[F.GAIN]),
        read_vector(state, F.LAST_NORMAL),
        state[F.LAST_DISTANCE],
        state[F.INSIDE] != 0.0,
        state[F.LAST_BOUND],
        int(state[F.CUT]),
    )


@kernel
def fresh_state(place, integrated):
    """Of no frame yet."""
    still = Motion(
        Pose((1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0)),
        (0.0, 0.0, 0.0),
        (0.0, 0.0, 0.0),
    )
    return State(
        place,
        NO_RATES,
        NO_RATES,
        0.0,
        0,
        still,
        False,
        0.0,
        False,
        integrated,
        (0.0, 0.0, 0.0),
        0.0,
        False,
        0.0,
        0,
    )


@kernel
def write_numbers(values, to, o):
    for k in range(len(values)):
        to[o + k] = values[k]


@kernel
def flag(value):
    return 1.0 if value else 0.0


@kernel
def write_state(new, state):
    place, motion = new.place, new.motion
    state[F.MODE], state[F.MODE + 1] = place.feature_a, place.chart_a
    state[F.MODE + 2], state[F.MODE + 3] = place.feature_b, place.chart_b
    write_numbers((place.u, place.v, place.r, place.s), state, F.Q)
    write_numbers(new.rates, state, F.RATE)
    write_numbers(new.last_rates, state, F.LAST_RATE)
    state[F.LAST_STEP] = new.last_step
    state[F.HISTORY] = new.history
    write_numbers(motion.pose.R, state, F.POSE)
    write_numbers(motion.pose.p, state, F.POSE + 9)
    write_numbers(motion.v, state, F.TWIST)
    write_numbers(motion.w, state, F.TWIST + 3)
    state[F.HAS_TWIST] = flag(new.fed)
    state[F.TIME] = new.time
    state[F.LOST] = flag(new.lost)
    write_numbers(new.integrated.errors, state, F.ERRORS)
    write_numbers(new.integrated.integral, state, F.INTEGRAL)
    state[F.GAIN] = new.integrated.gain
    write_numbers(new.normal, state, F.LAST_NORMAL)
    state[F.LAST_DISTANCE] = new.distance
    state[F.INSIDE] = flag(new.inside)
    state[F.LAST_BOUND] = new.lower
    state[F.CUT] = new.cut
