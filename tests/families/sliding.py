"""Bodies that slide and roll on each other at a signed distance which is known in every frame.

A contact path is a point x(t) of A and a normal n(t) of A there, both in A's frame; B, which is
strictly convex, turns as it likes and is placed at ``p_B = x + g n - R_B s_B(-n)``. So the signed
distance is g exactly, positive or negative, while the normal and both points roll.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import standoff as so
from families.shapes import Twin
from oracles.bounds import pair_size
from standoff.geometry import ellipsoid_patches
from standoff_studies import oracles as oracle
from standoff_studies.oracles import Affine, Placed, Shape, Superellipsoid, unit

Array = NDArray[np.float64]
Path = Callable[[Array], tuple[Array, Array]]
"""Points (k, 3) and unit normals (k, 3) of A in its frame, at times (k,)."""

STEP = 1e-3
"""Frame time, s."""
GAPS = (1e-2, 1e-4, 1e-6, 0.0, -1e-6, -1e-4, -1e-2)
"""Signed distances that stay constant, lengths; the bodies are about 1 long."""
DIFFERENCE = 1e-6
"""Half the time over which B's velocity is taken as a difference, s."""
SPIN_A, SPIN_B = np.array([0.3, -0.2, 0.5]), np.array([-0.4, 0.7, 0.2])
"""Angular velocities, rad/s, in world."""
TURNED = 1.0
"""Time that the bodies have turned before the first frame, s: no plane of theirs is shared."""
ORBIT = 0.5
"""How far A swings, a length."""


def rolling(shape: Shape) -> Path:
    """The support points of a strictly convex shape along a normal that rolls about 1 rad/s."""

    def at(t: Array) -> tuple[Array, Array]:
        up, around = 1.2 * np.sin(0.7 * t + 0.3), 0.8 * t + 0.4 * np.sin(1.1 * t)
        n = np.stack([np.cos(up) * np.cos(around), np.cos(up) * np.sin(around), np.sin(up)], 1)
        n = unit(n)
        return shape.points(n), n

    return at


def around_rectangle(t: Array, half: tuple[float, float]) -> tuple[Array, Array]:
    """Slide along a rectangle's sides and roll about its corners: points and normals (k, 2).

    It goes round once in 8 s: a second for each side, and for each corner.
    """
    u, w = half
    corners = np.array([(u, -w), (u, w), (-u, w), (-u, -w)])
    phase = np.mod(t, 8.0)
    part = np.minimum(phase.astype(int), 7)
    rest = (phase - part)[:, None]
    side = part // 2
    start, end = corners[side], corners[(side + 1) % 4]
    slide = part % 2 == 0
    points = np.where(slide[:, None], start + rest * (end - start), end)
    angle = (side + np.where(slide, 0.0, rest[:, 0])) * np.pi / 2
    return points, np.stack([np.cos(angle), np.sin(angle)], axis=1)


def around_box(lengths: tuple[float, float, float]) -> Path:
    """Round a box over four faces and the edges between them, swaying along the edges."""
    x, y, z = lengths

    def at(t: Array) -> tuple[Array, Array]:
        spot, normal = around_rectangle(t, (x / 2, z / 2))
        sway = 0.3 * y * np.sin(0.9 * t)
        return (
            np.stack([spot[:, 0], sway, spot[:, 1]], axis=1),
            np.stack([normal[:, 0], 0 * t, normal[:, 1]], axis=1),
        )

    return at


def around_cylinder(radius: float, length: float) -> Path:
    """Down the side, over the rims and across the discs, while the plane of the path turns."""

    def at(t: Array) -> tuple[Array, Array]:
        spot, normal = around_rectangle(t, (radius, length / 2))
        angle = 0.5 * t
        out = np.stack([np.cos(angle), np.sin(angle), 0 * t], axis=1)
        up = np.array([0.0, 0.0, 1.0])
        return spot[:, :1] * out + spot[:, 1:] * up, normal[:, :1] * out + normal[:, 1:] * up

    return at


@dataclass(frozen=True)
class Slide:
    """A pair, and the path of the contact on A. B is strictly convex."""

    a: Twin
    b: Twin
    path: Path

    @property
    def size(self) -> float:
        bodies = [Placed(x.shape, np.eye(3), np.zeros(3)) for x in (self.a, self.b)]
        return pair_size(*bodies)


@dataclass(frozen=True)
class Frames:
    """Poses (k, 12), twists (k, 6), and the truth: gaps (k,), points and normals (k, 3)."""

    poses_a: Array
    poses_b: Array
    twists_a: Array
    twists_b: Array
    gaps: Array
    points_a: Array
    points_b: Array
    normals: Array


Gap = Callable[[Array], Array]


