"""The squared parameter error |q − q*|² along the law: where it falls, and the ball it proves.

With e = q − q* and the bodies at rest, d|e|²/dt = −2K eᵀH⁻¹g. As g is about H e near the optimum,
it falls there; farther away nothing but a look at each point tells.

While the bodies move, g' = −K g stays exact, so V falls at any K. |e|² and E − E* do not: what the
feedforward is at q differs from what it is at q*, by about |e|. They fall at gains above a least
one, which grows with the motion.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy

import standoff as so
from standoff.bodies import Body
from standoff.control.lyapunov import LyapunovLevels, RestSystem
from standoff.control.tolerances import DIRECTION_TOLERANCE
from standoff.motion import ConstantTwist, Pose, Twist
from standoff.tracking.places import PlaceLike
from standoff.typing import Array

PACE = 0.02
"""Steps along a ray, in parameters, whose ranges are about 1."""

HALVINGS = 30
"""Halvings of the step in which a ray ends: to 2e-11 of a parameter."""

RAYS, SOUGHT = 60, 20
"""Rays that are drawn; and, per parameter, those of the search for the shortest from the best."""

SPREAD = 0.1
"""First simplex of that search, about a unit vector."""

SEED = 0

GAINS = (100.0, 200.0)
"""K at which rates are measured [1/s]; K times `INSTANT` is 1e-4."""

REACH = 3.0
"""Half the width of a box of parameters that holds the faces looked at."""

INSTANT = 1e-6
"""Frame in which a law's rates are measured [s]: their own error is about K times this."""

RISES, SINGULAR, SIDE = "the error rises beyond", "det H = 0", "the face ends"
"""Why a ray ends."""

FUNCTIONS = ("|q − q*|²", "V", "E − E*")
"""The three functions."""


class Volumes(NamedTuple):
    """Of sets around an optimum, in parameters.

    Attributes
    ----------
    ball : float
        The largest ball in which |q − q*|² falls.
    v, energy : float
        The largest level sets of V and of E − E*.
    region : float
        All that the law's own curves cover before H is singular or a face ends.
    """

    ball: float
    v: float
    energy: float
    region: float


class Ray(NamedTuple):
    """A straight line of parameters from the optimum: its length, why it ends, and its direction.

    The shortest one is the radius of the largest ball of parameters in which |q − q*|² falls.
    """

    length: float
    cause: str
    direction: Array

    @property
    def volume(self) -> float:
        """Of the ball with this radius, in parameters."""
        n = len(self.direction)
        return float(np.pi ** (n / 2) / scipy.special.gamma(n / 2 + 1) * self.length**n)


