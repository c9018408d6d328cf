"""Figure "lyapunov": decreasing functions of the parameter error, and where they are valid."""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import standoff as so
from standoff.bodies import Body
from standoff.control.basin import Basin, basin
from standoff.control.lyapunov import LyapunovLevels, lyapunov_level
from standoff.motion import Pose, Twist
from standoff.typing import Array
from standoff_studies.paper import style
from standoff_studies.paper.bodies import lens_of_patches
from standoff_studies.paper.control.parameter_errors import (
    INSTANT,
    Errors,
    Fallen,
    Ray,
    Volumes,
    fallen,
    in_ball,
    least_gains,
    volumes,
)
from standoff_studies.paper.figure import Artwork, Statement, measured_by, own_statement
from standoff_studies.paper.keys import key_fill, key_line
from standoff_studies.paper.law_words import law_words

STEP, GAIN = 1e-3, 100.0
"""Frame time [s] and gain [1/s] of the checking runs: K h = 0.1."""
FRAMES = 250
"""Frames of a run: e^-25 of an error is left."""
WATCHED, WATCHED_FRAMES, WATCHED_GAIN = 60, 40, 50.0
"""Runs whose functions are evaluated at each frame, their frames and gain [1/s]: K h = 0.05."""
CLEAR = 0.9
"""Fraction of the levels, and of a ball's radius, within which those runs start: near a singular H
a single step differs from the law in continuous time."""
ROUNDOFF = 1e-14
"""Rise of E that is roundoff [length²]: a few units in the last place of E itself, about 1."""
PART = 0.999
"""Starts are within this fraction of the level."""

SUBJECTS = {"point": "face and point", "faces": "two faces", "patch": "lens and point"}
"""The pairs: a cap and a point, two caps, a lens of patches and a point."""

CONCLUSIONS = "Section VI"

POINT_AT = (0.75, 0.45, 1.0)
"""The point above the cap [length]."""
POSE_B = ([2.9, 0.3, 0.2], [0.7, 0.4, 1.9])
"""The second cap: rotation vector [rad] and position [length]."""
LENS_AT = (-0.09, 0.23, 0.8)
"""The point above a lens of patches [length], near a side that has collapsed."""
MOVING = ([0.3, -0.5, 0.4], [0.5, 0.2, -0.7])
"""Twist of B [length/s, rad/s] for the gain that each function needs."""
HALF = 0.5
"""Fraction of a ball's radius within which that is asked."""
TRIED = 300
"""Points at which it is counted whether the functions fall, and starts drawn in a ball."""
RIM = 0.01
"""Left out of the picture of the lens's patch at its sides, two of which have collapsed."""
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
    """ "point": the cap's face and a point, 2 parameters; "faces": two caps' faces, 4; "patch": a
    face of the lens of patches and a point."""
    turn, shift = POSE_B
    a = lens_of_patches() if bodies == "patch" else cap()
    if bodies == "faces":
        b, pose = cap(), Pose.exp(turn, shift)
    else:
        b, pose = so.shapes.point(), Pose(np.eye(3), POINT_AT if bodies == "point" else LENS_AT)
    directions = 120 if bodies == "faces" else 96
    return Case(a, b, pose, lyapunov_level(a, b, Pose.identity(), pose, directions))


@cache
def errors(bodies: str) -> Errors:
    """The case's squared parameter error."""
    made = case(bodies)
    return Errors.of(made.a, made.b, made.pose_b)


@cache
def ball(bodies: str) -> Ray:
    """The radius of the largest ball in which it falls."""
    return errors(bodies).shortest()


@cache
def proven(bodies: str) -> Volumes:
    """The volumes of what each function proves."""
    return volumes(errors(bodies), case(bodies).levels, ball(bodies))


@cache
def counts(bodies: str) -> Fallen:
    """At how many points of the features each function falls."""
    return fallen(errors(bodies), case(bodies).levels, TRIED)


@cache
def from_ball(bodies: str) -> Basin:
    """The raw law from starts within the ball."""
    made = case(bodies)
    drawn = in_ball(errors(bodies), CLEAR * ball(bodies).length, TRIED)
    starts = [places(made, q) for q in drawn]
    return basin(tracker(bodies), Pose.identity(), made.pose_b, starts, FRAMES)


