"""The set of reference [28] beside Eqs. (1)-(4): issue 4, item 11, on the study's own numbers.

What the study calls exact, a common normal or an intersection is judged here by the ellipsoids'
support functions and implicit equations, which the study does not use.
"""

import numpy as np
import pytest

from standoff_studies.paper import normals
from standoff_studies.paper.normals_contact import passing
from standoff_studies.paper.normals_study import (
    FORMS,
    NORMAL,
    Points,
    begin,
    charts_of,
    equations,
    exact,
    focal_depth,
    pair_at,
    predicted,
    turned,
    witness_error,
)

PAPER, NORMALS, CONTACT = FORMS


def points_of(pair, points):
    """World points of A and B (n, 3) each."""
    return points.a @ pair.a.map.T, points.b @ pair.b.map.T + pair.centre


def implicit(side, centre, x):
    """Value of |D⁻¹(x - c)|² - 1 and its unit gradient, the outward normal, at points (n, 3)."""
    inverse = np.linalg.inv(side.map)
    y = (x - centre) @ inverse.T
    gradient = y @ inverse
    return (y * y).sum(axis=1) - 1.0, gradient / np.linalg.norm(gradient, axis=1, keepdims=True)


@pytest.mark.parametrize("distance", [-0.3, 0.0, 1e-6, 0.1, 10.0])
def test_the_exact_points_are_roots_of_every_set(distance):
    pair = pair_at(distance)
    points = exact(pair)
    x, y = points_of(pair, points)
    np.testing.assert_allclose(y - x, [distance * NORMAL], atol=1e-14 * max(1.0, distance))
    for side, centre, at, sign in ((pair.a, 0.0, x, 1.0), (pair.b, pair.centre, y, -1.0)):
        value, normal = implicit(side, centre, at)
        np.testing.assert_allclose(value, 0.0, atol=1e-14)
        np.testing.assert_allclose(normal, [sign * NORMAL], atol=1e-14)
    for form in FORMS:
        r = equations(pair, form, points, charts_of(pair, points.a, points.b)).r
        np.testing.assert_allclose(r, 0.0, atol=1e-14 * max(1.0, abs(distance)))


@pytest.mark.parametrize("distance", [-0.3, -1e-3, 1e-6, 1e-2, 1.0, 100.0])
def test_the_determinants_differ_by_the_square_of_the_distance(distance):
    """|det M| = d² |det J| in unit tangents, whose handedness is the sign: M fails at contact."""
    pair = pair_at(distance)
    points = exact(pair)
    at = charts_of(pair, points.a, points.b)
    M, J = (equations(pair, form, points, at).jacobian[0] for form in (PAPER, NORMALS))
    found, known = abs(np.linalg.det(M)), distance**2 * abs(np.linalg.det(J))
    assert found == pytest.approx(known, rel=1e-14 / min(1.0, abs(distance)) ** 2 + 1e-12)


def test_the_focal_depth_is_where_the_support_functions_lose_their_maximum():
    """d(n) = n.p_B - h_A(n) - h_B(-n) is stationary at n; its Hessian there vanishes one way."""
    pair = pair_at(-focal_depth())

    def separation(n):
        n = n / np.linalg.norm(n)
        a, b = np.linalg.norm(pair.a.map.T @ n), np.linalg.norm(pair.b.map.T @ n)
        return n @ pair.centre - a - b

    first = np.cross(NORMAL, [0.0, 0.0, 1.0])
    first /= np.linalg.norm(first)
    frame, h = np.array([first, np.cross(NORMAL, first)]), 1e-3

    def second(u, v):
        total = 0.0
        for i, j in ((1, 1), (-1, -1), (1, -1), (-1, 1)):
            total += i * j * separation(NORMAL + h * (i * u + j * v))
        return total / (4.0 * h * h)

    hessian = np.array([[second(u, v) for v in frame] for u in frame])
    values = np.linalg.eigvalsh(hessian)
    assert abs(values[1]) < 1e-5
    assert values[0] < -0.1


@pytest.mark.soak
def test_condition_near_and_far():
    study = normals.run()
    near, far = normals.GAPS < 1e-3, normals.GAPS > 30.0
    plain = {form: study.conditions[form][:, 0] for form in FORMS}
    # near contact that of M goes as 1/d, the others' stay
    np.testing.assert_allclose(np.ptp(np.log(plain[PAPER] * normals.GAPS)[near]), 0.0, atol=0.01)
    assert np.ptp(plain[NORMALS][near]) < 0.01 * plain[NORMALS][0]
    assert plain[NORMALS][0] < 5.0 < plain[CONTACT][0] < 10.0
    # far away that of the normals' set goes as d, of the contact-regular form as d², of M it stays
    np.testing.assert_allclose(np.ptp(np.log(plain[NORMALS] / normals.GAPS)[far]), 0.0, atol=0.1)
    np.testing.assert_allclose(np.ptp(np.log(plain[CONTACT] / normals.GAPS**2)[far]), 0, atol=0.1)
    assert plain[PAPER][far].max() < 5.0
    # and scaling mends both, near and far
    for form in (NORMALS, CONTACT):
        assert study.conditions[form][:, 1].max() < 3.0
    assert study.conditions[PAPER][0, 1] > 1e7


