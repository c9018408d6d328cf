"""Pairs whose distance, witness points and normal are exact by construction.

Choose a unit n, rotations and a gap g (negative: a depth), and put x = s_A(n), y = x + g n,
p_B = y - s_B(-n). The poses are rounded to float64 first, which moves the stationary point of
s(n) = h_A(n) + h_B(-n) by a rounding; if the bodies have no curvature (two vertices) and the gap is
1e-6, that turns the normal by 1e-10. So n is then solved for at the rounded poses, in extended
precision: NEWTON_STEPS from a start with an error of one rounding. The supports of the image R X
are exact for any matrix R, so the rounding of R does no harm.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from standoff_studies.accuracy.solids import Solid
from standoff_studies.oracles import Array, Flat, extended, unit

Pose = tuple[Array, Array]

STEP = 1e-6
"""Step of the central differences for Newton's matrix, rad: their error of 1e-12 of the size is
small compared with the least gap, 1e-6 of it, which alone is on the diagonal without curvature."""
NEWTON_STEPS = 3
CROSSING = 0.1
"""Least sine between two crossing lines: nearly parallel ones have no well-defined witness."""
WITHIN = (0.05, 0.95)
"""Range of the weights of a segment's or face's ends with which the witness is placed on it."""


@dataclass(frozen=True)
class Truth:
    """Two placed bodies and their exact answer, in world coordinates, float64.

    Attributes
    ----------
    pose_a, pose_b
        (R, p) as they are given to the engines.
    distance
        Signed: negative is the depth along ``normal``.
    point_a, point_b, normal
        Witness points (3,) and the unit normal (3,) from A to B.
    contact
        The support sets of A and B, such as ``"face, point"``.
    stiffness
        The least eigenvalue (length) of rho_A + rho_B + g I on the directions in which n is
        free, rho being the radii of curvature; inf where n is fixed. Positive: s(n) has a
        minimum there, also in penetration.
    """

    pose_a: Pose
    pose_b: Pose
    distance: float
    point_a: Array
    point_b: Array
    normal: Array
    contact: str
    stiffness: float


@dataclass(frozen=True)
class Setting:
    """A pair at rounded poses, and the flat of each body that takes part."""

    a: Solid
    b: Solid
    pose_a: Pose
    pose_b: Pose
    flat_a: Flat | None
    flat_b: Flat | None


def random_rotation(rng: np.random.Generator) -> Array:
    """Return a uniformly random rotation matrix."""
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return np.asarray(q * np.linalg.det(q))


def inverse_transposed(matrix: Array) -> Array:
    """Return R^-T times det R, which maps normals where R maps points."""
    x, y, z = matrix.T
    return np.stack([np.cross(y, z), np.cross(z, x), np.cross(x, y)], axis=1)


def _arm(solid: Solid, rotation: Array, normal: Array) -> Array:
    """Return R s(R^T n), extended: the support point from the body's origin, world axes."""
    turn = extended(rotation)
    return np.asarray(turn @ solid.support.points((normal @ turn)[None])[0])


def _frame(flat: Flat, rotation: Array, t: Any) -> tuple[Array, Array]:
    """Return the outward normal of a flat and its ends from the body's origin, world axes."""
    normal, ends = flat.at(t)
    turn = extended(rotation)
    return unit(inverse_transposed(turn) @ normal), ends @ turn.T


def _across(normal: Array) -> Array:
    """Return two unit vectors (2, 3) perpendicular to a unit vector."""
    least = np.zeros(3)
    least[np.abs(normal).argmin()] = 1.0
    first = unit(np.cross(normal, least))
    return np.stack([first, np.cross(normal, first)])


Residual = Callable[[Array], Array]


def _solve(residual: Residual, size: int) -> tuple[Array, Array]:
    """Apply Newton's method from 0 in ``size`` unknowns; return solution and last matrix."""
    unknown = extended(np.zeros(size))
    matrix = np.zeros((size, size))
    for _ in range(NEWTON_STEPS):
        here = residual(unknown)
        steps = STEP * np.eye(size, dtype=np.longdouble)
        sides = [(residual(unknown + s), residual(unknown - s)) for s in steps]
        matrix = np.stack([(ahead - behind) / (2 * STEP) for ahead, behind in sides], axis=1)
        # the matrix may be in float64, but not the residual
        scale = float(np.abs(here).max()) or 1.0
        change = np.linalg.solve(matrix.astype(float), (here / scale).astype(float))
        unknown = unknown - scale * change
    return unknown, matrix.astype(float)


