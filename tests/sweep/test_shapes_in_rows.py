"""Rows whose bodies change: each is answered with the body that is made of its numbers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import standoff as so
from families.solid_shapes import tube
from standoff.errors import StandoffError
from standoff.scene import SceneError
from standoff.scene.shapes import NUMBERS, SHAPES, read_body
from standoff.solids import save_boundary
from standoff.sweep import job as jobs
from standoff.sweep.subjects.shaped_body import shape_numbers
from sweep.conftest import Make
from sweep.shape_jobs import SHAPE_JOB, TABLES, TOOL_AND_BALL, shaped_of, table_of

NO_NUMBERS = ("planar_loop", "hull_of_revolution", "patches")
"""Shapes of curves and patches: of these `rounding` and `scale` alone."""


def test_every_number_of_every_shape_is_known() -> None:
    assert {*SHAPES} == {*TABLES, *NO_NUMBERS}
    for shape in TABLES:
        keys = {what.partition(".")[0] for what in shape_numbers(table_of(shape))}
        assert keys == {key for key in SHAPES[shape].keys if key in NUMBERS} | {"rounding", "scale"}


@pytest.mark.parametrize("shape", TABLES)
def test_a_row_s_body_is_the_body_of_such_a_scene(shape: str, rng: np.random.Generator) -> None:
    """To the bit, also where the swept ball alone is made anew."""
    table = table_of(shape)
    before = read_body(table).digest
    for what in shape_numbers(table):
        key, _, entry = what.partition(".")
        given = table.required(key, "") if key in table else 0.3
        x = float(given[int(entry) - 1] if entry else given) * rng.uniform(0.9, 1.1)
        value = [*given[: int(entry) - 1], x, *given[int(entry) :]] if entry else x
        made, told = shaped_of(shape, what).made((x,)), read_body(table.replaced({key: value}))
        assert (made.digest, made.radius, made.size) == (told.digest, told.radius, told.size)
        assert made.report.size == told.report.size
        assert made.digest != before or (shape, what) == ("point", "scale")


def test_several_numbers_of_one_body(rng: np.random.Generator) -> None:
    x = rng.uniform(0.5, 1.5, 4)
    made = shaped_of("ellipsoid", "semi_axes.3", "rounding", "semi_axes.1").made((*x[:3],))
    assert made.digest == so.shapes.ellipsoid([x[2], 2.0, x[0]], rounding=x[1]).digest
    both = shaped_of("capsule", "radius", "length", "rounding").made((*x[:3],))
    assert both.digest == so.shapes.capsule(x[0], x[1], rounding=x[2]).digest
    scaled = shaped_of("sphere", "scale", "radius").made((2.0, x[0]))
    assert scaled.radius == pytest.approx(2.0 * (x[0] + 0.2))


def test_a_row_is_the_distance_of_bodies_made_by_themselves(make: Make) -> None:
    job = make(SHAPE_JOB, TOOL_AND_BALL)
    rows, numbers = job.answers(0, 60), job.numbers(0, 60)
    a, b = job.poses(numbers)
    for k, (r, x, z, _) in enumerate(numbers.tolist()):
        tool, ball = so.shapes.ellipsoid([x, 1.0, z]), so.shapes.sphere(r)
        there = so.distances(tool, ball, a[k], b[0])
        assert there.distance[0] == rows.distance[k]
        assert there.lower_bound[0] == rows.lower_bound[k]
        if k % 15 == 0:
            alone = job.alone(k)
            assert alone.rows.distance[0] == rows.distance[k]
            assert [body.digest for body in alone.shapes] == [tool.digest, ball.digest]
            assert job.distances(k, k + 1).distance[0] == rows.distance[k]
    with pytest.raises(StandoffError, match="bodies of several shapes"):
        job.distances(0, 2)


def test_rows_computed_together_in_any_way_are_the_same(
    make: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    job = make(SHAPE_JOB, TOOL_AND_BALL)
    facts = job.kept(0, 60).facts()
    monkeypatch.setattr(jobs, "BLOCK", 7)
    again = make(SHAPE_JOB, TOOL_AND_BALL)
    assert again.digest == job.digest
    assert again.kept(0, 60).facts() == facts


def test_balls_come_nearer_by_what_their_radii_grow(make: Make) -> None:
    """Nothing moves at all: shapes alone change."""
    text = """version = 1
