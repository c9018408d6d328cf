"""Recordings in Parquet: round trip, other readers, refusals, whole or not at all."""

from __future__ import annotations

import json
import math
from dataclasses import fields, replace
from pathlib import Path
from typing import BinaryIO

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from moving_pairs import REST, random_pairs, straight

import standoff as so

SMALL, BOX = so.shapes.box(0.3, 0.2, 0.25), so.shapes.box(1.0, 1.0, 1.0)
THROUGH = straight((-1.0, 0.1, 0.3), (1.0, 0.05, 0.0))


@pytest.fixture(scope="module")
def recordings() -> list[so.Recording]:
    """An atlas, edges and vertices, an overlap, and a law without a tolerance."""
    a, b, path_a, path_b = random_pairs(1)[0]
    egg = so.shapes.ellipsoid(0.3, 0.2, 0.1)
    return [
        so.track(so.Tracker(a, b, 1e-2), path_a, path_b, 1.0),
        so.track(
            so.Tracker(egg, b, 1e-2, law=so.PredictorCorrector(tolerance=math.inf)),
            path_a,
            path_b,
            0.5,
            start=3.0,
        ),
        so.track(so.Tracker(SMALL, BOX, 1e-2), THROUGH, REST, 2.0),
    ]


def same(one: object, two: object) -> bool:
    """Equal, with nan equal to nan."""
    if isinstance(one, np.ndarray) and one.dtype != object:
        return np.array_equal(one, two, equal_nan=True) and one.dtype == two.dtype
    if isinstance(one, np.ndarray):
        return one.tolist() == two.tolist()
    if isinstance(one, tuple) and not isinstance(one, str):
        return len(one) == len(two) and all(map(same, one, two))
    return one == two or (one != one and two != two)


def test_a_recording_comes_back_as_it_was(recordings: list[so.Recording], tmp_path: Path) -> None:
    assert any(recording.events for recording in recordings)
    for recording in recordings:
        recording.save(tmp_path / "run.parquet")
        again = so.open_recording(tmp_path / "run.parquet")
        for field in fields(so.Recording):
            if field.name not in ("pair", "paths"):
                was, read = getattr(recording, field.name), getattr(again, field.name)
                assert same(was, read), field.name
        assert again.pair is None
        assert again.modes() == recording.modes()
        with pytest.raises(ValueError, match="does not hold its bodies"):
            again.automaton()


def test_another_reader_needs_nothing_of_ours(
    recordings: list[so.Recording], tmp_path: Path
) -> None:
    recording = recordings[0]
    recording.save(tmp_path / "run.parquet")
    table = pq.read_table(tmp_path / "run.parquet")
    np.testing.assert_array_equal(table["distance"], recording.distance)
    events = [event for row in table["events"].to_pylist() for event in row]
    assert [event["time"] for event in events] == [event.time for event in recording.events]
    assert all(event["located"] for event in events)
    told = json.loads(table.schema.metadata[b"standoff"])
    assert (told["format"], told["format_version"]) == ("standoff-recording", 4)
    assert told["standoff"] == so.__version__
    assert (told["a"], told["b"]) == recording.info.bodies
    assert (told["a_sha256"], told["b_sha256"]) == tuple(x.digest for x in recording.pair)
    assert told["options"]["law"] == "predictor-corrector"
    assert told["options"]["dt"] == 1e-2
    assert told["units"] == {"length": "", "time": "s", "angle": "rad"}
    assert str(tmp_path) not in table.schema.metadata[b"standoff"].decode()


def test_the_automaton_of_a_recording(recordings: list[so.Recording]) -> None:
    found = recordings[0].automaton()
    assert found.visits == tuple(recordings[0].modes())
    assert len(found.taken) + len(found.restarts) == len(recordings[0].events)


def test_the_metadata_is_strict_json(recordings: list[so.Recording], tmp_path: Path) -> None:
    def refuse(constant: str) -> None:
        raise AssertionError(constant)

    recordings[1].save(tmp_path / "run.parquet")
    text = pq.read_schema(tmp_path / "run.parquet").metadata[b"standoff"]
    assert json.loads(text, parse_constant=refuse)["options"]["tolerance"] == "inf"


