"""The picture of the force on a peg that slides into its hole:
``python docs/images/make_peg_picture.py``.

The peg is pressed against the wall of its hole, and rolls along it while it goes in. Its force is
that of a foundation: proportional to the depth, and to how far the peg is in.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import standoff as so
from standoff.bodies import Edge, Face
from standoff.geometry import ConicArc, Cylinder, Line, Plane
from standoff.solids import Solid

HERE = Path(__file__).parent
HOLE, OUTER, PEG = 0.5, 0.8, 0.49
LOW, HIGH, LENGTH = -0.5, 0.5, 1.4
DEPTH = 1e-3
FRAMES = 120
STIFFNESS = 1.0 / DEPTH
FACETS = (16, 32, 64)
X, Y, Z = np.eye(3)


def turned(radii: tuple[float, ...], low: float, high: float, name: str) -> Solid:
    """A peg of one radius, or a bush of two, the inner one first."""
    edges, faces = [], []
    for radius in radii:
        edges += [Edge(ConicArc(h * Z, radius * X, radius * Y)) for h in (low, high)]
        rims = (len(edges) - 2, 1), (len(edges) - 1, 1)
        faces.append(Face((Cylinder(np.diag([radius, radius, 1.0]), np.zeros(3)),), rims))
    for k, height in enumerate((low, high)):
        loops = tuple((2 * i + k, 1) for i in range(len(radii)))
        faces.append(Face((Plane.through(height * Z, X, Y),), loops))
    return Solid.from_brep(edges=edges, faces=faces, name=name)


def faceted(radii: tuple[float, ...], low: float, high: float, n: int) -> Solid:
    """The same with `n` plane facets for each wall, whose corners are on the circle."""
    angles = 2.0 * np.pi * np.arange(n) / n
    around = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    corners, edges, faces = [], [], []
    loops: tuple[list[tuple[int, int]], ...] = ([], [])
    for radius in radii:
        first, e = len(corners), len(edges)
        corners += [np.array([*(radius * p), height]) for height in (low, high) for p in around]
        ends = [(first + n * k + i, first + n * k + (i + 1) % n) for k in (0, 1) for i in range(n)]
        ends += [(first + i, first + n + i) for i in range(n)]
        edges += [Edge(Line(corners[a], corners[b]), a, b) for a, b in ends]
        for i in range(n):
            a, b = ends[i]
            plane = Plane.through(corners[a], corners[b] - corners[a], Z)
            j = (i + 1) % n
            rim = ((e + i, 1), (e + 2 * n + j, 1), (e + n + i, -1), (e + 2 * n + i, -1))
            faces.append(Face((plane,), rim))
        for k in (0, 1):
            loops[k].extend((e + n * k + i, 1) for i in range(n))
    for loop, height in zip(loops, (low, high), strict=True):
        faces.append(Face((Plane.through(height * Z, X, Y),), tuple(loop)))
    return Solid.from_brep(np.array(corners), edges, faces, name=f"{n} facets")


def pieces(n: int) -> list[so.Body]:
    """The bush as `n` convex pieces."""
    angles = 2.0 * np.pi * np.arange(n + 1) / n
    found = []
    for a, b in pairwise(angles):
        spots = [
            [r * np.cos(t), r * np.sin(t), h] for r in (HOLE, OUTER) for t in (a, b)
            for h in (LOW, HIGH)
        ]  # fmt: skip
        found.append(so.shapes.polytope(np.array(spots)))
    return found


def poses() -> tuple[list[so.Pose], np.ndarray]:
    """Of the peg, and how far it is in."""
    depth_in = np.linspace(0.12, 0.95, FRAMES)
    offset = HOLE - PEG + DEPTH
    found = []
    for k, length in enumerate(depth_in):
        way = 1.3 * k / FRAMES
        turn = so.Pose.exp((0.0, 0.0, -2.1 * way)).rotation
        found.append(
            so.Pose(turn, [offset * np.cos(way), offset * np.sin(way), HIGH - length + LENGTH / 2])
        )
    return found, depth_in


def depths(bush: Solid, peg: Solid, path: list[so.Pose]) -> np.ndarray:
    """How deep the deepest place is in each frame."""
    tracker = so.Tracker(bush, peg, minima=5.0 * DEPTH)
    state = tracker.start(so.Pose.identity(), path[0])
    _, answers = tracker.run(state, so.Pose.identity(), path)
    return np.maximum(-answers.distance, 0.0)


def main() -> None:
    path, depth_in = poses()
    low, high = -LENGTH / 2, LENGTH / 2
    figure, axes = plt.subplots(figsize=(8.0, 4.2), constrained_layout=True)
    lines = {}
    for n in FACETS:
        pair = faceted((HOLE, OUTER), LOW, HIGH, n), faceted((PEG,), low, high, n)
        lines[f"mesh of {n} facets"] = depths(*pair, path)
    cylinder, parts = so.shapes.cylinder(PEG, LENGTH), pieces(64)
    lines["64 convex pieces"] = np.array(
        [
            max(
                max(-so.distance(part, cylinder, so.Pose.identity(), pose).distance, 0.0)
                for part in parts
            )
            for pose in path
        ]
    )
    exact = turned((HOLE, OUTER), LOW, HIGH, "bush"), turned((PEG,), low, high, "peg")
    lines["exact"] = depths(*exact, path)
    for name, deep in lines.items():
        force = STIFFNESS * deep * depth_in
        ripple = force - depth_in
        print(f"{name}: off by {np.abs(ripple).max():.2g}, from frame to frame "
              f"{np.abs(np.diff(ripple)).max():.2g}")  # fmt: skip
        look = {"color": "black", "linewidth": 1.8} if name == "exact" else {"linewidth": 0.9}
        axes.plot(depth_in, force, label=name, **look)
    axes.set_xlabel("how far the peg is in its hole")
    axes.set_ylabel("force, of that of the whole wall")
    axes.set_ylim(0.0, 4.0)
    axes.legend(loc="upper left")
    figure.savefig(HERE / "peg.png", dpi=100)


if __name__ == "__main__":
    main()
