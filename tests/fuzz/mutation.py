"""Mutations of plain data (tables, lists, numbers, texts) and of the bytes of a file."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Iterator
from random import Random
from typing import Any

WILD = (
    0.0, -0.0, 1.0, -1.0, 2.0, 0.5, 1e-6, 1e6, 1e-9, 1e9, 1e-12, 1e12, 1e-15, 1e15, 1e-30, 1e30,
    1e-50, 1e50, 1e-99, 1e99, 1e100, 1e101, 1e-155, 1e155, 1e-200, 1e200, 5e-324, 2.3e-308, 1.8e308,
    math.nan, math.inf, -math.inf, math.pi, math.tau, -math.pi, 0, 1, -1, 2, 3, 10, 63, 64, 65, 255,
    2**31, 2**53 + 1, 2**63, -(2**63) - 1, 10**400,
)  # fmt: skip
"""Numbers at which readers and geometry go wrong: ends of ranges, units, roundoff, integers."""

NUDGES = (1.0 + 2.3e-16, 1.0 - 1.2e-16, 1.0 + 1e-12, 1.0 + 1e-9, 1.0 - 1e-6, 1.01, 0.9, -1.0, 2.0)
"""Factors that make a number nearly another, or its mirror image."""

TEXTS = (
    "", " ", "a", "nan", "inf", "1", "1.0", "true", "None", "λ", "\u202e", "\x00", "\ud7ff", "🜁",
    "..", "/", "C:\\", "a" * 300, "%s%n", "u", "v", "t", "1/0", "0/0", "u/(u-u)", "1/u", "9**9**9",
    "exp(u)", "exp(exp(9))", "sqrt(-1)", "sqrt(u)", "log(0)", "tan(u*9)", "u**0.5", "abs(u)",
    "2**-u", "(((u)))", "1e999", "0x10", "u u", "import os", "__import__('os')", "u.real",
    "lambda: 0", "u if v else 1", "[u]", "cos(u", "-" * 200 + "u", "(" * 120 + "u" + ")" * 120,
    "pi", "E", "zoo", "oo", "I", "nan*u",
)  # fmt: skip
"""Texts that readers and the formula parser might take for something else."""

OTHER_TYPES: tuple[Any, ...] = (
    True, False, "1", "text", [], {}, [1.0], [[]], [None], {"a": 1.0}, 1, 1.5, None,
)  # fmt: skip

Place = tuple[Any, Any]
"""A container and the key or index in it."""


def places(tree: Any) -> Iterator[Place]:
    """Yield every place of a tree: container and key."""
    if isinstance(tree, dict | list):
        keys = list(tree) if isinstance(tree, dict) else range(len(tree))
        for key in keys:
            yield tree, key
            yield from places(tree[key])


def is_number(value: Any) -> bool:
    """Tell numbers from truth values, which are whole numbers to Python."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def _chosen(tree: Any, random: Random, fits: Callable[[Any], bool]) -> Place | None:
    found = [place for place in places(tree) if fits(place[0][place[1]])]
    return random.choice(found) if found else None


def _wild_number(tree: Any, random: Random, other: Any) -> None:
    place = _chosen(tree, random, is_number)
    if place:
        place[0][place[1]] = random.choice(WILD)


def _nudge(tree: Any, random: Random, other: Any) -> None:
    place = _chosen(tree, random, lambda x: is_number(x) and abs(x) < 1e300)
    if place:
        place[0][place[1]] = place[0][place[1]] * random.choice(NUDGES)


def _same_number(tree: Any, random: Random, other: Any) -> None:
    source, place = _chosen(tree, random, is_number), _chosen(tree, random, is_number)
    if source and place:
        place[0][place[1]] = source[0][source[1]]


def _other_unit(tree: Any, random: Random, other: Any) -> None:
    factor = random.choice((1e-150, 1e-60, 1e-12, 1e-6, 1e-3, 1e3, 1e6, 1e12, 1e60, 1e150))
    for box, key in list(places(tree)):
        if isinstance(box[key], float):
            box[key] *= factor


def _flatten(tree: Any, random: Random, other: Any) -> None:
    """Set one coordinate of every point of a list to the same number, or the points to one."""
    place = _chosen(tree, random, lambda x: isinstance(x, list) and len(x) > 1)
    if place is None:
        return
    items = place[0][place[1]]
    if all(isinstance(item, list) and item for item in items):
        axis, value = random.randrange(3), random.choice((0.0, 1.0, 1e-13, -1e-9))
        for item in items:
            if axis < len(item) and is_number(item[axis]):
                item[axis] = item[axis] * value
    else:
        place[0][place[1]] = [items[0]] * len(items)


