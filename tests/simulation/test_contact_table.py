"""Every kind of body on every kind of floor, in every motion, against closed forms.

The simulator treats pairs apart by what touches: points of smooth faces, tips of polytopes on a
half-space (swept or not), edges, rulings, faces and rims that lie on each other, solids' places. A
motion's closed form knows of a body its mass, its moments, at which height its centre is, how many
springs carry it, and how far from the middle they are.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from itertools import product
from typing import Any, Final, NamedTuple

import numpy as np
import pytest

import standoff as so
from shares import only
from standoff import simulation as sim
from standoff.solids import Solid

G: Final = 9.81
MU: Final = 0.4
SLOPE: Final = 0.2
DT: Final = 2e-5
LAW: Final = sim.HuntCrossley(stiffness=1e7, damping=1.0, friction=MU, slip_speed=1e-3, depth=1e-3)
HEXAGON: Final = [
    (0.1 * np.cos(a), 0.1 * np.sin(a), z) for a in np.arange(6) * np.pi / 3 for z in (-0.05, 0.05)
]
LYING: Final = so.Pose.exp([np.pi / 2, 0.0, 0.0]).rotation
STANDING: Final = np.eye(3)


class Kind(NamedTuple):
    """A body and how it lies: how many springs carry it, on a half-space and on others, how far
    from its middle they push, and whether it rolls along x."""

    make: Callable[[], so.Body]
    turn: np.ndarray
    springs: tuple[float, float]
    reach: float
    round: bool


# A segment's two ends have a spring each, a face's corners four together; on a half-space each
# corner of a polytope has its own.
KINDS: Final = {
    "sphere": Kind(lambda: so.shapes.sphere(0.1), STANDING, (1, 1), 0.0, True),
    "ellipsoid": Kind(lambda: so.shapes.ellipsoid(0.1, 0.15, 0.1), STANDING, (1, 1), 0.0, True),
    "superellipsoid": Kind(
        lambda: so.shapes.superellipsoid(0.1, 0.1, 0.08, 0.9, 1.0), STANDING, (1, 1), 0.0, False
    ),
    "capsule": Kind(lambda: so.shapes.capsule(0.1, 0.2), LYING, (2, 2), 0.1, True),
    "cylinder": Kind(lambda: so.shapes.cylinder(0.1, 0.2), LYING, (2, 2), 0.1, True),
    "rounded cylinder": Kind(
        lambda: so.shapes.cylinder(0.06, 0.2, rounding=0.04), LYING, (2, 2), 0.1, True
    ),
    "standing cylinder": Kind(lambda: so.shapes.cylinder(0.1, 0.1), STANDING, (4, 4), 0.1, False),
    "standing rounded cylinder": Kind(
        lambda: so.shapes.cylinder(0.1, 0.1, rounding=0.02), STANDING, (4, 4), 0.1, False
    ),
    "cone": Kind(lambda: so.shapes.cone(0.1, 0.1), STANDING, (4, 4), 0.1, False),
    "box": Kind(
        lambda: so.shapes.box((0.2, 0.2, 0.1)), STANDING, (4, 4), 0.1 * np.sqrt(2.0), False
    ),
    "rounded box": Kind(
        lambda: so.shapes.rounded_polytope(
            [(x, y, z) for x in (-0.1, 0.1) for y in (-0.1, 0.1) for z in (-0.05, 0.05)], 0.02
        ),
        STANDING,
        (4, 4),
        0.08 * np.sqrt(2.0),
        False,
    ),
    "hull": Kind(lambda: so.shapes.polytope(HEXAGON), STANDING, (6, 4), 0.1, False),
    "rounded hull": Kind(
        lambda: so.shapes.polytope(HEXAGON, rounding=0.02), STANDING, (6, 4), 0.1, False
    ),
}
FLOORS: Final = ("half-space", "box", "solid")
MOTIONS: Final = ("rest", "drop", "slide", "spin", "roll")
WITHIN: Final = {"rest": 2e-3, "drop": 2e-3, "slide": 5e-3, "spin": 5e-3, "roll": 5e-3}
"""Relative. Friction is regularised, and a step has the order one: what is held over it differs by
this from what the closed forms have."""
ALONG_A_LINE: Final = ("capsule", "rounded cylinder")
"""As a solid, which touches at one place where smooth faces meet all along a line: it has one
spring there, and friction does not slow its spin."""
SHARING: Final = ("standing cylinder", "standing rounded cylinder", "cone", "rounded hull")
"""As a solid, whose springs are as many as its spots share in a tick (`Energy.shared`)."""
WITHIN_SHARED: Final = {"rest": 1e-2, "drop": 0.05, "spin": 0.07}
"""Relative, of those: the spots are not quite where the closed forms have them."""


@cache
def made(kind: str, floor: str) -> tuple[Any, Any, float]:
    """The body, the floor below z = 0, and how high the body's origin lies on it."""
    body = KINDS[kind].make()
    ground = so.shapes.halfspace()
    apart = so.distance(ground, body, so.Pose.identity(), so.Pose(KINDS[kind].turn, [0, 0, 1.0]))
    if floor == "half-space":
        return body, ground, 1.0 - apart.distance
    block = so.shapes.polytope(
        [(x, y, z) for x in (-2.0, 2.0) for y in (-2.0, 2.0) for z in (-0.2, 0.0)]
    )
    wrap: Any = Solid if floor == "solid" else (lambda body: body)
    return wrap(body), wrap(block), 1.0 - apart.distance


