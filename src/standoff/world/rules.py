"""Which pairs of a world's bodies count, and their margins: read from names and packed."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.checks.names import did_you_mean
from standoff.checks.numbers import not_negative
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.typing import Array, Ints
from standoff.world.pieces import CompoundPiece, name_of
from standoff.world.shapes import is_bounded

Pairs = Iterable[tuple[str, str]]
Sides = tuple[Ints, Ints]
"""The bodies on each side of a rule."""


class Rules(NamedTuple):
    """As the kernels read them.

    Attributes
    ----------
    kinds : (n,) array
        Of each body: bodies of one kind are in the same groups.
    meets : (k, k) array
        1 where two kinds meet.
    left_out : (m,) array
        i n + j of pairs i < j of bodies that do not count, sorted.
    kind_margins : (k, k) array
        The margins that were given by group, length; 0 where there is none.
    margin_pairs : (m,) array
        i n + j of pairs of two bodies with a margin of their own, sorted.
    margins : (m,) array
        These, length.
    """

    kinds: Ints
    meets: Ints
    left_out: Ints
    kind_margins: Array
    margin_pairs: Ints
    margins: Array

    def counts(self, i: int, j: int) -> bool:
        """Does a pair of bodies count?"""
        if i == j or not self.meets[self.kinds[i], self.kinds[j]]:
            return False
        key = min(i, j) * len(self.kinds) + max(i, j)
        at = int(np.searchsorted(self.left_out, key))
        return not (at < len(self.left_out) and self.left_out[at] == key)

    def counting(self, i: Ints, j: Ints) -> NDArray[np.bool_]:
        """Which of several pairs of bodies count?"""
        keys = np.minimum(i, j) * len(self.kinds) + np.maximum(i, j)
        meet = self.meets[self.kinds[i], self.kinds[j]] != 0
        return np.asarray(meet & (i != j) & ~np.isin(keys, self.left_out))

    def partners(self, i: int) -> Ints:
        """The bodies of greater number with which body i is a pair."""
        n = len(self.kinds)
        others = np.arange(i + 1, n)
        others = others[self.meets[self.kinds[i], self.kinds[i + 1 :]] != 0]
        first, end = np.searchsorted(self.left_out, [i * n, (i + 1) * n])
        return np.setdiff1d(others, self.left_out[first:end] - i * n, assume_unique=True)

    @property
    def greatest_margin(self) -> float:
        """Of all pairs, length; 0 without margins."""
        return max(float(self.kind_margins.max()), float(self.margins.max(initial=0.0)))

    def margins_of(self, numbers: Ints) -> Array:
        """The margins of pairs i n + j of bodies i < j, 0 where a pair has none; of several the
        greatest."""
        i, j = np.divmod(numbers, len(self.kinds))
        found: Array = self.kind_margins[self.kinds[i], self.kinds[j]]
        if len(self.margin_pairs):
            at = np.minimum(np.searchsorted(self.margin_pairs, numbers), len(self.margins) - 1)
            own = np.where(self.margin_pairs[at] == numbers, self.margins[at], 0.0)
            found = np.maximum(found, own)
        return found

    def margin(self, i: int, j: int) -> float:
        """The margin of a pair, 0 where it has none."""
        if not (len(self.margins) or self.kind_margins.any()):
            return 0.0
        number = min(i, j) * len(self.kinds) + max(i, j)
        return float(self.margins_of(np.array([number]))[0])


class PairRules(NamedTuple):
    """What the user says of pairs; see `World`."""

    groups: Mapping[str, Sequence[str]]
    ignore: Pairs
    only: Pairs | None
    parents: Mapping[str, str]
    margins: Mapping[tuple[str, str], float]


class Names:
    """Bodies and groups by name.

    Raises StandoffError: a group of a body's name, of nobody, or of bodies that the world does not
    have.
    """

    def __init__(self, bodies: Sequence[str], groups: Mapping[str, Sequence[str]]) -> None:
        self.bodies = {name: k for k, name in enumerate(bodies)}
        self.groups: dict[str, Ints] = {}
        if not isinstance(groups, Mapping):
            raise StandoffTypeError(
                f"groups = {shown(groups)}: give a mapping of names to lists of bodies.",
                "groups",
                groups,
            )
        for name, members in groups.items():
            if name_of(name) in self.bodies:
                raise StandoffError(f"{name!r} is a body: a group needs another name.", "groups")
            members = members if isinstance(members, str) else tuple(members)
            if isinstance(members, str) or not members:
                raise StandoffError(
                    f"The group {name!r} is {shown(members)}: give a list of one body or more.",
                    "groups",
                    members,
                )
            self.groups[name] = np.array([self.body(x, "groups") for x in members], np.int64)

    def body(self, name: Any, argument: str) -> int:
        """The number of a body."""
        if isinstance(name, str) and name in self.bodies:
            return self.bodies[name]
        hint = did_you_mean(name, self.bodies) if isinstance(name, str) else ""
        raise StandoffError(
            f"{argument}: the world has no body {shown(name)}.{hint}", argument, name
        )

    def members(self, name: Any, argument: str) -> Ints:
        """The numbers of a group's bodies, or of one."""
        if isinstance(name, str) and name in self.groups:
            return self.groups[name]
        if isinstance(name, str) and name not in self.bodies:
            hint = did_you_mean(name, [*self.bodies, *self.groups])
            raise StandoffError(
                f"{argument}: the world has no body or group {shown(name)}.{hint}", argument, name
            )
        return np.array([self.body(name, argument)], dtype=np.int64)

    def pair(self, given: Any, argument: str) -> tuple[Any, Any]:
        """A pair of names."""
        if isinstance(given, str) or not isinstance(given, Sequence) or len(given) != 2:
            raise StandoffTypeError(
                f"{argument} has {shown(given)}: give pairs of names of bodies or groups.",
                argument,
                given,
            )
        return given[0], given[1]


