"""Where a face of a file is: spheres with holes that are no circles, and parts that cross
themselves."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import cad_shapes as made
import numpy as np
import pytest

import standoff as so
from shares import only
from standoff.bodies.face_leaves import face_charts
from standoff.cad.trims import of_file
from standoff.cli import main
from standoff.errors import CadError
from standoff.solids.spatial.self_intersections import NONE_PROVEN

RADIUS = 12.4
BLIND = (0.0, 3.0, 1.0, 1.0, 0.0, 0.0, 4.0)
THROUGH = (-30.0, 3.0, 1.0, 1.0, 0.0, 0.0, 4.0)
OTHER = (0.0, -30.0, 2.0, 0.0, 1.0, 0.2, 2.0)


HOLES = [(BLIND,), (THROUGH,), (BLIND, OTHER)]


@pytest.mark.parametrize("holes", only(HOLES[2:], HOLES), ids=str)
def test_a_ball_with_holes_off_its_centre(holes: tuple[tuple[float, ...], ...]) -> None:
    shape = made.drilled_ball(RADIUS, *holes)
    part = so.cad.from_shape(shape)[0]
    volume, area = made.measured(shape)
    assert part.report.faces["sphere"] == 1
    # areas of faces are compared with OpenCASCADE's as the part is read
    assert part.report.volume == pytest.approx(volume, rel=1e-6)
    assert part.report.area == pytest.approx(area, rel=1e-6)
    assert part.report.area < 4.0 * np.pi * RADIUS**2 + part.report.faces["cylinder"] * 800.0
    assert not part.solid.contains([[6.0, 3.0, 1.0]])[0]
    assert part.solid.contains([[-RADIUS + 0.1, -1.0, -1.0]])[0]


def test_a_part_that_crosses_itself_is_refused_with_both_faces_and_the_place() -> None:
    with pytest.raises(CadError, match="it crosses itself: face") as raised:
        so.cad.from_shape(made.crossing_shells())
    assert re.search(r"face 2 \(a plane at \(2, .*\)\) crosses face", str(raised.value))
    assert "near (2, " in str(raised.value)


def test_what_is_found_of_a_part_is_in_its_report(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = made.write_step(made.plate(), tmp_path / "plate.step")
    assert so.read_step(file)[0].report.self_intersections == (NONE_PROVEN,)
    assert main(["check", str(file)]) == 0
    assert NONE_PROVEN in capsys.readouterr().out


def test_a_trimming_curve_that_is_given_a_turn_away_is_turned_back() -> None:
    """A file of an electronic part has its edge over (0.32, 3.14), the spline over (3.46, 9.42)."""
    from OCP import collections as arrays
    from OCP.Geom2d import Geom2d_BSplineCurve
    from OCP.gp import gp_Pnt2d

    poles, knots = arrays.Array1_gp_Pnt2d(1, 3), arrays.Array1_double(1, 2)
    times = arrays.Array1_int(1, 2)
    places = np.array([(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)])
    for k, place in enumerate(places, 1):
        poles.SetValue(k, gp_Pnt2d(*place))
    for k, knot in enumerate((3.46, 9.42), 1):
        knots.SetValue(k, knot)
        times.SetValue(k, 3)
    flat = Geom2d_BSplineCurve(poles, knots, times, 2)
    curve = SimpleNamespace(first=0.32, last=3.13)
    edge: Any = SimpleNamespace(own=lambda ts: ts, curve=curve, scale=1.0, shift=0.0)
    on: Any = SimpleNamespace(to_own=np.eye(2, 3), own=lambda points: points)
    found = of_file(flat, edge, on)
    assert found is not None
    share = (1.0 + 2.0 * np.pi - 3.46) / (9.42 - 3.46)
    row = np.array([(1 - share) ** 2, 2 * share * (1 - share), share**2])
    assert np.allclose(found.point(1.0)[:2], row @ places, atol=1e-12)
    curve.first, curve.last = 20.0, 21.0
    assert of_file(flat, edge, on) is None


def shaft() -> Any:
    return made.cylinder((0, 0, -1), 1.0, 2.0)


def dented(x: float, y: float) -> tuple[Any, list[tuple[float, float, float]]]:
    cut = made.cut(shaft(), made.ball((x, y, 0.0), 0.3))
    return cut, [(0.9 * x, 0.9 * y, 0.0), (x, y, 0.1), (0.85 * x, 0.85 * y, -0.1)]


SEAMS: dict[str, Callable[[], tuple[Any, list[tuple[float, float, float]]]]] = {
    # a shape with a hole, and points in the hole, 0.05 or more from its wall
    "drilled shaft": lambda: (
        made.cut(shaft(), made.turned_cylinder((-2, 0, 0), (1, 0, 0), 0.4, 4.0)),
        [(-0.9, 0, 0), (0.9, 0, 0), (1.0, 0, 0), (0.9, 0.2, -0.2)],
    ),
    "square hole in a cone": lambda: (
        made.cut(
            made.blunt_cone((0, 0, -1), 1.0, 0.5, 2.0), made.box(4.0, 0.4, 0.4, (-2.0, -0.2, -0.2))
        ),
        [(0.76, 0, 0), (-0.76, 0.1, 0), (0.7, -0.1, 0.1)],
    ),
    "dent at 0": lambda: dented(1.0, 0.0),
    "dent at half a turn": lambda: dented(-1.0, 0.0),
    "dent somewhere": lambda: dented(0.6, 0.8),
    "ring, drilled outside": lambda: (
        made.cut(made.ring(2.0, 0.5), made.turned_cylinder((0, 0, 0), (-1, 0, 0), 0.2, 4.0)),
        [(-1.6, 0, 0), (-2.0, 0.1, 0), (-2.45, 0, 0.1)],
    ),
    "ball, drilled off its axis": lambda: (
        made.cut(
            made.ball((0, 0, 0), 1.0), made.turned_cylinder((-2, 0.2, 0.1), (1, 0, 0), 0.3, 4)
        ),
        [(0.9, 0.2, 0.1), (-0.9, 0.3, 0.1), (0.0, 0.1, 0.0)],
    ),
}


@pytest.mark.parametrize("name", only(["drilled shaft", "dent at half a turn"], list(SEAMS)))
def test_a_hole_across_a_seam_or_past_a_pole_is_there(name: str) -> None:
    shape, inside = SEAMS[name]()
    part = so.cad.from_shape(shape)[0]
    answer = part.solid.signed_distance(inside)
    own = made.from_boundary(shape, inside)
    assert answer.distance == pytest.approx(own, abs=1e-6)
    assert (answer.lower_bound > 0.0).all()
    ball = so.shapes.sphere(0.02)
    for point, true in zip(inside, own, strict=True):
        pose = np.eye(4)
        pose[:3, 3] = point
        assert so.distance(part.solid, ball, np.eye(4), pose).distance == pytest.approx(
            true - 0.02, abs=1e-6
        )
    for chart in face_charts(part.shape):
        u0, u1, _, _ = chart.rectangle
        assert not chart.surface.periodic or u1 - u0 <= 2.0 * np.pi + 1e-9
