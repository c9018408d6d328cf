"""Derivatives in flat and line contact: what all optimal pairs agree on, and nan for the rest.

Of pairs (x, y) that serve with one normal n, the distance has the derivative least over them of
n . (y' - x') along any motion. The sets of pairs are those of ``contact_cases``, by closed form.
"""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

import standoff as so
from standoff.kernels.state import arrays as K
from standoff.tracking import Smoothness
from tracking.contact_cases import BOX, CASES, CYLINDER, LYING, OVERLAPS, PLATE, SQUARE

Array = NDArray[np.float64]

s = so.shapes
HOME = so.Pose.identity()
STEP = 1e-3
ARC = 1e-3
"""A turn of an area's pairs is told from none by this, length per radian."""
EXACT = 1e-9
LEFT, COARSE = ("cone on its side",), 1e-5
"""Of what queries in overlap may leave of the depth, 5e-9 within its bounds, over the step."""
OFF_PLANE = [2, 3, 4, 8, 9, 10]
WORLDS = {
    "as it lies": HOME,
    "turned about z": so.Pose.exp([0, 0, np.pi / 2], [0.4, -0.2, 0.0]),
    "turned": so.Pose.exp([0.3, 0.5, -0.7], [0.4, -0.2, 0.3]),
}
FLAT = [c for c in CASES if c.dim]
# the set is all of a side and ends with it: beyond, d bends at once
BENT = ("sliver", "edge on edge", "over the rim", "rounded box: edge")


def gaps_of(case):
    """Those at which the set is that of the least depth: slivers are left sideways."""
    return [gap for gap in case.gaps if gap > -1e-5 or "sliver" not in case.name]


def gradients(n: Array, on_a: Array, on_b: Array, poses: tuple[so.Pose, so.Pose]) -> Array:
    """(k, 12) of the pairs (x, y), one by one: (-n, -a x n, n, c x n)."""
    a, c = on_a - poses[0].translation, on_b - poses[1].translation
    n = np.broadcast_to(n, a.shape)
    return np.hstack([-n, -np.cross(a, n), n, np.cross(c, n)])


def after(a: so.Body, b: so.Body, poses: tuple[so.Pose, so.Pose], twist: Array) -> so.Proximity:
    """The answer after the twist (12,)."""
    v_a, w_a, v_b, w_b = twist.reshape(4, 3)
    moved = [
        so.Pose(so.Pose.exp(w, [0, 0, 0]).rotation @ pose.rotation, pose.translation + v)
        for pose, v, w in zip(poses, (v_a, v_b), (w_a, w_b), strict=True)
    ]
    return so.distance(a, b, *moved)


def slope(a: so.Body, b: so.Body, poses: tuple[so.Pose, so.Pose], unit: Array) -> float:
    """The central difference of the fourth order by a twist."""
    d = [after(a, b, poses, h * STEP * unit).distance for h in (-2, -1, 1, 2)]
    return (d[0] - 8 * d[1] + 8 * d[2] - d[3]) / (12 * STEP)


def put(case, gap, world, swapped):
    """(a, b, their poses, n, points on A, points on B) of a case, in the world."""
    n = world.rotation @ np.array(case.normal, dtype=float)
    pose_b = world @ so.Pose.exp(case.turn, case.position + gap * np.array(case.normal))
    x, y = world.apply(case.corners), world.apply(case.corners + gap * np.array(case.normal))
    if swapped:
        return case.b, case.a, (pose_b, world), -n, y, x
    return case.a, case.b, (world, pose_b), n, x, y


