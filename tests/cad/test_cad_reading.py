"""CAD files against OpenCASCADE: volumes, areas, points inside, kinds, names, places, units."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import cad_shapes as made
import numpy as np
import pytest

import standoff as so
from shares import only
from standoff.geometry import Cone, Cylinder, NurbsSurface, Plane, Sphere, Torus

pytest.importorskip("OCP", reason="OpenCASCADE comes with the extra 'cad'")

SHAPES: dict[str, tuple[Callable[[], Any], dict[str, int]]] = {
    "filleted box": (made.filleted_box, {"plane": 6, "cylinder": 12, "sphere": 8}),
    "plate": (made.plate, {"plane": 11, "cylinder": 4}),
    "flange": (made.flange, {"plane": 4, "cylinder": 9, "torus": 1}),
    "elbow": (made.elbow, {"plane": 2, "torus": 2}),
    "cone": (made.cone, {"plane": 1, "cone": 1}),
    "twisted": (made.twisted, {"plane": 2, "spline": 4}),
    "drilled tube": (made.drilled_tube, {"plane": 2, "cylinder": 2}),
    "hollow": (made.hollow, {"plane": 6, "sphere": 1}),
    "dimpled": (made.dimpled, {"plane": 6, "sphere": 1}),
}
KINDS = {
    "plane": Plane,
    "cylinder": Cylinder,
    "cone": Cone,
    "sphere": Sphere,
    "torus": Torus,
    "spline": NurbsSurface,
}
FITTED = {"drilled tube": 1e-7, "twisted": 1e-7}
"""Parts whose trims or tolerances allow a relative difference above 1e-9."""


OTHERS = ("plate", "elbow", "dimpled")
"""Parts whose kinds of faces others have too."""


@pytest.mark.parametrize("name", only(set(SHAPES) - {*OTHERS}, SHAPES))
def test_a_part(name: str, tmp_path: Path, rng: np.random.Generator) -> None:
    from OCP.BRepClass3d import BRepClass3d_SolidClassifier
    from OCP.gp import gp_Pnt
    from OCP.TopAbs import TopAbs_IN

    maker, kinds = SHAPES[name]
    shape = maker()
    assembly = so.read_step(made.write_step(shape, tmp_path / "part.step"))
    part = assembly.parts[0]
    volume, area = made.measured(shape)
    near = FITTED.get(name, 1e-9)
    np.testing.assert_allclose(part.report.volume, volume, rtol=near)
    np.testing.assert_allclose(part.report.area, area, rtol=near)
    assert part.report.faces == kinds
    for face in part.shape.face_parts:
        assert isinstance(face.charts[0], tuple(KINDS[kind] for kind in kinds))
    assert isinstance(part.shape, so.Body) == (name in ("filleted box", "cone"))
    if name == "drilled tube":  # splines on cylinders: not exact, but bounded
        report = part.report
        assert report.trims is not None
        assert report.trims.get("fitted", 0) + report.trims.get("file", 0) >= 2
        assert 0.0 < report.trim_bound <= report.slack <= 4.0 * report.tolerance
        assert part.shape.check().slack == report.slack
    low, high = _box(part.shape)
    points = rng.uniform(low - 1.0, high + 1.0, (40, 3))
    expected = [
        BRepClass3d_SolidClassifier(shape, gp_Pnt(*p.tolist()), 1e-9).State() == TopAbs_IN
        for p in points
    ]
    np.testing.assert_array_equal(part.shape.contains(points), expected)


def _box(shape: Any) -> tuple[np.ndarray, np.ndarray]:
    points = np.array(
        [e.curve.point(t) for e in shape.edge_parts for t in (e.curve.first, e.curve.last)]
    )
    return points.min(axis=0), points.max(axis=0)


def test_an_assembly_has_names_places_and_colours(tmp_path: Path) -> None:
    names = ("Grundplatte Ä", "棒", "вал")
    assembly = so.read_step(made.write_assembly(tmp_path / "all 部品.step", names))
    assert tuple(part.name for part in assembly) == names
    assert assembly["棒"] is assembly.parts[1]
    base, left, right = assembly.parts
    assert left.shape is right.shape
    assert isinstance(left.shape, so.Body)
    assert base.colour == (1.0, 0.0, 0.0, 1.0)
    np.testing.assert_allclose(left.pose[:3, 3], [20, 0, 5], atol=1e-12)
    np.testing.assert_allclose(right.pose[:3, :3] @ [0, 0, 1], [0, -1, 0], atol=1e-12)
    apart = so.distance(base.shape, left.shape, base.pose, left.pose)
    np.testing.assert_allclose(apart.distance, 8.0, rtol=1e-12)


def test_parts_that_bend_inward_answer_as_solids(tmp_path: Path) -> None:
    part = so.read_step(made.write_step(made.plate(), tmp_path / "plate.step")).parts[0]
    assert not isinstance(part.shape, so.Body)
    assert part.solid is part.solid
    above = np.array([0.0, 0.0, 8.5])
    apart = so.distance(part.solid, part.solid, None, (np.eye(3), above))
    np.testing.assert_allclose(apart.distance, 0.5, rtol=1e-9)


def test_the_nearer_of_two_rules_is_compared(monkeypatch: pytest.MonkeyPatch) -> None:
    from standoff.cad.measures import nearest

    asked: list[bool] = []

    def measure(shape: Any, adaptive: bool) -> float:
        asked.append(adaptive)
        return -1.0 if adaptive else 1.01

    assert nearest(measure, None, 1.005, 0.01) == 1.01
    assert asked == [False]
    monkeypatch.setattr("standoff.cad.measures.area_of", lambda shape: 64.0)
    monkeypatch.setattr("standoff.cad.measures._divided", lambda shape, most: most)
    assert nearest(measure, None, 1.001, 1e-6) == 1.0
    assert asked == [False, False, True, True, True]


def test_inches_are_converted_and_told(tmp_path: Path) -> None:
    path = made.write_step(made.box(25.4, 25.4, 50.8), tmp_path / "inch.step", unit="INCH")
    assembly = so.read_step(path)
    assert (assembly.unit, assembly.file_unit) == ("mm", "inch")
    assert "converted from inch" in assembly.report()
    np.testing.assert_allclose(assembly.parts[0].report.volume, 25.4**3 * 2, rtol=1e-12)
    metres = so.read_step(path, unit="m")
    np.testing.assert_allclose(metres.parts[0].report.volume, 0.0254**3 * 2, rtol=1e-12)


def test_a_brep_file_and_a_wrapped_shape(tmp_path: Path) -> None:
    class Wrapped:
        wrapped = made.plate()

    from_file = so.cad.read_brep(made.write_brep(Wrapped.wrapped, tmp_path / "plate.brep"))
    assert from_file.unit == ""
    wrapped = so.cad.from_shape(Wrapped(), name="plate")
    assert wrapped.parts[0].report.volume == from_file.parts[0].report.volume
    with pytest.raises(TypeError, match="give a TopoDS_Shape"):
        so.cad.from_shape(3)


def test_an_iges_file_needs_healing(tmp_path: Path) -> None:
    from OCP.IGESControl import IGESControl_Writer

    writer = IGESControl_Writer("MM", 0)
    writer.AddShape(made.box(10, 20, 30))
    path = tmp_path / "box.igs"
    writer.Write(str(path))
    with pytest.raises(so.cad.CadError, match="heal=True"):
        so.cad.read_iges(path)
    part = so.cad.read_iges(path, heal=True).parts[0]
    assert any("sewn" in one for one in part.report.healed)
    np.testing.assert_allclose(part.report.volume, 6000.0, rtol=1e-9)


def test_the_check_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from standoff.cli import main

    path = made.write_step(made.plate(), tmp_path / "plate.step")
    capsys.readouterr()
    assert main(["check", str(path)]) == 0
    told = capsys.readouterr().out
    assert "plate.step: 1 part, lengths in mm" in told
    assert "15 faces (4 cylinder, 11 plane)" in told
    assert "not convex: a Boundary" in told
    assert main(["check", str(path), "--json"]) == 0
    assert '"file_unit": "mm"' in capsys.readouterr().out
    path.write_text("")
    assert main(["check", str(path)]) == 2
