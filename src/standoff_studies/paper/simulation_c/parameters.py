"""Fig. 15: the parameters of both bodies against time, modes and switching instants."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import isotonic_regression

from standoff.bodies import Body
from standoff_studies.paper import style
from standoff_studies.paper.drawing import planar_features, short_name
from standoff_studies.paper.figure import Artwork, Statement
from standoff_studies.paper.simulation_c.kinds import FILLS, kind_of, mode_name, show_kinds
from standoff_studies.paper.simulation_c.run import (
    DURATION,
    FRAME,
    Run,
    loop_parameter,
    run,
    vertex_slip,
    witness_error,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

ROWS = 2
"""The time axis is cut in two rows, so that short stays can be seen."""
LEAST_APART = 0.16
"""Between two written instants, on the time axis [s]: the height of a line of text."""
SETTLING = 0.02
"""After a switch, before which the paper's law is told apart from what comes later [s]."""
SLIP = 1e-14
"""A witness point within this of its vertex is at it: roundings of poses [length]."""


def figure_15() -> Artwork:
    """Make Fig. 15."""
    simulation = run()
    return Artwork(
        caption=(
            "Where around its loop each body's witness point is, against time [s]: the number of "
            "the curve plus its parameter in [0, 1]; level where a vertex holds. Slopes jump at "
            "the switches. The lower panels go on where the upper ones end. Dotted lines are the "
            "switches; their instants [s] and the modes (A's feature, then B's) stand above. "
            "Shading tells the kinds of modes apart."
        ),
        text=(
            "Two rows of two panels: both parameters rise along curves and are level at vertices; "
            "25 dotted lines mark the switching instants."
        ),
        draw=lambda: _draw(simulation),
        tables={"frames": _frames(simulation)},
        statements=_statements(simulation),
    )


def _frames(simulation: Run) -> dict[str, NDArray[np.generic]]:
    recording, paper = simulation.recording, simulation.paper
    a, b = simulation.a, simulation.b
    return {
        "time_s": recording.time,
        "parameter_a": loop_parameter(a, recording.feature_a, recording.parameters_a),
        "parameter_b": loop_parameter(b, recording.feature_b, recording.parameters_b),
        "feature_a": np.array([short_name(feature) for feature in recording.feature_a]),
        "feature_b": np.array([short_name(feature) for feature in recording.feature_b]),
        "distance_length": recording.distance,
        "lower_bound_length": recording.lower_bound,
        "parameter_a_by_paper_law": loop_parameter(a, paper.feature_a, paper.parameters_a),
        "parameter_b_by_paper_law": loop_parameter(b, paper.feature_b, paper.parameters_b),
        "witness_error_of_paper_law_length": witness_error(simulation),
    }


def after_switches(simulation: Run) -> NDArray[np.bool_]:
    """Return which frames come within `SETTLING` after a switch of either law, shape (n,)."""
    recording = simulation.recording
    events = (*recording.events, *simulation.paper.events)
    since = recording.time[:, None] - np.array([event.time for event in events])
    return np.asarray(((since >= -FRAME) & (since <= SETTLING)).any(axis=1))


def _statements(simulation: Run) -> tuple[Statement, ...]:
    recording, slip = simulation.recording, vertex_slip(simulation)
    error, settling = witness_error(simulation), after_switches(simulation)
    slopes = np.abs([event.slope for event in recording.events])
    located = all(event.located for event in recording.events)
    return (
        Statement(
            "Figs. 8–11",
            "at a vertex the witness point is anchored",
            f"the witness point leaves its vertex by at most {slip:.1e} length",
            slip <= SLIP,
        ),
        Statement(
            "Fig. 15",
            "-",
            f"{len(recording.events)} switching instants, {'all' if located else 'not all'} "
            f"located; slope of the switching function {slopes.min():.2g} to {slopes.max():.2g} "
            "per s",
            None,
        ),
        Statement(
            "Fig. 15",
            "-",
            f"own law: certified in {np.mean(recording.certified):.0%} of the frames, distance "
            f"at most {recording.gap.max():.1e} length above its proven lower bound",
            None,
        ),
        Statement(
            "Fig. 15",
            "-",
            f"the paper's law (Heun, K = 1000/s, 1 kHz): witness points within {error.max():.1e} "
            f"length of the certified ones; {error[~settling].max():.1e} outside the "
            f"{1e3 * SETTLING:.0f} ms after a switch",
            None,
            "Within the step of a switch the feedforward is still that of the old feature; the "
            "feedback then halves the error every step.",
        ),
    )


