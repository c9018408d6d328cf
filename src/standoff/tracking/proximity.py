"""The answer of a query: witness points, normal, certified distance, and what it took."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.bodies.features import Feature as Feature
from standoff.bodies.features import feature_of as feature_of
from standoff.kernels import events as N
from standoff.kernels import frame as K
from standoff.kernels import layout as L
from standoff.read_only import KeepsReadOnly
from standoff.tracking.status import Status

if TYPE_CHECKING:
    from standoff.tracking.witness_set import WitnessSet

Array = NDArray[np.float64]


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
        Solves in which the Hessian had to be decomposed (with ``solve="plain"``: that had no
        solution, so that no step was made).
    saturations : int
        Components of a step that were zeroed at a boundary (``saturation="zero"``); of the
        paper's law also components of a PI feedback's integral that were cut, and frames whose
        integration overflowed and so changed nothing.
    searches : int
        Searches over all directions of depth in penetration.
    """

    evaluations: int
    corrections: int
    switches: int
    chart_changes: int
    restarts: int
    regularised: int
    saturations: int
    searches: int


class Event(NamedTuple):
    """A switch of one body's feature, dated to its frame.

    Attributes
    ----------
    time : float
        Time of the frame since the tracker's start, s.
    body : "A" or "B"
    source, target : Feature
    value : float
        Slope of the energy (length) for a release; 1 - s, the part of the step that did not fit,
        for a boundary reached; nan where a restart changed the feature.
    slope : float
        Slope of the distance along the direction of release; 0 for a boundary reached.
    """

    time: float
    body: str
    source: Feature
    target: Feature
    value: float
    slope: float


def charts_of(body: Body, face: int) -> tuple[int, int]:
    """(first packed chart, number of charts) of a face."""
    row = int(body.ints[L.FACES]) + L.FACE_STRIDE * face
    return int(body.ints[row]), int(body.ints[row + 1])


class Proximity(KeepsReadOnly):
    """Witness points of two bodies and their certified distance; all vectors in world axes.

    Attributes
    ----------
    distance : float
        Signed: between the witness points while apart, an upper bound of the true distance; less
        the depth in penetration: B moved by depth * normal touches A.
    lower_bound : float
        A certified lower bound of the true signed distance (docs/certificate.md).
    upper_bound : float
        An upper bound of it: the distance itself while apart, less than 0.999 of the depth where
        the status is GLOBAL.
    depth : float
        0 while apart, else how deep B is in A along the normal.
    point_a, point_b : (3,) arrays
        Witness points on A and B; in penetration the deepest ones: point_b - point_a is
        distance * normal in contact too.
    normal : (3,) array
        Unit vector from A to B; of all candidates the one with the greatest lower bound.
    feature_a, feature_b : Feature
        Active features of the cores.
    parameters_a, parameters_b : tuple of float
        (u, v) on a face, (u, v, chart) on a face with an atlas of charts, (t,) on an edge, ()
        on a vertex.
    rate : float
        Time derivative of the distance; nan where no twists were given.
    velocity_a, velocity_b : (3,) arrays
        Velocities of the witness points; nan where no twists were given.
    residual : float
        Length of the projections of the witness vector on the unit tangents (Psi in the metric
        of the tangents): zero at the optimum.
    status : Status
    counts : Counts
    events : tuple of Event
        The switches of this step.
    time : float
        Of the frame, s; 0 where no tracker asked.
    poses : pair of (12,) arrays
        World poses of A and B that the answer holds for: R row-major, p.
    """

    __slots__ = ("_a", "_b", "_out", "events", "poses", "time")

    def __init__(
        self,
        a: Body,
        b: Body,
        out: Array,
        events: tuple[Event, ...] = (),
        time: float = 0.0,
        poses: tuple[Array, Array] | None = None,
    ) -> None:
        out.flags.writeable = False
        self._a, self._b, self._out = a, b, out
        self.poses = poses
        self.events = events
        self.time = time

    @property
    def bodies(self) -> tuple[Body, Body]:
        """(A, B)."""
        return self._a, self._b

    @property
    def row(self) -> Array:
        """The answer as the kernels write it, read-only; laid out in ``kernels.frame``."""
        return self._out

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
    def feature_a(self) -> Feature:
        return feature_of(self._a, int(self._out[K.OUT_MODE]))

    @property
    def feature_b(self) -> Feature:
        return feature_of(self._b, int(self._out[K.OUT_MODE + 2]))

    @property
    def parameters_a(self) -> tuple[float, ...]:
        return self._parameters(self._a, 0)

    @property
    def parameters_b(self) -> tuple[float, ...]:
        return self._parameters(self._b, 2)

    def _parameters(self, body: Body, at: int) -> tuple[float, ...]:
        number, chart = (int(n) for n in self._out[K.OUT_MODE + at : K.OUT_MODE + at + 2])
        kind = feature_of(body, number).kind
        count = {"face": 2, "edge": 1, "vertex": 0}[kind]
        values = tuple(float(x) for x in self._out[K.OUT_Q + at : K.OUT_Q + at + count])
        if kind == "face":
            first, charts = charts_of(body, number)
            if charts > 1:
                return (*values, float(chart - first))
        return values

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
        """Is the signed distance proven: CONVERGED while apart, GLOBAL in penetration?"""
        return self.status in (Status.CONVERGED, Status.GLOBAL)

    @property
    def counts(self) -> Counts:
        o = self._out[K.OUT_COUNTS :]
        return Counts(
            int(o[N.EVALUATIONS]),
            int(o[N.CORRECTIONS]),
            int(o[N.EVENTS]),
            int(o[N.CHART_CHANGES]),
            int(o[N.RESTARTS]),
            int(o[N.REGULARISED]),
            int(o[N.SATURATIONS]),
            int(o[N.SEARCHES]),
        )

    def witness_set(self) -> WitnessSet:
        """All pairs of witness points that this answer could have named (docs/touching.md)."""
        from standoff.tracking.witness_set import witness_set  # it reads answers itself

        return witness_set(self)

    @property
    def unique(self) -> bool:
        """Are the witness points and the normal the only ones? Found anew at each call."""
        return self.witness_set().unique

    def __repr__(self) -> str:
        return (
            f"Proximity(distance={self.distance:.12g}, lower_bound={self.lower_bound:.12g}, "
            f"{self.feature_a} - {self.feature_b}, {self.status.name})"
        )
