"""From ``[pair]`` or ``[[pairs]]`` to the pairs that are tracked."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from standoff.scene.reader import SceneTable, shown
from standoff.scene.settings import TrackSettings, read_settings

PLAIN = "-_"
"""What a pair's name may have besides letters and digits: it becomes part of file names."""


@dataclass(frozen=True)
class PairOfScene:
    """Two bodies that are tracked together.

    Attributes
    ----------
    name : str
        Unique within the scene; letters, digits, ``-`` and ``_``.
    a, b : str
        Names of the bodies A and B; the normal points from A to B.
    settings : TrackSettings
        The scene's, with the pair's own values over them.
    """

    name: str
    a: str
    b: str
    settings: TrackSettings


def read_pairs(
    top: SceneTable, bodies: Sequence[str], compounds: Collection[str] = ()
) -> tuple[PairOfScene, ...]:
    """Return the pairs of a scene, at least one unless it has a world.

    Raises SceneError if neither or both are given, a body is unknown, a compound or paired with
    itself, two names are the same, or a pair's settings do not go together.

    Parameters
    ----------
    top : SceneTable
        The scene's top table, with ``pair`` or ``pairs``, or ``world``, and ``track``.
    bodies : sequence of str
        Names of the bodies.
    compounds : collection of str
        Those of several pieces: they are in no pair.
    """
    if "world" in top and "pair" not in top and "pairs" not in top:
        return ()
    track = (top.table("track"),) if "track" in top else ()
    if "pairs" not in top:
        table = top.table("pair")
        table.expect("a", "b")
        a, b = _bodies(table, bodies, compounds)
        return (PairOfScene("pair", a, b, read_settings(*track)),)
    if "pair" in top:
        raise top.error("is given together with [[pairs]]; write it as another [[pairs]]", "pair")
    pairs: list[PairOfScene] = []
    for table in top.tables("pairs"):
        settings = read_settings(table, *track, beside=("name", "a", "b"))
        a, b = _bodies(table, bodies, compounds)
        name = _name(table, f"{a}-{b}", pairs)
        pairs.append(PairOfScene(name, a, b, settings))
    return tuple(pairs)


def _bodies(
    table: SceneTable, bodies: Sequence[str], compounds: Collection[str]
) -> tuple[str, str]:
    a, b = (table.choice(key, bodies, noun="body") for key in ("a", "b"))
    for key, name in (("a", a), ("b", b)):
        if name in compounds:
            raise table.error(
                f"{shown(name)} has several pieces, or is placed by its file, and a pair is of two "
                "single bodies; write [world] in place of the pair",
                key,
            )
    if a == b:
        raise table.error(f"'{a}' is both a and b; name two different bodies")
    return a, b


def _name(table: SceneTable, usual: str, before: Sequence[PairOfScene]) -> str:
    name = table.text("name", usual)
    if not all(letter.isalnum() or letter in PLAIN for letter in name):
        raise table.error(
            f"{shown(name)} becomes part of file names: give a name of letters, digits, - and _",
            "name",
        )
    for number, pair in enumerate(before):
        # Some file systems treat names that differ only in case as the same.
        if pair.name.casefold() == name.casefold():
            raise table.error(
                f"two pairs are called '{name}', this one and pairs[{number}]; give each its own "
                "name, so that their results can be told apart",
                "name",
            )
    return name
