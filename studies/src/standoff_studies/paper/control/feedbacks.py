"""Figure "feedback": four feedbacks on one run, with a wrong start and then with wrong twists."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import standoff as so
from standoff.bodies import Body
from standoff.motion import ConstantTwist, Pose, Twist
from standoff.tracking import feedback
from standoff.typing import Array
from standoff_studies.paper import style
from standoff_studies.paper.figure import Artwork, Statement, measured_by, own_statement
from standoff_studies.paper.law_words import law_words

STEP = 1e-3
"""Frame time [s]."""
FRAMES = 300
"""Frames of the run."""
WRONG_FROM = 120
"""Frame from which the twists given to the law are wrong."""
LAST = 60
"""Frames at the end over which the steady error is taken."""
CHATTER = slice(20, 100)
"""Frames in which chatter is counted: the twists are right there."""
GAIN = 200.0
"""K of the linear law [1/s]."""
FALLEN = 1e-3
"""Fraction of the first error below which it counts as gone."""
BIAS = np.array([0.08, -0.05, 0.06])
"""Velocity added to B's true one, as by a sensor with a bias [length/s]."""
DRIFT = (np.array([0.05, 0.03, 0.04]), np.array([0.02, 0.03, -0.02]))
"""B's true twist, in world axes: velocity [length/s] and angular velocity [rad/s]."""
POSE_B = ([2.9, 0.3, 0.2], [0.45, 0.3, 1.9])
"""Where B starts: rotation vector [rad] and position [length]."""
OFFSET = np.array([0.25, -0.2, 0.15, 0.2])
"""Error of the parameters at the start."""

LAWS: dict[str, feedback.Feedback] = {
    "linear": feedback.Linear(GAIN),
    "gain matrix": feedback.GainMatrix([GAIN, GAIN, 2.0 * GAIN, 2.0 * GAIN]),
    "PI": feedback.PI(GAIN, 0.25 * GAIN**2),
    "finite-time": feedback.FiniteTime(GAIN, 0.5, 0.1),
    "finite-time, capped late": feedback.FiniteTime(GAIN, 0.5, 0.1, most=1.98 / STEP),
}
"""The sign-power law twice: with its greatest gain at 1/h, and nearly at Euler's limit 2/h."""


class Run(NamedTuple):
    """The result of a feedback.

    Attributes
    ----------
    error : (FRAMES + 1,) array
        Length of the projection of the witness vector on the tangents [length].
    fallen : float
        Time until it is first below `FALLEN` of the start's [s].
    steady : float
        Mean over the last frames, with wrong twists [length].
    chatter : float
        Share of the frames of `CHATTER` at which Psi_u changes its sign.
    psi_u : (FRAMES + 1,) array
        The first projection error [length² per parameter].
    tracker : so.Tracker
    """

    error: Array
    fallen: float
    steady: float
    chatter: float
    psi_u: Array
    tracker: so.Tracker


@cache
def bodies() -> tuple[Body, Body]:
    """Two caps of ellipsoids, their curved faces towards each other."""
    whole = so.shapes.cap(1.0, 0.36)
    return whole.transformed(np.diag([1.0, 0.8, 0.6])), whole.transformed(np.diag([0.7, 0.9, 0.8]))


def pose(frame: int) -> Pose:
    """B's pose at a frame."""
    return ConstantTwist(Pose.exp(*POSE_B), Twist(*DRIFT)).pose(frame * STEP)


@cache
def run(name: str) -> Run:
    """Euler at 1 kHz, with the feedforward; the same start and motion for each feedback."""
    a, b = bodies()
    tracker = so.Tracker(a, b, STEP, law=so.PaperLaw(integrator="euler", feedback=LAWS[name]))
    home = Pose.identity()
    best = so.distance(a, b, home, pose(0))
    state = tracker.start_from(
        home,
        pose(0),
        (best.feature_a, np.array(best.parameters_a) + OFFSET[:2]),
        (best.feature_b, np.array(best.parameters_b) + OFFSET[2:]),
        None,
        Twist(*DRIFT),
        settle=False,
    )
    error, psi = [state.proximity.residual], [first_error(state.proximity, 0)]
    for frame in range(1, FRAMES + 1):
        told = DRIFT[0] + (BIAS if frame >= WRONG_FROM else 0.0), DRIFT[1]
        state, answer = tracker.step(state, home, pose(frame), None, Twist(*told))
        error.append(answer.residual)
        psi.append(first_error(answer, frame))
    sizes = np.array(error)
    below = np.flatnonzero(sizes[:WRONG_FROM] < FALLEN * sizes[0])
    late = sizes[-LAST:]
    return Run(
        sizes,
        STEP * float(below[0]) if len(below) else np.inf,
        float(late.mean()),
        float((np.diff(np.sign(psi[CHATTER])) != 0.0).mean()),
        np.array(psi),
        tracker,
    )