def test_each_set_is_regular_where_the_statements_say():
    study = normals.run()
    zero = int(np.abs(normals.DEPTHS).argmin())
    assert normals.DEPTHS[zero] == pytest.approx(0.0, abs=1e-15)
    assert study.least[PAPER][zero] < 1e-14
    inner = (-study.focal + 0.02 < normals.DEPTHS) & (normals.DEPTHS < 0.4)
    for form in (NORMALS, CONTACT):
        assert study.least[form][inner].min() > 0.01
        beside = np.abs(normals.DEPTHS + study.focal).argmin()
        assert study.least[form][beside] < 0.02


def test_both_sets_have_the_same_four_roots():
    study = normals.run()
    pair = pair_at(0.1)
    kinds = {}
    for form in (PAPER, NORMALS):
        fate = study.fates[form, 0.1]
        assert fate.common_normals == 4
        assert (fate.found | fate.other).all()
        x, y = points_of(pair, fate.ends)
        (g_a, n_a), (g_b, n_b) = implicit(pair.a, 0.0, x), implicit(pair.b, pair.centre, y)
        np.testing.assert_allclose([g_a, g_b], 0.0, atol=1e-13)
        gap = (y - x) / np.linalg.norm(y - x, axis=1, keepdims=True)
        along = (n_a * gap).sum(axis=1), (n_b * gap).sum(axis=1)
        np.testing.assert_allclose(np.abs(along), 1.0, atol=1e-12)
        # near or far on either body: all four, and the witness points are the near-near pair
        signs = np.sign(along).T
        kinds[form] = {tuple(row) for row in signs}
        near = (signs == [1.0, -1.0]).all(axis=1)
        np.testing.assert_array_equal(near, fate.found)
    assert kinds[PAPER] == kinds[NORMALS] == {(1, 1), (1, -1), (-1, 1), (-1, -1)}


def test_in_penetration_intersections_solve_the_paper_set_alone():
    study = normals.run()
    d = normals.INSIDE
    pair = pair_at(d)
    fate = study.fates[PAPER, d]
    assert fate.meeting.mean() > 0.1
    assert fate.found.mean() < 0.05
    x, y = (side[fate.meeting] for side in points_of(pair, fate.ends))
    np.testing.assert_allclose(x, y, atol=1e-8)
    (g_a, n_a), (g_b, n_b) = implicit(pair.a, 0.0, x), implicit(pair.b, pair.centre, x)
    np.testing.assert_allclose([g_a, g_b], 0.0, atol=1e-7)
    assert np.linalg.norm(np.cross(n_a, n_b), axis=1).min() > 1e-3
    for form in (NORMALS, CONTACT):
        other = study.fates[form, d]
        assert not other.meeting.any()
        assert (other.found | other.other).all()
        assert 0.3 < other.found.mean() < 0.45


def test_starts_near_and_far():
    study = normals.run()
    near, far = normals.ANGLES <= 0.4, normals.ANGLES == 0.8
    for form in (NORMALS, CONTACT):
        for d in (normals.APART, normals.INSIDE):
            assert (study.shares[form, d][near] == 1.0).all()
            assert 0.5 < study.shares[form, d][far] < 0.8
    assert (study.shares[PAPER, normals.APART][near | far] == 1.0).all()
    assert study.shares[PAPER, normals.INSIDE][normals.ANGLES >= 0.4].max() < 0.1
    at = dict(zip(normals.START_DISTANCES, study.counts[PAPER], strict=True))
    assert 14 <= at[1e-6] <= 22
    assert at[10.0] <= 3
    assert (study.counts[NORMALS] <= 5).all()


def test_through_contact():
    study = normals.run()
    track = study.tracks[PAPER]
    touch = int(np.flatnonzero(track.time == 0.25)[0])
    assert abs(track.distance[touch]) < 1e-16
    assert track.error[: touch - 1].max() < 1e-9
    assert track.error[touch + 1 :].min() > 0.1
    assert study.past.error.max() < 1e-7
    assert np.abs(study.past.distance).min() > 1e-4
    for form in (NORMALS, CONTACT):
        assert study.tracks[form].error.max() < 1e-10


def test_the_feedforward_predicts_the_motion():
    """From the exact points, dt later, a step of -J⁻¹ r_t alone is off by dt², not dt."""
    for form in FORMS:
        errors = []
        for dt in (1e-2, 5e-3):
            pair = passing(0.1)
            points = predicted(pair, form, exact(pair), dt)
            errors.append(witness_error(passing(0.1 + dt), points)[0])
        assert errors[0] < 1e-3
        assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.15)


def test_starts_at_an_angle_are_at_that_angle():
    pair = pair_at(1.0)
    a, b = turned(pair, 0.3, 5, 0)
    at: Points = exact(pair)
    np.testing.assert_allclose(np.arccos(a @ at.a[0]), 0.3, atol=1e-12)
    np.testing.assert_allclose(np.arccos(b @ at.b[0]), 0.3, atol=1e-12)
    assert (witness_error(pair, begin(pair, a, b)) > 0.05).all()


def test_the_artwork_says_what_was_measured():
    artwork = normals.comparison()
    assert len(artwork.statements) == 9
    assert all(one.holds is None and one.stated == "-" for one in artwork.statements)
    for table in artwork.tables.values():
        assert len({len(column) for column in table.values()}) == 1
    assert len(artwork.draw().axes) == 6
