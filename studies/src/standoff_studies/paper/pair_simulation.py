"""A simulation of two bodies, and its runs: by the printed system and by the library."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np

from standoff.automaton import Visit
from standoff.bodies import Body
from standoff.motion import Fixed, Path, Pose
from standoff.recording import RecordedEvent, Recording, track
from standoff.recording.times import even_times
from standoff.recording.track import track_along
from standoff.tracking import Proximity, Tracker, TrackerState, distance
from standoff.tracking.laws import PaperLaw
from standoff.typing import Array
from standoff_studies.paper.figure import HYBRID, Statement, own_statement
from standoff_studies.paper.held_features import CONTINUOUS, SHARED, greatest_growth
from standoff_studies.paper.law_words import law_words
from standoff_studies.paper.many_starts import Ends, begun, is_pinned, last_answers
from standoff_studies.paper.resets import (
    Errors,
    Move,
    Reset,
    moves_of,
    projection_errors,
    resets_of,
)

Place = tuple[tuple[str, int], tuple[float, ...]]
"""A feature, kind and number, and parameters on it."""

Start = tuple[Place, Place]
"""The places on A and on B."""

AT_POINT: Place = ("vertex", 0), ()
"""The place on a body that is a point."""

REST = Fixed(Pose.identity())
"""The path of a body that stays where it is."""


@dataclass(frozen=True, eq=False)
class Simulation:
    """The input of a simulation's figures.

    Attributes
    ----------
    bodies : callable
        Makes A and B.
    paths : (Path, Path)
        Of A and B.
    duration, step : float
        Of the motion, and of a frame [s].
    gain : float
        K of the printed system [1/s].
    starts : tuple of Start
        Where the printed system starts, right or wrong. The figures show the first.
    entered : float
        Time after which a wrong start has reached the true features [s].
    """

    bodies: Callable[[], tuple[Body, Body]]
    paths: tuple[Path, Path]
    duration: float
    step: float
    gain: float
    starts: tuple[Start, ...]
    entered: float

    @cached_property
    def pair(self) -> tuple[Body, Body]:
        """A and B."""
        return self.bodies()

    @property
    def a(self) -> Body:
        return self.pair[0]

    @property
    def b(self) -> Body:
        return self.pair[1]

    @property
    def exact(self) -> Recording:
        """By the library's own law: every frame certified, every switch located within its step."""
        return exact_run(self)

    @property
    def printed(self) -> tuple[Recording, ...]:
        """By the system as printed, from each of the starts."""
        return printed_runs(self)

    @property
    def paper(self) -> Recording:
        """The run that the figures show."""
        return self.printed[0]

    @property
    def by(self) -> str:
        """The law with which statements on `printed` were measured."""
        return law_words(*self.printed, told="wrong start")

    @property
    def own(self) -> str:
        """The law with which statements on `exact` were measured."""
        return law_words(self.exact)

    @property
    def resets(self) -> list[Reset]:
        """The switches of `paper`, frame by frame."""
        return resets_of(self.paper, self.paths, self.gain)

    @property
    def errors(self) -> Errors:
        """The projection errors of `paper`."""
        return projection_errors(self.paper, self.paths)

    @property
    def witness_error(self) -> Array:
        """The greater error of the two witness points of `paper` [length], (n,)."""
        off_a = np.linalg.norm(self.paper.point_a - self.exact.point_a, axis=1)
        off_b = np.linalg.norm(self.paper.point_b - self.exact.point_b, axis=1)
        return np.asarray(np.maximum(off_a, off_b))

    @property
    def stays(self) -> list[Visit]:
        """The modes of `paper` once its start has reached the true features."""
        return [visit for visit in self.paper.modes() if visit.end > self.entered]

    def tracker(self) -> Tracker:
        """Return the tracker of the system as printed."""
        return Tracker(*self.pair, self.step, law=PaperLaw.as_printed(gain=self.gain))

    def begin(
        self, law: Tracker, start: Start, paths: tuple[Path, Path] | None = None
    ) -> TrackerState:
        """Return a law's state at any start, at the beginning of the motion."""
        return begun(law, self.paths if paths is None else paths, *start)

    def entered_events(self, recording: Recording) -> list[RecordedEvent]:
        """Return the switches after a wrong start has reached the true features."""
        return [event for event in recording.events if event.time > self.entered]

    def late(self, recording: Recording | None = None) -> Array:
        """Return how much later the printed system switches than the library's own law [s].

        Infinite if the features differ.
        """
        own = self.entered_events(self.paper if recording is None else recording)
        due = self.entered_events(self.exact)
        if [event[2:5] for event in own] != [event[2:5] for event in due]:
            return np.full(len(due), np.inf)
        return np.array([one.time - other.time for one, other in zip(own, due, strict=True)])

    def furthest(self) -> float:
        """Return the greatest time between a switch of the runs and of the library's law [s]."""
        return float(max(np.abs(self.late(one)).max(initial=0.0) for one in self.printed))


