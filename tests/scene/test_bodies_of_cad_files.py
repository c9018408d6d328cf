"""``body = "part.step"`` in scenes: parts, units, places, and files that are none."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("OCP")

import standoff as so
from cad import cad_shapes as made
from standoff.scene import Scene, SceneError, load_scene
from standoff.solids import Solid
from standoff.world import Compound


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("cad")
    holed = made.cut(made.box(40, 40, 10, (-20, -20, 0)), made.cylinder((0, 0, -1), 5.0, 12))
    made.write_step(holed, path / "plate.step")
    made.write_step(made.cylinder((0, 0, -5), 4.9, 20), path / "peg.stp")
    made.write_brep(holed, path / "plate.brep")
    made.write_assembly(path / "two.step", ("box", "rod", "whole"))
    return path


def loaded(folder: Path, text: str, unit: str = "mm") -> Scene:
    file = folder / "scene.toml"
    file.write_text(f'version = 1\nlength_unit = "{unit}"\n{text}\n[world]\n')
    return load_scene(file)


def test_convex_parts_are_bodies_and_others_solids(folder: Path) -> None:
    scene = loaded(folder, '[bodies.plate]\nbody = "plate.step"\n[bodies.peg]\nbody = "peg.stp"\n')
    assert isinstance(scene.bodies["plate"], Solid)
    assert isinstance(scene.bodies["peg"], so.Body)
    answer = scene.world.distances(scene.poses(scene.world, 0.0))["plate", "peg"]
    assert answer.distance == pytest.approx(0.1, abs=1e-8)


@pytest.mark.parametrize(("unit", "size"), [("m", 0.001), ("cm", 0.1), ("in", 1.0 / 25.4)])
def test_lengths_are_converted_to_those_of_the_scene(folder: Path, unit: str, size: float) -> None:
    peg = loaded(folder, '[bodies.peg]\nbody = "peg.stp"\n', unit).bodies["peg"]
    assert isinstance(peg, so.Body)
    assert peg.size == pytest.approx(size * np.sqrt(2 * 9.8**2 + 20**2), rel=1e-9)
    # a BREP file has no unit: as it is
    plate = loaded(folder, '[bodies.a]\nbody = "plate.brep"\n', unit).bodies["a"]
    assert isinstance(plate, Solid)
    assert plate.size == pytest.approx(np.sqrt(40**2 * 2 + 10**2))


def test_one_part_of_several_is_named_and_stands_where_the_file_has_it(folder: Path) -> None:
    whole = so.read_step(folder / "two.step").by_name
    names = list(whole)
    assert len(names) == 3
    with pytest.raises(SceneError) as caught:
        loaded(folder, '[bodies.a]\nbody = "two.step"\n')
    assert caught.value.key == "bodies.a.body"
    assert all(f"'{name}'" in str(caught.value) for name in names)
    with pytest.raises(SceneError, match="did you mean"):
        loaded(folder, f'[bodies.a]\nbody = "two.step"\npart = "{names[0]}x"\n')
    text = "".join(
        f'[bodies.part{k}]\nbody = "two.step"\npart = "{name}"\n' for k, name in enumerate(names)
    )
    scene = loaded(folder, text)
    answer = scene.world.distances(scene.poses(scene.world, 0.0))
    for a, b in scene.world.pairs():
        one, other = (whole[names[int(name[-1])]] for name in (a, b))
        alone = so.distance(one.shape, other.shape, one.pose, other.pose)  # type: ignore[arg-type]
        assert answer[a, b].distance == pytest.approx(alone.distance, abs=1e-7)


def test_a_solid_that_its_file_places_is_a_compound_of_one_piece(folder: Path) -> None:
    from OCP.BRep import BRep_Builder
    from OCP.gp import gp_Trsf, gp_Vec
    from OCP.TopLoc import TopLoc_Location
    from OCP.TopoDS import TopoDS_Compound

    plate = made.cut(made.box(40, 40, 10, (-20, -20, 0)), made.cylinder((0, 0, -1), 5.0, 12))
    move = gp_Trsf()
    move.SetTranslation(gp_Vec(100.0, 0.0, 0.0))
    whole, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(whole)
    builder.Add(whole, plate)
    builder.Add(whole, plate.Moved(TopLoc_Location(move)))
    made.write_step(whole, folder / "plates.step")
    names = list(so.read_step(folder / "plates.step").by_name)
    text = "".join(
        f'[bodies.part{k}]\nbody = "plates.step"\npart = "{name}"\n' for k, name in enumerate(names)
    )
    scene = loaded(folder, text)
    assert any(isinstance(body, Compound) for body in scene.bodies.values())
    answer = scene.world.distances(scene.poses(scene.world, 0.0))["part0", "part1"]
    assert answer.distance == pytest.approx(60.0, abs=1e-6)
    # as a piece, the placement of the scene comes before the file's
    text = (
        '[bodies.a]\nshape = "compound"\n[bodies.a.pieces.one]\nbody = "plates.step"\n'
        f'part = "{names[1]}"\nposition = [0.0, 0.0, 50.0]\n'
    )
    piece = loaded(folder, text).bodies["a"].pieces["one"]
    assert piece.pose.translation[2] == pytest.approx(50.0)


def test_files_that_are_none(folder: Path) -> None:
    shell = made.explored(made.box(1, 2, 3), "shell")[0]
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Shell

    opened, builder = TopoDS_Shell(), BRep_Builder()
    builder.MakeShell(opened)
    for face in made.explored(shell, "face")[:5]:
        builder.Add(opened, face)
    made.write_step(opened, folder / "open.step", shell=True)
    (folder / "empty.step").write_text("")
    (folder / "cut.step").write_bytes((folder / "plate.step").read_bytes()[:2000])
    (folder / "words.iges").write_text("not a part")
    for name, words in (
        ("open.step", "shell is open"),
        ("empty.step", "is empty"),
        ("cut.step", "is cut off"),
        ("words.iges", "words.iges"),
        ("plates.stepp", "must end in"),
    ):
        (folder / "plates.stepp").write_text("x")
        with pytest.raises(SceneError) as caught:
            loaded(folder, f'[bodies.a]\nbody = "{name}"\n')
        assert words in str(caught.value)
        assert caught.value.key == "bodies.a.body"
    with pytest.raises(SceneError, match="can't be converted to 'furlong'"):
        loaded(folder, '[bodies.a]\nbody = "peg.stp"\n', "furlong")


def test_without_opencascade_the_extra_is_named(folder: Path) -> None:
    (folder / "bare.toml").write_text('version = 1\n[bodies.a]\nbody = "peg.stp"\n[world]\n')
    code = (
        "import sys; sys.modules['OCP'] = None\n"
        "from standoff.scene import load_scene\n"
        f"load_scene({str(folder / 'bare.toml')!r})\n"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert "SceneError" in run.stderr
    assert "standoff[cad]" in run.stderr
