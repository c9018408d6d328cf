"""Ellipsoids as rational patches: on the quadric, outward, and side by side without gaps."""

import numpy as np
import pytest

from standoff.geometry import Sphere, ellipsoid_octants, ellipsoid_patches

AXES = (1.5, 0.4, 2.0)
MAKERS = (ellipsoid_patches, ellipsoid_octants)


@pytest.mark.parametrize("maker", MAKERS)
def test_patches_lie_on_the_ellipsoid_and_face_outward(maker, rng):
    for patch in maker(*AXES):
        for u, v in rng.uniform(0.0, 0.999, (20, 2)):
            x, xu, xv, *_ = patch.jet(u, v)
            y = x / np.array(AXES)
            assert y @ y == pytest.approx(1.0, abs=2e-15)
            assert np.cross(xu, xv) @ (y / np.array(AXES)) > 0.0


@pytest.mark.parametrize("maker", MAKERS)
def test_patches_cover_the_sphere_once(maker):
    """Solid angles, by Gauss-Legendre quadrature, sum to 4 pi."""
    nodes, weights = np.polynomial.legendre.leggauss(24)
    t, w = 0.5 * (nodes + 1.0), 0.5 * weights
    angle = 0.0
    for patch in maker(1.0, 1.0, 1.0):
        for i, u in enumerate(t):
            for j, v in enumerate(t):
                x, xu, xv, *_ = patch.jet(u, v)
                angle += w[i] * w[j] * float(np.cross(xu, xv) @ x)
    assert angle == pytest.approx(4.0 * np.pi, rel=1e-12)


@pytest.mark.parametrize("maker", MAKERS)
def test_each_side_is_that_of_a_neighbour(maker):
    sides = []
    for patch in maker(*AXES):
        p = patch.control_points
        sides += [(id(patch), s) for s in (p[0], p[-1], p[:, 0], p[:, -1])]
    sides = [(k, s) for k, s in sides if np.ptp(s, axis=0).max() > 0.0]
    for owner, side in sides:
        fits = [
            k
            for k, other in sides
            if k != owner
            and min(np.abs(side - other).max(), np.abs(side - other[::-1]).max()) < 1e-14
        ]
        assert len(fits) == 1


def test_curvature_is_that_of_the_quadric():
    """The same second fundamental form as the gnomonic chart at the same point."""
    quadric = Sphere(np.diag(AXES), np.zeros(3))
    patch = ellipsoid_patches(*AXES)[2]
    x, xu, xv, xuu, xuv, xvv = patch.jet(0.3, 0.6)
    y = x / np.array(AXES)
    _, qu, qv, quu, quv, qvv = quadric.jet(y[0] / y[2], y[1] / y[2])
    change = np.linalg.lstsq(np.column_stack([qu, qv]), np.column_stack([xu, xv]), rcond=None)[0]
    n = np.cross(xu, xv)
    n = n / np.linalg.norm(n)
    form = change.T @ np.array([[quu @ n, quv @ n], [quv @ n, qvv @ n]]) @ change
    np.testing.assert_allclose([[xuu @ n, xuv @ n], [xuv @ n, xvv @ n]], form, rtol=1e-12)


@pytest.mark.parametrize("maker", MAKERS)
def test_bad_axes_are_refused(maker):
    with pytest.raises(ValueError, match=r"b = -1.0: must be positive"):
        maker(1.0, -1.0, 2.0)
    with pytest.raises(ValueError, match="c = nan"):
        maker(1.0, 1.0, np.nan)
