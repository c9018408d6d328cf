"""A tool that a hand drags over a lens through a virtual coupler: bodies, device, operator."""

from __future__ import annotations

from typing import Any, NamedTuple

import standoff as so
from standoff import simulation as sim

PERIOD = 1e-3
"""s, of the device."""

RADIUS, REACH = 0.05, 0.01
"""m, of the lens's faces and of the tool."""

MASS = 0.2
"""kg, of the tool."""

LENS = so.shapes.lens(RADIUS, 0.45 * RADIUS)
TOOL = so.shapes.sphere(REACH)
CONTACT = sim.HuntCrossley(stiffness=3e5, damping=0.5, depth=1e-3)
SPRINGLESS = sim.HuntCrossley(stiffness=3e5, depth=1e-3)

VALUES: dict[str, Any] = {
    "stiffness": 800.0,
    "damping": 0.3,
    "rotational_stiffness": 0.2,
    "rotational_damping": 5e-4,
    "max_force": 20.0,
    "max_torque": 1.0,
    "engage_time": 0.0,
    "max_age": 3e-3,
}


OVER = so.motion.Helix(
    radius=0.046,
    pitch=0.0,
    rate=-1.6,
    centre=(-0.0035, 0.001, 0.0),
    axis=(0, 1, 0),
    phase=0.0,
    orientation="fixed",
)
"""Where the hand means to be: from a face over the upper vertex to the edge beyond, 2 s."""


class Scene(NamedTuple):
    """A device, and an operator whose tool it moves."""

    device: sim.SimulatedDevice
    operator: sim.Operator
    state: sim.SystemState


def coupled(
    path: Any = OVER,
    *,
    ticks: int = 1,
    contact: sim.HuntCrossley = CONTACT,
    coupler: Any = sim.VirtualCoupler,
    tracker: str = "beside",
    method: str = "semi-implicit",
) -> Scene:
    """The scene, the tool at the device's home, the coupler engaged."""
    mechanism = sim.Mechanism(mass=0.1, damping=1.0, rotational_damping=2e-3)
    arm = sim.HumanArm.tensed()
    device = sim.SimulatedDevice(mechanism, sim.ScriptedHand(path=path, arm=arm), period=PERIOD)
    joined = coupler(sampling=device.sampling, **VALUES)
    bodies = [sim.RigidBody.fixed(LENS), sim.RigidBody.free(TOOL, mass=MASS, pose=path.pose(0.0))]
    system = sim.System(bodies, contact, gravity=[0, 0, 0], coupler=joined, tool=1)
    operator = sim.Operator(system, PERIOD / ticks, method, tracker)
    return Scene(device, operator, operator.start().engage())


def dragged(scene: Scene, readings: int, **named: Any) -> sim.SystemRun:
    """A run of so many readings of the device, every one recorded."""
    ticks = round(PERIOD / scene.operator.dt)
    with scene.device:
        return scene.operator.run(
            scene.state, readings * ticks, ticks, device=scene.device, **named
        )
