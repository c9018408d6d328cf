"""Planar solids against the study's own curves: its formulas, and that it sees what is wrong."""

from dataclasses import replace

import numpy as np
import pytest

import standoff as so
from standoff.geometry import ConicArc, Line
from standoff.solids import distance
from standoff_studies.soak import (
    blocks,
    planar_drawn,
    planar_judge,
    planar_sampling,
    planar_solids,
    planar_truth,
)
from standoff_studies.soak.planar_drawn import Judged, planar_pose

SEED = 3
SOLIDS = 3
FEW = 10.0, 16.0


def square(half):
    corners = half * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    return list(zip(corners, np.roll(corners, -1, axis=0), strict=True))


def made(segments, arcs=()):
    """A solid of one loop, or of a full circle."""
    curves = [Line(p, q) for p, q in segments]
    rows = [planar_sampling.cubic(np.array(each)) for each in segments]
    for centre, radius, first, last in arcs:
        curves.append(ConicArc(centre, (radius, 0.0), (0.0, radius), first, last))
        rows.append(planar_sampling.arc(np.array(centre), radius, first, last))
    solid = so.PlanarSolid.from_loops(curves)
    return Judged(solid, planar_sampling.outline([rows], 400.0), solid.size)


@pytest.fixture(scope="module")
def disc():
    return made([], [((0.0, 0.0), 0.5, -np.pi, 0.0), ((0.0, 0.0), 0.5, 0.0, np.pi)])


@pytest.fixture(scope="module")
def block():
    return made(square(0.5))


def least(a, b, x, y, angle=0.0):
    move = float(np.cos(angle)), float(np.sin(angle)), x, y
    return planar_truth.least_distance(a.outline, b.outline, move)[1]


@pytest.mark.parametrize("gap", [0.3, 1e-3, 1e-7, 1e-10])
def test_distances_of_simple_shapes(disc, block, gap):
    assert abs(least(disc, disc, 0.6 * (1.0 + gap), 0.8 * (1.0 + gap)) - gap) < 1e-15
    assert abs(least(block, disc, 1.0 + gap, 0.2137) - gap) < 1e-15
    corner = 0.5 + (0.5 + gap) / np.sqrt(2.0)
    assert abs(least(block, disc, corner, corner) - gap) < 3e-16


@pytest.mark.parametrize("deep", [1e-2, 1e-4, 1e-6, 1e-8])
def test_boundaries_that_cross_in_a_narrow_lens_are_seen_to_meet(disc, block, deep):
    assert least(disc, disc, 1.0 - deep, 0.0, 0.3) < 1e-14
    assert least(block, disc, 1.0 - deep, 0.2137, 0.3) < 1e-14


def test_points_and_sides(disc, block):
    assert (
        abs(planar_truth.to_boundary(disc.outline, 0.11, 0.07) - 0.5 + np.hypot(0.11, 0.07)) < 1e-15
    )
    assert abs(planar_truth.to_boundary(block.outline, 0.8, 0.9) - 0.5) < 1e-15
    for outline in (disc.outline, block.outline):
        assert planar_truth.holds(outline, 0.1, -0.3)
        assert not planar_truth.holds(outline, 0.1, -0.6)
        assert planar_truth.roughly_holds(outline, 0.1, -0.3)


def test_sides_are_told_nearer_to_a_curve_than_its_samples_are(disc):
    angles = np.linspace(0.01, 6.27, 50)
    off = {-1e-9: [], 1e-9: []}
    for beyond, coarse in off.items():
        for x, y in (0.5 + beyond) * np.column_stack([np.cos(angles), np.sin(angles)]):
            assert planar_truth.holds_finely(disc.outline, x, y) == (beyond < 0.0)
            coarse.append(planar_truth.holds(disc.outline, x, y))
    assert not all(off[-1e-9])


def test_a_ball_inside_both_proves_an_overlap_wherever_the_descents_end(disc):
    poses = planar_pose(0.0, 0.0, 0.0), planar_pose(1.0 - 1e-6, 0.0, 0.3)
    told = distance(disc.solid, disc.solid, *poses)
    true = planar_judge.truth_of(disc, disc, *poses)._replace(least=1e-7)
    assert told.status is so.Status.OVERLAPPING
    assert planar_judge.faults_of(disc, disc, *poses, told, true) == []
    off = told.overlap.common_point + np.array([0.0, 1e-2, 0.0])
    told = replace(told, overlap=told.overlap._replace(common_point=off))
    kinds = [name for name, _ in planar_judge.faults_of(disc, disc, *poses, told, true)]
    assert kinds == ["status", "ball", "ball"]


