"""Boxes of configurations: proven free, a configuration that is not, or what stayed open."""

from __future__ import annotations

import numpy as np
import pytest

import standoff as so
from robots.arms import arm
from robots.path_oracle import Judged, drawn_judged, least_distances
from robots.trees import robot_of
from shares import only
from standoff.robots.proof import BoxProof, Verdict

ORACLE = 1e-11
"""Accuracy of the oracle's distances [length]."""


def judge(judged: Judged, proof: BoxProof, rng: np.random.Generator, samples: int = 3_000) -> None:
    q = rng.uniform(proof.lower, proof.upper, (samples, len(proof.lower)))
    least = least_distances(judged, q).min(axis=1)
    assert least.min() >= proof.proven - ORACLE
    assert proof.free + proof.violated + proof.open == pytest.approx(1.0, abs=1e-12)
    if proof.verdict is Verdict.PROVEN:
        assert least.min() >= proof.clearance - ORACLE
        assert (proof.free, proof.witness) == (1.0, None)
    kinds = (proof.free_boxes, proof.violated_boxes, proof.open_boxes)
    inside = [count_in(boxes, q) for boxes in kinds]
    assert (sum(inside) >= 1).all()  # every sample is in one of them
    assert (least[inside[0] > 0] >= proof.clearance - ORACLE).all()
    assert (least[inside[1] > 0] < proof.clearance + ORACLE).all()
    if proof.verdict is Verdict.VIOLATED:
        there = least_distances(judged, proof.witness.q[None])[0]
        assert there.min() < proof.clearance
        assert proof.witness.upper_bound < proof.clearance


def count_in(boxes: object, q: np.ndarray) -> np.ndarray:
    found = np.zeros(len(q), dtype=int)
    for low, high in zip(boxes.lower, boxes.upper, strict=True):
        found += ((q >= low) & (q <= high)).all(axis=1)
    return found


@pytest.mark.parametrize("joints", only([2, 3, 7], range(2, 8)))
def test_boxes_of_two_to_seven_joints(joints: int) -> None:
    rng = np.random.default_rng(joints)
    verdicts = set()
    for width in (0.05, 0.2, 0.6):
        for _ in range(3):
            judged = drawn_judged(rng, joints)
            q = rng.uniform(-1.0, 1.0, joints)
            proof = judged.robot.certify_box(q - width, q + width, 1e-3, max_boxes=400, whole=True)
            judge(judged, proof, rng)
            verdicts.add(proof.verdict)
    assert Verdict.VIOLATED in verdicts


def test_a_free_box_is_proven_and_a_bad_one_has_a_configuration() -> None:
    robot = arm(np.random.default_rng(1), joints=3, obstacles=6)
    q = np.array([0.3, 0.4, -0.2])
    free = robot.certify_box(q - 0.02, q + 0.02, 1e-3)
    assert free.verdict is Verdict.PROVEN
    assert free
    assert free.counts.boxes >= 1
    bad = robot.certify_box(np.full(3, -2.9), np.full(3, 2.9), 1e-3)
    assert bad.verdict is Verdict.VIOLATED
    assert robot.world.distances(robot.kinematics.poses(bad.witness.q)).clearance < 1e-3
    assert str(bad).startswith("VIOLATED: ")


def test_the_share_that_is_known_grows_with_the_budget() -> None:
    robot = arm(np.random.default_rng(2), joints=2, obstacles=8)
    open_ = []
    for most in (1, 10, 100, 1000):
        proof = robot.certify_box([-2.9, -2.9], [2.9, 2.9], 1e-3, max_boxes=most, whole=True)
        open_.append(proof.open)
        assert proof.counts.boxes <= most
    assert open_[0] == 1.0
    assert open_ == sorted(open_, reverse=True)
    assert open_[-1] < 0.1


def test_a_box_is_cut_across_the_joint_that_moves_the_pair() -> None:
    """The second joint moves nothing near the post: only the first is halved."""
    ball = so.shapes.sphere(0.1)
    places = [np.eye(4), np.eye(4)]
    places[1][0, 3] = 5.0
    at = np.eye(4)
    at[0, 3] = 1.0
    post = np.eye(4)
    post[1, 3] = 1.0
    robot = robot_of(
        [1, 1],
        [-1, -1],
        places,
        [[0, 0, 1.0]] * 2,
        [(0, ball, at), (1, ball, np.eye(4))],
        fixed={"post": (ball, post)},
    )
    proof = robot.certify_box([-1.36, -1.0], [1.36, 1.0], 1e-3)
    assert proof
    sides = proof.free_boxes.upper - proof.free_boxes.lower
    assert (sides[:, 1] == 2.0).all()
    assert proof.free_boxes.size > 1


def test_half_open_touching() -> None:
    """Exactly at the clearance nothing is decided, and the rest is."""
    ball = so.shapes.sphere(0.1)
    post = np.eye(4)
    post[0, 3] = 1.2 + 1e-3
    robot = robot_of(
        [2], [-1], [np.eye(4)], [[1.0, 0, 0]], [(0, ball, np.eye(4))], fixed={"post": (ball, post)}
    )
    proof = robot.certify_box([0.0], [1.0], 1e-3, max_boxes=200)
    assert proof.verdict is Verdict.UNDECIDED
    assert proof.free > 0.999
    assert 0.0 < proof.open < 1e-3
    assert proof.open_boxes.upper.max() == 1.0
    assert proof.witness.names == ("g0", "post")


def test_a_half_space_is_endless() -> None:
    """Seen from the arm, the floor's point below the axis moves little; that under the hand does
    not."""
    hand, floor = np.eye(4), so.shapes.halfspace([0.0, 0.0, 1.0], -1.0)
    hand[0, 3] = 10.0
    ball = so.shapes.sphere(0.1)
    for moving in (True, False):
        geoms = [(0, floor, np.eye(4))] if moving else [(0, ball, hand)]
        still = {"f": (ball, hand)} if moving else {"f": (floor, np.eye(4))}
        robot = robot_of([1], [-1], [np.eye(4)], [[0, 1.0, 0]], geoms, fixed=still)
        assert robot.certify_box([-0.2], [0.2], 1e-3).verdict is Verdict.VIOLATED
        assert robot.certify_box([-0.05], [0.05], 1e-3).verdict is Verdict.PROVEN
        assert robot.certify([[-0.2], [0.2]], 1e-3).verdict is Verdict.VIOLATED
        assert robot.certify([[-0.05], [0.0], [0.05]], 1e-3).verdict is Verdict.PROVEN
