"""Pairs that slide and oscillate in contact, with the truth by construction.

A is at rest in the world's frame. At every instant B is put where its support point along the
opposite of a normal n is the point x + gap n, x being A's along n: so the distance is the gap, and
n the normal, whatever the motion.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import standoff as so

Array = NDArray[np.float64]

DIFFERENCE = 1e-5
"""Half the time, s, over which velocities are differences of positions: good to 1e-9."""
TILTS = (1e-12, 1e-9, 1e-6, 1e-3)
"""Amplitudes, rad, of tilts through parallel."""


@dataclass(frozen=True)
class Frames:
    """Where B is at some instants, and the truth.

    Attributes
    ----------
    rotations, positions : (n, 3, 3) and (n, 3) arrays, B's poses.
    normals : (n, 3) array.
    points : (n, 3) array, the witness point on A; where it is not unique one of the set.
    """

    rotations: Array
    positions: Array
    normals: Array
    points: Array


Gap = Callable[[Array], Array]
Outside = Callable[[Frames, Array], Array]


@dataclass(frozen=True)
class Scene:
    """Two bodies and how they touch.

    Attributes
    ----------
    frames : of times [s] and the gaps there [length].
    outside : of frames and A's witness points, how far each is outside of the set, length; None
        where the witness points are unique.
    jumps : the witness points may jump, because the answer does.
    """

    name: str
    a: so.Body = field(repr=False)
    b: so.Body = field(repr=False)
    frames: Callable[[Array, Array], Frames] = field(repr=False)
    outside: Outside | None = field(default=None, repr=False)
    jumps: bool = False

    @property
    def size(self) -> float:
        return sum(body.size for body in (self.a, self.b))

    def motion(self, times: Array, gap: Gap) -> tuple[Frames, Array]:
        """Frames at some times, and B's twists (n, 6) there."""
        here = self.frames(times, gap(times))
        before, after = (self.frames(t, gap(t)) for t in (times - DIFFERENCE, times + DIFFERENCE))
        v = (after.positions - before.positions) / (2 * DIFFERENCE)
        turn = after.rotations @ before.rotations.transpose(0, 2, 1)
        skew = (turn - turn.transpose(0, 2, 1)) / (4 * DIFFERENCE)
        omega = np.stack([skew[:, 2, 1], skew[:, 0, 2], skew[:, 1, 0]], axis=1)
        return here, np.hstack([v, omega])


def turned(axes: str, *angles: Array) -> Array:
    """(n, 3, 3) rotations about intrinsic axes."""
    return np.asarray(Rotation.from_euler(axes, np.stack(angles, axis=1)).as_matrix())


def stacked(x: Array, y: Array, z: Array) -> Array:
    return np.stack(np.broadcast_arrays(x, y, z), axis=1)


def applied(rotations: Array, points: Array) -> Array:
    return np.asarray(
        np.einsum("nij,nj->ni", rotations, np.broadcast_to(points, (len(rotations), 3)))
    )


def touching(rotations: Array, x: Array, y: Array, n: Array, gap: Array) -> Frames:
    """B at some rotations, so that its point y (body frame) is at x + gap n."""
    return Frames(rotations, x + gap[:, None] * n - applied(rotations, y), n, x)


def path(t: Array, reach: float = 2.0) -> tuple[Array, Array]:
    """Where on the floor: about 1 m/s, never the same way twice."""
    return reach * np.sin(0.5 * t), reach * np.sin(0.37 * t + 1.0)


TOP = 0.5
FLOOR = so.shapes.box(10, 10, 1)
BOX = so.shapes.box(1, 0.8, 0.6)
UP = np.array([0.0, 0.0, 1.0])


def on_floor(t: Array) -> tuple[Array, Array]:
    """(points of the floor under the path, normals)."""
    return stacked(*path(t), TOP), np.broadcast_to(UP, (len(t), 3))


def ellipsoid_support(axes: Array, n: Array) -> Array:
    return axes**2 * n / np.linalg.norm(axes * n, axis=1)[:, None]


AXES_A, AXES_B = np.array([0.9, 0.6, 0.7]), np.array([0.3, 0.5, 0.4])


