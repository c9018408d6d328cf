"""``python -m standoff_studies.soak.solid_contacts``: solids that fall on each other, judged by
samples.

Block k of a seed is a simulation of one pair, always the same: B is drawn towards A from a drawn
side, with a drawn spin, and bounces, rolls and slides on it until it has left. At the end of each
stretch of 40 ticks the places of contact are compared with a query from nothing at the same poses:
each minimum that it tells is among them, and where the solids overlap something pushes.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from standoff.errors import StandoffError
from standoff.motion import Pose, Twist
from standoff.simulation import (
    HuntCrossley,
    Operator,
    RigidBody,
    SolidContact,
    System,
    SystemState,
    mass_properties,
)
from standoff.solids import SolidProximity, distance
from standoff.tracking.status import Status
from standoff_studies.soak import blocks
from standoff_studies.soak.solid_motions import SAME, STILL
from standoff_studies.soak.solid_outlines import Array
from standoff_studies.soak.solid_pairs import made
from standoff_studies.soak.solid_parts import MAKERS
from standoff_studies.soak.solid_poses import pairs_of

BLOCK, STRETCH = 2_000, 40
"""Ticks of a simulation, and from one sample to the next."""
DEPTH = 1e-3
"""Of the size: how deep the weight of B presses one spring."""
LOOKED_FOR = 4.0
"""Depths, on either side of 0, up to which places are compared."""
FROM = 1e-2
"""Of the size: how far apart both begin."""
SPIN = 0.5
"""Greatest speed of a turn at the start, rad/s, of sizes near 1 and a gravity of 1."""
FIRST_STEP, HALVINGS = 4e-3, 8


@dataclass(frozen=True)
class Verdict(blocks.Counted):
    """Counts of ticks, of those whose answers were not certified, of those that may have crossed
    something, and of places that ended deep; of samples, of those that overlap, and of those that
    are wrong; of minima of samples, and of those that no place was; and seconds."""

    ticks: int = 0
    uncertified: int = 0
    crossings: int = 0
    jumps: int = 0
    sampled: int = 0
    overlaps: int = 0
    wrong: int = 0
    minima: int = 0
    lost: int = 0
    seconds: float = 0.0

    def __str__(self) -> str:
        each = 1e6 * self.seconds / max(self.ticks, 1)
        return (
            f"{self.ticks:,} ticks, {each:.0f} us each; {self.uncertified} not certified, "
            f"{self.crossings} may have crossed, {self.jumps} places ended deep; "
            f"{self.sampled:,} sampled, {self.overlaps:,} in overlap: {self.wrong} wrong; "
            f"{self.minima:,} minima, {self.lost} no places"
        )


def falling(a: Any, b: Any, rng: np.random.Generator) -> Operator:
    """B drawn to A from nearby."""
    way = rng.normal(size=3)
    way /= np.linalg.norm(way)
    size = 0.5 * (a.size + b.size)
    turn = Rotation.random(random_state=rng).as_matrix()
    far = a.ball_round()[0] + 2.0 * (a.size + b.size) * way - turn @ b.ball_round()[0]
    near = distance(a, b, STILL, Pose(turn, far))
    there = far - near.normal * (near.distance - FROM * size)
    spin = SPIN * rng.uniform(-1.0, 1.0, size=3)
    mass = mass_properties(b, 1.0)
    middle = turn @ mass.centre
    free = RigidBody.free(
        b, density=1.0, pose=Pose(turn, there), twist=Twist(np.cross(middle, spin), spin)
    )
    depth = DEPTH * size
    law = HuntCrossley(
        stiffness=mass.mass / depth**1.5, damping=0.5, friction=0.2, slip_speed=0.05, depth=depth
    )
    return with_step(System([RigidBody.fixed(a), free], law, gravity=-near.normal))


def with_step(system: System) -> Operator:
    """With a step that a contact is stable with."""
    step = FIRST_STEP
    for _ in range(HALVINGS):
        try:
            return Operator(system, step)
        except StandoffError:  # too long for its stiffness, or its slip speed
            step *= 0.5
    return Operator(system, step)


def judged_fall(
    number: int, seed: int, pairs: list[tuple[str, str]], ticks: int
) -> tuple[Verdict, list[str]]:
    """A simulation of a pair, and its faults' lines."""
    rng = np.random.default_rng([seed, number, 8])
    a, b = (made(name)[1] for name in pairs[number % len(pairs)])
    operator = falling(a, b, rng)
    state, verdict, lines = operator.start(), Verdict(), []
    below = LOOKED_FOR * operator.system.depth(0)
    for first in range(0, ticks, STRETCH):
        begun = time.perf_counter()
        state = operator.run(state, STRETCH, STRETCH).final
        seconds = time.perf_counter() - begun
        sample, faults = judged(a, b, state, below)
        verdict = verdict.plus(sample).plus(Verdict(STRETCH, seconds=seconds))
        where = f"seed {seed}, block {number}, {a.name}, {b.name}, tick {first + STRETCH}"
        lines += [f"{where}: {fault}" for fault in faults]
        if not state.contact(0).places and state.distance(0) > below and first > ticks // 4:
            break
    crossed = sum(each.ticks for each in state.crossings)
    missed = state.uncertified - crossed
    told = Verdict(uncertified=missed, crossings=crossed, jumps=state.jumps)
    return verdict.plus(told), lines


def judged(a: Any, b: Any, state: SystemState, below: float) -> tuple[Verdict, list[str]]:
    """The places of a state beside a query from nothing at its poses."""
    cold = distance(a, b, state.pose(0), state.pose(1), minima=below)
    return compared(state.contact(0), cold, below, SAME * (a.size + b.size))


def compared(
    contact: SolidContact, cold: SolidProximity, below: float, spare: float
) -> tuple[Verdict, list[str]]:
    """Places beside an answer from nothing, up to a distance on both sides of 0."""
    known: Array = np.array([place.distance for place in contact.places])
    met = cold.status is Status.OVERLAPPING
    placed = not met or cold.minima[0].distance < 0.0  # else the query knows a ball alone
    sought = [m.distance for m in cold.minima if placed and abs(m.distance) < below - spare]
    lost = [d for d in sought if not (np.abs(known - d) <= spare).any()]
    faults = []
    deep = met and placed and -below < cold.minima[0].distance < -spare
    if deep and contact.complete and not contact.spots:
        faults.append(f"overlap of {-cold.minima[0].distance!r}, and nothing pushes")
    found = Verdict(
        sampled=1, overlaps=int(met), wrong=int(bool(faults)), minima=len(sought), lost=len(lost)
    )
    return found, faults + [f"minima at {lost!r} are no places"] * bool(lost)


def main() -> int:
    """Read the options, run, and tell; 1 if anything was wrong."""
    parser = blocks.options(__doc__, "ticks", 1_000_000, BLOCK)
    parser.add_argument("--parts", nargs="+", default=list(MAKERS), choices=list(MAKERS))
    given = parser.parse_args()
    work = partial(judged_fall, seed=given.seed, pairs=pairs_of(given.parts), ticks=BLOCK)
    verdict = blocks.run(given, BLOCK, work)
    return 0 if verdict is None or verdict.sound else 1


if __name__ == "__main__":
    raise SystemExit(main())
