"""The field's methods against certified answers, known roots and another engine; its statements."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import standoff as so
from standoff_studies.paper.bodies import lens_of_patches, planar_body
from standoff_studies.paper.convergence.pairs import pair
from standoff_studies.paper.field import algebra, figures, intervals, methods, newton, polyhedra
from standoff_studies.paper.field.rows import FULL, Row, committed, study
from standoff_studies.paper.field.shells import Shell, Spot
from standoff_studies.paper.field.support import climb, gjk
from standoff_studies.paper.field.work import Work, drawn_work, spot_at, spots_of
from standoff_studies.paper.simulation_a.setting import vault
from standoff_studies.paper.verdicts import Verdict

WINDOWS = {"A point": (0.3, 2.0), "B": (0.2, 1.1), "C": (1.0, 7.7), "D patches": (0.4, 3.9)}
"""Instants of the simulations, away from switches and near them [s]."""


DRAWN = 1000
"""Drawn pairs of the committed study."""


def work(key: str) -> Work:
    """Two short stretches of a simulation."""
    return Work(key[0], pair(key), WINDOWS.get(key, (0.5, 2.6)), frames=2, starts=2)


@pytest.mark.parametrize("body", [lens_of_patches, vault, planar_body])
def test_the_boundary_goes_on_beyond_each_side(
    body: Callable[[], so.Body], rng: np.random.Generator
) -> None:
    """The places beyond are the same point, on another patch, and lead away from this one."""
    shell = Shell(body())
    for patch, axis, end in shell.sides:
        q = rng.uniform(0.1, 0.9, shell.n)
        q[axis] = end
        here = shell.jet(Spot(patch, q), 1)
        onward = shell.beyond(Spot(patch, q))
        assert {other.patch for other, _ in onward} - {patch}
        for other, inward in onward:
            np.testing.assert_allclose(shell.jet(other, 0).x, here.x, atol=1e-12)
            if other.patch != patch:
                # the body is on one side of each: the two patches do not fold back on each other
                assert inward @ ((1.0 - 2.0 * end) * here.tangents[axis]) < np.linalg.norm(
                    here.tangents[axis]
                )


@pytest.mark.parametrize("body", [lens_of_patches, vault])
def test_a_climb_ends_at_the_top(body: Callable[[], so.Body], rng: np.random.Generator) -> None:
    """From any start, along any direction, no point of a dense sample is higher."""
    shell = Shell(body())
    at = np.stack(np.meshgrid(*[np.linspace(0.0, 1.0, 40)] * 2), -1).reshape(-1, 2)
    samples = np.concatenate([patch.points(at) for patch in shell.patches])
    for way in (*rng.normal(size=(20, 3)), np.array([0.0, 0.0, 1.0])):
        start = Spot(int(rng.integers(len(shell.patches))), rng.uniform(size=2))
        _, top = climb(shell, start, way)
        assert top @ way >= (samples @ way).max() - 1e-9


def test_common_roots_are_found() -> None:
    """Of p = (u - 0.3)(v - 0.7) and q = (u - 0.3)² + (v - 0.4)² - 0.09: two in the square."""
    p = np.outer([-0.3, 1.0], [-0.7, 1.0])
    q = np.array([[0.16, -0.8, 1.0], [-0.6, 0.0, 0.0], [1.0, 0.0, 0.0]])
    found = algebra.common_roots(p, q)
    for u, v in ((0.3, 0.1), (0.3, 0.7)):
        assert min(abs(u - x) + abs(v - y) for x, y in found) < 1e-5
    assert algebra.unit_roots(np.array([0.06, -0.5, 1.0])) == pytest.approx([0.3, 0.2])
    assert algebra.roots_of_two_faces(1, 1) == 168


def test_the_walk_finds_the_distance_of_two_hulls(rng: np.random.Generator) -> None:
    """Another engine: the library's own hulls of the same corners, from any start."""
    shells = Shell(lens_of_patches()), Shell(vault())
    bodies = polyhedra.tessellated(shells, 5)
    a, b = (so.Body.from_points(body.home) for body in bodies)
    for _ in range(8):
        poses = so.Pose.identity(), so.Pose.exp(tuple(rng.normal(size=3)), (3.0, 0.5, 1.0))
        for body, shell, pose in zip(bodies, shells, poses, strict=True):
            body.move(pose)
            shell.move(pose)
        x, y = (Spot(int(rng.integers(3)), rng.uniform(size=2)) for _ in shells)
        _, points = polyhedra.walk(bodies, polyhedra.begun(bodies, shells, (x, y)))
        due = so.distance(a, b, *poses)
        assert np.linalg.norm(points[0] - points[1]) == pytest.approx(due.distance, abs=1e-9)


SOLVERS = {
    "gjk": (gjk, 1e-5),
    "newton": (newton.newton, 1e-7),
    "boxes": (intervals.minimise, 1e-7),
    "algebra": (algebra.solve, 1e-7),
}
"""Methods on patches, and how far off a witness point may be: GJK's by the root of its bounds."""

TRIED = [(key, "D patches") for key in SOLVERS]
TRIED += [("gjk", "E patches"), ("newton", "E patches"), ("algebra", "C"), ("newton", "C")]


@pytest.mark.parametrize(("key", "pair_key"), TRIED)
def test_a_method_finds_the_certified_points(key: str, pair_key: str) -> None:
    one, (step, tolerance) = work(pair_key), SOLVERS[key]
    for time in one.windows:
        due = one.truth(time + 1e-3)
        spots = spots_of(one, one.truth(time))
        for shell, pose in zip(one.shells, one.poses(time + 1e-3), strict=True):
            shell.move(pose)
        _, points = step(one.shells, spots)
        np.testing.assert_allclose(points, [due.point_a, due.point_b], atol=tolerance)


