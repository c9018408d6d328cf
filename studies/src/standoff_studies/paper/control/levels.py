"""Figure "lyapunov": decreasing functions of the parameter error, and where they are valid."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import standoff as so
from standoff.bodies import Body
from standoff.control.basin import Basin, basin
from standoff.control.lyapunov import LyapunovLevels, lyapunov_level
from standoff.geometry.validation import Array
from standoff.motion import Pose, Twist
from standoff_studies.paper import style
from standoff_studies.paper.figure import Artwork, Statement, measured_by, own_statement
from standoff_studies.paper.keys import key_line
from standoff_studies.paper.law_words import law_words

STEP, GAIN = 1e-3, 100.0
"""Frame time [s] and gain [1/s] of the checking runs: K h = 0.1."""
FRAMES = 250
"""Frames of a run: e^-25 of an error is left."""
WATCHED, WATCHED_FRAMES, WATCHED_GAIN = 60, 40, 50.0
"""Runs whose functions are evaluated at each frame, their frames and gain [1/s]: K h = 0.05."""
CLEAR = 0.9
"""Fraction of the levels within which those runs start: near a singular H a single step differs
from the law in continuous time."""
ROUNDOFF = 1e-14
"""Rise of E that is roundoff [length²]: a few units in the last place of E itself, about 1."""
PART = 0.999
"""Starts are within this fraction of the level."""

POINT_AT = (0.75, 0.45, 1.0)
"""The point above the cap [length]."""
POSE_B = ([2.9, 0.3, 0.2], [0.7, 0.4, 1.9])
"""The second cap: rotation vector [rad] and position [length]."""
GRID = 71
"""Points per side at which the functions are evaluated for the picture."""


TOLD = "where dV/dt is watched the second; bodies at rest, starts within the level"
"""What the record of the trackers does not contain."""


@cache
def cap() -> Body:
    """The greater part of an ellipsoid, whose curved face has one chart."""
    return so.shapes.cap(1.0, 0.36).transformed(np.diag([1.0, 0.8, 0.6]))


class Case(NamedTuple):
    """A pair at rest with its levels."""

    a: Body
    b: Body
    pose_b: Pose
    levels: LyapunovLevels


@cache
def case(bodies: str) -> Case:
    """ "point": the cap's face and a point, 2 parameters; "faces": two caps' faces, 4."""
    turn, shift = POSE_B
    if bodies == "point":
        b, pose = so.shapes.point(), Pose(np.eye(3), POINT_AT)
    else:
        b, pose = cap(), Pose.exp(turn, shift)
    directions = 96 if bodies == "point" else 120
    return Case(cap(), b, pose, lyapunov_level(cap(), b, Pose.identity(), pose, directions))


@cache
def tracker(bodies: str) -> so.Tracker:
    """Return the tracker of the raw law."""
    made = case(bodies)
    return so.Tracker(made.a, made.b, STEP, law=so.PaperLaw(gain=GAIN, solve="plain"))


@cache
def watched_tracker(bodies: str) -> so.Tracker:
    """Return the tracker whose V and E are recorded: it stays on its features."""
    made = case(bodies)
    law = so.PaperLaw(integrator="rk4", gain=WATCHED_GAIN, solve="plain", switching="none")
    return so.Tracker(made.a, made.b, STEP, law=law)


def by() -> str:
    """Return the laws with which the statements were measured."""
    both = (law_words(*map(made, ("point", "faces"))) for made in (tracker, watched_tracker))
    return "; ".join([*both, TOLD])


@cache
def runs(bodies: str) -> tuple[Basin, Basin]:
    """The raw law from starts within the level of V, and within that of E."""
    made = case(bodies)
    within = [[places(made, q) for q in points] for points in made.levels.inside(PART)]
    home = Pose.identity()
    first, second = (basin(tracker(bodies), home, made.pose_b, starts, FRAMES) for starts in within)
    return first, second


def places(made: Case, q: Array) -> tuple[tuple[so.Feature, Array], tuple[so.Feature, Array]]:
    """Parameters as places on both bodies."""
    return (made.levels.feature_a, q[:2]), (made.levels.feature_b, q[2:])


class Watched(NamedTuple):
    """V and E, frame by frame.

    Attributes
    ----------
    v, e : (m, WATCHED_FRAMES + 1) arrays
        V and E - E* by run and frame, relative to those at its start.
    rate : float
        Greatest deviation of -ln(V / V before) / (2 K h) from 1.
    rises : int
        Frames at which V or E rose.
    indefinite : int
        Frames at which H was not positive definite.
    frames : int
    """

    v: Array
    e: Array
    rate: float
    rises: int
    indefinite: int
    frames: int


@cache
def watched(bodies: str) -> Watched:
    """V and E along runs from within both levels, evaluated by `so.tracking.pair_system`."""
    made = case(bodies)
    tracker = watched_tracker(bodies)
    by_slope, by_energy = made.levels.inside(CLEAR)
    chosen = [x[:: max(1, 2 * len(x) // WATCHED)] for x in (by_slope, by_energy)]
    home, still = Pose.identity(), Twist.zero()
    rows = []
    for q in np.vstack(chosen):
        on_a, on_b = places(made, q)
        state = tracker.start_from(home, made.pose_b, on_a, on_b, settle=False)
        values = [functions(made, q)]
        for _ in range(WATCHED_FRAMES):
            state, answer = tracker.step(state, home, made.pose_b, still, still)
            now = np.array(answer.parameters_a + answer.parameters_b)
            values.append(functions(made, now))
        rows.append(values)
    v, e, least = np.moveaxis(np.array(rows), -1, 0)
    e = e - functions(made, made.levels.optimum)[1]
    ratios = -np.diff(np.log(v), axis=1) / (2.0 * WATCHED_GAIN * STEP)
    rises = (np.diff(v) > 0.0).sum() + (np.diff(e) > ROUNDOFF).sum()
    return Watched(
        v / v[:, :1],
        e / e[:, :1],
        float(np.abs(ratios - 1.0).max()),
        int(rises),
        int((least <= 0.0).sum()),
        v.shape[0] * WATCHED_FRAMES,
    )


def functions(made: Case, q: Array) -> tuple[float, float, float]:
    """V, E and the least eigenvalue of H at parameters."""
    system = so.tracking.pair_system(made.a, made.b, Pose.identity(), made.pose_b, *places(made, q))
    inverse = np.linalg.inv(np.linalg.cholesky(made.levels.metric))
    slope = inverse @ system.g
    least = float(np.linalg.eigvalsh(inverse @ system.H @ inverse.T)[0])
    return 0.5 * float(slope @ slope), 0.5 * float(system.dR @ system.dR), least


def lyapunov() -> Artwork:
    """Level sets and what the law does within them."""
    return Artwork(
        caption=(
            "The curved face of a cap in its parameters (u, v), and a point above it. V = "
            "Ψᵀ D*⁻¹ Ψ / 2 falls along the law as dV/dt = −2KV, E = |ΔR|²/2 as dE/dt = "
            "−K gᵀH⁻¹g while H is positive definite, within the vermilion line. Thick: the largest "
            "level set of each that lies there, with its level; thin grey lines: the law's own "
            "trajectories, on which Ψ keeps its direction. Below: both functions in time."
        ),
        text=(
            "A roundish region of parameters with a dot at the minimum. Around it two closed "
            "curves, the larger one of E, each touching the vermilion line det H = 0 in one point; "
            "fine lines run from that line into the dot. Below: V falls on one straight line for "
            "all starts, E − E* beside it."
        ),
        draw=_draw,
        tables=_tables(),
        statements=measured_by(by(), (s for name in ("point", "faces") for s in _statements(name))),
    )


def _statements(bodies: str) -> tuple[Statement, ...]:
    first, second = runs(bodies)
    seen = watched(bodies)
    levels = case(bodies).levels
    starts = len(first.found) + len(second.found)
    found = int(first.found.sum() + second.found.sum())
    subject = "face and point" if bodies == "point" else "two faces"
    return (
        Statement(
            "Convergence",
            "-",
            f"{subject}: from {starts} starts within the levels V < {levels.level:.4g}, "
            f"E − E* < {levels.energy_level:.4g} length² the raw law found the minimum in {found}",
            found == starts,
        ),
        own_statement(
            "Convergence",
            f"{subject}: in {seen.frames} frames V or E rose in {seen.rises}, H was not positive "
            f"definite in {seen.indefinite}; dV/dt = −2KV to {seen.rate:.0e} (RK4, K h = 0.05)",
        ),
    )


def _tables() -> dict[str, dict[str, Array]]:
    tables = {}
    for name in ("point", "faces"):
        levels = case(name).levels
        columns = {
            f"end_{letter}": levels.curves[:, -1, k]
            for k, letter in enumerate("uvrs"[: levels.curves.shape[2]])
        }
        columns["end_slope_length"] = levels.slopes[:, -1]
        columns["end_energy_length2"] = levels.energies[:, -1]
        columns["singular_there"] = levels.singular.astype(float)
        tables[f"curves-{name}"] = columns
    tables["levels"] = {
        "parameters": np.array([2.0, 4.0]),
        "level_v_length2": np.array([case(n).levels.level for n in ("point", "faces")]),
        "level_e_length2": np.array([case(n).levels.energy_level for n in ("point", "faces")]),
    }
    return tables


@cache
def definiteness() -> tuple[Array, Array, Array]:
    """(u, v, least eigenvalue of H) on a grid of the face's parameters."""
    made = case("point")
    ends = made.levels.curves[:, -1]
    low, high = ends.min(axis=0), ends.max(axis=0)
    u, v = (
        np.linspace(x - 0.1 * (y - x), y + 0.1 * (y - x), GRID)
        for x, y in zip(low, high, strict=True)
    )
    least = [[functions(made, np.array([x, y]))[2] for x in u] for y in v]
    return u, v, np.array(least)


