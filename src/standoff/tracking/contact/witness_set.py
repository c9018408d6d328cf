"""Are the witness points unique? If not, the set of all pairs that are equally near."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from standoff.bodies.body import Body
from standoff.bodies.support_sets import support_set
from standoff.bodies.tolerances import HEIGHT_ROUNDINGS, LEVEL
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.geometry.flat_sets import FlatSet, shared
from standoff.kernels.body import layout as L
from standoff.kernels.entries import derivatives as kernels
from standoff.kernels.tolerances import AROUND, SAME_WIDTH, TOUCHING_CORES
from standoff.motion import Pose, PoseLike
from standoff.read_only import KeepsReadOnly
from standoff.tracking.inputs import flat_pose
from standoff.tracking.reached import packed
from standoff.tracking.rows import Answer, motion_row
from standoff.tracking.support import support_point
from standoff.tracking.tolerances import LEAST_EXTENT, LEAST_WIDTH_ANGLE, LINE_RANK, LOOSENESS
from standoff.typing import Array

# How many normals a pair that touches or overlaps has: one, a curve of them, or a region.

DIRECTIONS = 24
"""Directions around the normal that are tried first."""

WORTH_A_SEARCH = 0.2
"""A least width among the directions is searched between them if it is below this part of the
greatest: between two of 24 a width that grows linearly from zero is at most 0.13 of it."""


def normal_dimension(a: Body, b: Body, pose_a: Pose, pose_b: Pose, normal: Array) -> int:
    """The dimension of the set of normals, near one, along which the overlap is as thin.

    Parameters
    ----------
    normal : (3,) array
        Unit vector from A to B, world, along which the overlap has a least width.

    Returns
    -------
    int
        0: this normal only; 1: a curve of normals, such as a circle; 2: a region of the sphere.
    """
    if not (a.bounded and b.bounded):
        return 0
    size = float(a.reals[L.SIZE] + b.reals[L.SIZE]) + a.radius + b.radius
    excess = _excess(a, b, pose_a, pose_b, normal)
    if a.dimension == 2 or b.dimension == 2:
        return int(min(excess(1.0, 0.0), excess(-1.0, 0.0)) <= SAME_WIDTH * size)

    def around(angle: float) -> float:
        return excess(float(np.cos(angle)), float(np.sin(angle)))

    angles = 2.0 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    found = np.array([around(t) for t in angles])
    low = found <= SAME_WIDTH * size
    if (low & np.roll(low, 1)).any():
        return 2
    if low.any():
        return 1
    step = angles[1]
    for k in np.flatnonzero((found <= np.roll(found, 1)) & (found <= np.roll(found, -1))):
        if found[k] < WORTH_A_SEARCH * found.max():
            bounds = (angles[k] - step, angles[k] + step)
            least = scipy.optimize.minimize_scalar(
                around, bounds=bounds, method="bounded", options={"xatol": LEAST_WIDTH_ANGLE}
            )
            if least.fun <= SAME_WIDTH * size:
                return 1
    return 0


def _excess(
    a: Body, b: Body, pose_a: Pose, pose_b: Pose, normal: Array
) -> Callable[[float, float], float]:
    """How much wider the overlap is along a normal turned by AROUND, by the turn's direction."""
    first = np.cross(normal, np.eye(3)[int(np.abs(normal).argmin())])
    if a.dimension == 2 or b.dimension == 2:
        first = np.cross([0.0, 0.0, 1.0], normal)
    first = first / np.linalg.norm(first)
    second = np.cross(normal, first)
    shift = pose_b.translation - pose_a.translation

    def width(n: Array) -> float:
        x = pose_a.rotation @ _highest(a, pose_a.rotation.T @ n)
        y = pose_b.rotation @ _highest(b, -(pose_b.rotation.T @ n))
        return float((x - y - shift) @ n)

    own = width(normal)

    def excess(cosine: float, sine: float) -> float:
        aside = cosine * first + (sine * second if sine else 0.0)
        return width(np.cos(AROUND) * normal + np.sin(AROUND) * aside) - own

    return excess


def _highest(body: Body, direction: Array) -> Array:
    """The farthest point of a core along a direction, body frame."""
    if not (body.face_parts or body.edge_parts):
        return np.asarray(body.vertex_points[0])
    return support_point(body, direction)


