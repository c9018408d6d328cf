"""A picture of a world's bodies with the closest points of its worst pairs."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from graphlib import CycleError, TopologicalSorter
from typing import Any, NamedTuple

import numpy as np
import scipy

from standoff.bodies.body import Body
from standoff.bodies.drawing.body_view import FACE_COLOURS, across, direction_to_viewer, frame
from standoff.bodies.drawing.pair_picture import USUAL_VIEW, seen_from
from standoff.bodies.drawing.solids import Look, PictureSurface, draw_solid, solid_of
from standoff.bodies.tessellation import EdgeLine
from standoff.bodies.tolerances import FLAT_CLOUD
from standoff.clearance.report import PairRow, Report, gap_text
from standoff.clearance.verdicts import Verdict
from standoff.errors import of_extra
from standoff.motion import Pose
from standoff.motion.vectors import pose_row
from standoff.solids.planar.loops import points_along
from standoff.tracking import distance
from standoff.typing import Array
from standoff.wording import at_least, at_most, short_name
from standoff.world import Compound, World
from standoff.world.shapes import boundary_of

with of_extra("matplotlib", "plot"):
    from matplotlib.artist import Artist
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch, PathPatch
    from matplotlib.path import Path
    from matplotlib.patheffects import AbstractPathEffect, withStroke
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

MOST_PAIRS = 5
"""Pairs whose closest points are drawn and numbered."""

MOST_PIECES = 60
"""Pieces that are drawn; of more, those of the numbered pairs' bodies alone."""

OTHERS = "#DADADA"
"""Colour of bodies of none of the numbered pairs."""

FAINT, THROUGH = 0.22, 0.62
"""Opacity of these, and of bodies that overlap."""

NUMBER: Mapping[str, Any] = {"fontsize": 11, "fontweight": "bold"}
HALO: list[AbstractPathEffect] = [withStroke(linewidth=2.5, foreground="white")]
"""How a pair's number is written: it may stand on a dark body."""

ON_TOP = 10_000
"""Order in which the closest points are drawn: above all bodies."""


class PicturedPart(NamedTuple):
    """A piece of a body, where it is in the world."""

    owner: str
    solid: PictureSurface
    pose: Pose

    @property
    def flat(self) -> Array:
        """Its pose (12,), R row-major, p."""
        return pose_row(self.pose.rotation, self.pose.translation)

    @property
    def cloud(self) -> Array:
        """World points of its surface, (n, 3)."""
        return np.asarray(self.pose.apply(self.solid.points))


def numbered_rows(report: Report) -> tuple[PairRow, ...]:
    """Return the pairs whose closest points are drawn: the worst ones."""
    return report.rows[:MOST_PAIRS]


def world_figure(report: Report, poses: Mapping[str, Pose], unit: str) -> Figure:
    """Draw the bodies of a report at their poses.

    Parameters
    ----------
    report : Report
        Its first pairs are numbered, and their bodies are coloured; the others are faint.
    poses : mapping of str to Pose
        World poses of all bodies.
    unit : str
        Label of lengths.
    """
    rows = numbered_rows(report)
    coloured = list(dict.fromkeys(name for row in rows for name in row.names))
    parts = parts_of(report.world, poses, coloured)
    looks = _looks(parts, rows, coloured)
    # Not through pyplot, which would ask for a display and keep the figure alive.
    figure = Figure(figsize=(9.0, 7.6), dpi=130)
    FigureCanvasAgg(figure)
    if report.world.dimension == 2:
        _draw_planar(figure, parts, looks, rows, unit)
    else:
        _draw_spatial(figure, parts, looks, rows, unit)
    look: Any = {"frameon": False, "fontsize": "small", "borderaxespad": 0.6}
    own = {name: colour_of(name, coloured) for name in coloured}
    figure.legend(handles=bodies_legend(coloured, own), loc="lower left", ncols=2, **look)
    figure.legend(handles=pairs_legend(rows, unit), loc="lower right", **look)
    return figure


def parts_of(
    world: World, poses: Mapping[str, Pose], coloured: Sequence[str]
) -> list[PicturedPart]:
    """Return the pieces of a world's bodies as they are drawn; of very many those of the coloured
    bodies alone."""
    bodies = world.bodies
    count = sum(len(b) if isinstance(b, Compound) else 1 for b in bodies.values())
    names = list(bodies) if count <= MOST_PIECES else list(coloured)
    solids: dict[int, PictureSurface] = {}
    parts = []
    for name in names:
        body = bodies[name]
        pieces = body.pieces.values() if isinstance(body, Compound) else [(body, Pose.identity())]
        for shape, pose in pieces:
            if id(shape) not in solids:
                solids[id(shape)] = _drawn(boundary_of(shape))
            parts.append(PicturedPart(name, solids[id(shape)], poses[name] @ pose))
    return parts


