"""Results as text for a reader at a terminal."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from standoff.bodies.plain_data import without_roundoff
from standoff.impact import Impact
from standoff.recording import RecordedEvent, Recording
from standoff.recording.local_minima import MinimumEvent
from standoff.scene import Scene
from standoff.solids.answer import SolidCounts, SolidProximity
from standoff.tracking import Counts, Proximity, Status
from standoff.tracking.branches import NONE
from standoff.tracking.feedback_facts import feedback_text
from standoff.tracking.law_options import OfFeedback, Option, options_of
from standoff.tracking.laws import LAWS, PredictorCorrector
from standoff.tracking.proximity import shown_size
from standoff.typing import Array
from standoff.wording import MOST_DIGITS, at_least, at_most, counted, printable
from standoff.world.shapes import boundary_of

FIRST_EVENTS = 8
"""How many switching events the summary lists: they fit on a screen with the rest. All of them are
in the Parquet file and in ``--json``."""

ALWAYS_TOLD = ("predictor", "integrator", "gain")
"""Options of a law that the summary shows even if they are the default."""

NOUNS = {
    "switches": ("switch", "switches"),
    "searches": ("search", "searches"),
    "boxes": ("box", "boxes"),
    "regularised": ("regularised solve", ""),
}
"""What is counted, singular and plural, where the count's name with or without its s does not say
it."""

COLD_TOLERANCE = float(PredictorCorrector().tolerance)
"""That of a cold query, in sizes of the pair: the law's default."""

MARGIN = 14
"""Width of the column of names, in characters."""


def line(name: str, text: str) -> str:
    """Return one line of the summary."""
    return f"{printable(name):<{MARGIN}}{printable(text)}"


def answer_lines(
    scene: Scene, time: float, answer: Proximity | SolidProximity, *, verbose: bool = False
) -> list[str]:
    """Return the lines for one answer."""
    unit, size = scene.length_unit, shown_size(answer, scene.pair_shapes)
    (distance,) = without_roundoff([answer.distance], size).tolist()
    on_a, on_b = vector_text(answer.point_a, size), vector_text(answer.point_b, size)
    certified = f"yes, {_tolerance_text(COLD_TOLERANCE)}" if answer.certified else "no"
    return [
        *_scene_lines(scene),
        *(line("", note) for note in scene.notes),
        line("time", f"{time_text(time)}"),
        line("distance", f"{distance:.15g} {unit}"),
        line("lower bound", f"{at_least(answer.lower_bound, MOST_DIGITS)} {unit}"),
        line("upper bound", f"{at_most(answer.upper_bound, MOST_DIGITS)} {unit}"),
        line(_on(scene.pair[0]), f"{on_a} {unit}, {answer.feature_a}"),
        line(_on(scene.pair[1]), f"{on_b} {unit}, {answer.feature_b}"),
        line(
            "normal", f"{vector_text(answer.normal, 1.0)} from {scene.pair[0]} to {scene.pair[1]}"
        ),
        *(_solid_lines(scene, answer) if isinstance(answer, SolidProximity) else ()),
        line("certified", certified),
        *(
            []
            if answer.certified or isinstance(answer, SolidProximity)
            else [line("", f"{answer.status.name}: {answer.status.advice}")]
        ),
        line("work", _work(answer.counts, verbose=verbose)),
    ]


def _solid_lines(scene: Scene, answer: SolidProximity) -> list[str]:
    """What only an answer of solids has: its status, and how many pairs are as near."""
    lines = [line("status", f"{answer.status.name}: {answer.status.advice}")]
    if answer.inside:
        inner, outer = scene.pair if answer.inside == "A" else scene.pair[::-1]
        lines.append(line("inside", f"{inner} is inside the material of {outer}"))
    if answer.cavity:
        inner, outer = scene.pair if answer.cavity == "A" else scene.pair[::-1]
        lines.append(line("inside", f"{inner} is in a cavity of {outer}"))
    if answer.continuum is not None:
        lines.append(line("continuum", f"a {answer.continuum.kind} of nearest pairs"))
    elif len(answer.minima) > 1:
        lines.append(line("ties", f"{counted(len(answer.minima), 'pair')} at this distance"))
    if answer.overlap is not None:
        unit = scene.length_unit
        lines.append(
            line("overlap", f"a ball of radius {at_least(answer.overlap.radius)} {unit} is in both")
        )
        least = f"no translation shorter than {at_least(answer.overlap.depth)} {unit} parts them"
        lines.append(line("depth", least))
        if answer.overlap.way < np.inf:
            lines.append(line("way out", f"one of {at_most(answer.overlap.way)} {unit} does"))
        if answer.overlap.reason:
            lines.append(line("bounds", answer.overlap.reason))
    return lines


