"""Numbers in kinds that are no real numbers, though NumPy would make float64 of them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

import standoff as so
from families.masked import numeric
from standoff.checks.real_numbers import shape_of


def unreal_versions(value: Any) -> Iterator[tuple[str, Any]]:
    """The same numbers as complex ones without an imaginary part, as text and as truth values.

    Of arrays and lists of numbers, of poses and of twists, and of those in lists; single numbers
    are left out.
    """
    if isinstance(value, so.Pose):
        yield from unreal_versions(value.matrix)
        for how, part in unreal_versions(value.translation):
            yield f"pair: {how}", (value.rotation, part)
    elif isinstance(value, so.Twist):
        yield from unreal_versions(np.concatenate([value.v, value.omega]))
    elif numeric(value) and shape_of(value):
        yield from _of_numbers(np.array(value, dtype=np.float64))
    elif isinstance(value, list | tuple):
        for k, item in enumerate(value):
            for how, part in unreal_versions(item):
                yield f"[{k}] {how}", type(value)([*value[:k], part, *value[k + 1 :]])


def _of_numbers(array: Any) -> Iterator[tuple[str, Any]]:
    unreal = {
        "complex": array.astype(complex),
        "text": array.astype(str),
        "truth values": array != 0.0,
        "durations": array.astype("timedelta64[s]"),
    }
    for how, given in unreal.items():
        yield how, given
        yield f"list of {how}", given.tolist() if how != "durations" else list(given)
        yield f"objects, one of them {how}", _mixed(array, given)
        yield f"list, one of them {how}", _mixed(array, given).tolist()


def _mixed(array: Any, unreal: Any) -> Any:
    mixed = array.astype(object)
    mixed.flat[-1] = unreal.ravel()[-1]
    return mixed
