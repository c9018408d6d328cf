"""``python -m standoff_studies.soak.solid_corners``: bodies that are pressed into hollow corners,
judged by samples of closed forms.

Block k of a seed is a simulation of one pair, always the same: a brick, a drum, a wedge or a tube
falls a little way into an angle of two walls, a channel, a blind hole or under the head of a bolt,
along the hollow edge or past its ends, level or tilted a little, and bounces and slides there. At
the end of each stretch of ticks the deepest sampled point of either boundary in the other solid is
what the places must tell, at least by half; and none may be deeper than a fall explains.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

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
from standoff.solids.spatial.solid import Solid
from standoff_studies.soak import blocks, solid_cells, solid_parts
from standoff_studies.soak.solid_contacts import with_step
from standoff_studies.soak.solid_outlines import Array
from standoff_studies.soak.solid_parts import Part
from standoff_studies.soak.solid_truth import Truth, signed

BLOCK, STRETCH = 2_000, 40
"""Ticks of a simulation, and from one sample to the next."""
DEPTH = 1e-3
"""Length, of sizes near 1: how deep the weight of the body presses one spring."""
FROM = 5e-3
"""Length: how far it falls."""
DEEPEST = 8.0
"""Depths: more than a fall from there presses a spring."""
SHALLOW = 0.1
"""Depths: overlaps less deep may not be felt yet."""
TOLD_HALF = 0.5
"""Of the deepest point's depth: what a place must tell."""
TILTS = (0.0, 1e-6, 1e-3, 1e-2)
"""Radians."""
ALONG, GRID = 65, 9
"""Samples along the sides of a patch, and along each way within it."""


class Case(NamedTuple):
    """A solid that stands still, one that is pressed into it, its middle where it fits into the
    corner, and two directions: out of the corner, and along its hollow edge."""

    fixed: Part
    pressed: Part
    fits: Pose
    out: Array
    along: Array


@dataclass(frozen=True)
class Verdict(blocks.Counted):
    """Counts of ticks, of those that were not certified, and of places that ended deep; of samples,
    of those that overlap, and of those that are wrong; and seconds."""

    ticks: int = 0
    uncertified: int = 0
    jumps: int = 0
    sampled: int = 0
    overlaps: int = 0
    wrong: int = 0
    seconds: float = 0.0

    def __str__(self) -> str:
        each = 1e6 * self.seconds / max(self.ticks, 1)
        return (
            f"{self.ticks:,} ticks, {each:.0f} us each; {self.uncertified} not certified, "
            f"{self.jumps} places ended deep; {self.sampled:,} sampled, {self.overlaps:,} in "
            f"overlap: {self.wrong} wrong"
        )


def samples(truth: Truth) -> Array:
    """(n, 3) points of a boundary: along the sides of its patches, and within them."""
    ends, inner = np.linspace(0.0, 1.0, ALONG), np.linspace(0.0, 1.0, GRID + 2)[1:-1]
    zero, one = np.zeros(ALONG), np.ones(ALONG)
    u = np.concatenate([ends, ends, zero, one, np.repeat(inner, GRID)])
    v = np.concatenate([zero, one, ends, ends, np.tile(inner, GRID)])
    boxes = np.column_stack([u, v, np.zeros((len(u), 2))])
    rows = [solid_cells.cells_of(truth.form, np.ascontiguousarray(p), boxes) for p in truth.patches]
    found = np.concatenate(rows)
    return np.asarray(found[found[:, 3] >= 0.0, :3])


