"""What shapes, curves, surfaces and bodies refuse: an error that names the value and the fix."""

import itertools
import re

import numpy as np
import pytest

import standoff as so
from standoff.bodies import Edge, Face
from standoff.bodies.assembly import _stations
from standoff.geometry import (
    Cone,
    ConicArc,
    Cylinder,
    Line,
    NurbsCurve,
    Plane,
    RationalBezier,
    Sphere,
)

NAN, INF = np.nan, np.inf
SQUARE = ((0, 0), (1, 0), (1, 1), (0, 1))
TETRAHEDRON = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]

SIZES = {
    "sphere": ("radius",),
    "segment": ("length",),
    "capsule": ("radius", "length"),
    "cylinder": ("radius", "height"),
    "cone": ("radius", "height"),
    "lens": ("radius", "offset"),
}
"""Shapes and the names of their sizes, all positive, or zero for the first three."""
TRIPLES = {"ellipsoid": "semi_axes", "box": "size"}
MAY_BE_ZERO = ("sphere", "segment", "capsule")


@pytest.mark.parametrize(("shape", "name"), [(s, n) for s, names in SIZES.items() for n in names])
@pytest.mark.parametrize(
    ("value", "words"),
    [
        (0, "= 0.0: must be positive"),
        (-1.5, "= -1.5: must be (zero or )?positive"),
        (NAN, "= nan: must be finite"),
        (INF, "= inf: must be finite"),
        ("long", "= 'long' is not a number"),
        (1j, "= 1j is not a number"),
        ([1, 2], r"= \[1, 2\] is not a number"),
    ],
)
def test_sizes(shape, name, value, words):
    sizes = dict.fromkeys(SIZES[shape], 1.0)
    if shape == "lens":
        sizes["offset"] = 0.5
    make = getattr(so.shapes, shape)
    make(**sizes)
    if value == 0 and shape in MAY_BE_ZERO:
        make(**{**sizes, name: value})
        return
    with pytest.raises(ValueError, match=f"^{name} {words}") as caught:
        make(**{**sizes, name: value})
    assert caught.value.argument == name


@pytest.mark.parametrize(("shape", "name"), TRIPLES.items())
@pytest.mark.parametrize(
    ("value", "words"),
    [
        (0, r"\[1\] = 0.0: must be positive"),
        (-1.5, r"\[1\] = -1.5: must be positive"),
        (NAN, r" has a NaN or infinite number: \[ 1\. nan 1\.\]"),
        ("long", r" is not numeric: \[1.0, 'long', 1.0\]"),
        (1j, " is not numeric"),
        ([1, 2], " is not numeric"),
    ],
)
def test_sizes_of_three_numbers(shape, name, value, words):
    make = getattr(so.shapes, shape)
    for call in (lambda: make(1.0, value, 1.0), lambda: make(**{name: [1.0, value, 1.0]})):
        with pytest.raises(ValueError, match=f"^{name}{words}"):
            call()


@pytest.mark.parametrize("offset", [1.0, 2.0])
def test_empty_lens(offset):
    with pytest.raises(ValueError, match=f"Empty lens: offset = {offset} is not below"):
        so.shapes.lens(1, offset)


@pytest.mark.parametrize("offset", [1.0, -1.0, 3.0])
def test_empty_cap(offset):
    with pytest.raises(ValueError, match=rf"offset = {offset} outside \(-1.0, 1.0\)"):
        so.shapes.cap(1, offset)
    with pytest.raises(ValueError, match="offset = nan"):
        so.shapes.cap(1, NAN)


@pytest.mark.parametrize("flat", [(1.0, 1.0, 1e-16), (1e-20, 2.0, 1e-20), (3.0, 1e40, 1.0)])
def test_flat_box(flat):
    """Its faces are nearer to each other than roundoff of their corners."""
    with pytest.raises(so.BodyError, match=r"core \[.*\] of a box is flat: thinner than 5e-15"):
        so.shapes.box(*flat)
    with pytest.raises(so.BodyError, match="span no volume"):
        so.shapes.polytope(corners(*flat))
    with pytest.raises(so.BodyError, match=r"is flat.*round it less"):
        so.shapes.box(2.0, 2.0, 1.0, rounding=np.nextafter(0.5, 0.0))


