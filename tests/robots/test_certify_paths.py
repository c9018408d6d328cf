"""Proofs along joint paths, judged by many samples of an oracle with other kinematics."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline, PchipInterpolator, make_interp_spline

from robots.path_oracle import Judged, drawn_judged, least_distances
from robots.trees import drawn_q, drawn_robot, neutral
from standoff.robots.paths import FunctionPath
from standoff.robots.proof import PathProof, Verdict

SAMPLES = 2_000
"""Of a path here; benchmarks.certify takes 10^5."""

ORACLE = 1e-11
"""Accuracy of the oracle's distances [length]."""


def judge(judged: Judged, proof: PathProof, at: object, samples: int = SAMPLES) -> None:
    """Hold a proof against an oracle; `at` is the path as a function of times."""
    times = np.linspace(proof.start, proof.end, samples)
    q = np.array(at(times))
    distances = least_distances(judged, q)
    least = distances.min(axis=1)
    if proof.verdict is Verdict.PROVEN:
        assert least.min() >= proof.clearance - ORACLE
        assert least.min() >= proof.proven - ORACLE
        known = proof.steps.clearance(times)
        assert not np.isnan(known).any()
        assert (known <= least + ORACLE).all()
        return
    before = least[times < proof.time]
    assert before.min(initial=np.inf) >= proof.clearance - ORACLE
    if proof.verdict is Verdict.VIOLATED:
        assert proof.time <= proof.latest <= proof.end
        there = least_distances(judged, np.array(at(np.array([proof.latest]))))[0]
        assert there.min() < proof.clearance
        names = list(judged.robot.world.pairs())
        assert there[names.index(proof.witness.names)] == pytest.approx(
            proof.witness.distance, abs=1e-8
        )


def straight(points: np.ndarray, times: np.ndarray) -> object:
    return lambda t: np.stack(
        [np.interp(t, times, points[:, k]) for k in range(points.shape[1])], 1
    )


def test_random_paths() -> None:
    rng = np.random.default_rng(28)
    verdicts = []
    for _ in range(60):
        judged = drawn_judged(rng, int(rng.integers(1, 8)))
        n = int(rng.integers(2, 6))
        points = rng.uniform(-1.0, 1.0, judged.robot.nq) + rng.uniform(
            -0.6, 0.6, (n, judged.robot.nq)
        )
        times = np.cumsum(rng.uniform(0.1, 2.0, n)) - 1.0
        # what they keep is asked for, more or less, so that both verdicts come about
        own = least_distances(
            judged, straight(points, times)(np.linspace(times[0], times[-1], 200))
        )
        clearance = max(0.0, own.min() + rng.choice([-0.02, -1e-3, 1e-3]))
        if own[0].min() <= 0.0:
            continue
        proof = judged.robot.certify(points, clearance, times=times)
        judge(judged, proof, straight(points, times))
        verdicts.append(proof.verdict)
    assert verdicts.count(Verdict.PROVEN) > 10
    assert verdicts.count(Verdict.VIOLATED) > 10
    assert verdicts.count(Verdict.UNDECIDED) == 0


@pytest.mark.parametrize("made", [CubicSpline, PchipInterpolator, make_interp_spline])
def test_splines(made: object) -> None:
    rng = np.random.default_rng(3)
    proven = 0
    for _ in range(12):
        judged = drawn_judged(rng, 4)
        times = np.array([0.0, 0.7, 1.5, 2.0, 3.1])
        points = rng.uniform(-1.0, 1.0, judged.robot.nq) + rng.uniform(
            -0.5, 0.5, (5, judged.robot.nq)
        )
        spline = made(times, points)
        own = least_distances(judged, spline(np.linspace(0.0, 3.1, 300))).min()
        if own <= 0.01:
            continue
        for clearance in (own - 1e-3, own + 1e-3):
            proof = judged.robot.certify(spline, clearance)
            judge(judged, proof, spline)
            assert proof.verdict is (Verdict.PROVEN if clearance < own else Verdict.VIOLATED)
            proven += bool(proof)
    assert proven > 3


@pytest.mark.parametrize("bounded", [True, False])
def test_functions(bounded: bool) -> None:
    rng = np.random.default_rng(4)
    proven = 0
    for _ in range(12):
        judged = drawn_judged(rng, 3)
        nq = judged.robot.nq
        middle, wide = rng.uniform(-1, 1, nq), rng.uniform(0.1, 0.4, nq)

        def at(t: object, middle: np.ndarray = middle, wide: np.ndarray = wide) -> np.ndarray:
            return middle + wide * np.sin(2.0 * np.asarray(t))[..., None]

        own = least_distances(judged, at(np.linspace(0.0, 3.0, 300))).min()
        if own <= 0.01:
            continue
        path = FunctionPath(at, 3.0, 2.0 * wide, 4.0 * wide if bounded else None)
        for clearance in (own - 1e-3, own + 1e-3):
            proof = judged.robot.certify(path, clearance)
            judge(judged, proof, at)
            assert proof.verdict is (Verdict.PROVEN if clearance < own else Verdict.VIOLATED)
            proven += bool(proof)
    assert proven > 3


def test_ball_and_free_joints_move_by_the_packages_own_integration() -> None:
    rng = np.random.default_rng(11)
    proven = 0
    for _ in range(12):
        robot = drawn_robot(rng, 3, (3, 4, 5, 1), fixed=1)
        q = drawn_q(rng, robot, 1.0)
        points = [q, robot.kinematics.integrate(q, rng.uniform(-0.7, 0.7, robot.nv))]
        way = robot.kinematics.difference(*points)
        times = np.linspace(0.0, 1.0, 60)
        answers = [
            robot.world.distances(
                robot.kinematics.poses(robot.kinematics.integrate(points[0], t * way))
            )
            for t in times
        ]
        least = min(float(each.pairs.distance.min()) for each in answers)
        if least < 0.01:
            continue
        assert robot.certify(points, least + 1e-4).verdict is Verdict.VIOLATED
        proof = robot.certify(points, least - 5e-3)
        assert proof.verdict is Verdict.PROVEN
        assert proof.proven <= least + 1e-12
        proven += 1
    assert proven > 3
    assert neutral(robot).shape == (robot.nq,)
