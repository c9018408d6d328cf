"""Figure "lower": the lower limit of K with a start error, and which starts settle at a gain."""

from __future__ import annotations

import math
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import scipy
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import standoff as so
from standoff.bodies import Body
from standoff.control import growth_factor, lyapunov_level, step_growth
from standoff.errors import StandoffError
from standoff.geometry import ConicArc
from standoff.motion import ConstantTwist, Pose, Twist
from standoff.typing import Array
from standoff_studies.paper import style
from standoff_studies.paper.control.gains import draw_parts
from standoff_studies.paper.control.lag import DT, Case, random_case
from standoff_studies.paper.figure import Artwork, Statement, measured_by
from standoff_studies.paper.law_words import law_words

LEVEL = 1e-3
"""Part of the start error that is to be left."""
GAINS = (0.5, 1.0, 5.0, 20.0, 100.0, 400.0, 1000.0, 1500.0, 1800.0, 1900.0, 1950.0, 1990.0, 1999.0)
"""Gains of the runs [1/s]: from the paper's lower end to just below the limit."""
SLACK = 1.2
"""A run has failed after this multiple of the steps that are predicted."""
NEAR, FAR = 1e-3, 0.4
"""Starts: angles from the closest point [rad]."""
INTEGRATORS = {"heun": "Heun", "euler": "Euler"}
TRIED = (1500.0, 1600.0, 1700.0, 1800.0, 1900.0, 1960.0, 1990.0, 1999.0)
"""Gains at which the starts that settle are sought [1/s]. At lower ones a few starts just beyond
the limit come back from elsewhere."""
BESIDE = 0.97, 1.03
"""Parts of the predicted limit from which runs start."""
AT_ANGLE = 1.5
"""Where the point stands beside the circle [rad]: far from the ends of its arcs."""
APART = 2.0
"""Distance of the point from the circle's centre [length]."""

KINDS = ("ellipsoid - point", "ellipsoid - ellipsoid", "sphere - ellipsoid")
"""Pairs of which the start error is put on a face."""
OFFSET = 2e-3
"""Start error [parameter]."""
SLOW = 0.03
"""Part of the random velocities with which the bodies move."""
SECOND_ORDER = 0.005
"""What `so.min_gain` leaves out, in parts of its promise: the start error over the least radius of
curvature is up to this, and the promise is of first order in it."""
FRAMES = 20
"""Steps within which the error must be below `PART` of the start's."""
PART = 0.05


@cache
def circle() -> Body:
    """A planar circle, of two arcs, of radius 1 [length]."""
    arcs = [ConicArc((0, 0), (1, 0), (0, 1), k * np.pi, (k + 1) * np.pi) for k in range(2)]
    return so.shapes.planar_loop(arcs)


def beside() -> Pose:
    """Where the point is."""
    x, y = APART * math.cos(AT_ANGLE), APART * math.sin(AT_ANGLE)
    return Pose(np.eye(3), (x, y, 0.0))


@cache
def tracker(integrator: str, gain: float) -> so.Tracker:
    """The raw law on the circle and a point."""
    law = so.PaperLaw(integrator=integrator, gain=gain, solve="plain", switching="none")
    return so.Tracker(circle(), so.shapes.point(), DT, law=law)


def errors(integrator: str, gain: float, start: float, steps: int) -> Array:
    """Angles from the closest point, from a start, by step [rad]."""
    law, home = tracker(integrator, gain), np.eye(4)
    place = ("edge", 0), (AT_ANGLE + start,)
    state = law.start_from(home, beside(), place, (("vertex", 0), ()), *[Twist.zero()] * 2)
    still = np.zeros((steps, 6))
    _, answers = law.run(state, home, np.tile(beside().matrix, (steps, 1, 1)), still, still)
    points = np.asarray(answers.point_a)
    return np.asarray(np.abs(np.arctan2(points[:, 1], points[:, 0]) - AT_ANGLE))


def predicted(integrator: str, gain: float) -> int:
    """Steps until `LEVEL` of an error is left, in linear theory."""
    left = abs(float(growth_factor(integrator, -gain * DT)))
    return max(1, math.ceil(math.log(LEVEL) / math.log(left))) if left > 0.0 else 1


