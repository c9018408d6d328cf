"""Derivatives by design, beside differences in 50 digits of closed forms."""

import makers
import numpy as np
import pytest
import support_functions
from mpmath import mp, mpf

import standoff as so
from standoff.errors import StandoffError
from standoff.tracking.derivatives import Smoothness

REST = np.eye(4)
CORNERS = [[1.0, 0.1, 0.0], [-0.2, 0.9, 0.1], [-0.6, -0.5, 0.2], [0.1, 0.0, 1.2], [0.0, 0.1, -0.7]]
SHAPES = {
    "ellipsoid": {"semi_axes": [0.5, 0.8, 1.1]},
    "sphere": {"radius": 0.4},
    "capsule": {"radius": 0.2, "length": 0.9},
    "cylinder": {"radius": 0.4, "height": 1.3},
    "cone": {"radius": 0.5, "height": 0.8},
    "box": {"size": [0.7, 1.1, 0.4], "rounding": 0.05},
    "polytope": {"vertices": CORNERS},
    "cap": {"radius": 1.0, "offset": 0.3},
    "lens": {"radius": 1.0, "offset": 0.45},
    "spindle": {"radius": 0.3, "length": 1.4},
    "point": {"rounding": 0.3},
    "segment": {"start": [0.1, -0.4, 0.2], "end": [-0.3, 0.5, 0.7]},
    "polygon": {"vertices": [[1.0, 0.1, 0.0], [-0.2, 0.9, 0.1], [-0.6, -0.5, 0.2]]},
    "rounded_polytope": {"vertices": CORNERS[:4], "rounding": 0.05},
    "egg": {"radius": 0.5, "length": 1.4, "taper": 0.4},
    "gore": {"radius": 0.4, "height": 1.3},
    "wheel": {"major": 0.7, "minor": 0.2, "tall": 0.3},
    "arch": {"control": [[-0.6, 0.0], [0.1, 0.9], [0.7, 0.1]], "weight": 1.3, "depth": 0.8},
    "dome": {"height": 0.9},
    "superellipsoid": {"semi_axes": [0.5, 0.8, 0.6], "exponents": [0.7, 1.3]},
}


def design_of(shape):
    make = getattr(makers, shape, None) or getattr(so.shapes, shape)
    return so.Design(make, **SHAPES[shape])


def exact(values):
    return [exact(v) for v in values] if isinstance(values, list) else mpf(values)


def placed(parameters, name, index, value):
    """The same parameters with one number replaced."""
    if not index:
        return parameters | {name: value}
    copy = [list(row) if isinstance(row, list) else row for row in parameters[name]]
    inner = copy
    for i in index[:-1]:
        inner = inner[i]
    inner[index[-1]] = value
    return parameters | {name: copy}


def support_rate(shape, parameters, name, index, n):
    """The derivative of a support function by one number, in 50 digits."""
    with mp.workdps(50):
        given = {key: exact(value) for key, value in parameters.items()}
        at = parameters[name]
        for i in index:
            at = at[i]
        way = [mpf(x) for x in n]
        way = [x / mp.sqrt(sum(y * y for y in way)) for x in way]
        function = getattr(support_functions, shape)
        return float(mp.diff(lambda x: function(way, **placed(given, name, index, x)), mpf(at)))


def wall_facing(n, distance):
    """A pose of a half-space whose boundary is square to n, at a height along it."""
    x = np.cross(n, np.eye(3)[np.abs(n).argmin()])
    x /= np.linalg.norm(x)
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([x, np.cross(-n, x), -n])
    pose[:3, 3] = distance * n
    return pose