def test_rows_are_the_curves_of_the_library(rng):
    """All four kinds, by both formulas, at the ends and between."""
    seen = set()
    for _ in range(40):
        p, q = rng.normal(size=(2, 2))
        curve, rows = planar_drawn.drawn_curve(rng, p, q)
        seen.add(type(curve).__name__)
        share = np.linspace(0.0, 1.0, 9)
        for k, row in enumerate(rows):
            part = (k + share) / len(rows)
            t = curve.first + part * (curve.last - curve.first)
            there = np.array([curve.point(float(each))[:2] for each in t])
            at = planar_truth.points_of(row[None], np.column_stack([0.0 * share, share]))
            assert np.abs(at - there).max() < 1e-12 * (1.0 + np.abs(there).max())
    assert len(seen) == 4


@pytest.fixture(scope="module")
def queries():
    """Pairs at poses with their answers and truths."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(planar_drawn, "CURVES", FEW)
        pool, rng = planar_solids.pool_of(SEED, 0, SOLIDS), np.random.default_rng(SEED)
    found = []
    for _ in range(5):
        a, b = (pool[k] for k in rng.integers(SOLIDS, size=2))
        for poses in planar_drawn.drawn_poses(a, b, rng):
            told = distance(a.solid, b.solid, *poses)
            found.append((a, b, *poses, told, planar_judge.truth_of(a, b, *poses)))
    return found


def test_the_library_s_answers_are_sound(queries):
    for query in queries:
        assert planar_judge.faults_of(*query) == []
    names = {told.status.name for *_, told, _ in queries}
    assert {"CONVERGED", "OVERLAPPING"} <= names


def raised(told):
    more = told.distance + 1e-7
    return replace(told, distance=more, lower_bound=more, upper_bound=more)


def larger(told):
    ball = told.overlap._replace(radius=1.001 * told.overlap.radius + 1e-8)
    return replace(told, overlap=ball)


BREAKS = (
    ("bound", so.Status.CONVERGED, raised),
    ("distance", so.Status.CONVERGED, raised),
    ("witness", so.Status.CONVERGED, lambda told: replace(told, point_a=told.point_a + 1e-8)),
    ("width", so.Status.CONVERGED, lambda told: replace(told, lower_bound=told.distance - 1e-8)),
    ("inside", so.Status.CONVERGED, lambda told: replace(told, inside="A")),
    ("status", so.Status.CONVERGED, lambda told: replace(told, status=so.Status.TOUCHING)),
    ("width", so.Status.OVERLAPPING, lambda told: replace(told, status=so.Status.CONTAINED)),
    ("ball", so.Status.OVERLAPPING, larger),
)


@pytest.mark.parametrize(("kind", "status", "broken"), BREAKS)
def test_a_mistake_is_found(queries, kind, status, broken):
    kinds = set()
    for *query, told, true in queries:
        if told.status is status:
            kinds |= {name for name, _ in planar_judge.faults_of(*query, broken(told), true)}
    assert kind in kinds


def test_a_pool_is_the_same_whatever_was_before(monkeypatch, capsys):
    monkeypatch.setattr(planar_drawn, "CURVES", FEW)
    monkeypatch.setattr(planar_solids, "SOLIDS", 2)
    monkeypatch.setattr(planar_solids, "QUERIES", 8)
    monkeypatch.setattr(blocks, "TELL", -1.0)
    texts = []
    for first, count in ((0, 16), (1, 8)):
        given = ["", "--queries", str(count), "--first", str(first), "--seed", "5"]
        monkeypatch.setattr("sys.argv", given)
        assert planar_solids.main() == 0
        texts.append(capsys.readouterr().out)
    assert "16 queries; 0 wrong" in texts[0]
    assert "8 queries; 0 wrong" in texts[1]


def test_a_wrong_answer_ends_with_3(monkeypatch):
    monkeypatch.setattr(planar_drawn, "CURVES", FEW)
    verdict, lines = planar_solids.judge_pool(
        0, 5, 8, ask=lambda *given: raised(distance(*given)), solids=2
    )
    assert verdict.wrong > 0
    assert verdict.silent > 0
    assert "seed 5, pool 0, query" in lines[0]
    monkeypatch.setattr(blocks, "run", lambda *_: verdict)
    monkeypatch.setattr("sys.argv", [""])
    assert planar_solids.main() == 3


def test_planar_pose():
    move = planar_drawn.move_of(planar_pose(1.0, 2.0, 0.4), planar_pose(1.5, 2.0, 0.7))
    want = np.cos(0.3), np.sin(0.3), 0.5 * np.cos(0.4), -0.5 * np.sin(0.4)
    assert move == pytest.approx(want)
