"""From one world to another: which bodies both have, and what is known of their pairs."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import Any

import numpy as np

from standoff.checks.names import did_you_mean
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.kernels.world import arrays as W
from standoff.typing import Array, Ints
from standoff.world.broad_phase import PairTable, empty_placed
from standoff.world.given import mapping_of, names_of
from standoff.world.model import Model
from standoff.world.poses import GivenPoses, read_poses_of
from standoff.world.rules import PairRules
from standoff.world.state import KeptSolids, WorldState


def changed_arguments(
    given: PairRules, arguments: Mapping[str, Any], add: Any, remove: Any
) -> dict[str, Any]:
    """The arguments of a world with some bodies more and without others.

    Raises TypeError, ValueError: a name that the world does not have, or has already.
    """
    bodies, fixed = arguments["bodies"], arguments["fixed"]
    entering, gone = mapping_of(add, "add", "bodies"), names_of(remove, "remove")
    for name in gone:
        if name not in bodies:
            hint = did_you_mean(str(name), bodies)
            raise StandoffError(
                f"remove: the world has no body {shown(name)}.{hint}", "remove", name
            )
    stay = {name: body for name, body in bodies.items() if name not in gone}
    for name in entering:
        if name in stay:
            raise StandoffError(f"add: the world has a body {shown(name)} already.", "add", name)
    left = {name: pose for name, pose in fixed.items() if name not in gone}
    return {
        **arguments,
        **given_without(given, gone)._asdict(),
        "bodies": stay | entering,
        "fixed": left,
    }


def given_without(given: PairRules, gone: Collection[str]) -> PairRules:
    """What the user says of pairs, without the bodies that are gone and the groups of these
    alone."""
    left = {name: [x for x in members if x not in gone] for name, members in given.groups.items()}
    out = {*gone, *(name for name, members in left.items() if not members)}

    def stays(pair: Iterable[str]) -> bool:
        return out.isdisjoint(pair)

    return PairRules(
        {name: members for name, members in left.items() if members},
        tuple(filter(stays, given.ignore)),
        None if given.only is None else tuple(filter(stays, given.only)),
        {child: parent for child, parent in given.parents.items() if stays((child, parent))},
        {pair: margin for pair, margin in given.margins.items() if stays(pair)},
    )


def carried_poses(world: Model, old: Model, before: WorldState, poses: Any) -> GivenPoses:
    """The poses of a world's bodies: those given, and else where another world's state has them.

    Raises TypeError, ValueError: no mapping; a body that enters has no pose; a pose of no body of
    the world that moves.
    """
    given = {} if poses is None else poses
    if not isinstance(given, Mapping):
        raise StandoffTypeError(
            f"poses = {shown(poses)}: give a mapping of names to poses, of the bodies that enter.",
            "poses",
            poses,
        )
    for name in given:
        if name not in world.moving:
            raise StandoffError(
                f"poses has {shown(name)}, which is no body of the world that moves."
                f"{did_you_mean(str(name), world.moving)}",
                "poses",
                name,
            )
    entering = [name for name in world.moving if name in given or name not in old.names.bodies]
    read = read_poses_of({x: given[x] for x in entering if x in given}, entering, world.planar)
    matrices = np.empty((len(world.moving), 4, 4))
    of_given = dict(zip(entering, read.matrices, strict=True))
    for row, name in zip(matrices, world.moving, strict=True):
        row[:] = of_given[name] if name in of_given else before.poses[old.names.bodies[name]]
    return GivenPoses(world.all_poses(matrices), read.repaired)


def carried_pieces(world: Model, old: Model) -> Ints:
    """Of each piece of an old world its number in the new one; -1 where its body, the same object,
    is not there under its name."""
    found = np.full(len(old.search.pieces.owners), -1, dtype=np.int64)
    first, before = world.search.pieces.first, old.search.pieces.first
    for k, (name, body) in enumerate(old.listed):
        at = world.names.bodies.get(name, -1)
        if at >= 0 and world.listed[at][1] is body:
            count = before[k + 1] - before[k]
            found[before[k] : before[k + 1]] = first[at] + np.arange(count)
    return found


def carried_rows(n: int, before: WorldState, numbers: Ints) -> Array:
    """Where the n pieces of a new world were in an old one's state; nan where they are new."""
    placed = empty_placed(n).placed
    both = numbers >= 0
    placed[numbers[both]] = before.placed[both]
    return placed


def carried_table(
    world: Model, before: WorldState, numbers: Ints, keeps_rows: bool
) -> tuple[PairTable, KeptSolids]:
    """What an old state knows of the pairs that a new world has too.

    The answer of a pair is kept where `keeps_rows`, or one body is a solid, and its bodies stand in
    the same order; else its bounds alone.
    """
    search = world.search
    pieces, rules = search.pieces, search.rules
    a, b = numbers[before.ints[:, W.I_A]], numbers[before.ints[:, W.I_B]]
    both = np.flatnonzero((a >= 0) & (b >= 0))
    both = both[rules.counting(pieces.owners[a[both]], pieces.owners[b[both]])]
    a, b = a[both], b[both]
    turned = pieces.owners[a] > pieces.owners[b]
    a, b = np.where(turned, b, a), np.where(turned, a, b)
    i, j = pieces.owners[a], pieces.owners[b]
    number = i * len(world.listed) + j
    within = (a - pieces.first[i]) * world.most + b - pieces.first[j]
    ints, known = before.ints[both], before.known[both]
    old_keys = np.where(turned, -1, ints[:, W.I_KEY]).tolist()
    ints[:, W.I_KEY] = number * world.most**2 + within
    ints[:, W.I_A], ints[:, W.I_B] = a, b
    known[:, W.C_HORIZON] = np.maximum(search.within, rules.margins_of(number))
    ints[turned | (not keeps_rows), W.I_ROW] = -1
    order = np.argsort(ints[:, W.I_KEY], kind="stable")
    keys = dict(zip(old_keys, ints[:, W.I_KEY].tolist(), strict=True))
    found, fronts = before.solids.pieces, before.solids.fronts
    kept = KeptSolids(
        {keys[key]: found[key] for key in keys.keys() & found.keys()},
        {},
        {keys[key]: fronts[key] for key in keys.keys() & fronts.keys()},
    )
    return PairTable(ints[order], known[order]), kept
