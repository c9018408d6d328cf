"""Fig. 16: the lens with its external Voronoi regions, the helix and witness lines."""

from __future__ import annotations

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from standoff.bodies import Body
from standoff.bodies.tessellation import edge_lines
from standoff.bodies.voronoi import voronoi_regions
from standoff.tracking import Feature
from standoff.typing import Array
from standoff_studies.paper import style
from standoff_studies.paper.drawing_3d import LOOKS, View
from standoff_studies.paper.figure import Animation, Artwork, Statement, measured_by, own_statement
from standoff_studies.paper.keys import key_below, key_fill, key_line
from standoff_studies.paper.pair_simulation import Simulation, certified
from standoff_studies.paper.patch_places import short
from standoff_studies.paper.simulation_d.runs import (
    HELIX,
    SETTLED,
    SIMULATION,
    sequence,
    settling_steps,
)
from standoff_studies.paper.voronoi_drawing import draw_space_regions

AZIMUTH, ELEVATION = 40.0, 26.0
"""Direction of the viewer [degrees]: to the side of the helix's axis, above the upper vertex."""

WITNESS_LINES = 22
"""Witness lines of Fig. 16, evenly spaced in time."""

EARLY = 0.03
"""Time between the witness lines of the initial convergence [s]."""

REACH = 0.42
"""How far the drawn part of a Voronoi surface extends from the lens [length]."""

SLOW, APART, FRAMES = 14, 15, 80
"""Pictures of the animation: in its slow beginning, at which spacing in samples, and in total."""

KINDS = ("face", "edge", "vertex")

REGION_COLOUR = style.QUIET
LIT, UNLIT = "#7CC4F0", "#E2E2E2"
"""The active face of the animation, and the others."""


def figure_16() -> Artwork:
    """Draw the lens, the helix and witness lines."""
    runs = SIMULATION
    recording = runs.paper
    names = [str(feature) for feature in recording.feature_a]
    table: dict[str, ArrayLike] = {
        "time_s": recording.time,
        **{f"point_{x}": recording.point_b[:, k] for k, x in enumerate("xyz")},
        **{f"witness_{x}": recording.point_a[:, k] for k, x in enumerate("xyz")},
        "distance": recording.distance,
        "lower_bound": recording.lower_bound,
        "projection_error": recording.residual,
        "feature": names,
    }
    return Artwork(
        caption=(
            "Simulation D: a lens of three four-sided patches (u and v lines grey) and a point on "
            "a helix (thick black). Witness lines are drawn every "
            f"{runs.duration / WITNESS_LINES:.2g} s; their mark and colour tell the kind of the "
            "closest feature. Grey sheets (so.voronoi_regions) bound the external regions of the "
            "edges and vertices: a witness line changes its kind where the helix crosses one. The "
            "dashed line leads to the wrong point where the printed system was started on purpose, "
            f"at K = {runs.gain:g}/s; thin purple lines are its first ones, {1e3 * EARLY:.0f} ms "
            "apart. The path of its point is green, that of the library's own law thin. Lengths "
            "are in the radius of the lens's faces."
        ),
        text=(
            "A convex body like a three-sided lemon with sharp edges stands upright inside a "
            "helix with a nearly level axis. Straight lines join points of the helix with the "
            "nearest points of the body: on faces, on the three edges and at the upper vertex."
        ),
        draw=_draw,
        tables={"run": table},
        statements=measured_by(runs.by, _statements(runs)),
        animation=Animation(
            frames=FRAMES,
            draw=_draw_frame,
            seconds=0.07,
            size=(4.4, 4.4),
            text=(
                "The point goes along the helix; the line to its closest point on the lens turns "
                "with it, and the active face, edge or vertex of the lens is lit."
            ),
        ),
    )


def _statements(runs: Simulation) -> tuple[Statement, ...]:
    visits = runs.stays
    seen = {kind: sum(f"{kind} " in name for name in set(sequence(visits))) for kind in KINDS}
    steps = [settling_steps(recording) for recording in runs.printed]
    return (
        Statement(
            "Fig. 16",
            "the point on the helix visits faces, edges and a vertex of the lens",
            f"{seen['face']} faces, {seen['edge']} edges and {seen['vertex']} vertex in "
            f"{len(visits)} stays",
            set(sequence(visits)) >= {"face 0", "edge 0", "vertex 1"},
            "the helix is ours, chosen so that it does",
            constructed=True,
        ),
        own_statement(
            "Fig. 16",
            f"from wrong starts on faces {', '.join(str(place[0][1]) for place, _ in runs.starts)} "
            f"the projection errors fall below {SETTLED:g} in "
            f"{', '.join(str(count) for count in steps)} steps of 1 ms",
        ),
        certified(runs, "Fig. 16"),
    )


