"""Fig. 5, and below it a measured run: paths, force, distance, parameters and energy."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from standoff.bodies.features import Feature, feature_of
from standoff.typing import Array
from standoff_studies.paper import style
from standoff_studies.paper.drawing_3d import View
from standoff_studies.paper.figure import Artwork
from standoff_studies.paper.in_the_loop.diagram import draw_loop
from standoff_studies.paper.in_the_loop.run import (
    BALL,
    DURATION,
    GAIN,
    PERIOD,
    RADIUS,
    Runs,
    hand_pose,
    run,
)
from standoff_studies.paper.in_the_loop.statements import all_statements, by_gain
from standoff_studies.paper.keys import key_line
from standoff_studies.paper.patch_places import place_on, short
from standoff_studies.paper.simulation_d.parameters import SHADES

AZIMUTH, ELEVATION = 62.0, 30.0
"""Where the viewer stands [degrees]: above the edge that is crossed."""

LEAST_NAMED = 0.2
"""Shortest stay that is named in line [s]."""

MM = 1e3
"""Millimetres in a metre."""


def figure_5() -> Artwork:
    """Draw the diagram and the run."""
    runs = run()
    return Artwork(
        caption=(
            "Above: the paper's Fig. 5. Thick boxes integrate; red: poses and twists. In "
            "the dashed frame, bodies and witness points are one state, advanced by one method. "
            f"Below, a run ({1e3 * PERIOD:g} ms, Heun, K = {GAIN:g}/s): a scripted hand drags a "
            f"ball of {MM * BALL:g} mm over the lens of simulation D, whose faces have a radius of "
            f"{MM * RADIUS:g} mm. It means to be inside; the ball stays out, and the coupler's "
            "spring is what is felt. Forces, signed distance, where device and aim are off the "
            "ball along the normal, the face's parameters (on an edge those of a face beside it), "
            "and energies. Tinted: the closest feature is an edge; grey: the vertex V1."
        ),
        text=(
            "A block diagram with a human, a haptic device and a virtual coupler on the left and, "
            "in a dashed frame, forward dynamics, tracker, collision detector and contact force. "
            "Below, the path of the ball runs over two faces of the lens, its upper vertex and an "
            "edge, that of the device a little below; force and depth are smooth where the "
            "feature changes."
        ),
        draw=_draw,
        tables={"run": _table(runs), "gains": by_gain()},
        statements=all_statements(runs),
        shown=("gains",),
    )


def features(runs: Runs) -> list[Feature]:
    """Return the lens's feature of each record."""
    return [feature_of(runs.lens, int(number)) for number in runs.answers.mode[:, 0]]


def stays(runs: Runs) -> list[tuple[float, float, Feature]]:
    """Return (begin, end, feature) of each stay [s]."""
    found, times = features(runs), runs.inside.times
    cuts = [0, *(k for k in range(1, len(found)) if found[k] != found[k - 1]), len(found) - 1]
    return [(float(times[a]), float(times[b]), found[a]) for a, b in pairwise(cuts)]


def parameters(runs: Runs) -> Array:
    """Return face, u and v of each record, (n, 3); on an edge, those of an adjacent face."""
    face, rows = 0, []
    for feature, q in zip(features(runs), runs.answers.q, strict=True):
        face = feature.index if feature.kind == "face" else face
        faces = (face, *range(runs.lens.n_faces))  # the last one, or another one beside the edge
        found = ((k, place_on(runs.lens, k, feature, q[:2])) for k in faces)
        face, place = next((k, place) for k, place in found if place is not None)
        rows.append((face, place.u, place.v))
    return np.array(rows)


def _table(runs: Runs) -> dict[str, ArrayLike]:
    made, coupler = runs.inside, runs.coupler
    table: dict[str, ArrayLike] = {"time_s": made.times}
    for k, axis in enumerate("xyz"):
        table[f"device_{axis}_m"] = coupler.handle_positions[:, k]
        table[f"tool_{axis}_m"] = made.positions(1)[:, k]
        table[f"contact_force_{axis}_n"] = made.forces[:, 0, k]
        table[f"coupler_force_on_device_{axis}_n"] = coupler.on_device[:, k]
    energy = made.energy
    return table | {
        "distance_m": made.distances[:, 0],
        "certified_distance_m": runs.exact,
        "feature": [str(feature) for feature in features(runs)],
        **dict(zip(("face", "u", "v"), parameters(runs).T, strict=True)),
        "hand_work_j": coupler.energy.device,
        "stored_in_coupler_j": coupler.stored,
        "lost_in_coupler_j": coupler.damped,
        "kinetic_j": energy.kinetic,
        "stored_in_contact_j": energy.stored,
        "lost_in_contact_j": energy.dissipated,
    }


def _draw() -> Figure:
    runs = run()
    figure = style.new_figure(style.WIDTH, 11.6)
    grid = figure.add_gridspec(4, 2, height_ratios=(1.2, 1.3, 0.85, 0.85))
    draw_loop(figure.add_subplot(grid[0, :]))
    _draw_scene(figure.add_subplot(grid[1, 0]), runs)
    panels = [figure.add_subplot(grid[place]) for place in ((1, 1), (2, 0), (2, 1), (3, 0))]
    energy = figure.add_subplot(grid[3, 1])
    for draw, axes in zip(
        (_draw_force, _draw_distance, _draw_paths, _draw_parameters), panels, strict=True
    ):
        _shade(axes, runs)
        draw(axes, runs)
        axes.set_xlim(0.0, DURATION)
    _name(panels[0], runs)
    _draw_energy(energy, runs)
    for axes in (panels[3], energy):
        axes.set_xlabel("time [s]")
    return figure


