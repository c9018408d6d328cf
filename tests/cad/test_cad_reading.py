"""CAD files against OpenCASCADE: volumes, areas, points inside, kinds, names, places, units."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

import cad_shapes as made
import numpy as np
import pytest

import standoff as so
from shares import only
from standoff.bodies.face_leaves import face_charts
from standoff.geometry import Cone, Cylinder, NurbsSurface, Plane, Sphere, Torus
from standoff.solids.spatial import edge_kinds
from standoff.solids.spatial.trims import columns_of, pieces_of
from standoff_studies.soak.solid_parts import MAKERS

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


def test_a_judge_that_is_wrong_refuses_no_part(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where both of OpenCASCADE's rules are off, a quadrature that tells its error is asked; a face
    that is wrong is refused all the same."""
    from standoff.cad import making, measures

    shape = made.flange()
    right = so.cad.from_shape(shape)[0].report
    for name in ("area_of", "volume_of"):
        own = getattr(measures, name)
        monkeypatch.setattr(measures, name, partial(_off, own))
        monkeypatch.setattr(making, name, partial(_off, own))
    found = so.cad.from_shape(shape)[0].report
    assert found.area == right.area
    assert max(found.area_error, found.volume_error) < 1e-9
    assert not found.notes
    own_area = making.face_area
    monkeypatch.setattr(making, "face_area", lambda *given: 1.00001 * own_area(*given))
    with pytest.raises(so.cad.CadError, match=r"face 1 \(a \w+ at \(.*: its area is"):
        so.cad.from_shape(shape)


def _off(measure: Callable[..., float], shape: Any, adaptive: bool = False) -> float:
    return 1.0001 * measure(shape, adaptive)


QUADRATURES = ("flange", "elbow", "cone", "twisted", "hollow", "drilled tube")


@pytest.mark.parametrize("name", only(["elbow", "twisted"], QUADRATURES))
def test_the_quadrature_of_faces(name: str) -> None:
    from standoff.cad.measures import face_integrals

    shape = SHAPES[name][0]()
    parts = [face_integrals(f, np.array([1.0, 2.0, 3.0])) for f in made.explored(shape, "face")]
    volume, area = made.measured(shape)
    assert sum(abs(part.values[0]) for part in parts) == pytest.approx(area, rel=1e-9)
    assert sum(part.values[1] for part in parts) / 3.0 == pytest.approx(volume, rel=1e-8)
    assert max(part.error[0] for part in parts) <= 1e-8 * area


def test_names_are_those_that_a_person_gave(tmp_path: Path) -> None:
    """Those of OpenCASCADE are none: the file's takes their place; equal ones are numbered."""
    path = made.write_assembly(tmp_path / "two rods.step", ("base", "rod", "rod"))
    assert [part.name for part in so.read_step(path)] == ["base", "rod", "rod (2)"]
    path = made.write_assembly(tmp_path / "unnamed.step", ("=>[0:1:1:3]", "rod", "rod (2)"))
    names = [part.name for part in so.read_step(path)]
    assert names[1:] == ["rod", "rod (2)"]
    assert "=>" not in names[0]
    path = made.write_step(made.box(1, 2, 3), tmp_path / "small box.step")
    assert so.read_step(path)[0].name == "small box"


def test_lines_of_opencascade_are_not_printed(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    path = made.write_step(made.box(1, 2, 3), tmp_path / "box.step")
    text = path.read_text().replace("DATA;", "DATA;\n#99999=CARTESIAN_POINT('',((0.,0.,0.));", 1)
    path.write_text(text)
    capfd.readouterr()
    with suppress(so.cad.CadError):
        so.read_step(path)
    printed = capfd.readouterr()
    assert "ERR" not in printed.out + printed.err


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


def test_smooth_edges_along_which_normals_turn_need_no_cones(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """With the cones, their kinds and those of all others are told the same."""
    turning, seen = edge_kinds._turning, []

    def noted(*given: Any) -> bool:
        seen.append(turning(*given))
        return seen[-1]

    for solid in (MAKERS["elbow"](), so.cad.from_shape(made.filleted_box())[0].solid):
        boundary = solid.boundary
        charts = {chart.number: chart for chart in face_charts(boundary)}
        pieces = pieces_of(boundary, charts)
        given = boundary, charts, pieces, columns_of(pieces)
        monkeypatch.setattr(edge_kinds, "_turning", noted)
        told = edge_kinds.proven_kinds(*given)
        monkeypatch.setattr(edge_kinds, "_turning", lambda *given: False)
        assert told == edge_kinds.proven_kinds(*given)
    assert set(seen) == {True, False}
