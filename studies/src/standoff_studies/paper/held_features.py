"""The distance at a switch, on the features before and after it: the claim that it never grows."""

from __future__ import annotations

from typing import Any

from standoff.bodies import Body
from standoff.motion import Path, Pose, Twist
from standoff.recording import RecordedEvent, Recording
from standoff.tracking import Tracker
from standoff.tracking.laws import PaperLaw
from standoff_studies.paper.patch_places import places_at

STEPS = 12
"""Newton steps on fixed features; they begin within a frame's motion, and five reach roundoff."""

CONTINUOUS = 1e-13
"""A distance that changes by less at a switch is continuous [length]: an instant accurate to 1e-9 s
changes it by the square of that, and the rest is roundoff."""

SHARED = "the old and the new feature share the point at which the closest points switch"
"""Why the distance of the closest points cannot grow there."""

Place = tuple[Any, Any]


def held_distance(
    bodies: tuple[Body, Body], poses: tuple[Pose, Pose], place_a: Place, place_b: Place
) -> float:
    """Return the distance of two features, from places (feature, parameters) on them [length].

    Both features are kept: the witness points stop at their ends.
    """
    law = Tracker(*bodies, law=PaperLaw(integrator="euler", switching="none"))
    state = law.start_from(*poses, place_a, place_b, settle=False)
    still = Twist.zero()
    for _ in range(STEPS):
        state, answer = law.step(state, *poses, still, still)
    return answer.distance


def growth(
    recording: Recording,
    paths: tuple[Path, Path],
    event: RecordedEvent,
    offset: float = 0.0,
) -> float:
    """Return the distance of the features after a switch minus that of those before it [length].

    Both are taken at the instant, or `offset` [s] after it.
    """
    assert recording.pair is not None, "not opened from a file"
    time = event.time + offset
    poses = paths[0].pose(time), paths[1].pose(time)
    before, after = (
        held_distance(recording.pair, poses, *places_at(recording, frame))
        for frame in (event.frame - 1, event.frame)
    )
    return after - before


def greatest_growth(recording: Recording, paths: tuple[Path, Path]) -> float:
    """Return the greatest growth over a recording's switches [length]."""
    return max(growth(recording, paths, event) for event in recording.events)
