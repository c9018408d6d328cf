"""Drawing of planar bodies: names, order, and that what is drawn lies where the body is."""

import numpy as np
import pytest

import standoff as so
from standoff.geometry import Line
from standoff_studies.paper import drawing, style
from standoff_studies.paper.bodies import leaf, planar_body

QUARTER = so.Pose([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], (2.0, 1.0, 0.0))


def axes_of_a_figure():
    with style.settings():
        return style.new_figure().subplots()


def test_features_in_the_order_of_the_loop():
    names = [drawing.short_name(f) for f in drawing.planar_features(planar_body())]
    assert names == ["V0", "C0", "V1", "C1", "V2", "C2"]


def test_a_loop_in_another_order_is_refused():
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)], dtype=float)
    ends = [(0, 1), (2, 0), (1, 2)]
    edges = [so.bodies.Edge(Line(corners[i], corners[j]), i, j) for i, j in ends]
    body = so.Body.from_brep(corners, edges, dimension=2)
    with pytest.raises(ValueError, match="edge 1 does not begin at vertex 1"):
        drawing.planar_features(body)


def test_the_outline_is_at_the_pose():
    body = leaf()
    around = drawing.outline(body, QUARTER)
    home = drawing.outline(body)
    np.testing.assert_allclose(around, np.column_stack([2.0 - home[:, 1], 1.0 + home[:, 0]]))
    # Its points are on the body: a point far out along x is nearest to the rightmost tip.
    assert home[:, 0].max() == pytest.approx(0.7)


@pytest.mark.parametrize("pose", [None, QUARTER])
def test_names_stand_inside_and_outside(pose):
    body, axes = planar_body(), axes_of_a_figure()
    drawing.name_features(axes, body, pose, inset=0.1, prefix="A ")
    drawing.name_features(axes, body, pose, inset=-0.1)
    texts = [text.get_text() for text in axes.texts]
    assert texts[:6] == [f"A {name}" for name in texts[6:]]
    home = so.Pose.identity() if pose is None else pose
    for k, text in enumerate(axes.texts):
        place = so.Pose(np.eye(3), (*text.get_position(), 0.0))
        found = so.distance(body, so.shapes.point(), home, place)
        outside = found.distance > 0.0
        assert outside == (k >= 6)
        if outside:
            # Straight out of the feature that it names.
            assert found.distance == pytest.approx(0.1)
            assert drawing.short_name(found.feature_a) == text.get_text()


def test_active_features_and_witness_line_are_drawn():
    body, axes = leaf(), axes_of_a_figure()
    vertex, curve = drawing.planar_features(body)[:2]
    drawing.draw_planar_body(axes, body, QUARTER, colour=style.RED)
    assert axes.get_aspect() == 1.0
    drawing.draw_feature(axes, body, vertex, QUARTER, colour=style.RED)
    np.testing.assert_allclose(axes.lines[-1].get_xydata(), [[2.0, 0.3]])
    drawing.draw_feature(axes, body, curve, QUARTER, colour=style.RED)
    np.testing.assert_allclose(axes.lines[-1].get_xydata()[[0, -1]], [[2.0, 0.3], [2.0, 1.7]])
    drawing.draw_witness_line(axes, np.zeros(3), np.ones(3), linewidth=2.0)
    np.testing.assert_allclose(axes.lines[-1].get_xydata(), [[0.0, 0.0], [1.0, 1.0]])
    assert axes.lines[-1].get_linewidth() == 2.0
