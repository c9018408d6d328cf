"""The numbers of a frame's motion, of a tracker's state and of its answers by name.

The kernels read and write them as flat arrays, whose slots ``standoff.kernels.state.arrays``
numbers. The layers above the kernels read most of them by the names given here. The state is in A's
frame, the answers are in world axes.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.bodies.features import Feature, charts_of, feature_of
from standoff.kernels.pair import events as N
from standoff.kernels.state import arrays as K
from standoff.read_only import KeepsReadOnly
from standoff.tracking.block import FrameBlock
from standoff.tracking.status import Status
from standoff.typing import Array

NO_TWIST = np.zeros(6)
NO_TWIST.flags.writeable = False


def motion_row(
    pose_a: Array, pose_b: Array, twist_a: Array = NO_TWIST, twist_b: Array = NO_TWIST
) -> Array:
    """One frame's flat poses (12,) and twists (6,) as the kernels read them."""
    row = np.empty(K.N_MOTION)
    row[K.POSE_A : K.POSE_B], row[K.POSE_B : K.TWIST_A] = pose_a, pose_b
    row[K.TWIST_A : K.TWIST_B], row[K.TWIST_B :] = twist_a, twist_b
    return row


def poses_of(motion: Array) -> tuple[Array, Array]:
    """The flat poses (..., 12) of A and of B in a row or rows of motions: views."""
    return motion[..., K.POSE_A : K.POSE_B], motion[..., K.POSE_B : K.TWIST_A]


def twists_of(motion: Array) -> tuple[Array, Array]:
    """The flat twists (..., 6) of A and of B in a row or rows of motions: views."""
    return motion[..., K.TWIST_A : K.TWIST_B], motion[..., K.TWIST_B :]


class Counts(NamedTuple):
    """What an answer took.

    Attributes
    ----------
    evaluations : int
        Second-order evaluations of the pair system (one a frame while tracking).
    corrections : int
        Feedback steps applied.
    switches : int
        Changes of feature between the last frame and this one.
    chart_changes : int
        Changes between charts of one face.
    restarts : int
        Global starts after the first.
    regularised : int
        Solves in which the Hessian had to be decomposed (with ``solve="plain"``: those without a
        solution, in which no step was made).
    saturations : int
        Components of a step that were zeroed at a boundary (``saturation="zero"``); with the
        paper's law also components of a PI feedback's integral that were limited, stages whose
        `MotionGain` was cut by its `most`, and frames whose integration overflowed.
    searches : int
        Searches over all directions of depth in penetration that began from scratch. None where the
        polytope of the frame before proved the depth.
    foot_points : int
        Points of edges closest to the opposing witness point that Voronoi tests have looked for.
    solved_parameters : int
        Parameters that a switch has taken from such a search: none with ``reset="nearest"``, as
        the paper prints it.
    general_frames : int
        1 where the frame that is compiled for this pair's kinds of faces was tried and left the
        answer to the general one: at a boundary, in contact, on a curved edge or a vertex.
    """

    evaluations: int
    corrections: int
    switches: int
    chart_changes: int
    restarts: int
    regularised: int
    saturations: int
    searches: int
    foot_points: int
    solved_parameters: int
    general_frames: int = 0


# Where the fields of Counts stand in the kernels' own counts.
COUNT_SLOTS = [
    K.OUT_COUNTS + k
    for k in (
        N.EVALUATIONS,
        N.CORRECTIONS,
        N.EVENTS,
        N.CHART_CHANGES,
        N.RESTARTS,
        N.REGULARISED,
        N.SATURATIONS,
        N.SEARCHES,
        N.FOOT_POINTS,
        N.SOLVED_PARAMETERS,
        N.GENERAL_FRAMES,
    )
]


class Slot:
    """Some numbers of the last axis of ``data``: one, or `count` of them in a row."""

    def __init__(self, first: int, count: int | None = None) -> None:
        self.at: Any = (..., first if count is None else slice(first, first + count))

    def __get__(self, row: Any, owner: type | None = None) -> Any:
        return row.data[self.at]

    def __set__(self, row: Any, value: Any) -> None:
        row.data[self.at] = value


class StateRow:
    """A tracker's state, (56,), by name; what is assigned is written into ``data``.

    Attributes
    ----------
    mode : (4,) array
        Number of A's feature, its chart, number of B's feature, its chart.
    q : (4,) array
        u, v of A, r, s of B.
    time : float
        Since the start, s.
    lost : 0 or 1
        Had the last frame no certified witness points? Then the next one starts globally.
    inside : 0 or 1
        Was it solved in contact? Then the next one begins there.
    errors, integral : (4,) arrays
        Psi as the paper's law integrates it, and its time integral.
    gain : float
        K of the last stage, 1/s.
    last_normal : (3,) array
        Unit, from A to B.
    """

    __slots__ = ("data",)

    size = K.N_STATE
    mode = Slot(K.MODE, 4)
    q = Slot(K.Q, 4)
    time = Slot(K.TIME)
    lost = Slot(K.LOST)
    errors = Slot(K.ERRORS, 4)
    integral = Slot(K.INTEGRAL, 4)
    gain = Slot(K.GAIN)
    last_normal = Slot(K.LAST_NORMAL, 3)
    inside = Slot(K.INSIDE)

    def __init__(self, data: Array | None = None) -> None:
        self.data = np.zeros(K.N_STATE) if data is None else data

    def place(self, side: int, feature: int, chart: int, parameters: Array) -> None:
        """Put a witness point, of A (0) or B (1), on a feature by its number."""
        at = 2 * side
        self.mode[at : at + 2] = feature, chart
        self.q[at : at + len(parameters)] = parameters


