"""Lyapunov functions of the paper's law, and their largest level sets where H is definite.

At rest the law gives dg/dt = -K g while H = dg/dq is regular. Two functions fall along it:

    V = g' D*^-1 g / 2,  D* the metric of the tangents at the optimum:  dV/dt = -2 K V
    E - E*,              E = |dR|²/2:                                   dE/dt = -K g' H^-1 g

the second where H is positive definite. So g runs straight to 0, and the curves on which g keeps
its direction are the law's own. Each is followed outwards from the optimum until H becomes
singular or the features end. What they cover is mapped one to one by g on a star-shaped set, the
law never leaves it, and a level set below the least value at the curves' ends lies within it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.bodies.features import charts_of
from standoff.checks.numbers import whole_number
from standoff.control.tolerances import CURVE_TOLERANCE, DIRECTION_TOLERANCE
from standoff.errors import StandoffError
from standoff.kernels.entries import queries
from standoff.kernels.entries.queries import on_face
from standoff.kernels.tolerances import RECHART
from standoff.motion import PoseLike
from standoff.tracking import Feature, Proximity, distance
from standoff.tracking.inputs import flat_pose
from standoff.tracking.pair_system import UPPER
from standoff.tracking.places import PlaceLike, put
from standoff.tracking.rows import StateRow, motion_row
from standoff.typing import Array

# Greatest length of a curve, in parts of the pair's size: past it there is no end worth finding.
LONGEST = 20.0
# Points kept on each curve, its end included.
KEPT = 25
# The search for the least end: first simplex, and curves followed per parameter.
SPREAD = 0.1
SEARCH = 20


class LyapunovLevels(NamedTuple):
    """Level sets around an optimum, with n parameters in all.

    Attributes
    ----------
    feature_a, feature_b : Feature
    optimum : (n,) array
        Parameters of the optimum, those of A first.
    metric : (n, n) array
        D*: V = g' inv(D*) g / 2.
    level : float
        Largest V whose set around the optimum lies in {H > 0} and on the features, length².
    energy_level : float
        Largest E - E* likewise, length².
    directions : (m, n) array
        Unit vectors: curve k is where L^-1 g points along direction k, with D* = L L'.
    curves : (m, KEPT, n) array
        Parameters along them from the optimum to their end.
    slopes, energies : (m, KEPT) arrays
        sqrt(2 V), length, and E - E*, length², there.
    singular : (m,) bool array
        H is singular at the curve's end; else a feature ends there.
    repaired : int
        How many of the two poses were given with a rounded rotation, and were replaced by the
        nearest one.
    """

    feature_a: Feature
    feature_b: Feature
    optimum: Array
    metric: Array
    level: float
    energy_level: float
    directions: Array
    curves: Array
    slopes: Array
    energies: Array
    singular: NDArray[np.bool_]
    repaired: int

    def inside(self, part: float = 1.0) -> tuple[Array, Array]:
        """Points of the curves within `part` of the level of V, and of that of E: (., n) each.

        The optimum, where all curves begin, is left out.
        """
        by_slope = 0.5 * self.slopes[:, 1:] ** 2 < part * self.level
        by_energy = self.energies[:, 1:] < part * self.energy_level
        return self.curves[:, 1:][by_slope], self.curves[:, 1:][by_energy]


def lyapunov_level(
    a: Body, b: Body, pose_a: PoseLike, pose_b: PoseLike, directions: int = 180, seed: int = 0
) -> LyapunovLevels:
    """The largest level sets of both Lyapunov functions at the minimum of a pair at rest.

    Raises TypeError: not a body. Raises ValueError: `directions` or `seed` is not a whole number.
    The pair overlaps or touches; H is not positive definite at its optimum (parallel faces), or the
    witness points are vertices, which have no parameters.

    Parameters
    ----------
    a, b : Body
    pose_a, pose_b : Pose or what ``Pose.of`` reads
        World poses.
    directions : int
        Curves to follow: evenly around for two parameters, random with a seed for more. From the
        best of them the least value at an end is sought by descent.
    seed : int

    Returns
    -------
    LyapunovLevels
        On a face with an atlas, in the optimum's chart as far as a tracker stays in it.
    """
    directions = whole_number(directions, "directions")
    seed = whole_number(seed, "seed", 0)
    best = distance(a, b, pose_a, pose_b)
    if not best.certified or best.distance <= 0.0:
        raise StandoffError(f"The pair has no certified minimum: {best!r}.")
    system = RestSystem(a, b, pose_a, pose_b)
    q0 = system.place(best.place_a, best.place_b)
    if not len(q0):
        raise StandoffError("Both witness points are vertices: there are no parameters to err.")
    _, H, metric, energy = system.at(q0)
    L = np.array(np.linalg.cholesky(metric), dtype=np.float64)
    if system.definiteness(H, L) <= CURVE_TOLERANCE:
        raise _not_definite(best)

    def follow(direction: Array) -> LyapunovCurve:
        unit = np.asarray(direction / np.linalg.norm(direction))
        return _outwards(system, q0, L, unit, energy)

    found = _followed(follow, _directions(len(q0), directions, seed))
    curves, slopes, energies, singular, ways = (np.array(x) for x in zip(*found, strict=True))
    return LyapunovLevels(
        feature_a=best.feature_a,
        feature_b=best.feature_b,
        optimum=q0,
        metric=metric,
        level=float(0.5 * slopes[:, -1].min() ** 2),
        energy_level=float(energies[:, -1].min()),
        directions=ways,
        curves=curves,
        slopes=slopes,
        energies=energies,
        singular=singular,
        repaired=best.repaired,
    )


def _not_definite(best: Proximity) -> StandoffError:
    return StandoffError(
        f"H is not positive definite at the optimum, {best.feature_a} - {best.feature_b}: "
        "the faces are parallel, or the bodies touch."
    )


def _followed(follow: Callable[[Array], LyapunovCurve], around: Array) -> list[LyapunovCurve]:
    """The curves in given directions, and where there are several parameters both least ones."""
    found = [follow(direction) for direction in around]
    if around.shape[1] > 1:
        found += [_least(follow, found, lambda c: c.slopes[-1])]
        found += [_least(follow, found, lambda c: c.energies[-1])]
    return found


def _directions(n: int, count: int, seed: int) -> Array:
    if n == 1:
        return np.array([[1.0], [-1.0]])
    if n == 2:
        angle = 2.0 * np.pi * np.arange(count) / count
        return np.column_stack([np.cos(angle), np.sin(angle)])
    random = np.random.default_rng(seed).normal(size=(count, n))
    return np.asarray(random / np.linalg.norm(random, axis=1, keepdims=True))


class LyapunovCurve(NamedTuple):
    """A curve on which g = s L e, as far as H is regular: rows of `LyapunovLevels`."""

    points: Array
    slopes: Array
    energies: Array
    singular: bool
    direction: Array


def _least(
    follow: Callable[[Array], LyapunovCurve],
    found: list[LyapunovCurve],
    value: Callable[[LyapunovCurve], float],
) -> LyapunovCurve:
    """The curve with the least value at its end, sought from the best found."""
    best = min(found, key=value)
    sought: list[LyapunovCurve] = []

    def end(direction: Array) -> float:
        sought.append(follow(direction))
        return value(sought[-1])

    n = len(best.direction)
    corners = best.direction + np.vstack([np.zeros(n), SPREAD * np.eye(n)])
    ends = {"maxfev": SEARCH * n, "xatol": DIRECTION_TOLERANCE, "fatol": 0.0}
    options = {"initial_simplex": corners, **ends}
    scipy.optimize.minimize(end, best.direction, method="Nelder-Mead", options=options)
    return min([best, *sought], key=value)


def _outwards(
    system: RestSystem, q0: Array, L: Array, direction: Array, rest: float
) -> LyapunovCurve:
    """Follow a direction e from the optimum until H is singular or a feature ends.

    By length: dq/dt ~ adj(H) L e and ds/dt ~ det H go smoothly through a singular H.
    """
    n = len(q0)
    inverse = np.linalg.inv(L)

    def rate(_: float, y: Array) -> Array:
        H = inverse @ system.at(y[:n])[1] @ inverse.T
        values, V = np.linalg.eigh(H)
        others = np.array([np.prod(np.delete(values, k)) for k in range(n)])
        q = inverse.T @ (V @ (others * (V.T @ direction)))
        change = np.append(q, np.prod(values))
        return np.asarray(change / np.linalg.norm(L.T @ q))

    def definite(_: float, y: Array) -> float:
        return system.definiteness(system.at(y[:n])[1], L)

    def on_features(_: float, y: Array) -> float:
        return 1.0 if system.contains(y[:n]) else -1.0

    definite.terminal = on_features.terminal = True  # type: ignore[attr-defined]
    ended = scipy.integrate.solve_ivp(
        rate,
        (0.0, LONGEST * system.size),
        np.append(q0, 0.0),
        method="RK45",
        rtol=CURVE_TOLERANCE,
        atol=CURVE_TOLERANCE * system.size,
        max_step=0.1 * system.size,
        events=(definite, on_features),
        dense_output=True,
    )
    at = ended.sol(np.linspace(0.0, ended.t[-1], KEPT)).T
    energies = np.array([system.at(y[:n])[3] - rest for y in at])
    return LyapunovCurve(at[:, :n], at[:, n], energies, bool(len(ended.t_events[0])), direction)


class RestSystem:
    """g, H, D and E of one mode of a pair at rest, also a little outside its features."""

    def __init__(self, a: Body, b: Body, pose_a: PoseLike, pose_b: PoseLike) -> None:
        self.bodies = a, b
        self.packed = (a.ints, a.reals, b.ints, b.reals)
        self.motion = motion_row(flat_pose(pose_a), flat_pose(pose_b))
        self.mode = np.zeros(4, dtype=np.int64)
        self.kept = np.zeros(0, dtype=np.int64)
        self.size = max(body.size for body in self.bodies if body.bounded)
        self.state = StateRow()
        self.out = np.empty(queries.N_SYSTEM)

    def place(self, place_a: PlaceLike, place_b: PlaceLike) -> Array:
        """Set the mode; its parameters, (n,)."""
        state = self.state = StateRow()
        put(state, 0, self.bodies[0], place_a)
        put(state, 1, self.bodies[1], place_b)
        self.mode = state.mode.astype(np.int64)
        counts = [
            2 - int(number >= body.n_faces) - int(number >= body.n_faces + body.n_edges)
            for number, body in zip(self.mode[::2], self.bodies, strict=True)
        ]
        self.kept = np.array([0, 1, 2, 3])[np.r_[: counts[0], 2 : 2 + counts[1]]]
        return np.asarray(state.q[self.kept])

    def at(self, q: Array) -> tuple[Array, Array, Array, float]:
        """(g, H, D, E) at parameters q."""
        self.state.q[self.kept] = q
        queries.pair_system(self.packed, self.motion, self.state.data, self.out)
        jets = self.out[queries.JETS : queries.ERRORS].reshape(2, 6, 3)
        tangents = np.zeros((6, 4))
        tangents[:3, :2], tangents[3:, 2:] = jets[0, 1:3].T, jets[1, 1:3].T
        tangents = tangents[:, self.kept]
        H = np.empty((4, 4))
        H[UPPER] = H.T[UPPER] = self.out[queries.HESSIAN :]
        sign = np.array([1.0, 1.0, -1.0, -1.0])
        dR = jets[0, 0] - jets[1, 0]
        g = (sign * self.out[queries.ERRORS : queries.FEEDFORWARD])[self.kept]
        return g, H[np.ix_(self.kept, self.kept)], tangents.T @ tangents, 0.5 * float(dR @ dR)

    def points(self, q: Array) -> Array:
        """Both witness points, (2, 3)."""
        self.at(q)
        return self.out[queries.JETS : queries.ERRORS].reshape(2, 6, 3)[:, 0].copy()

    def definiteness(self, H: Array, L: Array) -> float:
        """The least eigenvalue of H in the metric L L'."""
        inverse = np.linalg.inv(L)
        return float(np.linalg.eigvalsh(inverse @ H @ inverse.T)[0])

    def contains(self, q: Array) -> bool:
        """Do the parameters lie on both features (of an atlas: on the chart's inner part)?"""
        full = np.zeros(4)
        full[self.kept] = q
        return all(
            self._on(body, int(self.mode[2 * k]), int(self.mode[2 * k + 1]), full[2 * k :][:2])
            for k, body in enumerate(self.bodies)
        )

    def _on(self, body: Body, feature: int, chart: int, q: Array) -> bool:
        if feature < body.n_faces:
            if charts_of(body, feature)[1] > 1 and np.abs(q).max() > RECHART:
                return False
            return bool(on_face(body.ints, body.reals, chart, q[0], q[1]))
        if feature < body.n_faces + body.n_edges:
            curve = body.edge_parts[feature - body.n_faces].curve
            return bool(curve.closed or curve.first <= q[0] <= curve.last)
        return True
