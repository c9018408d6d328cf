"""Fig. 19: five snapshots of two bodies of three patches each, and how they move."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from standoff.bodies import Body
from standoff.bodies.tessellation import edge_lines
from standoff.motion import Pose
from standoff.tracking import Feature
from standoff_studies.paper import style
from standoff_studies.paper.drawing_3d import LOOKS, View, posed
from standoff_studies.paper.figure import Animation, Artwork, Statement, measured_by, own_statement
from standoff_studies.paper.keys import key_below, key_line
from standoff_studies.paper.pair_simulation import Simulation, certified
from standoff_studies.paper.patch_places import short
from standoff_studies.paper.simulation_e.runs import (
    CONVERGED,
    PATH_A,
    PATH_B,
    SEMI_AXES,
    SIMULATION,
    sequence,
)

AZIMUTH, ELEVATION = 8.0, 56.0
"""Direction of the viewer [degrees], chosen so that both ends of the witness lines are visible."""

COLOURS = {"A": ("#CBE6F6", "#5F9FC8", "#9FD3F2"), "B": ("#F7D08A", "#DDA03F", "#FBE9C6")}
"""Colours of each body's three patches: one hue per body, three brightnesses."""

HEIGHTS = (1.25, 1.0, 1.0)
"""Heights of the rows of panels."""

FRAMES = 64
"""Pictures of the animation."""

TRIAD = (1.4, -1.4)
"""Where the world's axes are drawn [length in the picture]."""

ACROSS, UP = (-1.6, 2.3), (-2.5, 1.1)
"""Area shown by the animation [length in the picture]: both bodies at all times."""

FAN = 0.2
"""Time between the witness lines of the last panel [s]."""


def figure_19() -> Artwork:
    """Draw the five snapshots."""
    runs = SIMULATION
    recording = runs.paper
    axes = ", ".join(f"{axis:g}" for axis in SEMI_AXES)
    return Artwork(
        caption=(
            "Simulation E: body A (blue) is a lens of three four-sided patches, body B (orange) "
            f"the same stretched by {axes} along its axes. B's centre winds about A while B turns. "
            "One snapshot in each of the five modes: patches are named, their u and v lines grey; "
            "the witness line is black, its ends are marked by the kind of the active feature "
            "(hollow where a body hides them), and an active edge is thick and vermilion. The "
            f"printed system at K = {runs.gain:g}/s, from a wrong start: its first witness line is "
            "dashed in the first picture. Last: the path of B's centre (dashed) and a witness line "
            f"every {FAN:g} s. Lengths are in the radius of A's faces."
        ),
        text=(
            "Six pictures of two bodies like three-sided lemons. The line between their closest "
            "points goes from patch A F0 to B F1, to B's edge E2, from A's edge E0 to it, from "
            "there to B's patch F2, and from A's patch F1 to it."
        ),
        draw=_draw,
        tables={
            "run": {
                "time_s": recording.time,
                **{f"witness_a_{x}": recording.point_a[:, k] for k, x in enumerate("xyz")},
                **{f"witness_b_{x}": recording.point_b[:, k] for k, x in enumerate("xyz")},
                "distance": recording.distance,
                "distance_exact": runs.exact.distance,
                "lower_bound_exact": runs.exact.lower_bound,
                "feature_a": [short(feature) for feature in recording.feature_a],
                "feature_b": [short(feature) for feature in recording.feature_b],
            }
        },
        statements=measured_by(runs.by, _statements(runs)),
        animation=Animation(
            frames=FRAMES,
            draw=_draw_frame,
            seconds=0.08,
            size=(5.4, 5.6),
            text=(
                "Body B winds about body A and turns; the witness line between them changes its "
                "ends from faces to edges and to the next faces."
            ),
        ),
    )


def snapshot_frames(runs: Simulation) -> list[int]:
    """Return the frame in the middle of each mode of the paper's law."""
    return [round(0.5 * (stay.start + stay.end) / runs.step) for stay in runs.stays]


def _statements(runs: Simulation) -> tuple[Statement, ...]:
    modes = sequence(runs.stays)
    error = runs.witness_error
    late = error[round(CONVERGED / runs.step) :]
    return (
        Statement(
            "Fig. 19",
            "two spatial bodies of three patches each, one in a given motion, in five snapshots",
            f"{runs.a.n_faces} and {runs.b.n_faces} patches; five modes, "
            f"{', '.join(f'{a}–{b}' for a, b in modes)}",
            (runs.a.n_faces, runs.b.n_faces, len(modes)) == (3, 3, 5),
            "bodies, motion and instants are ours",
            constructed=True,
        ),
        own_statement(
            "Fig. 19",
            f"the start is off the exact witness points by {error[0]:.2f} of the radius; after "
            f"{CONVERGED:g} s by at most {late.max():.1e}, in the median {np.median(late):.1e}",
            "the greatest errors are those of the frames after a switch",
        ),
        certified(runs, "Fig. 19"),
    )


