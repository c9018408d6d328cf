"""The ``[world]`` table: which pairs of a scene's bodies count, and how far away they matter."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from standoff.scene.motions import Motion
from standoff.scene.reader import SceneTable, shown, unknown_name
from standoff.tracking.law_options import Law
from standoff.world import Compound, World
from standoff.world.pieces import dimension_of
from standoff.world.rules import Names, PairRules, packed_rules
from standoff.world.shapes import Shape

NamePair = tuple[str, str]

KEYS = ("within", "minima", "fixed", "groups", "ignore", "only", "parents", "margins")
"""Every key of the table."""

MARGIN_KEYS = ("a", "b", "length")
"""Those of a margin that is written as a table."""


@dataclass(frozen=True)
class WorldRules:
    """What ``[world]`` says, by the names of `World`'s arguments.

    Attributes
    ----------
    within : float
        The horizon, length.
    minima : float or None
    fixed : tuple of str
        Bodies that never move.
    groups : mapping of str to list of str
    ignore : tuple of (str, str)
    only : tuple of (str, str) or None
    parents : mapping of str to str
    margins : mapping of (str, str) to float
    """

    within: float = math.inf
    minima: float | None = None
    fixed: tuple[str, ...] = ()
    groups: Mapping[str, Sequence[str]] = field(default_factory=dict)
    ignore: tuple[NamePair, ...] = ()
    only: tuple[NamePair, ...] | None = None
    parents: Mapping[str, str] = field(default_factory=dict)
    margins: Mapping[NamePair, float] = field(default_factory=dict)

    @property
    def given(self) -> PairRules:
        """What it says of pairs."""
        return PairRules(self.groups, self.ignore, self.only, self.parents, self.margins)


def by_piece(bodies: Mapping[str, Shape | Compound]) -> dict[str, Shape]:
    """Return bodies by name; those of a compound by its name, a dot, and the piece's."""
    found: dict[str, Shape] = {}
    for name, body in bodies.items():
        if isinstance(body, Compound):
            found |= {f"{name}.{part}": piece.body for part, piece in body.pieces.items()}
        else:
            found[name] = body
    return found


def read_world(
    top: SceneTable, bodies: Mapping[str, Shape | Compound], moving: Collection[str]
) -> WorldRules | None:
    """Return what a scene's ``[world]`` says, None where it has none.

    Raises SceneError: at an unknown key or name, an empty group, a body that is fixed and moves,
    planar bodies among spatial ones, or a pair of a body with itself.

    Parameters
    ----------
    top : SceneTable
        The scene's top table.
    bodies : mapping of str to Body, Solid or Compound
    moving : collection of str
        Those with a motion.
    """
    if "world" not in top:
        return None
    table = top.table("world")
    table.expect(*KEYS)
    top.build(lambda: dimension_of(by_piece(bodies)), "bodies")
    groups = _groups(table, bodies)
    known = [*bodies, *groups]
    rules = WorldRules(
        within=table.positive("within", math.inf, infinite=True),
        minima=table.not_negative("minima") if "minima" in table else None,
        fixed=_fixed(table, bodies, groups, moving),
        groups=groups,
        ignore=_pairs(table, "ignore", known) or (),
        only=_pairs(table, "only", known),
        parents=_parents(table, bodies),
        margins=_margins(table, known),
    )
    still = np.array([name in rules.fixed for name in bodies])
    table.build(lambda: packed_rules(Names(list(bodies), groups), still, rules.given))
    return rules


def made_world(
    rules: WorldRules,
    bodies: Mapping[str, Shape | Compound],
    motions: Mapping[str, Motion],
    law: Law,
    dt: float,
) -> World:
    """Return a scene's bodies as a world.

    Raises ValueError, TypeError if they are none, as with two half-spaces that would be a pair.
    """
    return World(
        bodies,
        within=rules.within,
        fixed={name: motions[name].path.pose(0.0) for name in rules.fixed},
        minima=rules.minima,
        law=law,
        dt=dt,
        **rules.given._asdict(),
    )


def _name(table: SceneTable, value: object, key: str, known: Collection[str], noun: str) -> str:
    if not isinstance(value, str):
        raise table.error(f"must be the name of a {noun} in quotes, got {shown(value)}", key)
    if value not in known:
        raise table.error(unknown_name(value, known, noun), key)
    return value


def _groups(table: SceneTable, bodies: Collection[str]) -> dict[str, list[str]]:
    if "groups" not in table:
        return {}
    groups = table.table("groups", example='groups = { robot = ["arm", "hand"] }')
    return {
        name: [
            _name(groups, value, f"{name}[{k}]", bodies, "body")
            for k, value in enumerate(groups.entries(name))
        ]
        for name in groups.names()
    }


def _fixed(
    table: SceneTable,
    bodies: Collection[str],
    groups: Mapping[str, Sequence[str]],
    moving: Collection[str],
) -> tuple[str, ...]:
    """The names of fixed bodies, groups among them written out."""
    found: dict[str, None] = {}
    for k, value in enumerate(table.entries("fixed") if "fixed" in table else ()):
        key = f"fixed[{k}]"
        named = _name(table, value, key, [*bodies, *groups], "body or group")
        for name in groups.get(named, [named]):
            if name in moving:
                raise table.error(
                    f"'{name}' has a motion, [motions.{name}]: remove it, or this name", key
                )
            found[name] = None
    return tuple(found)


def _pairs(table: SceneTable, key: str, known: Collection[str]) -> tuple[NamePair, ...] | None:
    if key not in table:
        return None
    found = []
    for k, value in enumerate(table.entries(key)):
        if not isinstance(value, list) or len(value) != 2:
            raise table.error(
                f'must be two names such as ["arm", "hand"], got {shown(value)}', f"{key}[{k}]"
            )
        a, b = (
            _name(table, name, f"{key}[{k}][{side}]", known, "body or group")
            for side, name in enumerate(value)
        )
        found.append((a, b))
    return tuple(found)


def _parents(table: SceneTable, bodies: Collection[str]) -> dict[str, str]:
    if "parents" not in table:
        return {}
    parents = table.table("parents", example='parents = { hand = "arm" }')
    for child in parents.names():
        if child not in bodies:
            raise parents.error(unknown_name(child, bodies, "body"), child)
    return {child: parents.choice(child, list(bodies), noun="body") for child in parents.names()}


def _margins(table: SceneTable, known: Collection[str]) -> dict[NamePair, float]:
    """Margins written as lists [a, b, length], or as tables."""
    found: dict[NamePair, float] = {}
    for k, value in enumerate(table.entries("margins") if "margins" in table else ()):
        key = f"margins[{k}]"
        if isinstance(value, list) and len(value) == len(MARGIN_KEYS):
            value = dict(zip(MARGIN_KEYS, value, strict=True))
        if not isinstance(value, dict):
            raise table.error(
                'must be a list such as ["hand", "shelf", 0.02], or a table with a, b and length, '
                f"got {shown(value)}",
                key,
            )
        entry = SceneTable(value, file=table.file, path=f"{table.path}.{key}")
        entry.expect(*MARGIN_KEYS)
        a, b = (
            _name(entry, entry.required(side, f'{side} = "arm"'), side, known, "body or group")
            for side in ("a", "b")
        )
        found[a, b] = max(entry.not_negative("length"), found.get((a, b), 0.0))
    return found