def ellipsoid_on_ellipsoid(t: Array, gap: Array) -> Frames:
    n = stacked(
        np.cos(0.7 * t) * np.cos(0.4 * t), np.sin(0.7 * t) * np.cos(0.4 * t), np.sin(0.4 * t)
    )
    R = turned("ZYX", 0.9 * t, 0.5 * np.sin(t), 0.3 * t)
    y = ellipsoid_support(AXES_B, -applied(R.transpose(0, 2, 1), n))
    return touching(R, ellipsoid_support(AXES_A, n), y, n, gap)


def ellipsoid_on_floor(t: Array, gap: Array) -> Frames:
    x, n = on_floor(t)
    R = turned("ZYX", 0.9 * t, 0.5 * np.sin(t), 0.3 * t)
    return touching(R, x, ellipsoid_support(AXES_B, -applied(R.transpose(0, 2, 1), n)), n, gap)


def vertex_on_floor(t: Array, gap: Array) -> Frames:
    x, n = on_floor(t)
    # the box's diagonal upright, then rocked by less than its faces allow
    upright = Rotation.align_vectors([UP], [[0.5, 0.4, 0.3]])[0].as_matrix()
    R = turned("ZYX", 0.9 * t, 0.2 * np.sin(t), 0.2 * np.sin(1.3 * t)) @ upright
    return touching(R, x, np.array([-0.5, -0.4, -0.3]), n, gap)


RIDGE = so.shapes.polytope(
    [[x, y, -abs(y)] for x in (-3, 3) for y in (-1, 0, 1)] + [[0, 0, -3], [1, 0, -3]]
)
KEEL = so.shapes.polytope(
    [[x, y, abs(y)] for x in (-3, 3) for y in (-1, 0, 1)] + [[0, 0, 3], [1, 0, 3]]
)


def edge_on_edge(t: Array, gap: Array) -> Frames:
    """A's ridge along x, B's keel across it."""
    R = turned("ZYX", np.pi / 2 + 0.7 * np.sin(0.8 * t), 0.2 * np.sin(t), 0.3 * np.sin(1.3 * t))
    n = np.cross(stacked(np.ones_like(t), 0 * t, 0 * t), R[:, :, 0])
    n = n / np.linalg.norm(n, axis=1)[:, None]
    zero = np.zeros_like(t)
    x = stacked(2 * np.sin(0.5 * t), zero, zero)
    return touching(R, x, stacked(1.5 * np.sin(0.37 * t + 1.0), zero, zero), n, gap)


def face_on_floor(t: Array, gap: Array) -> Frames:
    """Over the floor's rim and back, turning."""
    x, n = stacked(*path(t, 4.9), TOP), np.broadcast_to(UP, (len(t), 3))
    return touching(turned("Z", 0.3 * t), x, np.array([0, 0, -0.3]), n, gap)


def outside_of_faces(frames: Frames, points: Array) -> Array:
    inner = applied(frames.rotations.transpose(0, 2, 1), points - frames.positions)
    over_box = np.abs(inner[:, :2]) - [0.5, 0.4]
    over_floor = np.abs(points[:, :2]) - 5.0
    return np.asarray(np.hstack([over_box, over_floor]).max(axis=1))


def lying(t: Array, gap: Array) -> Frames:
    """A rolling, turning cylinder."""
    x, n = stacked(*path(t, 4.9), TOP), np.broadcast_to(UP, (len(t), 3))
    heading, roll = 0.3 * t, 2.0 * t
    R = turned("ZXZ", heading, np.full_like(t, np.pi / 2), roll)
    y = applied(R.transpose(0, 2, 1), np.array([0, 0, -0.3]))
    return touching(R, x, y, n, gap)


def outside_of_ruling(frames: Frames, points: Array) -> Array:
    axis = frames.rotations[:, :, 2]
    step = points - frames.points
    along = (step * axis).sum(axis=1)
    across = np.linalg.norm(step - along[:, None] * axis, axis=1)
    over_floor = (np.abs(points[:, :2]) - 5.0).max(axis=1)
    return np.maximum(np.maximum(np.abs(along) - 0.5, across), over_floor)


def standing(t: Array, gap: Array) -> Frames:
    """A disc on the floor, over its rim and back, turning."""
    x, n = stacked(*path(t, 4.9), TOP), np.broadcast_to(UP, (len(t), 3))
    return touching(turned("Z", 0.3 * t), x, np.array([0, 0, -0.5]), n, gap)


