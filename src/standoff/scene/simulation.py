"""Scenes of simulations: bodies with mass, their contacts, and the operator that moves them."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, get_args

import numpy as np

from standoff.bodies.body import Body
from standoff.errors import StandoffError
from standoff.kernels.dynamics.operator import METHODS
from standoff.motion import Pose, Twist
from standoff.motion.twist import Frame
from standoff.progress import Progress
from standoff.recording.tolerances import WHOLE_STEPS
from standoff.scene.devices import Coupled, read_coupled
from standoff.scene.errors import SceneError
from standoff.scene.file_content import SIMULATION_KEYS, FileContent, named, read_content
from standoff.scene.motions import read_motion
from standoff.scene.reader import SceneTable
from standoff.simulation.contact import HuntCrossley
from standoff.simulation.operator import SIDES, Operator
from standoff.simulation.pair_laws import BESIDE
from standoff.simulation.rigid_body import FREE, RigidBody
from standoff.simulation.simulated_device import SimulatedDevice
from standoff.simulation.system import EARTH, System
from standoff.simulation.system_run import SystemRun
from standoff.solids.spatial.solid_model import SolidModel
from standoff.world import Compound

FREE_KEYS = ("density", "mass", "inertia", "centre", "linear", "angular", "frame")
CONTACT_KEYS = ("stiffness", "damping", "friction", "slip_speed", "depth")
SETTINGS = (
    "step",
    "duration",
    "start",
    "every",
    "method",
    "tracker",
    "gain",
    "gravity",
    "allow_overlap",
    "within",
)


@dataclass(frozen=True, eq=False)
class SimulationScene:
    """What a simulation's file says, checked and built.

    Attributes
    ----------
    file : Path
    text : str
        Its content.
    title : str
    length_unit : str
        Label of lengths; no number is converted.
    names : tuple of str
        Of the bodies, in the order of the system's.
    operator : Operator
    start : float
        Time of the first tick on the clock of the motions [s].
    ticks : int
    every : int
        Ticks from one record to the next.
    allow_overlap : bool
    device : SimulatedDevice or None
        What moves the handle of the system's coupler, where it has one.
    """

    file: Path
    text: str
    title: str
    length_unit: str
    names: tuple[str, ...]
    operator: Operator
    start: float
    ticks: int
    every: int
    allow_overlap: bool
    device: SimulatedDevice | None = None

    @property
    def system(self) -> System:
        """The bodies, their pairs and contacts."""
        return self.operator.system

    def run(self, progress: Progress | None = None, *, contacts: bool = False) -> SystemRun:
        """Simulate, with the scene's device if there is one.

        Raises SceneError: what the operator refuses: bodies that overlap, a motion that left all
        bounds.

        Parameters
        ----------
        progress : callable, optional
            Called now and then with the ticks done and the ticks in all.
        contacts : bool
            Keep all contacts of each record.
        """
        given: dict[str, Any] = {"progress": progress, "contacts": contacts}
        operator, count = self.operator, (self.ticks, self.every)
        try:
            state = operator.start(self.start, allow_overlap=self.allow_overlap)
            if self.device is None:
                return operator.run(state, *count, **given)
            with self.device as device:
                return operator.run(state.engage(), *count, device=device, **given)
        except StandoffError as error:
            raise SceneError(str(error), key="simulate", file=self.file) from error

    def pair_name(self, pair: int) -> str:
        """Return the names of a pair's bodies, with a hyphen."""
        a, b = self.system.pairs[pair]
        return f"{self.names[a]}-{self.names[b]}"


def load_simulation(
    file: str | os.PathLike[str],
    given: Mapping[str, object] | None = None,
    *,
    rate: float | None = None,
) -> SimulationScene:
    """Read, check and build the scene of a simulation.

    Raises SceneError if anything in it is unknown, missing, of the wrong type or shape, or refused
    by what it describes. The message names the file, the key and the fix.

    Parameters
    ----------
    file : str or path
        A TOML file; docs/simulation.md describes the format.
    given : mapping, optional
        Values that replace those of ``[simulate]``; None replaces nothing.
    rate : float, optional
        Readings a second of the coupler's device, in place of the file's; the step becomes the
        longest that is not above the file's and fits into their period.
    """
    content = read_content(file, SIMULATION_KEYS, _refuse_pair)
    top, bodies = content.top, content.bodies
    rigid = _rigid_bodies(content)
    settings = _settings(top, given or {})
    period = None if rate is None else 1.0 / rate
    if period is not None:
        steps = math.ceil(period / settings.positive("step") - WHOLE_STEPS)
        settings = settings.replaced({"step": period / max(1, steps)})
    free = [name for name, body in zip(bodies, rigid, strict=True) if body.kind == FREE]
    coupled = read_coupled(top, free, period)
    system = _system(top, tuple(bodies), rigid, settings, coupled)
    step, duration = settings.positive("step"), settings.positive("duration")
    operator = settings.build(lambda: _operator(system, step, settings))
    every = _every(settings, operator.ticks_a_reading)
    ticks = every * max(1, math.ceil(duration / step / every - WHOLE_STEPS))
    overlap = settings.true_or_false("allow_overlap") if "allow_overlap" in settings else False
    return SimulationScene(
        file=content.file,
        text=content.text,
        title=content.title,
        length_unit=content.length_unit,
        names=tuple(bodies),
        operator=operator,
        start=settings.number("start", 0.0),
        ticks=ticks,
        every=every,
        allow_overlap=overlap,
        device=None if coupled is None else coupled.device,
    )