def test_a_box_is_the_polytope_of_its_corners_to_the_last_bit(rng):
    """Its vertices, edges and faces have the numbers that a hull gives them."""
    for lengths in (np.ones(3), *10.0 ** rng.uniform(-3.0, 3.0, (20, 3))):
        box, hull = so.shapes.box(*lengths), so.shapes.polytope(corners(*lengths))
        assert box.ints.tobytes() == hull.ints.tobytes()
        assert box.reals.tobytes() == hull.reals.tobytes()


def corners(*lengths):
    return [np.multiply(signs, lengths) / 2.0 for signs in itertools.product((-1, 1), repeat=3)]


def test_rounding():
    with pytest.raises(ValueError, match=r"rounding = 0\.5 leaves no core.*less than half"):
        so.shapes.box(1, 2, 3, rounding=0.5)
    with pytest.raises(ValueError, match=r"rounding = -0\.1: must be zero or positive"):
        so.shapes.box(1, 2, 3, rounding=-0.1)
    with pytest.raises(ValueError, match="rounding = nan"):
        so.shapes.box(1, 2, 3, rounding=NAN)


@pytest.mark.parametrize(
    ("vertices", "words"),
    [
        ([], "vertices has shape"),
        (TETRAHEDRON[:1], "1 vertices span no volume.*at least four points"),
        (TETRAHEDRON[:3], "3 vertices span no volume.*not in one plane"),
        ([(*corner, 0.5) for corner in SQUARE], "4 vertices span no volume"),
        (np.zeros((5, 3)), "5 vertices span no volume"),
        (np.outer(np.arange(6), (1, 2, 3)), "6 vertices span no volume"),
        ([*TETRAHEDRON, [0, 0, NAN]], "vertices has a NaN or infinite number"),
        ([*TETRAHEDRON, [0, INF, 0]], "vertices has a NaN or infinite number"),
        (SQUARE, r"vertices has shape \(4, 2\): give an array of n by 3 numbers"),
        ("cube", "vertices is not numeric: 'cube'"),
    ],
)
def test_polytopes(vertices, words):
    with pytest.raises(ValueError, match=words):
        so.shapes.polytope(vertices)


THIN = {
    "slab": lambda h: [(*corner, z) for corner in SQUARE for z in (0.0, h)],
    "tetrahedron": lambda h: [*((*corner, 0.0) for corner in SQUARE[:3]), (0.3, 0.3, h)],
    "needle": lambda h: [(0, 0, 0), (h, 0, 0), (0, h, 0), (0, 0, 1)],
    "blade": lambda h: [(0, 0, 0), (h, 0, 0), (0, h, 0), (0, 0, 1), (h, h, 0.5)],
    "tent": lambda h: [(0, 0, h), *((np.cos(t), np.sin(t), 0) for t in np.linspace(0, 6.2, 90))],
}


@pytest.mark.parametrize("name", THIN)
def test_thin_polytopes_are_built_or_told_to_be_thin(name):
    refused = 0
    for exponent in range(-6, -17, -1):
        h = 10.0**exponent
        for make in (so.shapes.polytope, lambda points, r=0.1 * h: rounded(points, r)):
            try:
                make(THIN[name](h))
            except so.BodyError as error:
                refused += 1
                said = str(error)
                if "span no volume" in said:
                    assert exponent <= -15
                    continue
                found = re.search(r"in one plane: (\S+) thick on an extent of (\S+),", said)
                assert found, said
                thick, extent = map(float, found.groups())
                assert 0.0 < thick < 2.0 * h
                assert 0.9 < extent < 3.0
                assert "Make it thicker than" in said
    assert refused
    assert make(THIN[name](1e-5)).bounded


