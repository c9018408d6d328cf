"""`standoff clearance` of an assembly's file: verdicts, files, exit codes, bad input."""

from __future__ import annotations

import json
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("OCP")

from cad import cad_shapes as made
from standoff.cad import CadError, common_volumes, measures, read_cad
from standoff.cad.instances import Instance, at_place
from standoff.clearance.report import Report


def write_parts(path: Path, parts: list[Any]) -> Path:
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Compound

    whole, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(whole)
    for part in parts:
        builder.Add(whole, part)
    written: Path = made.write_step(whole, path)
    return written


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A peg with 0.01 of play in a plate's hole, and a cube beside them, in one file."""
    plate = made.cut(made.box(40, 40, 10, (-20, -20, 0)), made.cylinder((0, 0, -1), 5.0, 12))
    parts = [plate, made.cylinder((0, 0, -5), 4.99, 20), made.box(4, 4, 4, (10, 10, 10.5))]
    path: Path = write_parts(tmp_path_factory.mktemp("step") / "peg.step", parts)
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


PRESSED = pi * 10 * (3.025**2 - 9)


def shifted(*by: float) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, 3] = by
    return pose


@pytest.fixture(scope="module")
def pressed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A pin of 3.025 in a bore of 3, a plate 0.5 into the bush, and a cube beside them."""
    bush = made.cut(made.cylinder((0, 0, 0), 5.0, 10), made.cylinder((0, 0, -1), 3.0, 12))
    plate = made.box(20, 20, 2, (-10, -10, 9.5))
    plate = made.cut(plate, made.cylinder((0, 0, 0), 4.0, 20))
    # the pin has its own place in the file
    pin = at_place(Instance("pin", made.cylinder((7, 0, -5), 3.025, 10), shifted(-7, 0, 5), None))
    cube = made.box(1, 1, 1, (12, 0, 0))
    folder = tmp_path_factory.mktemp("pressed")
    path: Path = write_parts(folder / "pressed.step", [bush, pin, plate, cube])
    return path


def test_volumes_in_common(standoff: Any, pressed: Path, file: Path, tmp_path: Path) -> None:
    """Those of the closed forms, where parts overlap and nowhere else, and on each route."""
    page = tmp_path / "volumes.html"
    ended = standoff("clearance", pressed, "--volume", "--page", page)
    assert ended.code == 0
    _, told = facts(standoff, pressed, "--volume")
    volumes = [pair.get("common_volume") for pair in told["pairs"]]
    known = [PRESSED, pi * 0.5 * (25 - 16)]
    found = sorted(volume for volume in volumes if volume is not None)
    assert found == pytest.approx(sorted(known), rel=1e-6)
    assert told["verdicts"]["OVERLAPPING"] == len(found)
    for text in (ended.out, page.read_text("utf-8")):
        assert "4.73202" in text
        assert "common (mm³)" in text
        assert "not proven" in text
    _, told = facts(standoff, pressed)
    assert "common_volume" not in told["pairs"][0]
    # nothing overlaps
    _, told = facts(standoff, file, "--volume")
    assert all("common_volume" not in pair for pair in told["pairs"])


def test_volumes_of_parts_by_their_names(pressed: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In the unit asked; none that OpenCASCADE's operation does not give; of no unknown part."""
    names = [part.name for part in read_cad(pressed, unit="cm").parts]
    pair = names[0], names[1]
    assert common_volumes(pressed, [pair], unit="cm") == pytest.approx({pair: PRESSED / 1e3})
    assert common_volumes(pressed, []) == {}
    with pytest.raises(CadError, match="no part 'bolt'"):
        common_volumes(pressed, [(names[0], "bolt")])
    monkeypatch.setattr(measures, "volume_of", lambda shape, adaptive=False: 1.0 + adaptive)
    assert common_volumes(pressed, [pair]) == {pair: 2.0}
    told = iter([5.0, 4.0, 6.0])  # of the common part, more than one of both has
    monkeypatch.setattr(measures, "volume_of", lambda *_, **__: next(told))
    assert common_volumes(pressed, [pair]) == {pair: None}


def test_volumes_are_of_parts_of_a_cad_file(standoff: Any) -> None:
    ended = standoff("clearance", "examples/fits.toml", "--volume")
    assert ended.code == 2
    assert "--volume: only of a CAD file's parts" in ended.err
