"""Fig. 15: the parameters of both bodies' curves against time, modes and switching instants."""

from __future__ import annotations

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.optimize import isotonic_regression

from standoff.automaton import Visit
from standoff.recording import Recording
from standoff.typing import Array
from standoff_studies.paper import style
from standoff_studies.paper.drawing import short_name
from standoff_studies.paper.figure import Artwork, Statement, measured_by, own_statement
from standoff_studies.paper.keys import key_below, key_line
from standoff_studies.paper.pair_simulation import Simulation
from standoff_studies.paper.panels import draw_errors, tint, unit_interval
from standoff_studies.paper.resets import reset_statement, reset_table
from standoff_studies.paper.simulation_c.kinds import FILLS, kind_of, mode_name, show_kinds
from standoff_studies.paper.simulation_c.run import (
    SIMULATION,
    curve_parameters,
    snapshots,
    vertex_slip,
)
from standoff_studies.paper.start_decay import decay_statement

SPANS = ((0.0, 0.5), (0.0, 6.0), (6.0, 12.0))
"""The rows: the start alone, and the motion in two parts, so that short stays are visible [s]."""
DECAY = (0.05, 0.25)
"""Times between which the decay of the start is measured [s]: in one mode, before the law's own
error dominates."""
LEAST_APART = 0.16
"""Least spacing of written instants on the time axis [s]: the height of a line of text."""
LEAST_NAMED = 0.02
"""Shortest stay whose instant is written [s]: those of the start follow each other in one frame."""
SETTLING = 5.0 / SIMULATION.gain
"""Time after a switch during which its errors are treated separately [s]."""
FOOT = -0.3
"""Where the marks of the snapshots are, below the parameters."""
LEAST_ERROR = 1e-10
"""Errors below this are drawn at this value [length]."""
SLIP = 1e-14
"""A witness point within this of its vertex is at it: roundings of poses [length]."""
NAMES = {"A": ("u₁", "u₂", "u₃"), "B": ("rₐ", "r_b", "r_c")}
"""The parameters of A's curves C0, C1, C2 and of B's, as the paper calls them."""


def figure_15() -> Artwork:
    """Make Fig. 15."""
    simulation = SIMULATION
    return Artwork(
        caption=(
            "The parameters of A's three curves (u_1, u_2, u_3 of C0, C1, C2) and of B's (r_a, "
            "r_b, r_c), each in [0, 1], against time [s], by the printed system at K = "
            f"{simulation.gain:g}/s "
            "from a wrong start; thin and dark, the library's own law. A parameter is drawn while "
            "the witness point is on its curve or at one of its ends, where it is level at 0 or 1. "
            "The first row is the start at a larger scale, where the heavy lines come "
            "from the wrong start; the third goes on where the second ends. Dotted lines are the "
            "switches; their instants [s] and the modes (A's feature, then B's) stand above. "
            "Triangles and letters mark the snapshots of Fig. 14, in the middles of twelve equal "
            "parts of the motion. Shading tells the kinds of modes apart. Last, "
            "over the whole motion: how far the worse witness point is off, and the projection "
            "errors |Ψ|; rings are what each reset makes of them, and both fall again as exp(−K t)."
        ),
        text=(
            "Three rows of two panels: on each curve its parameter goes from one end to the other, "
            "is level at vertices, and the next curve's goes on; in the first half second the "
            "heavy lines come to the thin ones from a wrong start. The last panel is of the "
            "errors: teeth that jump at the switches and fall along straight lines between them."
        ),
        draw=lambda: _draw(simulation),
        tables={
            "frames": _frames(simulation),
            "resets": reset_table(simulation.resets),
        },
        statements=measured_by(simulation.by, _statements(simulation)),
    )


def parameters_of(simulation: Simulation, recording: Recording, letter: str) -> Array:
    """Return the parameters of one body's curves by frame, (n, 3), nan where they are not drawn."""
    if letter == "A":
        return curve_parameters(simulation.a, recording.feature_a, recording.parameters_a)
    return curve_parameters(simulation.b, recording.feature_b, recording.parameters_b)


def _frames(simulation: Simulation) -> dict[str, NDArray[np.generic]]:
    exact, paper = simulation.exact, simulation.paper
    table: dict[str, NDArray[np.generic]] = {"time_s": paper.time}
    for letter, names in (("A", ("u_1", "u_2", "u_3")), ("B", ("r_a", "r_b", "r_c"))):
        for k, name in enumerate(names):
            table[name] = parameters_of(simulation, paper, letter)[:, k]
            table[f"{name}_by_own_law"] = parameters_of(simulation, exact, letter)[:, k]
    return table | {
        "feature_a": np.array([short_name(feature) for feature in paper.feature_a]),
        "feature_b": np.array([short_name(feature) for feature in paper.feature_b]),
        "distance_length": paper.distance,
        "distance_by_own_law_length": exact.distance,
        "lower_bound_length": exact.lower_bound,
        "witness_error_length": simulation.witness_error,
    }


def after_switches(simulation: Simulation) -> NDArray[np.bool_]:
    """Return which frames are within `SETTLING` after a switch of either law, shape (n,)."""
    recording = simulation.exact
    events = (*recording.events, *simulation.paper.events)
    since = recording.time[:, None] - np.array([event.time for event in events])
    return np.asarray(((since >= -simulation.step) & (since <= SETTLING)).any(axis=1))


