"""Exact derivatives of an answer by the poses, by implicit differentiation of its pair system."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.errors import StandoffError
from standoff.kernels.entries import queries
from standoff.tracking.contact.witness_set import witness_set
from standoff.tracking.feature_boundary import at_boundary
from standoff.tracking.rows import Answer, AnswerRows, StateRow, motion_row
from standoff.tracking.tolerances import SETTLED, SINGULAR_SYSTEM

Array = NDArray[np.float64]

N_Q = 4  # parameters: u, v of A, r, s of B
NORMAL = slice(4, 7)
DISTANCE, N_SYSTEM = 7, 8
V_A, TURN_A, V_B, TURN_B = slice(0, 3), slice(3, 6), slice(6, 9), slice(9, 12)
TWISTS_OFF_PLANE = [2, 3, 4, 8, 9, 10]  # of unit twists: v_z, omega_x, omega_y of each body
NEWTON_ROUNDS = 3
"""Newton's corrections of a converged answer: two reach roundoff."""


class Smoothness(Enum):
    """Whether an answer has derivatives."""

    SMOOTH = "smooth"
    ONE_SIDED = "one-sided"
    UNDEFINED = "undefined"


class Derivatives(NamedTuple):
    """Derivatives by the 12 unit twists (v_A, omega_A, v_B, omega_B), world axes.

    Attributes
    ----------
    smoothness : Smoothness
        ONE_SIDED: a witness point lies where two features meet. The gradient holds on all sides,
        the rest where the features stay those of the answer. UNDEFINED: all arrays are nan.
    reason : str
        Why they are one-sided or undefined; empty where they are smooth.
    gradient : (12,) array
        Of the signed distance: length per length, and length per radian.
    hessian : (12, 12) array
        Of the signed distance in the chart R <- exp(omega) R, p <- p + v; symmetric.
    normal_jacobian : (3, 12) array
    point_jacobians : pair of (3, 12) arrays
        Of the witness points on A and on B.

    Notes
    -----
    Of planar bodies the columns of twists out of the plane are zero.
    """

    smoothness: Smoothness
    reason: str
    gradient: Array
    hessian: Array
    normal_jacobian: Array
    point_jacobians: tuple[Array, Array]


def defined(derivatives: Derivatives) -> Derivatives:
    """The same, or a StandoffError with the reason where they are undefined."""
    if derivatives.smoothness is Smoothness.UNDEFINED:
        raise StandoffError(
            f"The distance has no derivatives here: {derivatives.reason} "
            "answer.derivatives() gives a flag in place of this error."
        )
    return derivatives


def derivatives(answer: Answer) -> Derivatives:
    """See ``Proximity.derivatives``."""
    if answer.poses is None:
        return _undefined("the answer keeps no poses.")
    if not np.isfinite(answer.distance):
        return _undefined("the answer has no distance.")
    system = _Point(answer)
    if not system.settle():
        return _undefined("the witness points are not at rest at an optimum of their features.")
    if not witness_set(answer).unique:
        return _undefined("the witness points or the normal are not unique.")
    rates = system.rates()
    if rates is None:
        return _undefined("the pair system is singular.")
    corner = _boundary(answer, system)
    kind = Smoothness.ONE_SIDED if corner else Smoothness.SMOOTH
    return Derivatives(kind, corner, *_assembled(system, rates))


def _undefined(reason: str) -> Derivatives:
    points = np.full((3, 12), np.nan), np.full((3, 12), np.nan)
    values = np.full(12, np.nan), np.full((12, 12), np.nan), np.full((3, 12), np.nan)
    return Derivatives(Smoothness.UNDEFINED, reason, *values, points)


