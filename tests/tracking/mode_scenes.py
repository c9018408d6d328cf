"""Moving pairs whose active features are known by brute force, frame by frame."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import standoff as so
from oracles import closed_forms
from oracles.brute import Nearest, nearest_points, nearest_polytopes
from oracles.features import ON_SURFACE, Feature, feature_at
from oracles.loops import BezierCurve, PlanarLoop
from standoff.geometry import RationalBezier
from standoff.motion import ConstantTwist, Fixed, Helix, Path, Spiral
from standoff_studies.oracles import Box, Ellipsoid, Lens, Placed, Point, Polytope, Shape

Array = NDArray[np.float64]
Name = tuple[Any, ...]
"""A feature by geometry: its kind and the surfaces that meet there (and a tip's side)."""

FINE = 1e-3
"""Frame time of the brute force, s; the tracker's are multiples of it."""

LENS = Lens(1.0, 0.45)
PLANAR_CONTROL = (
    ((1, 0), (0.775, 0.645), (0.175, 1.005), (-0.5, 0.9)),
    ((-0.5, 0.9), (-0.87, 0.41), (-0.91, -0.27), (-0.6, -0.8)),
    ((-0.6, -0.8), (0.12, -1.04), (0.76, -0.72), (1, 0)),
)
PLANAR = PlanarLoop([BezierCurve(control) for control in PLANAR_CONTROL])
ROCK = Polytope(np.random.default_rng(7).normal(size=(14, 3)))


class Orbit:
    """A body that circles a point in a tilted plane and spins steadily about an axis of its own."""

    start, end = 0.0, np.inf

    def __init__(self, radius: float, rate: float, phase: float, spin: Any) -> None:
        self._circle = Helix(radius, 0.0, rate, axis=(1.0, -0.5, 0.15), phase=phase)
        self._spin = np.asarray(spin, dtype=float)

    def pose(self, t: float) -> so.Pose:
        turn = Rotation.from_rotvec(self._spin * t).as_matrix()
        return so.Pose(turn, self._circle.pose(t).translation)

    def twist(self, t: float) -> so.Twist:
        return so.Twist(self._circle.twist(t).v, self._spin)


def name_of(shape: Shape, feature: Feature, point: Array) -> Name:
    """Return the name of a feature at a body point; a lens's two tips differ by their side."""
    side = int(np.sign(point[2])) if feature.kind == "vertex" and isinstance(shape, Lens) else 0
    return feature.kind, feature.surfaces, side


def named_at(shape: Shape, point: Array) -> Name:
    return name_of(shape, feature_at(shape, point), point)


def _inner_point(body: so.Body, kind: str, index: int) -> Array:
    """Return a point inside a feature of the library's body, body frame."""
    if kind == "vertex":
        return np.asarray(body.vertex_points[index])
    if kind == "edge":
        curve = body.edge_parts[index].curve
        return np.asarray(curve.point(0.4 * curve.first + 0.6 * curve.last))
    face = body.face_parts[index]
    chart = face.charts[0]
    if type(chart).__name__ == "Plane":
        middles = [_inner_point(body, "edge", edge) for edge, _ in face.loop]
        return np.asarray(np.mean(middles, axis=0))
    return np.asarray(chart.jet(0.0, 0.0)[0])


def names_of_body(body: so.Body, shape: Shape) -> dict[str, Name]:
    """Return the geometric name of every feature of the library's body."""
    counts = {"face": body.n_faces, "edge": body.n_edges, "vertex": body.n_vertices}
    names = {
        f"{kind} {index}": named_at(shape, _inner_point(body, kind, index))
        for kind, count in counts.items()
        for index in range(count)
    }
    if len(set(names.values())) != len(names):
        raise ValueError(f"{body!r}: two features have one name")
    return names


Brute = Callable[[Placed, Placed, Nearest | None], Any]


@dataclass(frozen=True)
class Scene:
    """Two bodies, each as the library's and as an oracle's, on two paths."""

    body_a: so.Body
    body_b: so.Body
    shape_a: Shape
    shape_b: Shape
    path_a: Path
    path_b: Path
    duration: float
    brute: Brute

    @cached_property
    def names(self) -> tuple[dict[str, Name], dict[str, Name]]:
        return names_of_body(self.body_a, self.shape_a), names_of_body(self.body_b, self.shape_b)

    _truth: dict[int, list[tuple[Name, Name]]] = field(default_factory=dict, compare=False)

    def truth(self, stride: int) -> list[tuple[Name, Name]]:
        """The features by brute force in every so many-th fine frame."""
        if stride not in self._truth:
            self._truth[stride] = self._by_force(stride)
        return self._truth[stride]

    def _by_force(self, stride: int) -> list[tuple[Name, Name]]:
        rows, warm = [], None
        for k in range(0, round(self.duration / FINE) + 1, stride):
            poses = self.path_a.pose(k * FINE), self.path_b.pose(k * FINE)
            a = Placed(self.shape_a, poses[0].rotation, poses[0].translation)
            b = Placed(self.shape_b, poses[1].rotation, poses[1].translation)
            names, warm = self.brute(a, b, warm)
            rows.append(names)
        return rows


def of_points(a: Placed, b: Placed, found: Nearest) -> tuple[Name, Name]:
    return (
        name_of(a.shape, found.feature_a, a.local(found.point_a)),
        name_of(b.shape, found.feature_b, b.local(found.point_b)),
    )


def by_multipliers(a: Placed, b: Placed, warm: Nearest | None) -> Any:
    found = nearest_points(a, b, warm)
    return of_points(a, b, found), found


def by_enumeration(a: Placed, b: Placed, warm: Nearest | None) -> Any:
    del warm
    return of_points(a, b, nearest_polytopes(a, b)), None


NO_NAME: Name = ("vertex", frozenset(), 0)
"""Of a point's only feature."""


def lens_to_point(a: Placed, b: Placed, warm: Nearest | None) -> Any:
    del warm
    assert isinstance(a.shape, Lens)
    _, nearest = closed_forms.point_lens(a.local(b.position), a.shape)
    return (named_at(a.shape, nearest), NO_NAME), None


def loop_to_point(a: Placed, b: Placed, warm: Nearest | None) -> Any:
    """Feature of a loop nearest to a point: the best of many samples, then Newton's method."""
    del warm
    assert isinstance(a.shape, PlanarLoop)
    point = a.local(b.position)[:2]
    best, feet = np.inf, np.zeros(2)
    for curve in a.shape.curves:
        grid = np.linspace(*curve.span, 201)
        t = grid[((curve.jet(grid)[0] - point) ** 2).sum(axis=1).argmin()]
        for _ in range(20):
            c, velocity, bend = (row[0] for row in curve.jet(np.array([t])))
            slope = (c - point) @ velocity
            before = t
            t = float(np.clip(t - slope / (velocity @ velocity + (c - point) @ bend), *curve.span))
            if t == before:
                break
        nearest = curve.jet(np.array([t]))[0][0]
        distance = float(np.linalg.norm(nearest - point))
        if distance < best - ON_SURFACE:
            best, feet, index = distance, nearest, a.shape.curves.index(curve)
    corners = np.linalg.norm(a.shape.corners - feet, axis=1)
    if corners.min() <= ON_SURFACE:
        at = int(corners.argmin())
        names = {f"curve{(at - 1) % len(a.shape.curves)}", f"curve{at}"}
        return (("vertex", frozenset(names), 0), NO_NAME), None
    return (("edge", frozenset({f"curve{index}"}), 0), NO_NAME), None


def _lens_body() -> so.Body:
    return so.shapes.lens(LENS.radius, LENS.offset)


def make_scenes() -> dict[str, Scene]:
    """Return all scenes by name."""
    small, brick = Ellipsoid(0.12, 0.06, 0.09), Box(0.7, 0.4, 0.3)
    loop = so.shapes.planar_loop([RationalBezier(control) for control in PLANAR_CONTROL])
    tilted = so.Pose.exp([0.3, -0.4, 0.2], [0.05, -0.1, 0.02])
    helix = Helix(1.0, 1.1, 4.0, centre=(0.05, 0.0, -1.4), axis=(0.1, 0.05, 1.0), phase=0.3)
    wide = Helix(1.1, 1.3, 4.0, (0.05, 0.0, -1.5), (0.1, 0.05, 1.0), 0.3, orientation="turning")
    tumble = so.Twist([0.9, 0.25, 0.0], [1.3, -2.1, 0.8])
    over = ConstantTwist(so.Pose.exp([0.2, 0.1, 0.4], [-1.8, -0.5, 0.95]), tumble)
    return {
        "helix of a point around the lens": Scene(
            _lens_body(),
            so.shapes.point(),
            LENS,
            Point(),
            Fixed(tilted),
            helix,
            3.96,
            lens_to_point,
        ),
        "helix of an ellipsoid around the lens": Scene(
            _lens_body(),
            so.shapes.ellipsoid(*small.axes),
            LENS,
            small,
            Fixed(tilted),
            wide,
            3.63,
            by_multipliers,
        ),
        "spiral of a point around the planar body": Scene(
            loop,
            so.shapes.point(),
            PLANAR,
            Point(),
            Fixed(so.Pose(np.eye(3))),
            Spiral(1.15, 0.06, 3.0, (0.05, -0.03), 0.4),
            4.29,
            loop_to_point,
        ),
        "two orbiting lenses, one spinning": Scene(
            _lens_body(),
            _lens_body().transformed(0.7 * np.eye(3)),
            LENS,
            Lens(0.7, 0.315),
            Orbit(0.7, 1.5, 4.4, np.zeros(3)),
            Orbit(0.92, 1.5, 4.4 + np.pi, (-0.6, 0.1, 1.4)),
            3.96,
            by_multipliers,
        ),
        "tumbling box over a polytope": Scene(
            so.shapes.polytope(ROCK.vertices),
            so.shapes.box(0.7, 0.4, 0.3),
            ROCK,
            brick,
            Fixed(so.Pose(np.eye(3))),
            over,
            3.96,
            by_enumeration,
        ),
    }