def outside_of_disc(frames: Frames, points: Array) -> Array:
    over_disc = np.linalg.norm(points - frames.points, axis=1) - 0.3
    return np.maximum(over_disc, (np.abs(points[:, :2]) - 5.0).max(axis=1))


def parallel_capsules(t: Array, gap: Array) -> Frames:
    """B goes around A and slides along it."""
    n = stacked(np.cos(0.7 * t), np.sin(0.7 * t), 0 * t)
    R = turned("Z", 0.9 * t)
    x = 0.2 * n + stacked(0 * t, 0 * t, 1.1 * np.sin(0.5 * t))
    return touching(R, x, -0.3 * applied(R.transpose(0, 2, 1), n), n, gap)


def outside_of_segments(frames: Frames, points: Array) -> Array:
    across = np.linalg.norm(points[:, :2] - frames.points[:, :2], axis=1)
    over_a, over_b = np.abs(points[:, 2]) - 0.75, np.abs(points[:, 2] - frames.points[:, 2]) - 0.4
    return np.maximum(np.maximum(over_a, over_b), across)


def tilting_box(amplitude: float) -> Callable[[Array, Array], Frames]:
    def frames(t: Array, gap: Array) -> Frames:
        x, n = on_floor(t)
        angle = amplitude * np.sin(7.0 * t)
        R = turned("ZY", 0.3 * t, angle)
        y = stacked(0.5 * np.sign(angle), 0 * t, np.full_like(t, -0.3))
        return touching(R, x, y, n, gap)

    return frames


def tilting_cylinder(amplitude: float) -> Callable[[Array, Array], Frames]:
    def frames(t: Array, gap: Array) -> Frames:
        x, n = on_floor(t)
        angle = amplitude * np.sin(7.0 * t)
        R = turned("ZX", 0.3 * t, np.pi / 2 + angle)
        # the axis is R e_z; the lower end is where it points down
        down = applied(R.transpose(0, 2, 1), -n)
        radial = down * [1, 1, 0] / np.linalg.norm(down[:, :2], axis=1)[:, None]
        y = 0.3 * radial + stacked(0 * t, 0 * t, 0.5 * np.sign(down[:, 2]))
        return touching(R, x, y, n, gap)

    return frames


CYLINDER = so.shapes.cylinder(0.3, 1)
SCENES = [
    Scene(
        "ellipsoid on ellipsoid",
        so.shapes.ellipsoid(*AXES_A),
        so.shapes.ellipsoid(*AXES_B),
        ellipsoid_on_ellipsoid,
    ),
    Scene("ellipsoid on face", FLOOR, so.shapes.ellipsoid(*AXES_B), ellipsoid_on_floor),
    Scene("vertex on face", FLOOR, BOX, vertex_on_floor),
    Scene("edge on edge", RIDGE, KEEL, edge_on_edge),
    Scene("face on face", FLOOR, BOX, face_on_floor, outside_of_faces),
    Scene("cylinder lying on face", FLOOR, CYLINDER, lying, outside_of_ruling),
    Scene("disc on face", FLOOR, CYLINDER, standing, outside_of_disc),
    Scene(
        "capsules parallel",
        so.shapes.capsule(0.2, 1.5),
        so.shapes.capsule(0.3, 0.8),
        parallel_capsules,
        outside_of_segments,
    ),
    *(Scene(f"box tilting by {x:g}", FLOOR, BOX, tilting_box(x), None, True) for x in TILTS),
    *(
        Scene(f"cylinder tilting by {x:g}", FLOOR, CYLINDER, tilting_cylinder(x), None, True)
        for x in TILTS
    ),
]
GAPS = (1e-2, 1e-6, 0.0, -1e-6, -1e-2)
"""Of constant gaps while sliding, over the lesser body's size."""
SWING = 1e-2
"""Amplitude of the oscillation through contact, over the lesser body's size."""


def constant(gap: float) -> Gap:
    return lambda t: np.full_like(t, gap)


def oscillating(amplitude: float) -> Gap:
    return lambda t: amplitude * np.sin(11.0 * t)


def gaps_of(scene: Scene) -> list[tuple[str, Gap]]:
    """The gaps that a scene is run with: constant ones, and one that swings through contact."""
    size = min(scene.a.size, scene.b.size)
    swing = ("oscillating", oscillating(SWING * size))
    return [(f"{g:+.0e}" if g else "0", constant(g * size)) for g in GAPS] + [swing]