def _draw() -> Figure:
    runs = SIMULATION
    recording = runs.paper
    figure = style.new_figure(style.WIDTH, 6.6)
    axes = figure.add_subplot()
    view = View(AZIMUTH, ELEVATION)
    view.body(runs.a)
    between = voronoi_regions(runs.a, REACH)
    draw_space_regions(view, between, colours=(REGION_COLOUR, REGION_COLOUR), opacity=0.2)
    first = settling_steps(recording)
    view.line(recording.point_a[first:], style.GREEN, 2.0, rank=1.5)
    view.line(recording.point_b, style.BLACK, 2.2)
    wrong = [recording.point_a[0], recording.point_b[0]]
    view.line(wrong, style.PURPLE, 1.3, dashes=(0.06, 0.04))
    view.mark(wrong[0], style.PURPLE, "D", 0.045)
    view.line(recording.point_a[: first + 1], style.PURPLE, 1.6, rank=1.5)
    view.line(runs.exact.point_a, style.BLACK, 0.7, rank=1.6)
    for k in range(0, first, round(EARLY / runs.step)):
        view.line([recording.point_a[k], recording.point_b[k]], style.PURPLE, 0.7)
    for k in np.linspace(first, len(recording) - 1, WITNESS_LINES).astype(int).tolist():
        _witness(view, recording.point_a[k], recording.point_b[k], recording.feature_a[k])
    view.paint(axes)
    _name_parts(axes, view, runs.a)
    _name_ends(axes, view)
    view.triad(axes, (1.75, -1.3), 0.4, "radius")
    key_below(figure, _key(), 3)
    return figure


def _witness(view: View, foot: Array, point: Array, feature: Feature) -> None:
    colour, shape = LOOKS[feature.kind]
    view.line([foot, point], colour, 1.3)
    view.mark(foot, colour, shape, 0.035)
    view.mark(point, colour, shape, 0.035)


def _name_parts(axes: Axes, view: View, lens: Body) -> None:
    """Name the features that face the viewer."""
    for number, face in enumerate(lens.face_parts):
        x, xu, xv = face.charts[0].jet(0.5, 0.45)[:3]
        normal = np.cross(xu, xv)
        if view.faces(normal * np.sign(normal @ x)):
            view.text(axes, x, f"F{number}", color="#404040")
    for line in edge_lines(lens):
        middle = len(line.points) // 2
        if view.faces(line.normals[:, middle].sum(axis=0), 0.3):
            view.text(axes, line.points[middle], f"E{line.edge}", fontweight="bold")
    for number, vertex in enumerate(lens.vertex_points):
        if view.faces(vertex):
            view.text(axes, 1.1 * np.asarray(vertex), f"V{number}", fontweight="bold")


def _name_ends(axes: Axes, view: View) -> None:
    for time, words in ((0.0, "start"), (SIMULATION.duration, "end")):
        place = HELIX.pose(time).translation
        middle = np.asarray(HELIX.pose(0.5 * SIMULATION.duration).translation)
        away = view.flat(place) - view.flat(0.5 * middle)
        x, y = view.flat(place) + 0.22 * away / np.linalg.norm(away)
        axes.text(float(x), float(y), words, ha="center", va="center")


def _key() -> list[Artist]:
    return [
        *(key_line(f"closest: {kind}", look, marker=mark) for kind, (look, mark) in LOOKS.items()),
        key_line("helix", style.BLACK, 2.2),
        key_line("path of the law's point", style.GREEN, 2.0),
        key_line("library's law", style.BLACK, 0.7),
        key_line("wrong start", style.PURPLE, dashes="--", marker="D"),
        key_fill("Voronoi surfaces", REGION_COLOUR, alpha=0.35),
    ]


def _draw_frame(figure: Figure, number: int) -> None:
    runs = SIMULATION
    recording = runs.paper
    rest = len(recording) - 1 - APART * SLOW
    k = APART * min(number, SLOW) + round(max(0, number - SLOW) / (FRAMES - 1 - SLOW) * rest)
    feature = recording.feature_a[k]
    colour, shape = LOOKS[feature.kind]
    axes = figure.add_subplot()
    view = View(AZIMUTH, ELEVATION)
    lit = [
        LIT if feature.kind == "face" and feature.index == face else UNLIT
        for face in range(runs.a.n_faces)
    ]
    view.body(runs.a, colours=lit, grid=12, lines=1)
    if feature.kind == "edge":
        view.line(edge_lines(runs.a)[feature.index].points, colour, 4.0)
    if feature.kind == "vertex":
        view.mark(runs.a.vertex_points[feature.index], colour, shape, 0.09)
    view.line(recording.point_b[k::20], style.QUIET, 0.8, dashes=(0.05, 0.05))
    if k:
        view.line(recording.point_b[: k + 1 : 10 if k > 20 else 1], style.BLACK, 1.8)
    _witness(view, recording.point_a[k], recording.point_b[k], feature)
    view.paint(axes)
    across = view.flat(recording.point_b)
    axes.set_xlim(*(across[:, 0].min() - 0.1, across[:, 0].max() + 0.1))
    axes.set_ylim(*(across[:, 1].min() - 0.1, across[:, 1].max() + 0.1))
    axes.set_title(f"t = {recording.time[k]:.3f} s: {feature} ({short(feature)})")
