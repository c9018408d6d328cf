"""Entities of DXF files without the markers of their subclasses, which older programs leave out."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

MARKED = {
    "SPLINE": "AcDbSpline",
    "LWPOLYLINE": "AcDbPolyline",
    "MTEXT": "AcDbMText",
    "LEADER": "AcDbLeader",
    "MLINE": "AcDbMLine",
    "MULTILEADER": "AcDbMLeader",
    "MESH": "AcDbSubMesh",
}
"""The kinds of entities that ezdxf refuses without their marker; of others it needs none."""

OF_ENTITIES = frozenset(
    {6, 8, 48, 60, 62, 67, 92, 102, 160, 284, 310, 330, 347, 348, 360, 370, 380, 390}
    | {410, 420, 430, 440}
)
"""Group codes that entities of all kinds have."""

Group = tuple[str, str]

OF_ALL: Group = ("100", "AcDbEntity")
"""The marker before those."""


def with_markers(text: str) -> tuple[str, str]:
    """A drawing's text with the markers that it lacks, and what was added, "" if nothing.

    Parameters
    ----------
    text : str
        Of an ASCII file: a line with a group's code, one with its value.
    """
    lines = text.split("\n")
    added: Counter[str] = Counter()
    found: list[Group] = []
    for entity in _entities([*zip(lines[::2], lines[1::2], strict=False)]):
        kind = entity[0][1].strip()
        known = {value.strip() for code, value in entity if int(code) == 100}
        marker = MARKED.get(kind)
        if marker is None or marker in known:
            found += entity
            continue
        added[f"{kind} without {marker}"] += 1
        others = [group for group in entity if int(group[0]) != 100]
        found += sorted([*others, OF_ALL, ("100", marker)], key=_rank)
    told = ", ".join(f"{count} {what}" for what, count in added.items())
    return "\n".join(line for group in found for line in group) + "\n", told


def _rank(group: Group) -> int:
    """Where in an entity a group belongs: before its markers, to all kinds, or to its own."""
    code = int(group[0])
    if code == 100:
        return 1 if group == OF_ALL else 3
    return 0 if code in (0, 5) else 2 if code in OF_ENTITIES else 4


def _entities(groups: list[Group]) -> Iterator[list[Group]]:
    """Runs of groups that each begin with one of code 0."""
    run: list[Group] = []
    for group in groups:
        if int(group[0]) == 0 and run:
            yield run
            run = []
        run.append(group)
    if run:
        yield run