def _other_type(tree: Any, random: Random, other: Any) -> None:
    place = _chosen(tree, random, lambda x: True)
    if place:
        place[0][place[1]] = copy.deepcopy(random.choice(OTHER_TYPES))


def _text(tree: Any, random: Random, other: Any) -> None:
    place = _chosen(tree, random, lambda x: isinstance(x, str))
    if place:
        value = place[0][place[1]]
        cut = random.randrange(len(value) + 1)
        changed = value[:cut] + random.choice(TEXTS) + value[cut + random.randrange(3) :]
        place[0][place[1]] = random.choice((random.choice(TEXTS), changed))


def _drop(tree: Any, random: Random, other: Any) -> None:
    place = _chosen(tree, random, lambda x: True)
    if place:
        del place[0][place[1]]


def _repeat(tree: Any, random: Random, other: Any) -> None:
    place = _chosen(tree, random, lambda x: isinstance(x, list) and len(x) > 0)
    if place:
        items = place[0][place[1]]
        item = copy.deepcopy(random.choice(items))
        items.insert(random.randrange(len(items) + 1), item)


def _swap(tree: Any, random: Random, other: Any) -> None:
    place = _chosen(tree, random, lambda x: isinstance(x, list) and len(x) > 1)
    if place:
        items = place[0][place[1]]
        i, j = random.randrange(len(items)), random.randrange(len(items))
        items[i], items[j] = items[j], items[i]


def _rename(tree: Any, random: Random, other: Any) -> None:
    place = _chosen(tree, random, lambda x: isinstance(x, dict) and len(x) > 0)
    if place:
        table = place[0][place[1]]
        key = random.choice(list(table))
        table[random.choice((key[::-1], key + "s", "", "λ", "a.b"))] = table.pop(key)


def _transplant(tree: Any, random: Random, other: Any) -> None:
    """Put a piece of another tree in place of one of this, of the same type if there is one."""
    place = _chosen(tree, random, lambda x: True)
    if place is None:
        return
    kind = type(place[0][place[1]])
    source = _chosen(other, random, lambda x: type(x) is kind) or _chosen(
        other, random, lambda x: True
    )
    if source:
        place[0][place[1]] = copy.deepcopy(source[0][source[1]])


def _merge(tree: Any, random: Random, other: Any) -> None:
    """Add a key that a table of the other tree has."""
    place = _chosen(tree, random, lambda x: isinstance(x, dict))
    source = _chosen(other, random, lambda x: True)
    if place and source:
        place[0][place[1]][str(source[1])] = copy.deepcopy(source[0][source[1]])


def _nest(tree: Any, random: Random, other: Any) -> None:
    place = _chosen(tree, random, lambda x: True)
    if place:
        value = place[0][place[1]]
        for _ in range(random.choice((1, 2, 90))):
            value = [value] if random.random() < 0.8 else {"a": value}
        place[0][place[1]] = value


MUTATIONS: tuple[Callable[[Any, Random, Any], None], ...] = (
    *([_wild_number] * 5), *([_nudge] * 4), *([_same_number] * 3), *([_flatten] * 2),
    *([_transplant] * 3), _other_unit, _other_type, _text, _drop, _repeat, _swap, _rename, _merge,
    _nest,
)  # fmt: skip
"""Each as often as it is drawn; numbers most, since most of the geometry is behind valid tables."""


def mutated(tree: Any, random: Random, other: Any) -> Any:
    """Return a changed copy; `other` lends pieces."""
    result = copy.deepcopy(tree)
    for _ in range(random.choice((1, 1, 1, 2, 3, 5))):
        random.choice(MUTATIONS)(result, random, other)
    return result


def damaged(content: bytes, random: Random) -> bytes:
    """Return the bytes of a file cut off, or with some lost, doubled, flipped or made up."""
    kind = random.randrange(6)
    i, j = sorted(random.randrange(len(content) + 1) for _ in range(2))
    if kind == 0:
        return content[:i]
    if kind == 1:
        return content[:i] + content[j:]
    if kind == 2:
        return content[:j] + content[i:]
    if kind == 3:
        return content[:i] + random.randbytes(random.randrange(1, 9)) + content[i:]
    if kind == 4:
        return content[:i] + random.choice(TEXTS).encode() + content[i:]
    flipped = bytearray(content)
    for _ in range(random.randrange(1, 9)):
        if flipped:
            flipped[random.randrange(len(flipped))] = random.randrange(256)
    return bytes(flipped)