def _drawn(shape: Any) -> PictureSurface:
    """A body's surface, or the edges of a planar solid."""
    if not hasattr(shape, "outline"):
        return solid_of(shape)
    lines = [line for loop in shape.loops for line in points_along(loop)]
    none, empty = np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)
    edges = [EdgeLine(k, line, none[None], False) for k, line in enumerate(lines)]
    return PictureSurface(shape, np.concatenate(lines), none, empty, empty[:, 0], edges)


def _looks(
    parts: Sequence[PicturedPart], rows: Sequence[PairRow], coloured: Sequence[str]
) -> list[Look]:
    """Colour and opacity of each part; the order is set later."""
    deep = {name for row in rows if row.verdict is Verdict.OVERLAPPING for name in row.names}
    looks = []
    for part in parts:
        if part.owner not in coloured:
            looks.append(Look(OTHERS, OTHERS, 0, FAINT))
            continue
        colour = colour_of(part.owner, coloured)
        looks.append(Look(colour, colour, 0, THROUGH if part.owner in deep else 1.0))
    return looks


def colour_of(name: str, coloured: Sequence[str]) -> str:
    """Return the colour of a body of a numbered pair."""
    return FACE_COLOURS[coloured.index(name) % len(FACE_COLOURS)]


def _draw_spatial(
    figure: Figure, parts: list[PicturedPart], looks: list[Look], rows: Sequence[PairRow], unit: str
) -> None:
    axes: Any = figure.add_axes((0.0, 0.12, 1.0, 0.88), projection="3d", computed_zorder=False)
    towards = direction_to_viewer(USUAL_VIEW)
    axes.view_init(*USUAL_VIEW)
    axes.set_proj_type("ortho")
    for order, k in enumerate(back_to_front(parts, towards)):
        look = looks[k]._replace(order=2 * order)
        solid = parts[k].solid
        if look.opacity < 1.0:
            _draw_outline(axes, parts[k], towards, look)
            solid = replace(solid, triangles=solid.triangles[:0])
        if len(solid.triangles) or solid.lines:
            draw_solid(axes, solid, parts[k].flat, towards, look, None)
    for number, row in enumerate(rows, 1):
        ends = np.array([row.answer.point_a, row.answer.point_b])
        axes.plot(*ends.T, "-o", color="black", linewidth=1.5, markersize=3.5, zorder=ON_TOP)
        spot = axes.text(*ends.mean(axis=0), f" {number}", va="bottom", zorder=ON_TOP + 1, **NUMBER)
        spot.set_path_effects(HALO)
    bounded = [part.cloud for part in parts if part.solid.body.bounded]
    cloud = np.concatenate(bounded or [part.cloud for part in parts])
    frame(axes, seen_from(cloud, towards), 0.0, towards, unit)


def _draw_outline(axes: Any, part: PicturedPart, towards: Array, look: Look) -> None:
    """A body as one translucent area, which is convex as the body is: between triangles hairlines
    would show."""
    cloud = part.cloud
    seen = cloud @ np.stack(across(towards)).T
    if (
        np.linalg.matrix_rank(seen - seen[0], tol=FLAT_CLOUD * float(np.ptp(seen, axis=0).max()))
        < 2
    ):
        axes.plot(*cloud.T, ".-", color=look.colour, linewidth=3.0, zorder=look.order)
        return
    area = cloud[scipy.spatial.ConvexHull(seen).vertices]
    axes.add_collection3d(
        Poly3DCollection(
            [area],
            facecolor=look.colour,
            edgecolor="0.6",
            linewidths=0.7,
            alpha=look.opacity,
            zorder=look.order,
        )
    )


