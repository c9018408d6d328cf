"""Pictures of solids that need not be convex: what is seen, what is marked, and where."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.image import imread
from matplotlib.patches import Circle, Polygon

import standoff as so
from families.solid_shapes import ball, bolt, bracket, peg, prism, tube
from standoff.solids import distance
from standoff.solids.drawing.camera import camera_on, rastered, visible
from standoff.solids.drawing.skin import EDGE_LOOKS, raster_of, skin_of
from standoff.solids.drawing.spatial_picture import STILL as AT_HOME
from standoff.tracking.status import Status

STILL = so.Pose.identity()
STRAIGHT = np.eye(3)
SLOT = prism([(-1, -1), (3, -1), (3, 2), (2, 2), (2, 0), (0, 0), (0, 2), (-1, 2)], 3.0)


def legend(figure: Any) -> list[str]:
    return [text.get_text() for text in figure.legends[0].get_texts()]


def drawn(figure: Any, **look: Any) -> list[np.ndarray]:
    """The points of the lines of a colour, a marker, or both."""
    (axes,) = figure.axes
    return [
        np.array(line.get_data()).T
        for line in axes.lines
        if all(getattr(line, f"get_{name}")() == value for name, value in look.items())
    ]


def patches(figure: Any, kind: type) -> list[Any]:
    (axes,) = figure.axes
    return [patch for patch in axes.patches if type(patch) is kind]


def test_the_nearest_triangle_is_seen(rng: np.random.Generator) -> None:
    """At random pixels the depth is that of the nearest triangle on the line of sight."""
    corners = rng.normal(size=(60, 3, 3))
    camera = camera_on(corners.reshape(-1, 3), (30.0, 40.0), 90)
    raster = rastered(camera, corners)
    seen = camera.seen(corners)
    for _ in range(300):
        row, column = (int(rng.integers(n)) for n in camera.shape)
        spot = camera.low + (np.array([column, row]) + 0.5) * camera.pixel
        depths = [-np.inf]
        for triangle in seen:
            system = np.vstack([triangle[:, :2].T, np.ones(3)])
            shares = np.linalg.solve(system, [*spot, 1.0])
            if (shares >= 1e-9).all():
                depths.append(float(shares @ triangle[:, 2]))
        assert raster.depth[row, column] == pytest.approx(max(depths), abs=1e-9)
        number = raster.triangle[row, column]
        assert (number < 0) == (max(depths) == -np.inf)


def test_what_is_behind_a_solid_is_hidden() -> None:
    skin = skin_of(ball(1.0).boundary, AT_HOME)
    camera = camera_on(3.0 * np.vstack([np.eye(3), -np.eye(3)]), (0.0, 0.0), 300)
    raster = raster_of(camera, [skin])
    spots = np.array([[2.0, 0, 0], [-2.0, 0, 0], [-2.0, 1.5, 0], [1.0, 0, 0], [0, 0, 0]])
    np.testing.assert_array_equal(visible(camera, raster, spots), [True, False, True, True, False])


def test_a_solid_is_drawn_with_its_edges_by_kind(tmp_path: Path) -> None:
    path = tmp_path / "bolt.png"
    figure = bolt().plot(path, unit="mm")
    assert legend(figure) == ["convex edge", "reflex edge"]
    assert figure.get_suptitle() == "bolt: 5 faces, 4 edges (3 convex, 1 reflex), 0 vertices"
    image = imread(path)[..., :3]
    orange = np.array([0.835, 0.369, 0.0])
    assert (np.abs(image - orange).max(axis=2) < 0.05).sum() > 100
    with pytest.raises(ValueError, match=r"\.gif"):
        bolt().plot(tmp_path / "bolt.gif")


def test_every_local_minimum_is_marked() -> None:
    answer = distance(SLOT, ball(0.4), STILL, so.Pose(STRAIGHT, (0.9, 0.8, 1.5)), minima=0.9)
    figure = so.plot(SLOT, ball(0.4), answer, unit="mm")
    told = legend(figure)
    assert told[:2] == ["A: prism, face 6", "B: ball, face 0"]
    assert "distance 0.4 mm, CONVERGED" in told
    assert "2 more local minima" in told
    assert len([line for line in drawn(figure, marker="o") if len(line) == 2]) == 3


def test_a_view_shows_what_is_inside() -> None:
    """A peg's nearest points are in its hole: both solids are then drawn transparent."""
    a, b = tube(0.5, 1.0, -0.5, 0.5), peg(0.45, -0.7, 0.7)
    answer = distance(a, b, STILL, so.Pose(STRAIGHT, (0.02, 0, 0)))
    figure = so.plot(a, b, answer)
    assert answer.continuum.kind == "line"
    assert "ends of the continuum (line)" in legend(figure)
    (ends,) = drawn(figure, marker="D")
    assert len(ends) == 4
    image = figure.axes[0].images[0].get_array()
    assert image[..., 3].max() == 1.0
    tops = image[image[..., 3] > 0.0][:, :3]
    assert tops.min() > 0.3  # no strong colour: they are mixed with what is behind


