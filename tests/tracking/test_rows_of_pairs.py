"""``so.distances`` of lists of bodies: every row is of bodies of its own."""

import itertools
import pickle

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.errors import StandoffTypeError
from standoff.kernels.lanes.layout import ROWS
from standoff.kernels.state import arrays as K
from standoff.tracking import Status

AXES = ((0.3, 0.4, 0.5), (0.2, 0.2, 0.6), (0.5, 0.1, 0.3))
EGGS = [so.shapes.ellipsoid(*axes) for axes in AXES]
ROUNDED = so.shapes.ellipsoid(0.2, 0.3, 0.2, rounding=0.05)
BOX, LENS, BALL = so.shapes.box(0.4, 0.6, 0.5), so.shapes.lens(0.5, 0.2), so.shapes.sphere(0.3)
KINDS = [*EGGS, ROUNDED, BOX, LENS, BALL, so.shapes.point()]


def drawn(rng, n):
    poses = np.tile(np.eye(4), (n, 1, 1))
    poses[:, :3, :3] = Rotation.random(n, random_state=rng).as_matrix()
    poses[:, :3, 3] = rng.uniform(-0.9, 0.9, size=(n, 3))
    return poses


def lists(rng, n, kinds=KINDS):
    return ([kinds[k] for k in rng.integers(0, len(kinds), n)] for _ in range(2))


def test_every_row_is_that_of_its_bodies_alone(rng):
    """To the last bit: rows of ellipsoids are in lanes beside rows of others."""
    n = 6 * ROWS + 3
    (a, b), poses_a, poses_b = lists(rng, n), drawn(rng, n), drawn(rng, n)
    found = so.distances(a, b, poses_a, poses_b)
    assert found.certified.all()
    assert (found.distance < 0.0).any()
    for k in range(n):
        alone = so.distances(a[k], b[k], poses_a[k], poses_b[k])
        assert alone.rows.tobytes() == found.rows[k].tobytes()
        assert found[k].bodies == (a[k], b[k])
        assert found.pairs[found.pair[k]] == (a[k], b[k])
        assert found.feature_a[k] == alone.feature_a[0]
        assert found.feature_b[k] == alone.feature_b[0]


def test_ellipsoids_of_many_pairs_are_answered_in_lanes(rng):
    """Each row of a block with bodies of its own, which differ in their axes and roundings."""
    n = 4 * ROWS
    (a, b), poses = lists(rng, n, [*EGGS, ROUNDED]), drawn(rng, n)
    poses[:, :3, 3] *= 2.0
    found = so.distances(a, b, np.eye(4), poses)
    again = so.distances(a, b, np.eye(4), poses, within=1e6)  # the general code
    apart = found.status == Status.CONVERGED
    assert apart.mean() > 0.5
    counts = found.rows[:, K.OUT_COUNTS :]
    assert (counts[apart] != again.rows[apart, K.OUT_COUNTS :]).any(axis=1).mean() > 0.9
    for name in ("distance", "lower_bound", "upper_bound"):
        one, other = getattr(found, name)[apart], getattr(again, name)[apart]
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-13)


def test_any_order_and_any_number_of_workers(rng):
    n = 5 * ROWS
    (a, b), poses = lists(rng, n), drawn(rng, n)
    found, order = so.distances(a, b, np.eye(4), poses), rng.permutation(n)
    turned = so.distances(
        [a[k] for k in order], [b[k] for k in order], np.eye(4), poses[order], workers=3
    )
    assert turned.rows.tobytes() == found.rows[order].tobytes()


def test_gaps_that_are_exact_by_construction(rng):
    """Balls of many radii."""
    radii = rng.uniform(0.1, 0.5, size=(2, 40))
    a, b = ([so.shapes.sphere(r) for r in own] for own in radii)
    way = rng.normal(size=(40, 3))
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    gaps, poses = rng.uniform(0.01, 1.0, 40), np.tile(np.eye(4), (40, 1, 1))
    poses[:, :3, 3] = (radii.sum(axis=0) + gaps)[:, None] * way
    found = so.distances(a, b, np.eye(4), poses)
    np.testing.assert_allclose(found.distance, gaps, rtol=0.0, atol=1e-14)
    assert len(found.pairs) == 40


def test_one_body_beside_a_list_and_one_pose_for_all(rng):
    pose = np.eye(4)
    pose[0, 3] = 1.5
    found = so.distances(BOX, KINDS, np.eye(4), pose)
    single = [so.distances(BOX, each, np.eye(4), pose).distance[0] for each in KINDS]
    assert found.distance.tolist() == single
    np.testing.assert_array_equal(
        so.distances(KINDS, BOX, pose, np.eye(4)).distance,
        [so.distances(each, BOX, pose, np.eye(4)).distance[0] for each in KINDS],
    )


def test_a_list_of_one_body_is_that_body(rng):
    poses = drawn(rng, 40)
    one, many = (so.distances(x, BOX, np.eye(4), poses) for x in (LENS, [LENS] * 40))
    assert many.rows.tobytes() == one.rows.tobytes()
    assert many.bodies == (LENS, BOX)
    np.testing.assert_array_equal(many.gradient, one.gradient)
    assert so.distances([LENS], BOX, np.eye(4), poses).rows.tobytes() == one.rows.tobytes()