def angle(rng: np.random.Generator) -> Case:
    """A brick in an angle of two walls, as long as the hollow edge or longer, or past one end."""
    half = 0.5 * np.radians(rng.uniform(50.0, 150.0))
    long, thick = rng.uniform(0.8, 1.5), 0.3
    walls = [np.array([np.sin(half), np.cos(half)]), np.array([-np.sin(half), np.cos(half)])]
    back = np.array([0.0, -thick / np.sin(half)])
    corners = [long * walls[1], np.zeros(2), long * walls[0]]
    corners += [long * walls[0] + back, back, long * walls[1] + back]
    high = rng.uniform(0.3, 1.5)
    fixed = solid_parts.swept_part("angle", np.array(corners)[::-1], high)
    wide = rng.uniform(0.2, 0.7, size=2)
    prism = np.array([np.zeros(2), wide[0] * walls[0], wide @ walls, wide[1] * walls[1]])
    tall = rng.choice([0.5, 1.0, 1.5]) * high
    pressed = solid_parts.swept_part("prism", prism, tall)
    shift = rng.choice([0.5 * (high - tall), 0.7 * high, -0.4 * tall])
    return Case(fixed, pressed, at(0.0, 0.0, shift), *np.eye(3)[[1, 2]])


def channel(rng: np.random.Generator) -> Case:
    """A brick between the walls of a channel, with play, or a drum along it or upright."""
    thick, wide, high = 0.2, rng.uniform(0.3, 0.8), rng.uniform(0.3, 1.2)
    a, b = wide + 2.0 * thick, 0.8
    t = thick
    corners = [(0, 0), (a, 0), (a, b), (a - t, b), (a - t, t), (t, t), (t, b), (0, b)]
    fixed = solid_parts.swept_part("channel", np.array(corners, dtype=float), high)
    play = rng.choice([1e-3, 1e-2, 0.2]) * wide
    tall = rng.choice([0.5, 1.5]) * high
    inner = wide - play
    if rng.random() < 0.5:
        box = np.array([[0.0, 0.0], [inner, 0.0], [inner, inner], [0.0, inner]])
        pressed = solid_parts.swept_part("brick", box, tall)
        return Case(fixed, pressed, at(t, t, 0.5 * (high - tall)), *np.eye(3)[[1, 2]])
    pressed = solid_parts.drum(0.5 * inner, tall)
    turn = Rotation.from_euler("x", -0.5 * np.pi).as_matrix()  # upright on the floor
    return Case(
        fixed,
        pressed,
        Pose(turn, [t + 0.5 * inner, t, rng.uniform(0.0, 1.0) * high]),
        *np.eye(3)[[1, 2]],
    )


def hole(rng: np.random.Generator) -> Case:
    """A drum or a brick in a blind hole."""
    radius, deep, play = rng.uniform(0.2, 0.4), 0.3, rng.choice([1e-3, 1e-2, 0.2])
    wide = radius + 0.2
    corners = ((0, 0), (radius, 0), (radius, deep), (wide, deep), (wide, -0.2), (0, -0.2))
    fixed = solid_parts.turned_part("hole", corners)
    inner, tall = radius * (1.0 - play), rng.uniform(0.1, 0.6)
    if rng.random() < 0.7:
        pressed = solid_parts.drum(inner, tall)
    else:
        pressed = solid_parts.swept_part("brick", solid_parts.square(inner / np.sqrt(2.0)), tall)
    return Case(fixed, pressed, at(0.0, 0.0, 0.0), *np.eye(3)[[2, 0]])


def shoulder(rng: np.random.Generator) -> Case:
    """A tube on a shaft, pressed against a shoulder."""
    radius, play = rng.uniform(0.15, 0.3), rng.choice([1e-3, 1e-2, 0.2])
    fixed = solid_parts.bolt(radius, 2.0 * radius, 0.6, 0.8, "shaft")
    inner, wide, tall = radius * (1.0 + play), 1.8 * radius, rng.uniform(0.1, 0.4)
    corners = ((inner, 0.0), (wide, 0.0), (wide, tall), (inner, tall))
    pressed = solid_parts.turned_part("tube", corners)
    return Case(fixed, pressed, at(0.0, 0.0, 0.6 - tall), -np.eye(3)[2], np.eye(3)[0])


CASES = (angle, channel, hole, shoulder)


def at(*place: float) -> Pose:
    return Pose(np.eye(3), place)


