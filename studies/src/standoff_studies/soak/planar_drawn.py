"""Planar solids that are drawn: of the library, and by the study's own rows of numbers."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

import standoff as so
from standoff.geometry import ConicArc, Curve, Line, NurbsCurve, RationalBezier
from standoff_studies.soak import planar_sampling, planar_truth
from standoff_studies.soak.planar_truth import Array, Outline

Rng = np.random.Generator
Drawn = tuple[Curve, list[Array]]
Poses = tuple[so.Pose, so.Pose]

PER_LENGTH = 400
"""Samples along a unit of length, of a solid of size 1."""
CURVES = 10.0, 400.0
"""Of a loop, least and most."""
HOLES, SMALL = 0.3, 0.25
"""Shares of solids with a hole, and of small ones, which have room in others."""
GAPS = (0.3, 1e-1, 1e-2, 1e-3, 1e-5, 1e-7, 1e-9)
"""Of the mean size: how far apart."""
DEPTHS = (0.0, -1e-10, -1e-7, -1e-3, -0.1)
"""Of the mean size: that, or how deep."""
DEEP = 0.4
"""How often there is a depth."""
DEPTH_SHARES = (0.1, 0.1, 0.2, 0.3, 0.3)
"""How often each is drawn."""
ADVANCES, COARSE_ADVANCES = 30, 8
"""Steps by which B is brought to A; of these the ones that only look at runs of samples."""
TRIES = 5
"""Places that are tried until no sampled run of either solid is inside the other."""


class Judged(NamedTuple):
    """A solid and its boundary by the study's own formulas."""

    solid: so.PlanarSolid
    outline: Outline
    size: float


