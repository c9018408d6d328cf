"""Arguments of the wrong kind, one at a time, in every constructor: used, or refused on purpose."""

from __future__ import annotations

from datetime import timedelta
from decimal import Decimal
from typing import Any

import numpy as np
import pytest

from fuzz.laws import refusals, watchdog
from public_calls import Call, calls, pair_calls


def _deep() -> Any:
    value: Any = 1.0
    for _ in range(2000):
        value = [value]
    return value


HOSTILE: dict[str, Any] = {
    "nan": np.nan,
    "infinite": np.inf,
    "zero": 0,
    "negative": -1.0,
    "huge": 10**400,
    "longer than Python writes": 10**5000,
    "decimal": Decimal("1"),
    "complex": 1j,
    "true": True,
    "none": None,
    "text": "1",
    "long text": "x" * 5000,
    "bytes": b"1",
    "object": object(),
    "type": float,
    "duration": np.timedelta64(1, "s"),
    "standard duration": timedelta(seconds=1),
    "date": np.datetime64("2020-01-01"),
    "masked": np.ma.masked,
    "masked array": np.ma.array([1.0, 2.0, 3.0], mask=[False, True, False]),
    "array of no dimension": np.array(1.0),
    "array of two": np.array([1.0, 2.0]),
    "array of texts": np.array(["a", "b", "c"]),
    "array of objects": np.array([1.0, None, "a"], dtype=object),
    "empty": [],
    "empty pairs": np.empty((0, 2)),
    "empty points": np.empty((0, 3)),
    "empty rows": [[]],
    "ragged": [[1.0], [1.0, 2.0]],
    "deep": _deep(),
    "dictionary": {"a": 1.0},
    "set": {1.0, 2.0},
    "structured": np.zeros(3, dtype=[("a", float)]),
}


FEW = ("nan", "negative", "none", "text", "long text", "object", "array of two", "masked", "deep")
"""Of them, those tried where a call takes a whole query or run."""


@pytest.mark.filterwarnings("ignore::DeprecationWarning:numpy")
@pytest.mark.parametrize("call", calls(), ids=lambda call: call.name)
def test_an_argument_of_the_wrong_kind(call: Call) -> None:
    for key in call.arguments:
        for kind, value in HOSTILE.items():
            with watchdog(), refusals((ValueError, TypeError, OSError)) as said:
                call.public(**{**call.arguments, key: value})
            assert not said or len(said[0]) < 2000, f"{key} = {kind}"


@pytest.mark.parametrize("call", pair_calls(), ids=lambda call: call.name)
def test_an_argument_of_the_wrong_kind_in_a_query(call: Call) -> None:
    for key in call.arguments:
        for kind in FEW:
            with watchdog(), refusals((ValueError, TypeError, OSError)) as said:
                call.public(**{**call.arguments, key: HOSTILE[kind]})
            assert not said or 0 < len(said[0]) < 2000, f"{key} = {kind}"


@pytest.mark.parametrize("call", [*calls(), *pair_calls()], ids=lambda call: call.name)
def test_the_calls_work(call: Call) -> None:
    if call.name not in ("motion.read_pose_samples", "standoff.open_recording"):
        assert call.public(**call.arguments) is not None