def _draw_scene(axes: Axes, runs: Runs) -> None:
    """The lens with the paths of the ball's centre, of the device and of the witness point."""
    view = View(AZIMUTH, ELEVATION)
    view.body(runs.lens.transformed(np.eye(3) / RADIUS))
    tool = runs.inside.positions(1) / RADIUS
    handle = runs.coupler.handle_positions[1:] / RADIUS
    touching = np.flatnonzero(runs.inside.spots[:, 0] > 0)
    foot = runs.answers.point_a[touching] / RADIUS
    view.line(handle, style.RED, 1.5, dashes=(0.06, 0.04), rank=1.2)
    view.line(tool, style.BLACK, 2.0, rank=1.2)
    view.line(foot, style.GREEN, 2.4, rank=1.5)
    view.mark(tool[0], style.BLACK, "o", 0.035)
    view.paint(axes)
    view.text(axes, tool[0] * 1.13, "start")
    named: set[str] = set()
    for begin, end, feature in stays(runs):
        k = touching[(touching >= begin / PERIOD) & (touching <= end / PERIOD)]
        if len(k) and short(feature) not in named:
            named.add(short(feature))
            out = 0.86 if feature.kind == "vertex" else 0.93
            place = runs.answers.point_a[k[len(k) // 2]] / RADIUS
            view.text(axes, out * place, short(feature), fontweight="bold")
    handles = [
        key_line("tool", style.BLACK),
        key_line("device", style.RED, dashes="--"),
        key_line("witness point", style.GREEN),
    ]
    axes.legend(
        handles=handles,
        loc="upper center",
        bbox_to_anchor=(0.5, 0.02),
        ncols=3,
        frameon=False,
        columnspacing=1.0,
    )


def _shade(axes: Axes, runs: Runs) -> None:
    for begin, end, feature in stays(runs):
        if SHADES[feature.kind] is not None:
            axes.axvspan(begin, end, color=SHADES[feature.kind], linewidth=0.0, zorder=0)


def _name(axes: Axes, runs: Runs) -> None:
    """The stays on features, above."""
    for begin, end, feature in stays(runs):
        if end - begin > LEAST_NAMED:
            axes.text(
                0.5 * (begin + end),
                1.01,
                short(feature),
                transform=axes.get_xaxis_transform(),
                ha="center",
                va="bottom",
            )


def _draw_force(axes: Axes, runs: Runs) -> None:
    made = runs.inside
    touch = np.linalg.norm(made.forces[:, 0], axis=1)
    felt = np.linalg.norm(runs.coupler.on_device[:, :3], axis=1)
    axes.plot(made.times, touch, color=style.BLUE, label="of the contact")
    axes.plot(made.times, felt, "--", color=style.RED, label="on the device")
    axes.set(ylabel="force [N]", ylim=(-0.1, 1.45 * touch.max()))
    axes.legend(loc="upper left", ncols=2, columnspacing=1.0, handlelength=1.6)


def _draw_distance(axes: Axes, runs: Runs) -> None:
    distance = MM * runs.inside.distances[:, 0]
    axes.plot(runs.inside.times, distance, color=style.BLUE)
    axes.axhline(0.0, color=style.BLACK, linewidth=0.7)
    deepest = float(distance.min())
    axes.set_ylim(1.6 * deepest, -4.0 * deepest)
    axes.set_ylabel("distance [mm]")


def _draw_paths(axes: Axes, runs: Runs) -> None:
    """Distances of tool, device and hand from where the ball would just touch."""
    times = runs.inside.times
    tool = runs.inside.positions(1)
    out = tool - runs.answers.point_a
    normal = out / np.linalg.norm(out, axis=1)[:, None]
    apart = MM * (runs.coupler.handle_positions - tool)
    meant = MM * (np.array([hand_pose(t).translation for t in times]) - tool)
    axes.plot(times, np.sum(apart * normal, axis=1), "--", color=style.RED, label="device")
    axes.plot(times, np.sum(meant * normal, axis=1), ":", color=style.BLACK, label="hand’s aim")
    axes.axhline(0.0, color=style.BLACK, linewidth=0.7)
    axes.set_ylabel("off the tool, outward [mm]")
    axes.set_ylim(top=2.2)
    axes.legend(loc="upper right", ncols=2)


def _draw_parameters(axes: Axes, runs: Runs) -> None:
    rows, times = parameters(runs), runs.inside.times
    for column, name, colour, dashes in (
        (1, "u", style.BLUE, "-"),
        (2, "v", style.RED, "--"),
    ):
        label: str | None = name
        for face in np.unique(rows[:, 0]):
            values = np.where(rows[:, 0] == face, rows[:, column], np.nan)
            axes.plot(times, values, dashes, color=colour, label=label)
            label = None
    axes.set(ylabel="face parameters", ylim=(-0.05, 1.35), yticks=[0.0, 0.5, 1.0])
    axes.legend(loc="upper left", ncols=2, columnspacing=1.0, handlelength=1.6)


def _draw_energy(axes: Axes, runs: Runs) -> None:
    energy, coupler = runs.inside.energy, runs.coupler
    times = runs.inside.times
    stored = energy.kinetic + energy.stored + coupler.stored
    lost = energy.dissipated + coupler.damped
    work = coupler.energy.device
    for values, label, colour, dashes in (
        (work, "hand’s work", style.BLACK, "-"),
        (lost, "lost", style.RED, "--"),
        (stored, "held: kinetic, springs", style.BLUE, "-."),
    ):
        axes.plot(times, MM * values, dashes, color=colour, label=label)
    axes.set(ylabel="energy [mJ]", xlim=(0.0, DURATION), ylim=(None, 1.6 * MM * work.max()))
    axes.legend(loc="upper left")