@pytest.mark.parametrize("swapped", [False, True], ids=["AB", "BA"])
@pytest.mark.parametrize("world", WORLDS)
@pytest.mark.parametrize(
    ("case", "gap"), [pytest.param(c, g, id=f"{c}, {g:g}") for c in FLAT for g in gaps_of(c)]
)
def test_what_all_pairs_agree_on_is_given(case, gap, world, swapped):
    planar = case.a.dimension == 2
    if planar and world == "turned":
        pytest.skip("planar bodies stay in their plane")
    a, b, poses, n, x, y = put(case, gap, WORLDS[world], swapped)
    found = so.distance(a, b, *poses).derivatives()
    if case.normals and gap == 0.0:
        assert found.smoothness is Smoothness.UNDEFINED
        return
    all_pairs = gradients(n, x, y, poses)
    if planar:
        all_pairs[:, OFF_PLANE] = 0.0
    lost = np.ptp(all_pairs, axis=0) > 1e-6
    assert found.smoothness is Smoothness.PARTIAL, found.reason
    np.testing.assert_array_equal(np.isnan(found.gradient), lost)
    assert np.abs((found.gradient - all_pairs[0])[~lost]).max() <= EXACT
    axes = [axis for axis, gone in zip("xyz", lost[3:6], strict=True) if gone]
    assert f"turns about {', '.join(axes)} have no derivative" in found.reason
    for others in (found.hessian, found.normal_jacobian, *found.point_jacobians):
        assert np.isnan(others).all()


@pytest.mark.parametrize("gap", [1.0, 1e-6, -1e-2])
@pytest.mark.parametrize("case", [c for c in FLAT if not any(k in c.name for k in BENT)], ids=str)
def test_differences_agree_and_tell_one_sidedness(case, gap):
    """The components there are those of differences; a turn without one has two slopes, each the
    least over the pairs."""
    a, b, poses, n, x, y = put(case, gap, HOME, False)
    answer = so.distance(a, b, *poses)
    given, all_pairs = answer.gradient, gradients(n, x, y, poses)
    for k, unit in enumerate(np.eye(12)):
        if case.a.dimension == 2 and k in OFF_PLANE:
            continue
        if not np.isnan(given[k]):
            loose = COARSE if gap < 0.0 and case.name in LEFT else EXACT
            assert abs(slope(a, b, poses, unit) - given[k]) <= loose
            continue
        small = 1e-7
        ahead, back = (
            after(a, b, poses, h * unit).distance - answer.distance for h in (small, -small)
        )
        loose = ARC if case.arc else 1e-5
        assert ahead / small == pytest.approx(all_pairs[:, k].min(), abs=loose)
        assert back / small == pytest.approx(-all_pairs[:, k].max(), abs=loose)
        assert ahead + back < -0.1 * small


@pytest.mark.parametrize("gap", [0.3, 1e-6, 0.0, -0.02])
@pytest.mark.parametrize("angle", [0.4, 2.0, 4.1])
def test_a_cam_and_its_roller(gap, angle):
    """A cam of elliptic section and a round roller, axes parallel: the slope of the gap by the
    cam's turn is there, by both closed form and differences; that by a tilt is not."""
    cam, roller = CYLINDER.transformed(np.diag([1.6, 1.0, 1.0])), s.cylinder(0.2, 1.0)
    x = np.array([0.8 * np.cos(angle), 0.5 * np.sin(angle), 0.1])
    n = np.array([np.cos(angle) / 0.8, np.sin(angle) / 0.5, 0.0])
    n /= np.linalg.norm(n)
    there = so.Pose.exp([0, 0, 0.3], x + (gap + 0.2) * n)
    answer = so.distance(cam, roller, HOME, there)
    assert answer.derivatives().smoothness is Smoothness.PARTIAL
    expected = gradients(n, x[None], (x + gap * n)[None], (HOME, there))[0]
    expected[[3, 4, 9, 10]] = np.nan
    np.testing.assert_allclose(answer.gradient, expected, rtol=0.0, atol=EXACT)

    assert slope(cam, roller, (HOME, there), np.eye(12)[5]) == pytest.approx(
        answer.gradient[5], abs=EXACT
    )
    for name in ("hessian", "normal_jacobian", "point_jacobians"):
        with pytest.raises(so.StandoffError, match=r"but parts of its gradient here: .*not unique"):
            getattr(answer, name)


