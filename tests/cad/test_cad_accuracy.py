"""What parts of a file miss each other by: measured, told, in the slack, or refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cad_shapes as made
import numpy as np
import pytest

import standoff as so
from draws import draws
from standoff.cad.files import stated_accuracy
from standoff.errors import CadError, StandoffError

pytest.importorskip("OCP", reason="OpenCASCADE comes with the extra 'cad'")

PARTS = Path(__file__).resolve().parents[3] / "shared" / "parts"


def bent_box(by: float) -> Any:
    """A box of 10 x 10 x 10 with one edge that leaves both of its faces, by a length at most."""
    shape = made.box(10, 10, 10)
    return bent(shape, made.explored(shape, "edge")[0], by)


def bent(shape: Any, edge: Any, by: float) -> Any:
    """A shape one of whose straight edges is bent away from (5, 5, 5), by a length at most."""
    from OCP.BRep import BRep_Builder, BRep_Tool
    from OCP.gp import gp_Pnt

    curve = BRep_Tool.Curve_s(edge, 0.0, 0.0)
    first, last = BRep_Tool.Range_s(edge)
    ends = [np.array(p.Coord()) for p in (curve.Value(first), curve.Value(last))]
    out = 0.5 * sum(ends) - 5.0
    out /= np.linalg.norm(out)
    # a parabola is as far from its chord as half of its middle control point
    points = [ends[0], 0.5 * sum(ends) + 2.0 * by * out, ends[1]]
    bend = spline([gp_Pnt(*p.tolist()) for p in points], first, last)
    BRep_Builder().UpdateEdge(edge, bend, 1e-7)
    return shape


def _ends(edge: Any) -> set[tuple[int, ...]]:
    ends = [made._point(vertex) for vertex in made.explored(edge, "vertex")]
    return {tuple(round(x) for x in end) for end in ends}


def test_faces_that_share_a_vertex_do_not_cross_there() -> None:
    """A boss beside a plate reaches above it: its round face and the plate's top meet in two
    points. The slack of a bent edge elsewhere makes what counts as near wider than these are."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Fuse

    boss = made.turned_cylinder((5.0, -1.8, 8.75), (0.0, 1.0, 0.0), 1.7, 1.8)
    shape = BRepAlgoAPI_Fuse(made.box(10, 10, 10), boss).Shape()
    edge = next(e for e in made.explored(shape, "edge") if _ends(e) == {(0, 10, 0), (10, 10, 0)})
    report = so.cad.from_shape(bent(shape, edge, 2e-3), tolerance=0.01)[0].report
    assert report.slack > 1e-3
    assert not any("crosses" in line for line in report.self_intersections)


def spline(points: list[Any], first: float, last: float, flat: bool = False) -> Any:
    """A spline of one span with control points, over a range."""
    from OCP import collections as arrays
    from OCP.Geom import Geom_BSplineCurve
    from OCP.Geom2d import Geom2d_BSplineCurve

    poles = (arrays.Array1_gp_Pnt2d if flat else arrays.Array1_gp_Pnt)(1, len(points))
    for k, point in enumerate(points, 1):
        poles.SetValue(k, point)
    knots, times = arrays.Array1_double(1, 2), arrays.Array1_int(1, 2)
    for k, knot in enumerate((first, last), 1):
        knots.SetValue(k, knot)
        times.SetValue(k, len(points))
    return (Geom2d_BSplineCurve if flat else Geom_BSplineCurve)(
        poles, knots, times, len(points) - 1
    )


def poorly_trimmed(by: float, rng: np.random.Generator) -> Any:
    """A twisted prism whose trimming curves on its spline faces are off, to the side and along
    their edges, by up to a share of a fifth of the face; the edges in space are right."""
    from OCP.BRep import BRep_Builder, BRep_Tool
    from OCP.gp import gp_Pnt2d

    shape = made.twisted()
    for face in made.explored(shape, "face")[:4]:
        for edge in made.explored(face, "edge"):
            flat = BRep_Tool.CurveOnSurface_s(edge, face, 0.0, 0.0)
            first, last = BRep_Tool.Range_s(edge)
            ends = [np.array(flat.Value(t).Coord()) for t in (first, last)]
            points = np.linspace(*ends, 5)
            length = 0.2 * float(np.linalg.norm(ends[1] - ends[0]))
            points[1:4] += rng.uniform(-1.0, 1.0, (3, 2)) * by * length
            poor = spline([gp_Pnt2d(*p.tolist()) for p in points], first, last, flat=True)
            BRep_Builder().UpdateEdge(edge, poor, face, 1e-7)
    return shape


