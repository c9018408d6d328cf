"""The switching function of one switch, smooth in time on both sides of its instant.

A switch goes between a feature and one of its boundary: a face and its edge, an edge and its end.
The distance is minimised with the lower of the two *held*; the slope of that minimum along the
direction that leads into the higher one is the switching function of Eqs. (15)-(17). It is
negative where the higher feature is the active one, and crosses zero at the instant of the switch.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from standoff.bodies.body import Body
from standoff.kernels.body import layout as L
from standoff.kernels.entries.queries import coedge_conormal, edge_jet, end_direction, feature_jet
from standoff.recording.tolerances import FLAT_DIRECTION, HELD_AT_REST
from standoff.tracking.rows import AnswerRows
from standoff.typing import Array

HELD_STEPS = 20
"""Most steps of the held minimum: from a neighbouring frame 2 to 4 are taken."""


class NoMinimum(ArithmeticError):
    """The held minimum was not found."""


@dataclass
class SwitchingFunction:
    """See the module; made by `switching_function`.

    Attributes
    ----------
    pair : (Body, Body)
    switching : 0 where A switches, 1 where B does.
    mode : [feature_a, chart_a, feature_b, chart_b] with the lower feature held, packed numbers.
    q : (4,) parameters of a held minimum near by. Every search begins there, so that equal poses
        give equal values.
    into : the unit direction into the higher feature, body frame, at a parameter of the lower.
    """

    pair: tuple[Body, Body]
    switching: int
    mode: list[int]
    q: Array
    into: Callable[[float], Array]

    def __call__(self, pose_a: Array, pose_b: Array) -> float:
        """Return its value at two flat poses, (12,) each.

        Raises NoMinimum if the distance has no minimum near the last one with the lower feature
        held.
        """
        poses = pose_a, pose_b
        across, q = self._minimise(poses)
        length = float(np.linalg.norm(across))
        if not length > 0.0:
            raise NoMinimum("the bodies touch")
        towards = (1.0 - 2.0 * self.switching) * across / length
        turn = poses[self.switching][:9].reshape(3, 3)
        return float(-(turn.T @ towards) @ self.into(float(q[2 * self.switching])))

    def _minimise(self, poses: tuple[Array, Array]) -> tuple[Array, Array]:
        """(x_B - x_A, q) of the held minimum, the vector in world axes."""
        free = [
            2 * s + k
            for s, body in enumerate(self.pair)
            for k in range(L.dimension(body.ints, self.mode[2 * s]))
        ]
        q = self.q.copy()
        for _ in range(HELD_STEPS):
            across, gradient, hessian, tangents = self._derivatives(poses, q)
            step = np.zeros(4)
            if free:
                held = np.ix_(free, free)
                found = np.linalg.lstsq(hessian[held], gradient[free], rcond=FLAT_DIRECTION)
                step[free] = -found[0]
            q += step
            moved = float(np.abs(tangents * step[:, None]).max())
            scale = sum(x.size for x in self.pair if x.bounded) + float(np.linalg.norm(across))
            if not np.isfinite(moved):
                break
            if moved <= HELD_AT_REST * scale:
                return across, q
        raise NoMinimum("Newton's method did not come to rest")

    def _derivatives(
        self, poses: tuple[Array, Array], q: Array
    ) -> tuple[Array, Array, Array, Array]:
        """(x_B - x_A, gradient, Hessian, tangents) of E = |x_A - x_B|²/2, all in world."""
        points, columns, seconds = [], [], []
        # Positions count from A's origin, so that nothing is lost far from the world's.
        shifts = np.zeros(3), poses[1][9:] - poses[0][9:]
        for s, (body, flat, shift) in enumerate(zip(self.pair, poses, shifts, strict=True)):
            feature, chart = self.mode[2 * s : 2 * s + 2]
            jet = feature_jet(body.ints, body.reals, feature, chart, q[2 * s], q[2 * s + 1])
            x, xu, xv, xuu, xuv, xvv = np.array(jet) @ flat[:9].reshape(3, 3).T
            points.append(x + shift)
            columns += [xu, xv]
            seconds.append(np.array([[xuu, xuv], [xuv, xvv]]))
        apart = points[0] - points[1]
        tangents = np.array(columns)
        signed = np.array([1.0, 1.0, -1.0, -1.0])[:, None] * tangents
        hessian = signed @ signed.T
        hessian[:2, :2] += seconds[0] @ apart
        hessian[2:, 2:] -= seconds[1] @ apart
        return -apart, signed @ apart, hessian, tangents


def switching_function(
    pair: tuple[Body, Body], switching: int, lower: Array, higher: Array
) -> SwitchingFunction | None:
    """Return the function of a switch between two answers, one on each side of it.

    Parameters
    ----------
    pair : (Body, Body)
    switching : int
        0 where A switches, 1 where B does; the other body's feature is the same in both.
    lower, higher : ndarray
        Flat answers as in ``kernels.state.arrays``: with the feature of the boundary, and with the
        one that it bounds.

    Returns
    -------
    SwitchingFunction or None
        None where the two features are not a face and its edge or an edge and its end; a face
        that a vertex enters through a whole fan of directions is none of these.
    """
    below, above, at = AnswerRows(lower), AnswerRows(higher), 2 * switching
    into = _direction(pair[switching], int(below.mode[at]), int(above.mode[at]), float(above.q[at]))
    if into is None:
        return None
    mode = [int(number) for number in below.mode]
    return SwitchingFunction(pair, switching, mode, below.q.copy(), into)


def _direction(
    body: Body, low: int, high: int, parameter: float
) -> Callable[[float], Array] | None:
    ints, reals = body.ints, body.reals
    dimensions = L.dimension(ints, low), L.dimension(ints, high)
    if dimensions == (1, 2):
        edge = L.edge_record(ints, low)
        for k in ints[edge + L.EDGE_COEDGE_0], ints[edge + L.EDGE_COEDGE_1]:
            if k < 0:
                continue
            chart = L.chart_record(ints, ints[L.coedge_record(ints, k) + L.COEDGE_CHART])
            if ints[chart + L.CHART_FACE] == high:
                return partial(_conormal, body, low, int(k))
    if dimensions == (0, 1):
        ends = _ends(body, low, high)
        if ends:
            first = int(ints[L.edge_record(ints, high) + L.EDGE_REALS]) + L.EDGE_T0
            end = min(ends, key=lambda n: abs(parameter - reals[first + n]))
            direction = np.array(end_direction(ints, reals, high, end))
            return lambda _: direction
    return None


def _conormal(body: Body, edge: int, coedge: int, t: float) -> Array:
    tangent = np.array(edge_jet(body.ints, body.reals, edge, t)[1])
    tangent /= np.linalg.norm(tangent)
    return np.array(coedge_conormal(body.ints, body.reals, coedge, tuple(tangent), t)[0])


def _ends(body: Body, vertex: int, edge: int) -> list[int]:
    """Return which ends (0, 1) of an edge are at a vertex, both packed numbers."""
    ints = body.ints
    record = L.vertex_record(ints, vertex)
    fan, count = int(ints[record + L.VERTEX_FAN]), int(ints[record + L.VERTEX_N_FAN])
    entries = ints[fan : fan + 2 * count].reshape(count, 2).tolist()
    return [end for number, end in entries if number + body.n_faces == edge]
