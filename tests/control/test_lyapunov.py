"""Lyapunov levels against closed forms and brute force; basins' bad input."""

import numpy as np
import pytest

import standoff as so
from standoff import control
from standoff.motion import Pose

CAP = so.shapes.cap(1.0, 0.36).transformed(np.diag([1.0, 0.8, 0.6]))
POINT = so.shapes.point()
HOME = Pose.identity()
ABOVE = Pose(np.eye(3), (0.75, 0.45, 1.0))


def oval(a: float, b: float) -> so.Body:
    from standoff.geometry import ConicArc

    arcs = [ConicArc((0, 0), (a, 0), (0, b), k * np.pi, (k + 1) * np.pi) for k in range(2)]
    return so.shapes.planar_loop(arcs)


def test_circle_and_point_by_hand() -> None:
    """On a unit circle E = ((1 + D²) - 2 D cos t)/2, H = D cos t: singular at t = pi/2.

    There |g| = D and E - E* = D; but the half circle ends at t = pi/2 - 0.2 from the optimum on
    one side, before H is singular.
    """
    D, angle = 2.0, 0.5 * np.pi - 0.2
    at = Pose(np.eye(3), (D * np.cos(angle), D * np.sin(angle), 0.0))
    levels = control.lyapunov_level(oval(1.0, 1.0), POINT, HOME, at)
    assert str(levels.feature_a) == "edge 0"
    ends = np.sort(levels.curves[:, -1, 0] - angle)
    np.testing.assert_allclose(ends, [-angle, 0.5 * np.pi], atol=1e-6)
    assert levels.level == pytest.approx(0.5 * (D * np.sin(angle)) ** 2, rel=1e-6)
    assert levels.energy_level == pytest.approx(D * (1.0 - np.cos(angle)), rel=1e-6)
    assert levels.singular.sum() == 1


def test_levels_against_a_grid() -> None:
    """Brute force: flood {H > 0} from the optimum; the least V and E on its rim are the levels."""
    levels = control.lyapunov_level(CAP, POINT, HOME, ABOVE, directions=60)
    inverse = np.linalg.inv(np.linalg.cholesky(levels.metric))
    side = np.linspace(-0.9, 0.9, 91)
    rows = np.empty((91, 91, 3))
    for i, du in enumerate(side):
        for j, dv in enumerate(side):
            q = levels.optimum + np.array([du, dv])
            system = so.tracking.pair_system(
                CAP, POINT, HOME, ABOVE, (("face", 0), q), (("vertex", 0), ())
            )
            least = np.linalg.eigvalsh(inverse @ system.H @ inverse.T)[0]
            slope = inverse @ system.g
            rows[i, j] = 0.5 * slope @ slope, 0.5 * system.dR @ system.dR, least
    rest = rows[45, 45, 1]
    flooded = flood(rows[..., 2] > 0.0, (45, 45))
    rim = flooded & ~(
        np.roll(flooded, 1, 0)
        & np.roll(flooded, -1, 0)
        & np.roll(flooded, 1, 1)
        & np.roll(flooded, -1, 1)
    )
    assert rows[rim, 0].min() == pytest.approx(levels.level, rel=0.15)
    assert rows[rim, 1].min() - rest == pytest.approx(levels.energy_level, rel=0.05)


def flood(allowed: np.ndarray, start: tuple[int, int]) -> np.ndarray:
    """Cells reached from one through allowed neighbours."""
    reached, front = np.zeros_like(allowed), [start]
    reached[start] = True
    while front:
        i, j = front.pop()
        for k, m in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
            inside = 0 <= k < allowed.shape[0] and 0 <= m < allowed.shape[1]
            if inside and allowed[k, m] and not reached[k, m]:
                reached[k, m] = True
                front.append((k, m))
    return reached


def test_errors_run_straight_along_the_curves() -> None:
    """On curve k the whitened gradient is its slope times direction k."""
    levels = control.lyapunov_level(CAP, POINT, HOME, ABOVE, directions=12)
    inverse = np.linalg.inv(np.linalg.cholesky(levels.metric))
    for curve, slopes, way in zip(levels.curves, levels.slopes, levels.directions, strict=True):
        for q, s in zip(curve[1::6], slopes[1::6], strict=True):
            system = so.tracking.pair_system(
                CAP, POINT, HOME, ABOVE, (("face", 0), q), (("vertex", 0), ())
            )
            np.testing.assert_allclose(inverse @ system.g, s * way, atol=1e-6)


def test_pairs_without_a_level() -> None:
    box = so.shapes.box(1.0, 1.0, 1.0)
    with pytest.raises(ValueError, match="not positive definite"):
        control.lyapunov_level(box, box, HOME, Pose(np.eye(3), (0.3, 0.2, 1.5)))
    with pytest.raises(ValueError, match="vertices"):
        control.lyapunov_level(POINT, POINT, HOME, Pose(np.eye(3), (1.0, 0.0, 0.0)))
    with pytest.raises(ValueError, match="no certified minimum"):
        control.lyapunov_level(CAP, CAP, HOME, Pose(np.eye(3), (0.1, 0.0, 0.0)))


def test_bad_basins() -> None:
    tracker = so.Tracker(CAP, POINT)
    with pytest.raises(ValueError, match=r"starts = \[\] of 5 steps"):
        control.basin(tracker, HOME, ABOVE, [], 5)
    with pytest.raises(ValueError, match="outside face 0"):
        control.basin(tracker, HOME, ABOVE, [((("face", 0), (9.0, 0.0)), (("vertex", 0), ()))], 5)
    inside = Pose(np.eye(3), (0.1, 0.1, 0.4))
    with pytest.raises(ValueError, match="no certified distance"):
        control.basin(tracker, HOME, inside, [((("face", 0), (0.0, 0.0)), (("vertex", 0), ()))], 5)
