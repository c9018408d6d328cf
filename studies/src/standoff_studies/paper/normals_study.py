"""The set of reference [28] and two others on the same pairs: numbers, no pictures.

Two ellipsoids, whose support points are known, are placed a known distance apart. Each surface has
a chart centred on the current point, (u, v) -> D Q (u, v, 1)/sqrt(1 + u² + v²), with parameters
that measure length there: there are no poles, and no set has better coordinates than another.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from standoff.typing import Array
from standoff_studies.paper.normals_system import (
    evaluate_contact,
    evaluate_normals,
    evaluate_projection_errors,
)

FORMS = ("projection errors", "normals", "contact-regular")
"""Eqs. (1)-(4); the set of reference [28]; the form in (q, n, d) that Standoff uses at contact."""

ARRIVED = 1e-9
"""Witness points this near to the exact ones [length] have been found."""

ALIGNED = 1e-8
"""Sine of the angle between dR and both normals below which two points have a common normal."""

SAME = 1e-6
"""Difference of unit vectors below which two answers are the same."""

MOST_STEPS = 60
"""Newton steps after which a start is given up: those that converge need fewer than 20."""


BALANCING = 30
"""Rounds of scaling rows and columns of a matrix: each halves the remaining error in logarithms."""


@dataclass(frozen=True)
class Ellipsoid:
    """Semi-axes [length], (3,), and orientation in the world, (3, 3)."""

    axes: Array
    rotation: Array

    @property
    def map(self) -> Array:
        """The linear map from the unit sphere to the centred surface, (3, 3)."""
        return self.rotation * self.axes

    def farthest(self, n: Array) -> Array:
        """Support point of the centred surface along a unit vector, (3,) [length]."""
        pulled = self.map.T @ n
        return np.asarray(self.map @ pulled / np.linalg.norm(pulled))

    def direction(self, point: Array) -> Array:
        """The point of the unit sphere that is mapped to a point of the centred surface."""
        return np.asarray(np.linalg.solve(self.map, point))


STILL = np.zeros((6, 3))


class Pair(NamedTuple):
    """Two ellipsoids with known witness points: A centred at the origin, B at `centre`."""

    a: Ellipsoid
    b: Ellipsoid
    n: Array
    distance: float
    motion: Array = STILL
    """p_A, v_A, omega_A, p_B, v_B, omega_B: (6, 3)."""

    @property
    def point_a(self) -> Array:
        return self.a.farthest(self.n)

    @property
    def point_b(self) -> Array:
        return np.asarray(self.point_a + self.distance * self.n)

    @property
    def centre(self) -> Array:
        return np.asarray(self.point_b - self.b.farthest(-self.n))


AXES_A = np.array([1.0, 0.7, 0.5])
AXES_B = np.array([0.4, 0.8, 0.6])
TURN_A = Rotation.from_rotvec([0.4, -0.3, 0.7])
TURN_B = Rotation.from_rotvec([-0.6, 0.9, 0.2])
NORMAL = np.array([2.0, 1.0, 1.0]) / np.sqrt(6.0)


def pair_at(distance: float) -> Pair:
    """Return the study's pair with the witness points a signed distance apart."""
    return Pair(
        Ellipsoid(AXES_A, TURN_A.as_matrix()),
        Ellipsoid(AXES_B, TURN_B.as_matrix()),
        NORMAL,
        distance,
    )


def frames_about(directions: Array) -> Array:
    """Rotations (n, 3, 3) whose third columns are given unit vectors (n, 3)."""
    other = np.eye(3)[np.abs(directions).argmin(axis=1)]
    first = np.cross(other, directions)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return np.stack([first, np.cross(directions, first), directions], axis=2)


class Charts(NamedTuple):
    """Jets (n, 6, 3) in lengths at the current points, and the maps from lengths to directions."""

    jets: Array
    frames: Array
    stretch: Array

    def moved(self, steps: Array) -> Array:
        """Directions (n, 3) after steps in lengths (n, 2)."""
        uv = np.einsum("nij,nj->ni", self.stretch, steps)
        ahead = np.concatenate([uv, np.ones((len(uv), 1))], axis=1)
        directions = np.einsum("nij,nj->ni", self.frames, ahead)
        return np.asarray(directions / np.linalg.norm(directions, axis=1, keepdims=True))


def charts(linear: Array, centre: Array, directions: Array) -> Charts:
    """Charts centred on the images of unit vectors (n, 3) under a map (3, 3) and a shift."""
    frames = frames_about(directions)
    columns = linear @ frames
    tangents, out = columns[:, :, :2], columns[:, :, 2]
    lower = np.linalg.cholesky(np.swapaxes(tangents, 1, 2) @ tangents)
    stretch = np.swapaxes(np.linalg.inv(lower), 1, 2)
    unit_tangents = tangents @ stretch
    bend = np.swapaxes(stretch, 1, 2) @ stretch
    jets = np.empty((len(directions), 6, 3))
    jets[:, 0] = out + centre
    jets[:, 1], jets[:, 2] = unit_tangents[:, :, 0], unit_tangents[:, :, 1]
    for k, (i, j) in enumerate(((0, 0), (0, 1), (1, 1))):
        jets[:, 3 + k] = -bend[:, i, j, None] * out
    return Charts(jets, frames, stretch)