@cache
def steps_needed(integrator: str, gain: float, start: float) -> float:
    """Steps until `LEVEL` of the start is left, measured; nan if it is not."""
    seen = errors(integrator, gain, start, int(SLACK * predicted(integrator, gain)) + 5)
    below = np.flatnonzero(seen <= LEVEL * start)
    return float(below[0] + 1) if len(below) else math.nan


def cycle(gain: float) -> float:
    """The angle at which Euler's step turns the error just round: tan x / x = 2 / (K h)."""
    return float(scipy.optimize.brentq(lambda x: math.tan(x) - 2.0 * x / (gain * DT), 1e-6, 1.57))


class Settles(NamedTuple):
    """From which starts the law settles on the circle, as angles [rad].

    Attributes
    ----------
    told : float
        By `step_growth`, before a run.
    inside, outside : bool
        Do runs settle from `BESIDE` of `cycle`?
    """

    told: float
    inside: bool
    outside: bool


@cache
def levels() -> Any:
    """The levels of the circle and the point."""
    return lyapunov_level(circle(), so.shapes.point(), Pose.identity(), beside())


@cache
def settles(integrator: str, gain: float) -> Settles:
    """What is said before, and what runs do on either side of the cycle."""
    found = step_growth(tracker(integrator, gain), Pose.identity(), beside(), levels())
    # until the second order decides: the error's distance from the cycle grows by its square
    steps = 12 * predicted(integrator, gain) + 50
    ends = [errors(integrator, gain, part * cycle(gain), steps)[-1] for part in BESIDE]
    inside, outside = (bool(end < LEVEL * cycle(gain)) for end in ends)
    return Settles(2.0 * math.asin(0.5 * found.start_error), inside, outside)


class Promise(NamedTuple):
    """A pair in motion with a start error, at the gain of `so.min_gain`.

    Attributes
    ----------
    kind : str
    gain : float
        nan where none is stable [1/s].
    part : float
        Greatest error from the time on, over the one that is wanted.
    tracker : so.Tracker or None
    """

    kind: str
    gain: float
    part: float
    tracker: so.Tracker | None


def promise(case: Case) -> Promise:
    """Start off the closest points, without feedforward, at the gain for the time."""
    path = ConstantTwist(case.pose_b, case.twist_b)
    times = DT * np.arange(2 * FRAMES + 1)
    poses = [path.pose(t) for t in times]
    truth = [so.distance(case.a, case.b, Pose.identity(), pose) for pose in poses]
    places = [moved(truth[0].place_a), moved(truth[0].place_b)]
    off = so.Tracker(case.a, case.b, DT, law=so.PaperLaw()).start_from(
        Pose.identity(), poses[0], *places
    )
    far = greatest(case, [off.proximity], truth[:1])
    among = min(x.distance for x in truth), max(x.distance for x in truth)
    v, omega = (float(np.linalg.norm(x)) for x in (case.twist_b.v, case.twist_b.omega))
    start = far, FRAMES * DT
    try:
        gain = so.min_gain(case.a, case.b, PART * far, v, omega, distance=among, start=start)
    except StandoffError:
        return Promise(case.kind, math.nan, math.nan, None)
    law = so.Tracker(case.a, case.b, DT, law=so.PaperLaw(gain=gain, feedforward=False))
    twists = Twist.zero(), case.twist_b
    on_a, on_b = places
    state = law.start_from(Pose.identity(), poses[0], on_a, on_b, *twists)
    answers = []
    for pose in poses[1:]:
        state, answer = law.step(state, Pose.identity(), pose, *twists)
        answers.append(answer)
    late = greatest(case, answers[FRAMES - 1 :], truth[FRAMES:])
    return Promise(case.kind, gain, late / (PART * far), law)


def moved(place: Any) -> Any:
    """A place a little nearer to the middle of its chart."""
    feature, (*q, chart) = place if len(place[1]) == 3 else (place[0], (*place[1], None))
    if feature.kind != "face" or chart is None:
        return place
    return feature, (*(x - math.copysign(OFFSET, x) for x in q), chart)


