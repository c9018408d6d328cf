"""Results as text for a reader at a terminal."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np

from standoff.scene import Scene, TrackSettings
from standoff.scene.feedbacks import feedback_text
from standoff.scene.reader import Array
from standoff.tracking import Counts, Impact, Proximity, RecordedEvent, Recording, Status
from standoff.tracking.options import Variants

FIRST_EVENTS = 8
"""How many switching events the summary lists: they fit on a screen with the rest. All of them are
in the Parquet file and in ``--json``."""

MARGIN = 14
"""Width of the column of names, in characters."""


def line(name: str, text: str) -> str:
    """Return one line of the summary."""
    return f"{name:<{MARGIN}}{text}"


def answer_lines(scene: Scene, time: float, answer: Proximity) -> list[str]:
    """Return the lines that tell one answer."""
    unit = scene.length_unit
    return [
        *_scene_lines(scene),
        *(line("", note) for note in scene.notes),
        line("time", f"{_time(time)}"),
        line("distance", f"{answer.distance:.15g} {unit}"),
        line("lower bound", f"{answer.lower_bound:.15g} {unit}"),
        line("upper bound", f"{answer.upper_bound:.15g} {unit}"),
        line(
            f"on {scene.pair[0]}"[:MARGIN], f"{_vector(answer.point_a)} {unit}, {answer.feature_a}"
        ),
        line(
            f"on {scene.pair[1]}"[:MARGIN], f"{_vector(answer.point_b)} {unit}, {answer.feature_b}"
        ),
        line("normal", f"{_vector(answer.normal)} from {scene.pair[0]} to {scene.pair[1]}"),
        line("certified", "yes" if answer.certified else "no"),
        *_advice({answer.status: 1}, 1),
        line("work", _work(answer.counts)),
    ]


def impact_lines(scene: Scene, found: Impact) -> list[str]:
    """Return the lines that tell a time of impact and the answer at that time."""
    lines = answer_lines(scene, found.time, found.proximity)
    latest = "none" if np.isnan(found.latest) else f"{found.latest:.12g} s"
    at = next(k for k, text in enumerate(lines) if text.startswith("time"))
    lines[at : at + 1] = [
        line("impact", found.status.name),
        line("clearance", f"{found.clearance:g} {scene.length_unit}"),
        line("", found.status.advice),
        line("time", f"{found.time:.12g} s"),
        line("latest", latest),
        line("looked at", f"{found.evaluations} instants, {found.queries} queries"),
    ]
    return lines


def recording_lines(
    scene: Scene, settings: TrackSettings, recording: Recording, written: Sequence[Path]
) -> list[str]:
    """Return the lines that sum up a run."""
    frames, certified = len(recording.time), int(np.count_nonzero(recording.certified))
    return [
        *_scene_lines(scene),
        *(line("", note) for note in scene.notes),
        line("law", _law_text(settings, recording)),
        line("frames", _frames_text(recording)),
        line("closest", _closest_text(scene, recording)),
        line("certified", f"{certified} of {frames} frames, {_share(certified, frames)}"),
        *_advice(recording.status_frames(), frames),
        line("worst gap", _gap_text(scene, recording)),
        line("work", _work(recording.total_counts())),
        *_event_lines(scene, recording.events),
        *(line("wrote" if k == 0 else "", str(path)) for k, path in enumerate(written)),
    ]


def _scene_lines(scene: Scene) -> list[str]:
    (a, b), (body_a, body_b) = scene.pair, scene.pair_bodies
    bodies = f"A = {a} ({body_a.name}), B = {b} ({body_b.name})"
    if len(scene.pairs) == 1:
        return [line("scene", f"{scene.title}: {bodies}")]
    return [line("scene", scene.title), line("pair", f"{scene.selected.name}: {bodies}")]


def _law_text(settings: TrackSettings, recording: Recording) -> str:
    if settings.law != "paper":
        return f"{settings.law}, predictor {settings.predictor}"
    if settings.feedback is None:
        gain = settings.gain or 1.0 / float(np.diff(recording.time).max())
        feedback = f"gain {gain:.6g} 1/s"
    else:
        feedback = f"feedback {feedback_text(settings.feedback)}"
    told = [settings.law, settings.integrator, feedback]
    if settings.predictor == "none":
        told.append("no feedforward")
    used = recording.info.options
    told += [f"{k} {used[k]}" for k, usual in asdict(Variants()).items() if used[k] != usual]
    return ", ".join(told)


def _frames_text(recording: Recording) -> str:
    steps = 1e3 * np.diff(recording.time)
    least, most = f"{steps.min():.4g}", f"{steps.max():.4g}"
    every = f"{most} ms" if least == most else f"{least} to {most} ms"
    first, last = recording.time[[0, -1]].tolist()
    return f"{len(recording.time)} from {_time(first)} to {_time(last)}, {every} apart"


def _time(seconds: float) -> str:
    # To the microsecond, which a recorder's epoch of 1e9 s leaves of a double.
    return f"{seconds:.6f}".rstrip("0").rstrip(".") + " s"


def _closest_text(scene: Scene, recording: Recording) -> str:
    frame = recording.closest()
    if frame is None:
        return "no frame has a distance"
    a, b = scene.pair
    return (
        f"{recording.distance[frame]:.12g} {scene.length_unit} at {_time(recording.time[frame])}, "
        f"{a} {recording.feature_a[frame]} to {b} {recording.feature_b[frame]}"
    )


def _gap_text(scene: Scene, recording: Recording) -> str:
    frame = recording.widest_gap()
    if frame is None:
        return "no frame has a distance"
    return (
        f"{recording.gap[frame]:.3g} {scene.length_unit} (distance − lower bound) "
        f"at {_time(recording.time[frame])}"
    )


def _share(part: int, whole: int) -> str:
    # Rounding must not turn all but one into all.
    percent = 100.0 * part / whole
    return f"{percent:.0f} %" if part in (0, whole) else f"{min(percent, 99.99):.2f} %"


def _advice(statuses: dict[Status, int], frames: int) -> list[str]:
    return [
        line("", f"{status.name} in {count} of {frames}: {status.advice}")
        for status, count in statuses.items()
        if status not in (Status.CONVERGED, Status.GLOBAL)
    ]


def _work(counts: Counts) -> str:
    return ", ".join(f"{n} {name.replace('_', ' ')}" for name, n in counts._asdict().items())


def _event_lines(scene: Scene, events: Sequence[RecordedEvent]) -> list[str]:
    if not events:
        return [line("events", "none")]
    more = f", the first {FIRST_EVENTS}:" if len(events) > FIRST_EVENTS else ":"
    lines = [line("events", f"{len(events)}{more}")]
    names = dict(zip("AB", scene.pair, strict=True))
    told = (
        f"{_time(event.time):<12} {names[event.body]}: {event.source} to {event.target}"
        f"{'' if event.located else ', not located'}"
        for event in events[:FIRST_EVENTS]
    )
    return [*lines, *(line("", text) for text in told)]


def _vector(vector: Array) -> str:
    return "(" + ", ".join(f"{value:.9g}" for value in vector) + ")"
