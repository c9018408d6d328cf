"""The library grows by ideas, not by copies: the counts of `budgets` stay within those declared."""

from __future__ import annotations

import pytest

import budgets

TEXTS = budgets.sources()
DECLARED = budgets.budgets()
COUNTED = {"lines": budgets.lines(TEXTS), "counts": budgets.counted(TEXTS)}
IDLE = 0.02
"""Part of a count by which its budget may be above it: savings are not kept for other changes."""

LISTED = {
    "public-names": budgets.public_names,
    "repeated-classes": budgets.repeated_classes,
    "short-for-one": budgets.short_for_one,
    "asks-for-kind": budgets.asks_for_kind,
}


@pytest.mark.parametrize("kind", COUNTED)
def test_each_count_has_a_budget(kind: str) -> None:
    assert DECLARED[kind].keys() == COUNTED[kind].keys()


@pytest.mark.parametrize(
    ("kind", "name"), [(kind, name) for kind in COUNTED for name in COUNTED[kind]]
)
def test_counts_stay_within_their_budgets(kind: str, name: str) -> None:
    count, budget = COUNTED[kind][name], DECLARED[kind][name]
    listed = LISTED[name](TEXTS) if name in LISTED else ""
    assert count <= budget, f"{name}: {count} of {budget}. Take away what this replaces. {listed}"
    assert budget <= count * (1 + IDLE) + 1, f"lower the budget of {name} to {count}"


MODULES = {
    "standoff": 'from standoff.rooms import Room\n__all__ = ["Room"]\n',
    "standoff.rooms": 'from standoff.rooms.room import Room\n__all__ = ["Door", "Room"]\n',
    "standoff.rooms.room": "from standoff.rooms import wall\nclass Room: ...\n",
    "standoff.rooms.wall": "class Door: ...\n" + "x = 1\n" * budgets.SHORT,
    "standoff.door": "class Door:\n    class Room: ...\n",
    "standoff.key": "def f(x):\n    import standoff.door\n    return is_solid(x)\n",
    "standoff.lock": (
        "isinstance(a, so.Solid)\nisinstance(a, float | Body)\nisinstance(a, float)\n"
        "hasattr(a, 'b')\ngetattr(a, 'b')\ngetattr(a, 'b', None)\n"
    ),
}


def test_what_is_counted() -> None:
    lengths = budgets.lines(MODULES)
    assert lengths == {".": 13, "rooms": 5 + budgets.SHORT, "total": 18 + budgets.SHORT}
    assert budgets.public_names(MODULES) == [
        "standoff.Room",
        "standoff.rooms.Door",
        "standoff.rooms.Room",
    ]
    assert budgets.repeated_classes(MODULES) == ["Door"]
    # the walls are too many lines, and a package is no part of another module
    assert budgets.short_for_one(MODULES) == ["standoff.door", "standoff.rooms.room"]
    assert budgets.asks_for_kind(MODULES) == {"standoff.key": 1, "standoff.lock": 4}