@dataclass(frozen=True)
class Errors:
    """A pair at rest, A at home, and its optimum.

    Attributes
    ----------
    a, b : Body
    pose_b : Pose
    feature_a, feature_b : Feature
        Those of the closest points.
    optimum : (n,) array
        Their parameters, those of A first.
    metric : (n, n) array
        Of the tangents there.
    """

    a: Body
    b: Body
    pose_b: Pose
    feature_a: so.Feature
    feature_b: so.Feature
    optimum: Array
    metric: Array

    @classmethod
    def of(cls, a: Body, b: Body, pose_b: Pose) -> Errors:
        """A pair with its closest points."""
        best = so.distance(a, b, Pose.identity(), pose_b)
        system = RestSystem(a, b, Pose.identity(), pose_b)
        optimum = system.place(best.place_a, best.place_b)
        return cls(a, b, pose_b, best.feature_a, best.feature_b, optimum, system.at(optimum)[2])

    def places(self, q: Array) -> tuple[PlaceLike, PlaceLike]:
        """Parameters as places on both bodies."""
        n = {"face": 2, "edge": 1, "vertex": 0}[self.feature_a.kind]
        return (self.feature_a, q[:n]), (self.feature_b, q[n:])

    def system(self, pose_b: Pose | None = None) -> RestSystem:
        """g, H and E as functions of the parameters."""
        made = RestSystem(self.a, self.b, Pose.identity(), pose_b or self.pose_b)
        made.place(*self.places(self.optimum))
        return made

    def ends(self, system: RestSystem, q: Array) -> str:
        """Why a ray through q has ended, or nothing if it has not."""
        if not system.contains(q):
            return SIDE
        g, H, _, _ = system.at(q)
        if np.linalg.eigvalsh(H)[0] <= 0.0:  # Sylvester: its sign is that in any metric
            return SINGULAR
        return RISES if (q - self.optimum) @ np.linalg.solve(H, g) <= 0.0 else ""

    def ray(self, direction: Array) -> Ray:
        """Follow a direction from the optimum to its end."""
        system, home = self.system(), self.optimum
        unit = direction / np.linalg.norm(direction)
        inside, outside = 0.0, PACE
        while not self.ends(system, home + outside * unit):
            inside, outside = outside, outside + PACE
        for _ in range(HALVINGS):
            middle = 0.5 * (inside + outside)
            if self.ends(system, home + middle * unit):
                outside = middle
            else:
                inside = middle
        return Ray(inside, self.ends(system, home + outside * unit), unit)

    def shortest(self) -> Ray:
        """The shortest ray: of many directions, and of a search from the best of them."""
        n = len(self.optimum)
        drawn = np.random.default_rng(SEED).normal(size=(RAYS, n))
        found = [self.ray(direction) for direction in drawn]
        best = min(found, key=lambda ray: ray.length)

        def length(direction: Array) -> float:
            found.append(self.ray(direction))
            return found[-1].length

        corners = best.direction + np.vstack([np.zeros(n), SPREAD * np.eye(n)])
        ends = {"maxfev": SOUGHT * n, "xatol": DIRECTION_TOLERANCE, "fatol": 0.0}
        options = {"initial_simplex": corners, **ends}
        scipy.optimize.minimize(length, best.direction, method="Nelder-Mead", options=options)
        return min(found, key=lambda ray: ray.length)


def volumes(made: Errors, levels: LyapunovLevels, shortest: Ray) -> Volumes:
    """The volumes of what each function proves.

    g takes the region one-to-one to a star: with z = Lᵀ(q − q*), y = L⁻¹g and H' = L⁻¹HL⁻ᵀ the
    volume is dy / det H', and along a curve ds / det H' = dt / |adj(H') e|, which stays finite.
    """
    system, lower, n = made.system(), np.linalg.cholesky(made.metric), len(made.optimum)
    inverse = np.linalg.inv(lower)
    drawn = len(levels.directions) - (2 if n > 1 else 0)  # without the two that were sought
    sums = []
    for k in range(drawn):
        density = []
        for q, slope in zip(levels.curves[k], levels.slopes[k], strict=True):
            values, vectors = np.linalg.eigh(inverse @ system.at(q)[1] @ inverse.T)
            others = np.array([np.prod(np.delete(values, i)) for i in range(n)])
            along = np.linalg.norm(others * (vectors.T @ levels.directions[k]))
            density.append(max(slope, 0.0) ** (n - 1) / along)
        way = np.linalg.norm(np.diff(levels.curves[k], axis=0) @ lower, axis=1)
        parts = 0.5 * (np.array(density[1:]) + np.array(density[:-1])) * way
        grown = np.append(0.0, np.cumsum(parts))
        by_v = np.interp(levels.level, 0.5 * levels.slopes[k] ** 2, grown)
        by_energy = np.interp(levels.energy_level, levels.energies[k], grown)
        sums.append((by_v, by_energy, grown[-1]))
    sphere = 2.0 * np.pi ** (n / 2) / scipy.special.gamma(n / 2)
    scale = sphere / np.linalg.det(lower)
    v, energy, region = (scale * np.mean(sums, axis=0)).tolist()
    return Volumes(shortest.volume, v, energy, region)