def _draw() -> Figure:
    runs = SIMULATION
    figure = style.new_figure(style.WIDTH, 8.4)
    panels = figure.subplots(3, 2, height_ratios=HEIGHTS).ravel().tolist()
    for axes, frame in zip(panels, snapshot_frames(runs), strict=False):
        _draw_snapshot(axes, runs, frame, start=axes is panels[0])
    _draw_motion(panels[-1], runs)
    # the same scale in all panels, and each row as high as its two need
    across = np.array([axes.get_xlim() for axes in panels])
    for first in range(0, len(panels), 2):
        up = np.array([axes.get_ylim() for axes in panels[first : first + 2]])
        for axes in panels[first : first + 2]:
            axes.set_xlim(across[:, 0].min(), across[:, 1].max())
            axes.set_ylim(up[:, 0].min(), up[:, 1].max())
    key_below(figure, _key(), 5)
    return figure


def _draw_snapshot(
    axes: Axes, runs: Simulation, frame: int, *, grid: int = 20, lines: int = 3, start: bool = False
) -> None:
    recording = runs.paper
    time = float(recording.time[frame])
    features = {"A": recording.feature_a[frame], "B": recording.feature_b[frame]}
    view = View(AZIMUTH, ELEVATION)
    places = {"A": (runs.a, PATH_A.pose(time)), "B": (runs.b, PATH_B.pose(time))}
    for name, (body, pose) in places.items():
        view.body(body, pose, colours=COLOURS[name], grid=grid, lines=lines)
        if features[name].kind == "edge":
            points = edge_lines(body)[features[name].index].points
            view.line(posed(points, pose), style.RED, 4.0, rank=1.5)
    ends = recording.point_a[frame], recording.point_b[frame]
    view.line(ends, style.BLACK, 1.6)
    if start:  # where it began, on the bodies at their present poses
        far = PATH_B.pose(time).apply(PATH_B.pose(0.0).inverse().apply(recording.point_b[0]))
        view.line([recording.point_a[0], far], style.PURPLE, 1.4, dashes=(0.07, 0.05))
    for point, feature in zip(ends, features.values(), strict=True):
        colour, mark = LOOKS[feature.kind]
        view.mark(point, colour, mark, 0.05)
    view.paint(axes)
    # an end that a body hides is drawn hollow, and the line to it dotted
    flat = view.flat(np.array(ends))
    axes.plot(*flat.T, color=style.BLACK, linestyle=":", linewidth=0.9, zorder=3)
    for point, feature in zip(flat, features.values(), strict=True):
        colour, mark = LOOKS[feature.kind]
        hollow: dict[str, Any] = {
            "markerfacecolor": "none",
            "markeredgecolor": colour,
            "markersize": 6.0,
        }
        axes.plot(*point, mark, **hollow, zorder=4)
    for name, (body, pose) in places.items():
        _name_faces(axes, view, name, body, pose)
    axes.set_title(f"t = {time:.2f} s: A {_named(features['A'])}, B {_named(features['B'])}")


def _named(feature: Feature) -> str:
    return f"{feature.kind} {short(feature)}"


def _name_faces(axes: Axes, view: View, name: str, body: Body, pose: Pose) -> None:
    """Name the patches that face the viewer: in their middle, or higher up where that is hidden."""
    words: dict[str, Any] = {"color": "#303030", "fontsize": style.FONT - 1.0}
    for number, face in enumerate(body.face_parts):
        for v in (0.5, 0.65, 0.8, 0.35, 0.2):
            x, xu, xv = (pose.rotation @ part for part in face.charts[0].jet(0.5, v)[:3])
            normal = np.cross(xu, xv)
            if view.faces(normal * np.sign(normal @ x), 0.2):
                view.text(axes, x + pose.translation, f"{name} F{number}", **words)
                break


def _draw_motion(axes: Axes, runs: Simulation) -> None:
    recording = runs.paper
    view = View(AZIMUTH, ELEVATION)
    view.body(runs.a, colours=COLOURS["A"])
    centres = [PATH_B.pose(t).translation for t in np.linspace(0.0, runs.duration, 101).tolist()]
    view.line(centres, style.GREEN, 1.4, dashes=(0.07, 0.05))
    for k in range(0, len(recording), round(FAN / runs.step)):
        a, b = recording.point_a[k], recording.point_b[k]
        view.line([a, b], style.BLACK, 1.0)
        for point, feature in ((a, recording.feature_a[k]), (b, recording.feature_b[k])):
            colour, mark = LOOKS[feature.kind]
            view.mark(point, colour, mark, 0.035)
    view.paint(axes)
    for point, words in ((centres[0], "start "), (centres[-1], "end ")):
        view.text(axes, point, words, ha="right")
    view.triad(axes, TRIAD, 0.3, "radius")
    axes.set_title("the motion")


def _key() -> list[Artist]:
    looks = {kind: look for kind, look in LOOKS.items() if kind != "vertex"}
    return [
        *(
            key_line(
                f"on {'an' if kind == 'edge' else 'a'} {kind}",
                style.BLACK,
                marker=mark,
                markerfacecolor=colour,
            )
            for kind, (colour, mark) in looks.items()
        ),
        key_line("active edge", style.RED, 3.4),
        key_line("path of B's centre", style.GREEN, dashes="--"),
        key_line("wrong start", style.PURPLE, dashes="--"),
    ]


def _draw_frame(figure: Figure, number: int) -> None:
    runs = SIMULATION
    frame = round(number / (FRAMES - 1) * (len(runs.paper) - 1))
    axes = figure.add_subplot()
    _draw_snapshot(axes, runs, frame, grid=10, lines=1)
    axes.set_xlim(*ACROSS)
    axes.set_ylim(*UP)
