"""Poses and twists in any form reach the kernels as arrays of one type: no compile in mid-run."""

import numpy as np

import standoff as so
from standoff.kernels.entries import tracker as kernels

TWIST = so.Twist([1.0, 0.0, 0.0], [0.0, 0.0, 0.1])


def test_missing_and_mixed_twists_need_no_other_kernel():
    tracker = so.Tracker(so.shapes.box(1, 1, 1), so.shapes.sphere(0.5), dt=1e-3)
    home, there = so.Pose.identity(), so.Pose(np.eye(3), [2.0, 0.1, 0.0])
    state = tracker.start(home, there, TWIST, TWIST)
    state, _ = tracker.step(state, home, there, TWIST, TWIST)
    compiled = len(kernels.start.signatures), len(kernels.value.signatures)
    frozen = np.eye(4)
    frozen.flags.writeable = False
    for pose in (home, np.eye(4), frozen, (np.eye(3), np.zeros(3))):
        for twist in (None, TWIST, (np.zeros(3), np.zeros(3)), ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0])):
            state = tracker.start(pose, there, None, twist)
            state, _ = tracker.step(state, pose, there, twist, None)
    assert (len(kernels.start.signatures), len(kernels.value.signatures)) == compiled