@pytest.mark.parametrize("by", [1e-5, 1e-3, 0.02])
def test_an_edge_that_leaves_its_faces_is_refused_or_in_the_slack(by: float) -> None:
    """The edge of a box is bent: the slack is what it is off by, neither less nor much more."""
    with pytest.raises(CadError, match=r"face \d \(a plane at \(.*tolerance=.*becomes slack"):
        so.cad.from_shape(bent_box(by))
    with pytest.raises(CadError):
        so.cad.from_shape(bent_box(by), tolerance=0.6 * by)
    report = so.cad.from_shape(bent_box(by), tolerance=1.2 * by)[0].report
    off = by / np.sqrt(2.0)  # of either plane: it is bent along their diagonal
    assert off * (1.0 - 1e-9) <= report.trim_bound <= 1.1 * off
    assert report.slack >= report.trim_bound
    assert report.allowed == pytest.approx(1.2 * by)


def test_the_slack_is_inside_the_bounds() -> None:
    part = so.cad.from_shape(bent_box(0.02), tolerance=0.05)[0]
    far = np.array([0.0, 0.0, 30.0])
    answer = so.distance(part.solid, so.shapes.sphere(1.0), None, (np.eye(3), far))
    assert answer.slack >= part.report.slack > 0.014
    assert answer.lower_bound <= answer.distance - part.report.slack + 1e-12


@pytest.mark.parametrize("by", [1e-4, 1e-2])
def test_a_poor_trimming_curve_of_a_good_edge_is_made_anew(
    by: float, rng: np.random.Generator
) -> None:
    right = so.cad.from_shape(poorly_trimmed(0.0, rng))[0].report
    found = so.cad.from_shape(poorly_trimmed(by, rng))[0].report
    assert found.trims is not None
    assert found.trims.get("fitted", 0) > 0
    assert found.slack <= 1e-6 * found.size
    assert found.volume == pytest.approx(right.volume, rel=1e-6)
    assert found.area == pytest.approx(right.area, rel=1e-6)


def test_a_bound_of_a_trim_is_above_what_it_misses(rng: np.random.Generator) -> None:
    """Made anew or the file's: at many more points than it was made from."""
    from standoff.bodies.charts import loop_pcurve
    from standoff.cad.making import trim_bound
    from standoff.cad.measures import size_of
    from standoff.cad.miss_bounds import misses
    from standoff.cad.pieces import pieces_of
    from standoff.cad.seams import without_seams

    for _ in range(draws(6)):
        shape = poorly_trimmed(10.0 ** rng.uniform(-6.0, -1.0), rng)
        solid, _, numbers = without_seams(shape)
        pieces = pieces_of(solid, size_of(shape), shape, numbers)
        bound, _ = trim_bound(pieces, size_of(shape))
        for face in pieces.faces:
            for entry, (number, _) in enumerate(face.loop):
                curve = pieces.edges[number].curve
                pcurve = loop_pcurve(face, entry, pieces.edges, face.charts[0])
                ts = np.linspace(curve.first, curve.last, 2001)
                off = misses(pcurve, curve, face.charts[0], ts).max()
                assert off <= bound + 1e-14 * size_of(shape)


@pytest.mark.parametrize("off", [0.0, 1e-4, 3e-3])
def test_a_circle_beside_a_sphere_is_bounded_all_along(off: float) -> None:
    from standoff.cad.closed_bounds import sphere_bound
    from standoff.geometry import Sphere
    from standoff.geometry.curves import ConicArc

    centre, x, y = np.array([0.1, 0.0, 0.6]), np.array([0.8, 0.0, 0.0]), np.array([0.0, 0.8, 0.0])
    arc = ConicArc(centre * [off, 0.0, 1.0], x, y, 0.1, 1.3)
    bound = sphere_bound(arc, Sphere(np.eye(3), np.zeros(3)))
    points = arc.points(np.linspace(0.0, 2.0 * np.pi, 1001))
    seen = np.abs(np.linalg.norm(points, axis=1) - 1.0).max()
    assert seen <= bound + 1e-15
    assert bound <= 1.1 * seen + 1e-14


def test_a_cone_whose_tip_is_beside_its_vertex_is_not_taken_as_exact() -> None:
    from OCP.BRep import BRep_Builder
    from OCP.gp import gp_Pnt

    shape = made.cone()
    tip = next(v for v in made.explored(shape, "vertex") if made._point(v)[2] > 20.0)
    BRep_Builder().UpdateVertex(tip, gp_Pnt(0.0, 0.003, 25.0), 1e-7)
    with pytest.raises(CadError, match=r"0\.003"):
        so.cad.from_shape(shape)
    report = so.cad.from_shape(shape, tolerance=0.01)[0].report
    assert 0.003 * (1.0 - 1e-9) <= report.trim_bound <= 0.0031
    assert report.slack >= report.trim_bound


