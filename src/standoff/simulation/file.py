"""A run of a system as a Parquet file: one row a record; docs/simulation.md lists the columns."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from standoff.simulation.coupler_run import CouplerRun
from standoff.simulation.system_run import SystemRun
from standoff.version import __version__

try:
    import pyarrow as pa
    import pyarrow.parquet as pq
except ModuleNotFoundError as error:
    raise ModuleNotFoundError(
        "pyarrow is not installed; install the extra 'cli': pip install 'standoff[cli]'",
        name="pyarrow",
    ) from error

Array = NDArray[np.float64]

FORMAT = "standoff-simulation"
FORMAT_VERSION = 1
METADATA = b"standoff"
"""Key of the schema's metadata under which the JSON text stands."""


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
    told = json.dumps(metadata | dict(facts), ensure_ascii=False, allow_nan=False)
    table = pa.table(columns)
    pq.write_table(table.replace_schema_metadata({METADATA: told}), file)


def _body_columns(run: SystemRun, number: int, name: str) -> dict[str, Any]:
    xyzw = Rotation.from_matrix(run.rotations(number)).as_quat(canonical=True)
    return {
        f"{name}.position": _rows(run.positions(number)),
        f"{name}.quaternion_wxyz": _rows(np.roll(xyzw, 1, axis=1)),
        f"{name}.velocity": _rows(run.velocities(number)),
        f"{name}.angular_velocity": _rows(run.angular_velocities(number)),
    }


def _pair_columns(run: SystemRun, number: int, name: str) -> dict[str, Any]:
    point_a, point_b, normal = (part[:, number] for part in run.witness_points)
    return {
        f"{name}.distance": run.distances[:, number],
        f"{name}.force": _rows(run.forces[:, number]),
        f"{name}.spots": run.spots[:, number],
        f"{name}.point_a": _rows(point_a),
        f"{name}.point_b": _rows(point_b),
        f"{name}.normal": _rows(normal),
    }


def _coupler_columns(found: CouplerRun) -> dict[str, Any]:
    known = np.isfinite(found.handle_positions[:, 0])
    quaternions = np.full((len(known), 4), np.nan)
    if known.any():
        turned = Rotation.from_matrix(found.handle_rotations[known])
        quaternions[known] = np.roll(turned.as_quat(canonical=True), 1, axis=1)
    return {
        "coupler.handle_position": _rows(found.handle_positions),
        "coupler.handle_quaternion_wxyz": _rows(quaternions),
        "coupler.force_on_tool": _rows(found.on_tool[:, :3]),
        "coupler.torque_on_tool": _rows(found.on_tool[:, 3:]),
        "coupler.force_on_device": _rows(found.on_device[:, :3]),
        "coupler.torque_on_device": _rows(found.on_device[:, 3:]),
        "coupler.engaged": found.engaged,
        "coupler.fault": found.fault,
        "coupler.device_work": found.energy.device,
        "coupler.tool_work": found.energy.tool,
        "coupler.device_friction": found.energy.friction,
        "coupler.stored": found.stored,
        "coupler.damped": found.damped,
    }


def _rows(values: Array) -> Any:
    """A column of vectors of one length."""
    flat = pa.array(np.ascontiguousarray(values).ravel())
    return pa.FixedSizeListArray.from_arrays(flat, values.shape[1])
