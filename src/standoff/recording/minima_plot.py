"""Local minima over time, in the picture of a recording."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from standoff.recording.recorded import RecordedFrames
from standoff.tracking.branches import NONE
from standoff.typing import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes


MINIMA_COLOUR = "#009E73"
"""Of Okabe and Ito, as those of the picture."""


def draw_minima(axes: Axes, times: Array, recording: RecordedFrames) -> None:
    """Draw each local minimum while it lives, under the distance, which is that of the nearest."""
    if recording.minima is None:
        return
    told, label = recording.minima, "local minima"
    for key in np.unique(told.key[told.key != NONE]):
        rows = np.flatnonzero(told.key == key)
        cuts = np.flatnonzero(np.diff(told.frame[rows]) > 1) + 1
        for part in np.split(rows, cuts):
            axes.plot(
                *(times[told.frame[part]], told.distance[part]),
                color=MINIMA_COLOUR,
                linewidth=1.0,
                marker="." if len(part) == 1 else "",
                label=label,
                zorder=1.5,
            )
            label = "_"
