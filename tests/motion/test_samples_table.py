"""Pose samples from Parquet: every name of a column, every unit of time, and what is refused."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from standoff.motion import Pose, read_pose_samples

ROWS: dict[str, list[Any]] = {
    "time": [1.0, 1.5, 1.75],
    "x": [0.1, 1.0, 4.0],
    "y": [0.2, 2.0, 5.0],
    "z": [0.3, 3.0, 6.0],
    "qx": [0.0, 0.6, 0.6001],
    "qy": [0.0, 0.0, 0.0],
    "qz": [0.0, 0.0, 0.0],
    "qw": [1.0, 0.8, 0.8001],
}


def write(folder: Path, columns: dict[str, Any]) -> Path:
    file = folder / "hand.parquet"
    pq.write_table(pa.table(columns), file)
    return file


def renamed(**names: str) -> dict[str, Any]:
    return {names.get(key, key): values for key, values in ROWS.items()}


def with_times(times: Any) -> dict[str, Any]:
    return ROWS | {"time": times}


@pytest.mark.parametrize(
    "columns",
    [
        ROWS,
        renamed(time="timestamp", x="tx", y="ty", z="tz"),
        renamed(time="t"),
        dict(reversed(ROWS.items())),
        ROWS | {"force": [1.0, None, 2.0], "note": ["a", "b", "c"]},
        with_times(pa.array([1000, 1500, 1750], pa.timestamp("ms"))),
        with_times(pa.array([1000000000, 1500000000, 1750000000], pa.duration("ns"))),
    ],
)
def test_a_table_is_read(tmp_path: Path, columns: dict[str, Any]) -> None:
    samples = read_pose_samples(write(tmp_path, columns))
    np.testing.assert_array_equal(samples.times, [1.0, 1.5, 1.75])
    np.testing.assert_array_equal(samples.poses[0].matrix[:3, 3], [0.1, 0.2, 0.3])
    expected = Pose.from_xyzw((0.6, 0.0, 0.0, 0.8), (1.0, 2.0, 3.0))
    np.testing.assert_array_equal(samples.pose(1.5).matrix, expected.matrix)
    assert samples.repaired == 1


def test_far_instants_keep_their_digits(tmp_path: Path) -> None:
    epoch = 1_700_000_000 * 10**9
    ticks = pa.array([epoch, epoch + 123_456_789, epoch + 10**9], pa.timestamp("ns", "UTC"))
    samples = read_pose_samples(write(tmp_path, with_times(ticks)))
    assert samples.times[1] == 1_700_000_000.123456789


@pytest.mark.parametrize(
    ("columns", "pieces"),
    [
        (renamed(time="when"), ["no column time or timestamp or t", "when, x, y"]),
        (renamed(qw="w"), ["no column qw"]),
        (ROWS | {"tx": ROWS["x"]}, ["has x and tx"]),
        (with_times([1, 2, 3]), ["column time", "int64", "double"]),
        (with_times(["a", "b", "c"]), ["column time", "string"]),
        (ROWS | {"qx": ["a", "b", "c"]}, ["column qx", "string"]),
        (ROWS | {"y": [0.0, None, 1.0]}, ["row 2", "y is empty"]),
        (ROWS | {"y": [0.0, 0.0, np.inf]}, ["row 3", "y is inf"]),
        (with_times(pa.array([1, None, 3], pa.timestamp("s"))), ["row 2", "time is empty"]),
        (with_times([1.0, 1.0, 2.0]), ["row 2", "sort the rows"]),
        (ROWS | {"qw": [1.0, 1.5, 1.0]}, ["row 2", "norm 1.6"]),
        ({name: values[:1] for name, values in ROWS.items()}, ["at least two"]),
    ],
)
def test_refused(tmp_path: Path, columns: dict[str, Any], pieces: list[str]) -> None:
    file = write(tmp_path, columns)
    with pytest.raises(ValueError) as caught:  # noqa: PT011
        read_pose_samples(file)
    assert str(file) in str(caught.value)
    for piece in pieces:
        assert piece in str(caught.value)


def test_a_file_cut_off(tmp_path: Path) -> None:
    file = write(tmp_path, ROWS)
    file.write_bytes(file.read_bytes()[:-20])
    with pytest.raises(ValueError, match=r"hand\.parquet: is not a readable Parquet file"):
        read_pose_samples(file)
    with pytest.raises(FileNotFoundError, match="no such file"):
        read_pose_samples(tmp_path / "other.parquet")


def test_without_pyarrow_the_extra_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = write(tmp_path, ROWS)
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(ModuleNotFoundError, match=r"pip install 'standoff\[cli\]'"):
        read_pose_samples(file)