CLAIMS = {
    "#1=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(0.01),#2,'','');": 1e-5,
    "#1=UNCERTAINTY_MEASURE_WITH_UNIT (LENGTH_MEASURE(\n 1.E-02 ), #2, '','');": 1e-5,
    "#1=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(0.001),#3,'','');": 2.54e-5,
    "#1=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(0.),#2,'','');": 0.0,
    "#1=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.),#4,'','');": 1.0,
    "#1=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.),#9,'','');": 0.0,
    "": 0.0,
}
UNITS = """#2=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));
#3=(CONVERSION_BASED_UNIT('INCH',#5)LENGTH_UNIT()NAMED_UNIT(#6));
#4=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.));
#9=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));
"""


def test_the_accuracy_that_a_file_states(tmp_path: Path) -> None:
    for entity, metres in CLAIMS.items():
        file = tmp_path / "claim.step"
        file.write_text(UNITS + entity)
        assert stated_accuracy(file) == pytest.approx(metres, rel=1e-12), entity


@pytest.mark.parametrize("claim", [0.0, 0.03, 1000.0])
def test_what_a_file_claims_is_allowed(claim: float) -> None:
    """An edge of a box of size 17 is off by 0.1: too much for what a file of that size may claim;
    by 0.01 it is within it."""
    from standoff.cad.making import made_part

    bent = [made.explored(bent_box(by), "solid")[0] for by in (0.1, 0.01)]
    assert made_part(bent[0], "box", False, claim).shape is None
    found = made_part(bent[1], "box", False, claim)
    assert (found.shape is not None) == (claim > 0.0)
    if found.shape is None:
        assert "the file says nothing" in found.report.refused
    else:
        lines = "\n".join(found.report.lines("mm"))
        assert "its faces miss its edges by at most that" in lines
        assert f"the file says {claim:.3g}" in lines


@pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf, "wide"])
def test_a_tolerance_that_is_none_is_refused(value: Any) -> None:
    with pytest.raises((StandoffError, TypeError), match="tolerance"):
        so.cad.from_shape(made.box(1, 1, 1), tolerance=value)


def test_the_command_takes_a_tolerance(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from standoff.cli import main

    path = made.write_brep(bent_box(0.01), tmp_path / "bent.brep")
    assert main(["check", str(path)]) == 2
    assert "tolerance=" in capsys.readouterr().err
    assert main(["check", str(path), "--tolerance", "0.02", "--heal"]) == 0
    assert "by at most that" in capsys.readouterr().out
    assert main(["clearance", str(path), "--tolerance", "0.02"]) in (0, 3)
    assert main(["check", 'shape = "sphere", radius = 1', "--heal"]) == 2
    assert "for CAD files" in capsys.readouterr().err


FILES = {
    # what the faces of real files miss their edges by, at most, mm
    "tail_turbine_prt.stp": 0.004,
    "dm1-id-214.stp": 1e-6,
    "featuretype.STEP": 1e-7,
    "io1-tu-203.stp": 1e-6,
    "lower_leg_structure_fork.STEP": 8e-4,
    "sContainer1-B-1.step": 1e-5,
    "fLocator1-_-0.step": 6e-4,
}
SOAKED = [*FILES][3:]


@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=pytest.mark.soak) if n in SOAKED else n for n in FILES],
)
def test_a_file_that_nobody_here_made_loads(name: str) -> None:
    if not (PARTS / name).exists():
        pytest.skip(f"{name} is not beside this checkout")
    assembly = so.read_step(PARTS / name)
    assert not assembly.refusals
    for part in assembly:
        assert part.report.slack <= FILES[name]
        assert part.report.slack <= part.report.allowed
        assert "=>" not in part.name


def test_the_parameter_along_a_collapsed_side_stays() -> None:
    """Points beside a patch with a side that is one point, whose feet would go to its far end."""
    from types import SimpleNamespace

    from standoff.cad.trims import feet
    from standoff.geometry import BezierPatch

    u, v = np.meshgrid(np.linspace(0.0, 1.0, 4), np.linspace(0.0, 1.0, 4), indexing="ij")
    net = np.stack([u * (1.0 - v), v, 0.1 * v**2], axis=-1)
    on = SimpleNamespace(surface=BezierPatch(net), angles=np.array([False, False]))
    near = np.array([[0.0, 1.0 - away] for away in (0.0, 1e-12, 1e-9, 0.5)])
    points = on.surface.points(near) + np.array([1e-3, 0.0, 0.0])
    found = feet(on, points, near)
    np.testing.assert_allclose(found[:3, 0], 0.0, atol=1e-12)
    assert found[3, 0] == pytest.approx(2e-3, rel=1e-3)