def impact_lines(scene: Scene, found: Impact, *, verbose: bool = False) -> list[str]:
    """Return the lines for a time of impact and the answer at that time."""
    lines = answer_lines(scene, found.time, found.proximity, verbose=verbose)
    instants = counted(found.evaluations, "instant")
    queries = counted(found.queries, "query", "queries")
    latest = "none" if np.isnan(found.latest) else f"{found.latest:.12g} s"
    at = next(k for k, text in enumerate(lines) if text.startswith("time"))
    lines[at : at + 1] = [
        line("impact", found.status.name),
        line("clearance", f"{found.clearance:g} {scene.length_unit}"),
        line("", found.status.advice),
        line("time", f"{found.time:.12g} s"),
        line("latest", latest),
        line("looked at", f"{instants}, {queries}"),
    ]
    return lines


def recording_lines(
    scene: Scene, recording: Recording, written: Sequence[Path], *, verbose: bool = False
) -> list[str]:
    """Return the lines that sum up a run."""
    frames, certified = len(recording.time), int(np.count_nonzero(recording.certified))
    share = share_text(certified, frames)
    tolerance = _tolerance_text(float(recording.info.options["tolerance"]))
    return [
        *_scene_lines(scene),
        *(line("", note) for note in scene.notes),
        *([] if recording.info.of_solids else [line("law", _law_text(recording))]),
        line("frames", frames_text(recording.time)),
        line("closest", _closest_text(scene, recording)),
        line("certified", f"{certified} of {counted(frames, 'frame')}, {share}, {tolerance}"),
        *_advice(recording.status_frames(), frames),
        line("worst gap", _gap_text(scene, recording)),
        line("work", _work(recording.total_counts(), verbose=verbose)),
        *_event_lines(scene, recording.events),
        *_minima_lines(scene, recording),
        *(line("wrote" if k == 0 else "", str(path)) for k, path in enumerate(written)),
    ]


def _scene_lines(scene: Scene) -> list[str]:
    (a, b), (body_a, body_b) = scene.pair, (boundary_of(x) for x in scene.pair_shapes)
    bodies = f"A = {a} ({body_a.name}), B = {b} ({body_b.name})"
    if len(scene.pairs) == 1:
        return [line("scene", f"{scene.title}: {bodies}")]
    return [line("scene", scene.title), line("pair", f"{scene.selected.name}: {bodies}")]


def _law_text(recording: Recording) -> str:
    """The law with its predictor or integrator, its gain, and what else is not the default."""
    options = recording.info.options
    law = LAWS[options["law"]]
    usual = law().resolved(float(options["dt"])).facts()
    told = [law.name]
    for name, each in options_of(law).items():
        value = options[name]
        if value is not None and (name in ALWAYS_TOLD or value != usual[name]):
            told.append(f"{name} {_option_text(each, value)}")
    return ", ".join(told)


def _option_text(option: Option, value: Any) -> str:
    if isinstance(option.kind, OfFeedback):
        return feedback_text(value)
    if isinstance(value, bool):
        return str(value).lower()
    unit = f" {option.unit}" if option.unit else ""
    return f"{value:.6g}{unit}" if isinstance(value, float) else f"{value}{unit}"


def frames_text(times: Array) -> str:
    """Return how many frames there are, from when to when, and how far apart."""
    steps = 1e3 * np.diff(times)
    least, most = f"{steps.min():.4g}", f"{steps.max():.4g}"
    every = f"{most} ms" if least == most else f"{least} to {most} ms"
    first, last = times[[0, -1]].tolist()
    return f"{len(times)} from {time_text(first)} to {time_text(last)}, {every} apart"


def time_text(seconds: float) -> str:
    """Return a time with its unit."""
    # To the microsecond, which a recorder's epoch of 1e9 s leaves of a double.
    return f"{seconds:.6f}".rstrip("0").rstrip(".") + " s"