@cache
def gains(bodies: str) -> Array:
    """The least gain at which each function falls in half the ball while B moves [1/s]."""
    drawn = in_ball(errors(bodies), HALF * ball(bodies).length, TRIED)
    return least_gains(errors(bodies), drawn, Twist(np.array(MOVING[0]), np.array(MOVING[1])))


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
    v, e, squared : (m, WATCHED_FRAMES + 1) arrays
        V, E - E* and |q - q*|² by run and frame, relative to those at its start.
    rate : float
        Greatest deviation of -ln(V / V before) / (2 K h) from 1.
    rises : int
        Frames at which one of them rose.
    indefinite : int
        Frames at which H was not positive definite.
    frames : int
    """

    v: Array
    e: Array
    squared: Array
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
        values = [(*functions(made, q), _squared(made, q))]
        for _ in range(WATCHED_FRAMES):
            state, answer = tracker.step(state, home, made.pose_b, still, still)
            now = np.array(answer.parameters_a + answer.parameters_b)
            values.append((*functions(made, now), _squared(made, now)))
        rows.append(values)
    v, e, least, squared = np.moveaxis(np.array(rows), -1, 0)
    e = e - functions(made, made.levels.optimum)[1]
    ratios = -np.diff(np.log(v), axis=1) / (2.0 * WATCHED_GAIN * STEP)
    rises = (np.diff(v) > 0.0).sum() + (np.diff(e) > ROUNDOFF).sum()
    rises += (np.diff(squared) > 0.0).sum()
    return Watched(
        v / v[:, :1],
        e / e[:, :1],
        squared / squared[:, :1],
        float(np.abs(ratios - 1.0).max()),
        int(rises),
        int((least <= 0.0).sum()),
        v.shape[0] * WATCHED_FRAMES,
    )


def _squared(made: Case, q: Array) -> float:
    e = q - made.levels.optimum
    return float(e @ e)


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
            "Above: the curved face of a cap, and a patch of a lens, each with a point above it, "
            "in the parameters (u, v). V = Ψᵀ D*⁻¹ Ψ / 2 falls along the law as dV/dt = −2KV, "
            "E = |ΔR|²/2 as dE/dt = −K gᵀH⁻¹g while H is positive definite, within the vermilion "
            "line, and |q − q*|² as −2K eᵀH⁻¹g with e = q − q*. Thick: the largest set of each "
            "function that lies there and in which it falls. Hatched: H is definite, and "
            "|q − q*|² rises. Thin grey lines: the law's own trajectories, on which Ψ keeps its "
            "direction. Below: the functions of the cap in time."
        ),
        text=(
            "Two regions of parameters, each with a dot at the minimum. Around it three closed "
            "curves: a circle, that of V and that of E, of which V's is the smallest. They touch "
            "the line det H = 0 or the patch's side. On the lens's patch a hatched part lies "
            "within the region and outside of all three. Below: V falls on one straight line for "
            "all starts, E − E* and |q − q*|² beside it."
        ),
        draw=_draw,
        tables=_tables(),
        statements=measured_by(
            by(),
            (
                *(s for name in ("point", "faces") for s in _statements(name)),
                *_squared_errors(),
            ),
        ),
        shown=("proven",),
    )


def _statements(bodies: str) -> tuple[Statement, ...]:
    first, second = runs(bodies)
    seen = watched(bodies)
    levels = case(bodies).levels
    starts = len(first.found) + len(second.found)
    found = int(first.found.sum() + second.found.sum())
    subject = SUBJECTS[bodies]
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
            f"{subject}: in {seen.frames} frames V, E or |q − q*|² rose in {seen.rises}, "
            f"H was not positive definite in {seen.indefinite}; dV/dt = −2KV to "
            f"{seen.rate:.0e} (RK4, K h = 0.05)",
        ),
    )


def _squared_errors() -> tuple[Statement, ...]:
    """What is claimed of the squared parameter errors, and what each function does."""
    seen = {SUBJECTS[name]: counts(name) for name in SUBJECTS}
    least = {SUBJECTS[name]: gains(name) for name in SUBJECTS}
    starts = {SUBJECTS[name]: from_ball(name).found for name in SUBJECTS}

    def each(k: int, law: str) -> str:
        of = {"printed": "definite", "covariant": "spread"}[law]
        return ", ".join(f"{getattr(x, law)[k]} of {getattr(x, of)}" for x in seen.values())

    subjects = ", ".join(SUBJECTS.values())
    still = f"Euler, K = 100 1/s, over {INSTANT:g} s; {subjects}"
    return (
        Statement(
            CONCLUSIONS,
            "the squared parameter errors show convergence where M is positive definite",
            f"of points where H is definite |q − q*|² falls at {each(0, 'printed')}; "
            f"V at {each(1, 'printed')}; E − E* at {each(2, 'printed')}",
            all(x.printed[0] == x.definite for x in seen.values()),
            "eᵀH⁻¹g can be negative where H is definite: g is the mean of H along the way, times "
            "e, and two definite matrices have a product that need not be. It depends on the "
            "parameters of the patch; in a ball around the optimum the error does fall",
            f"{law_words(tracker('point'))}; {still}",
        ),
        Statement(
            CONCLUSIONS,
            "and a sufficiently large gain",
            f"within {HALF:g} of the ball's radius, while B moves at 0.7 length/s and 0.9 rad/s, "
            "|q − q*|² falls at K above "
            f"{', '.join(f'{x[0]:.2g}' for x in least.values())} 1/s, E − E* above "
            f"{', '.join(f'{x[2]:.2g}' for x in least.values())}; V, to what an instant shows, "
            f"above {', '.join(f'{x[1]:.1g}' for x in least.values())}",
            all(np.isfinite(x).all() and x[0] > 0.0 for x in least.values()),
            by=f"{law_words(tracker('point'))}; {still}",
        ),
        Statement(
            CONCLUSIONS,
            "-",
            "from starts in the ball, to "
            f"{CLEAR:g} of its radius, the raw law found the minimum in "
            f"{', '.join(f'{int(x.sum())} of {len(x)}' for x in starts.values())}",
            all(x.all() for x in starts.values()),
        ),
        Statement(
            CONCLUSIONS,
            "-",
            "by the covariant law, all over both features, E − E* falls at "
            f"{each(2, 'covariant')} points; |q − q*|² at {each(0, 'covariant')}; V at "
            f"{each(1, 'covariant')}",
            all(x.covariant[2] == x.spread for x in seen.values()),
            by=f"solve='covariant', switching='none'; {still}",
        ),
    )


def _proven() -> dict[str, list[str]]:
    """What each function proves, in parts of the region that the law's own curves cover."""
    rows = {name: proven(name) for name in SUBJECTS}
    return {
        "pair": list(SUBJECTS.values()),
        "|q − q*|²": [f"{v.ball / v.region:.2%}, {ball(n).cause}" for n, v in rows.items()],
        "V = Ψᵀ D*⁻¹ Ψ / 2": [f"{v.v / v.region:.2%}" for v in rows.values()],
        "E − E*": [f"{v.energy / v.region:.2%}" for v in rows.values()],
    }


