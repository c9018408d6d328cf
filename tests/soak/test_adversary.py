"""The adversary: its truths, that it notices what it plants, and what the certificate stands."""

import json
from fractions import Fraction
from itertools import product

import numpy as np
import pytest

from draws import draws
from standoff.cli import main
from standoff_studies.soak import adversary, any_places, certificate_checks, wild_runs
from standoff_studies.soak.adversary import run_round
from standoff_studies.soak.failures import breach_facts
from standoff_studies.soak.known_gaps import draw_scene, draw_walk
from standoff_studies.soak.lattice import signed_distance, whole
from standoff_studies.soak.placing import heights

SEED = 11
CUBE = np.array(list(product((-1.0, 1.0), repeat=3)))


def moved(points, *way):
    return points + np.array(way)


def between(a, b, planar=False):
    return signed_distance(whole(a), whole(b), planar)


@pytest.mark.parametrize(
    ("a", "b", "distance"),
    [
        (CUBE, moved(CUBE, 5.0, 6.0, 0.5), 5.0),
        (CUBE, moved(CUBE, 2.0, 0.25, 0.0), 0.0),
        (CUBE, moved(CUBE, 1.75, 0.25, 0.0), -0.25),
        (CUBE, 0.25 * CUBE, -1.25),
        (CUBE, [[0.0, 0.0, 0.5]], -0.5),
        (CUBE, [[0.0, 0.0, -3.0], [0.0, 0.0, 3.0]], -1.0),
        ([[0.0, 0.0, 0.0]], [[3.0, 4.0, 0.0]], 5.0),
        ([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]], [[0.0, -1.0, 2.0], [0.0, 1.0, 2.0]], 2.0),
        ([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]], [[0.0, -1.0, 0.0], [0.0, 1.0, 0.0]], 0.0),
        ([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]], [[3.0, 0.0, 0.0], [4.0, 0.0, 0.0]], 2.0),
    ],
)
def test_distances_on_the_lattice(a, b, distance):
    assert between(a, b) == distance
    assert between(b, a) == distance


def test_planar_bodies_are_pushed_apart_in_their_plane():
    square = np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]])
    assert between(square, moved(square, 1.5, 0.0, 0.0), planar=True) == -0.5
    assert between(square, moved(square, 1.5, 0.0, 0.0)) == 0.0  # in space by a push of nothing


def of_segments(p, q) -> Fraction:
    """The squared distance of two segments by Fractions: the least of a convex quadratic on the
    unit square, at its corners, on its sides, or inside."""
    p, q = ([[Fraction(float(x)) for x in point] for point in ends] for ends in (p, q))

    def sub(x, y):
        return [i - j for i, j in zip(x, y, strict=True)]

    def dot(x, y):
        return sum(i * j for i, j in zip(x, y, strict=True))

    u, v, w = sub(p[1], p[0]), sub(q[1], q[0]), sub(p[0], q[0])

    def at(s, t):
        gap = [w[k] + s * u[k] - t * v[k] for k in range(3)]
        return dot(gap, gap)

    found = [at(s, t) for s in (0, 1) for t in (0, 1)]
    uu, uv, vv, uw, vw = dot(u, u), dot(u, v), dot(v, v), dot(u, w), dot(v, w)
    for s in (0, 1):
        t = (vw + s * uv) / vv
        found += [at(s, t)] if 0 <= t <= 1 else []
    for t in (0, 1):
        s = (t * uv - uw) / uu
        found += [at(s, t)] if 0 <= s <= 1 else []
    below = uu * vv - uv * uv
    if below:
        s, t = (uv * vw - vv * uw) / below, (uu * vw - uv * uw) / below
        found += [at(s, t)] if 0 <= s <= 1 and 0 <= t <= 1 else []
    return min(found)


def test_segments_on_the_lattice_agree_with_fractions(rng):
    for _ in range(draws(300)):
        p, q = rng.integers(-8, 9, (2, 2, 3)) / 4
        if (p[0] == p[1]).all() or (q[0] == q[1]).all():
            continue
        exact = of_segments(p, q)
        assert between(p, q) == pytest.approx(float(exact) ** 0.5, rel=1e-15, abs=0.0)


