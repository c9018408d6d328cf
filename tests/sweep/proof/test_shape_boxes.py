"""Proofs over shapes: against samples of them, and against shares that are known exactly."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import NamedTuple

import numpy as np
import pytest

import standoff as so
from standoff.errors import StandoffError
from standoff.scene.reader import SceneTable
from standoff.scene.shapes import read_body
from standoff.sweep.job import Job
from standoff.sweep.proof.cells import Cells
from standoff.sweep.proof.pair_box import PairBox
from standoff.sweep.proof.proof import Proof
from standoff.sweep.proof.search import search
from standoff.sweep.proof.summary import Kind, ProofSummary
from sweep.conftest import Make
from sweep.shape_jobs import TOOL_AND_BALL

TOP = 'version = 1\nscene = "scene.toml"\n'
SOBOL = '[sampler]\nkind = "sobol"\nrows = 10\n'


def number(name: str, body: str, what: str, low: float, high: float) -> str:
    key = "moves" if what in ("x", "y", "z", "turn_x", "turn_y", "turn_z") else "shapes"
    return (
        f'[parameters.{name}]\n{key} = "{body}"\nwhat = "{what}"\nfrom = {low!r}\nto = {high!r}\n'
    )


class Case(NamedTuple):
    """A scene's two shapes, the parameters, and the clearance."""

    tool: dict[str, object]
    ball: dict[str, object]
    parameters: str
    clearance: float
    queries: int = 3000


ELLIPSOID = {"shape": "ellipsoid", "semi_axes": [3.0, 1.0, 0.8]}
BALL = {"shape": "sphere", "radius": 1.0}

CASES = {
    "semi-axes": Case(
        ELLIPSOID,
        BALL,
        number("a", "tool", "semi_axes.1", 1.0, 4.0)
        + number("c", "tool", "semi_axes.3", 0.5, 1.5)
        + number("z", "tool", "z", -2.0, 1.0),
        1.2,
    ),
    "a turned box that keeps its size": Case(
        {"shape": "box", "size": [2.0, 1.0, 1.5], "rounding": 0.1},
        {"shape": "ellipsoid", "semi_axes": [1.0, 0.8, 0.5]},
        number("r", "tool", "rounding", 0.0, 0.45)
        + number("t", "tool", "turn_y", -0.7, 1.2)
        + number("s", "tool", "size.1", 1.0, 3.0)
        + number("z", "tool", "z", -2.5, -1.0),
        0.6,
    ),
    "a lens and a ball": Case(
        {"shape": "lens", "radius": 1.5, "offset": 0.5},
        BALL,
        number("o", "tool", "offset", 0.3, 1.1)
        + number("r", "ball", "radius", 0.5, 2.5)
        + number("t", "tool", "turn_x", 0.0, 1.0),
        1.0,
        500,
    ),
    "radius and rounding": Case(
        {"shape": "capsule", "radius": 0.5, "length": 2.0},
        {"shape": "cylinder", "radius": 1.0, "height": 1.0},
        number("r", "tool", "radius", 0.1, 1.5)
        + number("g", "ball", "rounding", 0.0, 1.0)
        + number("t", "tool", "turn_y", -0.5, 0.8)
        + number("z", "tool", "z", -1.5, 0.0),
        0.5,
    ),
}


def plain(table: dict[str, object]) -> str:
    return "\n".join(
        f'{key} = "{value}"' if isinstance(value, str) else f"{key} = {value}"
        for key, value in table.items()
    )


def job_of(make: Make, case: Case) -> Job:
    scene = TOOL_AND_BALL.partition("[bodies.tool]")[0]
    scene += f"[bodies.tool]\n{plain(case.tool)}\n[bodies.ball]\n{plain(case.ball)}\n"
    scene += TOOL_AND_BALL[TOOL_AND_BALL.index("[placements") :]
    return make(f"{TOP}{case.parameters}{SOBOL}", scene)


