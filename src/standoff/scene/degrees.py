"""Angles in degrees: the key that says so, in place of the one in radians."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from standoff.scene.reader import SceneTable

ENDING = "_degrees"


def with_degrees(keys: Iterable[str]) -> list[str]:
    """Return keys of angles in radians, each followed by its key in degrees."""
    return [name for key in keys for name in (key, key + ENDING)]


def in_radians(
    table: SceneTable, numbers: Iterable[str] = (), vectors: Iterable[str] = ()
) -> SceneTable:
    """Return the table with what it says in degrees also under the keys in radians.

    Raises SceneError: at an angle that is given both ways, or that is not a finite number.

    Parameters
    ----------
    table : SceneTable
    numbers, vectors : iterable of str
        Keys in radians, or radians per second, of one number and of three.
    """
    found: dict[str, object] = {}
    for key in numbers:
        if _given(table, key):
            found[key] = float(np.radians(table.number(key + ENDING)))
    for key in vectors:
        if _given(table, key):
            found[key] = np.radians(table.vector(key + ENDING, 3)).tolist()
    return table.replaced(found) if found else table


def _given(table: SceneTable, key: str) -> bool:
    """Is an angle given in degrees?"""
    if key + ENDING in table:
        table.only_one((key, key + ENDING))
    return key + ENDING in table