def test_the_same_run_gives_the_same_bytes(recordings: list[so.Recording], tmp_path: Path) -> None:
    again = so.track(so.Tracker(SMALL, BOX, 1e-2), THROUGH, REST, 2.0)
    again.save(tmp_path / "1.parquet")
    recordings[2].save(tmp_path / "2.parquet")
    assert (tmp_path / "1.parquet").read_bytes() == (tmp_path / "2.parquet").read_bytes()


def test_nothing_is_left_where_writing_fails(
    recordings: list[so.Recording], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "run.parquet"
    target.write_text("before")

    def fail(_: object, file: BinaryIO) -> None:
        file.write(b"half")
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr("pyarrow.parquet.write_table", fail)
        with pytest.raises(OSError, match="No space left"):
            recordings[0].save(target)
    assert target.read_text() == "before"
    assert list(tmp_path.iterdir()) == [target]
    unfit = replace(recordings[0].info, source={"when": object()})
    with pytest.raises(TypeError):
        replace(recordings[0], info=unfit).save(target)
    assert target.read_text() == "before"
    assert list(tmp_path.iterdir()) == [target]
    with pytest.raises(FileNotFoundError):
        recordings[0].save(tmp_path / "no" / "run.parquet")
    assert list(tmp_path.iterdir()) == [target]


def rewritten(path: Path, change: dict) -> None:
    """Write a recording's table with other metadata."""
    table = pq.read_table(path)
    told = json.loads(table.schema.metadata[b"standoff"]) | change
    pq.write_table(table.replace_schema_metadata({"standoff": json.dumps(told)}), path)


def test_what_is_no_recording(recordings: list[so.Recording], tmp_path: Path) -> None:
    file = tmp_path / "run.parquet"
    with pytest.raises(FileNotFoundError, match="does not exist"):
        so.open_recording(file)
    with pytest.raises(FileNotFoundError, match="is a folder"):
        so.open_recording(tmp_path)
    file.write_text("time,distance\n0,1\n")
    with pytest.raises(ValueError, match="not a Parquet file, or is truncated"):
        so.open_recording(str(file))
    pq.write_table(pa.table({"time": [0.0]}), file)
    with pytest.raises(ValueError, match="not a Standoff recording"):
        so.open_recording(file)
    recordings[0].save(file)
    whole = file.read_bytes()
    for part in (4, len(whole) // 2, len(whole) - 1):
        file.write_bytes(whole[:part])
        with pytest.raises(ValueError, match="not a Parquet file, or is truncated"):
            so.open_recording(file)


@pytest.mark.parametrize(
    ("version", "fix"),
    [(1, "record again"), (6, "install the Standoff"), ("two", "install"), (True, "record again")],
)
def test_another_format_version(
    recordings: list[so.Recording], tmp_path: Path, version: object, fix: str
) -> None:
    file = tmp_path / "run.parquet"
    recordings[0].save(file)
    rewritten(file, {"format_version": version})
    told = f"version {version!r}.*reads versions 2, 3, 4 and 5: {fix}"
    with pytest.raises(ValueError, match=told):
        so.open_recording(file)


def test_what_was_added_may_not_be_nested_too_deeply(
    recordings: list[so.Recording], tmp_path: Path
) -> None:
    file = tmp_path / "run.parquet"
    for depth, deep in ((49, False), (50, True), (100_000, True)):
        value: object = 1
        for _ in range(depth - 1):
            value = [value]
        info = replace(recordings[0].info, source={"note": value})
        if deep:
            with pytest.raises(ValueError, match=r"info \(source.note\) .*nested too deeply"):
                replace(recordings[0], info=info).save(file)
        else:
            replace(recordings[0], info=info).save(file)
            assert so.open_recording(file).info.source == info.source
    table = pq.read_table(file)
    deep_text = '{"format": "standoff-recording", "source": ' + "[" * 100_000
    pq.write_table(table.replace_schema_metadata({"standoff": deep_text}), file)
    with pytest.raises(ValueError, match="not a Standoff recording"):
        so.open_recording(file)


def test_a_file_of_version_2_opens_with_what_it_holds(tmp_path: Path) -> None:
    old = Path(__file__).parent.parent / "fuzz" / "corpus" / "files" / "recording.parquet"
    assert json.loads(pq.read_schema(old).metadata[b"standoff"])["format_version"] == 2
    recording = so.open_recording(old)
    assert len(recording) > 0
    assert np.isfinite(recording.lower_bound).all()
    assert recording.upper_bound.shape == recording.time.shape
    assert np.isnan(recording.upper_bound).all()
    assert not {"depth", "deadline"} & set(recording.info.options)
    # Saved again it is of today's version, and what was unknown stays so.
    recording.save(tmp_path / "again.parquet")
    again = so.open_recording(tmp_path / "again.parquet")
    assert np.isnan(again.upper_bound).all()
    assert again.info.options == recording.info.options


OF_VERSION_3 = {
    "predictor": "none",
    "integrator": "rk4",
    "gain": 40.0,
    "tolerance": 1e-9,
    "dt": 1e-2,
    "depth": "local",
    "deadline": 40,
    "locate": True,
}
OF_THE_PAPER = {
    "law": "paper",
    "realisation": "integrated",
    "saturation": "hold",
    "switching": "multipliers",
    "solve": "plain",
}


@pytest.mark.parametrize(
    ("written", "law"),
    [
        (
            {"law": "predictor-corrector"},
            so.PredictorCorrector(predictor="none", tolerance=1e-9, depth="local", deadline=40),
        ),
        (
            {**OF_THE_PAPER, "feedback": "Linear(gain=40.0)"},
            so.PaperLaw(
                integrator="rk4",
                gain=40.0,
                feedforward=False,
                realisation="integrated",
                saturation="hold",
                solve="plain",
                tolerance=1e-9,
                depth="local",
                deadline=40,
            ),
        ),
    ],
    ids=["predictor-corrector", "paper"],
)
def test_a_file_of_version_3_has_its_law(
    recordings: list[so.Recording], tmp_path: Path, written: dict[str, str], law: object
) -> None:
    """It held every law's options, and no feedforward of the paper's."""
    file = tmp_path / "run.parquet"
    recordings[0].save(file)
    rewritten(file, {"format_version": 3, "options": {**OF_VERSION_3, **written}})
    info = so.open_recording(file).info
    assert info.law == law
    assert info.options["locate"] is True
    if written["law"] == "paper":
        changed = {**OF_VERSION_3, **written, "feedback": "PI(gain=40.0, integral=300.0)"}
        rewritten(file, {"format_version": 3, "options": changed})
        info = so.open_recording(file).info
        assert info.options["feedback"] == "PI(gain=40.0, integral=300.0)"
        with pytest.raises(ValueError, match=r"PI\(gain=40.*is not one of standoff's"):
            _ = info.law


def test_a_file_of_today_without_upper_bounds_was_changed(
    recordings: list[so.Recording], tmp_path: Path
) -> None:
    file = tmp_path / "run.parquet"
    recordings[0].save(file)
    pq.write_table(pq.read_table(file).drop_columns(["upper_bound"]), file)
    with pytest.raises(ValueError, match=r"does not fit .*upper_bound"):
        so.open_recording(file)


def test_a_recording_that_was_changed(recordings: list[so.Recording], tmp_path: Path) -> None:
    file = tmp_path / "run.parquet"
    recordings[0].save(file)
    table = pq.read_table(file)
    pq.write_table(table.drop_columns(["normal_y"]), file)
    with pytest.raises(ValueError, match=r"does not fit .*normal_y"):
        so.open_recording(file)
    recordings[0].save(file)
    rewritten(file, {"format": "other"})
    with pytest.raises(ValueError, match="not a Standoff recording"):
        so.open_recording(file)


def test_a_missing_library_is_named(
    recordings: list[so.Recording], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import sys

    for name, module, use in (
        ("pyarrow", "file", lambda: recordings[0].save(tmp_path / "run.parquet")),
        ("pyarrow", "file", lambda: so.open_recording(tmp_path / "run.parquet")),
        ("matplotlib", "plot", lambda: recordings[0].plot(tmp_path / "run.png")),
    ):
        with monkeypatch.context() as patch:
            patch.delattr(f"standoff.recording.{module}", raising=False)
            patch.delitem(sys.modules, f"standoff.recording.{module}", raising=False)
            patch.delitem(sys.modules, "standoff.parquet", raising=False)
            patch.setitem(sys.modules, name, None)
            with pytest.raises(ModuleNotFoundError, match=rf"{name} .*standoff\[cli\]"):
                use()
    assert not list(tmp_path.iterdir())
