"""`standoff check` of a CAD file: its parts, one of them, and their pictures."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from matplotlib.image import imread

pytest.importorskip("OCP")

from cad import cad_shapes as made


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A plate with a hole, and two cubes, which are one solid, beside it."""
    from OCP.BRep import BRep_Builder
    from OCP.gp import gp_Trsf, gp_Vec
    from OCP.TopLoc import TopLoc_Location
    from OCP.TopoDS import TopoDS_Compound

    plate = made.cut(made.box(40, 40, 10, (-20, -20, 0)), made.cylinder((0, 0, -1), 5.0, 12))
    cube = made.box(4, 4, 4, (10, 10, 10.5))
    away = gp_Trsf()
    away.SetTranslation(gp_Vec(0, 0, 10))
    whole, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(whole)
    for part in (plate, cube, cube.Moved(TopLoc_Location(away))):
        builder.Add(whole, part)
    path: Path = made.write_step(whole, tmp_path_factory.mktemp("step") / "plate.step")
    return path


def test_each_solid_has_a_picture(standoff: Any, file: Path, tmp_path: Path) -> None:
    ended = standoff("check", file, "--plot", tmp_path / "seen.png", "--json")
    facts = json.loads(ended.out)
    assert (ended.code, len(facts["parts"])) == (0, 3)
    pictures = [Path(path) for path in facts["files"]]
    assert 2 <= len(pictures) <= 3
    for picture in pictures:
        assert picture.name.startswith("seen-")
        assert imread(picture).std() > 0.02


def test_one_part_is_checked_and_drawn(standoff: Any, file: Path, tmp_path: Path) -> None:
    names = [part["name"] for part in json.loads(standoff("check", file, "--json").out)["parts"]]
    picture = tmp_path / "one.svg"
    ended = standoff("check", file, "--body", names[0], "--plot", picture)
    assert ended.code == 0
    assert f"wrote {picture}" in ended.out
    assert f"{names[1]}: " not in ended.out
    assert "convex edge" in picture.read_text("utf-8")
    ended = standoff("check", file, "--body", "none")
    assert ended.code == 2
    assert names[0] in ended.err


def test_a_picture_of_no_known_kind_is_refused(standoff: Any, file: Path, tmp_path: Path) -> None:
    ended = standoff("check", file, "--plot", tmp_path / "seen.gif")
    assert ended.code == 2
    assert not list(tmp_path.iterdir())