def _placed(slide: Slide, gap: Gap, t: Array) -> tuple[Array, ...]:
    """Return R_A, p_A, R_B, p_B, x in world and n in world at times (k,)."""
    turn_a = Rotation.from_rotvec(np.outer(t + TURNED, SPIN_A)).as_matrix()
    turn_b = Rotation.from_rotvec(np.outer(t + TURNED, SPIN_B)).as_matrix()
    shift = ORBIT * np.stack([np.sin(0.6 * t), np.cos(0.4 * t), np.sin(0.3 * t + 1)], axis=1)
    x, n = slide.path(t)
    x, n = (np.einsum("kij,kj->ki", turn_a, rows) for rows in (x, n))
    inner = -np.einsum("kji,kj->ki", turn_b, n)
    arm = np.einsum("kij,kj->ki", turn_b, slide.b.shape.points(inner))
    reach = x + gap(t)[:, None] * n - arm
    return turn_a, shift, turn_b, shift + reach, shift + x, n


def frames(slide: Slide, gap: Gap, times: Array) -> Frames:
    """Return the frames at times (k,), with the bodies' velocities there."""
    turn_a, at_a, turn_b, at_b, points, normals = _placed(slide, gap, times)
    before, after = (_placed(slide, gap, times + s * DIFFERENCE) for s in (-1.0, 1.0))
    speeds = [(after[k] - before[k]) / (2 * DIFFERENCE) for k in (1, 3)]
    count = len(times)
    gaps = gap(times)
    return Frames(
        np.column_stack([turn_a.reshape(count, 9), at_a]),
        np.column_stack([turn_b.reshape(count, 9), at_b]),
        np.column_stack([speeds[0], np.tile(SPIN_A, (count, 1))]),
        np.column_stack([speeds[1], np.tile(SPIN_B, (count, 1))]),
        gaps,
        points,
        points + gaps[:, None] * normals,
        normals,
    )


def constant(gap: float) -> Gap:
    """Return the gap that stays."""
    return lambda t: np.full(len(t), gap)


def oscillating(amplitude: float, rate: float = 20.0) -> Gap:
    """Return a gap that swings through contact, ``rate`` rad/s."""
    return lambda t: amplitude * np.sin(rate * t)


def _twin(shape: Shape, body: so.Body) -> Twin:
    return Twin(shape, body)


def _ellipsoid(a: float, b: float, c: float) -> Twin:
    return _twin(oracle.Ellipsoid(a, b, c), so.shapes.ellipsoid(a, b, c))


def _superellipsoid(a: float, b: float, c: float, e1: float, e2: float) -> Twin:
    body = so.shapes.superellipsoid(a, b, c, e1, e2)
    return _twin(Superellipsoid(a, b, c, e1, e2), body)


def _nurbs(a: float, b: float, c: float) -> Twin:
    body = so.Body.from_patches(ellipsoid_patches(a, b, c))
    return _twin(Affine(oracle.Ellipsoid(1, 1, 1), np.diag([a, b, c])), body)


EGG = (0.4, 0.5, 0.3)


def make(name: str) -> Slide:
    """Return the pair of a name in ``PAIRS``."""
    ball = _ellipsoid(*EGG)
    if name == "ellipsoids":
        a = _ellipsoid(0.52, 0.9, 0.7)
        return Slide(a, ball, rolling(a.shape))
    if name == "superellipsoids":
        a = _superellipsoid(0.6, 0.8, 0.5, 0.9, 1.1)
        return Slide(a, _superellipsoid(0.4, 0.3, 0.5, 1.1, 0.9), rolling(a.shape))
    if name == "capsule-ellipsoid":
        a = Twin(oracle.Capsule(0.4, 0.8), so.shapes.capsule(0.4, 0.8))
        return Slide(a, ball, around_capsule(0.4, 0.8))
    if name == "NURBS ellipsoids":
        a = _nurbs(0.52, 0.9, 0.7)
        return Slide(a, _nurbs(*EGG), rolling(a.shape))
    if name == "box-ellipsoid":
        lengths = (0.8, 1.0, 1.2)
        a = Twin(oracle.SharpBox(*lengths), so.shapes.box(*lengths))
        return Slide(a, ball, around_box(lengths))
    if name == "cylinder-ellipsoid":
        a = Twin(oracle.Cylinder(0.5, 1.2), so.shapes.cylinder(0.5, 1.2))
        return Slide(a, ball, around_cylinder(0.5, 1.2))
    if name == "lens-ellipsoid":
        a = Twin(oracle.Lens(1.0, 0.45), so.shapes.lens(1.0, 0.45))
        return Slide(a, ball, rolling(a.shape))
    raise KeyError(f"no pair {name!r}: choose from {PAIRS}")


SMOOTH = ("ellipsoids", "superellipsoids", "capsule-ellipsoid", "NURBS ellipsoids")
SHARP = ("box-ellipsoid", "cylinder-ellipsoid", "lens-ellipsoid")
PAIRS = SMOOTH + SHARP


def around_capsule(radius: float, length: float) -> Path:
    """Along the side and over both ends, while the plane of the path turns."""

    def at(t: Array) -> tuple[Array, Array]:
        core, normal = around_rectangle(t, (0.0, length / 2))
        angle = 0.5 * t
        out = np.stack([np.cos(angle), np.sin(angle), 0 * t], axis=1)
        n = normal[:, :1] * out + normal[:, 1:] * np.array([0.0, 0.0, 1.0])
        return core[:, 1:] * np.array([0.0, 0.0, 1.0]) + radius * n, n

    return at
