"""Every shape of the format gives the body that the same call in Python gives."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from standoff import Body, shapes
from standoff.geometry import ConicArc, FormulaCurve, Line, NurbsCurve, RationalBezier
from standoff.scene import Scene, SceneError
from standoff.scene.shapes import CURVES, SHAPES

LoadText = Callable[[str], Scene]

TETRAHEDRON = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]]

TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])

# A bottom of one straight line, a right side of one conic arc, and a Bézier curve back.
LOOP = """
shape = "planar_loop"
rounding = 0.1
[[bodies.a.curves]]
kind = "line"
start = [0.0, 0.0]
end = [2.0, 0.0]
[[bodies.a.curves]]
kind = "ellipse"
centre = [1.0, 0.0]
semi_axes = [1.0, 0.5]
start_angle = 0.0
end_angle = 1.5707963267948966
[[bodies.a.curves]]
kind = "bezier"
control_points = [[1.0, 0.5], [0.2, 0.5], [0.0, 0.0]]
weights = [1.0, 0.8, 1.0]
"""


def loop() -> Body:
    return shapes.planar_loop(
        [
            Line((0.0, 0.0), (2.0, 0.0)),
            ConicArc((1.0, 0.0), (1.0, 0.0), (0.0, 0.5), 0.0, 0.5 * np.pi),
            RationalBezier([[1.0, 0.5], [0.2, 0.5], [0.0, 0.0]], [1.0, 0.8, 1.0]),
        ],
        rounding=0.1,
    )


# Half a circle by a NURBS of two quarters, and its chord bent outwards by a formula.
CURVED = """
shape = "planar_loop"
[[bodies.a.curves]]
kind = "nurbs"
control_points = [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0]]
weights = [1, 0.7071067811865476, 1, 0.7071067811865476, 1]
knots = [0, 0, 0, 0.5, 0.5, 1, 1, 1]
[[bodies.a.curves]]
kind = "formula"
x = "a*t"
y = "0.5*(t**2 - 1)"
start = -1.0
end = 1.0
parameters = { a = 1.0 }
"""


def curved() -> Body:
    half = np.sqrt(0.5)
    points = [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [-1.0, 1.0], [-1.0, 0.0]]
    knots = [0.0, 0.0, 0.0, 0.5, 0.5, 1.0, 1.0, 1.0]
    return shapes.planar_loop(
        [
            NurbsCurve(points, knots, [1.0, half, 1.0, half, 1.0]),
            FormulaCurve("a*t", "0.5*(t**2 - 1)", "0", -1.0, 1.0, {"a": 1.0}),
        ]
    )


CASES: list[tuple[str, Callable[[], Body]]] = [
    ('shape = "point"', shapes.point),
    ('shape = "segment"\nlength = 0.7', lambda: shapes.segment(0.7)),
    ('shape = "sphere"\nradius = 2', lambda: shapes.sphere(2.0)),
    ('shape = "ellipsoid"\nsemi_axes = [0.3, 0.2, 0.1]', lambda: shapes.ellipsoid(0.3, 0.2, 0.1)),
    ('shape = "capsule"\nradius = 0.1\nlength = 0.4', lambda: shapes.capsule(0.1, 0.4)),
    ('shape = "cylinder"\nradius = 0.1\nheight = 0.4', lambda: shapes.cylinder(0.1, 0.4)),
    ('shape = "cone"\nradius = 0.1\nheight = 0.4', lambda: shapes.cone(0.1, 0.4)),
    ('shape = "box"\nsize = [1, 2, 3]', lambda: shapes.box(1.0, 2.0, 3.0)),
    ('shape = "box"\nsize = [1, 2, 3]\nrounding = 0.2', lambda: shapes.box(1.0, 2.0, 3.0, 0.2)),
    (f'shape = "polygon"\nvertices = {TETRAHEDRON[1:]}', lambda: shapes.polygon(TETRAHEDRON[1:])),
    (f'shape = "polytope"\nvertices = {TETRAHEDRON}', lambda: shapes.polytope(TETRAHEDRON)),
    ('shape = "lens"\nradius = 1.0\noffset = 0.45', lambda: shapes.lens(1.0, 0.45)),
    ('shape = "cap"\nradius = 1.0\noffset = -0.2', lambda: shapes.cap(1.0, -0.2)),
    ('shape = "halfspace"', shapes.halfspace),
    (LOOP, loop),
    (CURVED, curved),
    (
        f'shape = "rounded_polytope"\nvertices = {TETRAHEDRON}\nrounding = 0.1',
        lambda: shapes.rounded_polytope(TETRAHEDRON, 0.1),
    ),
    ('shape = "spindle"\nradius = 0.1\nlength = 0.6', lambda: shapes.spindle(0.1, 0.6)),
    (
        'shape = "spindle"\nradius = 0.1\nlength = 0.6\npatches = 5',
        lambda: shapes.spindle(0.1, 0.6, 5),
    ),
    ('shape = "gore"\nradius = 0.1\nheight = 0.6', lambda: shapes.gore(0.1, 0.6)),
    (
        'shape = "gore"\nradius = 0.1\nheight = 0.6\npatches = 6',
        lambda: shapes.gore(0.1, 0.6, 6),
    ),
    ('shape = "egg"\nradius = 0.02\nlength = 0.06', lambda: shapes.egg(0.02, 0.06)),
    (
        'shape = "egg"\nradius = 0.02\nlength = 0.06\ntaper = -0.2',
        lambda: shapes.egg(0.02, 0.06, -0.2),
    ),
    (
        'shape = "hull_of_revolution"\ncurve = {kind = "bezier", '
        "control_points = [[0.1, -0.2], [0.3, 0.0], [0.05, 0.2]]}",
        lambda: shapes.hull_of_revolution(
            RationalBezier([[0.1, 0.0, -0.2], [0.3, 0.0, 0.0], [0.05, 0.0, 0.2]])
        ),
    ),
    (
        'shape = "superellipsoid"\nsemi_axes = [0.3, 0.2, 0.1]\nexponents = [0.6, 1.4]',
        lambda: shapes.superellipsoid(0.3, 0.2, 0.1, 0.6, 1.4),
    ),
    (
        'shape = "sphere"\nradius = 1\nscale = 0.5',
        lambda: shapes.sphere(1.0).transformed(0.5 * np.eye(3)),
    ),
    (
        'shape = "lens"\nradius = 1\noffset = 0.4\nscale = [1, 2, 3]',
        lambda: shapes.lens(1.0, 0.4).transformed(np.diag([1.0, 2.0, 3.0])),
    ),
    (
        f'shape = "box"\nsize = [1, 2, 3]\naffine = {TURN.tolist()}',
        lambda: shapes.box(1.0, 2.0, 3.0).transformed(TURN),
    ),
    (
        'shape = "point"\naffine = [[1,0,0,5], [0,1,0,6], [0,0,1,7], [0,0,0,1]]',
        lambda: shapes.point().transformed((np.eye(3), np.array([5.0, 6.0, 7.0]))),
    ),
]


def packed(body: Body) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    return np.asarray(body.ints), np.asarray(body.reals)


@pytest.mark.parametrize(
    ("table", "build"), CASES, ids=lambda case: case[:30] if isinstance(case, str) else "python"
)
def test_body_is_the_one_that_python_builds(
    load_text: LoadText, table: str, build: Callable[[], Body]
) -> None:
    other = '[bodies.other]\nshape = "sphere"\nradius = 1\n[pair]\na = "a"\nb = "other"\n'
    scene = load_text(f"version = 1\n[bodies.a]\n{table}\n{other}")
    body = scene.bodies["a"]
    for mine, theirs in zip(packed(body), packed(build()), strict=True):
        np.testing.assert_array_equal(mine, theirs)
    assert body.name == build().name


def test_every_shape_and_curve_is_among_the_cases() -> None:
    text = "".join(table for table, _ in CASES)
    for shape in SHAPES.keys() - {"patches"}:  # test_scene_patches.py has these
        assert f'shape = "{shape}"' in text
    for kind in CURVES:
        assert f'kind = "{kind}"' in text


def test_an_ellipse_is_tilted_from_x(load_text: LoadText) -> None:
    text = """
    version = 1
    [bodies.a]
    shape = "planar_loop"
    curves = [{kind = "ellipse", centre = [1, 2], semi_axes = [3, 1], tilt = 1.5707963267948966}]
    [bodies.other]
    shape = "point"
    [pair]
    a = "a"
    b = "other"
    """
    curve = load_text(text).bodies["a"].edge_parts[0].curve
    np.testing.assert_allclose(curve.point(0.0), [1.0, 5.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(curve.point(0.5 * np.pi), [0.0, 2.0, 0.0], atol=1e-15)


@pytest.mark.parametrize("shape", list(SHAPES))
def test_a_misspelt_key_is_refused_with_the_right_one(load_text: LoadText, shape: str) -> None:
    for key in (*SHAPES[shape].keys, "scale", "affine"):
        misspelt = key[:-2] + key[-1] + key[-2]
        with pytest.raises(SceneError) as caught:
            load_text(f'version = 1\n[bodies.a]\nshape = "{shape}"\n{misspelt} = 1\n')
        assert caught.value.key == f"bodies.a.{misspelt}"
        assert f"did you mean '{key}'?" in caught.value.problem