def _tables() -> dict[str, dict[str, Any]]:
    tables: dict[str, Any] = {"proven": _proven()}
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
def fields(bodies: str) -> tuple[Array, Array, Array, Array]:
    """(u, v, least eigenvalue of H, rate of |q − q*|²) on a grid of the face's parameters."""
    made, one = case(bodies), errors(bodies)
    ends = made.levels.curves[:, -1]
    low, high = ends.min(axis=0), ends.max(axis=0)
    if bodies == "patch":
        low, high = np.full(2, RIM), np.full(2, 1.0 - RIM)
    else:
        low, high = low - 0.1 * (high - low), high + 0.1 * (high - low)
    u, v = (np.linspace(x, y, GRID) for x, y in zip(low, high, strict=True))
    least, falls, system = np.empty((GRID, GRID)), np.empty((GRID, GRID)), one.system()
    for i, j in np.ndindex(GRID, GRID):
        q = np.array([u[j], v[i]])
        g, H, _, _ = system.at(q)
        least[i, j] = functions(made, q)[2]
        falls[i, j] = (q - one.optimum) @ np.linalg.solve(H, g)
    return u, v, least, falls


def outline(bodies: str, values: Array, level: float) -> Array:
    """The closed curve of a level, (., 2), from the points where trajectories cross it."""
    levels = case(bodies).levels
    angle = np.arctan2(levels.directions[:, 1], levels.directions[:, 0])
    order = np.argsort(angle)
    order = np.append(order, order[0])
    return np.array(
        [[np.interp(level, values[k], levels.curves[k, :, j]) for j in range(2)] for k in order]
    )


