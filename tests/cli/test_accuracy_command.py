"""``standoff accuracy``: what it prints, writes and refuses, and its exit codes."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pyarrow import parquet

import standoff as so
from standoff_studies.accuracy import measuring
from standoff_studies.accuracy.measuring import Row

Standoff = Callable[..., Any]
PAIRS = 3
LEVELS = 6


def test_files_and_tables(standoff: Standoff, tmp_path: Path) -> None:
    folder = tmp_path / "new" / "folder"
    ended = standoff("accuracy", "sphere", "box", "--cases", 2, "--peers", "-o", folder)
    assert ended.err == ""
    names = [path.name for path in sorted(folder.iterdir())]
    assert names == ["accuracy.md", "accuracy.parquet", "accuracy.png", "depths.md", "gaps.md"]
    assert all(f"wrote {folder / name}" in ended.out for name in names)
    assert "sphere – box" in ended.out
    table = parquet.read_table(folder / "accuracy.parquet")
    assert table.column_names == list(Row.__annotations__)
    engines = ["Standoff", "Coal, default", "Coal, tight", "MuJoCo, default", "MuJoCo, tight"]
    assert set(table["engine"].to_pylist()) == {*engines, "python-fcl"}
    assert table.num_rows == PAIRS * LEVELS * 2 * 6
    assert table.schema.metadata[b"seed"] == b"0"
    assert json.loads(table.schema.metadata[b"versions"])["coal"].startswith("3.")
    page = (folder / "accuracy.md").read_text("utf-8")
    assert page.startswith("Made by `standoff accuracy 'sphere' 'box' --cases 2 --seed 0 --peers`")
    assert (folder / "accuracy.png").read_bytes().startswith(b"\x89PNG")


def test_any_row_can_be_asked_again(standoff: Standoff, tmp_path: Path) -> None:
    """Bodies, poses, points and normal of a row are those of its answer."""
    made = cache(lambda text: eval(text, {"so": so}))
    chosen = ["halfspace", "torus hull", "NURBS ellipsoid"]
    assert standoff("accuracy", *chosen, "--cases", 1, "-o", tmp_path).code == 0
    for row in parquet.read_table(tmp_path / "accuracy.parquet").to_pylist():
        a, b = (made(row[name]) for name in ("body_a", "body_b"))
        pose_a, pose_b = (
            (np.reshape(row[name][:9], (3, 3)), np.array(row[name][9:]))
            for name in ("pose_a", "pose_b")
        )
        found = so.distance(a, b, pose_a, pose_b)
        assert found.distance == row["distance"], row
        assert found.point_a.tolist() == row["point_a"]
        assert found.point_b.tolist() == row["point_b"]
        assert found.normal.tolist() == row["normal"]
        true_a, true_b, n = (
            np.array(row[name]) for name in ("true_point_a", "true_point_b", "true_normal")
        )
        np.testing.assert_allclose(true_b - true_a, row["truth"] * n, atol=1e-14 * row["size"])


def test_json_and_the_same_cases_again(standoff: Standoff) -> None:
    runs = [
        json.loads(standoff("accuracy", *shapes, "--cases", 1, "--seed", 7, "--json").out)
        for shapes in (["cone", "lens"], ["lens", "cone"], ["sphere", "lens", "cone"])
    ]

    def found(run: dict[str, Any]) -> list[dict[str, Any]]:
        return [entry for entry in run["pairs"] if entry["pair"] == "cone – lens"]

    assert found(runs[0])
    assert found(runs[0]) == found(runs[1]) == found(runs[2])
    assert runs[0]["seed"] == 7
    levels = {entry["level"] for entry in runs[0]["engines"]}
    assert levels == {1e-6, 1e-3, 1.0, -1e-6, -1e-3, -1e-1}
    other = json.loads(standoff("accuracy", "cone", "lens", "--cases", 1, "--json").out)
    assert found(other) != found(runs[0])


def test_a_wrong_answer_is_told_by_the_exit_code(
    standoff: Standoff, monkeypatch: pytest.MonkeyPatch
) -> None:
    own = measuring.own_answer

    def off(case: measuring.Case) -> Any:
        return replace(own(case), distance=case.truth.distance + 2e-6 * case.size)

    monkeypatch.setattr(measuring, "own_answer", off)
    assert standoff("accuracy", "sphere", "--cases", 1).code == 3


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["ball"], "no shape 'ball'; there are: point, segment, sphere, "),
        (["--cases", "0"], "--cases 0: give 1 or more"),
        (["--seed", "-1"], "--seed -1: give 0 or more"),
        (["sphere", "-o", "{tmp}/file/below"], "the folder cannot be made"),
    ],
)
def test_bad_input_is_named(
    standoff: Standoff, tmp_path: Path, arguments: list[str], complaint: str
) -> None:
    (tmp_path / "file").touch()
    ended = standoff("accuracy", *(word.replace("{tmp}", str(tmp_path)) for word in arguments))
    assert ended.code == 2
    assert complaint in ended.err
    assert ended.err.count("\n") == 1


@pytest.mark.parametrize("package", ["coal", "OCP.BRepExtrema"])
def test_a_missing_peer_is_named_with_its_extra(
    standoff: Standoff, monkeypatch: pytest.MonkeyPatch, package: str
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    ended = standoff("accuracy", "sphere", "NURBS ellipsoid", "--cases", 1, "--peers")
    assert ended.code == 2
    assert "standoff-studies[peers]" in ended.err