def test_a_curve_through_a_corner_of_knots_crosses_them_once() -> None:
    from standoff.cad.trims import _crossed
    from standoff.geometry.curves import Line
    from standoff.geometry.nurbs import NurbsSurface

    u, v = np.meshgrid(np.linspace(0.0, 1.0, 3), np.linspace(0.0, 1.0, 3), indexing="ij")
    knots = [0.0, 0.0, 0.3, 1.0, 1.0]
    at = np.array([0.0, 0.3, 1.0])
    bent = np.zeros((3, 3))
    bent[1, 1] = 0.1
    net = np.stack([at[:, None] + 0.0 * v, at[None] + 0.0 * u, bent], axis=-1)
    surface = NurbsSurface(net, knots, knots)
    line = Line([0.0, 0.0, 0.0], [1.0, 1.0, 0.0])

    def places(ts: np.ndarray) -> np.ndarray:
        return np.stack([ts, ts * (1.0 + 1e-15)], axis=1) / line.last

    found = _crossed(places, line, surface)
    np.testing.assert_allclose(found, [0.3 * line.last], rtol=1e-12)


@pytest.mark.parametrize("before", [0.0, 1e-6, -1e-6, 0.3])
def test_a_part_of_a_periodic_spline_begins_where_its_face_does(before: float) -> None:
    """OpenCASCADE gives one that begins a little before the first knot a period further on."""
    from OCP.Geom import Geom_CylindricalSurface, Geom_RectangularTrimmedSurface
    from OCP.GeomConvert import GeomConvert
    from OCP.gp import gp_Ax3

    from standoff.cad.surfaces import carrier

    tube = Geom_RectangularTrimmedSurface(
        Geom_CylindricalSurface(gp_Ax3(), 2.0), 0.0, 2.0 * np.pi, 0.0, 1.0
    )
    spline = GeomConvert.SurfaceToBSplineSurface_s(tube)
    spline.SetUPeriodic()
    over = (-before, 3.0 - before, 0.0, 1.0)
    made = carrier(spline, over).surface
    np.testing.assert_allclose(made.domain, over, atol=1e-9)
    for u in np.linspace(*over[:2], 7):
        np.testing.assert_allclose(
            made.jet(float(u), 0.4)[0], spline.Value(float(u), 0.4).Coord(), atol=1e-12
        )


@pytest.mark.parametrize("width", [0.01, 0.3, 2.0, 2.0 * np.pi])
def test_a_short_arc_is_bounded_over_itself_alone(width: float, rng: np.random.Generator) -> None:
    """Its circle leaves the plane, or the sphere, by as much as its radius elsewhere."""
    from standoff.cad.closed_bounds import closed_bound, sphere_bound
    from standoff.geometry import Plane, Sphere
    from standoff.geometry.curves import ConicArc
    from standoff.geometry.exact_pcurves import pcurve_of

    for _ in range(20):
        first = rng.uniform(0.0, 6.0)
        turned = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        centre = rng.normal(size=3)
        arc = ConicArc(centre, 3.0 * turned[:, 0], 3.0 * turned[:, 1], first, first + width)
        points = arc.points(np.linspace(arc.first, arc.last, 2001))

        middle = points[1000]
        tangent = arc.jet(0.5 * (arc.first + arc.last))[1] / 3.0
        across = np.cross(tangent, rng.normal(size=3))
        plane = Plane.through(middle, tangent, across / np.linalg.norm(across))
        flat = pcurve_of(arc, plane)
        bound = closed_bound(flat, arc, plane)
        seen = np.linalg.norm(
            plane.points(flat.places(np.linspace(arc.first, arc.last, 2001))) - points, axis=1
        ).max()
        assert bound is not None
        assert seen <= bound + 1e-12
        assert bound <= 1.03 * seen + 1e-12

        sphere = Sphere(
            1.5 * np.eye(3), middle - 1.5 * np.cross(tangent, across / np.linalg.norm(across))
        )
        seen = np.abs(np.linalg.norm(points - sphere.shift, axis=1) - 1.5).max()
        if seen < 0.7:
            assert seen <= sphere_bound(arc, sphere) + 1e-12 <= 2.0 * seen + 1e-11