def _between_points(s: Setting, normal: Array) -> tuple[Array, Array, Array, float]:
    """Two single support points: n has two degrees of freedom."""
    offset = extended(s.pose_b[1]) - s.pose_a[1]
    across = _across(normal)

    def points(turn: Array) -> tuple[Array, Array, Array]:
        n = unit(normal + turn @ across)
        return n, _arm(s.a, s.pose_a[0], n), offset + _arm(s.b, s.pose_b[0], -n)

    def residual(turn: Array) -> Array:
        n, x, y = points(turn)
        gap = n @ (y - x)
        return np.asarray(across @ (gap * n - (y - x)))

    turn, matrix = _solve(residual, 2)
    n, x, y = points(turn)
    least = float(np.linalg.eigvalsh((matrix + matrix.T) / 2)[0])
    return n, x, y, least


def _at_flat(s: Setting) -> tuple[Array, Array, Array, float]:
    """A flat of A and a single point of B: n is fixed on a face, and turns about a line."""
    assert s.flat_a is not None
    flat = s.flat_a
    offset = extended(s.pose_b[1]) - s.pose_a[1]

    def points(turn: Array) -> tuple[Array, Array, Array]:
        n, ends = _frame(flat, s.pose_a[0], flat.start + turn[0])
        return n, ends, offset + _arm(s.b, s.pose_b[0], -n)

    def sideways(turn: Array) -> Array:
        n, ends, y = points(turn)
        beside = unit(np.cross(n, ends[1] - ends[0]))
        return np.atleast_1d(beside @ (y - ends[0]))

    turn, least = extended([0.0]), np.inf
    if flat.turns:
        turn, matrix = _solve(sideways, 1)
        moved = _frame(flat, s.pose_a[0], flat.start + turn[0] + STEP)[0]
        n, ends = _frame(flat, s.pose_a[0], flat.start + turn[0])
        # by the angle of n instead of the parameter, and with the sense of rotation
        beside = unit(np.cross(n, ends[1] - ends[0]))
        least = float(-matrix[0, 0] * STEP / (beside @ (moved - n)))
    n, ends, y = points(turn)
    return n, y - (n @ (y - ends[0])) * n, y, least


def _crossing(s: Setting) -> tuple[Array, Array, Array, float]:
    """Two lines: n is perpendicular to both, wherever the bodies are."""
    assert s.flat_a is not None
    assert s.flat_b is not None
    flat_a, flat_b = s.flat_a, s.flat_b

    def frames(turns: Array) -> tuple[Array, Array, Array, Array]:
        n, ends_a = _frame(flat_a, s.pose_a[0], flat_a.start + turns[0])
        m, ends_b = _frame(flat_b, s.pose_b[0], flat_b.start + turns[1])
        return n, m, ends_a, ends_b

    across = _across(frames(extended([0, 0]))[0])
    turns, _ = _solve(lambda t: np.asarray(across @ np.add(*frames(t)[:2])), 2)
    n, _, ends_a, ends_b = frames(turns)
    ends_b = ends_b + (extended(s.pose_b[1]) - s.pose_a[1])
    along_a, along_b = ends_a[1] - ends_a[0], ends_b[1] - ends_b[0]
    start = ends_b[0] - ends_a[0]
    # where the lines are nearest to each other: y - x has no component along either
    x = ends_a[0] + along_a * (np.cross(start, along_b) @ n) / (np.cross(along_a, along_b) @ n)
    return n, x, x + (n @ start) * n, np.inf


def solve_truth(setting: Setting, normal: Array) -> Truth:
    """Return the truth at rounded poses, near the normal with which they were constructed."""
    flats = (setting.flat_a, setting.flat_b)
    if flats[0] is not None and flats[1] is not None:
        n, x, y, stiffness = _crossing(setting)
    elif flats[0] is not None:
        n, x, y, stiffness = _at_flat(setting)
    elif flats[1] is not None:
        s = setting
        swapped = Setting(s.b, s.a, s.pose_b, s.pose_a, s.flat_b, s.flat_a)
        n, y, x, stiffness = _at_flat(swapped)
        between = extended(s.pose_b[1]) - s.pose_a[1]
        n, x, y = -n, x + between, y + between
    else:
        n, x, y, stiffness = _between_points(setting, normal)
    origin = extended(setting.pose_a[1])
    return Truth(
        setting.pose_a,
        setting.pose_b,
        float(n @ (y - x)),
        (x + origin).astype(float),
        (y + origin).astype(float),
        n.astype(float),
        ", ".join(_word(flat) for flat in flats),
        stiffness,
    )


