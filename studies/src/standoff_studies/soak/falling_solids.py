"""``python -m standoff_studies.soak.falling_solids``: solids that tumble onto a slab, into a corner
and into a bowl, with a soft contact that they go much deeper into than it is meant for.

Block k of a seed is one drop, always the same: a shape and a ground in turn, a random rotation, a
height of a few millimetres. It is judged by samples of closed forms: no point of either boundary
may be deeper in the other solid than all energy of the drop in a single spring explains.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.bodies import Boundary, Face
from standoff.geometry import Plane, Sphere
from standoff.motion import Pose
from standoff.simulation import HuntCrossley, Operator, RigidBody, System
from standoff.solids import distance
from standoff.solids.spatial.solid import Solid
from standoff_studies.soak import blocks, solid_parts
from standoff_studies.soak.solid_corners import Case, at, deepest, samples
from standoff_studies.soak.solid_outlines import Arc, Array, Outline, Segment, polygon
from standoff_studies.soak.solid_parts import Part
from standoff_studies.soak.solid_truth import Turned

STRETCH, TICKS = 100, 8_000
"""Ticks from one sample to the next, and of a drop."""
STEP, STIFFNESS, DEPTH = 5e-5, 1e5, 1e-4
"""Of the contact: s, N/m^1.5, and for how deep it is meant, m."""
MOST_GAINED = 0.01
"""Of a drop's energy: a rise of its balance that is counted."""
CAP = np.radians(70.0)
DENSITY, GRAVITY = 2700.0, 9.81
TURNED_UPRIGHT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])


def _half_ball(radius: float) -> Part:
    """Of 70 degrees from its top, as the chart of a sphere ends before 90."""
    rim, low = radius * np.sin(CAP), radius * np.cos(CAP)
    profile = Outline(
        [Segment(np.array([0.0, low]), np.array([rim, low])),
         Arc(np.zeros(2), radius, 0.5 * np.pi - CAP, 0.5 * np.pi)],
        [Segment(np.array([0.0, radius]), np.array([0.0, low]))],
    )  # fmt: skip
    faces = [
        Face((Plane.through(np.array([0.0, 0.0, low]), *np.eye(3)[:2]),), ((0, 1),)),
        Face((Sphere(radius * np.eye(3), np.zeros(3)),), ((0, 1),)),
    ]
    edges = [solid_parts.circle(rim, low)]
    return Part("half ball", Boundary.from_brep(edges=edges, faces=faces), Turned(profile))


def _cone(radius: float, high: float) -> Part:
    *sides, axis = polygon((0, -0.5 * high), (radius, -0.5 * high), (0, 0.5 * high))
    return Part("cone", so.shapes.cone(radius, high), Turned(Outline(sides, [axis])))


def _bowl(radius: float, wide: float) -> Part:
    """A round block with a hollow of 70 degrees on each side of the axis, open upwards."""
    rim, top = radius * np.sin(CAP), radius * (1.0 - np.cos(CAP))
    points = np.array([[rim, top], [wide, top], [wide, -0.03], [0.0, -0.03]])
    sides = [Segment(p, q) for p, q in pairwise(points)]
    hollow = Arc(np.array([0.0, radius]), radius, -0.5 * np.pi, CAP - 0.5 * np.pi)
    profile = Outline([hollow, *sides], [Segment(points[-1], np.zeros(2))])
    edges = [solid_parts.circle(rho, z) for rho, z in points[:3]]
    down = radius * np.diag([1.0, 1.0, -1.0])
    faces = [Face((Sphere(down, np.array([0.0, 0.0, radius])),), ((0, 1),))]
    for k, piece in enumerate(sides):
        loop = tuple((j, 1) for j in (k, k + 1) if j < len(edges))
        faces.append(Face((solid_parts.quadric(piece.p, piece.q),), loop))
    return Part("bowl", Boundary.from_brep(edges=edges, faces=faces), Turned(profile))


SHAPES = {
    "cube": lambda: solid_parts.brick(0.04, 0.04),
    "L": lambda: solid_parts.bracket(0.04, 0.012, 0.02),
    "cup": lambda: solid_parts.turned_part(
        "cup", ((0, 0), (0.02, 0), (0.02, 0.04), (0.016, 0.04), (0.016, 0.005), (0, 0.005))
    ),
    "cone": lambda: _cone(0.02, 0.04),
    "ring": lambda: solid_parts.turned_part(
        "tube", ((0.012, 0), (0.02, 0), (0.02, 0.01), (0.012, 0.01))
    ),
    "peg": lambda: solid_parts.bolt(0.006, 0.012, 0.03, 0.04, "peg"),
    "half ball": lambda: _half_ball(0.02),
}
GROUNDS = {
    # the part, its pose, and where a shape falls
    "slab": (lambda: solid_parts.brick(0.36, 0.06), at(0, 0, -0.06), (0.0, 0.0)),
    "corner": (
        lambda: solid_parts.bracket(0.2, 0.03, 0.3),
        Pose(TURNED_UPRIGHT, [-0.03, 0.15, -0.03]),
        (0.045, 0.0),
    ),
    "bowl": (lambda: _bowl(0.07, 0.1), at(0, 0, 0), (0.005, 0.0)),
}
SCENES = [(shape, ground) for ground in GROUNDS for shape in SHAPES]


