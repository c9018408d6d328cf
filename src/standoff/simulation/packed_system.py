"""A system as the kernels read it, and as its state begins."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.errors import StandoffError
from standoff.kernels.dynamics import arrays as K
from standoff.recording.tolerances import WHOLE_STEPS
from standoff.simulation.flat_parts import pack_flat_parts
from standoff.simulation.near_pairs import NearRows
from standoff.simulation.rigid_body import DRIVEN, FREE, RigidBody
from standoff.simulation.solid_parts import pack_solids, pair_numbers, room_for_rows
from standoff.simulation.system import System, farthest, unseen_depth
from standoff.simulation.system_state import state_length
from standoff.solids.spatial.solid_model import SolidModel
from standoff.typing import Array

KINDS = {"free": K.FREE, "fixed": K.FIXED, "driven": K.DRIVEN}


def pack_system(
    system: System,
    dt: float,
    method: int,
    inside: bool,
    options: Array,
    kept: bool = False,
    near: NearRows | None = None,
) -> Any:
    """(layout, numbers, ints, reals, options, solids), all read-only.

    `options` are those of all pairs; with `kept`, polytopes stand at the end of a state; with
    `near`, ticks search for near pairs.
    """
    tool = -1 if system.tool is None else system.tool
    after = state_length(system)
    solids_at = after if any(system.of_solids) else 0
    polytopes = after + system.kept_starts()[-1] if kept else 0
    layout = [len(system.bodies), len(system.pairs), method, int(inside), tool, 0, 1, polytopes]
    layout += [0, 0, solids_at]  # of the search for near pairs
    numbers = [*system.gravity, dt]
    ints, reals = _convex_arrays(system)
    solids = pack_solids(system.models)
    starts = [np.cumsum([0, *(len(part) for part in parts)]) for parts in (ints, reals)]
    flats_at = K.INT_HEADER + K.INT_BODY * len(system.bodies) + K.INT_PAIR * len(system.pairs)
    numbers_at = K.REAL_HEADER + K.REAL_BODY * len(system.bodies)
    numbers_at += K.REAL_PAIR * len(system.pairs)
    flat_rows: list[int] = []
    flat_numbers: list[float] = []
    column = 0
    for number, body in enumerate(system.bodies):
        driven = column if body.kind == DRIVEN else -1
        column += body.kind == DRIVEN
        at = flats_at + len(flat_rows)
        layout += [KINDS[body.kind], int(starts[0][number]), int(starts[1][number]), driven, at, 0]
        numbers += [*_mass_row(body), farthest(body)]
        rows, found = pack_flat_parts(system.flats[number], numbers_at + len(flat_numbers))
        flat_rows += rows
        flat_numbers += found
    pair_rows = _pair_rows(system)
    layout += pair_rows[0]
    numbers += pair_rows[1] + flat_numbers
    if system.coupler is not None:
        layout[K.I_COUPLER], layout[K.I_READING] = len(numbers), ticks_a_reading(system, dt)
        numbers += system.coupler.packed.tolist()
    layout += flat_rows
    _put_solid_rows(layout, solids.starts)
    if near is not None:
        layout[K.I_NEAR], layout[K.I_NEAR_NUMBERS] = len(layout), len(numbers)
        layout += near.ints
        numbers += near.numbers
    packed = (
        np.array(layout, dtype=np.int64),
        np.array(numbers),
        np.concatenate(ints),
        np.concatenate(reals),
        options,
        solids.arrays,
    )
    for array in (*packed[:-1], *solids.arrays):
        array.flags.writeable = False
    return packed


def _convex_arrays(system: System) -> tuple[list[NDArray[np.int64]], list[Array]]:
    """The packed arrays of each body, empty for a solid."""
    convex = [None if isinstance(b.body, SolidModel) else b.body for b in system.bodies]
    ints = [np.zeros(0, dtype=np.int64) if b is None else b.ints for b in convex]
    return ints, [np.zeros(0) if b is None else b.reals for b in convex]


def _put_solid_rows(layout: list[int], starts: list[list[int]]) -> None:
    """Where the arrays of each body that meets a solid begin, behind what there is."""
    for number, row in enumerate(starts):
        if row:
            layout[K.INT_HEADER + K.INT_BODY * number + K.B_SOLID] = len(layout)
            layout += row


def _pair_rows(system: System) -> tuple[list[int], list[float]]:
    """(integers, numbers) of all pairs."""
    rows: list[int] = []
    numbers: list[float] = []
    starts = system.kept_starts()
    for number, (pair, contact) in enumerate(zip(system.pairs, system.contacts, strict=True)):
        met = system.of_solids[number]
        models = system.pair_models(number)
        rows += [*pair, starts[number] if met else -1, room_for_rows(models)]
        numbers += [contact.stiffness, contact.damping, contact.friction, contact.slip_speed]
        numbers += [*pair_numbers(models, system.depth(number)), unseen_depth(system, number)]
    return rows, numbers


def ticks_a_reading(system: System, dt: float) -> int:
    """Ticks from a reading of a coupler's device to the next; 1 if its period is not known.

    Raises StandoffError: the device's period is not a whole number of steps.
    """
    if system.coupler is None or system.coupler.sampling is None:
        return 1
    period = system.coupler.sampling.period
    ticks = round(period / dt)
    if ticks < 1 or abs(period / dt - ticks) > WHOLE_STEPS * ticks:
        raise StandoffError(
            f"dt = {dt:g} does not fit into the device's period of {period:g} a whole number of "
            "times: take a step that does, the period itself or a part of it.",
            "dt",
            dt,
        )
    return ticks


def _mass_row(body: RigidBody) -> list[float]:
    mass = body.mass_properties
    if mass is None:
        return [0.0] * K.B_REACH
    inverse = np.linalg.inv(mass.inertia)
    return [mass.mass, *mass.centre, *mass.inertia.ravel(), *inverse.ravel()]


def body_start(body: RigidBody) -> Array:
    """A body's row of the state, at its pose and twist."""
    R, v, omega = body.pose.rotation, body.twist.v, body.twist.omega
    mass = body.mass_properties
    if body.kind != FREE or mass is None:
        return np.concatenate([R.ravel(), body.pose.translation, v, omega])
    arm = R @ mass.centre
    spin = R @ mass.inertia @ R.T @ omega
    return np.concatenate([R.ravel(), body.pose.translation + arm, v + np.cross(omega, arm), spin])


def driven_table(system: System, start: float, dt: float, ticks: int) -> Array:
    """Motions of the driven bodies, one row per half tick: (pose 12, twist 6) for each."""
    driven = [body for body in system.bodies if body.kind == DRIVEN]
    if not driven:
        return np.zeros((1, 1))
    rows = np.empty((2 * ticks + 1, K.N_DRIVEN * len(driven)))
    for k in range(2 * ticks + 1):
        t = start + 0.5 * k * dt
        for column, body in enumerate(driven):
            rows[k, K.N_DRIVEN * column : K.N_DRIVEN * (column + 1)] = driven_row(body, t)
    return rows


def driven_row(body: RigidBody, t: float) -> Array:
    """Pose and twist of a driven body at a time, world: 18 numbers."""
    pose, twist = body.path.pose(t), body.path.twist(t)
    if twist.frame != "world":
        twist = twist.in_world(pose)
    return np.concatenate([pose.rotation.ravel(), pose.translation, twist.v, twist.omega])
