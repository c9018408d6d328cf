"""The answer of a query: witness points, normal, certified distance, and what it took."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from standoff.bodies.body import Body
from standoff.bodies.features import Feature as Feature
from standoff.bodies.features import feature_of
from standoff.bodies.plain_data import PlainData, plain, without_roundoff
from standoff.errors import StandoffError
from standoff.kernels.pair import events as N
from standoff.kernels.state import arrays as K
from standoff.tracking.rows import Answer
from standoff.tracking.rows import Counts as Counts
from standoff.typing import Array

if TYPE_CHECKING:
    from standoff.tracking.contact.patches import Patch
    from standoff.tracking.contact.witness_set import WitnessSet
    from standoff.tracking.derivatives import Derivatives


class Event(NamedTuple):
    """A switch of one body's feature, at the time of its frame.

    Attributes
    ----------
    time : float
        Time of the frame since the tracker's start, s.
    body : "A" or "B"
    source, target : Feature
    value : float
        Slope of the energy (length) for a release; 1 - s, the part of the step that did not fit,
        for a boundary that was reached; nan where a restart changed the feature.
    slope : float
        Slope of the distance along the direction of release; 0 for a boundary that was reached.
    """

    time: float
    body: str
    source: Feature
    target: Feature
    value: float
    slope: float


class Proximity(Answer, PlainData):
    """Witness points of two bodies and their certified distance; all vectors in world axes.

    Attributes
    ----------
    distance : float
        Signed: between the witness points while apart, an upper bound on the true distance; minus
        the depth in penetration: B moved by depth * normal touches A.
    lower_bound : float
        A certified lower bound of the true signed distance (docs/certificate.md).
    upper_bound : float
        An upper bound on it: the distance itself while apart, at most minus 0.999 of the depth if
        the status is GLOBAL.
    depth : float
        0 while apart, else how deep B is in A along the normal.
    point_a, point_b : (3,) arrays
        Witness points on A and B; in penetration the deepest ones: point_b - point_a is
        distance * normal in contact too.
    normal : (3,) array
        Unit vector from A to B; of all candidates the one with the greatest lower bound.
    feature_a, feature_b : Feature
        Active features of the cores; of an empty kind beyond the horizon.
    parameters_a, parameters_b : tuple of float
        (u, v) on a face, (u, v, chart) on a face with an atlas of charts, (t,) on an edge, ()
        on a vertex.
    place_a, place_b : (feature, parameters)
        Both of these, as ``Tracker.start_from`` takes them.
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
        Of the frame, s; 0 if there was no tracker.
    poses : pair of (12,) arrays
        World poses of A and B for which the answer holds: R row-major, p.
    repaired : int
        How many of these two were given with a rounded rotation, and were replaced by the nearest
        one, as `Pose.repaired` says of each.
    """

    __slots__ = ("repaired",)

    def __init__(self, a: Body, b: Body, out: Array, repaired: int = 0) -> None:
        out.setflags(write=False)
        self._a, self._b, self._out, self.repaired = a, b, out, repaired

    @property
    def time(self) -> float:
        block = self._out
        return float(block[K.BLOCK_STATE + K.TIME]) if len(block) >= K.BLOCK_EVENTS else 0.0

    @property
    def events(self) -> tuple[Event, ...]:
        block = self._out
        count = int(block[K.OUT_COUNTS + N.EVENTS])
        if not count or len(block) < K.BLOCK_EVENTS:
            return ()
        first = K.BLOCK_EVENTS
        return events_of(
            self._a, self._b, block[first : first + N.EVENT_COLUMNS * count], self.time
        )

    def _refuse_far(self) -> None:
        if self.far:
            raise StandoffError(
                "The bodies are beyond the horizon: only a lower bound of their distance is known; "
                "raise `within`."
            )

    def witness_set(self) -> WitnessSet:
        """All pairs of witness points that this answer could have given (docs/touching.md)."""
        self._refuse_far()
        from standoff.tracking.contact.witness_set import witness_set

        return witness_set(self)

    def patch(self, gap: float, after: Patch | None = None) -> Patch:
        """Up to four pairs of points that span where the bodies are hardly farther apart
        (docs/touching.md). Computed at each call.

        Raises TypeError: ``after`` is not a patch. Raises ValueError: ``gap`` is not positive; an
        answer that is FAR, or without a distance or poses.

        Parameters
        ----------
        gap : float
            By how much the gap along the normal may be wider than the distance, length.
        after : Patch, optional
            That of the frame before: its corners are gone on with, wherever they are still some.
        """
        self._refuse_far()
        from standoff.tracking.contact.patches import patch_of

        return patch_of(self, gap, after)

    @property
    def unique(self) -> bool:
        """Are the witness points and the normal the only ones? Computed at each call."""
        return self.witness_set().unique

    def derivatives(self) -> Derivatives:
        """All derivatives by the poses, with a flag where they are one-sided or undefined
        (docs/derivatives.md). Computed at each call."""
        from standoff.tracking.derivatives import derivatives

        return derivatives(self)

    @property
    def gradient(self) -> Array:
        """(12,) of the distance by unit twists (v_A, omega_A, v_B, omega_B), world axes.

        This and the next three raise StandoffError where they are undefined. In flat and line
        contact this has nan for turns without a derivative, and the next three raise it.
        """
        from standoff.tracking.derivatives import gradient

        return gradient(self)

    @property
    def hessian(self) -> Array:
        """(12, 12) of the distance, in the chart R <- exp(omega) R, p <- p + v."""
        return self._defined().hessian

    @property
    def normal_jacobian(self) -> Array:
        """(3, 12) of the normal."""
        return self._defined().normal_jacobian

    @property
    def point_jacobians(self) -> tuple[Array, Array]:
        """Two (3, 12), of the witness points on A and on B."""
        return self._defined().point_jacobians

    def _defined(self) -> Derivatives:
        from standoff.tracking.derivatives import defined

        return defined(self.derivatives())

    def as_dict(self) -> dict[str, Any]:
        """Return the answer as plain data: numbers, strings, lists and dictionaries of these.

        The keys are the attributes' names; ``poses`` are two 4×4 matrices, or None. Features are
        strings such as ``"face 2"``, the status is its name. The numbers are the same to the last
        bit, except that no zero has a sign; NaN stays NaN. Of an answer that is FAR, features are
        empty strings.
        """
        facts = {name: plain(getattr(self, name)) for name in _PLAIN}
        poses = self.poses
        return facts | {"poses": None if poses is None else [_matrix(pose) for pose in poses]}

    def __repr__(self) -> str:
        if self.far:
            return f"Proximity(FAR: at least {self.lower_bound:.12g} apart)"
        shown = [self.distance, self.distance - self.lower_bound]
        distance, gap = without_roundoff(shown, shown_size(self))
        return (
            f"Proximity(distance={distance:.12g}, gap={gap:.2g}, "
            f"{self.feature_a} - {self.feature_b}, {self.status.name})"
        )


_PLAIN = (
    *("distance", "lower_bound", "upper_bound", "depth", "point_a", "point_b", "normal"),
    *("feature_a", "feature_b", "parameters_a", "parameters_b", "rate", "velocity_a"),
    *("velocity_b", "residual", "status", "certified", "counts", "events", "time", "repaired"),
)
"""Attributes that an answer's plain data has under their own names."""


