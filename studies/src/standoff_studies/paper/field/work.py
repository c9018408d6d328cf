"""The work: pairs in motion, the frames at which methods are measured, and the true answers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from standoff.motion import Pose, Twist
from standoff.recording import track
from standoff.tracking import Feature, Proximity, Tracker, distance
from standoff.typing import Array
from standoff_studies.paper.convergence.pairs import DRAWN_PAIRS, Pair, pair, set_apart
from standoff_studies.paper.field.shells import Shell, Spot
from standoff_studies.paper.pair_simulation import REST, Place, Start
from standoff_studies.paper.patch_places import place_on

STEP = 1e-3
"""Frame time [s]: the paper's 1 kHz."""

LOOKS = 240
"""Frames in which a motion is tracked for its switches, whose instants are located within them."""

SEED = 56


@dataclass(frozen=True, eq=False)
class Work:
    """A pair in motion.

    Attributes
    ----------
    name : str
    pair : Pair
        A at rest.
    windows : tuple of float
        Where stretches of consecutive frames begin [s].
    frames : int
        Frames of a stretch.
    starts : int
        How many starts are tried, with the bodies at rest.
    number : int
        Of a drawn pair; the starts follow from it.
    """

    name: str
    pair: Pair
    windows: tuple[float, ...]
    frames: int
    starts: int
    number: int = 0

    @cached_property
    def shells(self) -> tuple[Shell, Shell]:
        """The boundaries of A and B."""
        return Shell(self.pair.a), Shell(self.pair.b)

    def poses(self, time: float) -> tuple[Pose, Pose]:
        """The poses of A and B."""
        return REST.pose(time), self.pair.path.pose(time)

    def twists(self, time: float) -> tuple[Twist, Twist]:
        """The twists of A and B."""
        return REST.twist(time), self.pair.path.twist(time)

    def truth(self, time: float) -> Proximity:
        """Return the certified answer of a cold query."""
        return distance(self.pair.a, self.pair.b, *self.poses(time))

    def tried(self) -> Iterator[tuple[float, Start]]:
        """Draw the starts, each with the instant at which the bodies rest."""
        rng = np.random.default_rng([SEED, self.number, self.starts])
        for k in range(self.starts):
            yield self.windows[k % len(self.windows)], self.pair.draw(rng)


def spots_of(work: Work, answer: Proximity) -> tuple[Spot, Spot]:
    """Return the places on the patches of the closest points of an answer."""
    a, b = work.shells
    return (
        _spot(a, answer.feature_a, np.asarray(answer.parameters_a)),
        _spot(b, answer.feature_b, np.asarray(answer.parameters_b)),
    )


def _spot(shell: Shell, feature: Feature, parameters: Array) -> Spot:
    if shell.n == 0:
        return Spot(0, np.zeros(0))
    if shell.n == 1:
        if feature.kind == "edge":
            return Spot(feature.index, parameters[:1])
        return Spot(feature.index, np.zeros(1))  # curve i begins at vertex i
    for face in range(len(shell.patches)):
        place = place_on(shell.body, face, feature, parameters)
        if place is not None:
            q = np.array([0.5 if np.isnan(x) else x for x in place])
            return Spot(face, _snapped(q))
    raise LookupError(f"{feature} is on no face")


def _snapped(q: Array) -> Array:
    """Parameters of an edge, exactly on the side of its patch."""
    at = np.round(q)
    return np.where(np.abs(q - at) < SNAP, at, q)


SNAP = 1e-12
"""Parameters nearer to a side than this are on it: they come from it, but for roundoff."""


def spot_at(place: Place) -> Spot:
    """Return a start's place as a spot."""
    (kind, index), parameters = place
    return Spot(0 if kind == "vertex" else index, np.array(parameters, dtype=float))


DURATIONS = {"A point": 3.1, "B": 1.5, "C": 12.0, "D patches": 5.34, "E patches": 4.0}
"""The motions of simulations A to E [s]; of B the part outside."""


def simulation(key: str, evenly: int, switches: int, frames: int, starts: int) -> Work:
    """Return a simulation's work: stretches evenly over its motion, and one about each of its
    first switches, at most so many, which is in the middle of a frame."""
    one, duration = pair(key), DURATIONS[key]
    last = duration - (frames + 1) * STEP
    even = np.linspace(0.0, last, evenly).tolist()
    run = track(Tracker(one.a, one.b, duration / LOOKS), REST, one.path, duration)
    seen = [event.time for event in run.events[:switches]]
    about = [min(max(t - 0.5 * (frames + 1) * STEP, 0.0), last) for t in seen]
    return Work(key[0], one, (*even, *about), frames, starts)


def drawn_work(number: int, frames: int) -> Work:
    """Return a drawn pair's work: one of ten pairs of stretched lenses, in a place and motion of
    its own; one stretch, and one start."""
    one = pair(DRAWN_PAIRS[number % len(DRAWN_PAIRS)])
    rng = np.random.default_rng([SEED, number])
    own = set_apart(f"{one.name}, motion {number}", one.a, one.b, rng)
    return Work("drawn", own, (0.0,), frames, 1, number)