scene = "scene.toml"
[parameters.r]
shapes = "ball"
what = "radius"
from = 0.0
to = 7.0
[parameters.s]
shapes = "tool"
what = "rounding"
from = 0.0
to = 2.0
[sampler]
kind = "grid"
"""
    scene = TOOL_AND_BALL.replace('"ellipsoid"\nsemi_axes = [3.0, 1.0, 0.8]', '"point"')
    job = make(text.replace("to =", "steps = 8\nto ="), scene)
    rows, numbers = job.answers(0, 64), job.numbers(0, 64)
    between = np.linalg.norm([0.5, -0.4, 4.0])
    np.testing.assert_allclose(rows.distance, between - numbers.sum(axis=1), atol=1e-14)
    assert (rows.distance < 0.0).any()
    assert (rows.lower_bound <= rows.distance).all()
    assert job.alone(9).rows.distance[0] == rows.distance[9]


def test_the_digest_knows_which_numbers_change(make: Make) -> None:
    job = make(SHAPE_JOB, TOOL_AND_BALL)
    assert job.facts["shapes"]["ball"] == {"shape": "sphere", "radius": 1.0}
    assert job.facts["parameters"]["a"]["shapes"] == "tool"
    # the same bodies as the scene has them, and others from row to row
    other = TOOL_AND_BALL.replace('"sphere"', '"superellipsoid"').replace("radius = 1.0", "")
    capsule = TOOL_AND_BALL.replace('"sphere"', '"capsule"\nlength = 0.0')
    assert make(SHAPE_JOB, capsule).digest != job.digest
    with pytest.raises(SceneError):
        make(SHAPE_JOB, other)


def test_a_row_of_a_file_that_makes_no_body_is_told(make: Make, tmp_path: Path) -> None:
    text = """version = 1
