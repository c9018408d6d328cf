"""Strict reading of TOML tables: every value checked, every key accounted for.

A `SceneTable` knows its file and its dotted key path, so that each complaint names the place.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TypeVar

import numpy as np

from standoff.checks import real_numbers
from standoff.checks.names import nearest, one_of
from standoff.errors import StandoffError
from standoff.scene.errors import SceneError
from standoff.typing import Array
from standoff.wording import printable

Value = TypeVar("Value")

SHOWN_CHARACTERS = 60
"""Longest piece of an offending value that a message repeats, in characters: one terminal line."""


def shown(value: object) -> str:
    """Return `value` as a message repeats it: its repr, cut to one line."""
    return real_numbers.shown(value, SHOWN_CHARACTERS)


def unknown_name(name: str, known: Iterable[str], noun: str) -> str:
    """Return the sentence that refuses a name outside `known` and suggests the nearest one."""
    names = sorted(known)
    likely = nearest(name, names)
    if likely is not None:
        return f"unknown {noun} {shown(name)}; did you mean '{printable(likely)}'?"
    return f"unknown {noun} {shown(name)}; known here: {one_of(names)}"


class SceneTable:
    """One table of a scene file, read key by key.

    Parameters
    ----------
    content : mapping
        The table as tomllib returns it.
    file : Path or None
        The scene file, for messages and for file names relative to it.
    path : str
        Dotted key path of this table; empty for the top of the file.
    json : bool
        Whether the file is JSON: its messages then say what to write in JSON.
    """

    def __init__(
        self,
        content: Mapping[str, object],
        *,
        file: Path | None = None,
        path: str = "",
        json: bool = False,
    ) -> None:
        self._content = content
        self._expected: tuple[str, ...] = ()
        self._json = json
        self.file = file
        self.path = path

    def __contains__(self, key: str) -> bool:
        return key in self._content

    def names(self) -> list[str]:
        """Return the keys in file order, for tables whose keys are the user's own names."""
        return list(self._content)

    def only(self, keys: Iterable[str]) -> SceneTable:
        """Return the same table with none but these of its keys."""
        content = {key: self._content[key] for key in keys if key in self._content}
        return SceneTable(content, file=self.file, path=self.path, json=self._json)

    def replaced(self, over: Mapping[str, object]) -> SceneTable:
        """Return the same table with other values in place of its own."""
        content = {**self._content, **over}
        return SceneTable(content, file=self.file, path=self.path, json=self._json)

    def error(self, problem: str, key: str | None = None) -> SceneError:
        """Return the error about `key` of this table, or about the table itself."""
        parts = [part for part in (self.path, key) if part]
        value = None if key is None else self._content.get(key)
        return SceneError(problem, key=".".join(parts), file=self.file, value=value)

    def expect(self, *keys: str) -> None:
        """Refuse every key but these.

        Raises SceneError: at the first other key, with the nearest of these.
        """
        self._expected = keys
        for key in self._content:
            if key not in keys:
                raise self.error(unknown_name(key, keys, "key"), key)

    def build(self, construct: Callable[[], Value], key: str | None = None) -> Value:
        """Return ``construct()``, its errors with this place added; a missing extra is an error
        too.

        Without a `key` the place is the argument at fault, where this table has a key of its name.
        """
        try:
            return construct()
        except SceneError:
            raise
        except StandoffError as error:
            if key is None and error.argument.partition("[")[0] in self:
                key = error.argument
            raise self.error(str(error), key) from error
        except (ValueError, TypeError, OSError, ImportError) as error:
            raise self.error(str(error), key) from error

    def formula(self, key: str) -> str | float:
        """Return a formula in quotes, or a number."""
        value = self.required(key, f'{key} = "cos(u)"')
        return self.text(key) if isinstance(value, str) else self._finite(value, key)

    def named_numbers(self, key: str) -> dict[str, float]:
        """Return the finite numbers of a table whose keys are the user's own names."""
        if key not in self:
            return {}
        table = self.table(key)
        return {name: table.number(name) for name in table.names()}

    def required(self, key: str, example: str) -> object:
        """Return the raw value of `key`; `example` is the line to add when it is missing."""
        if key in self:
            return self._content[key]
        # Once the other keys are known to be right, none of them can be a misspelling of this one.
        likely = None if self._expected else nearest(key, self._content)
        hint = f", or rename '{likely}'" if likely is not None else ""
        fix = f'add "{key}" to this object' if self._json else f"add a line such as: {example}"
        raise self.error(f"'{key}' is missing; {fix}{hint}")

    def number(self, key: str, default: float | None = None, *, example: str = "") -> float:
        """Return a finite number."""
        if default is not None and key not in self:
            return default
        return self._finite(self.required(key, example or f"{key} = 1.0"), key)

    def positive(
        self,
        key: str,
        default: float | None = None,
        *,
        example: str = "",
        infinite: bool = False,
    ) -> float:
        """Return a number above zero, finite unless `infinite` says that it need not be."""
        if infinite and self._content.get(key) == math.inf:
            return math.inf
        value = self.number(key, default, example=example)
        if value <= 0.0:
            raise self.error(f"must be above zero, got {value:g}", key)
        return value

    def count(self, key: str, default: int) -> int:
        """Return a whole number above zero."""
        value = self._content.get(key, default)
        if isinstance(value, bool) or not isinstance(value, int) or value < 1:
            raise self.error(f"must be a whole number above zero, got {shown(value)}", key)
        return value

    def true_or_false(self, key: str) -> bool:
        """Return true or false."""
        value = self.required(key, f"{key} = true")
        if not isinstance(value, bool):
            raise self.error(f"must be true or false, got {shown(value)}", key)
        return value

    def not_negative(self, key: str, default: float | None = None) -> float:
        """Return a finite number, zero or above."""
        value = self.number(key, default)
        if value < 0.0:
            raise self.error(f"must be zero or above, got {value:g}", key)
        return value

    def text(self, key: str, default: str | None = None, *, example: str = "") -> str:
        """Return a string that is not empty."""
        if default is not None and key not in self:
            return default
        value = self.required(key, example or f'{key} = "..."')
        if not isinstance(value, str) or not value.strip():
            raise self.error(f"must be a string in quotes, got {shown(value)}", key)
        return value

    def choice(
        self, key: str, known: Sequence[str], default: str | None = None, *, noun: str = ""
    ) -> str:
        """Return one of the words in `known`; `noun` is what the message calls it, if not `key`."""
        value = self.text(key, default, example=f'{key} = "{known[0]}"')
        if value not in known:
            raise self.error(unknown_name(value, known, noun or key), key)
        return value

    def number_or_word(self, key: str, word: str, default: float | None = None) -> float | None:
        """Return a finite number, or None where the value is `word`."""
        value = self._content.get(key, default)
        if value == word:
            return None
        if isinstance(value, str):
            raise self.error(f"must be a number or '{word}', got {shown(value)}", key)
        return self.number(key, default)

    def only_one(self, keys: Sequence[str]) -> str | None:
        """Return which of `keys` is given, None if none is; refuse two of them."""
        given = [key for key in keys if key in self]
        if len(given) > 1:
            raise self.error(
                f"{one_of(given[:-1])} and '{given[-1]}' say the same thing: keep one of them"
            )
        return given[0] if given else None

    def entries(self, key: str, example: str = "") -> list[object]:
        """Return the raw values of a list of any length above zero."""
        values = self._list(self.required(key, example or f"{key} = [...]"), key)
        if not values:
            raise self.error("is an empty list; give at least one entry, or leave it out", key)
        return values

    def vector(self, key: str, lengths: int | tuple[int, ...], *, example: str = "") -> Array:
        """Return a vector of finite numbers whose length is one of `lengths`."""
        allowed = (lengths,) if isinstance(lengths, int) else lengths
        sample = ", ".join(["0.0"] * allowed[-1])
        value = self.required(key, example or f"{key} = [{sample}]")
        return self._vector(value, key, allowed)

    def matrix(self, key: str, shapes: Sequence[tuple[int, int]]) -> Array:
        """Return a matrix of finite numbers, written as a list of rows, of one of `shapes`."""
        rows = self._list(self.required(key, f"{key} = [[...], ...]"), key)
        widths = tuple({columns for _, columns in shapes})
        matrix = [
            self._vector(row, f"{key}[{index}]", widths, "a row of")
            for index, row in enumerate(rows)
        ]
        shape = (len(matrix), len(matrix[0]) if matrix else 0)
        if shape not in shapes or any(len(row) != shape[1] for row in matrix):
            wanted = " or ".join(f"{height}×{width}" for height, width in shapes)
            raise self.error(f"must be a {wanted} list of rows, got {shape[0]} rows", key)
        return np.array(matrix)

    def points(self, key: str, lengths: int | tuple[int, ...], at_least: int) -> Array:
        """Return a list of at least `at_least` points of equal length, shape (n, length)."""
        allowed = (lengths,) if isinstance(lengths, int) else lengths
        rows = self._list(self.required(key, f"{key} = [[...], ...]"), key)
        points = [
            self._vector(row, f"{key}[{index}]", allowed, "a point of")
            for index, row in enumerate(rows)
        ]
        if len(points) < at_least:
            raise self.error(f"needs at least {at_least} points, got {len(points)}", key)
        for index, point in enumerate(points):
            if len(point) != len(points[0]):
                raise self.error(
                    f"has {len(point)} numbers where {key}[0] has {len(points[0])}; "
                    "give every point the same number",
                    f"{key}[{index}]",
                )
        return np.array(points)

    def net(self, key: str, length: int | None) -> Array:
        """Return a grid of finite numbers, or of points of `length` of them, row by row.

        Shape (n, m), or (n, m, length); every row as long as the first, none empty.
        """
        rows = self._list(self.required(key, f"{key} = [[...], ...]"), key)
        found: list[list[Array]] = []
        for i, row in enumerate(rows):
            items = self._list(row, f"{key}[{i}]")
            if not items or (found and len(items) != len(found[0])):
                wanted = f"where {key}[0] has {len(found[0])}" if found else "; give at least one"
                raise self.error(f"has {len(items)} entries {wanted}", f"{key}[{i}]")
            found.append(
                [self._entry(item, f"{key}[{i}][{j}]", length) for j, item in enumerate(items)]
            )
        if not found:
            raise self.error("is an empty list; give at least one row", key)
        return np.array(found)

    def _entry(self, value: object, key: str, length: int | None) -> Array:
        if length is None:
            return np.array(self._finite(value, key))
        return self._vector(value, key, (length,), "a point of")

    def numbers(self, key: str) -> Array:
        """Return a list of finite numbers of any length above zero."""
        values = self._list(self.required(key, f"{key} = [1.0, 1.0]"), key)
        if not values:
            raise self.error("is an empty list; give at least one number", key)
        return np.array([self._finite(value, f"{key}[{i}]") for i, value in enumerate(values)])

    def positive_vector(self, key: str, length: int, *, or_one: bool = False) -> Array:
        """Return `length` finite numbers above zero; with `or_one`, one may stand for all."""
        sample = ", ".join(["1.0"] * length)
        value = self.required(key, f"{key} = [{sample}]")
        if or_one and not isinstance(value, list):
            vector = np.full(length, self._finite(value, key))
        else:
            vector = self._vector(value, key, (length,))
        if np.any(vector <= 0.0):
            raise self.error(f"every number must be above zero, got {vector.tolist()}", key)
        return vector

    def table(self, key: str, example: str = "") -> SceneTable:
        """Return the table under `key`."""
        value = self.required(key, example or f"[{self._below(key)}]")
        return self._table(value, key)

    def tables(self, key: str) -> list[SceneTable]:
        """Return the array of tables under `key`, at least one."""
        values = self._list(self.required(key, f"[[{self._below(key)}]]"), key)
        if not values:
            fix = "add an object" if self._json else f"add a [[{self._below(key)}]]"
            raise self.error(f"is an empty list; {fix}", key)
        return [self._table(value, f"{key}[{index}]") for index, value in enumerate(values)]

    def _below(self, key: str) -> str:
        return f"{self.path}.{key}" if self.path else key

    def _list(self, value: object, key: str) -> list[object]:
        if not isinstance(value, list):
            raise self.error(f"must be a list in square brackets, got {shown(value)}", key)
        return value

    def _table(self, value: object, key: str) -> SceneTable:
        if not isinstance(value, dict):
            wanted = f"a table, written [{self._below(key)}]"
            if self._json:
                wanted = "an object in braces"
            raise self.error(f"must be {wanted}, got {shown(value)}", key)
        return SceneTable(value, file=self.file, path=self._below(key), json=self._json)

    def _vector(
        self, value: object, key: str, lengths: tuple[int, ...], noun: str = "a list of"
    ) -> Array:
        wanted = " or ".join(map(str, sorted(lengths)))
        if not isinstance(value, list) or len(value) not in lengths:
            raise self.error(f"must be {noun} {wanted} numbers, got {shown(value)}", key)
        return np.array([self._finite(item, f"{key}[{i}]") for i, item in enumerate(value)])

    def _finite(self, value: object, key: str) -> float:
        # TOML's true and false are Python bools, and a bool is an int: refused by name.
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self.error(f"must be a number, got {shown(value)}", key)
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if not math.isfinite(number):
            raise self.error(f"must be a finite number, got {shown(value)}", key)
        return number