def outward(jets: Array, centre: Array) -> Array:
    """Outward unit normals (n, 3) of a convex surface around its centre."""
    normal = np.cross(jets[:, 1], jets[:, 2])
    inside = ((jets[:, 0] - centre) * normal).sum(axis=1) < 0.0
    return np.asarray(np.where(inside[:, None], -normal, normal))


class Equations(NamedTuple):
    """r, dr/dy and the rate of r at fixed y, (n, m), (n, m, m), (n, m)."""

    r: Array
    jacobian: Array
    rate: Array


@dataclass(frozen=True)
class Points:
    """n points of both bodies, given by unit vectors, and (normal, depth) of the third form.

    `sound` is False if a step could not be taken: the point stays where it was.
    """

    a: Array
    b: Array
    normal: Array
    depth: Array
    sound: NDArray[np.bool_]


def begin(pair: Pair, a: Array, b: Array) -> Points:
    """Points at given directions; the contact-regular form starts with A's own normal."""
    first, second = charts_of(pair, a, b)
    normal = outward(first.jets, np.zeros(3))
    apart = second.jets[:, 0] - first.jets[:, 0]
    return Points(a, b, normal, (normal * apart).sum(axis=1), np.ones(len(a), dtype=bool))


def exact(pair: Pair) -> Points:
    """The witness points."""
    a = pair.a.direction(pair.point_a)[None]
    b = pair.b.direction(pair.point_b - pair.centre)[None]
    points = begin(pair, a, b)
    return replace(points, normal=pair.n[None], depth=np.array([pair.distance]))


def charts_of(pair: Pair, a: Array, b: Array) -> tuple[Charts, Charts]:
    return charts(pair.a.map, np.zeros(3), a), charts(pair.b.map, pair.centre, b)


def equations(pair: Pair, form: str, points: Points, at: tuple[Charts, Charts]) -> Equations:
    """Evaluate one of `FORMS` at n pairs of points."""
    count, size = len(points.a), 8 if form == "contact-regular" else 4
    jets_a, jets_b = at[0].jets, at[1].jets
    motion = np.broadcast_to(pair.motion, (count, 6, 3)).copy()
    out = np.empty((count, size)), np.empty((count, size, size)), np.empty((count, size))
    if form == "contact-regular":
        evaluate_contact(jets_a, jets_b, points.normal, points.depth, motion, *out)
    elif form == "normals":
        evaluate_normals(jets_a, jets_b, motion, *out)
    else:
        evaluate_projection_errors(jets_a, jets_b, motion, *out)
    return Equations(*out)


def corrected(pair: Pair, form: str, points: Points) -> Points:
    """One Newton step, y <- y - J⁻¹ r."""
    at = charts_of(pair, points.a, points.b)
    system = equations(pair, form, points, at)
    return advanced(at, points, -solution(system.jacobian, system.r))


def predicted(pair: Pair, form: str, points: Points, dt: float) -> Points:
    """The feedforward over dt [s], y <- y - dt J⁻¹ r_t."""
    at = charts_of(pair, points.a, points.b)
    system = equations(pair, form, points, at)
    return advanced(at, points, -dt * solution(system.jacobian, system.rate))


def solution(matrices: Array, right: Array) -> Array:
    """Solve each system; nan if the matrix is exactly singular."""
    steps = np.full_like(right, np.nan)
    regular = np.linalg.det(matrices) != 0.0
    if regular.any():
        steps[regular] = np.linalg.solve(matrices[regular], right[regular][..., None])[..., 0]
    return steps


def advanced(at: tuple[Charts, Charts], points: Points, steps: Array) -> Points:
    """Points after steps (n, 4) or (n, 8) in the charts centred on them."""
    fine = points.sound & np.isfinite(steps).all(axis=1)
    steps = np.where(fine[:, None], steps, 0.0)
    normal, depth = points.normal, points.depth
    if steps.shape[1] == 8:
        normal = normal + steps[:, 4:7]
        normal = normal / np.linalg.norm(normal, axis=1, keepdims=True)
        depth = depth + steps[:, 7]
    return Points(at[0].moved(steps[:, :2]), at[1].moved(steps[:, 2:4]), normal, depth, fine)


