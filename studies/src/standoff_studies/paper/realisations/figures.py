"""Figs. 3 and 4: both block diagrams, and how the two realisations differ."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from standoff.typing import Array
from standoff_studies.paper import style
from standoff_studies.paper.figure import Artwork, measured_by
from standoff_studies.paper.keys import key_below, key_line
from standoff_studies.paper.law_words import law_words
from standoff_studies.paper.realisations import comparison as c
from standoff_studies.paper.realisations.diagrams import draw_evaluated, draw_integrated
from standoff_studies.paper.realisations.statements import of_evaluated, of_integrated

TOLD = "two bodies, face against face, the start as told"
"""What the record of the trackers does not contain."""

EVERY = 20
"""Every how many frames of the long runs a point is drawn: their errors vary slowly."""

NAMES = {"euler": "Euler", "heun": "Heun", "rk4": "RK4"}

LEAST_DRAWN = 1e-10
"""Errors below this are not drawn [length²]: roundoff."""


def figure_3() -> Artwork:
    """Fig. 3: Psi integrated as a state."""
    return Artwork(
        caption=(
            "Above: the law with Ψ as a state, integrated from Ψ' = M w + b beside the parameters "
            "(thick: integrators; dashed: matrices; the bodies' motion enters M and b only). "
            "Below: errors after a wrong start (two faces in motion, Heun, "
            f"h = {1e3 * c.SHORT_STEP:g} ms, K = {c.GAIN:g} 1/s). The errors that the loop "
            "believes in decay to roundoff, while the true ones, by Eqs. (1)–(4) at its "
            "parameters, stay at what integration has lost."
        ),
        text=(
            "A block diagram: −K, sum, M⁻¹, M, sum and an integrator in a ring that Ψ goes round, "
            "and a second integrator from w to q. Below, three falling curves: one goes on "
            "falling, one levels off early, the one of Fig. 4 levels off twenty times lower."
        ),
        draw=_draw_integrated,
        tables={"decay": _decay_table()},
        statements=measured_by(law_words(*c.trackers(), told=TOLD), of_integrated()),
    )


def figure_4() -> Artwork:
    """Fig. 4: Psi evaluated at the parameters."""
    return Artwork(
        caption=(
            "Above: the law with Ψ evaluated from Eqs. (1)–(4); only q is integrated, and the "
            "poses enter the loop. Below, distances of witness points. Middle: how far the "
            f"realisations of Figs. 3 and 4 are apart {c.SPAN:g} s after a wrong start, left by "
            "step and gain (Heun), right by step and integrator. Bottom: true errors in 20 s from "
            f"the right start, K = {c.GAIN:g} 1/s, h = {1e3 * c.LONG_STEP:g} ms; solid Fig. 3, "
            "dashed Fig. 4; left with true twists, right (Heun) with B's velocity told wrong by a "
            "constant."
        ),
        text=(
            "A block diagram: −K, sum, M⁻¹, an integrator from w to q, and Ψ evaluated at q in "
            "one ring. Below, four plots: two with straight lines that fall with the step, two in "
            "which the errors of the integrated realisation climb with time while those of the "
            "evaluated one stay level."
        ),
        draw=_draw_evaluated,
        tables=_comparison_tables(),
        statements=measured_by(law_words(*c.trackers(), told=TOLD), of_evaluated()),
    )


def _decay_table() -> dict[str, Array]:
    made = c.decay()
    return {
        "time_s": np.asarray(c.SHORT_STEP * np.arange(len(made.believed))),
        "believed_psi_length2": made.believed,
        "integrated_psi_length2": made.integrated,
        "evaluated_psi_length2": made.evaluated,
    }


def _comparison_tables() -> dict[str, dict[str, Array]]:
    by_step: dict[str, Array] = {"step_s": c.by_integrator()["heun"].step}
    by_step |= {f"heun_{gain:g}_apart_length": d.apart for gain, d in c.by_gain().items()}
    for name, d in c.by_integrator().items():
        by_step[f"{name}_{c.GAIN:g}_apart_length"] = d.apart
    long: dict[str, Array] = {"time_s": c.long_time()}
    for realisation in c.REALISATIONS:
        for name in c.ORDERS:
            long[f"{realisation}_{name}_error_length"] = c.drift(realisation, name)
        for bias in c.BIASES[1:]:
            errors = c.drift(realisation, "heun", bias)
            long[f"{realisation}_heun_told_{bias:g}_wrong_error_length"] = errors
    return {"apart": by_step, "drift": long}


def _draw_integrated() -> Figure:
    figure = style.new_figure(style.WIDTH, 6.4)
    above, below = figure.subplots(2, 1, height_ratios=(1.0, 0.95))
    draw_integrated(above)
    made = c.decay()
    time = c.SHORT_STEP * np.arange(len(made.believed))
    for n, (name, errors) in enumerate(
        (
            ("Fig. 3: Ψ believed (the state)", made.believed),
            ("Fig. 3: true Ψ", made.integrated),
            ("Fig. 4: true Ψ", made.evaluated),
        )
    ):
        seen = errors > LEAST_DRAWN
        below.plot(time[seen], errors[seen], **style.marked(n, 5, markevery=20), label=name)
    below.set(yscale="log", xlabel="time [s]", ylabel="|Ψ| [length²]", xlim=(0.0, time[-1]))
    below.legend(loc="upper right", handlelength=4.5)
    return figure


def _draw_evaluated() -> Figure:
    figure = style.new_figure(style.WIDTH, 9.4)
    grid = figure.add_gridspec(3, 2, height_ratios=(1.15, 1.0, 1.0))
    gain, method, true, wrong = (
        figure.add_subplot(grid[row, column]) for row in (1, 2) for column in (0, 1)
    )
    draw_evaluated(figure.add_subplot(grid[0, :]))
    _draw_apart(gain, {f"K = {gain:g} 1/s": d for gain, d in c.by_gain().items()}, "Heun")
    _draw_apart(
        method,
        {f"{NAMES[name]}, order {c.ORDERS[name]}": d for name, d in c.by_integrator().items()},
        f"K = {c.GAIN:g} 1/s",
    )
    gain.legend(loc="upper left")
    method.legend(loc="lower right")
    _draw_drift(true, [(name, 0.0, NAMES[name]) for name in c.ORDERS], "true twists")
    _draw_drift(
        wrong,
        [("heun", bias, f"off by {bias:g} [length/s]") for bias in reversed(c.BIASES[1:])],
        "wrong twists, Heun",
    )
    true.set_ylim(bottom=1e-13)
    true.legend(loc="lower center", ncols=3, handlelength=1.5, columnspacing=1.0)
    wrong.legend(loc="center right")
    _tell_dashes(figure)
    return figure


def _tell_dashes(figure: Figure) -> None:
    """Below the lower plots: solid is the one realisation, dashed the other."""
    handles = [
        key_line("Fig. 3: Ψ integrated (lower plots)", style.BLACK),
        key_line("Fig. 4: Ψ evaluated (lower plots)", style.BLACK, dashes="--"),
    ]
    key_below(figure, handles, 2, handlelength=4.0)


def _draw_apart(axes: Axes, lines: dict[str, c.Difference], title: str) -> None:
    for n, (name, made) in enumerate(lines.items()):
        axes.plot(1e3 * made.step, made.apart, **style.marked(n, 5), label=name)
    axes.set(xscale="log", yscale="log", title=title, xlabel="h [ms]", ylabel="apart [length]")
    axes.set_xticks(1e3 * made.step, [f"{1e3 * step:g}" for step in made.step])
    axes.minorticks_off()


def _draw_drift(axes: Axes, runs: list[tuple[str, float, str]], title: str) -> None:
    """Integrated solid, evaluated dashed; one colour and marker per pair."""
    time = c.long_time()[EVERY::EVERY]
    for n, (method, bias, label) in enumerate(runs):
        for name, dashes in zip(c.REALISATIONS, ("-", "--"), strict=True):
            errors = c.drift(name, method, bias)[EVERY::EVERY]
            look = style.marked(n, 5, markevery=20) | {"linestyle": dashes}
            axes.plot(time, errors, **look, label=label if dashes == "-" else None)
    axes.set(yscale="log", title=title, xlabel="time [s]", ylabel="error [length]")
