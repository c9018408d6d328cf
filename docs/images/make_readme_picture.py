"""Draw docs/images/standoff.png for the README: a tool passes a lens, and what the tracker says.

Run: python docs/images/make_readme_picture.py [FILE]. Needs matplotlib.
"""

import os
import sys
import tempfile
from itertools import pairwise
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection
from scipy.spatial import ConvexHull

import standoff as so
from standoff.motion import Pose, Screw

LENS_RADIUS, LENS_OFFSET = 1.0, 0.45
TOOL_AXES = np.array([0.17, 0.42, 0.12])
DURATION, DT = 4.5, 0.01
SHOWN = 2.32  # s, the instant of the scene on the left
GHOSTS = (0.0, 0.8, 1.65, 3.25, 4.05)
LENS_COLOUR, TOOL_COLOUR, INK = "#5b8db8", "#d98e4a", "#222222"
FEATURE_COLOURS = {"face": "#dcebf7", "edge": "#f6dfc6", "vertex": "#d9ead3"}

# The eye looks along -EYE; RIGHT and UP span the picture.
EYE = np.array([0.5, -0.86, 0.05])
EYE = EYE / np.linalg.norm(EYE)
RIGHT = np.cross([0.0, 0.0, 1.0], EYE)
RIGHT = RIGHT / np.linalg.norm(RIGHT)
UP = np.cross(EYE, RIGHT)
LIGHT = 0.55 * EYE - 0.35 * RIGHT + 0.75 * UP
LIGHT = LIGHT / np.linalg.norm(LIGHT)


def flat(points):
    """Picture coordinates of world points, (..., 3) -> (..., 2)."""
    return np.stack([points @ RIGHT, points @ UP], axis=-1)


def directions(around, along):
    """Unit vectors on a grid of longitudes and latitudes."""
    a = np.linspace(0.0, 2.0 * np.pi, around + 1)[:, None]
    b = np.linspace(0.0, np.pi, along + 1)[None]
    return np.stack([np.cos(a) * np.sin(b), np.sin(a) * np.sin(b), 0.0 * a + np.cos(b)], axis=-1)


def lens_points():
    """Points of the lens: along each direction the nearest of its three spheres."""
    rays = directions(72, 48)
    reach = np.full(rays.shape[:2], np.inf)
    for i in range(3):
        angle = 2.0 * np.pi * i / 3.0
        centre = -LENS_OFFSET * np.array([np.cos(angle), np.sin(angle), 0.0])
        middle = rays @ centre
        reach = np.minimum(reach, middle + np.sqrt(middle**2 + LENS_RADIUS**2 - LENS_OFFSET**2))
    return reach[..., None] * rays


def tool_points():
    return directions(48, 32) * TOOL_AXES


def patches(points, colour):
    """(depth, polygon, shaded colour) of the grid's quads that face the eye."""
    base = np.array(matplotlib.colors.to_rgb(colour))
    corners = np.stack([points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]], axis=2)
    for quad in corners.reshape(-1, 4, 3):
        normal = np.cross(quad[2] - quad[0], quad[3] - quad[1])
        size = np.linalg.norm(normal)
        if size == 0.0:
            continue
        normal = -normal / size  # the grid runs clockwise seen from outside
        if normal @ EYE > 0.0:
            shade = 0.42 + 0.58 * max(normal @ LIGHT, 0.0)
            yield quad.mean(axis=0) @ EYE, flat(quad), np.clip(base * shade + 0.08, 0.0, 1.0)


def placed(points, pose):
    return points @ pose.rotation.T + pose.translation


def track():
    """(times, answers, path): the tool on a circle over the lens at rest."""
    lens = so.shapes.lens(LENS_RADIUS, LENS_OFFSET)
    tool = so.shapes.ellipsoid(*TOOL_AXES)
    quaternion = np.array([7.0, 5.0, 0.0, 5.0]) / np.sqrt(99.0)
    begin = Pose.from_wxyz(quaternion, [-0.74, -1.0, -0.15])
    path = Screw(begin, axis=[-0.5, 0.86, 0.0], angular_rate=0.7, pitch=0.0)
    tracker = so.Tracker(lens, tool, dt=DT)
    here = Pose.identity()
    state = tracker.start(here, path.pose(0.0), twist_b=path.twist(0.0))
    answers = [state.proximity]
    times = DT * np.arange(round(DURATION / DT) + 1)
    for t in times[1:]:
        state, answer = tracker.step(state, here, path.pose(t), twist_b=path.twist(t))
        answers.append(answer)
    return times, answers, path