@pytest.mark.parametrize("tilt", [1e-12, 1e-10, 1e-8, 1e-5])
@pytest.mark.parametrize("gap", [0.5, -0.02])
def test_tilts_of_a_cylinder_on_a_plate(tilt, gap):
    """Parallel to 1e-9 rad is parallel; beyond, its lower end alone touches, and all is there."""
    pose = so.Pose.exp([np.pi / 2 + tilt, 0, 0], [1, 2, 1 + gap])
    answer = so.distance(PLATE, CYLINDER, HOME, pose)
    n, given = answer.normal, answer.gradient
    assert np.abs(np.abs(n) - [0, 0, 1]).max() <= 2 * tilt
    np.testing.assert_array_equal(np.isnan(given), np.isin(np.arange(12), [3, 9]) & (tilt <= 1e-9))
    there = gradients(n, answer.point_a[None], answer.point_b[None], (HOME, pose))[0]
    here = ~np.isnan(given)
    assert np.abs(given - there)[here].max() <= EXACT


@pytest.mark.parametrize("angle", 10.0 ** np.arange(-12.0, -2.0))
def test_what_is_given_of_nearly_parallel_cylinders_has_nine_digits(angle):
    """Their common perpendicular is x: between parallel and crossed there is a gap without digits,
    and nothing that is wrong."""
    pose = so.Pose.exp([angle, 0, 0], [1.1, 0, 0.3])
    found = so.distance(CYLINDER, CYLINDER, HOME, pose).derivatives()
    flags = Smoothness.PARTIAL, Smoothness.UNDEFINED, Smoothness.SMOOTH
    assert found.smoothness is flags[int(angle > 5e-10) + int(angle > 5e-5)]
    if found.smoothness is not Smoothness.UNDEFINED:
        n = np.array([1.0, 0.0, 0.0])
        assert np.abs(found.gradient[[0, 1, 2, 6, 7, 8]] - np.r_[-n, n]).max() <= EXACT


def test_one_pair_of_a_singular_system_at_a_boundary():
    """A lying cylinder touches a disc's rim from inside, seen along n: one pair, without digits."""
    disc = s.cylinder(0.5, 1.0)
    pose = so.Pose.exp([0, 0, np.pi / 2], [0.25, 0.5, -0.75]) @ so.Pose.exp(LYING, [0, 0, 0])
    found = so.distance(disc, disc, HOME, pose).derivatives()
    assert found.smoothness is Smoothness.PARTIAL
    assert np.abs(found.gradient[6:9] - [0, 0, -1]).max() <= EXACT
    np.testing.assert_array_equal(np.isnan(found.gradient[9:]), [True, True, False])


@pytest.mark.parametrize("off", [0.0, 1e-10, 1e-8])
def test_an_axis_is_square_to_1e_9(off):
    """A turn about the line of contact has a derivative; about one off it by 1e-8 not.

    By the set of pairs, of a lying cylinder whose rim is named, and by the system, of two
    cylinders side by side.
    """
    pose = so.Pose.exp([0, 0, off], [1, 2, 1.5]) @ so.Pose.exp(LYING, [0, 0, 0])
    given = so.distance(s.halfspace(), CYLINDER, HOME, pose).gradient
    np.testing.assert_array_equal(np.isnan(given[[3, 4, 5]]), [True, off > 1e-9, False])
    np.testing.assert_array_equal(np.isnan(given[[9, 10, 11]]), [True, off > 1e-9, False])
    world = so.Pose.exp([off, 0, 0], [0.3, 0.2, 0.1])
    beside = so.distance(CYLINDER, CYLINDER, world, world @ so.Pose(np.eye(3), [1.1, 0, 0.3]))
    assert (beside.feature_a.kind, beside.feature_b.kind) == ("face", "face")
    np.testing.assert_array_equal(np.isnan(beside.gradient[3:6]), [False, True, off > 1e-9])
    np.testing.assert_array_equal(np.isnan(beside.gradient[9:]), [False, True, off > 1e-9])


