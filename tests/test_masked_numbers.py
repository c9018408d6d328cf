"""Masked numbers have no value: no public call may take what lies beneath the mask for data."""

from __future__ import annotations

import numpy as np
import pytest

import standoff as so
from families.masked import masked_versions
from public_calls import Call, calls, pair_calls
from public_methods import method_calls, refusal

ALL = [*calls(), *pair_calls(), *method_calls()]


@pytest.mark.filterwarnings("ignore::UserWarning:numpy")
@pytest.mark.parametrize("call", ALL, ids=lambda call: call.name)
def test_masked_numbers_are_refused(call: Call) -> None:
    for key, value in call.arguments.items():
        for how, masked in masked_versions(value):
            said = refusal(call, {**call.arguments, key: masked})
            assert "mask" in said, f"{key} as {how}: {said or 'taken'}"
            assert len(said) < 2000, f"{key} as {how}"


@pytest.mark.parametrize("call", ALL, ids=lambda call: call.name)
def test_masked_arrays_without_a_masked_number_are_arrays(call: Call) -> None:
    for key, value in call.arguments.items():
        if isinstance(value, np.ndarray):
            assert refusal(call, {**call.arguments, key: np.ma.array(value)}) == "", key


def test_the_message_says_what_to_do() -> None:
    rows = [[0.0, 0.0, 0.0], np.ma.array([1.0, 0.0, 0.0], mask=[False, True, False])]
    for refused in (
        lambda: so.shapes.polytope(rows),
        lambda: so.Pose(np.eye(3), rows[1]),
        lambda: so.Pose.of(np.ma.masked_equal(np.eye(4), 1.0)),
        lambda: so.feedback.GainMatrix(np.ma.masked_equal(np.eye(4), 0.0)),
    ):
        with pytest.raises(ValueError, match="has masked numbers; fill them, or leave them out"):
            refused()
