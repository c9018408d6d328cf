"""Knots inserted into exact patches change nothing but the time; nor do other parameters."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest

import standoff as so
from families import patch_shells as shells
from families import refined_shells as family
from families.refined_shells import SHELLS, SPACINGS, refined
from oracles.exact_pairs import random_rotation
from shares import only, share
from standoff.bodies.proofs import prove_patch
from standoff.bodies.tolerances import ROUNDOFF
from standoff.geometry import (
    BezierPatch,
    Extrusion,
    FormulaSurface,
    NurbsCurve,
    NurbsSurface,
    Revolution,
)


@cache
def coarse(name):
    return so.Body.from_patches(SHELLS[name](), name=name)


def assert_same(body, plain):
    """As many features, all convex, no slack; a defect and a residual of roundoff."""
    one, other = body.check(), plain.check()
    for what in ("faces", "edges", "vertices", "smooth_edges", "charts", "notes"):
        assert getattr(one, what) == getattr(other, what)
    assert all(patch.convex for patch in one.patches)
    assert one.slack == other.slack == 0.0
    assert one.convexity_defect <= ROUNDOFF * body.size
    assert one.sewing_residual <= ROUNDOFF * body.size
    assert body.size == pytest.approx(plain.size, rel=1e-14)


@pytest.mark.parametrize(("spacing", "name"), share(6, SPACINGS, SHELLS))
def test_knots_along_u_and_v_of_all_patches_change_no_feature(name, spacing):
    patches = [refined(patch, spacing, "uv") for patch in SHELLS[name]()]
    assert_same(so.Body.from_patches(patches), coarse(name))


MORE = pytest.mark.soak


@pytest.mark.parametrize("name", ["lens prism", "spline", "cone"])
@pytest.mark.parametrize("way", ["u", pytest.param("v", marks=MORE), "uv"])
@pytest.mark.parametrize("count", [pytest.param(1, marks=MORE), 5])
@pytest.mark.parametrize("spacing", [0.038, pytest.param(1e-3, marks=MORE), 1e-5])
def test_knots_on_one_patch_alone_change_no_feature(name, way, count, spacing):
    first, *others = SHELLS[name]()
    body = so.Body.from_patches([refined(first, spacing, way, count), *others])
    assert_same(body, coarse(name))


@pytest.mark.parametrize(
    ("spacing", "name"), share(2, [1e-3, 1e-5], ["lens prism", "fillet box", "octants"])
)
def test_turned_and_moved_bodies_have_no_slack_either(name, spacing, rng):
    """Numbers with all their digits, and knots at collapsed sides and knife edges."""
    turn, shift = random_rotation(rng), rng.uniform(-1.0, 1.0, 3)
    plain = [patch.transformed(turn, shift) for patch in SHELLS[name]()]
    fine = [refined(patch, spacing, "uv", 3) for patch in plain]
    assert_same(so.Body.from_patches(fine), so.Body.from_patches(plain))


@pytest.mark.parametrize("name", ["lens prism", "fillet box", "ellipsoid", "spline", "cone"])
def test_distances_stay_the_same(name, rng):
    plain, other, home = coarse(name), so.shapes.lens(0.5, 0.2), so.Pose.identity()
    spacing = SPACINGS[rng.integers(len(SPACINGS))]
    body = so.Body.from_patches([refined(patch, spacing, "uv", 3) for patch in SHELLS[name]()])
    for _ in range(10):
        away = rng.normal(size=3)
        at = so.Pose(random_rotation(rng), 2.5 * away / np.linalg.norm(away) * rng.uniform(1, 2))
        one, two = (so.distance(b, other, home, at) for b in (body, plain))
        assert one.status == two.status
        assert one.distance == pytest.approx(two.distance, abs=1e-12 * plain.size)
        assert one.lower_bound == pytest.approx(two.lower_bound, abs=1e-12 * plain.size)


@pytest.mark.parametrize("spacing", only([SPACINGS[0], SPACINGS[-1]], SPACINGS))
def test_profiles_and_planar_loops_with_inserted_knots(spacing):
    top = NurbsCurve([(-1, 0), (-0.5, 1), (0.5, 1), (1, 0)], [0] * 4 + [1] * 4)
    low = NurbsCurve([(1, 0), (0, -1.5), (-1, 0)], [0] * 3 + [1] * 3)
    meridian = NurbsCurve([(0, 0, -1), (0.8, 0, -1), (0.9, 0, 1), (0, 0, 1.2)], [0] * 4 + [1] * 4)
    ends = [so.bodies.Edge(top, 0, 1), so.bodies.Edge(low, 1, 0)]

    def bodies(change):
        loop = [so.bodies.Edge(change(edge.curve), edge.first, edge.last) for edge in ends]
        corners = [(-1, 0, 0), (1, 0, 0)]
        yield so.Body.from_brep(corners, loop, dimension=2)
        sides = [Extrusion(change(curve), [0.0, 0.2, 1.0]) for curve in (top, low)]
        caps = [
            BezierPatch(np.stack([top.control_points, _raised(low)[::-1]], axis=1) + shift)
            for shift in (np.zeros(3), np.array([0.0, 0.2, 1.0]))
        ]
        yield so.Body.from_patches([*sides, *caps])
        yield so.Body.from_patches([Revolution(change(meridian))])

    def change(curve):
        return curve.refined(family.cluster((0.0, 1.0), spacing, 3))

    for body, plain in zip(bodies(change), bodies(lambda curve: curve), strict=True):
        assert_same(body, plain)


def _raised(curve):
    return curve.elevated(3).control_points


def dented(depth, spacing):
    """A cube of edge 2; its top has knots `spacing` apart, and control points among them lie
    `depth` too low."""
    x, y = np.meshgrid(*(np.linspace(-1.0, 1.0, 4),) * 2, indexing="ij")
    top = BezierPatch(np.stack([x, y, np.ones((4, 4))], axis=-1))
    top = refined(top, spacing, "u", 4)
    points = top.control_points.copy()
    points[4, 1:3, 2] -= depth
    return [*shells.box((2.0, 2.0, 2.0))[:5], NurbsSurface(points, top.knots_u, top.knots_v)]


@pytest.mark.parametrize("spacing", only([0.1, 1e-5], [0.1, 1e-2, 1e-3, 1e-4, 1e-5]))
@pytest.mark.parametrize("depth", [pytest.param(1e-9, marks=MORE), 1e-11])
def test_a_dent_among_inserted_knots_is_not_waved_through(spacing, depth):
    """The slack is no less than the dent is deep; or the normals turn so far that it is refused."""
    patches = dented(depth, spacing)
    proof = prove_patch(patches[5])
    lowest = min(
        patches[5].jet(u, v)[0][2]
        for u in 0.41 + spacing * np.linspace(-3.0, 3.0, 49)
        for v in np.linspace(0.1, 0.9, 9)
    )
    assert 1.0 - lowest >= 0.1 * depth
    assert proof.defect >= 1.0 - lowest
    # over the dent's own width the normals turn by its depth over that
    assert proof.tilt >= 0.1 * depth / (10.0 * spacing)
    body = so.Body.from_patches(patches, convexity_tolerance=10.0)
    assert body.check().slack >= 1.0 - lowest
    if body.check().convexity_defect > 1e-6 * body.size:
        with pytest.raises(so.BodyError, match="Not convex"):
            so.Body.from_patches(patches)


def test_knots_inserted_into_a_dented_top_leave_its_dent():
    t = np.linspace(-1.0, 1.0, 5)
    points = np.stack([*np.meshgrid(t, t, indexing="ij"), np.ones((5, 5))], axis=-1)
    points[2, 2, 2] -= 1e-8
    box = shells.box((2.0, 2.0, 2.0))[:5]
    plain = so.Body.from_patches([*box, BezierPatch(points)]).check()
    for spacing in (0.3, 1e-3, 1e-5):
        top = refined(BezierPatch(points), spacing, "uv", 3)
        report = so.Body.from_patches([*box, top]).check()
        assert report.slack == pytest.approx(plain.slack, rel=1e-6)
        assert not report.patches[5].convex


def with_knots(patch, first, width):
    """The same surface over another domain."""
    knots = [first + width * (t - t[0]) / (t[-1] - t[0]) for t in (patch.knots_u, patch.knots_v)]
    return NurbsSurface(patch.control_points, *knots, patch.weights)


DOMAINS = [(0.0, 1e-6), (0.0, 1e6), (1e6, 1.0), (-1e9, 1e3)]


@pytest.mark.parametrize(
    ("name", "domain"), share(2, ["lens prism", "ellipsoid", "cylinder", "fillet box"], DOMAINS)
)
def test_domains_of_any_place_and_width_serve(name, domain):
    first, width = domain
    patches = [with_knots(patch, first, width) for patch in SHELLS[name]()]
    body = so.Body.from_patches(patches)
    report, other = body.check(), coarse(name).check()
    assert (report.faces, report.edges, report.vertices) == (
        other.faces,
        other.edges,
        other.vertices,
    )
    assert report.slack == 0.0


@pytest.mark.parametrize(
    ("ratio", "name"),
    share(2, [1e-4, 1e-2, 1e2, 1e4], ["lens prism", "ellipsoid", "spline", "bicubic"]),
)
def test_a_patch_with_weights_of_great_ratio_is_sewn_to_others(name, ratio):
    """u -> k u / (1 - u + k u), k^degree the ratio: the parameter runs k^2 times faster at one end
    than at the other."""
    patches = SHELLS[name]()
    k = next(i for i, patch in enumerate(patches) if isinstance(patch, BezierPatch))
    p, _ = patches[k].degrees
    patches[k] = shells.bezier(
        shells.homogeneous(patches[k]) * (ratio ** (np.arange(p + 1) / p))[:, None, None]
    )
    body = so.Body.from_patches(patches)
    report, other = body.check(), coarse(name).check()
    assert (report.faces, report.edges, report.vertices) == (
        other.faces,
        other.edges,
        other.vertices,
    )
    assert report.slack <= 1e-11 * body.size


def full_turn(rows, ratio):
    """A patch of degree 5 that turns about z once, of rows (w r, w z, w), with uneven speed."""
    circle = [[5, 0, 5], [1, 4, 1], [-3, 2, 1], [-3, -2, 1], [1, -4, 1], [5, 0, 5]]
    c = np.array(circle)[:, None] * (ratio ** np.arange(6))[:, None, None]
    rows = np.array(rows, dtype=float)
    z, w = (c[..., 2] * rows[None, :, k] for k in (1, 2))
    h = np.stack([c[..., 0] * rows[:, 0], c[..., 1] * rows[:, 0], z, w], axis=-1)
    return shells.bezier(h)


@pytest.mark.parametrize(("ratio", "across"), [(1.0, 1e5), (10.0, 1e5), (230.0, 1.0)])
def test_a_patch_of_a_full_turn_with_uneven_speed_is_sewn_to_itself(ratio, across):
    """Weights of ratio ratio^5 along u, of `across` along v."""
    points = [(0.0, -0.5), (0.4, -0.5), (0.4, 0.5), (0.0, 0.5)]
    patches = [
        full_turn([(*low, 1.0), (across * high[0], across * high[1], across)], ratio)
        for low, high in pairwise(points)
    ]
    report = so.Body.from_patches(patches).check()
    assert report.faces <= 8
    assert report.slack <= 1e-10 * report.size


@pytest.mark.parametrize("steepness", only([200], [5, 60, 200]))
def test_a_patch_of_a_full_turn_is_halved_by_length(steepness):
    """Halved amid its parameter it leaves a sliver, which closes on itself all the more."""
    angle = f"2*pi*(exp({steepness}*u) - 1)/(exp({steepness}) - 1)"
    patches = [
        FormulaSurface(f"v*cos({angle})", f"v*sin({angle})", z, (0, 1, 0, 1))
        for z in ("(1 - v**2)/2", "0")
    ]
    report = so.Body.from_patches(patches).check()
    assert report.faces == 4
    assert report.slack == 0.0
