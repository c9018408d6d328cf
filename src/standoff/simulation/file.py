"""A run of a system as a Parquet file: one row a record; docs/simulation.md lists the columns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, BinaryIO

import numpy as np
from scipy.spatial.transform import Rotation

from standoff import parquet
from standoff.parquet import vectors
from standoff.simulation.coupler_run import CouplerRun
from standoff.simulation.system_run import SystemRun
from standoff.version import __version__

FORMAT = "standoff-simulation"
FORMAT_VERSION = 1


def write_run(
    run: SystemRun, names: Sequence[str], facts: Mapping[str, Any], file: BinaryIO
) -> None:
    """Write a run to a stream; the same run gives the same file, byte for byte.

    Parameters
    ----------
    run : SystemRun
    names : sequence of str
        Of the bodies, in the system's order.
    facts : mapping
        What JSON can hold: kept in the file's metadata.
    file : BinaryIO
    """
    columns: dict[str, Any] = {"time": run.times}
    for number, name in enumerate(names):
        columns |= _body_columns(run, number, name)
    for number, (a, b) in enumerate(run.system.pairs):
        columns |= _pair_columns(run, number, f"{names[a]}-{names[b]}")
    if run.coupler is not None:
        columns |= _coupler_columns(run.coupler)
    columns |= {f"energy.{name}": value for name, value in run.energy._asdict().items()}
    metadata = {"format": FORMAT, "format_version": FORMAT_VERSION, "standoff": __version__}
    parquet.write(columns, metadata | dict(facts), file)


def _body_columns(run: SystemRun, number: int, name: str) -> dict[str, Any]:
    xyzw = Rotation.from_matrix(run.rotations(number)).as_quat(canonical=True)
    return {
        f"{name}.position": vectors(run.positions(number)),
        f"{name}.quaternion_wxyz": vectors(np.roll(xyzw, 1, axis=1)),
        f"{name}.velocity": vectors(run.velocities(number)),
        f"{name}.angular_velocity": vectors(run.angular_velocities(number)),
    }


def _pair_columns(run: SystemRun, number: int, name: str) -> dict[str, Any]:
    point_a, point_b, normal = (part[:, number] for part in run.witness_points)
    return {
        f"{name}.distance": run.distances[:, number],
        f"{name}.force": vectors(run.forces[:, number]),
        f"{name}.spots": run.spots[:, number],
        f"{name}.point_a": vectors(point_a),
        f"{name}.point_b": vectors(point_b),
        f"{name}.normal": vectors(normal),
    }


def _coupler_columns(found: CouplerRun) -> dict[str, Any]:
    known = np.isfinite(found.handle_positions[:, 0])
    quaternions = np.full((len(known), 4), np.nan)
    if known.any():
        turned = Rotation.from_matrix(found.handle_rotations[known])
        quaternions[known] = np.roll(turned.as_quat(canonical=True), 1, axis=1)
    return {
        "coupler.handle_position": vectors(found.handle_positions),
        "coupler.handle_quaternion_wxyz": vectors(quaternions),
        "coupler.force_on_tool": vectors(found.on_tool[:, :3]),
        "coupler.torque_on_tool": vectors(found.on_tool[:, 3:]),
        "coupler.force_on_device": vectors(found.on_device[:, :3]),
        "coupler.torque_on_device": vectors(found.on_device[:, 3:]),
        "coupler.engaged": found.engaged,
        "coupler.fault": found.fault,
        "coupler.device_work": found.energy.device,
        "coupler.tool_work": found.energy.tool,
        "coupler.device_friction": found.energy.friction,
        "coupler.stored": found.stored,
        "coupler.damped": found.damped,
    }
