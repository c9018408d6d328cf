"""From patches to the vertices, edges and faces of a body."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from standoff.bodies.proofs import PatchProof
from standoff.bodies.sewing.corners import SewnOutline, Stretch, outline
from standoff.bodies.sewing.correspondence import Correspondence, correspond, isoline
from standoff.bodies.sewing.patches import SewnPatch, check_patches, cut_patches, grid_points
from standoff.bodies.sewing.shell import check_shells, outward_senses
from standoff.bodies.sewing.sides import SENSES, gap
from standoff.bodies.tolerances import MAX_SPREAD, SEWING_TOLERANCE, WIDEST_SEAM
from standoff.bodies.topology import Apex, Edge, Face
from standoff.checks.numbers import magnitude
from standoff.checks.real_numbers import shown
from standoff.errors import BodyError
from standoff.geometry.pcurves import Pcurve
from standoff.geometry.surface_curves import SurfaceCurve
from standoff.geometry.surfaces import Surface
from standoff.typing import Array
from standoff.wording import counted

# A suggested tolerance is this much larger than the gap that was found at samples.
ROOM = 1.02


@dataclass(frozen=True, eq=False)
class Sewn:
    """A body's parts as they were sewn.

    size : diagonal of the patches' box, length.
    tolerance : the distance within which sides and corners were joined, length.
    residual : the greatest distance between joined points, length.
    senses, labels, proofs : for every face, +1 if x_u cross x_v points outward, else -1; the patch
        that it is or was cut from; its convexity.
    """

    vertices: Array
    edges: list[Edge]
    faces: list[Face]
    notes: list[str]
    size: float
    tolerance: float
    residual: float
    senses: list[int]
    labels: list[str]
    proofs: list[PatchProof]


def sew(patches: Sequence[Any], tolerance: float | None = None, *, several: bool = False) -> Sewn:
    """Join patches along their sides into a closed shell that faces outward.

    Raises BodyError: sides that match none or several, two shells, no volume; the message names the
    patches.

    Parameters
    ----------
    patches : surfaces with a finite domain.
    tolerance : how far joined sides may be apart, length; None: SEWING_TOLERANCE of the size.
    several : they may close several shells, each of which is made to face outward.
    """
    given: Any = patches
    no_list = isinstance(given, np.ndarray) and given.ndim == 0
    if no_list or isinstance(patches, Surface) or not isinstance(patches, Iterable):
        raise BodyError(
            f"patches = {shown(patches)}: give a sequence of surfaces that close a shell.",
            "patches",
            patches,
        )
    patches = list(patches)
    check_patches(patches)
    size = _size(patches)
    tolerance = SEWING_TOLERANCE * size if tolerance is None else magnitude(tolerance, "tolerance")
    if tolerance >= 0.1 * size:
        raise BodyError(
            f"tolerance = {tolerance:.3g} is not small compared to the patches' size {size:.3g}.",
            "tolerance",
            tolerance,
        )
    cut, notes = cut_patches(patches, tolerance)
    try:
        return _sewn(cut, notes, size, tolerance, several)
    except OpenShell as shell:
        raise _refusal(shell, patches, size, tolerance) from None


def _sewn(
    cut: list[SewnPatch], notes: list[str], size: float, tolerance: float, several: bool = False
) -> Sewn:
    shape = outline(cut, tolerance)
    pairs = match([s for row in shape.stretches for s in row], tolerance)
    shells = check_shells(cut, shape, pairs, several)
    found = [_joined(a, b, size, tolerance) for a, b in pairs]
    sign, turned = outward_senses(cut, pairs, [c.sense for c in found], shells, tolerance)
    edges = [
        Edge(
            SurfaceCurve(cut[a.patch].surface, isoline(a.side), a.side.first, a.side.last),
            a.first,
            a.last,
        )
        for a, _ in pairs
    ]
    faces = _faces(cut, shape, pairs, found, sign)
    residual = max([shape.spread, *(c.residual for c in found)])
    return Sewn(
        shape.vertices,
        edges,
        faces,
        notes + turned,
        size,
        tolerance,
        residual,
        sign,
        [patch.label for patch in cut],
        [patch.proof for patch in cut],
    )


def _refusal(
    shell: OpenShell, patches: Sequence[Surface], size: float, tolerance: float
) -> BodyError:
    """An open shell in one sentence, with the tolerance that would close it, if any."""
    wide = _closing(shell, patches, size)
    if not shell.gaps:
        return BodyError(
            f"The shell is open: only {shell.sides[0]} matches no side; a patch is missing."
        )
    cure = (
        ", and a greater one would not help: a patch is missing or out of place"
        if wide is None
        else f"; tolerance={wide:g} would join them"
    )
    return BodyError(
        f"The shell is open: {shell.told()}, more than tolerance={tolerance:.3g} allows{cure}.",
        "tolerance",
        tolerance,
    )


def _closing(shell: OpenShell, patches: Sequence[Surface], size: float) -> float | None:
    """A tolerance with which sewing the patches was tried and succeeds; None if none was found."""
    widest = max((gap.apart for gap in shell.gaps), default=np.inf)
    for times in (1.0, 2.0, 4.0):  # corners may be further apart than the sides that end in them
        wide = _rounded_up(times * widest)
        if not wide <= WIDEST_SEAM * size:
            return None
        try:
            _sewn(*cut_patches(patches, wide), size, wide)
        except (OpenShell, BodyError):
            continue
        return wide
    return None


def _rounded_up(length: float) -> float:
    """A length, slightly enlarged and rounded up to two digits."""
    if not np.isfinite(length):
        return length
    unit = 10.0 ** (np.floor(np.log10(ROOM * length)) - 1.0)
    return float(f"{np.ceil(ROOM * length / unit) * unit:.3g}")


def _joined(one: Stretch, other: Stretch, size: float, tolerance: float) -> Correspondence:
    found = correspond(one, other, size)
    if found.residual > MAX_SPREAD * tolerance:
        raise BodyError(
            f"{one.label} and {other.label} are {found.residual:.3g} apart between their ends, "
            f"more than tolerance={tolerance:.3g} allows: make them the same curve, or give "
            f"tolerance={_rounded_up(found.residual):g}.",
            "tolerance",
            tolerance,
        )
    return found


def _size(patches: Sequence[Surface]) -> float:
    points = np.concatenate([grid_points(surface).reshape(-1, 3) for surface in patches])
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    if not (np.isfinite(size) and size > 0.0):
        raise BodyError(
            f"The patches' size is {size}: they have no extent or no finite points.",
            "patches",
            patches,
        )
    return size


def _faces(
    patches: Sequence[SewnPatch],
    shape: SewnOutline,
    pairs: Sequence[tuple[Stretch, Stretch]],
    found: Sequence[Correspondence],
    sign: Sequence[int],
) -> list[Face]:
    uses: list[list[tuple[int, int, Pcurve]]] = [[] for _ in patches]
    for j, ((a, b), c) in enumerate(zip(pairs, found, strict=True)):
        sense = SENSES[a.side.name] * sign[a.patch]
        uses[a.patch].append((j, sense, isoline(a.side)))
        sense = SENSES[b.side.name] * c.sense * sign[b.patch]
        uses[b.patch].append((j, sense, c.pcurve))
    faces = []
    for p, patch in enumerate(patches):
        apexes = tuple(
            Apex(vertex, side.level, side.first, side.last, side=side.name)
            for side, vertex in shape.collapsed[p]
        )
        loop = tuple((j, sense) for j, sense, _ in uses[p])
        pcurves = tuple(pcurve for _, _, pcurve in uses[p])
        faces.append(Face((patch.surface,), loop, apexes, pcurves))
    return faces


# Which stretches of sides lie along each other: each along exactly one other.

# Greatest number of gaps that a message names.
MAX_NAMED = 3


class SideGap(NamedTuple):
    """Two open sides, at least one of them nearest to the other, and their distance, length."""

    one: str
    other: str
    apart: float


class OpenShell(Exception):
    """Sides that lie along no other.

    Attributes
    ----------
    sides : list of str
    gaps : list of SideGap
        From each to the nearest open side; none if only one side is open.
    """

    def __init__(self, sides: list[str], gaps: list[SideGap]) -> None:
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
    gaps = [
        SideGap(open_sides[a].label, open_sides[b].label, miss) for (a, b), miss in apart.items()
    ]
    return OpenShell([side.label for side in open_sides], gaps)


def _neighbours(stretch: Stretch, tree: scipy.spatial.KDTree, owner: NDArray[np.intp]) -> set[int]:
    """Open sides with points among the nearest to those of a stretch."""
    count = min(len(owner), 5 * len(stretch.side.polyline))
    return {int(owner[m]) for x in stretch.side.probes for m in tree.query(x, k=count)[1]}


def _apart(one: Stretch, other: Stretch) -> float:
    """The greatest distance between points of one stretch, including its ends, and another."""
    points = [*one.side.probes, one.side.polyline[0], one.side.polyline[-1]]
    return max(other.side.nearest(x)[1] for x in points)