def test_an_answer_that_still_converges_is_brought_to_its_optimum():
    """Of a law's frame with a normal off by 1e-5 the gradient has the optimum's."""
    cam, roller = CYLINDER, s.cylinder(0.2, 1.0)
    n = np.array([0.6, 0.8, 0.0])
    good = so.distance(cam, roller, HOME, so.Pose(np.eye(3), 1.0 * n))
    block = good._out.copy()
    block[K.NORMAL : K.NORMAL + 3] = np.array([0.6 - 8e-6, 0.8 + 6e-6, 0.0])
    given = so.Proximity(cam, roller, block).gradient
    assert np.abs(given[6:9] - n).max() <= EXACT


def test_a_flat_point_has_a_gradient_by_translation():
    """A superellipsoid's pole is flat to third order: one pair serves, but its place has few
    digits, so only the translations are given."""
    body = s.superellipsoid(0.5, 0.4, 0.3, exponents=(0.5, 0.5))
    answer = so.distance(s.halfspace(), body, HOME, so.Pose(np.eye(3), [0.1, 0.2, 0.7]))
    found = answer.derivatives()
    assert found.smoothness is Smoothness.PARTIAL
    np.testing.assert_allclose(found.gradient[6:9], [0, 0, 1], atol=1e-12)
    np.testing.assert_array_equal(np.isnan(found.gradient[9:]), [True, True, False])


@pytest.mark.parametrize("case", [c for c in OVERLAPS if c.normals], ids=str)
def test_curves_and_regions_of_normals_stay_undefined(case):
    pose = so.Pose.exp(case.turn, case.position)
    found = so.distance(case.a, case.b, HOME, pose).derivatives()
    assert found.smoothness is Smoothness.UNDEFINED
    assert np.isnan(found.gradient).all()


def test_two_equal_depths_in_flat_contact_are_undefined():
    """A box as deep below one face of a plate as above the other, and one that is not."""
    small = s.box(0.5, 0.5, 0.5)
    for height, flag in ((0.0, "UNDEFINED"), (0.01, "PARTIAL")):
        found = so.distance(PLATE, small, HOME, so.Pose(np.eye(3), [0.3, 0.2, height]))
        assert found.derivatives().smoothness is Smoothness[flag]


def test_rows_are_single_answers():
    """In arrays, and of a tracker's frames; with one row smooth, undefined or flat each."""
    poses = np.tile(np.eye(4), (5, 1, 1))
    poses[:, :3, 3] = [[0, 0, 1.5], [0.2, 0, 0.9], [0, 0, 0], [2, 2, 2], [1, 1.2, 1]]
    poses[4, :3, :3] = so.Pose.exp([0.3, 0.4, 0.5], [0, 0, 0]).rotation
    many = so.distances(BOX, BOX, np.eye(4), poses)
    found = many.derivatives()
    assert [flag.name for flag in found.smoothness[:3]] == ["PARTIAL", "PARTIAL", "UNDEFINED"]
    assert found.smoothness[4] is Smoothness.SMOOTH
    np.testing.assert_array_equal(many.gradient, found.gradient)
    for k, pose in enumerate(poses):
        single = so.distance(BOX, BOX, np.eye(4), pose).derivatives()
        assert single.smoothness is found.smoothness[k]
        assert single.reason == found.reasons.get(k, "")
        np.testing.assert_array_equal(np.isnan(single.gradient), np.isnan(found.gradient[k]))
        assert np.abs(np.nan_to_num(single.gradient - found.gradient[k])).max() <= EXACT
    tracker = so.Tracker(BOX, BOX, dt=1e-3)
    _, frames = tracker.run(tracker.start(np.eye(4), poses[0]), np.eye(4)[None], poses[:1])
    np.testing.assert_array_equal(frames[0].gradient, found.gradient[0])
    assert frames[0].derivatives().smoothness is Smoothness.PARTIAL


def test_planar_sides():
    """The plane's own turn is lost alone; columns out of the plane stay zero."""
    pose = so.Pose(np.eye(3), [0.3, 1.2, 0.0])
    given = so.distance(SQUARE, SQUARE, HOME, pose).gradient
    expected = [0, -1, 0, 0, 0, np.nan, 0, 1, 0, 0, 0, np.nan]
    np.testing.assert_array_equal(given, expected)
