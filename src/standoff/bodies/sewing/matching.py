"""Which stretches of sides lie along each other: each along exactly one other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from standoff.bodies.sewing.corners import Stretch
from standoff.bodies.sewing.sides import gap
from standoff.errors import BodyError
from standoff.wording import counted

# Greatest number of gaps that a message names.
MAX_NAMED = 3


class Gap(NamedTuple):
    """Two open sides, at least one of them nearest to the other, and their distance, length."""

    one: str
    other: str
    apart: float


class OpenShell(Exception):
    """Sides that lie along no other.

    Attributes
    ----------
    sides : list of str
    gaps : list of Gap
        From each to the nearest open side; none if only one side is open.
    """

    def __init__(self, sides: list[str], gaps: list[Gap]) -> None:
        super().__init__(sides, gaps)
        self.sides, self.gaps = sides, gaps

    def told(self) -> str:
        """The gaps in words."""
        named = [f"{g.one} and {g.other} are {g.apart:.2g} apart" for g in self.gaps[:MAX_NAMED]]
        more = len(self.gaps) - len(named)
        named += [f"{counted(more, 'more such gap')}"] if more else []
        return f"{', '.join(named[:-1])} and {named[-1]}" if len(named) > 1 else named[0]


def match(stretches: Sequence[Stretch], tolerance: float) -> list[tuple[Stretch, Stretch]]:
    """Pairs of stretches that lie along each other.

    Raises OpenShell: stretches that lie along no other. Raises BodyError: a stretch that lies along
    more than one.
    """
    groups: dict[tuple[int, int], list[int]] = {}
    for k, s in enumerate(stretches):
        groups.setdefault((min(s.first, s.last), max(s.first, s.last)), []).append(k)
    partners: list[list[int]] = [[] for _ in stretches]
    for group in groups.values():
        for a, b in _candidates(stretches, group, tolerance):
            if gap(stretches[a].side, stretches[b].side) <= tolerance:
                partners[a].append(b)
                partners[b].append(a)
    for k, found in enumerate(partners):
        if len(found) > 1:
            names = ", ".join(stretches[m].label for m in (k, *found))
            raise BodyError(
                f"{names} lie along one curve: an edge joins two patches. Remove patches given "
                f"twice, or give a smaller tolerance than {tolerance:.3g}.",
                "tolerance",
                tolerance,
            )
    loose = [k for k, found in enumerate(partners) if not found]
    if loose:
        raise _open_shell(stretches, loose)
    return [(stretches[k], stretches[found[0]]) for k, found in enumerate(partners) if k < found[0]]


def _candidates(
    stretches: Sequence[Stretch], group: list[int], tolerance: float
) -> list[tuple[int, int]]:
    """Pairs of a group whose middles are near each other's polylines."""
    if len(group) == 2:
        return [(group[0], group[1])]
    found = []
    middles = np.array([stretches[k].side.probes[3] for k in group])
    for i, a in enumerate(group):
        side = stretches[a].side
        reach = side.length / 8.0 + tolerance
        away = np.linalg.norm(side.polyline[:, None] - middles[None], axis=2).min(axis=0)
        found += [(a, group[j]) for j in range(i + 1, len(group)) if away[j] <= reach]
    return found


def _open_shell(stretches: Sequence[Stretch], loose: list[int]) -> OpenShell:
    """Every open side with the open side nearest to it, and their distance."""
    open_sides = [stretches[k] for k in loose]
    points = np.concatenate([s.side.polyline for s in open_sides])
    owner = np.repeat(np.arange(len(open_sides)), [len(s.side.polyline) for s in open_sides])
    tree = scipy.spatial.KDTree(points)
    apart: dict[tuple[int, int], float] = {}
    for k, stretch in enumerate(open_sides):
        near = _neighbours(stretch, tree, owner) - {k}
        near = near or set(range(len(open_sides))) - {k}
        misses = {m: _apart(stretch, open_sides[m]) for m in near}
        if misses:
            m = min(misses, key=lambda m: misses[m])
            pair = min(k, m), max(k, m)
            apart[pair] = max(apart.get(pair, 0.0), misses[m])
    gaps = [Gap(open_sides[a].label, open_sides[b].label, miss) for (a, b), miss in apart.items()]
    return OpenShell([side.label for side in open_sides], gaps)


def _neighbours(stretch: Stretch, tree: scipy.spatial.KDTree, owner: NDArray[np.intp]) -> set[int]:
    """Open sides with points among the nearest to those of a stretch."""
    count = min(len(owner), 5 * len(stretch.side.polyline))
    return {int(owner[m]) for x in stretch.side.probes for m in tree.query(x, k=count)[1]}


def _apart(one: Stretch, other: Stretch) -> float:
    """The greatest distance between points of one stretch, including its ends, and another."""
    points = [*one.side.probes, one.side.polyline[0], one.side.polyline[-1]]
    return max(other.side.nearest(x)[1] for x in points)