def test_the_common_ball_is_drawn_in_its_size() -> None:
    answer = distance(bracket(), bolt(), STILL, so.Pose(STRAIGHT, (1.2, 1.0, -1.0)))
    figure = so.plot(bracket(), bolt(), answer, view=(20.0, 30.0))
    (circle,) = patches(figure, Circle)
    assert circle.radius == answer.overlap.radius
    assert any(text.startswith("depth at least") for text in legend(figure))


def test_open_pieces_are_drawn() -> None:
    a, b = tube(0.5, 1.0, -0.5, 0.5), peg(0.45, -0.7, 0.7)
    answer = distance(a, b, STILL, so.Pose(STRAIGHT, (1e-3, 2e-3, 0)), deadline=2000)
    assert answer.status is Status.DEADLINE
    figure = so.plot(a, b, answer)
    pieces = {each.corners_a.tobytes() for each in answer.open}
    pieces |= {each.corners_b.tobytes() for each in answer.open}
    assert len(patches(figure, Polygon)) == len(pieces)
    (told,) = [text for text in legend(figure) if text.startswith("open:")]
    assert str(len(answer.open)) in told
    assert str(answer.counts.open) in told


def test_planar_solids_are_drawn_with_their_holes(tmp_path: Path) -> None:
    line, arc = so.geometry.Line, so.geometry.ConicArc
    corners = [(0, 0), (4, 0), (4, 3), (2, 1), (0, 3)]
    outer = [line(p, q) for p, q in zip(corners, corners[1:] + corners[:1], strict=True)]
    solid = so.PlanarSolid.from_loops(outer, [[arc((2, 0.5), (0.2, 0), (0, 0.2))]], name="notched")
    disc = so.PlanarSolid.from_loops([arc((0, 0), (1, 0), (0, 1))], name="disc")
    assert legend(solid.plot()) == ["convex vertex", "reflex vertex", "smooth vertex"]
    pose = so.Pose(STRAIGHT, (2, 4, 0))
    answer = so.distance(solid, disc, STILL, pose)
    path = tmp_path / "planar.png"
    figure = so.plot(solid, disc, answer, path)
    assert "1 more nearest pair" in legend(figure)
    (axes,) = figure.axes
    image = imread(path)[..., :3]
    tall = image.shape[0]

    def colour(x: float, y: float) -> np.ndarray:
        column, row = axes.transData.transform((x, y))
        return image[tall - 1 - int(row), int(column)]

    assert colour(2.05, 0.55).min() > 0.85  # the hole is empty
    assert colour(0.7, 0.7)[0] < 0.9
    cut = distance(solid, disc, STILL, pose, deadline=100)
    assert len(patches(so.plot(solid, disc, cut), Polygon)) >= 2


def test_a_planar_solid_and_one_in_space_are_refused() -> None:
    answer = distance(SLOT, ball(0.4), STILL, so.Pose(STRAIGHT, (0.9, 0.8, 1.5)))
    disc = so.PlanarSolid.from_loops([so.geometry.ConicArc((0, 0), (1, 0), (0, 1))])
    with pytest.raises(ValueError, match="is no Solid"):
        so.plot(SLOT, disc, answer)
    with pytest.raises(TypeError, match="planar Body"):
        so.plot(disc, SLOT, answer)
    with pytest.raises(ValueError, match="no Solid"):
        so.plot(SLOT, 3.0, answer)
    with pytest.raises(TypeError, match="not an answer of solids"):
        so.plot(SLOT, ball(0.4), 0.4)


def test_each_kind_of_edge_has_its_look() -> None:
    assert set(EDGE_LOOKS) == set(so.bodies.EdgeKind)
