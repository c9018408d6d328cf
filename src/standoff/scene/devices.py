"""From the tables ``[coupler]`` and ``[device]`` to a virtual coupler and a simulated device."""

from __future__ import annotations

from typing import NamedTuple

from standoff.scene.motions import read_motion
from standoff.scene.placements import read_pose
from standoff.scene.reader import SceneTable
from standoff.simulation.coupler import VirtualCoupler
from standoff.simulation.device import DeviceLimits
from standoff.simulation.disturbances import Disturbances
from standoff.simulation.encoder import Encoder
from standoff.simulation.human_arm import HumanArm
from standoff.simulation.passivity_observer import PassivityController
from standoff.simulation.simulated_device import Mechanism, ScriptedHand, SimulatedDevice

ARMS = {
    "none": HumanArm.none,
    "fingertip": HumanArm.fingertip,
    "relaxed": HumanArm.relaxed,
    "tensed": HumanArm.tensed,
}
"""The arms that have names, from soft to stiff."""

MASSES = ("mass", "damping", "rotational_inertia", "rotational_damping")
SPRINGS = ("stiffness", "rotational_stiffness")
ENCODER = ("position_step", "angle_step", "velocity_time_constant")
LIMITS = ("max_force", "max_torque")
DEVICE_KEYS = (
    *MASSES,
    *ENCODER,
    *LIMITS,
    *("period", "delay", "velocities", "arm", "placement", "path", "disturbances"),
)

PLAIN = ("stiffness", "damping", "rotational_stiffness", "rotational_damping", "max_torque")
OPTIONAL = ("max_force_rate", "max_torque_rate", "engage_time")
COUPLER_KEYS = ("tool", *PLAIN, "max_force", *OPTIONAL, "max_age", "controller")
CONTROLLER_KEYS = (
    "max_damping",
    "max_rotational_damping",
    "max_tool_damping",
    "max_tool_rotational_damping",
    "tolerance",
)

READINGS_TO_AGE = 3.0
"""Periods after which a reading is too old, if the coupler does not say its `max_age`."""


class Coupled(NamedTuple):
    """What moves a tool: the coupler, the name of the tool, and the device."""

    coupler: VirtualCoupler
    tool: str
    device: SimulatedDevice


def read_coupled(top: SceneTable, names: list[str], period: float | None = None) -> Coupled | None:
    """Return what ``[coupler]`` and ``[device]`` describe; None where there is neither.

    Raises SceneError: one of the two without the other, an unknown key, or a value that what it
    describes refuses: a stiffness that is not passive too.

    Parameters
    ----------
    top : SceneTable
        The file.
    names : list of str
        Of the free bodies.
    period : float, optional
        Of the device [s], in place of the file's.
    """
    if "coupler" not in top and "device" not in top:
        return None
    table = top.table("device", "[device], which moves the coupler's handle")
    device = _device(table if period is None else table.replaced({"period": period}))
    table = top.table("coupler", "[coupler], which joins the device to a tool")
    table.expect(*COUPLER_KEYS)
    tool = table.choice("tool", names, noun="free body")
    given = {name: table.not_negative(name, 0.0) for name in PLAIN if name in table}
    for name in ("stiffness", "damping"):
        given[name] = table.not_negative(name)
    for name in OPTIONAL:
        if name in table:
            given[name] = table.not_negative(name)
    given["max_force"] = table.positive("max_force", example="max_force = 10.0")
    given["max_age"] = table.positive("max_age", READINGS_TO_AGE * device.sampling.period)
    controller = _controller(table.table("controller")) if "controller" in table else None
    coupler = table.build(
        lambda: VirtualCoupler(**given, sampling=device.sampling, controller=controller)
    )
    return Coupled(coupler, tool, device)


def _controller(table: SceneTable) -> PassivityController:
    table.expect(*CONTROLLER_KEYS)
    given = {name: table.not_negative(name, 0.0) for name in CONTROLLER_KEYS}
    return table.build(lambda: PassivityController(**given))


def _device(table: SceneTable) -> SimulatedDevice:
    table.expect(*DEVICE_KEYS)
    mechanism = table.build(lambda: Mechanism(**_numbers(table, MASSES, ("mass", "damping"))))
    period = table.positive("period", example="period = 1e-3")
    home = read_pose(table.table("placement")) if "placement" in table else None
    hand = None
    if "path" in table:
        path = read_motion(table.table("path"), home).path
        arm = _arm(table)
        hand = table.build(lambda: ScriptedHand(path=path, arm=arm))
    elif "arm" in table:
        raise table.error("an arm needs a path to follow; add [device.path]", "arm")
    velocities = table.true_or_false("velocities") if "velocities" in table else True
    encoder = table.build(lambda: Encoder(velocities=velocities, **_numbers(table, ENCODER)))
    limits = None
    if "max_force" in table or "max_torque" in table:
        given = {name: table.not_negative(name, 0.0) for name in LIMITS}
        limits = DeviceLimits(**given)
    disturbances = _disturbances(table.table("disturbances")) if "disturbances" in table else None
    return table.build(
        lambda: SimulatedDevice(
            mechanism,
            hand,
            period=period,
            pose=home,
            encoder=encoder,
            delay=_whole(table, "delay"),
            limits=limits,
            disturbances=disturbances,
        )
    )


def _arm(table: SceneTable) -> HumanArm:
    """A name, or a table of numbers; a relaxed arm if nothing is said."""
    if "arm" not in table:
        return HumanArm.relaxed()
    if isinstance(table.required("arm", ""), str):
        return ARMS[table.choice("arm", list(ARMS))]()
    numbers = table.table("arm")
    numbers.expect(*MASSES, *SPRINGS)
    given = _numbers(numbers, (*MASSES, *SPRINGS), ("mass", "damping", "stiffness"))
    return numbers.build(lambda: HumanArm(**given))


def _disturbances(table: SceneTable) -> Disturbances:
    table.expect("script", "drop_out", "malformed", "seed")
    script: dict[int, str] = {}
    if "script" in table:
        words = table.table("script")
        for name in words.names():
            if not name.isdecimal():
                raise words.error("must be the number of a reading, from 0", name)
            script[int(name)] = words.text(name)
    chances = {name: table.not_negative(name, 0.0) for name in ("drop_out", "malformed")}
    return table.build(lambda: Disturbances(script=script, seed=_whole(table, "seed"), **chances))


def _whole(table: SceneTable, key: str) -> int:
    """A whole number from 0 on, 0 if nothing is said."""
    return table.count(key, 1) if key in table and table.number(key) != 0.0 else 0


def _numbers(
    table: SceneTable, names: tuple[str, ...], needed: tuple[str, ...] = ()
) -> dict[str, float]:
    """The numbers that are given, zero or above; those that are needed must be."""
    return {name: table.not_negative(name) for name in names if name in table or name in needed}
