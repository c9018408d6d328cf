"""Ellipsoid pairs whose answer is known by construction: distance, witness points and normal."""

import numpy as np
import pytest

import standoff as so
from draws import draws
from families.exact_ellipsoids import RATIOS, SIZE, condition, draw_pairs

POSES = draws(300)
DISTANCE = 1e-12
"""Greatest error of a distance, over the pair's size."""
TO_RATIO_TEN = 1e-10
"""Greatest error of a witness point, over the size, and of a normal, for axes ratios to 10."""
BEYOND = 100 * float(np.finfo(float).eps)
"""The same for greater ratios, times the conditioning: of the witness points the condition number
of the Hessian in the metric of the tangents; of the normal that or size/distance, whichever is
greater, as the roundings of two points turn the direction between them by eps size/distance."""


@pytest.mark.parametrize("ratio", RATIOS)
def test_answers_are_exact(ratio, rng):
    seed = int(rng.integers(1 << 31))
    for pair in draw_pairs(ratio, POSES, np.random.default_rng(seed)):
        a, b = so.shapes.ellipsoid(*pair.axes_a), so.shapes.ellipsoid(*pair.axes_b)
        for truth in pair.poses:
            found = so.distance(a, b, truth.pose_a, truth.pose_b)
            case = f"seed {seed}, axes {pair.axes_a}, {pair.axes_b}, gap {truth.distance}"
            assert found.certified, case
            assert abs(found.distance - truth.distance) <= DISTANCE * SIZE, case
            cond = condition(truth)
            steep = max(cond, SIZE / truth.distance)
            small = ratio <= 10.0
            for point, known in ((found.point_a, truth.point_a), (found.point_b, truth.point_b)):
                miss = np.linalg.norm(point - known) / SIZE
                assert miss <= (TO_RATIO_TEN if small else BEYOND * cond), case
            turn = np.linalg.norm(found.normal - truth.normal)
            assert turn <= (TO_RATIO_TEN if small else BEYOND * steep), case
