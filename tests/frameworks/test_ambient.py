"""Derivatives by the entries of matrices, beside differences of the distance at nearest poses."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import standoff as so
from frameworks.cases import APART, BOX, ELLIPSOID, INSIDE, LENS, LOST, STACKED, close, pose
from standoff.errors import DerivativeWarning, StandoffError
from standoff.frameworks import ambient

PAIR = ambient.AmbientPair.of(LENS, ELLIPSOID, "nan")


def at_nearest(matrices: np.ndarray) -> float:
    """The distance at the nearest poses to two matrices."""
    near = []
    for matrix in matrices:
        u, _, vt = np.linalg.svd(matrix[:3, :3])
        near.append(so.Pose(u @ vt, matrix[:3, 3]))
    return so.distance(LENS, ELLIPSOID, *near).distance


@pytest.mark.parametrize("q", [APART, INSIDE], ids=["apart", "overlap"])
def test_gradient_and_hessian_are_those_of_the_nearest_pose(
    q: np.ndarray, rng: np.random.Generator
) -> None:
    matrices = np.array([pose(q[:6]), pose(q[6:])])
    found = ambient.second(PAIR, *matrices)
    assert (found.distance < 0.0) == (q is INSIDE)
    close(found.gradient, ambient.first(PAIR, *matrices).gradient, 1e-15)
    h = 1e-3
    for _ in range(6):
        way = rng.normal(size=(2, 4, 4))  # the bottom row too: it does not count
        way /= np.linalg.norm(way)
        along = [at_nearest(matrices + k * h * way) for k in (-2, -1, 0, 1, 2)]
        slope = np.dot(along, [1, -8, 0, 8, -1]) / (12 * h)
        bend = np.dot(along, [-1, 16, -30, 16, -1]) / (12 * h * h)
        close((found.gradient * way).sum(), slope, 1e-9)
        close(np.einsum("aij,aijbkl,bkl->", way, found.hessian, way), bend, 1e-6)


def test_many_rows_are_single_ones(rng: np.random.Generator) -> None:
    poses = np.array([pose(APART[6:] + 0.1 * rng.normal(size=6)) for _ in range(6)])
    fixed = pose(APART[:6])
    found = ambient.second(PAIR, fixed, poses.reshape(2, 3, 4, 4))
    assert found.hessian.shape == (2, 3, 2, 4, 4, 2, 4, 4)
    for k, one in enumerate(poses):
        single = ambient.second(PAIR, fixed, one)
        for many, alone in zip(found, single, strict=True):
            close(many[divmod(k, 3)], alone, 1e-14)
    close(found.distance, ambient.value(PAIR, fixed, poses).reshape(2, 3), 0.0)


def test_a_planar_body_s_gradient_follows_motions_in_the_plane() -> None:
    arc = so.geometry.ConicArc
    ellipse = so.shapes.planar_loop([arc([0, 0], [1.0, 0], [0, 0.5])])
    pair = ambient.AmbientPair.of(ellipse, ellipse, "nan")

    def at(t: float) -> np.ndarray:
        return pose(np.array([0, 0, 0.4 + t + t * t, 3.0 - t * t, 0.5 + 2 * t, 0]))

    def distance(t: float) -> float:
        return float(ambient.value(pair, np.eye(4), at(t)))

    h = 1e-3
    first = (at(h) - at(-h)) / (2 * h)
    second = (at(h) - 2 * at(0) + at(-h)) / h**2
    found = ambient.second(pair, np.eye(4), at(0.0))
    slope = (found.gradient[1] * first).sum()
    bend = np.einsum("ij,ijkl,kl->", first, found.hessian[1, :, :, 1], first)
    close(slope, (distance(h) - distance(-h)) / (2 * h), 1e-5)
    close(
        bend + (found.gradient[1] * second).sum(),
        (distance(h) - 2 * distance(0.0) + distance(-h)) / h**2,
        1e-5,
    )


def test_undefined_derivatives_are_nan_with_a_warning() -> None:
    pair = ambient.AmbientPair.of(BOX, BOX, "nan")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        close(ambient.value(pair, np.eye(4), STACKED), 0.5, 1e-12)
    for asked in (ambient.first, ambient.second):
        with pytest.warns(DerivativeWarning, match="not unique"):
            found = asked(pair, np.eye(4), STACKED)
        np.testing.assert_array_equal(np.isnan(found.gradient), [LOST, LOST])
        np.testing.assert_array_equal(found.gradient[1, :3, 3], [0.0, 0.0, 1.0])
        close(found.distance, 0.5, 1e-12)
    with pytest.warns(DerivativeWarning, match="has no derivatives: the witness points"):
        found = ambient.first(pair, np.eye(4), np.eye(4))
    assert np.isnan(found.gradient[:, :3, 3]).all()
    tilted = STACKED @ pose(np.array([0.3, 0.2, 0.1, 0, 0, 1.0]))
    with pytest.warns(
        DerivativeWarning, match=r"of row 1 does not have all .*\(1 of 2 rows.\) The others"
    ):
        found = ambient.second(pair, np.eye(4), np.array([tilted, STACKED]))
    assert np.isfinite(found.hessian[0]).all()
    assert np.isnan(found.hessian[1]).all()


def test_or_an_error() -> None:
    pair = ambient.AmbientPair.of(BOX, BOX, "raise")
    for poses in (STACKED, np.array([STACKED, STACKED])):
        close(ambient.value(pair, np.eye(4), poses), np.full(poses.shape[:-2], 0.5), 1e-12)
        with pytest.raises(
            StandoffError, match="does not have all derivatives: the witness points"
        ):
            ambient.first(pair, np.eye(4), poses)


def test_what_cannot_serve_is_refused() -> None:
    with pytest.raises(StandoffError, match="undefined = 'zero': give 'nan' or 'raise'"):
        ambient.AmbientPair.of(BOX, BOX, "zero")
    with pytest.raises(TypeError, match="b = 3 is not a body"):
        ambient.AmbientPair.of(BOX, 3, "nan")  # type: ignore[arg-type]
    with pytest.raises(StandoffError, match=r"pose_b has the shape \(3, 3\)"):
        ambient.value(PAIR, np.eye(4), np.eye(3))
    with pytest.raises(StandoffError, match="the same number of both"):
        ambient.value(PAIR, np.zeros((2, 4, 4)), np.zeros((3, 4, 4)))
    with pytest.raises(StandoffError, match="Row 1 of poses_b"):
        ambient.value(PAIR, np.eye(4), np.array([STACKED, 2 * STACKED]))
