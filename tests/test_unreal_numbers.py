"""Complex numbers, text and truth values are no real numbers: no public call may take them."""

from __future__ import annotations

import numpy as np
import pytest

import standoff as so
from families.unreal import unreal_versions
from public_calls import Call, calls, pair_calls
from public_methods import BOX, SPHERE, method_calls, refusal

ALL = [*calls(), *pair_calls(), *method_calls()]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("call", ALL, ids=lambda call: call.name)
def test_arrays_of_other_kinds_are_refused(call: Call) -> None:
    for key, value in call.arguments.items():
        for how, given in unreal_versions(value):
            said = refusal(call, {**call.arguments, key: given})
            assert said, f"{key} as {how} is taken"
            assert len(said) < 2000, f"{key} as {how}"


@pytest.mark.parametrize("kind", [complex, str, bool])
def test_many_frames_say_what_a_step_says(kind: type) -> None:
    tracker = so.Tracker(SPHERE, BOX)
    state = tracker.start(np.eye(4), so.Pose(np.eye(3), [3.0, 0.0, 0.0]))
    given = np.tile(np.eye(4), (2, 1, 1)).astype(kind)
    words = "is not numeric: (.|\n)*numbers, all of them real|all of them real numbers"
    for refused in (
        lambda: tracker.step(state, given[0], np.eye(4)),
        lambda: tracker.run(state, given, np.eye(4)),
        lambda: so.distances(SPHERE, BOX, given, np.eye(4)),
    ):
        with pytest.raises(ValueError, match=words):
            refused()


def test_numbers_as_objects_are_numbers() -> None:
    poses = np.tile(np.eye(4), (2, 1, 1))
    poses[:, 0, 3] = 3.0
    plain = so.distances(SPHERE, BOX, np.eye(4), poses)
    objects = so.distances(SPHERE, BOX, np.eye(4), poses.astype(object))
    np.testing.assert_array_equal(plain.distance, objects.distance)
