"""Pictures of bodies and answers: what is drawn, and where."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.image import imread

import standoff as so
from standoff.bodies.drawing.body_view import direction_to_viewer
from standoff.bodies.drawing.pair_picture import COLOURS, view_across
from standoff.bodies.drawing.solids import solid_of

DOCS = Path(__file__).parents[2] / "docs"
HOME = so.Pose.identity()
BOX, LENS = so.shapes.box(0.6, 0.5, 0.4), so.shapes.lens(1.0, 0.45)
CAPSULE = so.shapes.capsule(0.15, 0.6)
LOOP = so.shapes.planar_loop([so.geometry.ConicArc((0, 0), (1, 0), (0, 0.6))])


def placed(x: float, y: float = 0.0, z: float = 0.0, turn: float = 0.0) -> so.Pose:
    return so.Pose.exp([0.0, 0.0, turn], [x, y, z])


def lines_of(figure: Any) -> list[Any]:
    (axes,) = figure.axes
    return [np.array(getattr(line, "_verts3d", line.get_data())) for line in axes.lines]


PAIRS = [
    (BOX, CAPSULE, placed(0.7, 0.5, 0.6)),
    (LENS, so.shapes.ellipsoid(0.2, 0.3, 0.1), placed(1.0, 0.2, 0.3)),
    (BOX, LENS, placed(0.3, 0.4, 0.3)),
    (LOOP, LOOP, placed(2.2, 0.3, turn=0.4)),
    (so.shapes.point(), BOX, placed(0.8, 0.1)),
    (so.shapes.segment(1.0), so.shapes.sphere(0.2), placed(0.8, 0.1)),
    (so.shapes.halfspace([0.0, 0.0, 1.0]), CAPSULE, placed(0.0, 0.0, 1.0)),
]


@pytest.mark.parametrize(("a", "b", "pose"), PAIRS, ids=lambda x: getattr(x, "name", ""))
def test_a_pair_is_drawn_with_its_witness_line(a: so.Body, b: so.Body, pose: so.Pose) -> None:
    answer = so.distance(a, b, HOME, pose)
    figure = so.plot(a, b, answer, unit="m")
    ends = np.array([answer.point_a, answer.point_b])[:, : a.dimension].T
    assert any(line.shape == ends.shape and np.array_equal(line, ends) for line in lines_of(figure))
    told = [text.get_text() for text in figure.legends[0].get_texts()]
    assert told[0] == f"A: {a.name}, {answer.feature_a}"
    assert told[1] == f"B: {b.name}, {answer.feature_b}"
    what = "depth" if answer.distance < 0.0 else "distance"
    assert told[2] == f"{what} {abs(answer.distance):.6g} m, {answer.status.name}"


def test_both_bodies_are_seen_in_equal_scales(tmp_path: Path) -> None:
    answer = so.distance(BOX, CAPSULE, HOME, placed(0.7, 0.5, 0.6))
    figure = so.plot(BOX, CAPSULE, answer, tmp_path / "pair.png")
    (axes,) = figure.axes
    spans = [np.ptp(getattr(axes, f"get_{axis}lim")()) for axis in "xyz"]
    np.testing.assert_allclose(spans, spans[0])
    picture = imread(tmp_path / "pair.png")[:, :, :3]
    red, blue = picture[:, :, 0], picture[:, :, 2]
    assert np.mean(blue - red > 0.1) > 0.03  # the box
    assert np.mean(red - blue > 0.1) > 0.01  # the capsule


def test_the_body_in_front_is_drawn_last() -> None:
    answer = so.distance(BOX, CAPSULE, HOME, placed(1.0))
    np.testing.assert_allclose(answer.normal, [1.0, 0.0, 0.0], atol=1e-9)
    for azimuth, b_in_front in ((0.0, True), (180.0, False)):
        figure = so.plot(BOX, CAPSULE, answer, view=(20.0, azimuth))
        of_a, of_b = (skin.get_zorder() for skin in figure.axes[0].collections[:2])
        assert (of_b > of_a) is b_in_front


def test_the_active_face_has_the_stronger_colour() -> None:
    answer = so.distance(LENS, so.shapes.sphere(0.2), HOME, placed(-0.3, -1.5, 0.2))
    assert answer.feature_a.kind == "face"
    figure = so.plot(LENS, so.shapes.sphere(0.2), answer, view=(20.0, -100.0))
    skin = figure.axes[0].collections[0].get_facecolor()
    shares = skin[:, 0] / skin[:, 2]
    strong = tuple(int(COLOURS[0][1][k : k + 2], 16) for k in (1, 5))
    light = tuple(int(COLOURS[0][0][k : k + 2], 16) for k in (1, 5))
    for red, blue in (strong, light):
        assert np.isclose(shares, red / blue, atol=1e-3).any()


def test_the_view_is_across_the_normal(rng: np.random.Generator) -> None:
    normals = [np.eye(3)[k] * s for k in range(3) for s in (1.0, -1.0)]
    normals += [direction_to_viewer((25.0, -50.0)), *rng.normal(size=(50, 3))]
    for normal in normals:
        unit = normal / np.linalg.norm(normal)
        assert abs(direction_to_viewer(view_across(unit)) @ unit) < 1e-12


def test_a_solid_s_points_lie_on_the_body(rng: np.random.Generator) -> None:
    for body in (BOX, CAPSULE, LENS, so.shapes.cylinder(0.3, 0.8, rounding=0.05)):
        solid = solid_of(body)
        picked = rng.choice(len(solid.points), 20)
        for point in solid.points[picked]:
            found = so.distance(so.shapes.point(), body, so.Pose(np.eye(3), point), HOME)
            # the arcs of a swept core are drawn by points on them
            assert abs(found.distance) < (1e-3 if body.radius else 1e-9) * body.size


def test_a_body_draws_itself(tmp_path: Path) -> None:
    figure = so.shapes.cylinder(0.3, 0.8).plot(tmp_path / "body.png", unit="m")
    told = [text.get_text() for axes in figure.axes for text in axes.texts]
    assert {"face 0", "face 1", "face 2", "e0", "e1", "0.1 m"} <= set(told)
    assert imread(tmp_path / "body.png").shape[2] == 4
    assert LOOP.plot().axes[0].get_xlabel() == "x"


def test_wrong_arguments_are_named(tmp_path: Path) -> None:
    answer = so.distance(BOX, CAPSULE, HOME, placed(1.0))
    with pytest.raises(TypeError, match="a = 3 is not a body"):
        so.plot(3, CAPSULE, answer)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"answer = 0\.5 is not an answer"):
        so.plot(BOX, CAPSULE, 0.5)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"The answer is of <Body box: .* as they were asked"):
        so.plot(CAPSULE, BOX, answer)
    with pytest.raises(ValueError, match=r"view has shape \(3,\): give 2 numbers"):
        so.plot(BOX, CAPSULE, answer, view=(1, 2, 3))  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"the ending '.bmp' is not known here"):
        so.plot(BOX, CAPSULE, answer, tmp_path / "x.bmp")
    with pytest.raises(ValueError, match=r"the ending '' is not known here"):
        BOX.plot(tmp_path / "x")
    same = so.shapes.box(0.6, 0.5, 0.4)
    assert so.plot(same, CAPSULE, answer)


def test_a_missing_matplotlib_is_named_with_its_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    answer = so.distance(BOX, CAPSULE, HOME, placed(1.0))
    own = "standoff.bodies.drawing"
    for name in list(sys.modules):
        if name.partition(".")[0] in ("matplotlib", "mpl_toolkits"):
            monkeypatch.setitem(sys.modules, name, None)
        elif name.startswith(own):
            monkeypatch.delitem(sys.modules, name)
    for draw in (lambda: so.plot(BOX, CAPSULE, answer), BOX.plot):
        with pytest.raises(ModuleNotFoundError, match=r"pip install 'standoff\[plot\]'"):
            draw()


def test_every_picture_of_the_gallery_is_written_by_its_code_and_shown() -> None:
    page = (DOCS / "gallery.md").read_text("utf-8")
    shown = re.findall(r"\]\(images/(gallery-[\w.-]+)\)", page)
    written = re.findall(r'"(gallery-[\w.-]+)"', page)
    assert shown == written
    kept = {file.name for file in (DOCS / "images").glob("gallery-*")}
    assert kept == set(shown)