def test_rows_follow_those_of_their_own_bodies(rng):
    """Two motions, whose rows alternate."""
    poses = np.tile(np.eye(4), (60, 1, 1))
    poses[:, 0, 3] = 1.2 + 0.005 * np.arange(60)
    a = [LENS if k % 2 else BOX for k in range(60)]
    found = so.distances(a, BALL, np.eye(4), poses, warm=True)
    for j, first in ((0, 0), (1, 1)):
        alone = so.distances(a[first], BALL, np.eye(4), poses[first::2], warm=True)
        assert found.of_pair(j).rows.tobytes() == alone.rows.tobytes()
        assert found.rows[first::2].tobytes() == alone.rows.tobytes()


def test_derivatives_are_those_of_each_pair(rng):
    n = 40
    (a, b), poses = lists(rng, n, [*EGGS, BOX, LENS]), drawn(rng, n)
    a[7] = b[7] = BOX
    poses[7] = np.eye(4)
    poses[7, 0, 3] = 1.0  # face to face
    found = so.distances(a, b, np.eye(4), poses)
    derived, gradient = found.derivatives(workers=2), found.gradient
    for k in range(n):
        alone = so.distances(a[k], b[k], np.eye(4), poses[k])
        own = alone.derivatives()
        assert derived.smoothness[k] == own.smoothness[0]
        assert derived.reasons.get(k) == own.reasons.get(0)
        np.testing.assert_array_equal(derived.hessian[k], own.hessian[0])
        np.testing.assert_array_equal(gradient[k], alone.gradient[0])
    assert 7 in derived.reasons


def test_refused_rows_and_the_rows_of_one_pair(rng):
    n = 20
    poses = drawn(rng, n)
    poses[[3, 8], 0, 0] = np.nan
    a = [BOX if k < 5 else LENS for k in range(n)]
    found = so.distances(a, BALL, np.eye(4), poses)
    assert sorted(found.errors) == [3, 8]
    part = found.of_pair(1)
    assert len(part) == n - 5
    assert list(part.errors) == [3]
    assert str(part.errors[3]) == str(found.errors[8])
    assert "Row 8 of poses_b" in str(part.errors[3])
    assert part.bodies == (LENS, BALL)
    again = pickle.loads(pickle.dumps(found))
    assert again.rows.tobytes() == found.rows.tobytes()
    assert "2 pairs of bodies" in repr(found)
    with pytest.raises(so.errors.StandoffError, match="of 2 pairs of bodies"):
        found.bodies  # noqa: B018
    with pytest.raises(IndexError):
        found.of_pair(2)


def disc(radius):
    return so.shapes.planar_loop([so.geometry.ConicArc((0, 0), (radius, 0), (0, radius))])


PLANAR = disc(0.2)


@pytest.mark.parametrize(
    ("a", "b", "poses", "error", "told"),
    [
        ([BOX, BALL], [BALL] * 3, 3, ValueError, "a has 2 bodies: give one for each row, 3"),
        ([], BALL, 1, ValueError, "a has 0 bodies: give one for each row, at least one"),
        ([BOX, BALL], BALL, 5, ValueError, "There are 2 pairs of bodies and 5 of poses"),
        ([BOX, "ball"], BALL, 2, StandoffTypeError, "The bodies of row 1: 'ball' is not a Body"),
        (BOX, [BALL, None], 2, StandoffTypeError, "The bodies of row 1: None is not a Body"),
        ("box", BALL, 2, StandoffTypeError, "'box' is not a Body"),
        (
            [so.shapes.halfspace(), BOX],
            [BALL, so.shapes.halfspace()],
            2,
            None,
            "",
        ),
        (so.shapes.halfspace(), [BALL, so.shapes.halfspace()], 2, ValueError, "of row 1: Two half"),
        ([BOX, PLANAR], [BALL, PLANAR], 2, ValueError, "row 1 are planar, those of row 0 are not"),
    ],
)
def test_lists_that_cannot_be_answered(a, b, poses, error, told):
    there = np.tile(np.eye(4), (poses, 1, 1))
    there[:, 0, 3] = 2.0
    if error is None:
        assert so.distances(a, b, np.eye(4), there).certified.all()
        return
    with pytest.raises(error, match=told):
        so.distances(a, b, np.eye(4), there)


def test_planar_bodies_of_many_kinds():
    discs = [disc(radius) for radius in (0.1, 0.2, 0.3)]
    poses = np.tile(np.eye(4), (9, 1, 1))
    poses[:, 0, 3] = 2.0
    poses[4, 2, 3] = 1.0  # out of the plane
    a, b = zip(*itertools.product(discs, discs), strict=True)
    found = so.distances(list(a), list(b), np.eye(4), poses)
    assert list(found.errors) == [4]
    gaps = [2.0 - x - y for x, y in itertools.product((0.1, 0.2, 0.3), repeat=2)]
    good = np.arange(9) != 4
    np.testing.assert_allclose(found.distance[good], np.array(gaps)[good], rtol=0.0, atol=1e-14)