def _draw(simulation: Run) -> Figure:
    with style.settings():
        figure = style.new_figure(style.WIDTH, 9.0)
        panels = figure.subplots(2 * ROWS, 1, height_ratios=(3.0, 2.2) * ROWS)
        length = DURATION / ROWS
        for row in range(ROWS):
            upper, lower = panels[2 * row : 2 * row + 2]
            span = row * length, (row + 1) * length
            _draw_panel(upper, simulation, "A", span)
            _draw_panel(lower, simulation, "B", span)
            _write_instants(upper, simulation, span)
            upper.tick_params(labelbottom=False)
            lower.set_xlabel("time [s]")
        show_kinds(figure)
    return figure


def _draw_panel(axes: Axes, simulation: Run, letter: str, span: tuple[float, float]) -> None:
    recording = simulation.recording
    body: Body = simulation.a if letter == "A" else simulation.b
    features = recording.feature_a if letter == "A" else recording.feature_b
    parameters = recording.parameters_a if letter == "A" else recording.parameters_b
    around = loop_parameter(body, features, parameters)
    for stay in simulation.stays:
        fill = FILLS[kind_of(stay.feature_a, stay.feature_b)]
        axes.axvspan(stay.start, stay.end, facecolor=fill, linewidth=0.0, zorder=0)
    for event in recording.events:
        own = event.body == letter
        axes.axvline(
            event.time,
            color=style.BLACK if own else style.QUIET,
            linestyle=":",
            linewidth=1.1 if own else 0.7,
            zorder=1,
        )
    # Once around, the parameter falls back to 0: no line there.
    broken = np.where(np.append(np.abs(np.diff(around)) > 0.5 * body.n_edges, False), np.nan, 1.0)
    colour = style.BLUE if letter == "A" else style.RED
    axes.plot(recording.time, broken * around, color=colour, linewidth=2.0, zorder=3)
    axes.set_xlim(span)
    axes.set_ylim(-0.12, body.n_edges + 0.12)
    names = [short_name(feature) for feature in planar_features(body)]
    ticks = [*(0.5 * k for k in range(len(names))), float(body.n_edges)]
    axes.set_yticks(ticks, [*names, names[0]])
    axes.grid(visible=False)
    for level in range(body.n_edges + 1):
        axes.axhline(level, color="#D0D0D0", linewidth=0.6, zorder=1)
    axes.set_ylabel(f"witness point on {letter}")


def _write_instants(axes: Axes, simulation: Run, span: tuple[float, float]) -> None:
    """Above a panel: the instants, upright, at their lines or as near as they can be read."""
    starts = [s for s in simulation.stays if span[0] <= s.start < span[1]]
    places = spread(np.array([stay.start for stay in starts]), LEAST_APART)
    top = axes.get_ylim()[1]
    height = top - axes.get_ylim()[0]
    for stay, place in zip(starts, places.tolist(), strict=True):
        axes.annotate(
            f"{mode_name(stay.feature_a, stay.feature_b)}  {stay.start:.3f}",
            (stay.start, top),
            (place, top + 0.07 * height),
            rotation=90,
            ha="center",
            va="bottom",
            fontsize=style.FONT - 1.5,
            annotation_clip=False,
            arrowprops={"arrowstyle": "-", "color": style.QUIET, "linewidth": 0.6, "shrinkA": 0.0},
        )


def spread(wanted: Array, apart: float) -> Array:
    """Return the places nearest to the wanted ones that keep their order and are so far apart."""
    even = apart * np.arange(len(wanted))
    return np.asarray(isotonic_regression(wanted - even).x + even)
