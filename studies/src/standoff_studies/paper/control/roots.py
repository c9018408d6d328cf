"""Figure "stability": stability regions of the integrators and root loci of the sampled loop."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from standoff.control import growth_factor, sampled_roots, stability_limit
from standoff.tracking import feedback
from standoff.typing import Array
from standoff_studies.paper import style
from standoff_studies.paper.control.decay import DAMPINGS, PROPORTIONAL, loops
from standoff_studies.paper.control.gains import AGREE, worst_loop
from standoff_studies.paper.figure import Artwork, Statement, measured_by, own_statement
from standoff_studies.paper.law_words import law_words

DAMPING = DAMPINGS[1:]
"""Damping ratios of the PI loci: K_i = (K / (2 zeta))², roots -zeta w +- i w sqrt(1 - zeta²)."""
GAINS = np.linspace(0.01, 4.5, 400)
"""K h along a locus."""
MARKED = {
    "euler": ((1.0, 0.0), (2.0, -1.0)),
    "heun": ((1.0, 0.5), (2.0, 1.0)),
    "rk4": ((1.6, 0.2704), (2.785, 1.0)),
}
"""K h that are marked on the real root of proportional feedback, and the root there."""
METHODS = ("euler", "heun", "rk4")
TITLES = {"euler": "Euler", "heun": "Heun and midpoint", "rk4": "RK4"}


class Locus(NamedTuple):
    """Roots of the sampled loop as the gain grows.

    Attributes
    ----------
    integrator : str
    damping : float
        Of the continuous loop; inf for proportional feedback, whose one root is real.
    gain : (n,) array
        K h.
    roots : (n, 1 or 2) complex array
    limit : float
        The greatest K h up to which all roots stay inside the unit circle.
    """

    integrator: str
    damping: float
    gain: Array
    roots: Array
    limit: float


@cache
def loci() -> tuple[Locus, ...]:
    """Loci of each integrator: proportional feedback and PI with three dampings."""
    return tuple(_locus(name, zeta) for name in METHODS for zeta in (np.inf, *DAMPING))


def _locus(integrator: str, damping: float) -> Locus:
    def law(z: float) -> feedback.Feedback:
        if np.isinf(damping):
            return feedback.Linear(z)
        return feedback.PI(z, (0.5 * z / damping) ** 2)

    # in units of the step: dt = 1
    roots = np.array([sampled_roots(integrator, law(float(z)), 1.0) for z in GAINS])
    outside = np.flatnonzero((np.abs(roots) >= 1.0).any(axis=1))
    low, high = float(GAINS[outside[0] - 1]), float(GAINS[outside[0]])
    for _ in range(50):
        middle = 0.5 * (low + high)
        stable = (np.abs(sampled_roots(integrator, law(middle), 1.0)) < 1.0).all()
        low, high = (middle, high) if stable else (low, middle)
    return Locus(integrator, damping, GAINS, roots, low)


def stability() -> Artwork:
    """Stability regions and root loci."""
    return Artwork(
        caption=(
            "Above left: where a step does not enlarge a solution of y′ = s y, in the plane of "
            "s h; the paper's law has s = −K and meets each boundary on the real axis. The other "
            "three: roots of the sampled error loop as the gain K grows from 0, where they start "
            "at 1; inside the circle the loop is stable. Black: the real root of proportional "
            "feedback up to its limit. Lines: PI feedback of damping ζ = K / (2 √K_i); triangles: "
            f"roots measured on the tracker at K h = {PROPORTIONAL:g}."
        ),
        text=(
            "Four square plots. Three nested regions left of the imaginary axis, the disc of "
            "Euler in that of Heun in that of RK4. Then unit circles with curves that start at 1: "
            "Euler's proportional root runs left along the real axis and leaves at -1, those of "
            "Heun and RK4 turn back and leave at 1; the less the damping the sooner a curve leaves."
        ),
        draw=_draw,
        tables=_tables(),
        statements=measured_by(by(), _statements()),
    )


def by() -> str:
    """Return the law with which the statements were measured."""
    ran = law_words(*(loop.tracker for loop in loops()), told="from 1e-5 off the minimum")
    return f"so.control, linear theory: no tracker; measured roots by {ran}"


def _statements() -> tuple[Statement, ...]:
    limits = {(one.integrator, one.damping): one.limit for one in loci()}
    linear = ", ".join(f"{TITLES[m]} {limits[m, np.inf]:.4g}" for m in METHODS)
    weak = ", ".join(f"{TITLES[m]} {limits[m, DAMPING[-1]]:.3g}" for m in METHODS)
    exact = all(abs(limits[m, np.inf] / stability_limit(m) - 1.0) < AGREE for m in METHODS)
    return (
        Statement(
            "Gains",
            "-",
            f"the root leaves the unit circle at K h = {linear}",
            exact,
        ),
        own_statement(
            "Gains",
            f"with PI of damping {DAMPING[-1]:g} at K h = {weak}: integral action costs gain",
        ),
        own_statement(
            "Gains", f"measured roots of the PI loop lie on the loci to {worst_loop():.0e}"
        ),
    )


def _tables() -> dict[str, dict[str, Array | list[str]]]:
    rows = [
        (one, z, root)
        for one in loci()
        for z, pair in zip(one.gain, one.roots, strict=True)
        for root in pair
    ]
    return {
        "loci": {
            "integrator": [one.integrator for one, _, _ in rows],
            "damping": np.array([one.damping for one, _, _ in rows]),
            "gain_times_step": np.array([z for _, z, _ in rows]),
            "root_real": np.array([root.real for _, _, root in rows]),
            "root_imaginary": np.array([root.imag for _, _, root in rows]),
        },
        "limits": {
            "integrator": [one.integrator for one in loci()],
            "damping": np.array([one.damping for one in loci()]),
            "greatest_gain_times_step": np.array([one.limit for one in loci()]),
        },
    }


def _draw() -> Figure:
    figure = style.new_figure(style.WIDTH, 7.4)
    parts = figure.subplots(2, 2).ravel()
    _draw_regions(parts[0])
    for axes, name in zip(parts[1:], METHODS, strict=True):
        _draw_loci(axes, name)
    parts[3].legend(loc="lower left", handlelength=1.8, borderpad=0.25, labelspacing=0.25)
    return figure


def _draw_regions(axes: Axes) -> None:
    x, y = np.meshgrid(np.linspace(-3.4, 0.9, 300), np.linspace(-3.2, 3.2, 400))
    for k in (2, 1, 0):
        size = np.abs(growth_factor(METHODS[k], x + 1j * y))
        axes.contourf(x, y, size, levels=[0.0, 1.0], colors=[style.COLOURS[k]], alpha=0.16)
        dashes = [style.DASHES[k]]
        axes.contour(x, y, size, levels=[1.0], colors=[style.COLOURS[k]], linestyles=dashes)
        limit = -stability_limit(METHODS[k])
        if k != 1:
            axes.plot(limit, 0.0, style.MARKERS[k], color=style.COLOURS[k], markersize=6)
    for (u, v), name in (((-1.0, 0.0), "Euler"), ((-1.0, 1.32), "Heun"), ((-0.55, 2.35), "RK4")):
        axes.text(u, v, name, ha="center", va="center")
    axes.axhline(0.0, color=style.QUIET, linewidth=0.8)
    axes.axvline(0.0, color=style.QUIET, linewidth=0.8)
    axes.set(title="stable region", xlabel="Re s h  (−K h)", ylabel="Im s h", xlim=(-3.4, 0.9))
    axes.set_aspect("equal")


def _draw_loci(axes: Axes, name: str) -> None:
    around = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 200))
    axes.fill(around.real, around.imag, color=style.SKY, alpha=0.15, linewidth=0)
    axes.plot(around.real, around.imag, color=style.QUIET, linewidth=1.0)
    for k, one in enumerate(o for o in loci() if o.integrator == name and np.isfinite(o.damping)):
        for j in range(2):
            root, label = one.roots[:, j], f"ζ = {one.damping:g}" if j == 0 else None
            axes.plot(root.real, root.imag, **style.line(k), label=label)
    _draw_proportional(axes, name)
    for loop in loops():
        if loop.integrator == name:
            axes.plot(loop.measured.real, loop.measured.imag, "^", color=style.BLACK, markersize=4)
    axes.set(title=TITLES[name], xlabel="Re", ylabel="Im", xlim=(-1.8, 1.8), ylim=(-1.8, 1.8))
    axes.set_aspect("equal")


def _draw_proportional(axes: Axes, name: str) -> None:
    """The real root of proportional feedback: it starts at 1 and turns back, or leaves at -1."""
    z = np.linspace(0.0, stability_limit(name), 100)
    root = growth_factor(name, -z)
    axes.plot(root, 0.0 * root, color=style.BLACK, linewidth=2.6, solid_capstyle="butt")
    for k, (gain, at) in enumerate(MARKED[name]):
        axes.annotate(
            f"K h = {gain:g}",
            (at, 0.0),
            (at - 0.1, -1.22 - 0.32 * k),
            ha="center",
            va="center",
            arrowprops={"arrowstyle": "-|>", "color": style.BLACK, "linewidth": 0.8},
            bbox={"color": "white", "pad": 0.8},
        )