@pytest.mark.parametrize("shape", SHAPES)
def test_rates_of_shapes_beside_a_wall(shape, rng):
    parameters = SHAPES[shape]
    design, wall = design_of(shape), so.shapes.halfspace()
    for _ in range(6):
        n = rng.normal(size=3)
        n /= np.linalg.norm(n)
        answer = so.distance(design.body, wall, REST, wall_facing(n, 3.0))
        found = so.shape_gradient(answer, a=design)
        assert found.b == {}
        for name, value in parameters.items():
            rates = np.asarray(found.a[name])
            assert rates.shape == np.shape(value)
            for index in np.ndindex(rates.shape):
                true = -support_rate(shape, parameters, name, index, n)
                assert abs(rates[index] - true) <= 1e-9, (shape, name, index, found.smoothness)


def gap_of(axes_a, axes_b, shift):
    """The distance of two ellipsoids with parallel axes in 50 digits: the greatest value of the
    support functions' difference, by Newton's method on its stationarity."""

    def slope(x, y):
        n = [mp.cos(x) * mp.cos(y), mp.sin(x) * mp.cos(y), mp.sin(y)]
        t1 = [-mp.sin(x), mp.cos(x), mpf(0)]
        t2 = [-mp.cos(x) * mp.sin(y), -mp.sin(x) * mp.sin(y), mp.cos(y)]
        ha, hb = (support_functions.ellipsoid(n, axes) for axes in (axes_a, axes_b))
        arm = [
            s - k * a * a / ha - k * b * b / hb
            for s, k, a, b in zip(shift, n, axes_a, axes_b, strict=True)
        ]
        return (
            sum(p * q for p, q in zip(t1, arm, strict=True)),
            sum(p * q for p, q in zip(t2, arm, strict=True)),
        )

    start = (mp.atan2(shift[1], shift[0]), mp.asin(shift[2] / support_functions.length(shift)))
    x, y = mp.findroot(slope, start)
    n = [mp.cos(x) * mp.cos(y), mp.sin(x) * mp.cos(y), mp.sin(y)]
    reach = support_functions.ellipsoid(n, axes_a) + support_functions.ellipsoid(n, axes_b)
    return support_functions.dot(n, shift) - reach


@pytest.mark.parametrize("shift", [[1.4, 0.9, 0.8], [0.65, 0.1, 0.05]])
def test_both_bodies_apart_and_in_overlap(shift):
    axes = {"a": [0.5, 0.8, 1.1], "b": [0.3, 0.2, 0.4]}
    a, b = (so.Design(so.shapes.ellipsoid, semi_axes=axes[side]) for side in "ab")
    pose = np.eye(4)
    pose[:3, 3] = shift
    answer = so.distance(a.body, b.body, REST, pose)
    assert (answer.distance < 0.0) == (shift[0] < 1.0)
    found = so.shape_gradient(answer, a=a, b=b)
    assert found.smoothness is Smoothness.SMOOTH
    with mp.workdps(50):
        exact_shift = exact(shift)
        true = gap_of(exact(axes["a"]), exact(axes["b"]), exact_shift)
        assert abs(answer.distance - float(true)) <= 1e-12
        for k in range(3):
            for side in "ab":

                def gap(x, side=side, k=k):
                    given = {s: exact(axes[s]) for s in "ab"}
                    given[side][k] = x
                    return gap_of(given["a"], given["b"], exact_shift)

                rate = float(mp.diff(gap, mpf(axes[side][k])))
                told = (found.a if side == "a" else found.b)["semi_axes"][k]
                assert abs(told - rate) <= 1e-9


def ring(radius, thickness):
    """A planar ring."""
    arc = so.geometry.ConicArc
    outer = radius + thickness
    return so.PlanarSolid.from_loops(
        [arc((0, 0), (outer, 0), (0, outer))], [[arc((0, 0), (radius, 0), (0, radius))]]
    )


