"""The picture of local minima over time: ``python docs/images/make_minima_picture.py``."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import standoff as so
from standoff.bodies import Edge, Face
from standoff.geometry import Line, Plane
from standoff.solids import Solid

HERE = Path(__file__).parent
# A bridge upside down: two feet at y = 1, each of width 1, and a floor between them at y = 0.5.
OUTLINE = [(0, 0), (3, 0), (3, 1), (2, 1), (2, 0.5), (1, 0.5), (1, 1), (0, 1)]


def bridge() -> Solid:
    n, up = len(OUTLINE), np.array([0.0, 0.0, 1.0])
    corners = np.array([(*p, h) for h in (0.0, 1.0) for p in OUTLINE])
    ends = [(k, (k + 1) % n) for k in range(n)]
    ends += [(n + a, n + b) for a, b in ends] + [(k, n + k) for k in range(n)]
    faces = []
    for k in (0, 1):
        loop = tuple((n * k + i, 1) for i in range(n))
        faces.append(Face((Plane.through(k * up, [1, 0, 0], [0, 1, 0]),), loop))
    for k, (a, b) in enumerate(ends[:n]):
        plane = Plane.through(corners[a], corners[b] - corners[a], up)
        faces.append(Face((plane,), ((k, 1), (2 * n + b, 1), (n + k, -1), (2 * n + a, -1))))
    edges = [Edge(Line(corners[a], corners[b]), a, b) for a, b in ends]
    return Solid.from_brep(corners, edges, faces, name="bridge")


def main() -> None:
    tracker = so.Tracker(bridge(), so.shapes.sphere(0.3), minima=0.75)
    poses = [so.Pose(np.eye(3), [x, 1.5, 0.5]) for x in np.linspace(0.2, 2.8, 261)]
    state = tracker.start(so.Pose.identity(), poses[0])
    _, answers = tracker.run(state, so.Pose.identity(), poses)
    answers.plot().savefig(HERE / "minima.png", dpi=100)


if __name__ == "__main__":
    main()
