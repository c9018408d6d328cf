"""A recording as one picture: distance, certificate, residual, modes and parameters over time."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from itertools import groupby
from typing import TYPE_CHECKING, BinaryIO, NamedTuple, TypeAlias, TypeVar

import numpy as np

from standoff.bodies.features import Feature
from standoff.errors import of_extra
from standoff.recording.recorded import RecordedFrames
from standoff.tracking.branches import NONE
from standoff.typing import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

with of_extra("matplotlib"):
    from matplotlib import colormaps
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

Value = TypeVar("Value")
Colour: TypeAlias = tuple[float, float, float, float]

FORMATS = ("png", "svg", "pdf")

# Okabe and Ito's colours, told apart by eyes without red or green. In grey print the light line
# lies under black dashes, and a cross is not a dot.
DISTANCE_COLOUR = "#56B4E9"
BOUND_COLOUR = "black"
GAP_COLOUR = "#0072B2"
RESIDUAL_COLOUR = "#E69F00"
UNCERTIFIED_COLOUR = "#D55E00"
PARAMETERS = (("u, or t on an edge", "#0072B2", "-"), ("v", "#D55E00", "--"))
"""Name, colour and dashes of a feature's first and second parameter."""

HATCHES = {"face": "", "edge": "///", "vertex": "xx"}
"""The kind of a feature, readable without colour."""

TINT = 0.16
"""Opacity of a mode's colour behind its parameters."""

LEGEND_ROWS = 6
"""Entries of a band's legend in one column beside it; more begin another."""

MOST_NAMED = 10
"""Most features in a band's legend, in two columns; a tumbling polytope visits far more."""

WIDTH = 10.0
MARGINS = {"left": 0.09, "right": 0.76}
"""The figure's width in inches, and its sides in parts of it; the legends stand to the right."""

HEIGHTS = {"distance": 2.6, "gap": 1.6, "band": 0.42, "parameters": 1.35}
SPACES = {"top": 0.42, "between": 0.32, "before a band": 0.62, "within": 0.06, "bottom": 0.55}
"""Of the panels and the spaces around them, in inches."""

LABEL_SHARE = 0.07
"""Least part of the time axis that a feature must be active to be named within its band: there is
room for the name."""

LEAST_SHOWN_GAP = 0.1
"""Height at which a gap that rounds to zero or less is drawn, in rounding units of the greatest
distance: a logarithm cannot show it where it is."""

LONG_WAY_OFF = 1e5
"""Start in s beyond which times are counted from the start: a recorder's epoch fills the axis."""


class Stay(NamedTuple):
    """One body's stay in a feature, from start to end on the axis."""

    feature: Feature
    start: float
    end: float


def write_plot(recording: RecordedFrames, file: BinaryIO, ending: str) -> None:
    """Draw a recording to a stream in one of `FORMATS`.

    Raises OSError if the file cannot be written.
    """
    draw(recording).savefig(file, format=ending)


def draw(recording: RecordedFrames) -> Figure:
    """Return the picture of a recording."""
    names = ["distance", "gap"]
    for body, values in (("A", recording.parameters_a), ("B", recording.parameters_b)):
        names.append(f"band {body}")
        if not np.isnan(values).all():
            names.append(f"parameters {body}")
    figure, axes = _panels(names)
    origin = float(recording.time[0]) if abs(recording.time[0]) > LONG_WAY_OFF else 0.0
    times = recording.time - origin
    _draw_distance(axes["distance"], times, recording)
    _draw_gap(axes["gap"], times, recording)
    for body in "AB":
        stays = _stays(recording, body, origin)
        colours = _colours({stay.feature for stay in stays})
        _draw_band(axes[f"band {body}"], times, recording, body, stays, colours, origin)
        if f"parameters {body}" in axes:
            _draw_parameters(axes[f"parameters {body}"], times, recording, body, stays, colours)
    last = axes[names[-1]]
    last.set_xlabel(f"time since {origin:.3f} s (s)" if origin else "time (s)")
    for name in names[:-1]:
        axes[name].tick_params(labelbottom=False, bottom=not name.startswith("band"))
    last.set_xlim(times[0], times[-1])
    return figure


