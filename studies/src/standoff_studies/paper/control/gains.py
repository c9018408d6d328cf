"""Figure "gains": decay by step predicted and measured; the lag and the gain that bounds it."""

from __future__ import annotations

from functools import cache

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from standoff.control import growth_factor, stability_limit
from standoff.typing import Array
from standoff_studies.paper import style
from standoff_studies.paper.control.decay import arrival, decays, loops
from standoff_studies.paper.control.lag import FRAMES, PAIRS, Lag, measured_lags
from standoff_studies.paper.figure import Artwork, Statement, measured_by, own_statement
from standoff_studies.paper.law_words import law_words

CASES = 480
"""Random pairs on which the lag is measured."""
AGREE = 1e-7
"""Greatest deviation of a measured growth factor from its prediction: that of Psi's roundoff, 1e-16
of 1e-5, and of the chart's curvature, with a margin."""
NAMED = {"euler": "Euler", "heun": "Heun", "midpoint": "midpoint", "rk4": "RK4"}


@cache
def lags() -> tuple[Lag, ...]:
    """The lag of random pairs without feedforward, at the gain of `so.min_gain`."""
    return tuple(measured_lags(CASES))


def worst_decay() -> float:
    """Greatest difference of a measured growth factor from its prediction."""
    return max(float(np.abs(d.measured - d.predicted).max()) for d in decays().values())


def worst_loop() -> float:
    """Greatest difference of a measured root of the PI loop from its prediction."""
    return max(float(np.abs(loop.measured - loop.predicted).max()) for loop in loops())


def worst_arrival() -> float:
    """Greatest difference of the finite-time law's errors from its equation, in references."""
    return float(np.abs(arrival().measured - arrival().predicted).max())


def by() -> str:
    """Return the law with which the statements were measured."""
    growing = law_words(*(one for made in decays().values() for one in made.trackers))
    looped = law_words(*(loop.tracker for loop in loops()))
    lagging = law_words(*(lag.tracker for lag in lags()))
    return (
        f"from 1e-5 off the minimum at rest {growing}; the PI loop, {looped}; the lower bound, "
        f"from the closest points, {lagging}"
    )


def decay_and_lag() -> Artwork:
    """Decay and lag."""
    return Artwork(
        caption=(
            "Above: by what a step of the paper's law multiplies small projection errors, against "
            "K h. Lines: the growth factor R(−K h) from the integrator's tableau; marks: the real "
            "tracker on two ellipsoids at rest. Outside the tinted band errors grow. Below: how "
            "far the witness points lag without feedforward, in parts of what so.min_gain "
            f"promises, {len(lags())} random pairs in motion over {FRAMES} frames each; a bar "
            "stands at each kind's greatest."
        ),
        text=(
            "Two plots. Three curves of growth factors that start at 1; Euler falls straight to "
            "-1 at K h = 2, Heun and midpoint dip to 0.5 at 1 and return to 1 at 2, RK4 dips to "
            "0.27 and returns to 1 at 2.785; all marks lie on them. And six rows of dots, one a "
            "kind of pair, all left of the line at 1."
        ),
        draw=_draw,
        tables=_tables(),
        statements=measured_by(by(), _statements()),
    )


def _statements() -> tuple[Statement, ...]:
    parts = np.array([lag.part for lag in lags()])
    limits = ", ".join(f"{NAMED[name]} {stability_limit(name):.4g}" for name in decays())
    return (
        Statement(
            "Eqs. (12)–(14)",
            "the feedback makes the errors obey dΨ/dt = −KΨ",
            f"by step Ψ is multiplied by R(−Kh) to {worst_decay():.0e}, four integrators over "
            "their stable range",
            worst_decay() < AGREE,
        ),
        own_statement(
            "Gains",
            f"K h below {limits}: where |R(−Kh)| reaches 1",
            "so.max_gain; the paper's 1500 at 1 kHz is a practical value below 2000",
        ),
        Statement(
            "Gains",
            "other feedbacks can be synthesised",
            f"PI: both roots of the sampled loop as predicted to {worst_loop():.0e}; finite-time: "
            f"the errors' course as predicted to {worst_arrival():.0e} of the reference",
            max(worst_loop(), worst_arrival()) < AGREE,
        ),
        Statement(
            "Gains",
            "a lower bound of K follows from the motion",
            f"so.min_gain's promise broken in {int((parts > 1.0).sum())} of {len(parts)} cases; "
            f"the worst comes to {parts.max():.0%} of it, the median to {np.median(parts):.0%}",
            bool((parts <= 1.0).all()),
            "bodies with edges or vertices stay further below: their gain allows for features "
            "that are left late",
        ),
    )