def searched(
    job: Job, clearance: float, queries: int, finest: float = 0.05
) -> tuple[PairBox, ProofSummary, Cells, np.ndarray]:
    """A search, and all cells that it closed."""
    box, looked = Proof(job, clearance).box, []
    assert isinstance(box, PairBox)
    box.finest = finest
    found = search(box, box.whole, queries, 20, lambda *told: looked.append(told))
    kinds = np.concatenate([kind for _, kind, _ in looked])
    cells = Cells.together([cells for cells, _, _ in looked]).at(kinds >= 0)
    return box, found, cells, kinds[kinds >= 0]


def distance_at(job: Job, case: Case, row: np.ndarray) -> so.Proximity:
    """Of bodies that the scene's tables say, at poses by themselves."""
    tables = {"tool": dict(case.tool), "ball": dict(case.ball)}
    for p, x in zip(job.parameters, row.tolist(), strict=True):
        if p.shape:
            key, _, entry = p.what.partition(".")
            given = tables[p.moves].get(key, 0.0)
            value = [*given[: int(entry) - 1], x, *given[int(entry) :]] if entry else x
            tables[p.moves][key] = value
    bodies = [read_body(SceneTable(tables[name])) for name in ("tool", "ball")]
    return so.distance(*bodies, *(pose[0] for pose in job.poses(row[None])))


@pytest.mark.parametrize("name", CASES)
def test_no_sample_contradicts_a_cell(name: str, make: Make, rng: np.random.Generator) -> None:
    """Of samples drawn from the cells, half of them at their corners."""
    case = CASES[name]
    job = job_of(make, case)
    box, found, cells, kinds = searched(job, case.clearance, case.queries)
    assert sum((found.share(kind) for kind in Kind), Fraction(0)) == 1
    assert found.share(Kind.PROVEN) > 0.1
    assert found.share(Kind.VIOLATED) > 0.02
    low = np.array([p.low for p in job.parameters])
    sizes = 0.5**cells.levels
    for kind in (Kind.PROVEN, Kind.VIOLATED):
        own = np.flatnonzero(kinds == kind)
        # large cells are where a bound that is too good is seen
        drawn = rng.choice(own, 24, p=sizes[own] / sizes[own].sum())
        some = cells.at(drawn)
        way = rng.choice([-1.0, 1.0], some.place.shape)
        way[::2] = rng.uniform(-1.0, 1.0, way[::2].shape)
        for row in low + (some.middles + way * some.halves) * box.width:
            there = distance_at(job, case, row)
            if kind == Kind.PROVEN:
                assert there.upper_bound >= case.clearance - 1e-12
            else:
                assert there.lower_bound < case.clearance
            assert there.upper_bound >= found.bound


@pytest.mark.parametrize("name", ["semi-axes", "radius and rounding"])
def test_bounds_hold_everywhere_in_any_cell(
    name: str, make: Make, rng: np.random.Generator
) -> None:
    case = CASES[name]
    job = job_of(make, case)
    box = Proof(job, case.clearance).box
    columns = len(job.parameters)
    depth = rng.integers(0, 5, (30, columns))
    cells = Cells(rng.integers(0, 1 << 62, (30, columns)) % (1 << depth), depth, np.zeros((30, 0)))
    told, _, asked = box.told(cells)
    assert 30 < asked[0] <= 60
    low = np.array([p.low for p in job.parameters])
    for _ in range(3):
        way = np.clip(rng.uniform(-1.5, 1.5, cells.place.shape), -1.0, 1.0)
        rows = low + (cells.middles + way * cells.halves) * box.width
        for k, row in enumerate(rows):
            there = distance_at(job, case, row)
            assert told.lower[k] <= there.upper_bound + 1e-12
            assert told.upper[k] >= there.lower_bound - 1e-12


HEIGHT = number("r", "tool", "radius", 0.5, 1.5) + number("z", "tool", "z", -3.0, -2.0)