def first_error(answer: so.Proximity, frame: int) -> float:
    """Psi_u of an answer."""
    places = answer.place_a, answer.place_b
    return float(so.tracking.pair_system(*bodies(), Pose.identity(), pose(frame), *places).Psi[0])


def four_feedbacks() -> Artwork:
    """Four feedbacks compared."""
    return Artwork(
        caption=(
            "Two curved faces; Euler at 1 kHz with the feedforward, from a wrong start. From "
            f"{WRONG_FROM} ms on (grey) the law is told a velocity of B that is off by a constant "
            f"{np.linalg.norm(BIAS):.2f} length/s. Above: the projection of the witness vector on "
            f"the tangents, K = {GAIN:g} 1/s (gain matrix: twice that for B's errors; PI: K_i = "
            "K²/4; finite-time: the square root of Ψ). Below: the first error under the "
            "finite-time law with its greatest gain at 1/h, and at 1.98/h, where it chatters."
        ),
        text=(
            "Above, five falling curves on a logarithmic scale. After the twists go wrong the "
            "linear law settles near 6e-4 length, the gain matrix a little lower, the finite-time "
            "law near 1e-4, PI jumps up and falls below 1e-6. Below, a straight line at zero and a "
            "zigzag about it."
        ),
        draw=_draw,
        tables=_tables(),
        statements=measured_by(
            law_words(*(run(name).tracker for name in LAWS), told="wrong start"), _statements()
        ),
    )


def _statements() -> tuple[Statement, ...]:
    made = {name: run(name) for name in LAWS}
    reached = ", ".join(f"{name} {1e3 * made[name].fallen:.0f} ms" for name in LAWS)
    steady = ", ".join(f"{name} {made[name].steady:.1e}" for name in LAWS)
    chatter = ", ".join(f"{name} {made[name].chatter:.0%}" for name in LAWS)
    works = all(np.isfinite(one.fallen) for one in made.values())
    return (
        Statement(
            "Feedback",
            "other feedbacks can be synthesised",
            f"error below {FALLEN:g} of the start's after: {reached}",
            works,
        ),
        own_statement(
            "Feedback",
            f"steady error with wrong twists [length]: {steady}",
            "PI takes up the constant part; the others keep b/K, or the power law's root of it",
        ),
        own_statement(
            "Feedback",
            f"chatter, frames at which Ψ_u changes its sign: {chatter}",
            "a gain near 2/h turns the error round at each frame; 1/h takes it away in one",
        ),
    )


def _tables() -> dict[str, dict[str, Array | list[str]]]:
    errors: dict[str, Array | list[str]] = {"time_s": np.asarray(STEP * np.arange(FRAMES + 1))}
    for name in LAWS:
        errors[f"{name.replace(', ', '_').replace(' ', '_')}_error_length"] = run(name).error
    made = [run(name) for name in LAWS]
    return {
        "errors": errors,
        "summary": {
            "feedback": list(LAWS),
            "time_to_thousandth_s": np.array([one.fallen for one in made]),
            "steady_error_length": np.array([one.steady for one in made]),
            "sign_changes_share": np.array([one.chatter for one in made]),
        },
    }


def _draw() -> Figure:
    figure = style.new_figure(style.WIDTH, 7.0)
    above, below = figure.subplots(2, 1, height_ratios=(2.0, 1.0))
    _draw_errors(above)
    _draw_chatter(below)
    return figure


def _draw_errors(axes: Axes) -> None:
    time = 1e3 * STEP * np.arange(FRAMES + 1)
    axes.axvspan(WRONG_FROM, FRAMES, color=style.QUIET, alpha=0.15, linewidth=0)
    for k, name in enumerate(LAWS):
        look = style.marked(k, 4.5, markevery=(3 * k, 20))
        axes.plot(time, run(name).error, **look, label=name)
    axes.set(
        yscale="log",
        xlabel="time [ms]",
        ylabel="projection error [length]",
        xlim=(0.0, FRAMES),
        ylim=(1e-10, 3.0),
    )
    axes.legend(loc="lower right", ncols=2)


def _draw_chatter(axes: Axes) -> None:
    frames = np.arange(8, 41)
    for k, name in ((3, "finite-time"), (4, "finite-time, capped late")):
        errors = 1e3 * run(name).psi_u[frames]
        axes.plot(1e3 * STEP * frames, errors, **style.marked(k, 4.5), label=name)
    axes.set(xlabel="time [ms]", ylabel="$\\Psi_u$ [1e-3 length²]", ylim=(-1.6, 2.4))
    axes.legend(loc="upper right", ncols=2)
