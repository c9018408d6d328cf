"""The run for Fig. 5: a scripted hand drags a ball over the lens through device and coupler."""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.interpolate import CubicSpline

import standoff as so
from standoff import simulation as sim
from standoff.bodies import Body, shapes
from standoff.motion import Pose
from standoff.tracking.rows import AnswerRows
from standoff.typing import Array
from standoff_studies.paper.bodies import lens_of_patches

RADIUS, OFFSET = 0.05, 0.0225
"""Radius of the lens's balls, and offset of their centres [m]: simulation D's, to be held."""

BALL = 0.01
"""Radius of the ball that the hand drags: the tool [m]."""

MASS = 0.2
"""Mass of the tool [kg]."""

PERIOD = 1e-3
"""Step of device, coupler and operator [s]: the paper's 1 kHz."""

DURATION = 5.0
"""Duration of the run [s]."""

GAIN = 100.0
"""K of the law inside [1/s]."""

GAINS = (25.0, 100.0, 1000.0)
"""K of the law inside, tried [1/s]."""

METHOD = "heun"
"""Advances bodies and parameters together; the order of the paper's own integrator."""

CONTACT = sim.HuntCrossley(stiffness=2e5, damping=20.0, friction=0.1, slip_speed=0.05, depth=6e-4)
"""Contact of tool and lens [N/m^1.5, s/m, m/s, m]."""

DEVICE = sim.Mechanism(mass=0.1, damping=1.2, rotational_damping=2e-3)
COUNT = 1e-5
"""One count of the device's encoders [m]."""

PRESS, LIFT = 4e-3, 8e-3
"""How deep the hand aims inside the surface, and how far away it is at both ends [m]."""

WAY = ((5.0, 25.0), (35.0, 25.0), (75.0, 28.0), (95.0, 45.0), (118.0, 88.0), (300.0, 65.0))
WAY_DOWN = ((300.0, 40.0), (300.0, 20.0))
"""Azimuth and elevation [degrees] of the hand's path around the lens: over face 0, across an edge
to face 1, up to the vertex, and down along the edge beyond it."""

OUTSIDE = 3.0
"""Distance of the path from the middle [radii]; the hand's path is next to the lens below it."""

FINE = 1500
"""Points of that path from which the hand's path is made."""


@dataclass(frozen=True, eq=False)
class Runs:
    """The data of the figure.

    Attributes
    ----------
    lens : Body
    operator : Operator
        That of `inside`.
    inside : SystemRun
        With the law inside the operator, at `GAIN`.
    beside : SystemRun
        The same scene with a separate, certified tracker.
    microseconds : dict of str to float
        Time per tick without Python, by where the tracker is.
    exact : ndarray, shape (n,)
        Certified distances at the poses of `inside` [m].
    """

    lens: Body
    operator: sim.Operator
    inside: sim.SystemRun
    beside: sim.SystemRun
    microseconds: dict[str, float]
    exact: Array

    @property
    def coupler(self) -> sim.CouplerRun:
        """The coupler of the run with the law inside."""
        found = self.inside.coupler
        assert found is not None
        return found

    @property
    def answers(self) -> AnswerRows:
        """The law's own answers."""
        return self.inside.answers(0)


@cache
def lens() -> Body:
    """Return the lens of three patches: three faces, three edges and two vertices."""
    return lens_of_patches(RADIUS, OFFSET)


@cache
def hand_way() -> CubicSpline:
    """Return the intended position of the hand, (3,) [m] by time [s]."""
    corners = np.radians(np.array([*WAY, *WAY_DOWN]))
    ends = np.array([[np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)] for a, e in corners])
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(ends, axis=0), axis=1))])
    directions = CubicSpline(arc, ends)(np.linspace(0.0, arc[-1], FINE))
    point, home = shapes.point(), Pose.identity()
    places = []
    for k, direction in enumerate(directions):
        off = OUTSIDE * RADIUS * direction / np.linalg.norm(direction)
        foot = so.distance(lens(), point, home, Pose(np.eye(3), off)).point_a
        normal = (off - foot) / np.linalg.norm(off - foot)
        places.append(foot + (BALL + _height(k / (FINE - 1))) * normal)
    way = np.array(places)
    # uniform steps on the path, with rest at both ends
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(way, axis=0), axis=1))])
    part = np.linspace(0.0, 1.0, FINE)
    at = np.array([np.interp(_eased(s) * arc[-1], arc, x) for s in part for x in way.T])
    return CubicSpline(DURATION * part, at.reshape(FINE, 3), bc_type="clamped")