def draw_scene(axes, times, answers, path):
    shapes = lens_points(), tool_points()
    shown = answers[int(np.searchsorted(times, SHOWN - DT / 2))]
    way = flat(np.array([path.pose(t).translation for t in times]))
    axes.plot(*way.T, color="0.6", lw=0.9, ls=(0, (4, 3)), zorder=0)
    for t in GHOSTS:
        outline = flat(placed(shapes[1], path.pose(t))).reshape(-1, 2)
        ring = outline[ConvexHull(outline).vertices]
        axes.fill(*ring.T, fc="#f7ead9", ec=TOOL_COLOUR, lw=0.9, alpha=0.9, zorder=1)
        answer = answers[int(np.searchsorted(times, t - DT / 2))]
        ends = flat(np.array([answer.point_a, answer.point_b]))
        axes.plot(*ends.T, color="0.45", lw=0.9, zorder=4)
    quads = [*patches(shapes[0], LENS_COLOUR)]
    quads += patches(placed(shapes[1], path.pose(SHOWN)), TOOL_COLOUR)
    quads.sort(key=lambda q: q[0])
    colours = [q[2] for q in quads]
    axes.add_collection(
        PolyCollection(
            [q[1] for q in quads], facecolors=colours, edgecolors=colours, lw=0.6, zorder=3
        )
    )
    a, b = flat(shown.point_a), flat(shown.point_b)
    axes.plot(*np.array([a, b]).T, color=INK, lw=2.0, zorder=5)
    axes.plot(*np.array([a, b]).T, "o", color=INK, ms=5, mfc="white", mew=1.5, zorder=6)
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.axis("off")
    return shown, a, b


def label(axes, text, at, offset):
    axes.annotate(
        text, at, xytext=offset, textcoords="offset points", fontsize=9, color=INK, zorder=8,
        arrowprops={"arrowstyle": "-", "color": "0.4", "lw": 0.7, "shrinkA": 1, "shrinkB": 4},
    )  # fmt: skip


def draw_strips(upper, lower, times, answers):
    kinds = [answer.feature_a for answer in answers]
    cuts = [0, *(k for k in range(1, len(kinds)) if kinds[k] != kinds[k - 1]), len(kinds) - 1]
    for first, last in pairwise(cuts):
        span = times[first], times[last]
        upper.axvspan(*span, color=FEATURE_COLOURS[kinds[first].kind], lw=0)
        upper.text(
            sum(span) / 2, 0.96, str(kinds[first]), ha="center", va="top", fontsize=8, rotation=90,
            transform=upper.get_xaxis_transform(), color="0.3",
        )  # fmt: skip
    for k in cuts[1:-1]:
        upper.axvline(times[k], color="0.5", lw=0.7)
    distance = np.array([answer.distance for answer in answers])
    bound = np.array([answer.lower_bound for answer in answers])
    upper.plot(times, distance, color=INK, lw=1.6)
    upper.set_ylim(0.0, 1.35 * distance.max())
    upper.set_ylabel("distance")
    upper.set_title("active feature of the lens, and the distance", fontsize=9, loc="left")
    lower.semilogy(times, distance - bound, color="#a03030", lw=1.2)
    lower.set_ylim(1e-15, 1e-9)
    lower.set_ylabel("distance −\nlower bound")
    lower.set_xlabel("time, s")
    for axes in (upper, lower):
        axes.axvline(SHOWN, color=INK, lw=0.9, ls=":")
        axes.set_xlim(times[0], times[-1])
        axes.spines[["top", "right"]].set_visible(False)
        axes.tick_params(labelsize=8)
    upper.tick_params(labelbottom=False)


def main():
    default = Path(__file__).parent / "standoff.png"
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else default
    times, answers, path = track()
    if not all(answer.certified for answer in answers):
        raise SystemExit("A frame is not certified: no picture drawn.")
    plt.rcParams["font.size"] = 9
    figure = plt.figure(figsize=(9.6, 4.0), dpi=110)
    grid = figure.add_gridspec(2, 2, width_ratios=(1.15, 1.0), height_ratios=(2.1, 1.0))
    scene = figure.add_subplot(grid[:, 0])
    shown, a, b = draw_scene(scene, times, answers, path)
    label(scene, f"witness point on the lens,\non its {shown.feature_a}", a, (85, -95))
    label(scene, "witness point\non the tool", b, (75, 35))
    label(scene, f"distance {shown.distance:.4f},\nalong the normal", 0.5 * (a + b), (-125, 50))
    draw_strips(figure.add_subplot(grid[0, 1]), figure.add_subplot(grid[1, 1]), times, answers)
    figure.tight_layout()
    handle, name = tempfile.mkstemp(suffix=".png", dir=target.parent)
    os.close(handle)
    figure.savefig(name)
    os.replace(name, target)
    switches = [str(e.source) + " to " + str(e.target) for p in answers for e in p.events]
    print(f"{target}: {target.stat().st_size} bytes; switches: {', '.join(switches)}")


if __name__ == "__main__":
    main()