def outline(values: Array, level: float) -> Array:
    """The closed curve of a level, (., 2), from the points where trajectories cross it."""
    levels = case("point").levels
    angle = np.arctan2(levels.directions[:, 1], levels.directions[:, 0])
    order = np.argsort(angle)
    order = np.append(order, order[0])
    return np.array(
        [[np.interp(level, values[k], levels.curves[k, :, j]) for j in range(2)] for k in order]
    )


def _draw() -> Figure:
    figure = style.new_figure(style.WIDTH, 8.4)
    sets, times = figure.subplots(2, 1, height_ratios=(2.1, 1.0))
    _draw_sets(sets)
    figure.legend(handles=_keys(), loc="outside upper center", ncols=2)
    _draw_times(times)
    return figure


def _draw_sets(axes: Axes) -> None:
    u, v, least = definiteness()
    levels = case("point").levels
    for curve in levels.curves[:-2:4]:
        axes.plot(curve[:, 0], curve[:, 1], color=style.QUIET, linewidth=0.7)
    axes.contour(u, v, least, levels=[0.0], colors=style.RED, linewidths=2.2, linestyles="-")
    for values, level, colour, dash in (
        (0.5 * levels.slopes**2, levels.level, style.BLUE, "--"),
        (levels.energies, levels.energy_level, style.GREEN, "-."),
    ):
        axes.plot(*outline(values, level).T, color=colour, linewidth=2.6, linestyle=dash)
    axes.plot(*levels.optimum, "o", color=style.BLACK, markersize=6)
    axes.set(xlabel="u", ylabel="v", aspect="equal")