def rounded(points, rounding):
    return so.shapes.rounded_polytope(points, rounding)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Line((1, 2), (1, 2)), r"Line from \[1. 2. 0.\] to itself"),
        (lambda: Line((0, 0), (NAN, 0)), "q has a NaN"),
        (lambda: Line((0,), (1, 1)), r"p has shape \(1,\)"),
        (lambda: ConicArc((0, 0), (1, 0), (2, 0)), "parallel or zero axes.*2"),
        (lambda: ConicArc((0, 0), (1, 0), (0, 0)), "parallel or zero axes"),
        (lambda: ConicArc((0, 0), (1, 0), (0, 1), 1, 1), "from t = 1.0 to 1.0: give 0 < last"),
        (lambda: ConicArc((0, 0), (1, 0), (0, 1), 0, 7), "from t = 0.0 to 7.0: give 0 < last"),
        (lambda: ConicArc((0, INF), (1, 0), (0, 1)), "centre has a NaN or infinite"),
        (lambda: ConicArc((0, 0), (1, 0), (0, 1), NAN), "first = nan"),
        (lambda: RationalBezier([(1, 2)]), "1 control point: give at least two"),
        (lambda: RationalBezier(SQUARE, [1, 1, 0, 1]), "weights must be positive"),
        (lambda: RationalBezier(SQUARE, [1, 1, -2, 1]), "weights must be positive.*-2"),
        (lambda: RationalBezier(SQUARE, [1, 1]), r"weights has shape \(2,\): give 4 numbers"),
        (lambda: RationalBezier([(0, 0), (NAN, 1)]), "control_points has a NaN"),
        (lambda: RationalBezier([(0, 0), (1, 1)], [1, NAN]), "weights has a NaN"),
        (lambda: Plane.through((0, 0, 0), (1, 2, 0), (2, 4, 0)), "parallel: no plane"),
    ],
)
def test_curves_and_planes(make, words):
    with pytest.raises(ValueError, match=words):
        make()


@pytest.mark.parametrize("kind", [Plane, Sphere, Cylinder, Cone])
def test_surfaces(kind):
    name = kind.__name__
    with pytest.raises(ValueError, match=rf"(?s){name}\.linear is singular.*independent columns"):
        kind(np.diag([1.0, 1, 0]), np.zeros(3))
    with pytest.raises(ValueError, match=rf"{name}\.linear has a NaN"):
        kind(np.full((3, 3), NAN), np.zeros(3))
    with pytest.raises(ValueError, match=rf"{name}\.shift has shape \(2,\)"):
        kind(np.eye(3), np.zeros(2))


@pytest.mark.parametrize(
    ("affine", "words"),
    [
        (np.zeros((3, 3)), "map is singular.*0. 0. 0."),
        (np.diag([1.0, 1, 1e-20]), "map is singular"),
        (np.full((3, 3), NAN), "affine map has a NaN"),
        (np.eye(2), r"affine map has shape \(2, 2\)"),
        ((np.eye(3), (1, 2)), r"affine shift has shape \(2,\)"),
        ((np.eye(3), (1, 2, INF)), "affine shift has a NaN or infinite"),
        (np.diag([1.0, 1, 1, 2]), "last row is .*it must be 0 0 0 1"),
        ("big", "affine map.*'big'"),
    ],
)
def test_affine_maps(affine, words):
    with pytest.raises(so.StandoffError, match=words) as refused:
        so.shapes.lens(1, 0.45).transformed(affine)
    assert refused.value.argument == "affine"


def test_maps_that_a_body_does_not_survive():
    with pytest.raises(ValueError, match=r"radius 0\.5 would not keep a round skin"):
        so.shapes.capsule(0.5, 1).transformed(np.diag([1, 1, 2]))
    disc = so.shapes.planar_loop([ConicArc((0, 0), (1, 0), (0, 1))])
    quarter_turn = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    for affine in (quarter_turn, (np.eye(3), (0, 0, 1))):
        with pytest.raises(ValueError, match="out of z = 0"):
            disc.transformed(affine)


def lines(*points):
    """A closed chain of straight curves."""
    return [Line(p, q) for p, q in zip(points, (*points[1:], points[0]), strict=True)]


