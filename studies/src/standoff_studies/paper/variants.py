"""The variants that the paper prints, compared with the default: saturation, switching, gain."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import standoff as so
from standoff.motion import Pose, Twist
from standoff.typing import Array
from standoff_studies.paper import style
from standoff_studies.paper.bodies import lens_of_patches
from standoff_studies.paper.figure import Artwork, Statement, measured_by, own_statement
from standoff_studies.paper.law_words import law_words

STEP = 1e-3
"""Frame time [s]: the paper's 1 kHz."""
RADIUS, HEIGHT = 1.6, 0.4
"""Of the point's circle about the lens's axis [length]."""
TURN = 2.0 * np.pi
SLOW_DOWN = 0.8
"""How much the point's speed varies, as a fraction of its mean: fast three times a turn."""
SETTLED = 0.05
"""Time [s] after the wrong start from which errors count."""
WRONG_STARTS = ((0.5, 0.2), (0.9, 0.2), (0.15, 0.8))
"""Parameters (u, v) on face 0 where the witness point starts, far from where it should be."""
LOW_GAIN = 4.0
"""Gain [1/s] at which the wrong starts still have an effect at the first switches."""
WANTED = 5e-3
"""Projection error [length] that the lower gain computed online should keep."""

BEYOND, RAISED = 60, 0.35
"""The point at rest: frames of the motion after it has passed an edge's plane, and its height above
the circle [length]."""

FULL_SPEED = 2.0
"""Mean angular velocity of the point about the axis [rad/s]."""

LENS, POINT = lens_of_patches(), so.shapes.point()
REST, STILL = np.eye(4), Twist(np.zeros(3), np.zeros(3))
POINT_PLACE = (("vertex", 0), ())

VARIANTS: dict[str, dict[str, Any]] = {
    "default: hold the edge, multipliers": {},
    "printed: zero components, Voronoi tests": {"switching": "voronoi"},
    "hold the edge, Voronoi tests": {"switching": "voronoi", "saturation": "hold"},
    "errors integrated (Fig. 3)": {"realisation": "integrated"},
    "raw solve, no rank rule": {"solve": "plain"},
    "no feedforward, K = 1/h": {"feedforward": False},
    "no feedforward, K = 100/s": {"feedforward": False, "gain": 100.0},
    "no feedforward, lower gain online": {
        "feedforward": False,
        "feedback": so.feedback.MotionGain(WANTED, least=1.0),
    },
}
"""For each name, the options of the paper's law in which it differs from the default."""


TOLD = "from wrong starts on a face"
"""What the record of the trackers does not contain."""


class Run(NamedTuple):
    """One run, frame by frame; frame 0 is the start.

    Attributes
    ----------
    time : ndarray [s]
    error : ndarray
        Error of the witness point on the lens [length].
    feature : list of so.Feature
    switches : list of (time [s], str)
        The feature entered.
    saturations, evaluations : int
    gain : ndarray
        The gain that the law used [1/s]; 0 at the start.
    tracker : so.Tracker
    """

    time: Array
    error: Array
    feature: list[so.Feature]
    switches: list[tuple[float, str]]
    saturations: int
    evaluations: int
    gain: Array
    tracker: so.Tracker


@cache
def motion(t: float) -> tuple[Pose, Twist]:
    """The point's pose and twist: once around the lens, three times fast and slow."""
    angle = FULL_SPEED * t - SLOW_DOWN / 3.0 * np.sin(3.0 * FULL_SPEED * t)
    speed = FULL_SPEED * (1.0 - SLOW_DOWN * np.cos(3.0 * FULL_SPEED * t))
    x = np.array([RADIUS * np.cos(angle), RADIUS * np.sin(angle), HEIGHT])
    return Pose(np.eye(3), x), Twist(speed * np.array([-x[1], x[0], 0.0]), np.zeros(3))


@cache
def truth() -> tuple[so.Proximity, ...]:
    """Cold certified answers at every frame."""
    frames = range(round(TURN / FULL_SPEED / STEP) + 1)
    return tuple(so.distance(LENS, POINT, REST, motion(k * STEP)[0]) for k in frames)


@cache
def run(name: str, start: tuple[float, float] = WRONG_STARTS[0], gain: float | None = None) -> Run:
    """Once around the lens, from a wrong start, with one of the `VARIANTS`."""
    options = {**VARIANTS[name], **({"gain": gain} if gain else {})}
    tracker = so.Tracker(LENS, POINT, dt=STEP, law=so.PaperLaw(**options))
    pose, twist = motion(0.0)
    state = tracker.start_from(
        REST, pose, (("face", 0), start), POINT_PLACE, STILL, twist, settle=False
    )
    answers, gains, switches = [state.proximity], [state.gain], []
    for k in range(1, len(truth())):
        pose, twist = motion(k * STEP)
        state, answer = tracker.step(state, REST, pose, STILL, twist)
        answers.append(answer)
        gains.append(state.gain)
        switches += [(event.time, str(event.target)) for event in answer.events]
    exact = np.array([x.point_a for x in truth()])
    return Run(
        np.asarray(STEP * np.arange(len(answers))),
        np.asarray(np.linalg.norm(np.array([x.point_a for x in answers]) - exact, axis=1)),
        [x.feature_a for x in answers],
        switches,
        sum(x.counts.saturations for x in answers),
        sum(x.counts.evaluations for x in answers),
        np.array(gains),
        tracker,
    )