def _keys() -> list[Artist]:
    levels = case("point").levels
    return [
        key_line("det H = 0", style.RED, 2.2),
        key_line(f"V = {levels.level:.4f} length²", style.BLUE, 2.6, "--"),
        key_line(f"E − E* = {levels.energy_level:.4f} length²", style.GREEN, 2.6, "-."),
        key_line("trajectories", style.QUIET, 0.7),
    ]


def _draw_times(axes: Axes) -> None:
    seen = watched("point")
    time = WATCHED_GAIN * STEP * np.arange(WATCHED_FRAMES + 1)
    for k, (v, e) in enumerate(zip(seen.v, seen.e, strict=True)):
        if k % 3 == 0:
            axes.plot(time, e, color=style.GREEN, linestyle="-.", linewidth=1.0)
        axes.plot(
            time,
            v,
            color=style.BLUE,
            linestyle="--",
            linewidth=1.6,
            label="V / V at the start, all starts" if k == 0 else None,
        )
    axes.plot([], [], color=style.GREEN, linestyle="-.", label="E − E*, likewise")
    axes.plot(
        time[::3],
        np.exp(-2.0 * time[::3]),
        "o",
        color=style.BLACK,
        markersize=3.5,
        markerfacecolor="none",
        label="exp(−2 K t)",
    )
    axes.set(yscale="log", xlabel="K t", ylabel="parts of the start's", xlim=(0.0, time[-1]))
    axes.legend(loc="lower left")