@dataclass(frozen=True, eq=False)
class WitnessSet(KeepsReadOnly):
    """All pairs of points that are as far apart as the distance says, world axes.

    Attributes
    ----------
    dimension : int
        0: the witness points are unique; 1: the pairs fill a segment; 2: an area.
    normal_dimension : int
        0: the normal is unique; 1: one of a curve of normals (coaxial capsules: a circle); 2: any
        of a region (concentric spheres: all; corner on corner: a cone). Only bodies that touch or
        overlap can have more than one.
    points_a, points_b : (n, 3) arrays
        The set's extreme points on A and on B, pair by pair: one, the two ends, or the corners in
        order around the normal. Where an arc bounds it, points along the arc.
    normal : (3,) array
        Unit vector from A to B that the set belongs to.
    normals : (k, 3) array
        That normal and, in overlap, others along which the bodies are as deep in each other: two
        for an ellipsoid about the centre of another, six for a cube in the middle of a cube. Found
        by descents from 53 directions, so a narrow one may be missed; not searched for if
        ``normal_dimension`` is not 0.
    residual : float
        Greatest length of point_b - point_a - distance * normal over the pairs: large if the answer
        was not an optimum.
    """

    dimension: int
    normal_dimension: int
    points_a: Array
    points_b: Array
    normal: Array
    normals: Array
    residual: float

    @property
    def unique(self) -> bool:
        """Are the witness points and the normal the only ones?"""
        return self.dimension == self.normal_dimension == 0 and len(self.normals) == 1

    def __repr__(self) -> str:
        kind = ("a point", "a segment", "an area")[self.dimension]
        others = f", {len(self.normals)} normals" if len(self.normals) > 1 else ""
        return f"WitnessSet({kind}, normal_dimension={self.normal_dimension}{others})"


def witness_set(
    proximity: Answer, pose_a: PoseLike | None = None, pose_b: PoseLike | None = None
) -> WitnessSet:
    """The set of all pairs of witness points that an answer could have given.

    Raises TypeError: no answer. Raises ValueError: the answer has no distance; only one pose is
    given.

    Parameters
    ----------
    proximity : Proximity
        A converged answer, apart or overlapping.
    pose_a, pose_b : Pose or what ``Pose.of`` reads, optional
        World poses for which it holds; those that the answer keeps if not given.

    Returns
    -------
    WitnessSet

    Notes
    -----
    The set is {(x, y): y - x = distance * normal}, x where A, and y where B, touches its
    supporting plane along the normal: the overlap of two flat sets seen along it. What is
    parallel to 1e-9 rad counts as parallel. Along the other ``normals`` there are other sets.
    """
    given: Any = proximity
    if not isinstance(given, Answer):
        raise StandoffTypeError(
            f"{shown(given)} is not an answer: give one of so.distance or a Tracker.",
            "proximity",
            given,
        )
    first, second = poses_of(proximity, pose_a, pose_b)
    if not np.isfinite(proximity.distance):
        raise StandoffError(
            f"The answer has no distance (status {proximity.status.name}), so no witness points.",
            "proximity",
            proximity,
        )
    several, normals = _normals(proximity, first, second)
    across, points_a, points_b = serving_pairs(proximity, first, second)
    n = proximity.normal
    off = points_b - points_a - proximity.distance * n
    residual = float(np.linalg.norm(off, axis=1).max())
    return WitnessSet(across, several, points_a, points_b, n, normals, residual)


def serving_pairs(proximity: Answer, first: Pose, second: Pose) -> tuple[int, Array, Array]:
    """(dimension, points on A, points on B) of the set that belongs to the answer's own normal."""
    a, b = proximity.bodies
    n = proximity.normal
    x, y = proximity.point_a, proximity.point_b
    origin = first.translation
    sides = [
        _side(a, first, n, x - a.radius * n, origin),
        _side(b, second, -n, y + b.radius * n, origin),
    ]
    across, on_a, on_b = _overlap(proximity, sides, first, second)
    return across, on_a + origin + a.radius * n, on_b + origin - b.radius * n


def _normals(proximity: Answer, first: Pose, second: Pose) -> tuple[int, Array]:
    """Of how many dimensions the normals are, and, where each stands alone, all of them."""
    a, b = proximity.bodies
    n, distance = proximity.normal, proximity.distance
    size_a, size_b = (float(body.reals[L.SIZE]) for body in (a, b))
    span = size_a + size_b + abs(distance) + a.radius + b.radius
    if distance + a.radius + b.radius > TOUCHING_CORES * span:
        return 0, n[None]
    several = normal_dimension(a, b, first, second, n)
    return several, n[None] if several else equal_normals(a, b, first, second, n, distance)