def shown_size(answer: Any, bodies: Any = None) -> float:
    """Length compared with which numbers of an answer are roundoff: of a body, or of a far
    point. `bodies` are those of an answer that does not have them."""
    given = bodies or getattr(answer, "bodies", ())
    sizes = [body.size for body in given if body.bounded]
    return float(np.nanmax([*sizes, *np.abs(answer.point_a), *np.abs(answer.point_b), 0.0]))


def _matrix(pose: Array) -> list[list[float]]:
    """A flat pose (12,), R by rows and p, as the rows of a 4×4 matrix."""
    top = np.column_stack([pose[:9].reshape(3, 3), pose[9:]])
    rows: list[list[float]] = plain(np.vstack([top, [0.0, 0.0, 0.0, 1.0]]))
    return rows


def events_of(a: Body, b: Body, log: Array, time: float) -> tuple[Event, ...]:
    """The switches that a frame's log holds, (n * EVENT_COLUMNS,), at its time [s]."""
    events = []
    for row in log.reshape(-1, N.EVENT_COLUMNS):
        body = a if row[N.BODY] == 0 else b
        source, target = (feature_of(body, int(row[k])) for k in (N.SOURCE, N.TARGET))
        name = "AB"[int(row[N.BODY])]
        value, slope = float(row[N.VALUE]), float(row[N.SLOPE_COLUMN])
        events.append(Event(time, name, source, target, value, slope))
    return tuple(events)
