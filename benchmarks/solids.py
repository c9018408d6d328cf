"""Cold proven distances of two solids: median and 99 % by gap, statuses, and cost by faces.

Run it with ``python -m benchmarks.solids``; times are of one thread, with closing, in milliseconds.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from itertools import pairwise

import numpy as np

import standoff as so
from standoff.bodies import Edge, Face
from standoff.geometry import ConicArc, Cylinder, Plane
from standoff.solids import Solid
from standoff.solids.spatial.distance import spatial_distance
from standoff.solids.spatial.half_space import HalfSpace, size_together
from standoff.solids.spatial.models import as_model
from standoff.solids.spatial.solid_model import SolidModel

GAPS = (1.0, 0.1, 1e-2, 1e-3, 1e-6)
AXES = np.eye(3)


def turned(steps: list[tuple[float, float]], top: float) -> Solid:
    """A turned part: (height, radius) of each step upwards, and the height of its top."""
    levels = [h for h, _ in steps] + [top]
    edges, faces = [], []

    def circle(radius: float, height: float) -> tuple[int, int]:
        edges.append(Edge(ConicArc(height * AXES[2], radius * AXES[0], radius * AXES[1])))
        return len(edges) - 1, 1

    def level(height: float, *loop: tuple[int, int]) -> None:
        faces.append(Face((Plane.through(height * AXES[2], AXES[0], AXES[1]),), loop))

    rims = [
        (circle(r, low), circle(r, high))
        for (low, high), (_, r) in zip(pairwise(levels), steps, strict=True)
    ]
    level(levels[0], rims[0][0])
    for k, (low, high) in enumerate(rims):
        r = steps[k][1]
        faces.append(Face((Cylinder(np.diag([r, r, 1.0]), np.zeros(3)),), (low, high)))
        following = rims[k + 1][0] if k + 1 < len(rims) else None
        level(levels[k + 1], high, *([following] if following else []))
    return Solid.from_brep(edges=edges, faces=faces, name=f"{len(faces)} faces")


def drawn(faces: int, rng: np.random.Generator) -> Solid:
    """A part of about so many faces, of size about 1."""
    return turned(drawn_steps(faces, rng), 1.0)


def drawn_steps(faces: int, rng: np.random.Generator) -> list[tuple[float, float]]:
    """Of such a part (height, radius) of each step upwards."""
    count = max((faces - 1) // 2, 1)
    radii = np.where(np.arange(count) % 2, 0.12, 0.25) * rng.uniform(0.8, 1.2, count)
    return [(k / count, float(r)) for k, r in enumerate(radii)]


def posed(
    a: Solid, b: SolidModel, gap: float, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """A drawn pose at which the solids are `gap` apart, found by moving along the normal."""
    q = rng.normal(size=4)
    w, x, y, z = q / np.linalg.norm(q)
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    way = -turn[:, 2] if isinstance(b, HalfSpace) else rng.normal(size=3)
    move = way / np.linalg.norm(way) * size_together(a, b)
    for _ in range(12):
        answer = spatial_distance(a, b, None, (turn, move))
        if abs(answer.distance - gap) <= 0.1 * gap:
            break
        move = move + (gap - answer.distance) * answer.normal
    return turn, move


def row(a: Solid, b: SolidModel, gap: float, poses: int, rng: np.random.Generator) -> str:
    times, statuses = [], Counter()
    for _ in range(poses):
        pose = posed(a, b, gap, rng)
        start = time.perf_counter()
        answer = spatial_distance(a, b, None, pose)
        times.append(1e3 * (time.perf_counter() - start))
        statuses[answer.status.name] += 1
    told = ", ".join(f"{name} {100 * n / poses:.0f} %" for name, n in statuses.most_common())
    return f"{np.median(times):8.2f} {np.quantile(times, 0.99):8.2f} {max(times):8.2f}  {told}"


def beside(part: Solid, poses: int, rng: np.random.Generator) -> None:
    """Convex bodies beside a part: what making each takes, and a query."""
    shapes = {
        "sphere": so.shapes.sphere(0.3),
        "capsule": so.shapes.capsule(0.1, 0.6),
        "rounded box": so.shapes.box((0.4, 0.5, 0.6), rounding=0.05),
        "rounded cylinder": so.shapes.cylinder(0.2, 0.5, rounding=0.05),
        "half-space": so.shapes.halfspace(),
        "point": so.shapes.point(),
    }
    spatial_distance(part, so.shapes.capsule(0.1, 0.5), None, (np.eye(3), (3.0, 0, 0)))
    print(f"beside {part.boundary.n_faces} faces: gap, median, 99 %, worst (ms)")
    for name, body in shapes.items():
        start = time.perf_counter()
        made = as_model(body)
        print(f"{name}: made in {1e3 * (time.perf_counter() - start):.0f} ms")
        for gap in GAPS:
            print(f"{gap:8g} {row(part, made, gap, poses, rng)}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--poses", type=int, default=100)
    parser.add_argument("--faces", type=int, nargs="*", default=[10, 30, 100])
    parser.add_argument("--beside", action="store_true", help="convex bodies beside the parts")
    given = parser.parse_args()
    rng = np.random.default_rng(0)
    for faces in given.faces:
        a, b = drawn(faces, rng), drawn(faces, rng)
        if given.beside:
            beside(a, given.poses, rng)
            continue
        spatial_distance(a, b, None, (np.eye(3), (3.0, 0, 0)))
        print(f"{a.boundary.n_faces} faces, {len(a.leaves)} leaves: gap, median, 99 %, worst (ms)")
        for gap in GAPS:
            print(f"{gap:8g} {row(a, b, gap, given.poses, rng)}")


if __name__ == "__main__":
    main()