class AnswerRows:
    """Answers as the kernels write them, (..., N_OUT), by name; `data` may be one row or many.

    Attributes
    ----------
    distance, lower_bound, upper_bound, rate, residual, status : (...) arrays
        As in `Proximity`; the status by its number.
    point_a, point_b, normal, velocity_a, velocity_b : (..., 3) arrays
    mode : (..., 4) array
        Number of A's feature, its chart, number of B's feature, its chart.
    q : (..., 4) array
        u, v of A, r, s of B.
    """

    __slots__ = ("data",)

    size = K.N_OUT
    distance = Slot(K.DISTANCE)
    lower_bound = Slot(K.LOWER_BOUND)
    upper_bound = Slot(K.UPPER_BOUND)
    point_a = Slot(K.POINT_A, 3)
    point_b = Slot(K.POINT_B, 3)
    normal = Slot(K.NORMAL, 3)
    mode = Slot(K.OUT_MODE, 4)
    q = Slot(K.OUT_Q, 4)
    rate = Slot(K.OUT_RATE)
    velocity_a = Slot(K.VELOCITY_A, 3)
    velocity_b = Slot(K.VELOCITY_B, 3)
    residual = Slot(K.RESIDUAL)
    status = Slot(K.STATUS)
    switches = Slot(K.OUT_COUNTS + N.EVENTS)

    def __init__(self, data: Array) -> None:
        self.data = data

    @classmethod
    def empty(cls, *shape: int) -> AnswerRows:
        """Rows for the kernels to write: one, or as many as a shape says."""
        return cls(np.empty((*shape, K.N_OUT)))

    @property
    def counts(self) -> NDArray[np.int64]:
        """(..., 11) in the order of `Counts`."""
        return np.asarray(self.data[..., COUNT_SLOTS], dtype=np.int64)

    def parameters(self, body: Body, side: int) -> tuple[float, ...]:
        """One row's parameters of A (0) or B (1), as in `Proximity`."""
        at = 2 * side
        number, chart = (int(n) for n in self.mode[at : at + 2])
        kind = feature_of(body, number).kind
        count = {"face": 2, "edge": 1}.get(kind, 0)
        values = tuple(float(x) for x in self.q[at : at + count])
        if kind == "face":
            first, charts = charts_of(body, number)
            if charts > 1:
                return (*values, float(chart - first))
        return values


class Answer(KeepsReadOnly):
    """What the kernels answered of two bodies at two poses; `Proximity` describes the fields."""

    __slots__ = ("_a", "_b", "_out")

    def __init__(self, a: Body, b: Body, out: Array) -> None:
        # the answer's row, or a block, which begins with it; fields are read when asked for
        out.setflags(write=False)
        self._a, self._b, self._out = a, b, out

    @property
    def bodies(self) -> tuple[Body, Body]:
        """(A, B)."""
        return self._a, self._b

    @property
    def row(self) -> Array:
        """The answer as the kernels write it, read-only; laid out in ``kernels.state.arrays``."""
        return self._out[: K.N_OUT]

    @property
    def poses(self) -> tuple[Array, Array] | None:
        """World poses (12,) that it holds for; None for an answer that was made by hand."""
        if (
            len(self._out) < K.BLOCK_EVENTS
            or self._out[K.BLOCK_MOTION + K.POSE_A] != self._out[K.BLOCK_MOTION + K.POSE_A]
        ):
            return None
        return poses_of(FrameBlock(self._out).motion)

    @property
    def distance(self) -> float:
        return float(self._out[K.DISTANCE])

    @property
    def lower_bound(self) -> float:
        return float(self._out[K.LOWER_BOUND])

    @property
    def upper_bound(self) -> float:
        return float(self._out[K.UPPER_BOUND])

    @property
    def depth(self) -> float:
        return max(0.0, -self.distance)

    @property
    def point_a(self) -> Array:
        return self._out[K.POINT_A : K.POINT_A + 3]

    @property
    def point_b(self) -> Array:
        return self._out[K.POINT_B : K.POINT_B + 3]

    @property
    def normal(self) -> Array:
        return self._out[K.NORMAL : K.NORMAL + 3]

    @property
    def far(self) -> bool:
        """Is only a lower bound known, because the bodies are beyond the horizon?"""
        return bool(self._out[K.STATUS] == K.FAR)

    @property
    def feature_a(self) -> Feature:
        return feature_of(self._a, int(self._out[K.OUT_MODE]))

    @property
    def feature_b(self) -> Feature:
        return feature_of(self._b, int(self._out[K.OUT_MODE + 2]))

    @property
    def parameters_a(self) -> tuple[float, ...]:
        return AnswerRows(self._out).parameters(self._a, 0)

    @property
    def parameters_b(self) -> tuple[float, ...]:
        return AnswerRows(self._out).parameters(self._b, 1)

    @property
    def place_a(self) -> tuple[Feature, tuple[float, ...]]:
        return self.feature_a, self.parameters_a

    @property
    def place_b(self) -> tuple[Feature, tuple[float, ...]]:
        return self.feature_b, self.parameters_b

    @property
    def rate(self) -> float:
        return float(self._out[K.OUT_RATE])

    @property
    def velocity_a(self) -> Array:
        return self._out[K.VELOCITY_A : K.VELOCITY_A + 3]

    @property
    def velocity_b(self) -> Array:
        return self._out[K.VELOCITY_B : K.VELOCITY_B + 3]

    @property
    def residual(self) -> float:
        return float(self._out[K.RESIDUAL])

    @property
    def status(self) -> Status:
        return Status(int(self._out[K.STATUS]))

    @property
    def certified(self) -> bool:
        """Is what was asked proven: the signed distance, or that the bodies are FAR?"""
        return self.status.certified

    @property
    def counts(self) -> Counts:
        return Counts(*AnswerRows(self._out).counts.tolist())
