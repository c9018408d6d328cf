"""Figs. 1 and 2: tangents and projections on the computed data."""

from __future__ import annotations

import numpy as np
import pytest

from standoff_studies.paper.patches import (
    POINT,
    cosines,
    curved_face,
    foot,
    pair,
    pose_b,
    tangents_patch,
    witness_pair,
)
from standoff_studies.paper.verdicts import Verdict


def test_tangents_are_the_patches_slopes() -> None:
    """Fig. 1: f_u and f_v, by the patch's formula z = -p (2u - 1)^2 - q (2v - 1)^2."""
    answer, system = foot()
    u, v = answer.parameters_a
    np.testing.assert_allclose(
        system.F.T, [[2.0, 0.0, -1.8 * (2 * u - 1)], [0.0, 1.6, -1.2 * (2 * v - 1)]], atol=1e-14
    )
    np.testing.assert_allclose(curved_face().jet(u, v)[0], answer.point_a, atol=1e-14)


def test_foot_is_nearer_than_any_point_of_the_patch() -> None:
    """Fig. 1: brute force on a grid; a step of 1/400 is off by less than 1e-4 in distance."""
    answer, _ = foot()
    grid = np.linspace(0.0, 1.0, 401)
    u, v = np.meshgrid(grid, grid)
    points = np.stack([2 * u - 1, 0.8 * (2 * v - 1), -0.45 * (2 * u - 1) ** 2], axis=-1)
    points[..., 2] -= 0.3 * (2 * v - 1) ** 2
    nearest = np.linalg.norm(points - POINT, axis=-1).min()
    assert answer.distance <= nearest < answer.distance + 1e-4


@pytest.mark.parametrize(("found", "tangents"), [(foot, 2), (pair, 4)])
def test_the_witness_vector_has_no_projection_on_the_tangents(found, tangents) -> None:
    """Figs. 1 and 2, Eqs. (1)-(4): Psi = 0 at the closest points."""
    answer, system = found()
    assert len(system.Psi) == tangents
    np.testing.assert_allclose(system.dR, answer.point_a - answer.point_b, atol=1e-14)
    np.testing.assert_allclose(cosines(system), 0.0, atol=1e-12)
    assert answer.certified


def test_both_witness_points_lie_inside_the_curved_faces() -> None:
    """Fig. 2: else there are not four tangents."""
    answer, system = pair()
    assert str(answer.feature_a) == str(answer.feature_b) == "face 0"
    assert all(0.1 < p < 0.9 for p in (*answer.parameters_a, *answer.parameters_b))
    upper = pose_b().apply(curved_face().jet(*answer.parameters_b)[0])
    np.testing.assert_allclose(upper, answer.point_b, atol=1e-14)
    assert system.G.shape == (3, 2)


def test_the_figures_say_so() -> None:
    first, second = tangents_patch(), witness_pair()
    assert [Verdict.of(s) for s in first.statements] == [Verdict.HOLDS, Verdict.OWN]
    assert [Verdict.of(s) for s in second.statements] == [Verdict.HOLDS, Verdict.OWN]
    assert list(second.tables["tangents"]["tangent"]) == ["f_u", "f_v", "h_r", "h_s"]
    assert len(first.tables["isoparametric"]["u"]) == 2 * 9 * 33