def greatest(case: Case, found: list[Any], truth: list[Any]) -> float:
    """The greatest distance of a core's witness point from its true place."""
    worst = 0.0
    for x, y in zip(found, truth, strict=True):
        n = x.normal - y.normal
        worst = max(
            worst,
            float(np.linalg.norm(x.point_a - y.point_a - case.a.radius * n)),
            float(np.linalg.norm(x.point_b - y.point_b + case.b.radius * n)),
        )
    return worst


@cache
def promises(count: int = 60, seed: int = 7) -> tuple[Promise, ...]:
    """Random pairs, each kind in turn."""
    random = np.random.default_rng(seed)
    return tuple(promise(slowly(random_case(KINDS[k % 3], random))) for k in range(count))


def slowly(case: Case) -> Case:
    """A case at a part of its speed."""
    return case._replace(twist_b=Twist(SLOW * case.twist_b.v, SLOW * case.twist_b.omega))


class Online(NamedTuple):
    """A gain from the motion, without feedforward, with a start error.

    Attributes
    ----------
    error : float
        Projection error from the time on, in parts of the one that is wanted.
    cut : int
        Stages whose gain was cut.
    before : str
        What `so.min_gain` said before.
    tracker : so.Tracker
    """

    error: float
    cut: int
    before: str
    tracker: so.Tracker


@cache
def online(wanted: float) -> Online:
    """A point that passes an ellipsoid: half of the error for the motion, half for the start."""
    body, point, home = so.shapes.ellipsoid(1.0, 0.7, 0.5), so.shapes.point(), Pose.identity()
    path = ConstantTwist(Pose(np.eye(3), (-0.2, 0.05, 0.9)), Twist([1.0, 0.0, 0.0], np.zeros(3)))
    twists = Twist.zero(), path.twist(0.0)
    first = so.distance(body, point, home, path.pose(0.0))
    places = moved(first.place_a), first.place_b
    far = so.Tracker(body, point, law=so.PaperLaw()).start_from(home, path.pose(0.0), *places)
    start = max(far.proximity.residual, wanted), FRAMES * DT
    half = 0.5 * wanted
    try:
        so.min_gain(body, point, half, 1.0, distance=0.3)
        before = ""
    except StandoffError as error:
        before = str(error)
    least = so.min_gain(body, point, half, 0.0, distance=0.3, start=start)
    gain = so.feedback.MotionGain(half, least=least, most=1.0 / DT)
    law = so.Tracker(body, point, DT, law=so.PaperLaw(feedback=gain, feedforward=False))
    on_a, on_b = places
    state, seen, cut = law.start_from(home, path.pose(0.0), on_a, on_b, *twists), [], 0
    for k in range(1, 10 * FRAMES + 1):
        state, answer = law.step(state, home, path.pose(k * DT), *twists)
        seen.append(answer.residual)
        cut += answer.counts.saturations
    return Online(max(seen[FRAMES - 1 :]) / wanted, cut, before, law)


KEPT, OUTRUN = 2e-3, 1e-4
"""Projection errors wanted of `online` [length]: one that can be kept, and one that cannot."""


def lower_limit() -> Artwork:
    """The lower limit of K: start error, time, motion; and what a gain near the upper one does."""
    return Artwork(
        caption=(
            f"Above: time until {LEVEL:g} of a start error is left, against K, at 1 kHz. Lines: "
            "from the growth factor R(−K h); marks: runs on a circle and a point, from a small and "
            "from a large error; at the upper edge those that never arrive. Middle: from which "
            "errors runs settle, as an angle on the circle. Line: where a step of Euler's method "
            "turns the error just round, tan x / x = 2/(K h); marks: what control.step_growth says "
            "before a run; triangles: runs from 0.97 of the line, which settle, and from 1.03, "
            "which never do. Below: error at the stated time and after, in parts of what "
            "so.min_gain promises, random pairs in motion without feedforward; a bar stands at the "
            "greatest."
        ),
        text=(
            "Above, two lines that fall straight with K, have a dip at 1000 1/s and rise to the "
            "limit of 2000; all marks of small errors lie on them, those of large ones too up to "
            "1800 1/s. Middle, a curve that falls from 0.84 rad at 1500 1/s to zero at 2000, marks "
            "just below it. Below, three rows of dots, none beyond the line at 1."
        ),
        draw=_draw,
        tables=_tables(),
        statements=measured_by(by(), _statements()),
    )