def _closest_text(scene: Scene, recording: Recording) -> str:
    frame = recording.closest()
    if frame is None:
        return "no frame has a distance"
    a, b = scene.pair
    at = time_text(recording.time[frame])
    return (
        f"{recording.distance[frame]:.6g} {scene.length_unit} at {at}, "
        f"{a} {recording.feature_a[frame]} to {b} {recording.feature_b[frame]}"
    )


def _gap_text(scene: Scene, recording: Recording) -> str:
    frame = recording.widest_gap()
    if frame is None:
        return "no frame has a distance"
    return (
        f"{recording.gap[frame]:.3g} {scene.length_unit} (distance − lower bound) "
        f"at {time_text(recording.time[frame])}"
    )


def share_text(part: int, whole: int) -> str:
    """Return a part as percent of a whole."""
    # Rounding must not turn all but one into all.
    percent = 100.0 * part / whole
    return f"{percent:.0f} %" if part in (0, whole) else f"{min(percent, 99.99):.2f} %"


def _advice(statuses: dict[Status, int], frames: int) -> list[str]:
    return [
        line("", f"{status.name} in {count} of {counted(frames, 'frame')}: {status.advice}")
        for status, count in statuses.items()
        if not status.certified
    ]


def _work(counts: Counts | SolidCounts, *, verbose: bool) -> str:
    told = []
    for name, n in counts._asdict().items():
        one, many = NOUNS.get(name, (name.removesuffix("s").replace("_", " "), ""))
        if n or verbose:
            told.append(counted(n, one, many))
    return ", ".join(told) or "none"


def _tolerance_text(tolerance: float) -> str:
    if np.isinf(tolerance):
        return "no tolerance given"
    return f"tolerance {tolerance:g} of the pair's size"


def _on(name: str) -> str:
    """The name of the line of a witness point, with a space before what it says."""
    text = f"on {printable(name)}"
    return text if len(text) < MARGIN else f"{text[: MARGIN - 2]}…"


def _event_lines(scene: Scene, events: Sequence[RecordedEvent]) -> list[str]:
    if not events:
        return [line("events", "none")]
    more = f", the first {FIRST_EVENTS}:" if len(events) > FIRST_EVENTS else ":"
    lines = [line("events", f"{len(events)}{more}")]
    names = dict(zip("AB", scene.pair, strict=True))
    told = (
        f"{time_text(event.time):<12} {names[event.body]}: {event.source} to {event.target}"
        f"{'' if event.located else ', not located'}"
        for event in events[:FIRST_EVENTS]
    )
    return [*lines, *(line("", text) for text in told)]


def _minima_lines(scene: Scene, recording: Recording) -> list[str]:
    """How many local minima there were, and the first of their births, ends and handovers."""
    if recording.minima is None:
        return []
    unit, keys = scene.length_unit, recording.minima.key
    most = int(np.bincount(recording.minima.frame, minlength=1).max())
    below = f"below {recording.info.options['minima']:g} {unit}"
    events = [event for event in recording.minima_events if event.kind != "switch"]
    more = f", the first {FIRST_EVENTS} events:" if len(events) > FIRST_EVENTS else ":"
    total = counted(len(np.unique(keys[keys != NONE])), "local minimum", "local minima")
    told = (
        f"{time_text(recording.time[event.frame]):<12} {_event_text(event)}, "
        f"at {event.distance:.6g} {unit}"
        for event in events[:FIRST_EVENTS]
    )
    head = line("minima", f"{total} {below}, {most} at most in a frame{more if events else ''}")
    return [head, *(line("", text) for text in told)]


def _event_text(event: MinimumEvent) -> str:
    if event.kind == "handover":
        return f"minimum {event.key} is the nearest, {event.other} was"
    reason = "" if event.reason is None else f", {event.reason.name}"
    into = f" into {event.other}" if event.kind == "end" and event.other != NONE else ""
    return f"minimum {event.key}: {event.kind}{reason}{into}"


def vector_text(vector: Array, size: float, digits: int = 9) -> str:
    """Return a vector in parentheses; numbers that are roundoff beside a size are zero."""
    values = without_roundoff(vector, size)
    return "(" + ", ".join(f"{value:.{digits}g}" for value in values) + ")"
