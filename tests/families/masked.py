"""Numbers with one of them masked, in every way that NumPy's masked arrays can come in."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

import standoff as so


def numeric(value: Any) -> bool:
    """Is a value a number, or numbers in lists or an array?"""
    if isinstance(value, np.ndarray):
        return value.dtype.kind in "iuf" and value.size > 0
    if isinstance(value, list | tuple):
        return bool(value) and all(map(numeric, value))
    return isinstance(value, int | float) and not isinstance(value, bool)


def masked_versions(value: Any) -> Iterator[tuple[str, Any]]:
    """The same numbers with one masked: as one masked array, in one row of a list, or by itself.

    Where a pose or a twist is meant, or a list of which one may be masked, its parts are.
    """
    if isinstance(value, so.Pose):
        for how, part in masked_versions(value.matrix):
            yield f"pose: {how}", part
        for how, part in masked_versions(value.translation):
            yield f"pair: {how}", (value.rotation, part)
        return
    if isinstance(value, so.Twist):
        for how, part in masked_versions(np.concatenate([value.v, value.omega])):
            yield f"twist: {how}", part
        return
    if numeric(value):
        yield from _of_numbers(value)
    if isinstance(value, list | tuple) and not isinstance(value, str):
        for k, item in enumerate(value):
            for how, part in masked_versions(item):
                yield f"[{k}] {how}", type(value)([*value[:k], part, *value[k + 1 :]])
    elif isinstance(value, dict):
        for key, item in value.items():
            for how, part in masked_versions(item):
                yield f"[{key}] {how}", value | {key: part}


def _of_numbers(value: Any) -> Iterator[tuple[str, Any]]:
    try:
        plain = np.array(value)
    except ValueError:
        return  # rows of different lengths: each comes by itself
    mask = np.zeros(plain.shape, dtype=bool)
    mask.flat[-1] = True
    array = np.ma.array(plain, mask=mask)
    yield "masked array", array
    if plain.ndim > 1:
        yield "list of masked arrays", list(array)
    if plain.ndim == 0:
        yield "masked number", np.ma.masked
