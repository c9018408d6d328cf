"""Facets that are felt: the force on a tool that slides over an exact lens, and over hulls of it.

Run with ``python -m benchmarks.facets``. An ellipsoidal tool is led over face, edge, vertex, edge
and face of a lens at a constant speed and a constant depth, in frames of 1 ms, and pushed back by a
contact spring. The way is exact by construction: for a unit normal n the tool stands at s_A(n) -
s_B(-n) - depth n, with the support points s of lens and tool, so the depth along n is the one that
was chosen and the force's size is one number all the way. The same way is led with Coal on convex
hulls of both bodies, whose facets lie up to 1e-2, 1e-3 and 1e-4 of each body's size below the
surface. ``docs/images/make_facets_picture.py`` draws it.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

import standoff as so
from standoff import simulation as sim
from standoff_studies.accuracy.peers.answer import require
from standoff_studies.oracles import Ellipsoid, Lens

Array = NDArray[np.float64]

RADIUS, OFFSET = 0.05, 0.0225
"""m, of the lens."""
AXES = (0.008, 0.006, 0.005)
"""m, of the tool."""
DEPTH = 1e-3
"""m, of the tool in the lens, all the way."""
SPEED = 0.1
"""m/s, of the tool."""
DT = 1e-3
"""s, a frame of a haptic device."""
CONTACT = sim.HuntCrossley(stiffness=6.4e4)
"""N/m^1.5: 2.0 N at the depth."""
FINENESS = (1e-2, 1e-3, 1e-4)
"""How far facets lie below the surface at most, parts of the body's size."""
INCLINATION, NODE = math.radians(80.0), math.radians(25.0)
ALONG = math.radians(-20.0), math.radians(200.0)
"""The great circle of normals, and its part that is passed."""
FINE_STEPS = 40_001
"""Points of the way before frames are laid on it."""
SLIVER = 0.2
"""Parts of the spacing: nearer to an edge a face has no vertex of its hull."""


class Way(NamedTuple):
    """Where the tool is led: (n,) times [s], (n, 3) positions [m] and exact normals."""

    times: Array
    positions: Array
    normals: Array


class Ride(NamedTuple):
    """(n, 3) forces on the tool [N], (n,) depths [m]."""

    forces: Array
    depths: Array


def supports() -> tuple[Lens, Ellipsoid]:
    return Lens(RADIUS, OFFSET), Ellipsoid(*AXES)


def bodies() -> tuple[so.Body, so.Body]:
    return so.shapes.lens(RADIUS, OFFSET), so.shapes.ellipsoid(*AXES)


def way(dt: float = DT) -> Way:
    """The tool's way at constant speed, in frames of dt."""
    u = np.linspace(*ALONG, FINE_STEPS)
    arc = np.linalg.norm(np.diff(_places(_normals(u)), axis=0), axis=1)
    gone = np.concatenate([[0.0], np.cumsum(arc)])
    times = dt * np.arange(int(gone[-1] / SPEED / dt))
    normals = _normals(np.interp(SPEED * times, gone, u))
    return Way(times, _places(normals), normals)


def _normals(u: Array) -> Array:
    """Unit vectors along the inclined great circle."""
    around = NODE + np.arctan2(math.cos(INCLINATION) * np.sin(u), np.cos(u))
    rise = math.sin(INCLINATION) * np.sin(u)
    flat = np.sqrt(1.0 - rise**2)
    return np.stack([flat * np.cos(around), flat * np.sin(around), rise], axis=1)


def _places(normals: Array) -> Array:
    """Where the tool stands with these normals."""
    lens, tool = supports()
    return np.asarray(lens.points(normals) - tool.points(-normals) - DEPTH * normals)


def pushed(depth: float, normal: Any) -> Array:
    """The contact's force on the tool, along the normal from lens to tool."""
    return np.asarray(CONTACT.force(depth) * np.asarray(normal))