def rates(made: Errors, law: so.PaperLaw, points: Iterable[Array], twist: Twist) -> Array:
    """By how much a law changes |q − q*|², V and E − E* in an instant, per unit of time: (., 3).

    Measured at each point with the tracker itself and with the optimum of the moved bodies; B moves
    with `twist`.
    """
    path = ConstantTwist(made.pose_b, twist)
    tracker = so.Tracker(made.a, made.b, INSTANT, law=law)
    home, still, found = Pose.identity(), Twist.zero(), []
    values = [_values(made, path.pose(t)) for t in (0.0, INSTANT)]
    for q in points:
        state = tracker.start_from(
            home, path.pose(0.0), *made.places(q), still, path.twist(0.0), settle=False
        )
        _, answer = tracker.step(state, home, path.pose(INSTANT), still, path.twist(INSTANT))
        after = np.array(answer.parameters_a + answer.parameters_b)
        found.append((values[1](after) - values[0](q)) / INSTANT)
    return np.array(found)


def _values(made: Errors, pose_b: Pose) -> Callable[[Array], Array]:
    """|q − q*|², V and E − E* as a function of q, at a pose of B."""
    system = made.system(pose_b)
    inverse = np.linalg.inv(made.metric)
    optimum = made.optimum
    for _ in range(4):  # Newton's method: the optimum has moved by an instant
        g, H, _, energy = system.at(optimum)
        optimum = optimum - np.linalg.solve(H, g)

    def at(q: Array) -> Array:
        g, _, _, here = system.at(q)
        e = q - optimum
        return np.array([e @ e, 0.5 * g @ inverse @ g, here - energy])

    return at


def spread(made: Errors, count: int) -> Array:
    """Points of the optimum's features, drawn evenly in their parameters: (count, n)."""
    rng, system, found = np.random.default_rng(SEED), made.system(), list[Array]()
    n = len(made.optimum)
    while len(found) < count:
        q = rng.uniform(-REACH, REACH, n)
        if system.contains(q):
            found.append(q)
    return np.array(found)


def in_ball(made: Errors, radius: float, count: int) -> Array:
    """Points drawn evenly in a ball of parameters around the optimum."""
    n = len(made.optimum)
    rng = np.random.default_rng(SEED)
    x = rng.normal(size=(count, n))
    x *= (rng.uniform(size=(count, 1)) ** (1.0 / n)) / np.linalg.norm(x, axis=1, keepdims=True)
    return np.asarray(made.optimum + radius * x)


def least_gains(made: Errors, points: Array, twist: Twist) -> Array:
    """The least K at which each function falls at all points while B moves, (3,) [1/s].

    A rate is linear in K, so it follows from two gains.
    """
    low, high = GAINS
    at_low, at_high = (rates(made, law(k), points, twist) for k in GAINS)
    slope = (at_high - at_low) / (high - low)
    return np.asarray((low - at_low / slope).max(axis=0).clip(min=0.0))


def law(gain: float, solve: str = "plain") -> so.PaperLaw:
    """Return the law whose rates are measured: Euler's, on its features."""
    return so.PaperLaw(integrator="euler", gain=gain, solve=solve, switching="none")


class Fallen(NamedTuple):
    """At how many points each function falls, at rest.

    Attributes
    ----------
    definite, printed : int and (3,) array of int
        Points at which H is definite, and at how many of them each falls by the printed law: points
        on the law's own curves around the optimum, and those of the spread ones.
    spread, covariant : int and (3,) array of int
        Points all over the features, and at how many each falls by the covariant law.
    """

    definite: int
    printed: Array
    spread: int
    covariant: Array


def fallen(made: Errors, levels: LyapunovLevels, count: int) -> Fallen:
    """Count where the functions fall."""
    on_curves = levels.curves[:, 1:-1].reshape(-1, len(made.optimum))
    chosen = np.random.default_rng(SEED).choice(len(on_curves), count, replace=False)
    everywhere, system = spread(made, count), made.system()
    definite = [q for q in everywhere if np.linalg.eigvalsh(system.at(q)[1])[0] > 0.0]
    near = [*on_curves[chosen], *definite]
    printed, covariant = (
        (rates(made, law(GAINS[0], solve), points, Twist.zero()) < 0.0).sum(axis=0)
        for solve, points in (("plain", near), ("covariant", everywhere))
    )
    return Fallen(len(near), printed, count, covariant)