def springs_of(kind: str, floor: str) -> float:
    """How many carry it, about, where spots share them."""
    if floor == "solid" and kind in ALONG_A_LINE:
        return 1.0
    n = KINDS[kind].springs[floor != "half-space"]
    return min(n, 4.0) if floor == "solid" else n


def run_of(
    kind: str, floor: str, time: float, gravity: Any, lift: float = 0.0, **twist: Any
) -> tuple[sim.SystemRun, sim.MassProperties]:
    """A body that lies as deep as its weight presses it, or hangs `lift` above the floor."""
    body, ground, height = made(kind, floor)
    free = sim.RigidBody.free(body, density=1000.0)
    mass = free.mass_properties
    assert mass is not None
    weight = -mass.mass * gravity[2]
    sunk = (weight / (springs_of(kind, floor) * LAW.stiffness)) ** (2.0 / 3.0)
    pose = so.Pose(KINDS[kind].turn, [0.0, 0.0, height + lift - sunk])
    v, w = twist.get("v", np.zeros(3)), twist.get("w", np.zeros(3))
    free = sim.RigidBody.free(body, density=1000.0, pose=pose, twist=so.Twist(v, w))
    system = sim.System([sim.RigidBody.fixed(ground), free], LAW, gravity=gravity)
    operator = sim.Operator(system, DT)
    ticks = round(time / DT)
    return operator.run(operator.start(allow_overlap=True), ticks, every=ticks), mass


def about(kind: str, mass: sim.MassProperties, axis: int) -> float:
    """The body's moment about an axis of the world through its centre."""
    R = KINDS[kind].turn
    return float((R @ mass.inertia @ R.T)[axis, axis])


def rest(kind: str, floor: str) -> float:
    """It stays where n springs carry it."""
    run, mass = run_of(kind, floor, 0.2, [0.0, 0.0, -G])
    weight = mass.mass * G
    if floor == "solid" and kind in SHARING:  # on the whole
        return float(abs(run.velocities(1)[-1, 2]) / (G * 0.2))
    off = abs(run.forces[-1, 0, 2] / weight - 1.0)
    deep = (weight / (springs_of(kind, floor) * 1e7)) ** (2.0 / 3.0)
    return float(max(off, abs(-run.distances[-1, 0] / deep - 1.0)))


def drop(kind: str, floor: str) -> float:
    """It leaves the floor as its restitution says, whatever springs push it."""
    run, _ = run_of(kind, floor, 0.03, np.zeros(3), 1e-4, v=[0.0, 0.0, -0.5])
    return float(abs(run.velocities(1)[-1, 2] / (0.5 * LAW.restitution(0.5)) - 1.0))


def slide(kind: str, floor: str) -> float:
    """It slows by mu times what presses it, and turns by what that turns it, if it is round."""
    time, speed = 0.05, 1.0
    run, mass = run_of(kind, floor, time, [0.0, 0.0, -G], v=[speed, 0.0, 0.0])
    # all that pressed it: its weight, and what moves its centre up
    lost = MU * (G * time + run.velocities(1)[-1, 2])
    off = abs((speed - run.velocities(1)[-1, 0]) / lost - 1.0)
    if KINDS[kind].round:
        height = made(kind, floor)[2]
        turned = mass.mass * lost * height / about(kind, mass, 1)
        off = max(off, abs(run.angular_velocities(1)[-1, 1] / turned - 1.0))
    return float(off)


def spin(kind: str, floor: str) -> float:
    """Friction of spots all round slows it; at a point nothing does."""
    time, rate = 0.05, 10.0
    run, mass = run_of(kind, floor, time, [0.0, 0.0, -G], w=[0.0, 0.0, rate])
    reach = 0.0 if floor == "solid" and kind in ALONG_A_LINE else KINDS[kind].reach
    slowed = MU * mass.mass * G * reach * time / about(kind, mass, 2)
    off = abs(run.angular_velocities(1)[-1, 2] - (rate - slowed))
    return float(off / max(slowed, 0.1 * rate))


def roll(kind: str, floor: str) -> float:
    """It rolls down a slope."""
    time = 0.2
    down = [G * np.sin(SLOPE), 0.0, -G * np.cos(SLOPE)]
    run, mass = run_of(kind, floor, time, down)
    height = made(kind, floor)[2]
    k = about(kind, mass, 1) / (mass.mass * height**2)
    return float(abs(run.velocities(1)[-1, 0] / (G * np.sin(SLOPE) / (1.0 + k) * time) - 1.0))


OFF: Final[dict[str, Callable[[str, str], float]]] = {
    "rest": rest,
    "drop": drop,
    "slide": slide,
    "spin": spin,
    "roll": roll,
}


def cases() -> list[tuple[str, str, str]]:
    every = product(KINDS, FLOORS, MOTIONS)
    return [each for each in every if KINDS[each[0]].round or each[2] != "roll"]


def always() -> list[tuple[str, str, str]]:
    """Those of every run: some of convex bodies, and two of solids, whose ticks take long."""
    convex = [each for each in cases() if each[1] != "solid"]
    return [*convex[::6], ("sphere", "solid", "roll"), ("box", "solid", "spin")]


@pytest.mark.parametrize("case", only(always(), cases()), ids=" - ".join)
def test_a_motion_is_that_of_its_closed_form(case: tuple[str, str, str]) -> None:
    kind, floor, motion = case
    shared = floor == "solid" and kind in SHARING
    within = {**WITHIN, **WITHIN_SHARED} if shared else WITHIN
    assert OFF[motion](kind, floor) < within[motion]
