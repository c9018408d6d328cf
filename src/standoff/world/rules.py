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
from standoff.world.compound import Piece, name_of

Ints = NDArray[np.int64]
Pairs = Iterable[tuple[str, str]]


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
    margin_pairs : (m,) array
        i n + j of pairs with a margin of their own, sorted.
    margins : (m,) array
        These, length.
    """

    kinds: Ints
    meets: Ints
    left_out: Ints
    margin_pairs: Ints
    margins: NDArray[np.float64]

    def counts(self, i: int, j: int) -> bool:
        """Does a pair of bodies count?"""
        if i == j or not self.meets[self.kinds[i], self.kinds[j]]:
            return False
        key = min(i, j) * len(self.kinds) + max(i, j)
        at = int(np.searchsorted(self.left_out, key))
        return not (at < len(self.left_out) and self.left_out[at] == key)

    def margin(self, i: int, j: int) -> float:
        """The margin of a pair, 0 where it has none of its own."""
        key = min(i, j) * len(self.kinds) + max(i, j)
        at = int(np.searchsorted(self.margin_pairs, key))
        if at < len(self.margin_pairs) and self.margin_pairs[at] == key:
            return float(self.margins[at])
        return 0.0


class Given(NamedTuple):
    """What the user says of pairs; see `World`."""

    groups: Mapping[str, Sequence[str]]
    ignore: Pairs
    only: Pairs | None
    parents: Mapping[str, str]
    margins: Mapping[tuple[str, str], float]


class Names:
    """Bodies and groups by name.

    Raises
    ------
    StandoffError
        A group of a body's name, of nobody, or of bodies that the world does not have.
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


def packed_rules(names: Names, fixed: NDArray[np.bool_], given: Given) -> Rules:
    """The rules of a world's pairs; two fixed bodies are never a pair."""
    n = len(names.bodies)
    single: list[Ints] = []
    groups: list[tuple[Any, Any]] = []
    for pair in given.ignore:
        a, b = names.pair(pair, "ignore")
        if a in names.groups or b in names.groups:
            groups.append((names.members(a, "ignore"), names.members(b, "ignore")))
        else:
            single.append(_keys(names.members(a, "ignore"), names.members(b, "ignore"), n))
            if len(single[-1]) == 0:
                raise StandoffError(f"ignore has {a!r} with itself.", "ignore", pair)
    for child, parent in given.parents.items():
        i, j = names.body(child, "parents"), names.body(parent, "parents")
        if i == j:
            raise StandoffError(f"{child!r} is its own parent.", "parents", child)
        single.append(_keys(np.array([i]), np.array([j]), n))
    wanted = None
    if given.only is not None:
        pairs = [names.pair(pair, "only") for pair in given.only]
        wanted = [(names.members(a, "only"), names.members(b, "only")) for a, b in pairs]
    kinds, meets = _kinds(n, fixed, groups, wanted)
    left_out = np.unique(np.concatenate(single)) if single else np.zeros(0, dtype=np.int64)
    return Rules(kinds, meets, left_out, *_margins(names, given.margins, n))


def _keys(a: Ints, b: Ints, n: int) -> Ints:
    """i n + j of all pairs i < j of two lists."""
    i, j = (x.ravel() for x in np.meshgrid(a, b, indexing="ij"))
    keys: Ints = (np.minimum(i, j) * n + np.maximum(i, j))[i != j]
    return keys


def _kinds(
    n: int,
    fixed: NDArray[np.bool_],
    apart: list[tuple[Ints, Ints]],
    wanted: list[tuple[Ints, Ints]] | None,
) -> tuple[Ints, Ints]:
    """The kinds of bodies that rules by group tell apart, and which of them meet."""
    sides = [side for pair in [*apart, *(wanted or [])] for side in pair]
    marks = np.zeros((n, 1 + len(sides)), dtype=bool)
    marks[:, 0] = fixed
    for k, side in enumerate(sides, 1):
        marks[side, k] = True
    rows, kinds = np.unique(marks, axis=0, return_inverse=True)
    of_pair = np.arange(1, 1 + len(sides)).reshape(-1, 2)
    meets = ~np.outer(rows[:, 0], rows[:, 0])
    for a, b in of_pair[: len(apart)]:
        meets &= ~(np.outer(rows[:, a], rows[:, b]) | np.outer(rows[:, b], rows[:, a]))
    if wanted is not None:
        some = np.zeros_like(meets)
        for a, b in of_pair[len(apart) :]:
            some |= np.outer(rows[:, a], rows[:, b]) | np.outer(rows[:, b], rows[:, a])
        meets &= some
    return kinds.reshape(-1).astype(np.int64), meets.astype(np.int64)


def _margins(
    names: Names, given: Mapping[tuple[str, str], float], n: int
) -> tuple[Ints, NDArray[np.float64]]:
    """Pairs with a margin and the margins; of several for one pair the greatest."""
    found: dict[int, float] = {}
    for pair, value in given.items():
        a, b = names.pair(pair, "margins")
        margin = not_negative(value, f"margins[{a!r}, {b!r}]")
        for key in _keys(names.members(a, "margins"), names.members(b, "margins"), n).tolist():
            found[key] = max(margin, found.get(key, 0.0))
    keys = sorted(found)
    return np.array(keys, dtype=np.int64), np.array([found[key] for key in keys], dtype=float)


def check_half_spaces(
    names: Sequence[str], pieces: Sequence[Sequence[Piece]], rules: Rules
) -> None:
    """Refuse two half-spaces that would be a pair.

    Raises
    ------
    StandoffError
    """
    endless = [k for k, each in enumerate(pieces) if any(not p.body.bounded for p in each)]
    for i, j in itertools.combinations(endless, 2):
        if rules.counts(i, j):
            raise StandoffError(
                f"{names[i]!r} and {names[j]!r} are half-spaces: such a pair has no witness "
                "points; fix both, or ignore the pair.",
                "bodies",
            )
