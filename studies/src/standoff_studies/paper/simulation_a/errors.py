"""Fig. 7: normalised projection errors by step, and the effect of the gain on their decay."""

from __future__ import annotations

from functools import cache

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from standoff.typing import Array
from standoff_studies.paper import style
from standoff_studies.paper.figure import Artwork
from standoff_studies.paper.simulation_a import gains
from standoff_studies.paper.simulation_a.run import SETTLED, Run, run
from standoff_studies.paper.simulation_a.statements import statements

SHOWN = {100.0: 100, 1000.0: 20}
"""The paper's gains [1/s], each with the steps that are drawn."""


@cache
def shown(gain: float) -> Run:
    """The run of a panel, twice as long as shown, to check that what has settled stays."""
    return run(gain, 2 * SHOWN[gain])


def figure_7() -> Artwork:
    """Fig. 7."""
    return Artwork(
        caption=(
            "Above: magnitudes of the two projection errors, each in parts of its first, after "
            f"a wrong start at K = 100 and K = 1000 1/s (Heun's method, 1 kHz); grey: what linear "
            "theory predicts, (1 − Kh + (Kh)²/2)ⁿ. Middle: steps until both errors are below "
            f"{SETTLED:g}, against K (the inset of the paper's figure), by theory and as measured; "
            "tinted: the paper's stable range, 0.5 to 1500 1/s. Below left: how many of "
            f"{gains.GRID**2} starts all over the patch settle, by the law without safeguards "
            "(light line: the paper's 1500 1/s, dashed: 2000). "
            "Below right: the greatest error while the point moves on, with the feedforward b "
            "and without it; dashed: max|b|/K."
        ),
        text=(
            "Five plots. Two of errors that fall from 1 to nearly 0 in about 70 and 10 steps; "
            "one of the steps to settle, which falls in proportion to 1/K, is least at "
            "K = 1000 1/s and rises steeply towards 2000 1/s; one of the share of starts that "
            "settle, 100 % up to 1300 1/s and 98 % beyond; one of steady errors."
        ),
        draw=_draw,
        tables=_tables(),
        statements=statements(shown(100.0), shown(1000.0)),
    )


def _tables() -> dict[str, dict[str, Array]]:
    tables: dict[str, dict[str, Array]] = {}
    for gain in SHOWN:
        made = shown(gain)
        tables[f"errors-{gain:.0f}"] = {
            "step": np.arange(len(made.q), dtype=float),
            "time_s": made.recording.time,
            "normalised_psi_u": made.normalised[:, 0],
            "normalised_psi_v": made.normalised[:, 1],
            "predicted": np.asarray(gains.growth(gain) ** np.arange(len(made.q))),
        }
    settling, steady, trials = gains.settling(), gains.steady(), gains.trials()
    tables["settling"] = {
        "gain_per_s": settling.gain,
        "steps": settling.steps,
        "predicted_steps": settling.predicted,
    }
    tables["starts"] = {
        "gain_per_s": np.array(gains.TRIED_GAINS, dtype=float),
        "settled_share": (trials.steps >= 0).mean(axis=1),
        "failed_share_with_indefinite_h": trials.indefinite.mean(axis=1),
        "monotone_share": trials.monotone.mean(axis=1),
    }
    tables["steady"] = {
        "gain_per_s": steady.gain,
        "psi_with_feedforward_length2": steady.forward,
        "psi_without_feedforward_length2": steady.without,
    }
    return tables


def _draw() -> Figure:
    figure = style.new_figure(style.WIDTH, 9.0)
    parts = figure.subplot_mosaic([["slow", "fast"], ["steps", "steps"], ["starts", "steady"]])
    for name, gain in zip(("slow", "fast"), SHOWN, strict=True):
        _draw_errors(parts[name], gain)
    parts["slow"].set_ylabel("|Ψ| / |Ψ(0)|")
    _draw_steps(parts["steps"])
    _draw_starts(parts["starts"])
    _draw_steady(parts["steady"])
    return figure


def _draw_errors(axes: Axes, gain: float) -> None:
    made, end = shown(gain), SHOWN[gain]
    assert made.steps is not None
    step = np.arange(end + 1)
    axes.plot(step, gains.growth(gain) ** step, color=style.QUIET, linewidth=4.0, label="theory")
    for k, name in enumerate(("$\\Psi_u$", "$\\Psi_v$")):
        axes.plot(
            step,
            made.normalised[: end + 1, k],
            **style.marked(k, 8 - 4 * k),
            markerfacecolor="none" if k == 0 else None,
            markevery=max(1, end // 20),
            label=name,
        )
    axes.plot([made.steps] * 2, [0.0, 0.4], color=style.BLACK, linewidth=1.0, linestyle=":")
    axes.text(made.steps, 0.45, f"{made.steps} steps", ha="center", va="center")
    axes.set(title=f"K = {gain:.0f} 1/s", xlabel="step of 1 ms", xlim=(0, end), ylim=(0, 1.03))
    axes.legend(loc="upper right")


def _draw_steps(axes: Axes) -> None:
    made = gains.settling()
    line = np.geomspace(made.gain[0], 1997.0, 400)
    axes.axvspan(*gains.STATED, color=style.SKY, alpha=0.18, linewidth=0)
    axes.plot(line, gains.predicted_steps(line), color=style.QUIET, linewidth=2.4, label="theory")
    axes.plot(made.gain, made.steps, "o", color=style.BLUE, markersize=5, label="measured")
    axes.axvline(gains.LIMIT, color=style.RED, linestyle="--", label="limit of theory, 2000 1/s")
    axes.set(
        xscale="log",
        yscale="log",
        xlabel="K [1/s]",
        ylabel=f"steps until |Ψ| / |Ψ(0)| < {SETTLED:g}",
        ylim=(5, 5e4),
    )
    axes.text(30.0, 6.5, "tinted: the paper's stable range", ha="center")
    axes.legend(loc="upper center")


def _draw_starts(axes: Axes) -> None:
    share = 100.0 * (gains.trials().steps >= 0).mean(axis=1)
    axes.plot(gains.TRIED_GAINS, share, "s-", color=style.BLUE, markersize=4)
    axes.axvline(gains.STATED[1], color=style.SKY, linewidth=3.0, alpha=0.6)
    axes.axvline(gains.LIMIT, color=style.RED, linestyle="--")
    axes.set(xlabel="K [1/s]", ylabel="starts that settle [%]", ylim=(0.0, 105.0))
    axes.set_xlim(1000.0, 2020.0)


def _draw_steady(axes: Axes) -> None:
    made = gains.steady()
    bound = gains.greatest_feedforward() / made.gain
    axes.plot(made.gain, bound, color=style.QUIET, linestyle="--", linewidth=2.4, label="max|b|/K")
    axes.plot(made.gain, made.without, "s-", color=style.RED, markersize=4, label="without b")
    axes.plot(made.gain, made.forward, "o-", color=style.BLUE, markersize=4, label="with b")
    axes.set(xscale="log", yscale="log", xlabel="K [1/s]", ylabel="steady |Ψ| [length²]")
    axes.legend(loc="center left")
