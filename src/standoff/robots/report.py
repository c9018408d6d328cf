"""What became of each geometry of a robot's model, and which pairs are watched."""

from __future__ import annotations

from collections import Counter
from typing import NamedTuple

from standoff.robots.obstacles import Obstacles
from standoff.wording import counted
from standoff.world import Compound
from standoff.world.shapes import Shape

EXACT, HULL, GIVEN, SKIPPED, UNSEEN = "exact", "hull", "given", "skipped", "does not collide"
"""What may become of a geometry: its exact shape, the hull of its mesh, a body that the user gave,
left out by the user, or left out since the model watches no pair of it."""

RIGID = "rigid to each other"
STILL = "both stand still"
NO_SUCH_PAIR = "no collision pair of the model"
"""Why a pair may not be watched; packages have reasons of their own beside these."""


class GeomReport(NamedTuple):
    """What became of one geometry.

    Attributes
    ----------
    name, link : str
    kind : str
        As the model calls it: "box", "mesh", ...
    became : "exact", "hull", "given", "skipped" or "does not collide"
    gap : float
        Of a hull: the greatest distance of its surface from the mesh that was found, length; 0 for
        exact shapes, nan where nothing was measured.
    """

    name: str
    link: str
    kind: str
    became: str
    gap: float


class RobotReport(NamedTuple):
    """A robot's geometries and pairs; ``print`` shows it as a table.

    Attributes
    ----------
    source : str
    joints : tuple of str
    geoms : tuple of GeomReport
        Of all geometries of the model, in its order, and of the obstacles.
    pairs : tuple of (str, str)
        Names of the geometries of all pairs that are watched.
    left_out : tuple of (str, str, str)
        Names of all pairs that are not watched, and why.
    overlapping : tuple of (str, str)
        Pairs that are watched and overlap at the model's own zero: no path through it is proven.
    notes : tuple of str
        What else should be known, such as joints that are not limited.
    """

    source: str
    joints: tuple[str, ...]
    geoms: tuple[GeomReport, ...]
    pairs: tuple[tuple[str, str], ...]
    left_out: tuple[tuple[str, str, str], ...]
    overlapping: tuple[tuple[str, str], ...]
    notes: tuple[str, ...]

    def __str__(self) -> str:
        tally = Counter(geom.became for geom in self.geoms)
        summary = ", ".join(f"{count} {became}" for became, count in tally.items())
        lines = [
            f"{self.source}: {counted(len(self.joints), 'joint')}, "
            f"{counted(len(self.geoms), 'geometry', 'geometries')} ({summary}), "
            f"{counted(len(self.pairs), 'pair')} watched, {len(self.left_out)} not"
        ]
        rows = [("geometry", "link", "kind", "became", "gap")]
        rows += [(g.name, g.link, g.kind, g.became, _gap(g)) for g in self.geoms]
        widths = [max(len(row[k]) for row in rows) for k in range(5)]
        lines += [
            "  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True)).rstrip()
            for row in rows
        ]
        reasons = Counter(_kind_of(reason) for *_, reason in self.left_out)
        lines += [f"not watched: {counted(n, 'pair')} {reason}" for reason, n in reasons.items()]
        lines += [f"overlap at the model's zero: {a} and {b}" for a, b in self.overlapping]
        return "\n".join([*lines, *(f"note: {note}" for note in self.notes)])


def of_obstacles(obstacles: Obstacles) -> tuple[GeomReport, ...]:
    """Rows of a robot's obstacles, which are as they were given."""
    return tuple(
        GeomReport(name, name, _kind(body), GIVEN, float("nan"))
        for name, (body, _) in obstacles.items()
    )


def _kind(body: Shape | Compound) -> str:
    return "compound" if isinstance(body, Compound) else str(body.name)


def _kind_of(reason: str) -> str:
    """A reason without the name that it ends with."""
    return reason.split(" '", maxsplit=1)[0]


def _gap(geom: GeomReport) -> str:
    if geom.became == HULL:
        return f"{geom.gap:.3g}"
    return ""