def _refuse_pair(top: SceneTable) -> None:
    """Name the commands for a file of the other kind, if that is what it is."""
    for key in ("pair", "pairs"):
        if key in top and "simulate" not in top:
            raise top.error(
                "this is the scene of a pair: `standoff track` runs it and `standoff view` shows "
                f"it; the scene of a simulation has no [{key}]",
                key,
            )


def _every(settings: SceneTable, ticks_a_reading: int) -> int:
    """Ticks per record: whole readings if a device is read."""
    every = settings.count("every", ticks_a_reading)
    if every % ticks_a_reading:
        raise settings.error(
            f"must be a multiple of {ticks_a_reading}, the steps in a period of the device, got "
            f"{every}",
            "every",
        )
    return every


def _settings(top: SceneTable, given: Mapping[str, object]) -> SceneTable:
    """The table ``[simulate]``, with what was given in place of its values."""
    table = top.table("simulate")
    table.expect(*SETTINGS)
    over = {name: value for name, value in given.items() if value is not None}
    return table.replaced(over)


def _operator(system: System, step: float, settings: SceneTable) -> Operator:
    method = settings.choice("method", list(METHODS), "semi-implicit")
    tracker = settings.choice("tracker", list(SIDES), "beside")
    gain = settings.positive("gain") if "gain" in settings else None
    law = None
    if "within" in settings:
        if tracker == "inside":
            raise settings.error(
                "a tracker inside the operator is integrated in every tick: a horizon goes with "
                "tracker = 'beside'",
                "within",
            )
        law = replace(BESIDE, within=settings.positive("within"))
    return Operator(system, step, method, tracker, gain, law)


def _rigid_bodies(content: FileContent) -> list[RigidBody]:
    motions = content.motions
    free = named(content.top, "free", lambda table: table, content.bodies)
    found = []
    for name, body in content.bodies.items():
        if isinstance(body, Compound):
            raise content.top.error(
                "has several pieces, and the simulator moves single bodies; write each piece as a "
                "body, or use the scene with `standoff clearance`",
                f"bodies.{name}",
            )
        placement = content.placements.get(name)
        if name in free and name in motions:
            raise free[name].error(
                "a body that is free has no motion of its own; remove one of them"
            )
        if name in free:
            found.append(_free(free[name], body, placement or Pose.identity()))
        elif name in motions:
            motion = read_motion(motions[name], placement)
            found.append(motions[name].build(partial(RigidBody.driven, body, motion.path)))
        else:
            found.append(RigidBody.fixed(body, placement))
    return found


def _free(table: SceneTable, body: Body | SolidModel, pose: Pose) -> RigidBody:
    table.expect(*FREE_KEYS)
    if table.only_one(("density", "mass")) is None:
        table.required("density", "density = 1000.0 (or mass = 1.0)")
    density = table.positive("density") if "density" in table else None
    mass = table.positive("mass") if "mass" in table else None
    inertia = table.matrix("inertia", ((3, 3),)) if "inertia" in table else None
    centre = table.vector("centre", 3) if "centre" in table else None
    linear = table.vector("linear", 3) if "linear" in table else np.zeros(3)
    angular = table.vector("angular", 3) if "angular" in table else np.zeros(3)
    frame: Any = table.choice("frame", list(get_args(Frame)), "world")
    twist = Twist(linear, angular, frame)
    return table.build(
        lambda: RigidBody.free(
            body, density=density, mass=mass, inertia=inertia, centre=centre, pose=pose, twist=twist
        )
    )


def _contact(table: SceneTable) -> HuntCrossley:
    given = {
        "stiffness": table.positive("stiffness", example="stiffness = 1e6"),
        "damping": table.not_negative("damping", 0.0),
        "friction": table.not_negative("friction", 0.0),
        "slip_speed": table.not_negative("slip_speed", 0.0),
    }
    depth = table.positive("depth") if "depth" in table else None
    return table.build(lambda: HuntCrossley(**given, depth=depth))


def _system(
    top: SceneTable,
    names: tuple[str, ...],
    rigid: list[RigidBody],
    settings: SceneTable,
    coupled: Coupled | None,
) -> System:
    """The system, its contacts those of ``[contact]``, but for the pairs of ``[[contacts]]``."""
    gravity = settings.vector("gravity", 3) if "gravity" in settings else np.array(EARTH)
    pairs = [
        (i, j)
        for i in range(len(names))
        for j in range(i + 1, len(names))
        if FREE in (rigid[i].kind, rigid[j].kind)
    ]
    usual = None
    if "contact" in top:
        table = top.table("contact")
        table.expect(*CONTACT_KEYS)
        usual = _contact(table)
    own: dict[tuple[int, int], HuntCrossley] = {}
    for entry in top.tables("contacts") if "contacts" in top else []:
        entry.expect("a", "b", *CONTACT_KEYS)
        i, j = sorted(names.index(entry.choice(key, list(names))) for key in ("a", "b"))
        if (i, j) not in pairs or (i, j) in own:
            raise entry.error("names a pair twice, one body twice, or a pair without a free body")
        own[i, j] = _contact(entry)
    if usual is None:
        pairs = [pair for pair in pairs if pair in own]
    contacts = [own.get(pair, usual) for pair in pairs]
    known = [contact for contact in contacts if contact is not None]
    coupler = None if coupled is None else coupled.coupler
    tool = None if coupled is None else names.index(coupled.tool)
    return top.build(lambda: System(rigid, known, pairs, gravity, coupler, tool))