def _draw() -> Figure:
    figure = style.new_figure(style.WIDTH, 7.4)
    places = figure.subplot_mosaic([["cap", "lens"], ["times", "times"]], height_ratios=(1.5, 1.0))
    for name, bodies in (("cap", "point"), ("lens", "patch")):
        _draw_sets(places[name], bodies)
        places[name].set_title(f"{name} and point")
    figure.legend(handles=_keys(), loc="outside upper center", ncols=3)
    _draw_times(places["times"])
    return figure


def _draw_sets(axes: Axes, bodies: str) -> None:
    u, v, least, falls = fields(bodies)
    levels, around = case(bodies).levels, np.linspace(0.0, 2.0 * np.pi, 181)
    for curve in levels.curves[:-2:4]:
        axes.plot(curve[:, 0], curve[:, 1], color=style.QUIET, linewidth=0.7)
    bad = ((least > 0.0) & (falls < 0.0)).astype(float)
    if bad.any():
        axes.contourf(u, v, bad, levels=[0.5, 1.5], colors=[style.ORANGE], hatches=["////"])
    axes.contour(u, v, least, levels=[0.0], colors=style.RED, linewidths=2.2, linestyles="-")
    for values, level, colour, dash in (
        (0.5 * levels.slopes**2, levels.level, style.BLUE, "--"),
        (levels.energies, levels.energy_level, style.GREEN, "-."),
    ):
        axes.plot(*outline(bodies, values, level).T, color=colour, linewidth=2.2, linestyle=dash)
    circle = ball(bodies).length * np.array([np.cos(around), np.sin(around)])
    axes.plot(*(levels.optimum[:, None] + circle), color=style.PURPLE, linewidth=2.2, linestyle=":")
    axes.plot(*levels.optimum, "o", color=style.BLACK, markersize=5)
    axes.set(xlabel="u", ylabel="v", aspect="equal", xlim=u[[0, -1]], ylim=v[[0, -1]])


def _keys() -> list[Artist]:
    return [
        key_line("det H = 0", style.RED, 2.2),
        key_line("largest set of |q − q*|²", style.PURPLE, 2.2, ":"),
        key_fill("|q − q*|² rises, H definite", style.ORANGE, hatch="////"),
        key_line("of V", style.BLUE, 2.2, "--"),
        key_line("of E − E*", style.GREEN, 2.2, "-."),
        key_line("trajectories", style.QUIET, 0.7),
    ]


def _draw_times(axes: Axes) -> None:
    seen = watched("point")
    time = WATCHED_GAIN * STEP * np.arange(WATCHED_FRAMES + 1)
    for k, (v, e, squared) in enumerate(zip(seen.v, seen.e, seen.squared, strict=True)):
        if k % 3 == 0:
            axes.plot(time, e, color=style.GREEN, linestyle="-.", linewidth=1.0)
            axes.plot(time, squared, color=style.PURPLE, linestyle=":", linewidth=1.4)
        axes.plot(
            time,
            v,
            color=style.BLUE,
            linestyle="--",
            linewidth=1.6,
            label="V / V at the start, all starts" if k == 0 else None,
        )
    axes.plot([], [], color=style.GREEN, linestyle="-.", label="E − E*, likewise")
    axes.plot([], [], color=style.PURPLE, linestyle=":", label="|q − q*|², likewise")
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
