"""A recording as one picture: distance, certificate gap, and active features over time."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from itertools import groupby
from pathlib import Path
from typing import TypeAlias, TypeVar

import numpy as np

from standoff.cli.errors import MissingExtra
from standoff.scene import Scene
from standoff.scene.reader import Array
from standoff.tracking import Feature, Recording, Status

try:
    from matplotlib import colormaps
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch
except ModuleNotFoundError as error:
    raise MissingExtra("matplotlib") from error

Value = TypeVar("Value")
Colour: TypeAlias = tuple[float, float, float, float]

# Okabe and Ito's colours, told apart by eyes without red or green. In grey print the light line
# lies under black dashes, and a cross is not a dot.
DISTANCE_COLOUR = "#56B4E9"
BOUND_COLOUR = "black"
GAP_COLOUR = "#0072B2"
UNCERTIFIED_COLOUR = "#D55E00"

HATCHES = {"face": "", "edge": "///", "vertex": "xx"}
"""The kind of a feature, readable without colour."""

LEGEND_ROWS = 5
"""Entries of a band's legend in one column beside it; more begin another."""

MOST_NAMED = 12
"""Most features in a band's legend, in three columns; a tumbling polytope visits far more."""

MARGINS = {"left": 0.09, "right": 0.76, "bottom": 0.08, "top": 0.94, "hspace": 0.5}
"""Of the panels, in parts of the figure; the legends stand in the margin to the right."""

LABEL_SHARE = 0.07
"""Least part of the time axis that a feature must be active to be named within its band: there is
room for the name."""

LEAST_GAP = 0.1
"""Height at which a gap that rounds to zero or less is drawn, in rounding units of the greatest
distance: a logarithm cannot show it where it is."""

LONG_WAY_OFF = 1e5
"""Start in s beyond which times are counted from the start: a recorder's epoch fills the axis."""


