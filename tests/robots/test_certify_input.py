"""What is refused of paths and boxes: named, with what to do."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import standoff as so
from robots.arms import arm
from robots.trees import drawn_robot, neutral
from standoff.robots.paths import FunctionPath

ARM = arm(np.random.default_rng(0), joints=2, obstacles=2)
HOME = np.zeros((2, 2))
AWAY = np.array([[0.0, 0.0], [0.1, 0.1]])


def refused(*given: Any, match: str, of: Any = ARM, **options: Any) -> None:
    with pytest.raises(so.errors.StandoffError, match=match):
        of.certify(*given, **options)


def test_paths() -> None:
    refused([[0.0, 0.0]], match="1 waypoint: give two or more")
    refused([0.0, 0.0], match=r"shape \(2,\): give waypoints \(n, 2\)")
    refused([[0.0], [1.0]], match=r"shape \(2, 1\)")
    refused(np.zeros((0, 2)), match="0 waypoint")
    refused([[0.0, 0.0], [math.nan, 0.0]], match="Waypoint 1: .*NaN")
    refused([[0.0, 0.0], [0.0, 3.0]], match=r"joint 'j1' \(q\[1\]\) is 3.0 at 1.0 s, outside .*2.9")
    refused("up", match="not numeric")
    refused(AWAY, -1e-3, match="clearance")
    refused(AWAY, math.nan, match="clearance")
    refused(AWAY, times=[0.0, 0.0], match="increasing")
    refused(AWAY, times=[0.0], match="times are 1: give one of each of 2")
    refused(AWAY, times=[0.0, math.inf], match="infinite")
    refused(AWAY, times=[0.0, 5e-324], match="too near")
    refused(AWAY, max_steps=0, match="max_steps")
    refused(AWAY, workers=0, match="workers")
    refused(lambda t: HOME[0], match="greatest speeds must be known; give so.robots.FunctionPath")


def test_splines() -> None:
    spline = CubicSpline([0.0, 1.0, 2.0], [[0.0], [1.0], [0.0]])
    refused(spline, match=r"\(1,\): give one of \(2,\)")
    over = CubicSpline([0.0, 1.0, 2.0, 3.0], np.array([[0, 0], [2.8, 0], [2.8, 0], [0, 0]]))
    refused(over, match=r"joint 'j0' \(q\[0\]\) is .* outside its limits")
    good = CubicSpline([0.0, 1.0, 2.0], np.zeros((3, 2)))
    refused(good, times=[0.0, 1.0], match="a spline has its own")
    jump = CubicSpline([0.0, 1.0, 2.0], np.zeros((3, 2)))
    jump.c[-1, 1, 0] = 0.5
    refused(jump, match="jumps by 0.5 at 1.0 s")
    ball = drawn_robot(np.random.default_rng(0), 1, (3,))
    refused(good, of=ball, match="unit quaternions")


def test_functions() -> None:
    def at(t: float) -> np.ndarray:
        return np.array([math.sin(t), 0.0])

    refused(FunctionPath(at, 1.0, 0.5), match="velocity 0 is .*greatest speed is given as 0.5")
    refused(FunctionPath(at, 0.0, 1.0), match="duration")
    refused(FunctionPath(at, -1.0, 1.0), match="duration")
    refused(FunctionPath(at, 1.0, [1.0, 1.0, 1.0]), match="speed has shape")
    refused(FunctionPath(at, 1.0, -1.0), match="speed")
    refused(FunctionPath(at, 1.0, math.nan), match="speed")
    refused(FunctionPath(at, 1.0, 1.0, acceleration=-1.0), match="acceleration")
    refused(FunctionPath(lambda t: [t], 1.0, 1.0), match="give 2 numbers")


def boxed(lower: Any, upper: Any, match: str, of: Any = ARM, **options: Any) -> None:
    with pytest.raises(so.errors.StandoffError, match=match):
        of.certify_box(lower, upper, **options)


def test_boxes() -> None:
    boxed([0.0], [1.0, 1.0], "lower has shape")
    boxed([0.0, 0.0], [1.0, math.nan], "upper has a NaN")
    boxed([0.0, -math.inf], [1.0, 1.0], r"joint 'j1' \(q\[1\]\) is -inf: it has no limit; give a")
    boxed([0.0, 1.0], [1.0, 0.0], r"joint 'j1' \(q\[1\]\) goes from 1.0 down to 0.0: swap")
    boxed([0.0, 0.0], [1.0, 3.0], r"joint 'j1' \(q\[1\]\) is 3.0, outside its limits")
    boxed([0.0, 0.0], [1.0, 1.0], "clearance", clearance=-1.0)
    boxed([0.0, 0.0], [1.0, 1.0], "max_boxes", max_boxes=0)
    boxed([0.0, 0.0], [1.0, 1.0], "whole", whole=1)


@pytest.mark.parametrize(
    ("kind", "said"), [(3, "a ball joint"), (4, "a floating base"), (5, "an endless hinge")]
)
def test_joints_without_a_range_are_refused_in_boxes_but_may_be_held(kind: int, said: str) -> None:
    robot = drawn_robot(np.random.default_rng(1), 1, (kind,))
    q = neutral(robot)
    boxed(q - 0.1, q + 0.1, f"Joint 'j0' is {said}.*no box", of=robot)
    assert robot.certify_box(q, q, 0.0).counts.boxes == 1


def test_joints_that_were_read_wrongly_are_found_before_anything_is_proven() -> None:
    robot = arm(np.random.default_rng(0), joints=2, obstacles=0)
    axes = np.array(robot.joints.axes)
    axes[1] = 1.0, 0.0, 0.0
    wrong = dataclasses.replace(robot, joints=robot.joints._replace(axes=axes))
    refused(AWAY, of=wrong, match="not where the joints as read place it")
    boxed([0.0, 0.0], [0.1, 0.1], "not where the joints as read place it", of=wrong)