@pytest.mark.parametrize("wall", ['"halfspace"', '"sphere"\nradius = 0.25'])
def test_a_share_that_is_known(make: Make, wall: str) -> None:
    """A ball of the radius 0.5 + v, its centre 1 + u above the other body."""
    scene = TOOL_AND_BALL.replace('"sphere"\nradius = 1.0', wall)
    scene = scene.replace('"ellipsoid"\nsemi_axes = [3.0, 1.0, 0.8]', '"sphere"\nradius = 1.0')
    scene = scene.replace("[0.5, -0.4, 4.0]", "[0.0, 0.0, 4.0]")
    clearance = 0.25 if "half" in wall else 0.0
    _, found, _, _ = searched(make(f"{TOP}{HEIGHT}{SOBOL}", scene), clearance, 20_000, 0.004)
    # kept where u - v >= -0.25
    kept = 1.0 - 0.75**2 / 2.0
    assert 0.0 <= kept - float(found.share(Kind.PROVEN)) < 0.005
    assert 0.0 <= 1.0 - kept - float(found.share(Kind.VIOLATED)) < 0.005
    assert found.nearest.places.numbers[0] == pytest.approx([1.5, -3.0], abs=0.3)


def test_a_margin_is_proven_and_no_more(make: Make) -> None:
    """The least distance of the box is at the largest ball, and is known."""
    job = job_of(make, Case(ELLIPSOID, BALL, number("r", "ball", "radius", 0.5, 2.0), 0.0))
    fixed = so.distance(*(job.bodies), *job.homes).distance
    least = fixed - 1.0
    found = search(Proof(job, 0.999 * least).box, Cells.whole(1), 10_000, 5)
    assert (found.verdict.name, found.queries) == ("PROVEN", 1)
    over = search(Proof(job, 1.001 * least).box, Cells.whole(1), 10_000, 5)
    assert over.verdict.name == "VIOLATED"
    share = 0.001 * least / 1.5
    assert float(over.share(Kind.PROVEN)) == pytest.approx(1.0 - share, abs=0.002)


def test_counterexamples_are_rows_that_are_nearer(make: Make) -> None:
    case = CASES["semi-axes"]
    job = job_of(make, case)
    _, found, _, _ = searched(job, case.clearance, 500)
    places = found.counterexamples.places
    assert len(places.distance) == 20
    for row, distance in zip(places.numbers, places.distance, strict=True):
        assert distance < case.clearance
        assert distance_at(job, case, row).distance == pytest.approx(distance, abs=1e-12)
        assert job.subject.rows(job.parameters, row[None], 0).distance[0] <= distance


def test_what_is_halved_is_what_the_bound_is_lost_to(make: Make, rng: np.random.Generator) -> None:
    """Not the semi-axis across the normal, however long its range."""
    parameters = number("a", "tool", "semi_axes.1", 1.0, 2.0)
    parameters += number("b", "tool", "semi_axes.3", 0.5, 1.0)
    job = job_of(make, Case(ELLIPSOID, BALL, parameters, 0.0))
    homes = so.Pose.exp([0.0, 0.0, 0.0], [0.0, 0.0, 4.0]), so.Pose.identity()
    job = replace(job, subject=replace(job.pair, homes=homes))
    box = Proof(job, 2.3).box
    assert box.look(box.whole).along.tolist() == [1]
    growth = box.movers[0].growth
    assert growth is not None
    normals = rng.normal(size=(500, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    ends = [np.linalg.norm(normals * [2.0, 1.0, c], axis=1) for c in (0.5, 1.0)]
    rate = (ends[1] - ends[0]) / 0.5
    np.testing.assert_allclose(growth.along(normals)[:, 1], rate, atol=0.2)
    assert growth.most == pytest.approx([1.0, 1.0], abs=1e-9)


@pytest.mark.parametrize(
    ("shape", "what", "told"),
    [
        ({"shape": "cone", "radius": 1.0, "height": 2.0}, "height", "those of a cone that differ"),
        ({"shape": "egg", "radius": 1.0, "length": 2.0}, "taper", "in 'taper' do not nest"),
        ({"shape": "cap", "radius": 1.0, "offset": 0.5}, "scale", "sweep it, or prove one value"),
    ],
)
def test_bodies_that_do_not_nest_are_refused(
    make: Make, shape: dict[str, object], what: str, told: str
) -> None:
    job = job_of(make, Case(shape, BALL, number("p", "tool", what, 0.6, 0.69), 0.0))
    with pytest.raises(StandoffError, match=r"parameters\.p: .*") as caught:
        Proof(job, 0.1)
    assert told in str(caught.value)