def _height(s: float) -> float:
    """Intended distance of the hand from the lens, by the fraction of its path [m]."""
    into = min(1.0, s / 0.12, (1.0 - s) / 0.12)
    return LIFT - (LIFT + PRESS) * _smooth(into)


def _smooth(s: float) -> float:
    return s * s * (3.0 - 2.0 * s)


def _eased(s: float) -> float:
    """From 0 to 1 at constant speed, except for a tenth of the time at each end."""
    ramp = 0.1
    ends = ramp * _half(min(s, 1.0 - s) / ramp) if min(s, 1.0 - s) < ramp else None
    whole = 1.0 - ramp
    if ends is None:
        return (s - 0.5 * ramp) / whole
    return ends / whole if s < 0.5 else 1.0 - ends / whole


def _half(x: float) -> float:
    """The distance covered with a speed that rises smoothly from 0 to 1."""
    return x * x * x - 0.5 * x**4


def hand_pose(t: float) -> Pose:
    """Return the intended pose of the hand."""
    return Pose(np.eye(3), hand_way()(np.clip(t, 0.0, DURATION)))


def device() -> sim.SimulatedDevice:
    """Return the device in a tensed hand, at rest at the start of its path."""
    hand = sim.ScriptedHand(path=hand_pose, arm=sim.HumanArm.tensed())
    return sim.SimulatedDevice(
        DEVICE, hand, period=PERIOD, encoder=sim.Encoder(position_step=COUNT)
    )


def operator(tracker: str = "inside", gain: float | None = GAIN) -> sim.Operator:
    """Return device, coupler, dynamics and tracker as one operator."""
    joined = sim.VirtualCoupler(
        stiffness=800.0,
        damping=0.7,
        rotational_stiffness=0.2,
        rotational_damping=1e-3,
        max_force=15.0,
        max_torque=0.5,
        engage_time=0.0,
        max_age=3.0 * PERIOD,
        sampling=device().sampling,
    )
    tool = sim.RigidBody.free(shapes.sphere(BALL), mass=MASS, pose=hand_pose(0.0))
    system = sim.System(
        [sim.RigidBody.fixed(lens()), tool], CONTACT, gravity=[0, 0, 0], coupler=joined, tool=1
    )
    own = gain if tracker == "inside" else None
    return sim.Operator(system, PERIOD, METHOD, tracker, own)


def dragged(one: sim.Operator) -> sim.SystemRun:
    """Return the run with the device."""
    with device() as held:
        return one.run(one.start().engage(), round(DURATION / PERIOD), device=held)


@cache
def run() -> Runs:
    """Run the scene with the law inside, and with a separate tracker."""
    inside, beside = operator(), operator("beside")
    made = dragged(inside)
    return Runs(
        lens(),
        inside,
        made,
        dragged(beside),
        {one.tracker: _microseconds(one) for one in (inside, beside)},
        exact_distances(made),
    )


def exact_distances(made: sim.SystemRun) -> Array:
    """Return certified distances of lens and tool, searched again at each recorded pose [m]."""
    (_, ball), home = made.system.convex_pair(0), Pose.identity()
    places = zip(made.rotations(1), made.positions(1), strict=True)
    return np.array([so.distance(lens(), ball, home, Pose(R, p)).distance for R, p in places])


def _microseconds(one: sim.Operator) -> float:
    """Time per tick with recorded readings, without Python."""
    given = sim.DeviceReadings.along(hand_pose, round(DURATION / PERIOD), PERIOD)
    state = one.start().engage()
    began = time.perf_counter()
    one.run(state, len(given), len(given), device=given)
    return 1e6 * (time.perf_counter() - began) / len(given)
