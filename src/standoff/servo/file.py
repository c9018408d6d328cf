"""A servo's log as a Parquet file: one row a tick; docs/servo.md lists the columns."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, BinaryIO

import numpy as np
from scipy.spatial.transform import Rotation

from standoff import parquet
from standoff.kernels.dynamics import servo_arrays as V
from standoff.servo.report import ServoReport
from standoff.version import __version__

FORMAT = "standoff-servo"
FORMAT_VERSION = 1
AXES = "xyz"


def write_log(report: ServoReport, facts: Mapping[str, Any], file: BinaryIO) -> None:
    """Write the ticks that a servo kept; those with a handle are a trace that `Trace.read` reads.

    Parameters
    ----------
    report : ServoReport
    facts : mapping
        What JSON can hold: kept in the file's metadata.
    file : BinaryIO
    """
    log = report.log
    turns = log[:, V.J_TURN : V.J_TURN + 9].reshape(-1, 3, 3)
    known = np.asarray(turns.any(axis=(1, 2)))
    quaternions = np.full((len(log), 4), np.nan)
    if known.any():
        quaternions[known] = Rotation.from_matrix(turns[known]).as_quat(canonical=True)
    handle = np.where(known[:, None], log[:, V.J_HANDLE : V.J_HANDLE + 3], np.nan)
    columns: dict[str, Any] = {"time": log[:, V.J_CLOCK]}
    columns |= {axis: handle[:, k] for k, axis in enumerate(AXES)}
    columns |= {f"q{axis}": quaternions[:, k] for k, axis in enumerate(f"{AXES}w")}
    columns |= {f"tool.{axis}": log[:, V.J_TOOL + k] for k, axis in enumerate(AXES)}
    columns |= {f"force.{axis}": log[:, V.J_FORCE + k] for k, axis in enumerate(AXES)}
    columns |= {f"torque.{axis}": log[:, V.J_FORCE + 3 + k] for k, axis in enumerate(AXES)}
    columns |= {
        "distance": log[:, V.J_DISTANCE],
        "tick": log[:, V.J_TICK].astype(np.int64),
        "lateness": log[:, V.J_LATE],
        "work": log[:, V.J_WORK],
        "engaged": log[:, V.J_ENGAGED] > 0.0,
        "fault": log[:, V.J_WHY].astype(np.int64),
    }
    told = {"format": FORMAT, "format_version": FORMAT_VERSION, "standoff": __version__}
    parquet.write(columns, told | dict(facts), file)
