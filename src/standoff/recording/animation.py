"""A recording as an animation: both bodies, their active features, and the witness line."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from standoff.bodies.drawing.pair_picture import (
    DrawnAnswer,
    add_legend,
    axes_of,
    cloud_of,
    draw_pair,
    new_figure,
    view_across,
)
from standoff.bodies.drawing.solids import solid_of
from standoff.errors import StandoffError, of_extra
from standoff.recording.recorded import Paths, RecordedFrames
from standoff.tracking.inputs import flat_pose

with of_extra("matplotlib", "plot"):
    from matplotlib.animation import FuncAnimation
    from matplotlib.figure import Figure

INTERVAL = 50
"""Time that a picture is shown, ms."""


def animation(
    recording: RecordedFrames,
    pair: tuple[Any, Any],
    paths: Paths,
    pictures: int,
    view: tuple[float, float] | None,
) -> FuncAnimation:
    """Return the animation; `Recording.animate` describes it."""
    figure, draw, count = drawing(recording, pair, paths, pictures, view)
    return FuncAnimation(figure, draw, frames=count, interval=INTERVAL, init_func=list)


def drawing(
    recording: RecordedFrames,
    pair: tuple[Any, Any],
    paths: Paths,
    pictures: int,
    view: tuple[float, float] | None,
) -> tuple[Figure, Callable[[int], list[Any]], int]:
    """Return the figure, what draws picture k in it, and the number of pictures."""
    if recording.info.of_solids:
        raise StandoffError(
            "Animations and videos draw convex bodies alone, and one of these is a solid that need "
            "not be: standoff.view.export.save_page(recording, 'run.html') shows the motion, and "
            "so.plot an instant of it."
        )
    count = min(pictures, len(recording))
    chosen = np.unique(np.linspace(0, len(recording) - 1, count).round().astype(int)).tolist()
    frames = [_shown(recording, paths, frame) for frame in chosen]
    solids = solid_of(pair[0]), solid_of(pair[1])
    cloud = np.concatenate([cloud_of(solids, shown) for shown in frames])
    closest = recording.closest() or 0
    angles = view_across(recording.normal[closest]) if view is None else view
    unit = recording.info.length_unit
    figure = new_figure()
    axes = axes_of(figure, pair[0].dimension == 2)

    def draw(k: int) -> list[Any]:
        axes.clear()
        for legend in list(figure.legends):
            legend.remove()
        draw_pair(axes, solids, frames[k], angles, cloud, unit)
        add_legend(figure, solids, frames[k], unit)
        figure.suptitle(f"{recording.time[chosen[k]] + 0.0:.3f} s", fontsize="medium")
        return []

    return figure, draw, len(frames)


def _shown(recording: RecordedFrames, paths: Paths, frame: int) -> DrawnAnswer:
    time = float(recording.time[frame])
    pose_a, pose_b = (flat_pose(path.pose(time)) for path in paths)
    return DrawnAnswer(
        (pose_a, pose_b),
        (recording.point_a[frame], recording.point_b[frame]),
        recording.normal[frame],
        float(recording.distance[frame]),
        (recording.feature_a[frame], recording.feature_b[frame]),
        recording.status[frame].name,
    )