def by() -> str:
    """Return the laws with which the statements were measured."""
    ran = [tracker(name, gain) for name in INTEGRATORS for gain in GAINS]
    moving = [one.tracker for one in promises() if one.tracker]
    return (
        f"circle and point at rest, {law_words(*ran)}; in motion, from wrong starts, "
        f"{law_words(*moving)}; online, {law_words(*(online(x).tracker for x in (KEPT, OUTRUN)))}"
    )


def worst_steps() -> float:
    """Greatest difference of measured from predicted steps, from small errors, in steps."""
    pairs = [(name, gain) for name in INTEGRATORS for gain in GAINS]
    return max(abs(steps_needed(*pair, NEAR) - predicted(*pair)) for pair in pairs)


def _statements() -> tuple[Statement, ...]:
    kept = np.array([one.part for one in promises() if one.tracker])
    outrun = sum(one.tracker is None for one in promises())
    tried = [settles(name, gain) for name in INTEGRATORS for gain in TRIED]
    right = sum(one.inside and not one.outside for one in tried)
    beyond = sum(one.told > cycle(gain) for one, gain in zip(tried, 2 * TRIED, strict=True))
    good, bad = online(KEPT), online(OUTRUN)
    late = [k for k in GAINS if math.isnan(steps_needed("heun", k, FAR))]
    return (
        Statement(
            "Section V",
            "a lower limit of K follows from shape, motion and the initialization error",
            f"so.min_gain's promise, {PART:g} of the start error after {FRAMES} ms, broken by more "
            f"than {SECOND_ORDER:g} in {int((kept > 1.0 + SECOND_ORDER).sum())} of {len(kept)} "
            f"cases; the worst comes to {kept.max():.1%} of it. In {outrun} more the motion "
            "outruns every stable gain, which is said before the run with the step that would do",
            bool((kept <= 1.0 + SECOND_ORDER).all()),
        ),
        Statement(
            "Section V",
            "the lower limit can be computed online",
            "MotionGain, half of the error for the motion and half for the start: "
            f"{good.error:.0%} of {KEPT:g} length from {FRAMES} ms on, gains cut in {good.cut} "
            f"stages. {OUTRUN:g} cannot be kept ({bad.error:.1f} times that): so.min_gain says so "
            f"before the run, and {bad.cut} cut stages are counted",
            good.error <= 1.0 and not good.cut + len(good.before) and bad.cut * len(bad.before) > 0,
        ),
        Statement(
            "Fig. 7",
            "the convergence rate is adjusted by K; stable from 0.5 to 1500 1/s",
            f"steps until {LEVEL:g} of a small error is left, K = {GAINS[0]:g} to {GAINS[-1]:g}: "
            f"as predicted to {worst_steps():.0f} step, Heun and Euler",
            worst_steps() <= 1.0,
        ),
        Statement(
            "Section VI",
            "K may be increased as long as the poles remain inside the unit circle",
            f"from small errors. From {FAR:g} rad on the circle K = {late[0]:g} to {late[-1]:g} "
            "1/s never settle, though |R(−K h)| < 1",
            None,
            "M changes along a step; so.Tracker warns of such gains",
        ),
        Statement(
            "Gains",
            "-",
            "starts of Euler's and of Heun's method settle up to tan x / x = 2/(K h), by theory: "
            f"so it is on both sides in {right} of {len(tried)} cases. step_growth, before a run, "
            f"exceeds it in {beyond}",
            right == len(tried) and beyond == 0,
            "Heun's leaves a point where it is just where Euler's turns it to and fro",
        ),
    )