def test_a_pin_in_the_hole_of_a_planar_solid():
    hole = so.Design(ring, radius=1.0, thickness=0.3)
    pin = so.Design(lambda r: ring(0.2, r), r=0.5)
    pose = np.eye(4)
    pose[:2, 3] = 0.03, 0.04
    answer = so.solids.distance(hole.body, pin.body, REST, pose)
    assert abs(answer.distance - 0.25) <= 1e-12
    found = so.shape_gradient(answer, a=hole, b=pin)
    np.testing.assert_allclose([found.a["radius"], found.a["thickness"]], [1.0, 0.0], atol=1e-9)
    assert abs(found.b["r"] + 1.0) <= 1e-9


def test_placements_are_parameters_too():
    def moved(x, turn):
        pose = np.eye(4)
        pose[:2, :2] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
        pose[0, 3] = x
        return so.shapes.box(1.0, 2.0, 0.5).transformed(pose)

    design, ball = so.Design(moved, x=0.2, turn=0.1), so.shapes.sphere(0.1)
    pose = np.eye(4)
    pose[:3, 3] = 1.3, 0.4, 0.0
    answer = so.distance(design.body, ball, REST, pose)
    found = so.shape_gradient(answer, a=design)
    # the pose gradient says the same of a translation and of a turn about A's origin, at x
    assert abs(found.a["x"] - answer.gradient[0]) <= 1e-9
    arm = answer.point_a - np.array([0.2, 0.0, 0.0])
    speed = np.cross([0.0, 0.0, 1.0], arm)
    assert abs(found.a["turn"] + answer.normal @ speed) <= 1e-9


def test_a_vertex_of_a_tilted_box_is_told_one_sided_or_smooth_and_flat_contact_partial():
    box = so.Design(so.shapes.box, size=[1.0, 1.0, 1.0])
    pose = np.eye(4)
    pose[0, 3] = 1.5
    answer = so.distance(box.body, so.shapes.box(1, 1, 1), REST, pose)
    found = so.shape_gradient(answer, a=box)
    assert found.smoothness is Smoothness.PARTIAL
    assert found.reason
    # all points of the face move alike
    np.testing.assert_allclose(found.a["size"], [-0.5, 0.0, 0.0], atol=1e-9)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: so.Design(3, radius=1.0), "give a function"),
        (lambda: so.Design(so.shapes.sphere), "no parameter"),
        (lambda: so.Design(so.shapes.sphere, radius=np.nan), "radius has a NaN"),
        (lambda: so.Design(lambda r: r, r=1.0).body, "must return a Body"),
        (lambda: so.Design(so.shapes.sphere, radius=1.0).changed(size=2.0), "'size' is no"),
    ],
)
def test_bad_designs_say_so(make, words):
    with pytest.raises((TypeError, ValueError), match=words):
        make()


def test_bad_questions_say_so():
    ball = so.Design(so.shapes.sphere, radius=1.0)
    pose = np.eye(4)
    pose[0, 3] = 3.0
    other = so.distance(so.shapes.sphere(0.9), ball.body, REST, pose)
    with pytest.raises(StandoffError, match="not the body of the design"):
        so.shape_gradient(other, a=ball)
    with pytest.raises(StandoffError, match="No design"):
        so.shape_gradient(other)
    with pytest.raises(TypeError, match=r"give a so\.Design"):
        so.shape_gradient(other, b=3)
    with pytest.raises(TypeError, match="answer"):
        so.shape_gradient(3, b=ball)
    edge = so.Design(so.shapes.lens, radius=1.0, offset=0.9999)
    found = so.distance(edge.body, ball.body, REST, pose)
    with pytest.raises(StandoffError, match=r"No derivative by .* makes no body"):
        so.shape_gradient(found, a=edge)


def test_a_boundary_that_jumps_is_refused():
    def jumping(r):
        return so.shapes.sphere(r + (0.1 if r > 1.0 else 0.0))

    ball, pose = so.Design(jumping, r=1.0), np.eye(4)
    pose[0, 3] = 3.0
    answer = so.distance(ball.body, so.shapes.sphere(0.5), REST, pose)
    with pytest.raises(StandoffError, match="not move smoothly"):
        so.shape_gradient(answer, a=ball)