def exact_ride(led: Way) -> tuple[Ride, list[str]]:
    """The forces on the exact bodies, and the lens's features that carry them."""
    lens, tool = bodies()
    here = so.Pose.identity()
    tracker = so.Tracker(lens, tool, dt=float(led.times[1]))
    speeds = np.gradient(led.positions, led.times, axis=0)
    twist = so.Twist(speeds[0], np.zeros(3))
    state = tracker.start(here, so.Pose(np.eye(3), led.positions[0]), twist_b=twist)
    answers = [state.proximity]
    for position, speed in zip(led.positions[1:], speeds[1:], strict=True):
        pose = so.Pose(np.eye(3), position)
        state, answer = tracker.step(state, here, pose, twist_b=so.Twist(speed, np.zeros(3)))
        answers.append(answer)
    forces = np.array([pushed(-answer.distance, answer.normal) for answer in answers])
    depths = np.array([-answer.distance for answer in answers])
    return Ride(forces, depths), [str(answer.feature_a) for answer in answers]


def sphere_points(spacing: float) -> Array:
    """Unit vectors about so far apart: corners of a divided icosahedron."""
    golden = 0.5 * (1.0 + math.sqrt(5.0))
    base = np.array([(0, s, t * golden) for s in (-1, 1) for t in (-1, 1)], dtype=float)
    corners = np.concatenate([np.roll(base, k, axis=1) for k in range(3)])
    corners /= np.linalg.norm(corners[0])
    count = max(1, math.ceil(1.1 / spacing))
    weights = np.array(
        [(i, j, count - i - j) for i in range(count + 1) for j in range(count + 1 - i)]
    )
    faces = ConvexHull(corners).simplices
    points = np.concatenate([weights @ corners[face] for face in faces])
    points /= np.linalg.norm(points, axis=1)[:, None]
    return np.asarray(np.unique(points.round(12), axis=0))


def lens_points(spacing: float) -> Array:
    """Points of the lens: on each ball where it bounds the lens, on its edges, its vertices."""
    found = []
    for i in range(3):
        angle = 2.0 * np.pi * i / 3.0
        centre = -OFFSET * np.array([np.cos(angle), np.sin(angle), 0.0])
        on_ball = centre + RADIUS * sphere_points(spacing)
        # not so near an edge that slivers come about
        inside = [
            np.linalg.norm(on_ball - other, axis=1) < RADIUS * (1.0 - SLIVER * spacing)
            for other in _centres()
            if not np.allclose(other, centre)
        ]
        found.append(on_ball[np.all(inside, axis=0)])
    found += [_edge_points(k, spacing) for k in range(3)]
    return np.concatenate(found)


def _centres() -> Array:
    angles = 2.0 * np.pi * np.arange(3) / 3.0
    return -OFFSET * np.stack([np.cos(angles), np.sin(angles), 0.0 * angles], axis=1)


def _edge_points(k: int, spacing: float) -> Array:
    """Points of the edge of balls k and k + 1, its ends among them."""
    first, second = _centres()[[k, (k + 1) % 3]]
    middle = 0.5 * (first + second)
    off = float(np.linalg.norm(middle))
    wide = math.sqrt(RADIUS**2 - float(np.sum((first - middle) ** 2)))
    top = math.acos(off / wide)
    angles = np.linspace(-top, top, 2 * math.ceil(top * wide / (spacing * RADIUS)) + 1)
    up = np.array([0.0, 0.0, 1.0])
    return middle + wide * (np.cos(angles)[:, None] * -middle / off + np.sin(angles)[:, None] * up)


def lowest(support: Any, points: Array) -> float:
    """How far facets of a hull lie below the body's surface at most, length: the body's support
    plane along a facet's normal is nowhere farther from the hull.
    """
    planes = ConvexHull(points).equations
    normals = planes[:, :3]
    return float(np.max(np.sum(support.points(normals) * normals, axis=1) + planes[:, 3]))


def tessellated(support: Any, points_at: Any, below: float) -> Array:
    """Vertices of the coarsest hull found whose facets lie at most so far below the surface."""
    spacing, points = 1.0, points_at(1.0)
    found = lowest(support, points)
    while found > below:
        spacing *= min(0.98, 0.995 * math.sqrt(below / found))
        points = points_at(spacing)
        found = lowest(support, points)
    return np.asarray(points)


