"""A servo's log as a Parquet file: one row a tick; docs/servo.md lists the columns."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, BinaryIO

import numpy as np
from scipy.spatial.transform import Rotation

from standoff import parquet
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
    turns = log["rotation"]
    known = np.asarray(turns.any(axis=(1, 2)))
    quaternions = np.full((len(log), 4), np.nan)
    if known.any():
        quaternions[known] = Rotation.from_matrix(turns[known]).as_quat(canonical=True)
    handle = np.where(known[:, None], log["position"], np.nan)
    columns: dict[str, Any] = {"time": log["time"]}
    columns |= {axis: handle[:, k] for k, axis in enumerate(AXES)}
    columns |= {f"q{axis}": quaternions[:, k] for k, axis in enumerate(f"{AXES}w")}
    for name in ("tool", "force", "torque"):
        columns |= {f"{name}.{axis}": log[name][:, k] for k, axis in enumerate(AXES)}
    columns |= {
        "distance": log["distance"],
        "tick": log["tick"].astype(np.int64),
        "lateness": log["lateness"],
        "work": log["work"],
        "engaged": log["engaged"] > 0.0,
        "fault": log["fault"].astype(np.int64),
    }
    told = {"format": FORMAT, "format_version": FORMAT_VERSION, "standoff": __version__}
    parquet.write(columns, told | dict(facts), file)