def _statements(simulation: Simulation) -> tuple[Statement, ...]:
    exact, slip = simulation.exact, vertex_slip(simulation)
    error, late = simulation.witness_error, simulation.paper.time > simulation.entered
    quiet = late & ~after_switches(simulation)
    slopes = np.abs([event.slope for event in exact.events])
    located = all(event.located for event in exact.events)
    return (
        Statement(
            "Figs. 8–11",
            "at a vertex the witness point is anchored",
            f"the witness point leaves its vertex by at most {slip:.1e} length",
            slip <= SLIP,
            "a vertex has no parameter that could move",
            constructed=True,
        ),
        decay_statement(simulation.paper, simulation.paths, DECAY, simulation.gain, simulation.by),
        reset_statement(simulation.resets, simulation.by),
        own_statement(
            "Fig. 15",
            f"the start is off the exact witness points by {error[0]:.2f} length; after "
            f"{simulation.entered:g} s by at most {error[late].max():.1e}, and by "
            f"{error[quiet].max():.1e} outside the {SETTLING:g} s after a switch",
            "The rest of a switch's frame still goes with the feedforward of the old feature, and "
            f"what that leaves decays as exp(−K t), 1/K = {1.0 / simulation.gain:g} s.",
        ),
        own_statement(
            "Fig. 15",
            f"{len(exact.events)} switching instants, {'all' if located else 'not all'} "
            f"located; slope of the switching function {slopes.min():.2g} to {slopes.max():.2g} "
            "per s",
            by=simulation.own,
        ),
        own_statement(
            "Fig. 15",
            f"certified in {np.mean(exact.certified):.0%} of the frames, distance "
            f"at most {exact.gap.max():.1e} length above its proven lower bound",
            by=simulation.own,
        ),
    )


def _draw(simulation: Simulation) -> Figure:
    figure = style.new_figure(style.WIDTH, 13.2)
    heights = [1.0] * (2 * len(SPANS)) + [1.6]
    panels = figure.subplots(len(heights), 1, height_ratios=heights)
    for row, span in enumerate(SPANS):
        upper, lower = panels[2 * row : 2 * row + 2]
        _draw_panel(upper, simulation, "A", span)
        _draw_panel(lower, simulation, "B", span)
        if row:
            _write_instants(upper, simulation, span)
            _mark_snapshots(lower, simulation, span)
        upper.tick_params(labelbottom=False)
        lower.set_xlabel("time [s]")
    draw_errors(panels[-1], simulation, least=LEAST_ERROR, linewidth=1.2, label="witness points")
    panels[-1].set_ylabel("error [length],\n|Ψ| [length²]")
    panels[-1].set_xlabel("time [s]")
    panels[-1].set_xlim(0.0, simulation.duration)
    panels[-1].set_ylim(0.5 * LEAST_ERROR, 300.0)
    key_below(figure, _key(), 4)
    return figure


def _draw_panel(axes: Axes, simulation: Simulation, letter: str, span: tuple[float, float]) -> None:
    recording = simulation.paper
    stays = simulation.paper.modes()
    tint(axes, [(stay, FILLS[kind_of(stay.feature_a, stay.feature_b)]) for stay in stays])
    for event in recording.events:
        own = event.body == letter
        axes.axvline(
            event.time,
            color=style.BLACK if own else style.QUIET,
            linestyle=":",
            linewidth=1.1 if own else 0.7,
            zorder=1,
        )
    for k, values in enumerate(parameters_of(simulation, recording, letter).T):
        axes.plot(recording.time, values, **style.line(k), linewidth=2.4, zorder=3)
    for values in parameters_of(simulation, simulation.exact, letter).T:
        axes.plot(recording.time, values, color=style.BLACK, linewidth=0.6, zorder=4)
    axes.set_xlim(span)
    names = ", ".join(NAMES[letter]).replace("r_b", "r$_b$").replace("r_c", "r$_c$")
    unit_interval(axes, f"{letter}: {names} [–]")


def _mark_snapshots(axes: Axes, simulation: Simulation, span: tuple[float, float]) -> None:
    """At the foot of a panel: where the snapshots of Fig. 14 are."""
    for snapshot in snapshots():
        if span[0] <= snapshot.time < span[1]:
            axes.set_ylim(bottom=FOOT)
            axes.plot(snapshot.time, FOOT, "^", color=style.BLACK, markersize=5.0, clip_on=False)
            axes.annotate(
                snapshot.letter,
                (snapshot.time, FOOT),
                xytext=(6.0, 1.0),
                textcoords="offset points",
                fontweight="bold",
                fontsize=style.FONT - 1.0,
            )


def _key() -> list[Artist]:
    words = ("u$_1$, r$_a$: curve C0", "u$_2$, r$_b$: C1", "u$_3$, r$_c$: C2")
    return [
        *(key_line(w, style.COLOURS[k], 2.4, style.DASHES[k]) for k, w in enumerate(words)),
        key_line("library's law", style.BLACK, 0.6),
        *show_kinds(),
    ]


def _write_instants(axes: Axes, simulation: Simulation, span: tuple[float, float]) -> None:
    """Above a panel: the instants, upright, as close to their lines as is readable."""
    starts = named_stays(simulation, span)
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
            fontsize=style.FONT - 2.0,
            annotation_clip=False,
            arrowprops={"arrowstyle": "-", "color": style.QUIET, "linewidth": 0.6, "shrinkA": 0.0},
        )


def named_stays(simulation: Simulation, span: tuple[float, float]) -> list[Visit]:
    """Return the stays that begin in a time and are long enough to be named."""
    return [
        stay
        for stay in simulation.paper.modes()
        if span[0] <= stay.start < span[1] and stay.end - stay.start > LEAST_NAMED
    ]


def spread(wanted: Array, apart: float) -> Array:
    """Return the places nearest to the wanted ones that keep order and a least spacing."""
    even = apart * np.arange(len(wanted))
    return np.asarray(isotonic_regression(wanted - even).x + even)