@cache
def exact_run(simulation: Simulation) -> Recording:
    """Track the pair with the library's own law."""
    law = Tracker(*simulation.pair, simulation.step)
    return track(law, *simulation.paths, simulation.duration)


@cache
def printed_runs(simulation: Simulation) -> tuple[Recording, ...]:
    """Track the pair with the printed system, from each start."""
    law, times = simulation.tracker(), even_times(0.0, simulation.duration, simulation.step)
    states = [simulation.begin(law, start) for start in simulation.starts]
    return tuple(track_along(law, *simulation.paths, times, state=state) for state in states)


def random_starts(kind: str, count: int) -> list[Start]:
    """Draw starts on both bodies, each on one of three faces or edges, parameters from 0 to 1."""
    rng, parameters = np.random.default_rng(1), {"edge": 1, "face": 2}[kind]
    found = []
    for _ in range(count):
        on, at = rng.integers(3, size=2).tolist(), rng.uniform(0.02, 0.98, (2, parameters)).tolist()
        a, b = (((kind, index), tuple(own)) for index, own in zip(on, at, strict=True))
        found.append((a, b))
    return found


def ends_of(
    simulation: Simulation,
    tried: Sequence[Start],
    patience: float,
    arrived: Callable[[Proximity, Proximity], bool],
    told: str,
    paths: tuple[Path, Path] | None = None,
) -> Ends:
    """Try starts with the printed system, and return where they are after some time.

    Parameters
    ----------
    simulation : Simulation
    tried : sequence of Start
    patience : float
        That time [s].
    arrived : callable
        Has an answer of the last frame arrived? The second argument is that of a global search.
    told : str
        About the starts, for the words of the law.
    paths : (Path, Path), optional
        Motions to use instead of the simulation's.
    """
    law, both = simulation.tracker(), simulation.paths if paths is None else paths
    states = (simulation.begin(law, start, both) for start in tried)
    times = even_times(0.0, patience, simulation.step)
    poses = both[0].pose(patience), both[1].pose(patience)
    due = distance(*simulation.pair, *poses)
    lost = [one for one in last_answers(law, states, both, times) if not arrived(one, due)]
    placed = sum((one.feature_a, one.feature_b) == (due.feature_a, due.feature_b) for one in lost)
    pinned = sum(is_pinned(simulation.pair, poses, one) for one in lost)
    return Ends(len(tried) - len(lost), len(tried), law_words(law, told=told), placed, pinned)


def moves_from(simulation: Simulation, tried: Sequence[Start], until: float) -> list[Move]:
    """Return how the printed resets move the witness points, from each start up to a time [s]."""
    law, times = simulation.tracker(), even_times(0.0, until, simulation.step)
    found: list[Move] = []
    for start in tried:
        state = simulation.begin(law, start)
        made = track_along(law, *simulation.paths, times, state=state)
        found += moves_of(made, simulation.paths, simulation.gain)
    return found


def never_grows(simulation: Simulation, told: str) -> Statement:
    """Return whether the distance grows at a switch of the closest points.

    Parameters
    ----------
    simulation : Simulation
    told : str
        What is farther away after the switch, with a placeholder for the number.
    """
    grows = greatest_growth(simulation.exact, simulation.paths)
    return Statement(
        HYBRID,
        "the distance between features never grows at a switch",
        f"at each of {len(simulation.exact.events)} instants {told.format(f'{grows:.0e}')}",
        grows <= CONTINUOUS,
        SHARED,
        simulation.own + ": the claim is of the closest points",
        constructed=True,
    )


def follows(simulation: Simulation, since: str = "", more: str = "") -> Statement:
    """Return whether the printed system makes the switches of the library's own law, and when.

    With the feedforward b the law does not lag by a time constant, only by the error of a step,
    less than a frame. Without b it lags by about 1/K.

    Parameters
    ----------
    simulation : Simulation
    since, more : str
        Text before and after.
    """
    off = simulation.furthest()
    return Statement(
        HYBRID,
        "the features follow those of the closest points",
        f"{since}{'the same' if np.isfinite(off) else 'other'} "
        f"{len(simulation.entered_events(simulation.paper))} switches as the library's own law, at "
        f"most {off:.1e} s apart (a frame is {simulation.step:g} s; without b it would be about "
        f"1/K = {1.0 / simulation.gain:g} s){more}",
        off < simulation.step,
        by=simulation.by,
    )


def anywhere(ends: Ends, told: str, why: str = "") -> Statement:
    """Return whether starts anywhere arrive; `told` says what was tried and what happened."""
    return Statement(
        HYBRID,
        "from a start anywhere on tiled convex bodies the errors converge",
        f"{ends.arrived} of {ends.tried} {told}",
        ends.arrived == ends.tried,
        why,
        ends.by,
    )


def certified(simulation: Simulation, figure: str) -> Statement:
    """Return how many frames the library's own law certifies, and how closely."""
    exact = simulation.exact
    return own_statement(
        figure,
        f"the default law certifies {int(exact.certified.sum())} of {len(exact)} frames; distance "
        f"less lower bound is at most {exact.gap.max():.0e} of the radius",
        by=simulation.own,
    )