def _tables() -> dict[str, dict[str, Array | list[str]]]:
    pairs = [(name, gain) for name in INTEGRATORS for gain in GAINS]
    tried = [(name, gain) for name in INTEGRATORS for gain in TRIED]
    return {
        "time-to-level": {
            "integrator": [name for name, _ in pairs],
            "gain_per_s": np.array([gain for _, gain in pairs]),
            "predicted_steps": np.array([predicted(*pair) for pair in pairs]),
            "small_error_steps": np.array([steps_needed(*pair, NEAR) for pair in pairs]),
            "large_error_steps": np.array([steps_needed(*pair, FAR) for pair in pairs]),
        },
        "starts-that-settle": {
            "integrator": [name for name, _ in tried],
            "gain_per_s": np.array([gain for _, gain in tried]),
            "predicted_rad": np.array([cycle(gain) for _, gain in tried]),
            "step_growth_rad": np.array([settles(*pair).told for pair in tried]),
        },
        "promises": {
            "pair": [one.kind for one in promises()],
            "gain_per_s": np.array([one.gain for one in promises()]),
            "part_of_promise": np.array([one.part for one in promises()]),
        },
    }


def _draw() -> Figure:
    figure = style.new_figure(style.WIDTH, 9.6)
    above, middle, below = figure.subplots(3, 1, height_ratios=(1.3, 1.1, 0.7))
    _draw_times(above)
    _draw_starts(middle)
    _draw_promises(below)
    return figure


def _draw_times(axes: Axes) -> None:
    fine = np.concatenate([np.geomspace(0.4, 900.0, 120), np.linspace(900.0, 1999.5, 400)])
    for k, (name, words) in enumerate(INTEGRATORS.items()):
        left = np.maximum(np.abs(growth_factor(name, -DT * fine)), 1e-12)
        time = DT * np.maximum(np.log(LEVEL) / np.log(left), 1.0)
        axes.plot(fine, time, **style.line(k), label=f"predicted, {words}")
        for start, mark in ((NEAR, "o"), (FAR, "x")):
            steps = np.array([steps_needed(name, gain, start) for gain in GAINS])
            size: dict[str, Any] = {"markersize": 8.5 - 3.5 * k, "markerfacecolor": "none"}
            colour = style.COLOURS[k]
            label = f"from {start:g} rad, {words}"
            axes.plot(GAINS, DT * steps, mark, color=colour, label=label, **size)
            never = np.array(GAINS)[np.isnan(steps)]
            axes.plot(never, np.full(len(never), 45.0), mark, color=colour, **size)
    axes.annotate("never", (1890.0, 45.0), (700.0, 40.0), va="center", ha="right")
    axes.set(
        xscale="log",
        yscale="log",
        xlabel="K [1/s]",
        ylabel=f"time to {LEVEL:g} of the start [s]",
        ylim=(7e-4, 80.0),
    )
    axes.legend(loc="lower left")


def _draw_starts(axes: Axes) -> None:
    gains = np.append(np.linspace(1450.0, 1999.0, 200), 1999.9)
    limits = [cycle(gain) for gain in gains]
    axes.plot(gains, limits, **style.line(2), label="tan x / x = 2/(K h)")
    for k, (name, words) in enumerate(INTEGRATORS.items()):
        told = [settles(name, gain).told for gain in TRIED]
        look: dict[str, Any] = {
            "color": style.COLOURS[k],
            "markersize": 8.5 - 3.5 * k,
            "markerfacecolor": "none",
        }
        axes.plot(TRIED, told, "o", label=f"step_growth, {words}", **look)
    for part, mark, words in zip(BESIDE, "^v", ("settles", "never settles"), strict=True):
        ends = [part * cycle(gain) for gain in TRIED]
        axes.plot(TRIED, ends, mark, color=style.BLACK, markersize=4.0, label=words)
    axes.set(xlabel="K [1/s]", ylabel="start error [rad]", xlim=(1450.0, 2010.0), ylim=(0.0, 1.0))
    axes.legend(loc="upper right")


def _draw_promises(axes: Axes) -> None:
    parts = {kind: [x.part for x in promises() if x.kind == kind and x.tracker] for kind in KINDS}
    draw_parts(axes, parts, "measured error / error promised by so.min_gain")
