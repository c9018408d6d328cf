"""The picture of planar solids: ``python docs/images/make_planar_solids_picture.py``."""

from __future__ import annotations

import runpy
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import standoff as so
from standoff.geometry import ConicArc, Line

HERE = Path(__file__).parent
EXAMPLES = HERE.parents[1] / "examples" / "planar"


def outline(axes, solid, pose, colour):
    parts = []
    for loop in solid.loops:
        points = []
        for curve, backward in zip(loop.curves, loop.backward, strict=True):
            t = np.linspace(curve.first, curve.last, 40)
            points += [pose.apply(curve.point(x))[:2] for x in (t[::-1] if backward else t)]
        parts.append(np.array(points))
    axes.fill(*parts[0].T, color=colour, alpha=0.12, linewidth=0)
    for part in parts[1:]:
        axes.fill(*part.T, color="white", linewidth=0)
    for part in parts:
        axes.fill(*part.T, facecolor="none", edgecolor=colour, linewidth=1.2)


def pairs(axes, answer, colour="tab:red"):
    for each in answer.minima:
        p, q = each.point_a[:2], each.point_b[:2]
        axes.plot(*np.array([p, q]).T, color=colour, linewidth=1.5, zorder=5)
        axes.plot(*p, "o", color=colour, markersize=4, zorder=5)
        axes.plot(*q, "o", color=colour, markersize=4, zorder=5)


def main() -> None:
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.0, 4.2), layout="constrained")
    gears = runpy.run_path(str(EXAMPLES / "gears.py"))
    a, _ = gears["involute_gear"](20, 1.0, thinning=0.008)
    b, _ = gears["involute_gear"](31, 1.0, thinning=0.008)
    pose_a, pose_b = gears["in_mesh"](0.1, 20, 31, 25.5)
    answer = so.distance(a, b, pose_a, pose_b)
    outline(left, a, pose_a, "tab:blue")
    outline(left, b, pose_b, "tab:green")
    pairs(left, answer)
    left.set_xlim(6.0, 14.0)
    left.set_ylim(-4.0, 4.0)
    left.set_title(f"{len(answer.minima)} pairs of flanks at the distance {answer.distance:.4f}")
    axes = (0.5, 0.0), (0.0, 0.5)
    hole = [
        Line((-1, -0.5), (1, -0.5)),
        ConicArc((1, 0), *axes, -np.pi / 2, np.pi / 2),
        Line((1, 0.5), (-1, 0.5)),
        ConicArc((-1, 0), *axes, np.pi / 2, 3 * np.pi / 2),
    ]
    corners = [(-2, -1.2), (2, -1.2), (2, 1.2), (-2, 1.2)]
    sides = [Line(p, q) for p, q in zip(corners, corners[1:] + corners[:1], strict=True)]
    plate = so.PlanarSolid.from_loops(sides, [hole])
    pin = so.PlanarSolid.from_loops([ConicArc((0, 0), (0.42, 0), (0, 0.42))])
    at = so.Pose(np.eye(3), (1.0, 0.0, 0.0))
    answer = so.distance(plate, pin, so.Pose.identity(), at)
    outline(right, plate, so.Pose.identity(), "tab:blue")
    outline(right, pin, at, "tab:green")
    for p, q in answer.continuum.ends:
        right.plot(*np.array([p, q])[:, :2].T, color="tab:red", linewidth=2.0)
    turn = np.linspace(-np.pi / 2, np.pi / 2, 60)
    for r in (0.42, 0.5):
        right.plot(1.0 + r * np.cos(turn), r * np.sin(turn), color="tab:red", linewidth=1.5)
    right.set_title(f"a continuum of pairs at the distance {answer.distance:.2f}")
    for each in (left, right):
        each.set_aspect("equal")
        each.axis("off")
    figure.savefig(HERE / "planar-solids.png", dpi=120)


if __name__ == "__main__":
    main()