def test_no_direction_separates_by_more_than_the_distance(rng):
    """Of every scene; one that was built is separated by it along its own normal."""
    for number in range(draws(40)):
        scene = draw_scene(rng, SEED, number // 20)
        if not (scene.a.body.bounded and scene.b.body.bounded):
            continue
        n = rng.normal(size=(300, 3))
        if scene.a.body.dimension == 2:
            n[:, 2] = 0.0
        n[0] = scene.normal
        n /= np.linalg.norm(n, axis=1)[:, None]
        up = heights(scene.a, np.tile(scene.pose_a, (300, 1)), n)[0]
        apart = -(up + heights(scene.b, np.tile(scene.pose_b, (300, 1)), -n)[0])
        row = np.zeros((1, any_places.N_ASKED))
        noise = 1e-13 * certificate_checks.size_of(scene, row)[0]
        # swept cores that overlap, as on the lattice alone, are parted by no less than their depth
        assert apart.max() <= scene.truth + noise
        if scene.where == "built":
            assert apart[0] == pytest.approx(scene.truth, abs=noise)


def test_the_certificate_stands_what_no_search_would_bring():
    """Any places and directions, all kinds; and trackers led astray."""
    for number in range(draws(12)):
        _, breaches = run_round(SEED, number, cases=500)
        assert not breaches, json.dumps(breach_facts(breaches[0]))


def test_wild_runs():
    for number in range(draws(8)):
        rng = np.random.default_rng([SEED, number])
        run = wild_runs.run(rng, draw_walk(rng, SEED, 0, 20))
        assert not list(wild_runs.misses(run)), (number, run.law)


RAISED = {
    "the lower bound is above the distance": any_places.LOWER,
    "points of the bodies nearer than the distance": any_places.D,
}


@pytest.mark.parametrize("what", RAISED)
def test_a_planted_fault_is_found_and_replayed(what, monkeypatch, tmp_path, capsys):
    """Bounds a little too high, or points a little too near."""
    true = certificate_checks.ask_all

    def planted(scene, drawn):
        asked = true(scene, drawn)
        sign = 1.0 if RAISED[what] == any_places.LOWER else -1.0
        asked[:, RAISED[what]] += sign * (1e-8 + 1e-8 * abs(scene.truth))
        return asked

    monkeypatch.setattr(certificate_checks, "ask_all", planted)
    arguments = ["soak", "--certificates", "20000", "--seed", str(SEED), "-o", str(tmp_path)]
    assert main(arguments) == 3
    err = capsys.readouterr().err
    assert what in err
    file = next(f for f in tmp_path.glob("*.json") if json.loads(f.read_text())["what"] == what)
    assert main(["soak", "--replay", str(file)]) == 3
    assert "now the round fails" in capsys.readouterr().out
    monkeypatch.undo()
    assert main(["soak", "--replay", str(file)]) == 0
    assert "no check of the round fails" in capsys.readouterr().out


def test_rounds_depend_on_their_numbers_alone():
    first, _ = run_round(SEED, 0, 100)
    run_round(SEED, 1, 100)
    again, _ = run_round(SEED, 0, 100)
    assert first == again
    assert first.sums["certificates"] == 100
    assert first.sums["wild frames"] == adversary.WILD_FRAMES


@pytest.mark.parametrize(
    ("entry", "value"), [("seed", -1), ("number", "x"), ("cases", 0), ("cases", None)]
)
def test_damaged_files_of_a_round(entry, value, tmp_path, capsys):
    facts = {
        "kind": "standoff soak failure",
        "what": "planted",
        "value": 1.0,
        "allowed": 0.0,
        "asked": 0,
        "round": {"seed": 0, "number": 0, "cases": 1, entry: value},
    }
    file = tmp_path / "breach.json"
    file.write_text(json.dumps(facts))
    assert main(["soak", "--replay", str(file)]) == 2
    assert f"the round's '{entry}'" in capsys.readouterr().err