class AtRest(NamedTuple):
    """Distances after a long time to a point at rest beyond an edge, and the true one [length]."""

    saturated: float
    printed: float
    default: float
    exact: float


@cache
def edge_at_rest() -> AtRest:
    """A point at rest beyond an edge, off its middle: kept on the face, or let onto the edge."""
    on_edge = next(k for k, x in enumerate(truth()) if x.feature_a.kind == "edge")
    beyond = motion((on_edge + BEYOND) * STEP)[0].translation + np.array([0.0, 0.0, RAISED])
    pose = Pose(np.eye(3), beyond)

    def last(**options: Any) -> float:
        tracker = so.Tracker(LENS, POINT, dt=STEP, law=so.PaperLaw(gain=500.0, **options))
        state = tracker.start_from(
            REST, pose, (("face", 0), (0.97, 0.6)), POINT_PLACE, settle=False
        )
        for _ in range(500):
            state, answer = tracker.step(state, REST, pose, STILL, STILL)
        return answer.distance

    exact = so.distance(LENS, POINT, REST, pose).distance
    return AtRest(last(switching="none"), last(switching="voronoi"), last(), exact)


def wrong_frames(one: Run) -> int:
    """Number of frames after the start whose feature is not the true one."""
    first = round(SETTLED / STEP)
    pairs = zip(one.feature[first:], truth()[first:], strict=True)
    return sum(found != exact.feature_a for found, exact in pairs)


class Spread(NamedTuple):
    """How the switches depend on the start, at a low gain.

    Attributes
    ----------
    same : bool
        Every start has the same switches in the same order.
    entries : list of float
        For each feature that all runs enter: by how much its first entry varies [s], in frames.
    """

    same: bool
    entries: list[float]


def spread(switching: str) -> Spread:
    """How the switches depend on the start, at a low gain."""
    name = {
        "voronoi": "printed: zero components, Voronoi tests",
        "multipliers": "default: hold the edge, multipliers",
    }[switching]
    runs = [run(name, start, LOW_GAIN).switches for start in WRONG_STARTS]
    orders = {tuple(target for _, target in switches) for switches in runs}
    firsts = [_first_entries(switches) for switches in runs]
    common = set.intersection(*(set(entries) for entries in firsts))
    moved = [max(e[key] for e in firsts) - min(e[key] for e in firsts) for key in sorted(common)]
    return Spread(len(orders) == 1, moved)


def _first_entries(switches: list[tuple[float, str]]) -> dict[str, float]:
    """When each feature was entered for the first time [s]."""
    entries: dict[str, float] = {}
    for time, target in switches:
        entries.setdefault(target, time)
    return entries


def variants() -> Artwork:
    """The picture, table and statements of the printed variants."""
    return Artwork(
        caption=(
            f"A point goes once around the lens of patches, three times fast and slow, tracked at "
            f"{1.0 / STEP:.0f} Hz by the paper's law (Heun) from a wrong start. Above: error of "
            "the witness point with the default and with the printed saturation and switching, "
            "which begin alike and part at the edges (grey: the closest point is on an edge). "
            "Middle: error without feedforward, with a fixed gain and with the lower gain computed "
            f"online so that it stays below {WANTED:g}. Below: that gain."
        ),
        text=(
            "Three diagrams over time. The errors of the default and of the printed variants lie "
            "on each other but for the stretches on edges. Without feedforward the online gain "
            "holds the error below the wanted line, a fixed gain does not."
        ),
        draw=draw,
        tables={"variants": variant_table(), "runs": run_table()},
        statements=measured_by(by(), statements()),
        shown=("variants",),
    )


def by() -> str:
    """Return the law with which the statements were measured: that of each variant."""
    return law_words(*(run(name).tracker for name in VARIANTS), told=TOLD)


def variant_table() -> dict[str, list[str]]:
    """Each variant: errors [length] after the start, frames on another feature, counts."""
    runs = {name: run(name) for name in VARIANTS}
    first = round(SETTLED / STEP)
    return {
        "variant": list(runs),
        "greatest error": [f"{one.error[first:].max():.1e}" for one in runs.values()],
        "median error": [f"{np.median(one.error[first:]):.1e}" for one in runs.values()],
        "frames on another feature": [str(wrong_frames(one)) for one in runs.values()],
        "switches": [str(len(one.switches)) for one in runs.values()],
        "components zeroed": [str(one.saturations) for one in runs.values()],
        "evaluations a frame": [f"{one.evaluations / len(one.time):.2f}" for one in runs.values()],
    }