def _word(flat: Flat | None) -> str:
    if flat is None:
        return "point"
    return "line" if flat.turns else "face"


def _turn_onto(first: Array, second: Array, rng: np.random.Generator) -> Array:
    """Return a rotation that takes one unit vector to another, with a random spin about it."""
    spin = rng.uniform(0, 2 * np.pi)
    axes = [np.column_stack([n, *_across(n)]) for n in (first, second)]
    c, s = np.cos(spin), np.sin(spin)
    about = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    return np.asarray(axes[1] @ about @ axes[0].T)


def _weighted(ends: Array, rng: np.random.Generator) -> Array:
    share = extended(rng.uniform(*WITHIN, len(ends)))
    return np.asarray((share / share.sum()) @ ends)


def _choose_flats(
    a: Solid, b: Solid, rng: np.random.Generator
) -> tuple[Flat | None, Flat | None] | None:
    """Draw which flats take part; None if the draw has no unique witnesses."""
    pick: list[Flat | None] = []
    for solid in (a, b):
        flats = solid.support.flats(rng)
        must = not solid.bounded
        meets = bool(flats) and (must or rng.random() < 0.5)
        pick.append(flats[int(rng.integers(len(flats)))] if meets else None)
    first, second = pick
    if first is not None and second is not None and not (first.turns and second.turns):
        return None
    return first, second


def draw_truth(
    a: Solid, b: Solid, gap: float, position: Array, rng: np.random.Generator
) -> Truth | None:
    """Return a random exact pair; None if the draw has no unique witness points.

    Parameters
    ----------
    gap : signed, length.
    position : (3,), of A's origin.
    """
    flats = _choose_flats(a, b, rng)
    if flats is None:
        return None
    rotation_a, rotation_b = random_rotation(rng), random_rotation(rng)
    ends: list[Array | None] = [None, None]
    n = unit(extended(rng.normal(size=3)))
    if flats[0] is not None:
        n, ends[0] = _frame(flats[0], rotation_a, flats[0].start)
    if flats[1] is not None:
        if flats[0] is not None:
            inner = flats[1].at(flats[1].start)[0]
            rotation_b = _turn_onto(inner.astype(float), -n.astype(float), rng)
        opposite, ends[1] = _frame(flats[1], rotation_b, flats[1].start)
        n = -opposite if flats[0] is None else n
    if ends[0] is not None and ends[1] is not None:
        first, second = (unit(e[1] - e[0]) for e in (ends[0], ends[1]))
        if float(np.linalg.norm(np.cross(first, second).astype(float))) < CROSSING:
            return None
    x = _arm(a, rotation_a, n) if ends[0] is None else _weighted(ends[0], rng)
    y = _arm(b, rotation_b, -n) if ends[1] is None else _weighted(ends[1], rng)
    position_b = (position + x + extended(gap) * n - y).astype(float)
    setting = Setting(a, b, (rotation_a, position), (rotation_b, position_b), *flats)
    return solve_truth(setting, n)


def support_sum(a: Solid, b: Solid, truth: Truth, normals: Array) -> Array:
    """Return s(n) = h_A(n) + h_B(-n) (k,) along world directions (k, 3), float64."""
    (turn_a, p_a), (turn_b, p_b) = truth.pose_a, truth.pose_b
    height_a = a.support.heights(normals @ turn_a)
    height_b = b.support.heights(-normals @ turn_b)
    return np.asarray(height_a + height_b - normals @ (p_b - p_a))


def difference_points(a: Solid, b: Solid, truth: Truth, normals: Array) -> Array:
    """Return the points (k, 3) of A - B that are farthest along world directions."""
    (turn_a, p_a), (turn_b, p_b) = truth.pose_a, truth.pose_b
    points_a = a.support.points(normals @ turn_a) @ turn_a.T
    points_b = b.support.points(-normals @ turn_b) @ turn_b.T
    return np.asarray(points_a - points_b - (p_b - p_a))
