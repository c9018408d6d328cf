"""Faces of every kind that closes, drilled through their seams: each point of them stands once."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import cad_shapes as made
import numpy as np
import pytest

import standoff as so
from shares import only
from standoff.bodies.face_leaves import FaceChart, face_charts
from standoff.cad.making import face_area
from standoff.kernels.entries.queries import on_face, surface_jets
from standoff.solids.spatial.leaves import face_leaves
from standoff.solids.spatial.trims import pieces_of
from standoff.typing import Array

OVAL = [(2.5, 0.0), (2.1, 0.5), (1.6, 0.3), (1.5, -0.2), (2.0, -0.5)]
NODES = 10
"""Along each side of a leaf."""


def hole(z: float = 0.03) -> Any:
    """Along x, from the middle out, through where u and v are 0."""
    return made.turned_cylinder((0.0, 0.0, z), (1, 0, 0), 0.2, 4.0)


def shaft() -> Any:
    return made.cylinder((0, 0, -1), 1.0, 2.0)


KINDS: dict[str, Callable[[], Any]] = {
    "cylinder": shaft,
    "cone": lambda: made.blunt_cone((0, 0, -1), 1.0, 0.5, 2.0),
    "ball": lambda: made.ball((0, 0, 0), 1.0),
    "torus": lambda: made.ring(2.0, 0.5),
    "revolved spline": lambda: made.spun(OVAL),
    "extruded spline": lambda: made.pulled(OVAL, 1.0),
    "cylinder as splines": lambda: made.as_splines(shaft()),
    "ball as splines": lambda: made.as_splines(made.ball((0, 0, 0), 1.0)),
    "torus as splines": lambda: made.as_splines(made.ring(2.0, 0.5)),
}


def read_back(shape: Any, folder: Path) -> Any:
    from OCP.BRepTools import BRepTools

    file = folder / "part.brep"
    BRepTools.Write_s(shape, str(file))
    return so.cad.read_brep(file)[0]


def leaf_area(boundary: Any, chart: FaceChart, rows: list[Array], cut: list[bool]) -> float:
    """Of rectangles of a chart: those that a trimming curve cuts by whether their nodes are on the
    face."""
    x, w = np.polynomial.legendre.leggauss(NODES)
    weights = np.outer(w, w).ravel()
    total = 0.0
    for (u0, u1, v0, v1), halved in zip(rows, cut, strict=True):
        us, vs = (0.5 * (a + b) + 0.5 * (b - a) * x for a, b in ((u0, u1), (v0, v1)))
        places = np.array([(u, v) for u in us for v in vs])
        jets = np.empty((len(places), 18))
        surface_jets(chart.surface.reals, chart.surface.kind, 0, places, jets)
        density = np.linalg.norm(np.cross(jets[:, 3:6], jets[:, 6:9]), axis=1)
        if halved:
            ints, reals = boundary.ints, boundary.reals
            density *= [on_face(ints, reals, chart.number, u, v) for u, v in places.tolist()]
        total += float(weights @ density) * 0.25 * (u1 - u0) * (v1 - v0)
    return total


@pytest.mark.parametrize("kind", only(["ball", "extruded spline"], list(KINDS)))
def test_a_drilled_seam_shows_each_point_once(kind: str, tmp_path: Path) -> None:
    shape = made.cut(KINDS[kind](), hole())
    part = read_back(shape, tmp_path)
    boundary = part.shape
    charts = {chart.number: chart for chart in face_charts(boundary)}
    pieces = pieces_of(boundary, charts)
    areas = np.zeros(len(boundary.face_parts))
    for chart in charts.values():
        u0, u1 = chart.rectangle[:2]
        assert not chart.surface.periodic or u1 - u0 <= 2.0 * np.pi + 1e-9
        own = [k for k, piece in enumerate(pieces) if piece.chart == chart.number]
        leaves = face_leaves(boundary, chart, pieces, own, part.report.size)
        rows = [leaf.reals[:4] for leaf in leaves]
        areas[chart.face] += leaf_area(boundary, chart, rows, [leaf.cut for leaf in leaves])
    own = [face_area(boundary, k, part.report.size) for k in range(len(areas))]
    assert areas == pytest.approx(own, rel=0.06, abs=1e-3)
    within = [(x, y, 0.03) for x in (0.6, 1.0, 1.7, 2.45) for y in (0.0, 0.1)]
    answer = part.solid.signed_distance(within)
    true = made.from_boundary(shape, within)
    assert np.abs(answer.distance) == pytest.approx(true, abs=1e-6)
    assert (answer.distance > 0.0).all()


@pytest.mark.parametrize(("first", "turn"), [(0.5, 0.5), (0.75, 0.25), (0.0, 0.5)])
def test_a_bend_that_ends_at_the_seam_of_its_torus_loads(
    first: float, turn: float, tmp_path: Path
) -> None:
    """It is cut along its tube, and the flat ends keep their edges."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Common

    boxes = {
        0.5: (8, 4, 2, (-4, -4, -1)),
        0.75: (4, 4, 2, (0, -4, -1)),
        0.0: (8, 4, 2, (-4, 0, -1)),
    }
    part = read_back(
        BRepAlgoAPI_Common(made.ring(2.0, 0.5), made.box(*boxes[first])).Shape(), tmp_path
    )
    angle = 2.0 * np.pi * turn
    report = part.shape.check()
    assert report.volume == pytest.approx(angle * 2.0 * np.pi * 0.25, rel=1e-9)
    assert report.area == pytest.approx(angle * 2.0 * np.pi + 0.5 * np.pi, rel=1e-9)
    assert part.report.slack < 1e-8
