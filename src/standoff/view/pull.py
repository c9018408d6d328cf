"""A body pulled through the virtual coupler: the handle of the page is that of a haptic device."""

from __future__ import annotations

import numpy as np

from standoff import simulation as sim
from standoff.errors import StandoffError
from standoff.motion import ConstantTwist, Pose, Twist
from standoff.typing import Array
from standoff.view.live_pair import LivePair
from standoff.view.tolerances import TICK

MOST_TICKS = 100
"""Ticks between two looks at most: after a pause the tool does not leap."""

MASS = 0.2
"""Of the tool [kg]: that of a pen with its holder."""

STIFFNESS = 200.0
"""Of the coupler [N/m]: a handle a few centimetres off pulls with a few newtons."""

MAX_FORCE = 10.0
"""Greatest force when a page begins [N]; a page can lower it, and never raise it."""

LEAST_FORCE = 0.5
"""To which a page can lower it [N]."""

DEPTH = 0.01
"""Depth over the tool's size at which the contact is as stiff as the tick allows."""

STIFF_SHARE = 0.01
"""The contact's stiffness there, over mass / tick²: a tool that is struck at its end turns, and
resists with a small part of its mass."""


class Pull:
    """A dragged body as the tool of a virtual coupler, the other one held fast.

    Raises StandoffError if the bodies cannot be simulated, as planar ones or a tool without end.

    Parameters
    ----------
    pair : LivePair
        Where the bodies are.
    number : int
        Of the body that is the tool: 0 of A, 1 of B.
    size : float
        Of the tool [length]; lengths count as metres here.
    max_force : float
        [N]

    Attributes
    ----------
    force : (3,) array
        On the tool, world axes [N].
    fault : str
        Why the coupler let go; empty while it has not.
    """

    def __init__(self, pair: LivePair, number: int, size: float, max_force: float) -> None:
        if any(body.dimension == 2 for body in pair.bodies):
            raise StandoffError("A coupler pulls bodies in space: this pair is in the plane.")
        self.number, self.max_force = number, max_force
        self._pair, self._size, self._handle = pair, size, pair.poses[number]
        self._sequence = 0
        self._operator = self._loop()
        self._state = self._operator.start().engage()

    def lower(self, max_force: float) -> None:
        """Begin anew where handle and tool are, with a lower greatest force [N]."""
        self.max_force = min(max_force, self.max_force)
        self._operator = self._loop()
        # A tool that is pressed on the other body overlaps it a little.
        self._state = self._operator.start(allow_overlap=True).engage()
        self._sequence = 0

    def _loop(self) -> sim.Operator:
        tool, size, max_force = self.number, self._size, self.max_force
        bodies, poses = self._pair.bodies, self._pair.poses
        turn = size**2 / 20.0
        free = sim.RigidBody.free(
            bodies[tool], mass=MASS, inertia=MASS * turn * np.eye(3), pose=poses[tool]
        )
        fast = sim.RigidBody.fixed(bodies[1 - tool], pose=poses[1 - tool])
        damping = np.sqrt(STIFFNESS * MASS)
        coupler = sim.VirtualCoupler(
            stiffness=STIFFNESS,
            damping=damping,
            rotational_stiffness=STIFFNESS * turn,
            rotational_damping=damping * turn,
            max_force=max_force,
            max_torque=0.5 * max_force * size,
            max_age=1.0,
        )
        depth = DEPTH * size
        contact = sim.HuntCrossley(
            stiffness=STIFF_SHARE * MASS / TICK**2 / (1.5 * np.sqrt(depth)),
            damping=1.0,
            friction=0.2,
            slip_speed=0.2 * size,
            depth=depth,
        )
        system = sim.System([fast, free], contact, gravity=[0, 0, 0], coupler=coupler, tool=1)
        return sim.Operator(system, dt=TICK)

    def step(self, handle: Pose, elapsed: float) -> Pose:
        """Carry the handle to a pose, and return where the tool is then.

        Raises StandoffError: what the simulation refuses.

        Parameters
        ----------
        handle : Pose
        elapsed : float
            Time that this takes [s].
        """
        ticks = int(np.clip(round(elapsed / TICK), 1, MOST_TICKS))
        path = ConstantTwist(self._handle, Twist.between(self._handle, handle, ticks * TICK))
        readings = []
        for k in range(1, ticks + 1):
            self._sequence += 1
            at = k * TICK
            time = self._sequence * TICK
            readings.append(sim.DeviceReading(time, self._sequence, path.pose(at), path.twist(at)))
        run = self._operator.run(self._state, ticks, ticks, device=sim.DeviceReadings(readings))
        self._state, self._handle = run.final, handle
        return Pose.of(self._state.pose(1))

    @property
    def force(self) -> Array:
        """On the tool, world axes (3,) [N]."""
        coupler = self._state.coupler
        return np.zeros(3) if coupler is None else np.asarray(coupler.wrench_on_tool.force)

    @property
    def fault(self) -> str:
        """Why the coupler let go; empty while it has not."""
        coupler = self._state.coupler
        return "" if coupler is None or coupler.engaged else coupler.fault.advice