def _panels(names: Sequence[str]) -> tuple[Figure, dict[str, Axes]]:
    """Return a figure as high as its panels need, one above another."""
    heights, spaces = [], []
    for name in names:
        kind = name.split()[0]
        heights.append(HEIGHTS[kind])
        above = {"distance": "top", "band": "before a band", "parameters": "within"}
        spaces.append(SPACES[above.get(kind, "between")])
    total = sum(heights) + sum(spaces) + SPACES["bottom"]
    # Not through pyplot, which would ask for a display and keep the figure alive.
    figure = Figure(figsize=(WIDTH, total), dpi=150)
    FigureCanvasAgg(figure)
    axes: dict[str, Axes] = {}
    at, width = total, MARGINS["right"] - MARGINS["left"]
    for name, height, space in zip(names, heights, spaces, strict=True):
        at -= space + height
        box = (MARGINS["left"], at / total, width, height / total)
        axes[name] = figure.add_axes(box, sharex=next(iter(axes.values()), None))
    return figure, axes


def _unit(recording: RecordedFrames) -> str:
    return f" ({recording.info.length_unit})" if recording.info.length_unit else ""


def _beside(axes: Axes) -> None:
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)


def _draw_distance(axes: Axes, times: Array, recording: RecordedFrames) -> None:
    info = recording.info
    title = f"{info.title}: " if info.title else ""
    axes.set_title(f"{title}A = {info.bodies[0]}, B = {info.bodies[1]}", loc="left")
    axes.plot(times, recording.distance, color=DISTANCE_COLOUR, linewidth=3.0, label="distance")
    axes.plot(
        times,
        recording.lower_bound,
        color=BOUND_COLOUR,
        linewidth=1.0,
        dashes=(4, 4),
        label="certified lower bound",
    )
    draw_minima(axes, times, recording)
    closest = recording.closest()
    if closest is not None:
        axes.plot(
            times[closest],
            recording.distance[closest],
            "o",
            color="black",
            markerfacecolor="none",
            clip_on=False,
            label=f"closest: {recording.distance[closest]:.4g} {info.length_unit}".rstrip(),
        )
    _shade_overlaps(axes, times, recording, named=True)
    axes.set_ylabel(f"distance{_unit(recording)}")
    axes.set_ylim(bottom=0.0)
    axes.grid(alpha=0.3)
    _beside(axes)


def _shade_overlaps(axes: Axes, times: Array, recording: RecordedFrames, *, named: bool) -> None:
    edges = _frame_edges(times)
    label = "in penetration" if named else "_"
    for inside, first, last in _runs(recording.penetrating.tolist()):
        if inside:
            axes.axvspan(edges[first], edges[last], color="0.8", linewidth=0, label=label)
            label = "_"  # one legend entry for all


def _draw_gap(axes: Axes, times: Array, recording: RecordedFrames) -> None:
    known = recording.distance[np.isfinite(recording.distance)]
    scale = np.abs(known).max(initial=0.0) or 1.0
    floor = LEAST_SHOWN_GAP * float(np.spacing(scale))
    gap, residual = np.maximum(recording.gap, floor), np.maximum(recording.residual, floor)
    good = recording.certified
    bad = ~good & ~np.isnan(gap)
    if not np.isnan(residual).all():  # solids have none
        axes.plot(times, residual, color=RESIDUAL_COLOUR, linewidth=0.8, label="residual")
    axes.plot(
        *(times[good], gap[good], "."),
        color=GAP_COLOUR,
        markersize=3,
        label="distance − lower bound",
    )
    if bad.any():
        axes.plot(
            *(times[bad], gap[bad], "x"),
            color=UNCERTIFIED_COLOUR,
            markersize=4,
            label="the same, not certified",
        )
    axes.set_yscale("log")
    axes.set_ylim(*_decades(np.concatenate([gap, residual])))
    _shade_overlaps(axes, times, recording, named=False)
    axes.set_ylabel(f"error{_unit(recording)}")
    axes.grid(alpha=0.3)
    _beside(axes)