def write_plot(path: Path, ending: str, scene: Scene, recording: Recording) -> None:
    """Draw a recording.

    Parameters
    ----------
    path : Path
    ending : str
        The format: ``png``, ``svg`` or ``pdf``.
    scene : Scene
    recording : Recording

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    # Not through pyplot, which would ask for a display and keep the figure alive.
    figure = Figure(figsize=(10.0, 6.8), dpi=150)
    FigureCanvasAgg(figure)
    far, gap, band_a, band_b = figure.subplots(
        4, 1, sharex=True, gridspec_kw={"height_ratios": [5.0, 2.5, 1.0, 1.0], **MARGINS}
    )
    origin = float(recording.time[0]) if abs(recording.time[0]) > LONG_WAY_OFF else 0.0
    times = recording.time - origin
    _draw_distance(far, times, scene, recording)
    _draw_gap(gap, times, scene, recording)
    _draw_band(band_a, times, recording, "A", scene.pair[0])
    _draw_band(band_b, times, recording, "B", scene.pair[1])
    band_b.set_xlabel(f"time since {origin:.3f} s (s)" if origin else "time (s)")
    band_b.set_xlim(times[0], times[-1])
    figure.savefig(path, format=ending)


def _draw_distance(axes: Axes, times: Array, scene: Scene, recording: Recording) -> None:
    axes.set_title(f"{scene.title}: A = {scene.pair[0]}, B = {scene.pair[1]}", loc="left")
    axes.plot(times, recording.distance, color=DISTANCE_COLOUR, linewidth=3.0, label="distance")
    axes.plot(
        times,
        recording.lower_bound,
        color=BOUND_COLOUR,
        linewidth=1.0,
        dashes=(4, 4),
        label="certified lower bound",
    )
    closest = recording.closest()
    if closest is not None:
        axes.plot(
            times[closest],
            recording.distance[closest],
            "o",
            color="black",
            markerfacecolor="none",
            label=f"closest: {recording.distance[closest]:.4g} {scene.length_unit}",
        )
    _shade_overlaps(axes, times, recording, named=True)
    axes.set_ylabel(f"distance ({scene.length_unit})")
    axes.set_ylim(bottom=0.0)
    axes.grid(alpha=0.3)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)


def _shade_overlaps(axes: Axes, times: Array, recording: Recording, *, named: bool) -> None:
    edges = _frame_edges(times)
    label = "overlapping: no distance" if named else "_"
    for status, first, last in _runs(recording.status.tolist()):
        if status is Status.OVERLAPPING:
            axes.axvspan(edges[first], edges[last], color="0.8", linewidth=0, label=label)
            label = "_"  # one legend entry for all


def _draw_gap(axes: Axes, times: Array, scene: Scene, recording: Recording) -> None:
    gap = recording.gap
    scale = np.nanmax(np.abs(recording.distance), initial=0.0) or 1.0
    floor = LEAST_GAP * float(np.spacing(scale))
    shown = np.maximum(gap, floor)
    good = recording.certified
    axes.plot(
        times[good],
        shown[good],
        ".",
        color=GAP_COLOUR,
        markersize=3,
        label="distance − lower bound",
    )
    bad = ~good & ~np.isnan(gap)
    if bad.any():
        axes.plot(
            times[bad],
            shown[bad],
            "x",
            color=UNCERTIFIED_COLOUR,
            markersize=4,
            label="the same, not certified",
        )
    axes.set_yscale("log")
    axes.set_ylim(*_decades(shown))
    _shade_overlaps(axes, times, recording, named=False)
    axes.set_ylabel(f"gap ({scene.length_unit})")
    axes.grid(alpha=0.3)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)


def _decades(values: Array) -> tuple[float, float]:
    """Return whole powers of ten around positive values, at least two of them apart."""
    present = values[~np.isnan(values)]
    if not present.size:
        return 1e-16, 1.0
    low = np.floor(np.log10(present.min()))
    high = max(np.ceil(np.log10(present.max())), low + 2.0)
    return float(10.0**low), float(10.0**high)


def _draw_band(axes: Axes, times: Array, recording: Recording, body: str, name: str) -> None:
    tracked = recording.feature_a if body == "A" else recording.feature_b
    features = [
        None if status is Status.OVERLAPPING else feature
        for feature, status in zip(tracked, recording.status, strict=True)
    ]
    colours = _colours({feature for feature in features if feature is not None})
    edges = _frame_edges(times)
    for feature, first, last in _runs(features):
        if feature is None:
            continue
        start, end = edges[first], edges[last]
        hatch = HATCHES[feature.kind]
        axes.axvspan(
            start, end, facecolor=colours[feature], hatch=hatch, edgecolor="black", linewidth=0.0
        )
        if end - start >= LABEL_SHARE * (times[-1] - times[0]):
            _name_run(axes, 0.5 * (start + end), str(feature))
    offset = float(recording.time[0] - times[0])
    switches = [
        event.time - offset
        for event in recording.events
        if event.body == body and features[event.frame] is not None
    ]
    _shade_overlaps(axes, times, recording, named=False)
    ticks = axes.plot(
        switches,
        [1.09] * len(switches),
        "|",
        color="black",
        markersize=7,
        clip_on=False,
        transform=axes.get_xaxis_transform(),
        label="switch",
    )
    axes.set_yticks([])
    axes.set_title(f"{body}: active features of {name}", loc="left", fontsize="small", pad=9)
    _band_legend(axes, colours, ticks if switches else ())


def _band_legend(axes: Axes, colours: Mapping[Feature, Colour], ticks: Sequence[Artist]) -> None:
    patches: list[Artist] = [
        Patch(facecolor=colour, hatch=HATCHES[feature.kind], edgecolor="black", label=str(feature))
        for feature, colour in colours.items()
    ]
    if len(patches) > MOST_NAMED:
        more = Patch(facecolor="none", label=f"{len(patches) - MOST_NAMED} more")
        patches = [*patches[:MOST_NAMED], more]
    handles = [*patches, *ticks]
    axes.legend(
        handles=handles,
        loc="upper left",
        bbox_to_anchor=(1.0, 1.4),
        frameon=False,
        fontsize="small",
        columnspacing=1.0,
        handlelength=1.6,
        ncols=-(-len(handles) // LEGEND_ROWS),
    )


def _name_run(axes: Axes, time: float, name: str) -> None:
    axes.text(
        time,
        0.5,
        name,
        transform=axes.get_xaxis_transform(),
        ha="center",
        va="center",
        fontsize="small",
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5},
    )


def _colours(visited: Collection[Feature]) -> dict[Feature, Colour]:
    """Return a colour for each feature: faces, then edges, then vertices, by number."""
    kinds = tuple(HATCHES)
    ordered = sorted(visited, key=lambda feature: (kinds.index(feature.kind), feature.index))
    # Viridis rises in lightness all along, so that it survives eyes without red or green, and grey
    # print. Its darkest end is left out, where neither the hatch nor the outline could be seen.
    shades = np.linspace(0.2, 1.0, max(len(ordered), 2))
    return {
        feature: colormaps["viridis"](shade)
        for feature, shade in zip(ordered, shades[: len(ordered)], strict=True)
    }


def _runs(values: Sequence[Value]) -> list[tuple[Value, int, int]]:
    """Return maximal runs of equal values: (value, first index, index after the last)."""
    runs, at = [], 0
    for value, group in groupby(values):
        length = sum(1 for _ in group)
        runs.append((value, at, at + length))
        at += length
    return runs


def _frame_edges(times: Array) -> Array:
    """Return the times between which each frame is drawn, shape (n + 1,): half way between."""
    middles = 0.5 * (times[1:] + times[:-1])
    return np.concatenate([times[:1], middles, times[-1:]])