scene = "scene.toml"
[parameters.r]
shapes = "ball"
what = "radius"
[sampler]
kind = "file"
file = "rows.csv"
"""
    (tmp_path / "rows.csv").write_text("r\n1.0\n2.0\n-1.0\n3.0\n")
    job = make(text, TOOL_AND_BALL)
    assert job.answers(0, 2).distance[0] > job.answers(0, 2).distance[1]
    with pytest.raises(StandoffError, match=r"row 2: 'ball' with radius = -1 is no body"):
        job.answers(1, 4)
    with pytest.raises(StandoffError, match=r"'ball' with radius = -1 is no body"):
        job.alone(2)


NUMBER = '[parameters.p]\nshapes = "{body}"\nwhat = "{what}"\n{rest}\n'
TOP = 'version = 1\nscene = "scene.toml"\n'
SOBOL = '[sampler]\nkind = "sobol"\nrows = 4\n'


@pytest.mark.parametrize(
    ("body", "what", "rest", "key", "told"),
    [
        ("bal", "radius", "from = 1\nto = 2", "p.shapes", "did you mean 'ball'?"),
        ("ball", "radios", "from = 1\nto = 2", "p.what", "did you mean 'radius'?"),
        ("ball", "height", "from = 1\nto = 2", "p.what", "number of sphere 'ball'"),
        ("ball", "x", "from = 1\nto = 2", "p.what", "here: 'radius', 'rounding' or 'scale'"),
        (
            "tool",
            "semi_axes",
            "from = 1\nto = 2",
            "p.what",
            "write 'semi_axes.1', 'semi_axes.2' or 'semi",
        ),
        ("tool", "semi_axes[0]", "from = 1\nto = 2", "p.what", "write 'semi_axes.1', "),
        ("tool", "semi_axes.4", "from = 1\nto = 2", "p.what", "write 'semi_axes.1', "),
        ("tool", "semi_axes.1", "from = 0\nto = 2", "p.from", "must be above zero, got [0.0, 1.0"),
        ("ball", "radius", "from = -1\nto = 2", "p.from", "'ball' with radius = -1 is no body"),
        ("ball", "radius", "from = 1\nto = 1e60", "p.to", "1e+60"),
        ("ball", "radius", "from = 2\nto = 1", "p.to", "above 'from'"),
        ("ball", "radius", "from_degrees = 1\nto = 2", "p.from_degrees", "'radius' is a length"),
        ("ball", "scale", "from_degrees = 1\nto = 2", "p.from_degrees", "without a unit"),
        ("ball", "radius", 'moves = "ball"\nfrom = 1\nto = 2', "p.moves", "unknown key"),
        ("ball", "radius", "from = 1", "p", "'to' is missing"),
    ],
)
def test_refused(make: Make, body: str, what: str, rest: str, key: str, told: str) -> None:
    text = f"{TOP}{NUMBER.format(body=body, what=what, rest=rest)}{SOBOL}"
    with pytest.raises(SceneError) as caught:
        make(text, TOOL_AND_BALL)
    assert caught.value.key == f"parameters.{key}"
    assert told in str(caught.value)


def test_ends_that_do_not_go_together_are_refused(make: Make) -> None:
    scene = TOOL_AND_BALL.replace('"sphere"\nradius = 1.0', '"lens"\nradius = 2.0\noffset = 1.0')
    one = NUMBER.format(body="ball", what="radius", rest="from = 1.5\nto = 2")
    two = NUMBER.format(body="ball", what="offset", rest="from = 1\nto = {}").replace(".p]", ".q]")
    make(f"{TOP}{one}{two.format(1.4)}{SOBOL}", scene)
    with pytest.raises(
        SceneError, match=r"parameters\.p: 'ball' with radius = 1\.5, offset = 1\.6"
    ):
        make(f"{TOP}{one}{two.format(1.6)}{SOBOL}", scene)


def test_a_range_that_leaves_the_plane_is_refused(make: Make) -> None:
    """Of a point that becomes a segment across the other body's plane."""
    curve = "kind = 'ellipse'\ncentre = [0.0, 0.0]\nsemi_axes = [3.0, 1.0]"
    loop = f'"planar_loop"\n[[bodies.tool.curves]]\n{curve}'
    scene = TOOL_AND_BALL.replace('"ellipsoid"\nsemi_axes = [3.0, 1.0, 0.8]', loop)
    scene = scene.replace('"sphere"\nradius = 1.0', '"segment"\nlength = 0.0')
    scene = scene.replace("4.0]\nrotation_vector = [0.3, -0.2, 0.4]", "0.0]")
    for what, refused in (("rounding", False), ("length", True)):
        number = NUMBER.format(body="ball", what=what, rest="from = 0\nto = 2")
        if refused:
            with pytest.raises(SceneError, match=r"parameters\.p\.to: .* planar partner"):
                make(f"{TOP}{number}{SOBOL}", scene)
        else:
            assert make(f"{TOP}{number}{SOBOL}", scene).answers(0, 4).row.tolist() == [0, 1, 2, 3]


def test_what_is_not_given_by_numbers_is_refused(make: Make, tmp_path: Path) -> None:
    number = NUMBER.format(body="ball", what="radius", rest="from = 1\nto = 2")
    with pytest.raises(SceneError, match="this job is over a world of 2 bodies: shapes change in"):
        make(f"{TOP}{number}{SOBOL}".replace("scene =", "world ="), TOOL_AND_BALL)
    save_boundary(tmp_path / "ball.json", tube(1.0, 1.5, -0.5, 0.5).boundary)
    scene = TOOL_AND_BALL.replace('shape = "sphere"\nradius = 1.0', 'body = "ball.json"')
    with pytest.raises(SceneError, match="over tool and ball: shapes change in jobs of a scene's"):
        make(f"{TOP}{number}{SOBOL}", scene)
    save_boundary(tmp_path / "ball.json", so.shapes.box(1.0, 1.0, 1.0))
    with pytest.raises(SceneError, match="'ball' is read from a file, and has no numbers"):
        make(f"{TOP}{number}{SOBOL}", scene)
    scaled = TOOL_AND_BALL.replace("radius = 1.0", "radius = 1.0\nscale = [1.0, 1.0, 1.0]")
    with pytest.raises(SceneError, match="known here: 'radius' or 'rounding'"):
        make(f"{TOP}{number.replace('radius', 'scalar')}{SOBOL}", scaled)
