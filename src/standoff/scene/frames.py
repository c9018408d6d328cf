"""The instants at which a scene is looked at."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from standoff.recording.times import MOST_FRAMES
from standoff.recording.tolerances import WHOLE_STEPS
from standoff.scene.errors import SceneError
from standoff.scene.motions import Motion
from standoff.scene.settings import DEFAULT_STEP, SAMPLES, TrackSettings
from standoff.typing import Array


def time_span(motions: Iterable[Motion]) -> tuple[float, float]:
    """Return the scene times [s] between which every motion is known; infinite where all are.

    Raises SceneError if the samples of two motions have no time in common.
    """
    sampled = [motion.sample_times for motion in motions if motion.sample_times.size]
    first = max((float(times[0]) for times in sampled), default=-math.inf)
    last = min((float(times[-1]) for times in sampled), default=math.inf)
    if first >= last:
        raise SceneError(
            f"the samples of the motions have no time in common: one begins at {first:g} s, "
            f"another ends at {last:g} s; set their 'start', or 'start = \"file\"' for each",
            key="motions",
        )
    return first, last


def check_time(time: float, motions: Iterable[Motion], key: str) -> float:
    """Return `time` [s] if every motion is known then; `key` names it in the message."""
    first, last = time_span(motions)
    if not math.isfinite(time):
        raise SceneError(f"must be a finite number, got {time}", key=key)
    if not first <= time <= last:
        raise SceneError(
            f"{time:g} s is outside the pose samples, which reach from {first:g} s to {last:g} s",
            key=key,
        )
    return time


def check_instant(time: float, settings: TrackSettings, motions: Iterable[Motion]) -> float:
    """Return `time` [s] if it lies within the scene's times.

    They go from the start to the end of the duration, or of the pose samples. A scene that has
    neither has no end time.

    Raises SceneError if it lies outside, or is not finite.
    """
    motions = list(motions)
    check_time(time, motions, "time")
    start, end = start_time(settings, motions), time_span(motions)[1]
    room, told = 0.0, ""
    if settings.duration is not None:
        end = min(end, start + settings.duration)
        # A sum such as 0.7 + 0.1 may be a rounding error below the end that is meant.
        room = WHOLE_STEPS * settings.duration
        told = f", a duration of {settings.duration:g} s"
    if not start <= time <= end + room:
        reach = f"from {start:g} s" + (f" to {end:g} s" if math.isfinite(end) else " on")
        raise SceneError(
            f"{time:g} s is outside the scene's times, {reach}{told}; give a time within them, or "
            "change 'start' or 'duration' of [track]",
            key="time",
        )
    return time


def start_time(settings: TrackSettings, motions: Iterable[Motion]) -> float:
    """Return the first instant [s]: the one asked for, else the first that all motions know."""
    motions = list(motions)
    if settings.start is not None:
        return check_time(settings.start, motions, "track.start")
    first, _ = time_span(motions)
    return first if math.isfinite(first) else 0.0


def time_window(settings: TrackSettings, motions: Iterable[Motion]) -> tuple[float, float]:
    """Return the times [s] between which the pair is looked at; no frame need lie between them.

    Raises SceneError if the end is not given, is beyond the samples, or is not later than the
    start.
    """
    motions = list(motions)
    start = start_time(settings, motions)
    end = _end(settings, motions, start)
    if not end > start:
        raise SceneError(
            f"no time is left after {start!r} s, because the pose samples end at {end!r} s or "
            f"times there are {math.ulp(start):.2g} s apart; begin earlier, or give a longer "
            "duration",
            key="track.start" if settings.duration is None else "track.duration",
        )
    return start, end


def frame_times(settings: TrackSettings, motions: Iterable[Motion]) -> Array:
    """Return the times of all frames [s], shape (n,), strictly increasing.

    Without a ``step`` the frames are the pose samples' own times if a body moves by samples, else
    `DEFAULT_STEP` apart. With a step they are ``start + k step``, the last one not beyond the end.

    Raises SceneError if the times are not given or not possible: no duration and no samples, a
    duration beyond the samples, ``step = "samples"`` without samples, or too many frames.
    """
    motions = list(motions)
    start = start_time(settings, motions)
    end = _end(settings, motions, start)
    sampled = [motion.sample_times for motion in motions if motion.sample_times.size]
    step = settings.step if settings.step is not None else (SAMPLES if sampled else DEFAULT_STEP)
    if isinstance(step, str):
        if not sampled:
            raise SceneError(
                f"'{SAMPLES}' needs a body that moves by pose samples; give a time in seconds, "
                f"such as step = {DEFAULT_STEP:g}",
                key="track.step",
            )
        times = np.unique(np.concatenate(sampled))
        times = times[(times >= start) & (times <= end)]
    else:
        steps = (end - start) / step + WHOLE_STEPS
        if steps >= MOST_FRAMES:
            raise SceneError(
                f"{end - start:g} s in steps of {step:g} s are {steps:.3g} frames, more than "
                f"{MOST_FRAMES:g}; give a longer step or a shorter duration",
                key="track.step",
            )
        # The last step may end a rounding error beyond the samples, which refuse to be asked there.
        times = np.minimum(start + step * np.arange(math.floor(steps) + 1), end)
    if len(times) < 2:
        raise SceneError(
            f"from {start:g} s to {end:g} s there are {len(times)} frames, at least 2 are needed; "
            "give a longer duration or a shorter step",
            key="track.duration",
        )
    return times


def _end(settings: TrackSettings, motions: list[Motion], start: float) -> float:
    _, last = time_span(motions)
    if settings.duration is None:
        if math.isinf(last):
            raise SceneError(
                "no motion ends by itself; add a line such as: duration = 10.0",
                key="track.duration",
            )
        return last
    end = start + settings.duration
    if end > last + WHOLE_STEPS * settings.duration:
        raise SceneError(
            f"{settings.duration:g} s from {start:g} s end at {end:g} s, after the last pose "
            f"sample at {last:g} s; give at most {last - start:g}, or leave 'duration' out",
            key="track.duration",
        )
    return min(end, last)
