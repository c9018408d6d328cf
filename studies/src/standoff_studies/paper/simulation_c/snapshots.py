"""Fig. 14: twelve moments of the motion, with the active features; and the motion itself."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from standoff.motion import Pose
from standoff.typing import Array
from standoff_studies.paper import style
from standoff_studies.paper.drawing import (
    draw_feature,
    draw_planar_body,
    draw_witness_line,
    outline,
    short_name,
)
from standoff_studies.paper.figure import Animation, Artwork, Statement, measured_by
from standoff_studies.paper.pair_simulation import Simulation
from standoff_studies.paper.simulation_c.kinds import KINDS, kind_of, mode_name
from standoff_studies.paper.simulation_c.run import (
    RADIUS,
    SIMULATION,
    snapshots,
)

COLUMNS = 3
MARGIN = 0.12
"""Margin around the bodies in a snapshot [length]."""
RULER = 1.0
"""Length of the drawn scale."""

PICTURES = 100
"""Frames of the animation."""
EXTENT = RADIUS + 0.75
"""Half width of the animation's view: B's tips stay within [length]."""
SECONDS = 0.08
"""A frame of the animation on the screen [s]."""


def figure_14() -> Artwork:
    """Make Fig. 14."""
    simulation = SIMULATION
    times = [snapshot.time for snapshot in snapshots()]
    return Artwork(
        caption=(
            "Twelve moments of the motion, the middles of twelve equal parts of it, all at one "
            f"scale; the printed system at K = {simulation.gain:g}/s from a wrong start. A (solid, "
            "blue) rests; B (dashed, vermilion) spins while its centre spirals in. Thick curves "
            "and squares are the active features, named in the middle of their bodies; the black "
            "line joins the witness points, the thin grey one under it those of the library's own "
            "law. Titles: time [s], mode (A's feature, then B's), distance d [length]. The "
            "animation shows the whole motion; grey is the way of B's centre."
        ),
        text=(
            "Twelve small pictures of two planar bodies joined by a witness line, "
            f"a second apart from {times[0]:.2f} s to {times[-1]:.2f} s."
        ),
        draw=lambda: _draw(simulation),
        tables={"snapshots": _table(simulation)},
        statements=measured_by(simulation.by, _statements(simulation)),
        animation=Animation(
            PICTURES,
            lambda figure, k: _draw_moment(figure, simulation, k),
            SECONDS,
            (5.6, 5.6),
            "B spins and spirals in; the witness line and the active features follow.",
        ),
    )


def _table(simulation: Simulation) -> dict[str, ArrayLike]:
    recording, found = simulation.paper, snapshots()
    frames = [snapshot.frame for snapshot in found]
    table: dict[str, ArrayLike] = {
        "snapshot": [snapshot.letter for snapshot in found],
        "time_s": [snapshot.time for snapshot in found],
        "feature_a": [short_name(snapshot.feature_a) for snapshot in found],
        "feature_b": [short_name(snapshot.feature_b) for snapshot in found],
        "distance_length": list(recording.distance[frames]),
    }
    for name, points in (("a", recording.point_a), ("b", recording.point_b)):
        for k, axis in enumerate("xy"):
            table[f"witness_{name}_{axis}_length"] = list(points[frames, k])
    return table


def _statements(simulation: Simulation) -> tuple[Statement, ...]:
    exact = simulation.exact
    kinds = [kind_of(*snapshot[3:]) for snapshot in snapshots()]
    frames = [snapshot.frame for snapshot in snapshots()]
    right = sum(
        (exact.feature_a[frame], exact.feature_b[frame]) == snapshot[3:]
        for frame, snapshot in zip(frames, snapshots(), strict=True)
    )
    ends = [simulation.paths[1].pose(t) for t in (0.0, simulation.duration)]
    centres = [np.linalg.norm(pose.translation) for pose in ends]
    return (
        Statement(
            "Fig. 14",
            "twelve snapshots, each with its active features",
            f"in {right} of {len(kinds)} the active features are those of the closest points, and "
            f"witness points at most {simulation.witness_error[frames].max():.0e} length off; "
            + ", ".join(f"{kinds.count(k)} {KINDS[k]}" for k in range(3)),
            right == len(kinds) == 12,
        ),
        Statement(
            "Fig. 14",
            "B spins while its centre spirals in towards A",
            f"centre from {centres[0]:.2f} to {centres[1]:.2f} length; least distance "
            f"{exact.distance.min():.3f}, proven {exact.lower_bound.min():.3f} length",
            bool(centres[1] < centres[0] and exact.lower_bound.min() > 0.0),
            "the motion is ours",
            simulation.own,
            constructed=True,
        ),
    )


def _draw(simulation: Simulation) -> Figure:
    figure = style.new_figure(style.WIDTH, 8.8)
    rows = len(snapshots()) // COLUMNS
    panels = figure.subplots(rows, COLUMNS).ravel().tolist()
    boxes = [_box(simulation, snapshot.time) for snapshot in snapshots()]
    half = 0.5 * np.max([np.ptp(box, axis=0) for box in boxes], axis=0) + MARGIN
    for axes, snapshot, box in zip(panels, snapshots(), boxes, strict=True):
        _draw_pair(axes, simulation, snapshot.frame)
        middle = box.mean(axis=0)
        axes.set_xlim(middle[0] - half[0], middle[0] + half[0])
        axes.set_ylim(middle[1] - half[1], middle[1] + half[1])
        axes.set_axis_off()
        name = mode_name(snapshot.feature_a, snapshot.feature_b)
        distance = simulation.paper.distance[snapshot.frame]
        axes.set_title(f"({snapshot.letter}) {snapshot.time:.2f} s  {name}\nd = {distance:.3f}")
    corner = panels[0].get_xlim()[0], panels[0].get_ylim()[0]
    _draw_ruler(panels[0], (corner[0] + MARGIN, corner[1] + 2.0 * MARGIN))
    return figure


def _box(simulation: Simulation, time: float) -> Array:
    """The corners of the box around both bodies, (2, 2) [length]."""
    both = outline(simulation.a), outline(simulation.b, simulation.paths[1].pose(time))
    points = np.vstack(both)
    return np.array([points.min(axis=0), points.max(axis=0)])


def _draw_pair(axes: Axes, simulation: Simulation, frame: int) -> None:
    recording, exact = simulation.paper, simulation.exact
    pose = simulation.paths[1].pose(float(recording.time[frame]))
    sides = (
        (simulation.a, Pose.identity(), recording.feature_a[frame], style.BLUE, "-"),
        (simulation.b, pose, recording.feature_b[frame], style.RED, (0, (4, 1.5))),
    )
    for body, where, feature, colour, dashes in sides:
        draw_planar_body(axes, body, where, colour=colour, linestyle=dashes, linewidth=1.2)
        draw_feature(axes, body, feature, where, colour=colour)
        x, y = outline(body, where).mean(axis=0).tolist()
        name = short_name(feature)
        axes.text(x, y, name, ha="center", va="center", color=colour, fontweight="bold")
    ends = exact.point_a[frame], exact.point_b[frame]
    draw_witness_line(axes, *ends, color=style.QUIET, linewidth=3.4, markersize=5.0, zorder=4)
    draw_witness_line(axes, recording.point_a[frame], recording.point_b[frame])


def _draw_ruler(axes: Axes, start: tuple[float, float]) -> None:
    x, y = start
    axes.plot([x, x + RULER], [y, y], "|-", color=style.BLACK, linewidth=1.2)
    axes.text(x + 0.5 * RULER, y + 0.06, f"{RULER:g} length", ha="center", va="bottom")


def _draw_moment(figure: Figure, simulation: Simulation, k: int) -> None:
    """Draw one picture of the animation: frame k of `PICTURES` over the whole motion."""
    recording = simulation.paper
    frame = round(k / (PICTURES - 1) * (len(recording) - 1))
    axes = figure.subplots()
    times = np.linspace(0.0, frame * simulation.step, 2 + frame // 50)
    trail = np.array([simulation.paths[1].pose(time).translation for time in times.tolist()])
    axes.plot(trail[:, 0], trail[:, 1], color=style.QUIET, linewidth=1.0)
    _draw_pair(axes, simulation, frame)
    axes.set_xlim(-EXTENT, EXTENT)
    axes.set_ylim(-EXTENT, EXTENT)
    axes.set_xlabel("x [length]")
    axes.set_ylabel("y [length]")
    mode = recording.feature_a[frame], recording.feature_b[frame]
    axes.set_title(
        f"{recording.time[frame]:5.2f} s   {mode_name(*mode)} ({KINDS[kind_of(*mode)]})   "
        f"d = {recording.distance[frame]:.3f}"
    )
