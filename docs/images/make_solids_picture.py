"""The picture of solids in space: ``python docs/images/make_solids_picture.py``."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.image import imsave

import standoff as so
from standoff.bodies import Edge, Face
from standoff.geometry import ConicArc, Cylinder, Line, Plane
from standoff.solids import Solid, distance

HERE = Path(__file__).parent
x, y, z = np.eye(3)
STILL = so.Pose.identity()


def circle(radius: float, height: float) -> Edge:
    return Edge(ConicArc(height * z, radius * x, radius * y))


def level(height: float, *loop: tuple[int, int]) -> Face:
    return Face((Plane.through(height * z, x, y),), loop)


def wall(radius: float, *loop: tuple[int, int]) -> Face:
    return Face((Cylinder(np.diag([radius, radius, 1.0]), np.zeros(3)),), loop)


def peg(radius: float, low: float, high: float) -> Solid:
    edges = [circle(radius, low), circle(radius, high)]
    faces = [level(low, (0, 1)), wall(radius, (0, 1), (1, 1)), level(high, (1, 1))]
    return Solid.from_brep(edges=edges, faces=faces, name="peg")


def bush(inner: float, outer: float, low: float, high: float) -> Solid:
    edges = [circle(inner, low), circle(inner, high), circle(outer, low), circle(outer, high)]
    faces = [
        level(low, (0, 1), (2, 1)),
        wall(inner, (0, 1), (1, 1)),
        wall(outer, (2, 1), (3, 1)),
        level(high, (1, 1), (3, 1)),
    ]
    return Solid.from_brep(edges=edges, faces=faces, name="bush")


def prism(outline: list[tuple[float, float]], height: float, name: str) -> Solid:
    n = len(outline)
    points = np.array([(*p, h) for h in (0.0, height) for p in outline])
    ends = [(k, (k + 1) % n) for k in range(n)]
    ends += [(n + a, n + b) for a, b in ends[:n]] + [(k, n + k) for k in range(n)]
    edges = [Edge(Line(points[a], points[b]), a, b) for a, b in ends]
    faces = [
        Face((Plane.through(points[k * n], x, y),), tuple((k * n + i, 1) for i in range(n)))
        for k in (0, 1)
    ]
    for k, (a, b) in enumerate(ends[:n]):
        plane = Plane.through(points[a], points[b] - points[a], z)
        faces.append(Face((plane,), ((k, 1), (2 * n + b, 1), (n + k, -1), (2 * n + a, -1))))
    return Solid.from_brep(points, edges, faces, name=name)


def main() -> None:
    slot = [(-1, -1), (3, -1), (3, 2), (2, 2), (2, 0), (0, 0), (0, 2), (-1, 2)]
    channel, pin = prism(slot, 3.0, "channel"), peg(0.4, 0.5, 3.4)
    at = so.Pose(np.eye(3), (0.9, 0.8, 0.0))
    hole, shaft = bush(0.5, 1.0, -0.5, 0.5), peg(0.45, -0.7, 0.7)
    beside = so.Pose(np.eye(3), (0.02, 0.0, 0.0))
    figures = [
        so.plot(channel, pin, distance(channel, pin, STILL, at, minima=0.9), unit="mm"),
        so.plot(hole, shaft, distance(hole, shaft, STILL, beside), unit="mm"),
        so.plot(hole, shaft, distance(hole, shaft, STILL, beside, deadline=4500), unit="mm"),
    ]
    images = []
    for figure in figures:
        figure.canvas.draw()
        images.append(np.asarray(figure.canvas.buffer_rgba()))
    tall = max(len(image) for image in images)
    padded = [np.pad(i, ((0, tall - len(i)), (0, 0), (0, 0)), constant_values=255) for i in images]
    imsave(HERE / "solids.png", np.concatenate(padded, axis=1))


if __name__ == "__main__":
    main()