def poses_of(
    proximity: Answer, pose_a: PoseLike | None = None, pose_b: PoseLike | None = None
) -> tuple[Pose, Pose]:
    """The poses that an answer holds for: those given, or those that it keeps."""
    if pose_a is not None and pose_b is not None:
        return Pose.of(pose_a), Pose.of(pose_b)
    kept = getattr(proximity, "poses", None)
    if pose_a is not None or pose_b is not None or kept is None:
        raise StandoffError("Give both poses that the answer holds for.")
    first, second = (
        Pose.from_checked(np.reshape(flat[:9], (3, 3)), np.array(flat[9:])) for flat in kept
    )
    return first, second


def _side(body: Body, pose: Pose, along: Array, witness: Array, origin: Array) -> Array | None:
    """Points of a core's flat set along a direction, world axes from `origin`; None: its plane."""
    if not body.bounded:
        return None
    inner = pose.rotation.T @ (witness - pose.translation)
    points = support_set(body, pose.rotation.T @ along, inner)
    return np.asarray(points @ pose.rotation.T + (pose.translation - origin))


def _overlap(
    proximity: Answer, sides: list[Array | None], pose_a: Pose, pose_b: Pose
) -> tuple[int, Array, Array]:
    """(dimension, points on A's core, points on B's), both in world axes from A's origin."""
    a, b = proximity.bodies
    n, origin = proximity.normal, pose_a.translation
    x = proximity.point_a - origin - a.radius * n
    y = proximity.point_b - origin + b.radius * n
    sizes = [float(body.reals[L.SIZE]) for body in (a, b) if body.bounded]
    reach = sum(sizes) + float(np.linalg.norm(pose_b.translation - origin))
    off = (y - x) - ((y - x) @ n) * n
    loose = LOOSENESS * float(np.linalg.norm(off))
    rounding = HEIGHT_ROUNDINGS * np.finfo(float).eps * (reach + float(np.linalg.norm(origin)))
    tolerance = max(LEVEL * min(sizes), 1e2 * rounding) + loose
    least = max(LEAST_EXTENT * min(sizes), 10.0 * tolerance)
    frame = _frame(n, a.dimension == 2 or b.dimension == 2)
    # seen along the line of the witness points both sets lie over each other
    seen = [None if s is None else (s - w) @ frame for s, w in zip(sides, (x, y), strict=True)]
    flat = [None if s is None else FlatSet.of(s, least) for s in seen]
    flat = [f if f is None or f.dimension else FlatSet(0, np.zeros((1, 2))) for f in flat]
    first, second = flat
    if first is None or second is None:
        found = first if second is None else second
    else:
        found = shared(first, second, tolerance, least)
    if found is None or found.dimension == 0:
        return 0, x[None], y[None]
    lifted = [
        w + _lifted(found.corners, side, points, frame, n, w)
        for side, points, w in zip(sides, seen, (x, y), strict=True)
    ]
    return found.dimension, lifted[0], lifted[1]


def _frame(n: Array, planar: bool) -> Array:
    """(3, 2): two unit vectors square to the normal and to each other, right-handed with it."""
    axis = np.array([0.0, 0.0, 1.0]) if planar else np.eye(3)[int(np.abs(n).argmin())]
    first = np.cross(axis, n)
    first = first / np.linalg.norm(first)
    return np.column_stack([first, np.cross(n, first)])


def _lifted(
    corners: Array, side: Array | None, seen: Array | None, frame: Array, n: Array, witness: Array
) -> Array:
    """Corners put back on a set: its own plane or line may be tilted by LEVEL against n."""
    flat = np.asarray(corners @ frame.T)
    if side is None or seen is None:
        return flat
    heights = (side - witness) @ n
    slope = np.linalg.lstsq(seen, heights, rcond=LINE_RANK)[0]
    return np.asarray(flat + np.outer(corners @ slope, n))


__all__ = ["WitnessSet", "witness_set"]


# Other directions in which an overlap is as thin: a ball in the middle of a slab has two.


def equal_normals(
    a: Body, b: Body, pose_a: Pose, pose_b: Pose, normal: Array, distance: float
) -> Array:
    """All normals found along which two overlapping bodies are as deep in each other.

    Parameters
    ----------
    normal, distance
        Of the answer: unit vector from A to B, world, and the signed distance, a length.

    Returns
    -------
    (k, 3) array
        Unit vectors, world, the answer's own first. Each is a local minimum of the depth within
        SAME_WIDTH of the size; they are apart by more than AROUND.
    """
    found = np.empty((kernels.N_NORMALS, 3))
    turn = pose_a.rotation
    own = tuple((turn.T @ normal).tolist())
    motion = motion_row(flat_pose(pose_a), flat_pose(pose_b))
    depth = distance + a.radius + b.radius
    count = kernels.equal_depths(packed(a, b), motion, own, depth, found)
    return np.vstack([normal, found[1:count] @ turn.T])
