"""Recordings as tables of PyArrow and pandas, and what is said where pandas is missing."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from moving_pairs import REST, straight

import standoff as so

SMALL, BOX = so.shapes.box(0.3, 0.2, 0.25), so.shapes.box(1.0, 1.0, 1.0)


@pytest.fixture(scope="module")
def passing() -> so.Recording:
    path = straight((-1.0, 0.1, 0.3), (1.0, 0.05, 0.0))
    return so.track(so.Tracker(SMALL, BOX, 1e-1), path, REST, 2.0)


def test_the_arrow_table_is_the_file(passing: so.Recording, tmp_path: Path) -> None:
    passing.save(tmp_path / "run.parquet")
    table, file = passing.to_arrow(), pq.read_table(tmp_path / "run.parquet")
    assert table.schema.metadata == file.schema.metadata
    assert table.column_names == file.column_names
    for name in table.column_names:
        np.testing.assert_equal(table[name].to_pylist(), file[name].to_pylist())


def test_the_data_frame_has_the_recording_s_numbers(passing: so.Recording) -> None:
    pd = pytest.importorskip("pandas")
    frame = passing.to_pandas()
    assert len(frame) == len(passing)
    for name in ("time", "distance", "lower_bound", "upper_bound", "residual"):
        np.testing.assert_array_equal(frame[name], getattr(passing, name))
    points = frame[[f"point_b_{axis}" for axis in "xyz"]].to_numpy()
    np.testing.assert_array_equal(points, passing.point_b)
    spots = frame[[f"parameters_b_{k}" for k in range(3)]].to_numpy()
    np.testing.assert_array_equal(spots, passing.parameters_b)
    assert frame["feature_b"].tolist() == list(map(str, passing.feature_b))
    assert frame["status"].tolist() == [status.name for status in passing.status]
    assert frame["evaluations"].sum() == passing.total_counts().evaluations
    assert frame.attrs["standoff"]["bodies"] == ["box", "box"]
    # the same names as in the file, but for the lists
    lists = {"parameters_a", "parameters_b", "events"}
    alone = {f"parameters_{side}_{k}" for side in "ab" for k in range(3)}
    assert set(frame) - alone == set(passing.to_arrow().column_names) - lists
    assert len(pd.DataFrame(passing.events)) == len(passing.events) > 0


@pytest.mark.parametrize(("library", "call"), [("pandas", "to_pandas"), ("pyarrow", "to_arrow")])
def test_a_missing_library_is_named_with_its_extra(
    passing: so.Recording, monkeypatch: pytest.MonkeyPatch, library: str, call: str
) -> None:
    for name in [name for name in sys.modules if name.partition(".")[0] == library]:
        monkeypatch.setitem(sys.modules, name, None)
    monkeypatch.setitem(sys.modules, library, None)
    module = {"pandas": "data_frame", "pyarrow": "file"}[library]
    monkeypatch.delitem(sys.modules, f"standoff.recording.{module}", raising=False)
    monkeypatch.delitem(sys.modules, "standoff.parquet", raising=False)
    extra = {"pandas": "pandas", "pyarrow": "cli"}[library]
    with pytest.raises(ModuleNotFoundError, match=rf"pip install 'standoff\[{extra}\]'"):
        getattr(passing, call)()