def drawn_loop(rng: Rng, n: int, scale: float = 1.0) -> list[Drawn]:
    """A loop of n curves round the origin that bends inward here and there."""
    angles = (np.arange(n) + rng.uniform(0.0, 0.6, n)) * 2.0 * np.pi / n
    radii = 0.8 + rng.uniform(-1.0, 1.0, n) * min(0.2, 4.0 / n)
    if n >= 40:
        radii += rng.uniform(0.0, 0.2) * np.cos(rng.integers(2, 6) * angles)
    corners = scale * radii[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    following = np.roll(corners, -1, axis=0)
    return [drawn_curve(rng, p, q) for p, q in zip(corners, following, strict=True)]


def drawn_curve(rng: Rng, p: Array, q: Array) -> Drawn:
    """A curve of any kind from p to q, or back, and its rows."""
    kind = rng.integers(4)
    if kind == 0:
        return Line(p, q), [planar_sampling.cubic(np.array([p, q]))]
    side = np.array([p[1] - q[1], q[0] - p[0]])
    if kind == 1:
        # an arc through both, its centre beyond either side
        away = rng.choice([-1.0, 1.0]) * rng.uniform(2.0, 8.0)
        centre = 0.5 * (p + q) + away * side
        r = float(np.linalg.norm(p - centre))
        first, last = (float(np.arctan2(*(each - centre)[::-1])) for each in (p, q))
        if (last - first) % (2.0 * np.pi) > np.pi:
            first, last = last, first
        turn = (last - first) % (2.0 * np.pi)
        curve = ConicArc(centre, (r, 0.0), (0.0, r), first, first + turn)
        return curve, [planar_sampling.arc(centre, r, first, first + turn)]
    inner = [p + u * (q - p) + rng.uniform(-0.08, 0.08) * side for u in (0.33, 0.66)]
    points = np.array([p, *inner, q])
    if kind == 2:
        weights = rng.uniform(0.7, 1.4, 4)
        return RationalBezier(points, weights), [planar_sampling.cubic(points, weights)]
    knot = 0.5 * (points[1] + points[2])
    halves = [points[0], points[1], knot], [knot, points[2], points[3]]
    spline = NurbsCurve(points, [0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0])
    return spline, [planar_sampling.cubic(np.array(half)) for half in halves]


def judged(rng: Rng) -> Judged:
    """A drawn solid; loops that meet themselves or each other are drawn anew."""
    n = round(float(np.exp(rng.uniform(*np.log(CURVES)))))
    scale = rng.uniform(0.05, 0.3) if rng.uniform() < SMALL else 1.0
    while True:
        loops = [drawn_loop(rng, n, scale)]
        if rng.uniform() < HOLES:
            loops.append(drawn_loop(rng, max(10, n // 3), scale * rng.uniform(0.2, 0.6)))
        curves = [[curve for curve, _ in loop] for loop in loops]
        try:
            solid = so.PlanarSolid.from_loops(curves[0], curves[1:])
            break
        except so.BodyError:
            continue
    rows = [[row for _, rows in loop for row in rows] for loop in loops]
    return Judged(solid, planar_sampling.outline(rows, PER_LENGTH / scale), solid.size)


def planar_pose(x: float, y: float, angle: float) -> so.Pose:
    """A pose in the plane."""
    c, s = np.cos(angle), np.sin(angle)
    return so.Pose([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]], (x, y, 0.0))


def move_of(pose_a: so.Pose, pose_b: so.Pose) -> tuple[float, float, float, float]:
    """(cos, sin, x, y) from B's frame into A's."""
    back = np.asarray(pose_a.rotation)[:2, :2].T
    R = back @ np.asarray(pose_b.rotation)[:2, :2]
    p = back @ (np.asarray(pose_b.translation) - np.asarray(pose_a.translation))[:2]
    return float(R[0, 0]), float(R[1, 0]), float(p[0]), float(p[1])


def drawn_poses(a: Judged, b: Judged, rng: Rng) -> list[Poses]:
    """World poses of both: B brought along a line until it nearly touches A, at several gaps and
    depths; two places that face each other, also inside A; and anywhere near each other."""
    r, way, turn = rng.uniform(0.1, 2.6), rng.uniform(0.0, 7.0), rng.uniform(0.0, 7.0)
    found = [(r * np.cos(way), r * np.sin(way), turn)]
    if rng.uniform() < 0.7:
        found[0] = _facing(a, b, rng)
    way, turn = rng.uniform(0.0, 7.0), rng.uniform(0.0, 7.0)
    touching = _brought(a, b, way, turn)
    gaps = [*GAPS, *rng.choice(DEPTHS, int(rng.uniform() < DEEP), p=DEPTH_SHARES)]
    for gap in gaps:
        away = touching + gap * 0.5 * (a.size + b.size)
        nudge = float(rng.choice([0.0, 0.0, 1e-9, 1e-6]))
        found.append((away * np.cos(way), away * np.sin(way), turn + nudge))
    return [_in_world(place, rng) for place in found]


def _in_world(place: tuple[float, float, float], rng: Rng) -> Poses:
    """A at the origin, or anywhere."""
    x, y, angle = place
    if rng.uniform() < 0.5:
        return so.Pose.identity(), planar_pose(x, y, angle)
    turn, p = rng.uniform(0.0, 7.0), rng.normal(size=2)
    c, s = np.cos(turn), np.sin(turn)
    pose_b = planar_pose(c * x - s * y + p[0], s * x + c * y + p[1], angle + turn)
    return planar_pose(p[0], p[1], turn), pose_b


def _brought(a: Judged, b: Judged, way: float, turn: float) -> float:
    """How far B is from A's origin in a direction when it nearly touches A from outside."""
    c, s, far = float(np.cos(turn)), float(np.sin(turn)), 4.0
    for k in range(ADVANCES):
        move = c, s, far * float(np.cos(way)), far * float(np.sin(way))
        if k < COARSE_ADVANCES:
            left = planar_truth.run_distance(a.outline, b.outline, move) - a.outline.radii.max()
            left = max(left - b.outline.radii.max(), 0.0)
        else:
            left = planar_truth.least_distance(a.outline, b.outline, move)[1]
        far -= left
        if k >= COARSE_ADVANCES and left < 1e-10:
            break
    return far


def _facing(a: Judged, b: Judged, rng: Rng) -> tuple[float, float, float]:
    """(x, y, angle) at which a sample of B faces one of A; the last place that is tried may have
    the solids meet elsewhere."""
    gap = float(rng.choice(GAPS)) * 0.5 * (a.size + b.size)
    side = -1.0 if b.size < 0.5 * a.size else 1.0  # into A's material
    way = angle = 0.0
    place = np.zeros(2)
    for _ in range(TRIES):
        (p, at_p), (q, at_q) = _place(a, rng), _place(b, rng)
        way = at_p if side > 0.0 else at_p + np.pi
        angle = way + np.pi - at_q + float(rng.choice([0.0, 0.0, 1e-9, 1e-3, 0.1]))
        c, s = float(np.cos(angle)), float(np.sin(angle))
        turned = np.array([c * q[0] - s * q[1], s * q[0] + c * q[1]])
        place = p + gap * np.array([np.cos(way), np.sin(way)]) - turned
        if not _crossing(a, b, (c, s, float(place[0]), float(place[1])), side):
            break
    return float(place[0]), float(place[1]), float(angle)


def _place(solid: Judged, rng: Rng) -> tuple[Array, float]:
    """A sample and the angle of a normal that leads out of the solid there, nearly."""
    o = solid.outline
    loop = rng.integers(len(o.loops) - 1)
    k = int(rng.integers(o.loops[loop], o.loops[loop + 1] - 1))
    tangent = o.samples[k + 1] - o.samples[k]
    angle = float(np.arctan2(-tangent[0], tangent[1]))
    # samples of a loop go either way round
    step = 4.0 * o.reach * np.array([np.cos(angle), np.sin(angle)])
    inside = planar_truth.holds(o, *(0.5 * (o.samples[k] + o.samples[k + 1]) + step))
    return o.samples[k], angle + np.pi if inside else angle


def _crossing(a: Judged, b: Judged, move: tuple[float, float, float, float], side: float) -> bool:
    """Is the middle of a run of B inside A, or outside where it should be inside, or one of A
    inside B?"""
    there = planar_truth.any_held(a.outline, b.outline, move)
    back = planar_truth.any_held(b.outline, a.outline, planar_truth.inverse(move))
    if side < 0.0:
        return bool(not there[1] or back[0])
    return bool(there[0] or back[0])