class _Point:
    """The contact-regular system (docs/pair-system.md) at an answer, lengths over ``size``.

    Positions are taken from A's origin, in world axes; parameters in units of arc length.
    """

    def __init__(self, answer: Answer) -> None:
        a, b = answer.bodies
        poses = answer.poses
        assert poses is not None
        row = AnswerRows(answer.row)
        self.a, self.b, self.state = a, b, StateRow()
        self.state.mode, self.state.q = row.mode, row.q
        self.turn = poses[0][:9].reshape(3, 3)
        self.shift = poses[1][9:] - poses[0][9:]
        self.motion, self.out = motion_row(*poses), np.empty(queries.N_SYSTEM)
        self.packed = (a.ints, a.reals, b.ints, b.reals)
        self.normal = np.array(answer.normal)
        self.d = answer.distance + a.radius + b.radius
        bodies = [body.size for body in (a, b) if body.bounded]
        self.size = max([*bodies, abs(self.d), np.finfo(float).tiny])
        self.planar = a.dimension == 2 or b.dimension == 2
        kept = [*self._parameters(0, a), *self._parameters(1, b), *range(N_Q, N_SYSTEM)]
        # of planar bodies the system is that of the plane
        self.kept = [k for k in kept if not (self.planar and k == NORMAL.start + 2)]
        self._evaluate()

    def _parameters(self, side: int, body: Body) -> range:
        number = int(self.state.mode[2 * side])
        count = 2 - int(number >= body.n_faces) - int(number >= body.n_faces + body.n_edges)
        return range(2 * side, 2 * side + count)

    def _evaluate(self) -> None:
        queries.pair_system(self.packed, self.motion, self.state.data, self.out)
        flat = self.out[queries.JETS : queries.ERRORS].reshape(2, 6, 3)
        self.jets = flat @ self.turn.T / self.size
        lengths = np.linalg.norm(self.jets[:, 1:3], axis=2)
        self.scale = 1.0 / np.where(lengths > 0.0, lengths, 1.0)  # parameter per arc length
        self.x, self.y = self.jets[0, 0], self.jets[1, 0]
        self.tangents = np.swapaxes(self.jets[:, 1:3] * self.scale[:, :, None], 1, 2)

    def residual(self) -> Array:
        """r of the contact-regular form, (8,)."""
        n, (f, g) = self.normal, self.tangents
        gap = self.y - self.x - self.d / self.size * n
        return np.concatenate([-f.T @ n, g.T @ n, gap, [0.5 * (1.0 - n @ n)]])

    def jacobian(self) -> Array:
        """J of the contact-regular form, (8, 8), symmetric."""
        n, (f, g) = self.normal, self.tangents
        J = np.zeros((N_SYSTEM, N_SYSTEM))
        for side, sign in ((0, -1.0), (1, 1.0)):
            uu, uv, vv = self.jets[side, 3:] @ n
            at = slice(2 * side, 2 * side + 2)
            J[at, at] = (
                sign * np.array([[uu, uv], [uv, vv]]) * np.outer(self.scale[side], self.scale[side])
            )
            tangents = (f, g)[side] * sign
            J[NORMAL, at], J[at, NORMAL] = tangents, tangents.T
        J[NORMAL, NORMAL] = -self.d / self.size * np.eye(3)
        J[NORMAL, DISTANCE] = J[DISTANCE, NORMAL] = -n
        return J

    def solve(self, right: Array) -> Array | None:
        """J⁻¹ times the right-hand sides, (8, k); None where J is singular."""
        J = self.jacobian()[np.ix_(self.kept, self.kept)]
        singular = np.linalg.svd(J, compute_uv=False)
        if not singular[-1] > SINGULAR_SYSTEM * singular[0]:
            return None
        whole = np.zeros((N_SYSTEM, right.shape[1]))
        whole[self.kept] = np.linalg.solve(J, right[self.kept])
        return whole

    def settle(self) -> bool:
        """Bring the point to roundoff by Newton's method; was it at rest before and after?"""
        if not np.abs(self.residual()[self.kept]).max() <= SETTLED:
            return False
        for _ in range(NEWTON_ROUNDS):
            change = self.solve(-self.residual()[:, None])
            if change is None:
                return True  # `rates` tells that it is singular
            step = change[:, 0]
            self.state.q = self.state.q + step[:N_Q] * self.scale.ravel()
            self.normal = self.normal + step[NORMAL]
            self.d += self.size * step[DISTANCE]
            self._evaluate()
        return bool(np.abs(self.residual()[self.kept]).max() <= SETTLED)

    def rates(self) -> Array | None:
        """(8, 12): changes of the system's unknowns by the unit twists, lengths over size."""
        n, (f, g) = self.normal, self.tangents
        rates = np.zeros((N_SYSTEM, 12))
        unit = np.eye(3) / self.size
        rates[0:2, TURN_A], rates[2:4, TURN_B] = -f.T @ _cross(n), g.T @ _cross(n)
        rates[NORMAL, V_A], rates[NORMAL, V_B] = -unit, unit
        rates[NORMAL, TURN_A] = _cross(self.x)
        rates[NORMAL, TURN_B] = -_cross(self.y - self.shift / self.size)
        if self.planar:
            rates[:, TWISTS_OFF_PLANE] = 0.0
        return self.solve(-rates)


def _cross(x: Array) -> Array:
    """[x], with [x] y = x × y."""
    return np.array([[0.0, -x[2], x[1]], [x[2], 0.0, -x[0]], [-x[1], x[0], 0.0]])


def _assembled(at: _Point, rates: Array) -> tuple[Array, Array, Array, tuple[Array, Array]]:
    """Gradient, Hessian, Jacobian of the normal and of the points, of a system's rates."""
    n, dn = at.normal, rates[NORMAL]
    arms = at.size * at.x, at.size * at.y - at.shift
    gradient = np.concatenate([-n, -np.cross(arms[0], n), n, np.cross(arms[1], n)])
    turned = np.empty((12, 12))
    points = []
    for side, sign, radius in ((0, -1.0, at.a.radius), (1, 1.0, at.b.radius)):
        v, turn, arm = (V_A, V_B)[side], (TURN_A, TURN_B)[side], arms[side]
        along = at.size * at.tangents[side] @ rates[2 * side : 2 * side + 2]
        along[:, turn] -= _cross(arm)
        # gradient's rows: sign n, and sign (arm x n)
        turned[v], turned[turn] = sign * dn, sign * (_cross(arm) @ dn - _cross(n) @ along)
        moved = along - sign * radius * dn
        moved[:, v] += np.eye(3)
        points.append(moved)
    hessian = 0.5 * (turned + turned.T)
    if at.planar:
        gradient[TWISTS_OFF_PLANE] = 0.0
        hessian[TWISTS_OFF_PLANE] = hessian[:, TWISTS_OFF_PLANE] = 0.0
        for moved in points:
            moved[:, TWISTS_OFF_PLANE] = 0.0
    return gradient, hessian, dn, (points[0], points[1])


def _boundary(answer: Answer, at: _Point) -> str:
    """Where a witness point lies between two features: a sentence, or nothing."""
    poses = answer.poses
    assert poses is not None
    for side, name, sign in ((0, "A", 1.0), (1, "B", -1.0)):
        body, pose = (at.a, at.b)[side], poses[side]
        n = sign * pose[:9].reshape(3, 3).T @ at.normal
        number, chart = (int(k) for k in at.state.mode[2 * side : 2 * side + 2])
        q = at.state.q[2 * side : 2 * side + 2]
        if at_boundary(body, number, chart, q, n):
            feature = (answer.feature_a, answer.feature_b)[side]
            return f"the witness point on {name} lies where {feature} meets another feature."
    return ""