@pytest.mark.parametrize(
    ("curves", "words"),
    [
        ([], "0 open curves: give at least two"),
        (lines(*SQUARE)[:1], "1 open curves: give at least two"),
        (lines(*SQUARE)[:3], "misses its vertex 0 by 1 "),
        ([*lines(*SQUARE)[:3], Line((0, 1), (0, 1e-3))], "misses its vertex 0 by 0.001"),
        (lines((0, 0), (2, 0), (0.5, 0.5), (0, 2)), "Not convex.*Split the body"),
        (lines((0, 0), (1, 1), (1, 0), (0, 1)), "Not convex"),
        ([RationalBezier([(0, 0), (0.5, 0.4), (1, 0)]), *lines((1, 0), (0.5, 2), (0, 0))[:2]],
         "Not convex"),
        (lines((0, 0, 0), (1, 0, 0), (0, 1, 1)), r"leaves z = 0 \(by 1\)"),
    ],
)  # fmt: skip
def test_planar_loops(curves, words):
    with pytest.raises(so.BodyError, match=words):
        so.shapes.planar_loop(curves)


def box_parts():
    """Vertices, edges and faces of a cube from -1/2 to 1/2."""
    body = so.shapes.box(1, 1, 1)
    return body.vertex_points.copy(), list(body.edge_parts), list(body.face_parts)


def reversed_loop(face):
    return Face(face.charts, tuple((edge, -sense) for edge, sense in face.loop))


def one_entry(face, entry):
    """The face with another first entry in its loop."""
    return Face(face.charts, (entry, *face.loop[1:]))


def moved_vertex(v, e, f):
    v[0, 0] += 1e-3
    return v, e, f


def nan_vertex(v, e, f):
    v[3, 1] = NAN
    return v, e, f


def lifted_face(v, e, f):
    return (
        v,
        e,
        [Face((f[0].charts[0].transformed(np.eye(3), np.full(3, 0.02)),), f[0].loop), *f[1:]],
    )


PARTS = {
    "a face missing": (lambda v, e, f: (v, e, f[:-1]), "Edge . is open: it bounds 1 faces"),
    "a face twice": (lambda v, e, f: (v, e, [*f, f[0]]), "Edge . is used too often.* 3 faces"),
    "an edge missing": (
        lambda v, e, f: (v, e, [*f[:-1], Face(f[-1].charts, f[-1].loop[1:])]),
        "Edge . is open",
    ),
    "an unknown edge": (
        lambda v, e, f: (v, e, [*f[:-1], one_entry(f[-1], (99, 1))]),
        "Face 5 names edge 99; there are 12",
    ),
    "an orientation of zero": (
        lambda v, e, f: (v, e, [*f[:-1], one_entry(f[-1], (f[-1].loop[0][0], 0))]),
        r"orientation 0; give \+1 or -1",
    ),
    "a loop both ways round": (
        lambda v, e, f: (
            v, e, [*f[:-1], one_entry(f[-1], (f[-1].loop[0][0], -f[-1].loop[0][1]))]
        ),
        "Face 5: its loop runs both ways round",
    ),
    "a moved vertex": (moved_vertex, "Edge . misses its vertex 0 by 0.001.*move the vertex"),
    "a NaN vertex": (nan_vertex, "vertices has a NaN"),
    "an unknown vertex": (
        lambda v, e, f: (v, [Edge(e[0].curve, e[0].first, 77), *e[1:]], f),
        "Edge 0 names vertex 77; there are 8",
    ),
    "an edge against its vertices": (
        lambda v, e, f: (v, [Edge(e[0].curve, e[0].last, e[0].first), *e[1:]], f),
        "Edge 0 misses its vertex",
    ),
    "an open edge without vertices": (
        lambda v, e, f: (v, [Edge(e[0].curve), *e[1:]], f),
        "Edge 0 is open: an open edge needs a first and a last vertex",
    ),
    "a sharp edge said to be smooth": (
        lambda v, e, f: (v, [Edge(e[0].curve, e[0].first, e[0].last, True), *e[1:]], f),
        "Edge 0 is said to be smooth, but",
    ),
    "a surface off its edges": (lifted_face, "Edge . leaves the surface of face 0 by"),
    "a face without a surface": (
        lambda v, e, f: (v, e, [*f[:-1], Face((), f[-1].loop)]),
        "Face 5.*(chart|surface)",
    ),
    "a vertex of its own": (
        lambda v, e, f: (np.vstack([v, [[0, 0, 0]]]), e, f),
        r"Vertices \[8\] belong to no edge",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", PARTS)
def test_parts_that_do_not_fit(name):
    spoil, words = PARTS[name]
    so.Body.from_brep(*box_parts())
    with pytest.raises(ValueError, match=words):
        so.Body.from_brep(*spoil(*box_parts()))


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"rounding": -1}, "rounding = -1.0: must be zero or positive"),
        ({"rounding": NAN}, "rounding = nan"),
        ({"dimension": 2}, "edges and vertices only, no faces"),
        ({"dimension": 4}, "dimension.*4"),
    ],
)
def test_options_of_a_body(options, words):
    with pytest.raises(ValueError, match=words):
        so.Body.from_brep(*box_parts(), **options)