def back_to_front(parts: Sequence[PicturedPart], towards: Array) -> list[int]:
    """Return the order in which parts are drawn: none over one that is in front of it.

    A plane across the normal parts two convex bodies, and so says which one is in front; of those
    that overlap the farther middle is drawn first.
    """
    right, up = across(towards)
    clouds = [part.cloud @ np.stack([right, up, towards]).T for part in parts]
    boxes = [(cloud.min(axis=0), cloud.max(axis=0)) for cloud in clouds]
    depth = [0.5 * float(low[2] + high[2]) for low, high in boxes]
    behind: dict[int, set[int]] = {
        k: set() for k in sorted(range(len(parts)), key=depth.__getitem__)
    }
    for i in range(len(parts)):
        for j in range(i):
            (low, high), (lower, higher) = boxes[i], boxes[j]
            if (high[:2] < lower[:2]).any() or (higher[:2] < low[:2]).any():
                continue
            forward = _forward(parts[i], parts[j], towards)
            if forward > 0.0:
                behind[j].add(i)
            elif forward < 0.0:
                behind[i].add(j)
    try:
        return list(TopologicalSorter(behind).static_order())
    except CycleError:
        return sorted(range(len(parts)), key=depth.__getitem__)


def _forward(a: PicturedPart, b: PicturedPart, towards: Array) -> float:
    """Above zero where b is in front of a, below where it is behind, 0 where neither is known."""
    bodies: list[Body] = [a.solid.body, b.solid.body]
    if not any(body.bounded for body in bodies):
        return 0.0
    found = distance(bodies[0], bodies[1], a.pose, b.pose)
    return float(found.normal @ towards) if found.distance >= 0.0 else 0.0


def _draw_planar(
    figure: Figure, parts: list[PicturedPart], looks: list[Look], rows: Sequence[PairRow], unit: str
) -> None:
    axes = figure.add_axes((0.1, 0.22, 0.86, 0.74))
    for part, look in zip(parts, looks, strict=True):
        lines = [part.pose.apply(line.points)[:, :2] for line in part.solid.lines]
        if lines:
            # holes run the other way round, so they stay empty
            ends = np.cumsum([len(loop.curves) for loop in getattr(part.solid.body, "loops", ())])
            starts = [0, *ends[:-1]]
            loops = [lines[i:j] for i, j in zip(starts, [*ends[:-1], len(lines)], strict=True)]
            whole = Path.make_compound_path(*(Path(np.concatenate(loop)) for loop in loops))
            fill = {"facecolor": look.colour, "alpha": min(look.opacity, THROUGH)}
            axes.add_patch(PathPatch(whole, edgecolor="none", **fill))
        for line in lines:
            axes.plot(*line.T, color="black", linewidth=0.9)
        if not lines:
            axes.plot(*part.cloud[:, :2].T, "o", color="black", markersize=3)
    for number, row in enumerate(rows, 1):
        ends = np.array([row.answer.point_a, row.answer.point_b])[:, :2]
        axes.plot(*ends.T, "-o", color="black", linewidth=1.5, markersize=3.5)
        spot = axes.annotate(
            str(number), ends.mean(axis=0), xytext=(4, 4), textcoords="offset points", **NUMBER
        )
        spot.set_path_effects(HALO)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel(f"x ({unit})" if unit else "x")
    axes.set_ylabel(f"y ({unit})" if unit else "y")
    axes.grid(alpha=0.3)


def bodies_legend(coloured: Sequence[str], colours: Mapping[str, Any]) -> list[Artist]:
    return [Patch(facecolor=colours[name], label=short_name(name)) for name in coloured]


def pairs_legend(rows: Sequence[PairRow], unit: str) -> list[Artist]:
    handles: list[Artist] = []
    for number, row in enumerate(rows, 1):
        a, b = (short_name(name) for name in row.names)
        gap = row.answer.distance
        text = gap_text(row.answer, 4).removeprefix("-")
        told = f"{'depth' if gap < 0.0 else 'gap'} {text} {unit}".rstrip()
        if row.verdict is Verdict.TOUCHING:
            told = "touching"
        if row.verdict is Verdict.CONTAINED:
            told = f"inside, wall {text} {unit}".rstrip()
        if row.verdict is Verdict.UNDECIDED:
            told = undecided_gap(row, unit)
        label = f"{number}  {a} - {b}: {told}"
        handles.append(Line2D([], [], color="black", marker="o", markersize=3.5, label=label))
    return handles


def undecided_gap(row: PairRow, unit: str) -> str:
    """What is known of a pair that is not decided: the interval of its gap, below 0 a depth."""
    low, high = row.nearest.lower_bound, row.answer.upper_bound
    unit = f" {unit}" if unit else ""
    if low == -math.inf:
        return f"undecided, gap at most {at_most(high, 4)}{unit}"
    return f"undecided, gap {at_least(low, 4)} to {at_most(high, 4)}{unit}"