def meshes(fineness: float) -> tuple[Array, Array]:
    """Vertices of lens and tool, whose facets lie at most that part of their sizes too low."""
    lens, tool = supports()
    sizes = [body.size for body in bodies()]
    return (
        tessellated(lens, lens_points, fineness * sizes[0]),
        tessellated(tool, lambda s: np.array(AXES) * sphere_points(s), fineness * sizes[1]),
    )


def coal_ride(led: Way, vertices: tuple[Array, Array]) -> Ride:
    """The forces that Coal's depth and normal of two hulls make."""
    coal = require("coal")
    shapes = []
    for points in vertices:
        listed = coal.StdVec_Vec3s()
        for point in points:
            listed.append(point)
        shapes.append(coal.Convex.convexHull(listed, False, None))
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    here = coal.Transform3s(np.eye(3), np.zeros(3))
    forces, depths = np.zeros((len(led.times), 3)), np.zeros(len(led.times))
    for k, position in enumerate(led.positions):
        result.clear()
        place = coal.Transform3s(np.eye(3), position)
        depths[k] = -coal.distance(shapes[0], here, shapes[1], place, request, result)
        forces[k] = pushed(depths[k], np.array(result.normal))
    return Ride(forces, depths)


def hull_depths(led: Way, vertices: tuple[Array, Array]) -> Array:
    """The depths of two hulls by all facets of their Minkowski difference: for coarse ones."""
    corners = (vertices[0][:, None] - vertices[1][None]).reshape(-1, 3)
    planes = ConvexHull(corners).equations
    return np.array([-np.max(planes[:, :3] @ p + planes[:, 3]) for p in led.positions])


def steps(ride: Ride) -> Array:
    """Changes of the force from frame to frame [N]."""
    return np.asarray(np.linalg.norm(np.diff(ride.forces, axis=0), axis=1))


def explained(dt: float = DT) -> float:
    """The greatest change of the force in a frame that stiffness and motion explain [N].

    A tool that keeps its depth moves across the normal n. F = f n then changes by f times the turn
    of n: at most the way over the least radius of curvature that lens and tool have together, less
    the depth. The lens has vertices, so that radius is the tool's own.
    """
    rounding = min(AXES) ** 2 / max(AXES)
    return CONTACT.force(DEPTH) / (rounding - DEPTH) * SPEED * dt


def spectrum(ride: Ride, dt: float = DT) -> tuple[Array, Array]:
    """Frequencies [Hz] and amplitudes of the force [N], its three parts taken together."""
    window = np.hanning(len(ride.forces))
    moved = (ride.forces - ride.forces.mean(axis=0)) * window[:, None]
    parts = 2.0 * np.abs(np.fft.rfft(moved, axis=0)) / window.sum()
    return np.fft.rfftfreq(len(window), dt), np.asarray(np.linalg.norm(parts, axis=1))


def line(name: str, ride: Ride, vertices: str) -> str:
    size = np.linalg.norm(ride.forces, axis=1)
    f, amplitude = spectrum(ride)
    felt = amplitude[(f >= 40.0) & (f <= 400.0)]
    return (
        f"{name:8s} {vertices:>13s} {size.min():8.3f} {size.max():8.3f} {steps(ride).max():10.3f} "
        f"{np.sum(steps(ride) > explained()):8d} {np.sqrt(0.5 * np.sum(felt**2)):12.1e}"
    )


def main() -> None:
    led = way()
    print(
        f"{len(led.times)} frames of {1e3 * DT:g} ms, {1e3 * SPEED:g} mm/s, {1e3 * DEPTH:g} mm deep"
    )
    print(f"largest change in a frame that stiffness and motion explain: {explained():.3f} N")
    print(
        f"{'body':8s} {'vertices':>13s} {'least, N':>8s} {'most, N':>8s} {'change, N':>10s} "
        f"{'beyond':>8s} {'40-400 Hz, N':>12s}"
    )
    for fineness in FINENESS:
        vertices = meshes(fineness)
        counts = " + ".join(str(len(part)) for part in vertices)
        print(line(f"{fineness:g}", coal_ride(led, vertices), counts))
    ride, features = exact_ride(led)
    print(line("exact", ride, ""))
    print("passed:", ", ".join(dict.fromkeys(features)))


if __name__ == "__main__":
    main()