def _tables() -> dict[str, dict[str, Array | list[str]]]:
    tables: dict[str, dict[str, Array | list[str]]] = {
        f"decay-{name}": {
            "gain_times_step": d.z,
            "measured_factor": d.measured,
            "predicted_factor": d.predicted,
        }
        for name, d in decays().items()
    }
    rows = [(loop, k) for loop in loops() for k in range(2)]
    tables["pi-loop"] = {
        "integrator": [loop.integrator for loop, _ in rows],
        "gain_per_s": np.array([loop.gain for loop, _ in rows]),
        "integral_gain_per_s2": np.array([loop.integral for loop, _ in rows]),
        "measured_real": np.array([loop.measured[k].real for loop, k in rows]),
        "measured_imaginary": np.array([loop.measured[k].imag for loop, k in rows]),
        "predicted_real": np.array([loop.predicted[k].real for loop, k in rows]),
        "predicted_imaginary": np.array([loop.predicted[k].imag for loop, k in rows]),
    }
    tables["lag"] = {
        "pair": [lag.kind for lag in lags()],
        "error_length": np.array([lag.error for lag in lags()]),
        "bound_length": np.array([lag.bound for lag in lags()]),
    }
    return tables


def _draw() -> Figure:
    figure = style.new_figure(style.WIDTH, 7.6)
    above, below = figure.subplots(2, 1, height_ratios=(1.25, 1.0))
    _draw_decay(above)
    _draw_lag(below)
    return figure


def _draw_decay(axes: Axes) -> None:
    axes.axhspan(-1.0, 1.0, color=style.SKY, alpha=0.15, linewidth=0)
    same = {"euler": "Euler", "heun": "Heun", "rk4": "RK4"}
    for k, (name, d) in enumerate(decays().items()):
        colour = style.COLOURS[k]
        if name in same:
            z = np.linspace(0.0, 1.04 * stability_limit(name), 200)
            words = f"R(−K h), {'Heun and midpoint' if name == 'heun' else same[name]}"
            axes.plot(z, growth_factor(name, -z), **style.line(k), label=words)
        axes.plot(
            d.z,
            d.measured,
            style.MARKERS[k],
            color=colour,
            markersize=8.5 if name == "heun" else 5.0,
            markerfacecolor="none" if name == "heun" else colour,
            label=f"measured, {NAMED[name]}",
        )
    axes.axhline(0.0, color=style.QUIET, linewidth=0.8)
    axes.set(xlabel="K h", ylabel="Ψ after a step / Ψ before", xlim=(0.0, 2.95), ylim=(-1.15, 1.15))
    axes.legend(loc="lower left")


def _draw_lag(axes: Axes) -> None:
    parts = {kind: [lag.part for lag in lags() if lag.kind == kind] for kind in PAIRS}
    draw_parts(axes, parts, "measured lag / lag promised by so.min_gain")


def draw_parts(axes: Axes, parts: dict[str, list[float]], label: str) -> None:
    """Draw a row of dots for each kind, in parts of what is promised, the greatest as a line."""
    random = np.random.default_rng(0)
    for row, own in enumerate(parts.values()):
        spread = row + random.uniform(-0.28, 0.28, len(own))
        axes.plot(own, spread, ".", color=style.BLUE, markersize=3.5, alpha=0.6)
        axes.plot([max(own)] * 2, [row - 0.36, row + 0.36], color=style.BLACK, linewidth=2.0)
    axes.axvline(1.0, color=style.RED, linestyle="--")
    axes.set_yticks(range(len(parts)), list(parts))
    axes.set(xlabel=label, xlim=(0.0, 1.05))
    axes.grid(axis="y", visible=False)
    axes.invert_yaxis()
