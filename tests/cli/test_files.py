"""What a run writes: the Parquet file, the plot, and both whole or not at all."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import pyarrow.parquet as pq
import pytest
from matplotlib.image import imread

from standoff.cli.errors import CommandError, WriteError
from standoff.cli.output import check_target, write_whole
from standoff.scene import load_scene, record

Standoff = Callable[..., Any]


def test_parquet_holds_the_run(standoff: Standoff, passing: Path) -> None:
    target = passing.with_name("run.parquet")
    ended = standoff("track", passing, "-o", target)
    assert ended.code == 0
    assert f"wrote         {target}" in ended.out
    table = pq.read_table(target)
    recording = record(load_scene(passing))
    assert table.num_rows == 101
    np.testing.assert_array_equal(table["time"], recording.time)
    for name in ("distance", "lower_bound", "upper_bound", "rate", "residual", "certified"):
        np.testing.assert_array_equal(table[name], getattr(recording, name))
    for name in ("point_a", "point_b", "normal", "velocity_a", "velocity_b"):
        columns = np.column_stack([table[f"{name}_{axis}"] for axis in "xyz"])
        np.testing.assert_array_equal(columns, getattr(recording, name))
    assert table["feature_b"].to_pylist() == [str(feature) for feature in recording.feature_b]
    assert table["status"].to_pylist() == ["CONVERGED"] * 101
    assert [len(row) for row in table["parameters_a"].to_pylist()] == [3] * 101
    assert table["evaluations"].to_pylist() == recording.counts[:, 0].tolist()


def test_events_stand_in_their_frame(standoff: Standoff, passing: Path) -> None:
    target = passing.with_name("run.parquet")
    standoff("track", passing, "-o", target)
    table = pq.read_table(target)
    recording = record(load_scene(passing))
    rows = [(k, event) for k, row in enumerate(table["events"].to_pylist()) for event in row]
    assert [k for k, _ in rows] == [recorded.frame for recorded in recording.events]
    for (_, row), recorded in zip(rows, recording.events, strict=True):
        assert row["time"] == recorded.time
        assert row["body"] == recorded.body
        assert row["source"] == str(recorded.source)
        assert row["target"] == str(recorded.target)
        np.testing.assert_array_equal(row["value"], recorded.value)
        np.testing.assert_array_equal(row["slope"], recorded.slope)


def test_metadata_tells_how_the_file_came_about(standoff: Standoff, tmp_path: Path) -> None:
    samples = tmp_path / "tool.tum"
    samples.write_text("0 0 0 1 0 0 0 1\n0.5 0.1 0 1 0 0 0 1\n")
    scene = tmp_path / "scene.toml"
    scene.write_text(
        'version = 1\n[bodies.a]\nshape = "sphere"\nradius = 0.1\n[bodies.b]\nshape = "point"\n'
        '[motions.a]\nkind = "samples"\nfile = "tool.tum"\n[pair]\na = "a"\nb = "b"\n'
    )
    target = tmp_path / "run.parquet"
    standoff("track", scene, "-o", target, "--step", "0.1")
    raw = pq.read_schema(target).metadata[b"standoff"]
    metadata = json.loads(raw)
    assert (metadata["format"], metadata["format_version"]) == ("standoff-recording", 4)
    assert metadata["source"]["scene_text"] == scene.read_text()
    assert metadata["source"]["settings"]["step"] == 0.1
    assert metadata["source"]["samples_sha256"] == {
        "tool.tum": hashlib.sha256(samples.read_bytes()).hexdigest()
    }
    assert {"python", "numpy", "numba", "pyarrow"} == set(metadata["versions"])
    assert str(tmp_path) not in raw.decode()


def test_same_run_same_bytes(standoff: Standoff, passing: Path) -> None:
    first, second = passing.with_name("1.parquet"), passing.with_name("2.parquet")
    standoff("track", passing, "-o", first)
    standoff("track", passing, "-o", second)
    assert first.read_bytes() == second.read_bytes()


def test_runs_in_penetration_are_written_too(standoff: Standoff, crossing: Path) -> None:
    target, plot = crossing.with_name("run.parquet"), crossing.with_name("run.png")
    assert standoff("track", crossing, "-o", target, "--plot", plot).code == 0
    table = pq.read_table(target)
    penetrating = np.array(table["status"].to_pylist()) == "GLOBAL"
    assert penetrating.any()
    np.testing.assert_array_equal(np.array(table["distance"]) < 0.0, penetrating)
    assert imread(plot).ndim == 3


@pytest.mark.parametrize(
    ("ending", "head"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")]
)
def test_plot_formats(standoff: Standoff, passing: Path, ending: str, head: bytes) -> None:
    target = passing.with_name(f"run.{ending}")
    ended = standoff("track", passing, "--plot", target)
    assert ended.code == 0
    assert target.read_bytes().startswith(head)


def test_plot_names_what_it_shows(standoff: Standoff, passing: Path) -> None:
    target = passing.with_name("run.svg")
    standoff("track", passing, "--plot", target)
    # matplotlib keeps each text of a drawing as a comment beside its outlines.
    drawn = target.read_text()
    for text in (
        "Tool past a box: A = tool, B = part",
        "distance (cm)",
        "certified lower bound",
        "error (cm)",
        "residual",
        "time (s)",
        "B: active features of part",
        "face 0",
        "switch",
    ):
        assert f"<!-- {text} -->" in drawn
    assert "not certified" not in drawn
    assert "overlapping" not in drawn


def test_plot_marks_penetration(standoff: Standoff, crossing: Path) -> None:
    target = crossing.with_name("run.svg")
    standoff("track", crossing, "--plot", target)
    assert "<!-- in penetration -->" in target.read_text()
    standoff(
        *("track", crossing, "--plot", target, "--duration", 0.2),
        *("--law", "paper", "--gain", 5, "--feedforward", "false"),
    )
    assert "<!-- the same, not certified -->" in target.read_text()


def test_a_far_epoch_is_taken_off_the_axis(standoff: Standoff, passing: Path) -> None:
    text = passing.read_text().replace("linear = [1.0, 0.0, 0.0]", "linear = [0.0, 0.0, 0.0]")
    passing.write_text(text)
    target = passing.with_name("run.svg")
    assert standoff("track", passing, "--plot", target, "--start", 1305031098.5).code == 0
    assert "<!-- time since 1305031098.500 s (s) -->" in target.read_text()


def test_files_appear_whole_or_not_at_all(tmp_path: Path) -> None:
    good, bad = tmp_path / "good.txt", tmp_path / "bad.txt"
    good.write_text("before")

    def after(file: BinaryIO) -> None:
        file.write(b"after")

    def fail(file: BinaryIO) -> None:
        file.write(b"half")
        raise OSError(28, "No space left on device")

    with pytest.raises(WriteError, match="No space left"):
        write_whole({good: after, bad: fail})
    assert good.read_text() == "before"
    assert list(tmp_path.iterdir()) == [good]
    write_whole({good: after})
    assert good.read_text() == "after"
    assert list(tmp_path.iterdir()) == [good]


def test_a_full_disk_ends_in_one_message(
    standoff: Standoff, passing: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("pyarrow.parquet.write_table", fail)
    target, plot = passing.with_name("run.parquet"), passing.with_name("run.png")
    ended = standoff("track", passing, "-o", target, "--plot", plot)
    assert ended.code == 1
    assert ended.out == ""
    assert "could not be written" in ended.err
    assert list(passing.parent.iterdir()) == [passing]


def test_a_folder_that_cannot_be_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(**_: object) -> None:
        raise PermissionError(13, "Permission denied")

    check_target(tmp_path / "x.png", "--plot", (".png",))
    assert not list(tmp_path.iterdir())
    # A stand-in: the tests may run as root, to whom no folder is closed.
    monkeypatch.setattr("tempfile.TemporaryFile", refused)
    with pytest.raises(CommandError, match=r"cannot be written \(Permission denied\)"):
        check_target(tmp_path / "x.png", "--plot", (".png",))