def witness_error(pair: Pair, points: Points) -> Array:
    """Greater distance of the two points from the exact ones [length], (n,)."""
    x = points.a @ pair.a.map.T - pair.point_a
    y = points.b @ pair.b.map.T + pair.centre - pair.point_b
    return np.asarray(np.maximum(np.linalg.norm(x, axis=1), np.linalg.norm(y, axis=1)))


class Fate(NamedTuple):
    """Where n starts ended, as bool arrays (n,), and after how many steps at the exact points.

    `found`: the exact witness points; `other`: another pair of points with a common normal;
    `meeting`: dR = 0 at points whose normals differ, where the surfaces intersect; `ends`: the
    points where each of them ended.
    """

    found: NDArray[np.bool_]
    other: NDArray[np.bool_]
    meeting: NDArray[np.bool_]
    steps: NDArray[np.int64]
    ends: Points

    @property
    def common_normals(self) -> int:
        """Number of different pairs of points with a common normal that were found."""
        at = np.hstack([self.ends.a, self.ends.b])[self.found | self.other]
        seen: list[Array] = []
        for row in at:
            if all(np.abs(row - known).max() > SAME for known in seen):
                seen.append(row)
        return len(seen)


def newton(pair: Pair, form: str, points: Points) -> Fate:
    """Take plain Newton steps from each start and see where it ends."""
    steps = np.full(len(points.a), MOST_STEPS)
    for k in range(MOST_STEPS):
        steps = np.where((steps == MOST_STEPS) & (witness_error(pair, points) < ARRIVED), k, steps)
        points = corrected(pair, form, points)
    found = points.sound & (witness_error(pair, points) < ARRIVED)
    first, second = charts_of(pair, points.a, points.b)
    n_a, n_b = outward(first.jets, np.zeros(3)), outward(second.jets, pair.centre)
    apart = second.jets[:, 0] - first.jets[:, 0]
    parallel = np.linalg.norm(np.cross(n_a, n_b), axis=1) < ALIGNED
    along = np.linalg.norm(np.cross(n_a, apart), axis=1) < ALIGNED
    together = np.linalg.norm(apart, axis=1) < ARRIVED
    other = points.sound & ~found & parallel & along
    meeting = points.sound & ~found & together & ~parallel
    return Fate(found, other, meeting, steps, points)


def scattered(count: int, seed: int) -> tuple[Array, Array]:
    """Directions of A and of B, (count, 3) each, uniformly distributed over the spheres."""
    drawn = np.random.default_rng(seed).normal(size=(2, count, 3))
    drawn /= np.linalg.norm(drawn, axis=2, keepdims=True)
    return drawn[0], drawn[1]


def turned(pair: Pair, angle: float, count: int, seed: int) -> tuple[Array, Array]:
    """Directions at an angle [rad] from the exact ones, each at a random azimuth."""
    rng = np.random.default_rng(seed)
    sides = []
    at = exact(pair)
    for direction in (at.a[0], at.b[0]):
        frame = frames_about(direction[None])[0]
        azimuth = rng.uniform(0.0, 2.0 * np.pi, count)
        ring = np.column_stack([np.cos(azimuth), np.sin(azimuth)]) @ frame[:, :2].T
        sides.append(np.cos(angle) * direction + np.sin(angle) * ring)
    return sides[0], sides[1]


def condition(pair: Pair, form: str, *, balanced: bool = False) -> tuple[float, float]:
    """(condition number, least singular value) of J at the witness points, in lengths.

    Parameters are lengths along the surfaces, and the unit of length is A's longest semi-axis;
    `balanced` scales rows and columns to unit length first, so that no unit matters.
    """
    points = exact(pair)
    J = equations(pair, form, points, charts_of(pair, points.a, points.b)).jacobian[0]
    if balanced:
        for _ in range(BALANCING):
            J = J / np.sqrt(np.linalg.norm(J, axis=1, keepdims=True))
            J = J / np.sqrt(np.linalg.norm(J, axis=0, keepdims=True))
    values = np.linalg.svd(J, compute_uv=False)
    return float(values[0] / values[-1]), float(values[-1])


def focal_depth() -> float:
    """Depth [length] at which A + B - depth AB becomes singular at the study's witness points.

    A and B are the shape operators of both surfaces in their common tangent plane.
    """
    points = exact(pair_at(0.0))
    first, second = charts_of(pair_at(0.0), points.a, points.b)
    n = NORMAL
    shapes = []
    for jets, sign in ((first.jets[0], -1.0), (second.jets[0], 1.0)):
        form = sign * np.array([[jets[3] @ n, jets[4] @ n], [jets[4] @ n, jets[5] @ n]])
        tangents = jets[1:3]
        shapes.append(tangents.T @ form @ tangents)
    frame = frames_about(n[None])[0][:, :2]
    a, b = (frame.T @ shape @ frame for shape in shapes)
    # (A + B) x = depth A B x
    depths = np.linalg.eigvals(np.linalg.solve(a @ b, a + b))
    return float(depths.real.min())
