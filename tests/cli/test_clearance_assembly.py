"""`standoff clearance` of an assembly's file: verdicts, files, exit codes, bad input."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("OCP")

from cad import cad_shapes as made
from standoff.clearance.report import Report


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A peg with 0.01 of play in a plate's hole, and a cube beside them, in one file."""
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Compound

    plate = made.cut(made.box(40, 40, 10, (-20, -20, 0)), made.cylinder((0, 0, -1), 5.0, 12))
    parts = [plate, made.cylinder((0, 0, -5), 4.99, 20), made.box(4, 4, 4, (10, 10, 10.5))]
    whole, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(whole)
    for part in parts:
        builder.Add(whole, part)
    path: Path = made.write_step(whole, tmp_path_factory.mktemp("step") / "peg.step")
    return path


def facts(standoff: Any, *arguments: object) -> tuple[int, dict[str, Any]]:
    ended = standoff("clearance", *arguments, "--json")
    return ended.code, json.loads(ended.out)


def test_the_gaps_of_a_peg_in_its_hole(standoff: Any, file: Path) -> None:
    code, told = facts(standoff, file)
    assert code == 0
    gaps = sorted(pair["distance"] for pair in told["pairs"])
    assert gaps == pytest.approx([0.01, 0.5, 10.0 * 2**0.5 - 4.99], abs=1e-8)
    assert told["verdicts"]["APART"] == 3
    assert told["length_unit"] == "mm"
    assert told["certified"]


def test_a_clearance_that_is_not_kept_is_code_3(standoff: Any, file: Path, tmp_path: Path) -> None:
    page, plot = tmp_path / "report.html", tmp_path / "matrix.png"
    ended = standoff("clearance", file, "--min", "0.05", "--page", page, "--plot", plot)
    assert ended.code == 3
    assert "not proven to keep 0.05" in ended.out
    assert "assembly" in ended.out
    assert "at rest" in page.read_text("utf-8")
    assert plot.read_bytes().startswith(b"\x89PNG")
    assert standoff("clearance", file, "--min", "0.009").code == 0


def test_what_the_bounds_prove_is_kept_though_an_answer_is_not_certified(
    standoff: Any, file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Report, "certified", False)
    assert not facts(standoff, file)[1]["certified"]
    for asked, code in (((), 0), (("--min", "0.009"), 0), (("--min", "0.05"), 3)):
        assert standoff("clearance", file, *asked).code == code


def test_bad_files_and_options_are_code_2(standoff: Any, file: Path, tmp_path: Path) -> None:
    empty = tmp_path / "empty.step"
    empty.write_text("")
    for arguments, words in (
        ((empty,), "empty.step"),
        ((tmp_path / "none.step",), "none.step"),
        ((file, "--motion"), "at rest"),
        ((file, "--within", "-1"), "--within"),
    ):
        ended = standoff("clearance", *arguments)
        assert ended.code == 2, arguments
        assert words in ended.err
        assert "Traceback" not in ended.err