@dataclass(frozen=True)
class Verdict(blocks.Counted):
    """Counts of drops, of those that fell through, of ticks not certified, and of places that ended
    deep; the greatest rise of the energy's balance, of the energy of the drop; and seconds."""

    FAULTS = ("fell",)
    drops: int = 0
    fell: int = 0
    uncertified: int = 0
    jumps: int = 0
    crossings: int = 0
    gained: int = 0
    seconds: float = 0.0

    def __str__(self) -> str:
        return (
            f"{self.drops} drops, {self.seconds:.1f} s; {self.fell} fell through, {self.gained} "
            f"gained more than 1 % of their energy; {self.uncertified} ticks not certified, "
            f"{self.jumps} places ended deep, {self.crossings} may have crossed"
        )


def scene(number: int, seed: int) -> tuple[Case, Operator, float]:
    """Shapes and poses of a drop, its operator, and the energy that it may have at most, J."""
    shape, ground = SCENES[number % len(SCENES)]
    rng = np.random.default_rng([seed, number])
    make, pose, place = GROUNDS[ground]
    case = Case(make(), SHAPES[shape](), pose, *np.eye(3)[[2, 0]])
    a, b = (Solid(part.boundary) for part in case[:2])
    turn = Rotation.random(random_state=rng).as_matrix()
    high = 0.08
    start = Pose(turn, [*place, high])
    free = RigidBody.free(b, density=DENSITY, pose=start)
    mass = free.mass_properties
    assert mass is not None
    # as near as a drop of some millimetres
    centred = start.translation - turn @ mass.centre
    gap = distance(a, b, pose, Pose(turn, centred)).distance
    start = Pose(turn, centred - [0.0, 0.0, gap - rng.uniform(1e-3, 2e-2)])
    free = RigidBody.free(b, density=DENSITY, pose=start)
    law = HuntCrossley(stiffness=STIFFNESS, damping=1.0, friction=0.3, slip_speed=0.02, depth=DEPTH)
    operator = Operator(System([RigidBody.fixed(a, pose), free], law), STEP)
    return case, operator, mass.mass * GRAVITY * 2.0 * high


def deepest_of(energy: float) -> float:
    """How deep a spring is pressed that holds so much energy, m."""
    return float((2.5 * energy / STIFFNESS) ** 0.4)


def judged_drop(number: int, seed: int, ticks: int = TICKS) -> tuple[Verdict, list[str]]:
    """A drop, and its faults' lines."""
    begun = time.perf_counter()
    case, operator, energy = scene(number, seed)
    spots, most = (samples(case.fixed.truth), samples(case.pressed.truth)), deepest_of(energy)
    run = operator.run(operator.start(), ticks, STRETCH)
    deep: list[float] = []
    for row in range(len(run.times)):
        state = run.state(row)
        deep.append(deepest(case, spots, state.pose(0), state.pose(1)))
    balance: Array = run.energy.balance
    gained = float(balance.max() - balance[0]) / energy
    crossed = sum(each.ticks for each in run.crossings)
    told = run.uncertified, run.jumps, crossed, int(gained > MOST_GAINED)
    verdict = Verdict(1, int(max(deep) > most), *told, time.perf_counter() - begun)
    where = f"seed {seed}, block {number}, {' in '.join(SCENES[number % len(SCENES)])}"
    faults = f"{told[0]} not certified, {told[1]} ended deep, energy {gained:+.2%}"
    if verdict.fell:
        return verdict, [f"{where}: a point is {1e3 * max(deep):.2f} mm deep; {faults}"]
    return verdict, [f"{where}: {faults}"] if any(told) else []


def main() -> int:
    """Read the options, run, and tell; 1 if anything fell."""
    given = blocks.options(__doc__, "drops", 3 * len(SCENES), 1).parse_args()
    verdict = blocks.run(given, 1, partial(judged_drop, seed=given.seed))
    return 0 if verdict is None or verdict.sound else 1


if __name__ == "__main__":
    raise SystemExit(main())
