"""A convex body whose shape changes from row to row: some numbers of its table in the scene."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from standoff.bodies.body import Body
from standoff.bodies.swept import with_radius
from standoff.checks.numbers import magnitude_or_zero
from standoff.errors import StandoffError
from standoff.kernels.state import arrays as K
from standoff.scene.errors import SceneError
from standoff.scene.reader import SceneTable
from standoff.scene.shapes import NUMBERS, SHAPES, read_body, swept_keys
from standoff.sweep.parameters import Parameter, columns_of
from standoff.tracking.many_distances import rows_at_made_poses
from standoff.typing import Array

BODIES_KEPT = 4096
"""Bodies of a changing shape that are kept at hand: some 8 kB each of ellipsoids, and more of
bodies of many patches. Rows of a grid, and cells of a proof, share most of theirs."""


class ShapeNumber(NamedTuple):
    """One number of a body's table.

    Attributes
    ----------
    key : str
    entry : int
        Which of a list, from 0 on; -1 where the value is a number.
    """

    key: str
    entry: int

    @classmethod
    def of(cls, what: str) -> ShapeNumber:
        """Return what a parameter's `what` names."""
        key, _, entry = what.partition(".")
        return cls(key, int(entry) - 1 if entry else -1)


def shape_numbers(table: SceneTable) -> list[str]:
    """Return what of a body's table can change, as `what` names it."""
    shape = table.text("shape")
    keys = [key for key in (*SHAPES[shape].keys, "rounding") if key in NUMBERS]
    if shape == "segment" and "start" in table:
        keys.remove("length")
    if "affine" not in table and not ("scale" in table and _is_list(table, "scale")):
        keys.append("scale")
    counts = [(key, NUMBERS[key]) for key in keys]
    return [
        what
        for key, count in counts
        for what in ([key] if count == 1 else [f"{key}.{k + 1}" for k in range(count)])
    ]


def _is_list(table: SceneTable, key: str) -> bool:
    return isinstance(table.required(key, ""), list)


class ShapedBody:
    """A body that is made for its numbers.

    Parameters
    ----------
    name : str
        Of the body in the scene.
    table : SceneTable
        The scene's ``[bodies.NAME]``.
    parameters : sequence of Parameter
        All of the job; those of this body's shape are its own.

    Attributes
    ----------
    columns : list of int
        Where its numbers are in a row's.
    parts : list of ShapeNumber
    shape : str
        The scene's word for its kind.
    """

    def __init__(self, name: str, table: SceneTable, parameters: Sequence[Parameter]) -> None:
        self.name, self.table = name, table
        self.shape = table.text("shape")
        own = [(at, p) for at, p in columns_of(parameters) if p.shape and p.moves == name]
        self.columns = [at for at, _ in own]
        self.whats = [p.what for _, p in own]
        self.parts = [ShapeNumber.of(p.what) for _, p in own]
        scaled = "affine" in table or "scale" in table or "scale" in self.whats
        swept = () if scaled else swept_keys(self.shape)
        changes = any(part.key in swept for part in self.parts)
        self._adds = {key: table.number(key, 0.0) for key in swept} if changes else {}
        self.made = lru_cache(BODIES_KEPT)(self._made)
        self._core = lru_cache(BODIES_KEPT)(self._read)

    def numbers(self, numbers: Array) -> Array:
        """Return its own numbers (n, k) of rows (n, columns)."""
        own: Array = numbers[:, self.columns] + 0.0  # so that no zero has a sign
        return own

    def _made(self, numbers: tuple[float, ...]) -> Body:
        """Return the body of its numbers, the same bits as if the scene said them.

        Raises StandoffError if there is no such body; it tells the numbers.
        """
        own = list(zip(numbers, self.parts, strict=True))
        try:
            if not self._adds:
                return self._core(numbers)
            core = tuple(x for x, part in own if part.key not in self._adds)
            changed = {
                part.key: magnitude_or_zero(x, part.key)
                for x, part in own
                if part.key in self._adds
            }
            return with_radius(self._core(core), sum((self._adds | changed).values()))
        except StandoffError as error:
            told = ", ".join(
                f"{what} = {x:.9g}" for what, x in zip(self.whats, numbers, strict=True)
            )
            problem = error.problem if isinstance(error, SceneError) else str(error)
            raise StandoffError(
                f"'{self.name}' with {told} is no body: {problem}", "job"
            ) from error

    def _read(self, numbers: tuple[float, ...]) -> Body:
        """The body of the numbers that are not of the swept ball."""
        over: dict[str, Any] = {}
        own = [part for part in self.parts if part.key not in self._adds]
        for x, (key, entry) in zip(numbers, own, strict=True):
            if entry < 0:
                over[key] = x
            else:
                given: Any = over.get(key) or self.table.required(key, f"{key} = [...]")
                over[key] = [*given[:entry], x, *given[entry + 1 :]]
        return read_body(self.table.replaced(over))

    def facts(self) -> dict[str, Any]:
        """Return its table as plain data."""
        return {key: self.table.required(key, "") for key in self.table.names()}


Shaped = tuple[ShapedBody | None, ShapedBody | None]
"""Of A and of B: None where its shape is the same in all rows."""


def groups(
    bodies: tuple[Body, Body], shaped: Shaped, numbers: Array
) -> Iterator[tuple[Any, tuple[Body, Body]]]:
    """Yield which rows have the same shapes, and the two bodies of these.

    Raises StandoffError: numbers that make no body.

    Parameters
    ----------
    bodies : pair of Body
        Of which those stand for all rows that no parameter changes.
    shaped : pair of ShapedBody or None
    numbers : (n, columns) array
    """
    if shaped == (None, None):
        yield slice(None), bodies
        return
    own = [one.numbers(numbers) for one in shaped if one is not None]
    each, which = np.unique(np.concatenate(own, axis=1), axis=0, return_inverse=True)
    order = np.argsort(which.ravel(), kind="stable")
    ends = np.cumsum(np.bincount(which.ravel(), minlength=len(each)))[:-1]
    for values, rows in zip(each.tolist(), np.split(order, ends), strict=True):
        at, made = 0, []
        for body, one in zip(bodies, shaped, strict=True):
            if one is None:
                made.append(body)
                continue
            k = len(one.columns)
            made.append(one.made(tuple(values[at : at + k])))
            at += k
        yield rows, (made[0], made[1])


def answered_shapes(
    bodies: tuple[Body, Body],
    shaped: Shaped,
    numbers: Array,
    poses: tuple[Array, Array],
    within: float | None,
) -> tuple[Array, tuple[Array, Array]]:
    """Return the answers of rows, each of its own bodies, as the kernels write them (n, N_OUT); and
    the radii of the bodies' swept balls, (n,) each.

    Raises StandoffError: numbers that make no body.

    Parameters
    ----------
    bodies, shaped, numbers
        As of `groups`.
    poses : two (n, 4, 4) arrays, or (1, 4, 4)
        As `rows_at_made_poses` takes them.
    within : float or None
    """
    n = len(numbers)
    answers, radii = np.empty((n, K.N_OUT)), (np.empty(n), np.empty(n))
    for rows, (a, b) in groups(bodies, shaped, numbers):
        answers[rows] = rows_at_made_poses(a, b, some_poses(poses, rows), within)
        radii[0][rows], radii[1][rows] = a.radius, b.radius
    return answers, radii


def some_poses(poses: Sequence[Array], rows: Any) -> tuple[Array, Array]:
    """Return the poses of some rows, of which (1, 4, 4) stand for all."""
    a, b = (x if len(x) == 1 else x[rows] for x in poses)
    return a, b
