"""The distance of designed bodies and its derivatives, by design parameters and poses together.

Rows of one set of parameters are answered together. Bodies are made by ``Design.changed``, and the
derivatives are those of `shape_gradient` and of `ambient`: there is no other formula here.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from math import prod
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.checks.names import choice
from standoff.checks.real_numbers import shown
from standoff.design import Design, shape_gradient
from standoff.errors import StandoffError, StandoffTypeError
from standoff.frameworks import ambient
from standoff.tracking.derivatives import Smoothness
from standoff.typing import Array

Shape = tuple[int, ...]
POSE: Shape = (4, 4)

KEPT = 8
"""Designs of given parameters that are kept with their bodies: derivatives follow the distance."""

NO_SECOND = (
    "Standoff has first derivatives of the distance by design parameters, not second ones, alone "
    "or mixed with poses. Of constant parameters, `distance` of `design.body` has second "
    "derivatives by the poses."
)


class Designs(NamedTuple):
    """Two bodies or designs, the names of the parameters that are given, and what is done where
    derivatives are not defined."""

    a: Body | Design
    b: Body | Design
    names: tuple[tuple[str, ...], tuple[str, ...]]
    undefined: str

    @classmethod
    def of(cls, a: Any, b: Any, params: tuple[Any, Any], undefined: str) -> Designs:
        """The designs, checked with the dictionaries of their parameters."""
        names = []
        for side, design, given in zip("ab", (a, b), params, strict=True):
            if not isinstance(design, Body | Design):
                raise StandoffTypeError(
                    f"design_{side} = {shown(design)}: give a so.Design, or a body that does not "
                    "change.",
                    f"design_{side}",
                    design,
                )
            names.append(_names(design, given, f"params_{side}"))
        choice(undefined, "undefined", ambient.UNDEFINED)
        return cls(a, b, (names[0], names[1]), undefined)

    @property
    def labels(self) -> list[str]:
        """What each array is called: A's parameters, B's, and the poses."""
        sides = zip("ab", self.names, strict=True)
        told = [f"params_{side}[{name!r}]" for side, names in sides for name in names]
        return [*told, "pose_a", "pose_b"]

    @property
    def shapes(self) -> list[Shape]:
        """The shape of each in one row."""
        found: list[Shape] = []
        for design, names in zip((self.a, self.b), self.names, strict=True):
            if isinstance(design, Design):
                found += [np.shape(design.parameters[name]) for name in names]
        return [*found, POSE, POSE]

    def arrays(self, params: tuple[Any, Any], poses: tuple[Any, Any]) -> list[Any]:
        """All that is given, in the order of the labels."""
        sides = zip(self.names, params, strict=True)
        return [*(given[name] for names, given in sides for name in names), *poses]

    def lead(self, shapes: Sequence[Shape]) -> Shape:
        """The common leading shape of arrays of these shapes: () of one row, (n,) of n.

        Raises StandoffError.
        """
        leads: dict[str, Shape] = {}
        for label, shape, own in zip(self.labels, shapes, self.shapes, strict=True):
            at = len(shape) - len(own)
            if at < 0 or shape[at:] != own:
                many = str(("n", *own)).replace("'", "")
                raise StandoffError(
                    f"{label} has the shape {shape}: give {own}, or {many} for n rows.",
                    label,
                    shape,
                )
            leads[label] = shape[:at]
        try:
            return np.broadcast_shapes(*leads.values())
        except ValueError as error:
            told = ", ".join(f"{label} {lead[0]}" for label, lead in leads.items() if lead)
            raise StandoffError(
                f"The numbers of rows differ: {told}. Give n of each, or one for all."
            ) from error


class DesignGradients(NamedTuple):
    """Distances (...), and their gradients by each array that was given, in its shape."""

    distance: Array
    gradients: tuple[Array, ...]


class Set(NamedTuple):
    """Rows of one set of parameters, and what is made with these."""

    rows: NDArray[np.int64] | slice
    designs: tuple[Body | Design, Body | Design]
    pair: ambient.AmbientPair
    poses: list[Array]


def value(designs: Designs, *given: Array) -> Array:
    """Distances (...) of arrays in the order of ``designs.labels``, which are broadcast.

    Raises StandoffError: parameters that make no body; a matrix that is no pose.
    """
    lead = designs.lead([x.shape for x in given])
    distance = np.empty(prod(lead))
    for one, found in _answered(designs, given, lead, 0):
        distance[one.rows] = found.distance
    return distance.reshape(lead)


def first(designs: Designs, *given: Array) -> DesignGradients:
    """Distances and gradients; where they are not defined, as the designs say."""
    lead = designs.lead([x.shape for x in given])
    count, shapes = prod(lead), designs.shapes
    distance = np.empty(count)
    gradients = [np.empty((count, *shape)) for shape in shapes]
    lacking: dict[int, tuple[Smoothness, str]] = {}
    for one, found in _answered(designs, given, lead, 1):
        distance[one.rows] = found.distance
        by_poses = ambient.by_matrices(found).reshape(-1, 2, *POSE)
        rates = _rates(designs, one, found)
        for gradient, part in zip(gradients, [*rates, by_poses[:, 0], by_poses[:, 1]], strict=True):
            gradient[one.rows] = part
        alone = len(found.distance) == 1  # one answer, it may be for many rows
        for k, row in enumerate(np.arange(count)[one.rows].tolist() if found.lacking else ()):
            if (0 if alone else k) in found.lacking:
                lacking[row] = found.lacking[0 if alone else k]
    ambient.tell(designs.undefined, lacking, count, 3)
    return DesignGradients(
        distance.reshape(lead),
        tuple(x.reshape((*lead, *shape)) for x, shape in zip(gradients, shapes, strict=True)),
    )


def _names(design: Body | Design, given: Any, label: str) -> tuple[str, ...]:
    if isinstance(design, Body):
        if given:
            raise StandoffError(
                f"{label} = {shown(given)}: a body has no parameters; give {{}}, or a so.Design.",
                label,
                given,
            )
        return ()
    if not isinstance(given, Mapping):
        raise StandoffTypeError(
            f"{label} = {shown(given)}: give a dict of the design's parameters by name.",
            label,
            given,
        )
    for name in given:
        choice(name, label, design.parameters)
    # JAX sorts dictionaries as well: one order for each set of names
    return tuple(sorted(given))


def _rates(designs: Designs, one: Set, found: ambient.AmbientRows) -> list[Array]:
    """(m, ...) derivatives by each parameter that is given; nan in rows that lack derivatives.

    In flat contact a parameter need not move all pairs of nearest points alike, and so its
    derivative is not known.
    """
    kinds = [design if isinstance(design, Design) else None for design in one.designs]
    count = len(found.distance)
    told: tuple[Mapping[str, Any], ...] = ({}, {})
    if any(kinds):
        by = shape_gradient(found.answers, a=kinds[0], b=kinds[1])
        told = (by.a, by.b)
    rates = []
    for names, side, shapes in zip(designs.names, told, _by_side(designs), strict=True):
        for name, shape in zip(names, shapes, strict=True):
            rate = np.array(side.get(name, np.full(shape, np.nan))).reshape(count, *shape)
            rate[list(found.lacking)] = np.nan
            rates.append(rate)
    return rates


def _by_side(designs: Designs) -> tuple[list[Shape], list[Shape]]:
    shapes, of_a = designs.shapes[:-2], len(designs.names[0])
    return shapes[:of_a], shapes[of_a:]


def _answered(
    designs: Designs, given: Sequence[Array], lead: Shape, order: int
) -> Iterator[tuple[Set, ambient.AmbientRows]]:
    """Each set of parameters with the answers of its rows."""
    sets = _sets(designs, given, lead)
    for one in sets:
        try:
            found = ambient.answered(one.pair, one.poses, order)
        except StandoffError as error:
            if len(sets) == 1:
                raise
            numbers = np.arange(prod(lead))[one.rows].tolist()
            raise StandoffError(
                f"Of the rows {shown(numbers)}, which have the same parameters: {error}"
            ) from error
        yield one, found


def _sets(designs: Designs, given: Sequence[Array], lead: Shape) -> list[Set]:
    count, shapes = prod(lead), designs.shapes
    poses = ambient.flat_poses(given[-2:], lead)
    params = given[:-2]
    if all(x.shape == shape for x, shape in zip(params, shapes, strict=False)):
        return [_set(designs, slice(None), params, poses)]
    flat = [
        np.broadcast_to(x, (*lead, *shape)).reshape(count, *shape)
        for x, shape in zip(params, shapes, strict=False)
    ]
    numbers = np.concatenate([x.reshape(count, -1) for x in flat], axis=1)
    if (numbers == numbers[:1]).all():
        return [_set(designs, slice(None), [x[0] for x in flat], poses)] if count else []
    inverse = np.unique(numbers, axis=0, return_inverse=True)[1].ravel()
    order = np.argsort(inverse, kind="stable")
    return [
        _set(
            designs,
            rows,
            [x[rows[0]] for x in flat],
            [x if len(x) == 1 else x[rows] for x in poses],
        )
        for rows in np.split(order, np.cumsum(np.bincount(inverse))[:-1])
    ]


def _set(
    designs: Designs,
    rows: NDArray[np.int64] | slice,
    values: Sequence[Array],
    poses: list[Array],
) -> Set:
    of_a = len(designs.names[0])
    made: list[Body | Design] = []
    bodies: list[Body] = []
    for side, design, names, given in zip(
        "ab", (designs.a, designs.b), designs.names, (values[:of_a], values[of_a:]), strict=True
    ):
        changed = design
        if isinstance(design, Design) and names:
            told = tuple(np.ascontiguousarray(x, dtype=float).tobytes() for x in given)
            changed = _kept(design, names, told, side)
        body = changed.body if isinstance(changed, Design) else changed
        bodies.append(_convex(body, f"design_{side}"))
        # a design none of whose parameters are given does not change
        made.append(changed if names else bodies[-1])
    pair = ambient.AmbientPair(bodies[0], bodies[1], designs.undefined)
    return Set(rows, (made[0], made[1]), pair, poses)


@lru_cache(maxsize=KEPT)
def _kept(design: Design, names: tuple[str, ...], numbers: tuple[bytes, ...], side: str) -> Design:
    """The design of these parameters, of which the others are no parameters, with its body made."""
    free = design if len(names) == len(design.parameters) else design.only(*names)
    values: dict[str, Any] = {
        name: np.frombuffer(told).reshape(np.shape(design.parameters[name]))
        for name, told in zip(names, numbers, strict=True)
    }
    try:
        found = free.changed(**values)
        _ = found.body
    except (ValueError, ArithmeticError) as error:
        told = ", ".join(f"{name} = {shown(value.tolist())}" for name, value in values.items())
        raise StandoffError(f"params_{side} make no body: with {told}, {error}") from error
    return found


def _convex(body: Any, name: str) -> Body:
    if not isinstance(body, Body):
        raise StandoffTypeError(
            f"{name} makes {shown(body)}: give a design of a Body; of solids "
            "`so.shape_gradient` has the derivatives.",
            name,
            body,
        )
    return body