@pytest.mark.parametrize(
    ("vertices", "words"),
    [
        ((), "at least one vertex, edge or face"),
        ([[1, 2], [3, 4], [5, 6]], r"vertices has shape \(3, 2\)"),
        ([[1, 2, 3, 4]], r"vertices has shape \(1, 4\)"),
        ([[0, 0, 0], [1, 0, 0]], r"Vertices \[0, 1\] belong to no edge"),
        ("here", "vertices is not numeric: 'here'"),
    ],
)
def test_vertices_alone(vertices, words):
    with pytest.raises(ValueError, match=words):
        so.Body.from_brep(vertices)


def test_a_closed_edge_has_no_vertices():
    circle = ConicArc((0, 0), (1, 0), (0, 1))
    with pytest.raises(so.BodyError, match="Edge 0 is closed and has vertices"):
        so.Body.from_brep([[1, 0, 0]], [Edge(circle, 0, 0)], dimension=2)


def test_a_face_past_a_hemisphere_needs_an_atlas():
    rim = np.sqrt(0.75)
    edge = Edge(ConicArc((0, 0, -0.5), (rim, 0, 0), (0, rim, 0)))
    ball = Face((Sphere(np.eye(3), np.zeros(3)),), ((0, 1),))
    disc = Face((Plane.through((0, 0, -0.5), (0, 1, 0), (1, 0, 0)),), ((0, -1),))
    with pytest.raises(so.BodyError, match=r"Face 0 does not see the whole of edge 0.*atlas"):
        so.Body.from_brep(edges=[edge], faces=[ball, disc])


def test_inward_loops_are_turned_and_reported():
    vertices, edges, faces = box_parts()
    good = so.Body.from_brep(vertices, edges, faces)
    assert good.check().notes == ()
    one = so.Body.from_brep(vertices, edges, [*faces[:-1], reversed_loop(faces[-1])])
    assert one.check().notes == ("face 5: loop given inward, turned outward",)
    every = so.Body.from_brep(vertices, edges, [reversed_loop(face) for face in faces])
    assert len(every.check().notes) == 6
    rng, home = np.random.default_rng(61), so.Pose.identity()
    for _ in range(50):
        place = so.Pose.exp(rng.normal(size=3), 2 * rng.normal(size=3))
        known = so.distance(good, so.shapes.point(), home, place)
        for turned in (one, every):
            found = so.distance(turned, so.shapes.point(), home, place)
            assert found.status is known.status
            np.testing.assert_equal(found.distance, known.distance)


def test_an_edge_is_compared_with_its_surfaces_in_every_span():
    # a bump of 1e-2 over a thousandth of an edge, between any nine points of the whole
    knots = [0, 0, 0.4871, 0.4875, 0.4879, 1, 1]
    points = np.array([[x, 0.0, 0.0] for x in (0, 0.4871, 0.4875, 0.4879, 1)])
    points[2, 2] = 1e-2
    curve = NurbsCurve(points, knots)
    heights = [curve.point(t)[2] for t in _stations(curve, 0.0, 1.0)]
    assert max(heights) == pytest.approx(1e-2)
    assert len(_stations(Line([0, 0, 0], [1, 0, 0]), 0.0, 1.0)) == 9


@pytest.mark.parametrize("patches", [None, 3, Sphere(np.eye(3), np.zeros(3))])
def test_patches_must_be_a_sequence(patches):
    with pytest.raises(so.BodyError, match="sequence of surfaces"):
        so.Body.from_patches(patches)