def _decades(values: Array) -> tuple[float, float]:
    """Return whole powers of ten around positive values, at least two of them apart."""
    present = values[np.isfinite(values)]
    if not present.size:
        return 1e-16, 1.0
    low = np.floor(np.log10(present.min()))
    high = max(np.ceil(np.log10(present.max())), low + 2.0)
    return float(10.0**low), float(10.0**high)


def _stays(recording: RecordedFrames, body: str, origin: float) -> list[Stay]:
    """Return one body's stays, those of the pair's modes that follow on one another joined."""
    stays: list[Stay] = []
    for visit in recording.modes():
        feature = visit.feature_a if body == "A" else visit.feature_b
        start, end = visit.start - origin, visit.end - origin
        if stays and stays[-1].feature == feature and stays[-1].end == start:
            start = stays.pop().start
        stays.append(Stay(feature, start, end))
    return stays


def _draw_band(
    axes: Axes,
    times: Array,
    recording: RecordedFrames,
    body: str,
    stays: Sequence[Stay],
    colours: Mapping[Feature, Colour],
    origin: float,
) -> None:
    for stay in stays:
        axes.axvspan(
            stay.start,
            stay.end,
            facecolor=colours[stay.feature],
            hatch=HATCHES[stay.feature.kind],
            edgecolor="black",
            linewidth=0.0,
        )
        if stay.end - stay.start >= LABEL_SHARE * (times[-1] - times[0]):
            _name_stay(axes, stay)
    _shade_overlaps(axes, times, recording, named=False)
    switches = [event.time - origin for event in recording.events if event.body == body]
    ticks = axes.plot(
        switches,
        [1.16] * len(switches),
        "|",
        color="black",
        markersize=6,
        clip_on=False,
        transform=axes.get_xaxis_transform(),
        label="switch",
    )
    axes.set_yticks([])
    name = recording.info.bodies["AB".index(body)]
    axes.set_title(f"{body}: active features of {name}", loc="left", fontsize="medium", pad=11)
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
        bbox_to_anchor=(1.0, 1.35),
        frameon=False,
        fontsize="small",
        columnspacing=1.0,
        handlelength=1.6,
        ncols=-(-len(handles) // LEGEND_ROWS),
    )


def _name_stay(axes: Axes, stay: Stay) -> None:
    axes.text(
        0.5 * (stay.start + stay.end),
        0.5,
        str(stay.feature),
        transform=axes.get_xaxis_transform(),
        ha="center",
        va="center",
        fontsize="small",
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5},
    )


def _draw_parameters(
    axes: Axes,
    times: Array,
    recording: RecordedFrames,
    body: str,
    stays: Sequence[Stay],
    colours: Mapping[Feature, Colour],
) -> None:
    """Draw a body's parameters, broken where they begin to count on another feature or chart."""
    for stay in stays:
        axes.axvspan(
            stay.start, stay.end, facecolor=colours[stay.feature], alpha=TINT, linewidth=0.0
        )
    values = recording.parameters_a if body == "A" else recording.parameters_b
    features = recording.feature_a if body == "A" else recording.feature_b
    charts = np.nan_to_num(values[:, 2], nan=-1.0).tolist()
    keys = list(zip(features.tolist(), charts, strict=True))
    for k, (name, colour, dashes) in enumerate(PARAMETERS):
        label = name
        for _, first, last in _runs(keys):
            part = values[first:last, k]
            if np.isnan(part).all():
                continue
            # One frame alone has no line.
            marker = "." if last - first == 1 else ""
            axes.plot(
                *(times[first:last], part, dashes),
                color=colour,
                linewidth=1.4,
                marker=marker,
                markersize=3,
                label=label,
            )
            label = "_"
    _shade_overlaps(axes, times, recording, named=False)
    axes.set_ylabel("parameters")
    axes.grid(alpha=0.3)
    axes.legend(loc="lower left", bbox_to_anchor=(1.0, -0.1), frameon=False, fontsize="small")


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


# Local minima over time, in the picture of a recording.

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