def test_ellipsoids_by_resultants(rng: np.random.Generator) -> None:
    """The closest points of two ellipsoids are those of a certified query."""
    for _ in range(8):
        axes, turn, way = rng.uniform(0.5, 1.5, (2, 3)), rng.normal(size=3), rng.normal(size=3)
        pose = so.Pose.exp(tuple(turn), tuple(4.0 * way / np.linalg.norm(way)))
        a, b = (np.diag(each**-2.0) for each in axes)
        rotation = pose.rotation
        points = algebra.two_ellipsoids(a, rotation @ b @ rotation.T, pose.translation)
        due = so.distance(*(so.shapes.ellipsoid(*each) for each in axes), so.Pose.identity(), pose)
        np.testing.assert_allclose(points, [due.point_a, due.point_b], atol=1e-9)


def test_newton_goes_on_over_a_side() -> None:
    """From a side of the next patch it comes to the closest point, a little beyond on this one."""
    shells, tried = (Shell(lens_of_patches()), Shell(so.shapes.point())), 0
    shell, home = shells[0], so.Pose.identity()
    shell.move(home)
    for patch, axis, end in shell.sides:
        if axis == 1:  # where the patch ends in a point
            continue
        foot = np.array([0.03 + 0.94 * end, 0.5])
        jet = shell.jet(Spot(patch, foot), 1)
        n = np.cross(*jet.tangents)
        way = np.sign(n @ jet.x) * n / np.linalg.norm(n)
        shells[1].move(so.Pose(np.eye(3), jet.x + 0.3 * way))
        for other, _ in shell.beyond(Spot(patch, np.array([end, 0.5]))):
            _, points = newton.newton(shells, (other, Spot(0, np.zeros(0))))
            np.testing.assert_allclose(points[0], jet.x, atol=1e-7)
            tried += other.patch != patch
    assert tried == 6


def test_every_kind_of_place_is_a_spot() -> None:
    """A start's place, and an answer's on a face, an edge and a vertex."""
    one = work("D patches")
    for time in np.linspace(0.0, 5.3, 40).tolist():
        due = one.truth(time)
        spot, _ = spots_of(one, due)
        one.shells[0].move(so.Pose.identity())
        np.testing.assert_allclose(one.shells[0].jet(spot, 0).x, due.point_a, atol=1e-12)
    assert spot_at((("face", 2), (0.1, 0.2))).patch == 2


def of(rows: tuple[Row, ...], method: str, name: str) -> Row:
    return figures.of(rows, method)[name]


@pytest.mark.parametrize("name", ["A", "drawn"])
def test_the_committed_rows_are_those_of_the_methods(name: str) -> None:
    """A few frames made anew cost what the study says, and are no farther off."""
    some = [work("A point")] if name == "A" else [drawn_work(k, 2) for k in range(2)]
    for row in study(some, ("vclip", "gjk", "newton", "blind", "paper", "own")):
        due = of(committed(), row.method, name)
        assert row.worst <= due.worst
        assert row.median <= 2.0 * due.median
        assert row.error <= 2.0 * due.error
        assert row.failures == 0


def test_the_study_is_whole() -> None:
    rows = committed()
    for key in methods.METHODS:
        names = {"vclip 40": "E", "vclip 80": "E", "planes": "ABD", "algebra": "ABCD"}
        due = set(names.get(key, "ABCDE")) | ({"drawn"} if key not in names else set())
        assert set(figures.of(rows, key)) == due
    assert {of(rows, key, "drawn").tried for key in ("vclip", "gjk", "paper", "own")} == {DRAWN}
    assert of(rows, "boxes", "drawn").frames == FULL.boxes
    table = figures.table(rows)
    assert len({len(column) for column in table.values()}) == 1
    assert "not run" in table["frames"]


def verdicts(rows: tuple[Row, ...]) -> list[Verdict]:
    """Of the four claims: efficiency, Newton's, the basin, the polyhedra."""
    return [Verdict.of(statement) for statement in figures.statements(rows)[:4]]


def test_a_dearer_law_changes_the_verdict(monkeypatch: pytest.MonkeyPatch) -> None:
    """Integrated by RK4 a frame takes four evaluations, more than Newton's iteration to its end."""
    assert verdicts(committed()) == [Verdict.FAILS, Verdict.HOLDS, Verdict.HOLDS, Verdict.HOLDS]
    printed = methods.law_of
    monkeypatch.setattr(
        methods,
        "law_of",
        lambda key, gain=1e3: (
            replace(printed(key, gain), integrator="rk4") if key == "paper" else printed(key, gain)
        ),
    )
    dear = {row.work: row for row in study([work("A point")], ("paper",))}
    assert dear["A"].median == 4.0
    rows = tuple(
        dear["A"] if (row.method, row.work) == ("paper", "A") else row for row in committed()
    )
    assert verdicts(rows)[1] is Verdict.FAILS


def test_each_verdict_can_turn() -> None:
    """With two steps dearer than the law, with Newton arriving from all starts, with polyhedra as
    accurate as the law, each of the others turns."""
    rows = committed()
    dear = [row._replace(median=3.0) if row.method == "blind" else row for row in rows]
    assert verdicts(tuple(dear))[0] is Verdict.HOLDS
    sure = [row._replace(arrived=row.tried) if row.method == "newton" else row for row in rows]
    assert verdicts(tuple(sure))[2] is Verdict.FAILS
    fine = [row._replace(error=1e-9) if row.method.startswith("vclip") else row for row in rows]
    assert verdicts(tuple(fine))[3] is Verdict.FAILS
