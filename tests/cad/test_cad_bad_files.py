"""Bad CAD files: each a clear error with the place, and nothing half loaded."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import cad_shapes as made
import pytest

import standoff as so
from standoff.cad import CadError, files

pytest.importorskip("OCP", reason="OpenCASCADE comes with the extra 'cad'")


def test_a_file_that_is_cut_off(tmp_path: Path) -> None:
    path = made.write_step(made.box(1, 2, 3), tmp_path / "box.step")
    text = path.read_text()
    path.write_text(text[: len(text) // 2])
    with pytest.raises(CadError, match=r"is cut off: it ends in line \d+ after entity #\d+"):
        so.read_step(path)


def test_an_empty_file_and_others(tmp_path: Path) -> None:
    path = tmp_path / "empty.step"
    path.touch()
    with pytest.raises(CadError, match="is empty"):
        so.read_step(path)
    path.write_text("solid x\nendsolid x\n")
    with pytest.raises(CadError, match="is no STEP file"):
        so.read_step(path)
    path.write_text("ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n")
    with pytest.raises(CadError, match="has no entities"):
        so.read_step(path)
    with pytest.raises(CadError, match="is a folder"):
        so.read_step(tmp_path)
    with pytest.raises(FileNotFoundError):
        so.read_step(tmp_path / "none.step")
    with pytest.raises(TypeError, match="give the path"):
        so.read_step(3)
    with pytest.raises(CadError, match="is no BREP file"):
        so.cad.read_brep(path)
    with pytest.raises(CadError, match="give a file that ends in"):
        so.cad.read_cad(path.rename(tmp_path / "part.prt"))


def test_a_million_entities_are_refused_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(files, "MOST_ENTITIES", 1000)
    path = tmp_path / "huge.step"
    lines = "".join(f"#{k}=CARTESIAN_POINT('',(0.,0.,0.));\n" for k in range(1, 1500))
    path.write_text(f"ISO-10303-21;\nDATA;\n{lines}ENDSEC;\nEND-ISO-10303-21;\n")
    with pytest.raises(CadError, match=r"has more than 1000 entities .*1499 are within"):
        so.read_step(path)


def test_an_open_shell(tmp_path: Path) -> None:
    path = made.write_step(_open_box(), tmp_path / "open.step", shell=True)
    with pytest.raises(CadError, match=r"shell is open: 4 edges bound one face, near \("):
        so.read_step(path)
    with pytest.raises(CadError, match="open"):
        so.read_step(path, heal=True)


def _open_box() -> Any:
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Shell

    shell, builder = TopoDS_Shell(), BRep_Builder()
    builder.MakeShell(shell)
    for face in made.explored(made.box(1, 2, 3), "face")[:5]:
        builder.Add(shell, face)
    return shell


def test_a_face_that_crosses_itself(tmp_path: Path) -> None:
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakePolygon
    from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
    from OCP.gp import gp_Pnt, gp_Vec

    polygon = BRepBuilderAPI_MakePolygon()
    for x, y in ((0, 0), (10, 10), (10, 0), (0, 11)):
        polygon.Add(gp_Pnt(x, y, 0))
    polygon.Close()
    bow = BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(polygon.Wire()).Face(), gp_Vec(0, 0, 5))
    path = made.write_brep(bow.Shape(), tmp_path / "bow.brep")
    with pytest.raises(
        CadError, match=r"face \d \(a plane at \(.*\)\): SelfIntersectingWire near \("
    ):
        so.cad.read_brep(path)


def test_a_hole_that_crosses_the_outer_wire(tmp_path: Path) -> None:
    from OCP.BRepBuilderAPI import (
        BRepBuilderAPI_MakeEdge,
        BRepBuilderAPI_MakeFace,
        BRepBuilderAPI_MakePolygon,
        BRepBuilderAPI_MakeWire,
    )
    from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
    from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Pnt, gp_Vec

    square = BRepBuilderAPI_MakePolygon()
    for x, y in ((0, 0), (10, 0), (10, 10), (0, 10)):
        square.Add(gp_Pnt(x, y, 0))
    square.Close()
    face = BRepBuilderAPI_MakeFace(square.Wire(), True)
    circle = gp_Circ(gp_Ax2(gp_Pnt(9, 5, 0), gp_Dir(0, 0, -1)), 2.0)
    face.Add(BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(circle).Edge()).Wire())
    solid = BRepPrimAPI_MakePrism(face.Face(), gp_Vec(0, 0, 5)).Shape()
    path = made.write_brep(solid, tmp_path / "crossing.brep")
    wires = r"face 6 \(a plane at \(.*, 0\)\): IntersectingWires near \(11, 5, 0\)"
    with pytest.raises(CadError, match=wires):
        so.cad.read_brep(path)


def test_a_solid_inside_out(tmp_path: Path) -> None:
    box = made.explored(made.box(1, 2, 3), "solid")[0]
    path = made.write_brep(box.Reversed(), tmp_path / "inside_out.brep")
    with pytest.raises(CadError, match=r"inside out: its 6 faces, from face 1 \(a plane\)"):
        so.cad.read_brep(path)
    report = so.cad.read_brep(path, heal=True).parts[0].report
    assert "turned its faces, which were inside out" in report.healed
    assert report.volume == pytest.approx(6.0)


def test_a_face_without_area(tmp_path: Path) -> None:
    from OCP.BRep import BRep_Builder
    from OCP.BRepBuilderAPI import (
        BRepBuilderAPI_MakeEdge,
        BRepBuilderAPI_MakeFace,
        BRepBuilderAPI_MakeWire,
    )
    from OCP.gp import gp_Dir, gp_Pln, gp_Pnt
    from OCP.TopoDS import TopoDS_Shell, TopoDS_Solid

    a, b = gp_Pnt(0, 0, 0), gp_Pnt(1, 0, 0)
    there = BRepBuilderAPI_MakeEdge(a, b)
    back = BRepBuilderAPI_MakeEdge(there.Vertex2(), there.Vertex1())
    wire = BRepBuilderAPI_MakeWire(there.Edge(), back.Edge()).Wire()
    flat = BRepBuilderAPI_MakeFace(gp_Pln(a, gp_Dir(0, 0, 1)), wire).Face()
    shell, solid, builder = TopoDS_Shell(), TopoDS_Solid(), BRep_Builder()
    builder.MakeShell(shell)
    builder.MakeSolid(solid)
    for face in (*made.explored(made.box(1, 2, 3), "face"), flat):
        builder.Add(shell, face)
    builder.Add(solid, shell)
    with pytest.raises(CadError, match=r"face 7 \(a plane\) has no area"):
        so.cad.read_brep(made.write_brep(solid, tmp_path / "flat.brep"))


def test_one_refused_part_refuses_all_unless_asked(tmp_path: Path) -> None:
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Compound

    compound, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(compound)
    builder.Add(compound, made.box(1, 1, 1))
    builder.Add(compound, _open_box())
    path = made.write_brep(compound, tmp_path / "two.brep")
    with pytest.raises(CadError, match="1 of 2 parts refused") as caught:
        so.cad.read_brep(path)
    assert len(caught.value.refusals) == 1
    readable = so.cad.read_brep(path, keep="readable")
    assert len(readable) == 1
    assert "left out" in readable.report()


def test_options_are_checked(tmp_path: Path) -> None:
    path = made.write_step(made.box(1, 2, 3), tmp_path / "box.step")
    for options in ({"unit": "furlong"}, {"keep": "some"}):
        with pytest.raises(so.StandoffError, match=r"give one of|give 'all'"):
            so.read_step(path, **options)
    with pytest.raises(TypeError, match="give True or False"):
        so.read_step(path, heal="yes")  # type: ignore[arg-type]


def test_without_opencascade_the_extra_is_named(tmp_path: Path) -> None:
    path = made.write_step(made.box(1, 2, 3), tmp_path / "box.step")
    code = (
        "import sys; sys.modules['OCP'] = None\n"
        "import standoff as so\n"
        f"so.read_step({str(path)!r})\n"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert "ModuleNotFoundError" in run.stderr
    assert "standoff[cad]" in run.stderr