def run_table() -> dict[str, Any]:
    """Errors [length] by frame."""
    table: dict[str, Any] = {"time_s": run(next(iter(VARIANTS))).time}
    for k, name in enumerate(VARIANTS):
        table[f"error_{k}_length"] = run(name).error
    table["online_gain_per_s"] = run("no feedforward, lower gain online").gain
    return table


def statements() -> tuple[Statement, ...]:
    """What the printed variants should do, and what they did."""
    first = round(SETTLED / STEP)
    default, printed = (run(name) for name in list(VARIANTS)[:2])
    rest = edge_at_rest()
    online = run("no feedforward, lower gain online")
    fixed = run("no feedforward, K = 100/s")
    by_voronoi, by_multipliers = spread("voronoi"), spread("multipliers")
    return (
        Statement(
            "Saturation",
            "components of the solved rates that lead out of the patch are set to zero",
            f"kept on its patch by that alone, it rests at the distance {rest.saturated:.6f}, "
            f"where the edge has {rest.exact:.6f}. With the printed Voronoi tests, which let it "
            f"onto the edge, it reaches that to {abs(rest.printed - rest.exact):.0e}, as the "
            f"default does ({abs(rest.default - rest.exact):.0e})",
            None,
            "H couples both parameters: the rate that is kept was solved for together with the one "
            "that is dropped. The default solves again on the edge",
        ),
        Statement(
            "Switching",
            "for a body and a point the switching times do not depend on the continuous state",
            f"Voronoi tests on the opposing point: from {len(WRONG_STARTS)} wrong starts "
            f"{'the same' if by_voronoi.same else 'other'} switches, in frames "
            f"{max(by_voronoi.entries) / STEP:.0f} apart (located: Fig. 17); multipliers at the "
            f"witness point: up to {max(by_multipliers.entries) / STEP:.0f} frames of 1 ms apart "
            f"(K = {LOW_GAIN:g}/s)",
            by_voronoi.same and max(by_voronoi.entries) == 0.0,
            "multipliers are tested at the witness point, which must first have come near",
        ),
        own_statement(
            "Switching",
            f"with both, once converged, frames on another feature than the true one: default "
            f"{wrong_frames(default)}, printed {wrong_frames(printed)} of "
            f"{len(default.time) - first}",
        ),
        Statement(
            "Lower gain",
            "the lower bound of the gain follows from the motion and the wanted error",
            f"computed online for a projection error of {WANTED:g}: greatest witness error "
            f"{online.error[first:].max():.1e}; with K = 100/s {fixed.error[first:].max():.1e}; "
            f"gains of {online.gain[1:].min():.0f} to {online.gain.max():.0f} 1/s",
            bool(online.error[first:].max() <= WANTED),
            "the witness error is the projection error over 1 + distance times curvature; with "
            "feedforward no gain is needed for it",
        ),
    )


def draw() -> Figure:
    """Three diagrams over time."""
    figure = style.new_figure(height=9.0)
    above, middle, below = figure.subplots(3, 1, sharex=True, height_ratios=(3, 3, 2))
    names = list(VARIANTS)
    for axes in (above, middle, below):
        _shade_edges(axes)
    for k, name in enumerate(names[:2]):
        _line(above, name, k, lambda one: np.maximum(one.error, 1e-16))
    above.set_ylabel("error of the witness\npoint [length]")
    for k, name in enumerate(names[6:], start=2):
        _line(middle, name, k, lambda one: np.maximum(one.error, 1e-16))
    middle.axhline(WANTED, color=style.BLACK, linewidth=1.0, label="wanted error")
    middle.set_ylabel("error of the witness\npoint [length]")
    below.plot(run(names[7]).time[1:], run(names[7]).gain[1:], color=style.COLOURS[3])
    below.set_ylabel("online gain K [1/s]")
    below.set_xlabel("time [s]")
    for axes in (above, middle):
        axes.set_yscale("log")
        axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), frameon=False)
    above.set_ylim(1e-9, 2.0)
    middle.set_ylim(1e-6, 2.0)
    return figure


def _line(axes: Axes, name: str, k: int, values: Callable[[Run], Array]) -> None:
    one = run(name)
    axes.plot(one.time, values(one), **style.line(k), label=name)


def _shade_edges(axes: Axes) -> None:
    """Shade the times when the closest point is on an edge."""
    on_edge = np.array([x.feature_a.kind == "edge" for x in truth()], dtype=float)
    changes = np.flatnonzero(np.diff(on_edge, prepend=0.0, append=0.0))
    for low, high in changes.reshape(-1, 2):
        axes.axvspan(low * STEP, high * STEP, color="#E8E8E8", linewidth=0.0, zorder=0)