def falling(
    case: Case, a: Solid, b: Solid, rng: np.random.Generator
) -> tuple[Operator, SystemState]:
    """B a little way out of the corner, drawn into it and to one side."""
    tilt = rng.choice(TILTS) * rng.normal(size=3)
    spin = 0.1 * rng.normal(size=3)
    pull = rng.uniform(-0.3, 0.3) * np.cross(case.along, case.out) - case.out
    mass = mass_properties(b, 1.0)
    law = HuntCrossley(
        stiffness=mass.mass / DEPTH**1.5,
        damping=0.5,
        friction=rng.choice([0.0, 0.2]),
        slip_speed=0.05,
        depth=DEPTH,
    )
    for share in (1.0, 0.1, 0.01, 0.0):  # there may be no room for the whole tilt
        pose = tilted(case, mass.centre, share * tilt)
        still = np.cross(pose.rotation @ mass.centre, spin)
        free = RigidBody.free(b, density=1.0, pose=pose, twist=Twist(still, spin))
        operator = with_step(System([RigidBody.fixed(a), free], law, gravity=pull))
        try:
            return operator, operator.start()
        except StandoffError:
            if share == 0.0:
                raise
    raise AssertionError


def tilted(case: Case, centre: Array, by: Array) -> Pose:
    """Out of the corner, and turned about the middle."""
    turn = Rotation.from_rotvec(by).as_matrix()
    middle = case.fits.rotation @ centre
    where = case.fits.translation + middle - turn @ middle + FROM * case.out
    return Pose(turn @ case.fits.rotation, where)


def judged_press(number: int, seed: int, ticks: int) -> tuple[Verdict, list[str]]:
    """A simulation, and its faults' lines."""
    rng = np.random.default_rng([seed, number, 9])
    case = CASES[number % len(CASES)](rng)
    a, b = (Solid(part.boundary) for part in case[:2])
    spots = samples(case.fixed.truth), samples(case.pressed.truth)
    operator, state = falling(case, a, b, rng)
    verdict, lines = Verdict(), []
    for first in range(0, ticks, STRETCH):
        begun = time.perf_counter()
        state = operator.run(state, STRETCH, STRETCH).final
        seconds = time.perf_counter() - begun
        deep = deepest(case, spots, state.pose(0), state.pose(1))
        wrong = faults_of(state.contact(0), deep)
        verdict = verdict.plus(
            Verdict(STRETCH, 0, 0, 1, int(deep > 0.0), int(bool(wrong)), seconds)
        )
        where = f"seed {seed}, block {number}, {a.name}, {b.name}, tick {first + STRETCH}"
        lines += [f"{where}: {fault}" for fault in wrong]
        if deep > DEEPEST * DEPTH:
            break
    told = Verdict(uncertified=state.uncertified, jumps=state.jumps)
    return verdict.plus(told), lines


def deepest(case: Case, spots: tuple[Array, Array], a: Pose, b: Pose) -> float:
    """How deep the deepest sampled point of either boundary is in the other solid."""
    deep = 0.0
    for own, other, points, truth in (
        (a, b, spots[0], case.pressed.truth),
        (b, a, spots[1], case.fixed.truth),
    ):
        world = points @ own.rotation.T + own.translation
        seen = (world - other.translation) @ other.rotation
        deep = max(deep, -float(signed(truth, seen).min()))
    return deep


def faults_of(contact: SolidContact, deep: float) -> list[str]:
    """What is wrong of a contact in which a point is as deep as that."""
    told: Any = max((spot.depth for spot in contact.spots), default=0.0)
    faults = []
    if deep > SHALLOW * DEPTH and contact.complete and told < TOLD_HALF * deep:
        faults.append(f"a point is {deep!r} deep, and what pushes {told!r}")
    if deep > DEEPEST * DEPTH:
        faults.append(f"a point is {deep!r} deep")
    return faults


def main() -> int:
    """Read the options, run, and tell; 1 if anything was wrong."""
    parser = blocks.options(__doc__, "ticks", 1_000_000, BLOCK)
    given = parser.parse_args()
    verdict = blocks.run(given, BLOCK, partial(judged_press, seed=given.seed, ticks=BLOCK))
    return 0 if verdict is None or verdict.sound else 1


if __name__ == "__main__":
    raise SystemExit(main())
