"""Pictures in space: what is nearer covers what is farther, and what lies on a surface is seen."""

import numpy as np
import pytest

import standoff as so
from standoff_studies.paper import style
from standoff_studies.paper.bodies import lens_of_patches
from standoff_studies.paper.drawing_3d import PALE, View, edge_points, patch_points, rgb_of

RED = (1.0, 0.0, 0.0)


def square(x):
    """A grid in the plane of a given x, y and z from -1 to 1."""
    side = np.linspace(-1.0, 1.0, 9)
    y, z = np.meshgrid(side, side, indexing="ij")
    return np.stack([np.full_like(y, x), y, z], axis=2)


def share(view, colour):
    """The part of the picture that has a colour, nearly."""
    with style.settings():
        figure = style.new_figure(3.0, 3.0)
        figure.set_layout_engine("none")
        view.paint(figure.add_axes((0.0, 0.0, 1.0, 1.0)))
        figure.canvas.draw()
    pixels = np.asarray(figure.canvas.buffer_rgba())[..., :3] / 255.0
    return float((np.abs(pixels - colour).max(axis=2) < 0.1).mean())


@pytest.mark.parametrize(
    ("x", "seen"), [(-0.5, False), (0.0, True), (0.5, True)], ids=["behind", "on", "before"]
)
def test_a_line_by_a_surface(x, seen):
    view = View(0.0, 0.0)
    view.surface(square(0.0), "#777777")
    view.line([[x, -0.9, 0.0], [x, 0.9, 0.1]], "#FF0000", 6.0)
    assert (share(view, RED) > 0.005) == seen


@pytest.mark.parametrize("turn", [0.0, 35.0, 60.0])
def test_a_line_on_a_surface_is_whole(turn):
    """From aslant, where its pieces are behind the middles of half the surface's pieces."""
    alone, on = View(turn, 25.0), View(turn, 25.0)
    for view in (alone, on):
        view.line([[0.0, -0.9, -0.7], [0.0, 0.9, 0.8]], "#FF0000", 5.0)
        view.line(square(0.0)[::8, ::8].reshape(-1, 3), "#FFFFFF", 0.1)  # of one extent
    on.surface(square(0.0), "#777777")
    assert share(on, RED) > 0.9 * share(alone, RED)


@pytest.mark.parametrize(("x", "seen"), [(-0.5, False), (0.0, True)])
@pytest.mark.parametrize("shape", ["o", "s", "^", "D"])
def test_a_mark_by_a_surface(shape, x, seen):
    view = View(0.0, 0.0)
    view.surface(square(0.0), "#777777")
    view.mark((x, 0.2, 0.3), "#FF0000", shape, 0.2)
    assert (share(view, RED) > 0.005) == seen


def test_a_sheet_lets_through():
    view = View(0.0, 0.0)
    view.surface(square(0.0), "#777777", opacity=0.2, shaded=False)
    view.surface(square(-0.5), "#FF0000", shaded=False)
    assert share(view, RED) < 0.1
    assert share(view, 0.8 * np.array(RED) + 0.2 * np.array(rgb_of("#777777"))) > 0.5


def test_dashes_leave_gaps():
    whole, dashed = View(0.0, 0.0), View(0.0, 0.0)
    whole.line([[0, -1, 0], [0, 1, 0]], "#FF0000", 4.0)
    dashed.line([[0, -1, 0], [0, 1, 0]], "#FF0000", 4.0, dashes=(0.1, 0.1))
    lengths = [
        sum(np.ptp(piece.corners[:, 0]) for piece in view.pieces) for view in (whole, dashed)
    ]
    assert lengths == pytest.approx([2.0, 1.0])


def test_the_viewer_stands_where_told():
    view = View(90.0, 0.0)  # on the y axis: z up, and -x to the right
    np.testing.assert_allclose(view.flat([[1.0, 5.0, 2.0]]), [[-1.0, 2.0]], atol=1e-15)
    assert view.faces(np.array([0.0, 1.0, 0.0]))
    assert not view.faces(np.array([0.0, -1.0, 0.1]))
    above = View(0.0, 90.0)
    np.testing.assert_allclose(above.flat((1.0, 2.0, 3.0)), (2.0, -1.0), atol=1e-15)


def test_a_body_moves_with_its_pose():
    lens = lens_of_patches()
    pose = so.Pose.exp((0.3, -0.2, 0.5), (2.0, 1.0, 0.0))
    views = View(30.0, 20.0), View(30.0, 20.0)
    views[0].body(lens, grid=6)
    views[1].body(lens, pose, grid=6)
    middles = [np.mean([piece.corners.mean(axis=0) for piece in v.pieces], axis=0) for v in views]
    expected = [np.zeros(2), views[1].flat(pose.translation)]
    np.testing.assert_allclose(middles, expected, atol=1e-9)
    assert len(views[0].pieces) == len(views[1].pieces)
    assert share(views[0], rgb_of(PALE[0])) > 0.02


def test_points_of_patches_and_edges():
    lens = lens_of_patches()
    grid = patch_points(lens, 1, 4)
    assert grid.shape == (5, 5, 3)
    np.testing.assert_allclose(grid[:, 0], [lens.vertex_points[0]] * 5, atol=1e-15)
    ends = edge_points(lens, 0)[[0, -1]]
    np.testing.assert_allclose(ends, lens.vertex_points, atol=1e-15)