def packed_rules(names: Names, fixed: NDArray[np.bool_], given: PairRules) -> Rules:
    """The rules of a world's pairs; two fixed bodies are never a pair."""
    n = len(names.bodies)
    single: list[Ints] = []
    groups: list[Sides] = []
    for pair in given.ignore:
        a, b = sides = _sides(names, pair, "ignore")
        if len(a) == len(b) == 1:
            single.append(_keys(a, b, n))
        else:
            groups.append(sides)
    for child, parent in given.parents.items():
        i, j = names.body(child, "parents"), names.body(parent, "parents")
        if i == j:
            raise StandoffError(f"{child!r} is its own parent.", "parents", child)
        single.append(_keys(np.array([i]), np.array([j]), n))
    wanted = None
    if given.only is not None:
        wanted = [_sides(names, pair, "only") for pair in given.only]
    own, of_groups = _margins(names, given.margins, n)
    kinds = _Kinds(n, fixed, [*groups, *(wanted or []), *(sides for sides, _ in of_groups)])
    left_out = np.unique(np.concatenate(single)) if single else np.zeros(0, dtype=np.int64)
    keys = sorted(own)
    rules = Rules(
        kinds.kinds,
        kinds.meets(groups, wanted),
        left_out,
        kinds.margins(of_groups),
        np.array(keys, dtype=np.int64),
        np.array([own[key] for key in keys], dtype=float),
    )
    for array in rules:
        array.flags.writeable = False
    return rules


def _sides(names: Names, pair: Any, argument: str) -> Sides:
    """The bodies on both sides of a rule.

    Raises StandoffError: a name that nobody has, or a body with itself, which is no pair.
    """
    a, b = names.pair(pair, argument)
    sides = names.members(a, argument), names.members(b, argument)
    if a == b and a in names.bodies:
        raise StandoffError(f"{argument} has {a!r} with itself.", argument, pair)
    return sides


def _keys(a: Ints, b: Ints, n: int) -> Ints:
    """i n + j of all pairs i < j of two lists."""
    i, j = (x.ravel() for x in np.meshgrid(a, b, indexing="ij"))
    keys: Ints = (np.minimum(i, j) * n + np.maximum(i, j))[i != j]
    return keys


class _Kinds:
    """The kinds of bodies that rules by group tell apart: what holds of a pair of groups stands in
    a table of kinds, however many bodies are in them.

    Attributes
    ----------
    kinds : (n,) array
        Of each body.
    """

    def __init__(self, n: int, fixed: NDArray[np.bool_], rules: Iterable[Sides]) -> None:
        columns: dict[bytes, int] = {}
        sides = [side for pair in rules for side in pair]
        for side in sides:
            columns.setdefault(side.tobytes(), 1 + len(columns))
        marks = np.zeros((n, 1 + len(columns)), dtype=bool)
        marks[:, 0] = fixed
        for side in sides:
            marks[side, columns[side.tobytes()]] = True
        self._rows, kinds = np.unique(marks, axis=0, return_inverse=True)
        self._members = {
            side: np.flatnonzero(self._rows[:, column]) for side, column in columns.items()
        }
        self.kinds: Ints = kinds.reshape(-1).astype(np.int64)

    def _of(self, sides: Sides) -> tuple[Any, Any]:
        """Where a rule stands in a table of kinds: its one order, and the other."""
        a, b = (self._members[x.tobytes()] for x in sides)
        return (a[:, None], b), (b[:, None], a)

    def meets(self, apart: Iterable[Sides], wanted: Iterable[Sides] | None) -> Ints:
        """1 where two kinds meet: not both fixed, not `apart`, and `wanted` if that is given."""
        still = self._rows[:, 0]
        found = ~np.outer(still, still)
        if wanted is not None:
            some = np.zeros_like(found)
            for sides in wanted:
                for where in self._of(sides):
                    some[where] = True
            found &= some
        for sides in apart:
            for where in self._of(sides):
                found[where] = False
        return found.astype(np.int64)

    def margins(self, given: Iterable[tuple[Sides, float]]) -> Array:
        """The greatest margin of each two kinds."""
        found = np.zeros((len(self._rows), len(self._rows)))
        for sides, margin in given:
            for where in self._of(sides):
                found[where] = np.maximum(found[where], margin)
        return found


def _margins(
    names: Names, given: Mapping[tuple[str, str], float], n: int
) -> tuple[dict[int, float], list[tuple[Sides, float]]]:
    """Margins of two bodies, by i n + j; and those of groups."""
    own: dict[int, float] = {}
    groups: list[tuple[Sides, float]] = []
    for pair, value in given.items():
        a, b = sides = _sides(names, pair, "margins")
        margin = not_negative(value, f"margins[{pair[0]!r}, {pair[1]!r}]")
        if len(a) == len(b) == 1:
            for key in _keys(a, b, n).tolist():
                own[key] = max(margin, own.get(key, 0.0))
        else:
            groups.append((sides, margin))
    return own, groups


def check_half_spaces(
    names: Sequence[str], pieces: Sequence[Sequence[CompoundPiece]], rules: Rules
) -> None:
    """Refuse two half-spaces that would be a pair.

    Raises StandoffError.
    """
    endless = [k for k, each in enumerate(pieces) if any(not is_bounded(p.body) for p in each)]
    for i, j in itertools.combinations(endless, 2):
        if rules.counts(i, j):
            raise StandoffError(
                f"{names[i]!r} and {names[j]!r} are half-spaces: such a pair has no witness "
                "points; fix both, or ignore the pair.",
                "bodies",
            )
