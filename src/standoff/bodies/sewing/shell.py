"""Whether what was sewn is one closed shell, and which side is outside: senses of patches."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from standoff.bodies.sewing.corners import SewnOutline, Stretch
from standoff.bodies.sewing.patches import SewnPatch
from standoff.bodies.sewing.sides import SENSES
from standoff.bodies.tolerances import LEAST_THICKNESS
from standoff.errors import BodyError
from standoff.geometry.surfaces import Surface
from standoff.typing import Array

Pairs = Sequence[tuple[Stretch, Stretch]]
# Gauss points along u and v for the volume, of which only sign and order of magnitude are needed.
VOLUME_POINTS = 6
# Greatest number of a shell's patches that a message names.
MOST_NAMED = 6


def check_shells(
    patches: Sequence[SewnPatch], shape: SewnOutline, pairs: Pairs, several: bool
) -> list[list[int]]:
    """The patches of each shell. Raises BodyError for more than one shell unless `several`, and for
    patches that only touch at a vertex."""
    rows = np.array([(a.patch, b.patch) for a, b in pairs], dtype=np.intp).reshape(-1, 2)
    n = len(patches)
    graph = scipy.sparse.coo_matrix((np.ones(len(rows)), (rows[:, 0], rows[:, 1])), shape=(n, n))
    count, shell = scipy.sparse.csgraph.connected_components(graph, directed=False)
    shells: list[list[int]] = [np.flatnonzero(shell == s).tolist() for s in range(count)]
    if count > 1 and not several:
        names = [_names(patches, numbers) for numbers in shells]
        raise BodyError(
            f"{count} shells that share no side: {' | '.join(names[:3])}. Make a body of each."
        )
    _check_fans(patches, shape, pairs)
    return shells


def _names(patches: Sequence[SewnPatch], numbers: Sequence[int]) -> str:
    given = sorted({patches[k].given for k in numbers})
    dots = ", ..." if len(given) > MOST_NAMED else ""
    return "patches " + ", ".join(str(k) for k in given[:MOST_NAMED]) + dots


def _check_fans(patches: Sequence[SewnPatch], shape: SewnOutline, pairs: Pairs) -> None:
    """Check that the patches around every vertex form a single ring."""
    edge = {id(s): j for j, pair in enumerate(pairs) for s in pair}
    links: list[tuple[int, int]] = []
    place: dict[tuple[int, int], int] = {}  # (edge, vertex at its end) -> node
    for p in range(len(patches)):
        ring = _ring(shape, p)
        for k, (item, stop) in enumerate(ring):
            following = ring[(k + 1) % len(ring)][0]
            nodes = [place.setdefault((edge[id(s)], stop), len(place)) for s in (item, following)]
            links.append((nodes[0], nodes[1]))
    rows = np.array(links, dtype=np.intp)
    graph = scipy.sparse.coo_matrix(
        (np.ones(len(rows)), (rows[:, 0], rows[:, 1])), shape=(len(place),) * 2
    )
    _, fan = scipy.sparse.csgraph.connected_components(graph, directed=False)
    fans: dict[int, set[int]] = {}
    for (_, vertex), node in place.items():
        fans.setdefault(vertex, set()).add(int(fan[node]))
    for vertex, found in fans.items():
        if len(found) > 1:
            names = sorted(
                {s.label for row in shape.stretches for s in row if vertex in (s.first, s.last)}
            )
            raise BodyError(
                f"Patches touch only at the point {shape.vertices[vertex]}: {len(found)} fans "
                f"meet there ({', '.join(names)})."
            )


def _ring(shape: SewnOutline, patch: int) -> list[tuple[Stretch, int]]:
    """A patch's stretches counterclockwise in (u, v), each with the vertex where it ends."""
    ring: list[tuple[Stretch, int]] = []
    for number in range(4):
        row = [s for s in shape.stretches[patch] if s.number == number]
        sense = SENSES[row[0].side.name] if row else 1
        ring += [(s, s.last if sense > 0 else s.first) for s in row[::sense]]
    return ring


def outward_senses(
    patches: Sequence[SewnPatch],
    pairs: Pairs,
    senses: Sequence[int],
    shells: Sequence[Sequence[int]],
    tolerance: float,
) -> tuple[list[int], list[str]]:
    """+1 if x_u cross x_v of a patch points outward, else -1; and notes on those turned.

    senses : for every pair, +1 if the free parameters increase together.
    """
    neighbours: list[list[tuple[int, int]]] = [[] for _ in patches]
    for (a, b), along in zip(pairs, senses, strict=True):
        # the boundaries of two counterclockwise patches run in opposite directions along an edge
        relation = -SENSES[a.side.name] * SENSES[b.side.name] * along
        neighbours[a.patch].append((b.patch, relation))
        neighbours[b.patch].append((a.patch, relation))
    sign = [0] * len(patches)
    for shell in shells:
        _turn_shell(patches, shell, neighbours, sign, tolerance)
    turned = sorted({patches[p].given for p, s in enumerate(sign) if s < 0})
    return sign, [f"patch {k}: its x_u cross x_v points inward, turned outward" for k in turned]


def _turn_shell(
    patches: Sequence[SewnPatch],
    shell: Sequence[int],
    neighbours: Sequence[Sequence[tuple[int, int]]],
    sign: list[int],
    tolerance: float,
) -> None:
    """Set the signs of a shell's patches."""
    sign[shell[0]], waiting = 1, [shell[0]]
    while waiting:
        p = waiting.pop()
        for q, relation in neighbours[p]:
            if sign[q] == 0:
                sign[q] = relation * sign[p]
                waiting.append(q)
            elif sign[q] != relation * sign[p]:
                raise BodyError(
                    f"The shell has one side only (like a Moebius strip): {patches[p].label} "
                    f"and {patches[q].label} cannot both face outward."
                )
    volume, area = _volume([patches[p] for p in shell], [sign[p] for p in shell])
    if abs(volume) <= LEAST_THICKNESS * tolerance * area:
        raise BodyError(
            f"The patches enclose no volume: {abs(volume):.3g} at an area of {area:.3g}, "
            f"tolerance {tolerance:.3g}.",
            "tolerance",
            tolerance,
        )
    if volume < 0.0:
        for p in shell:
            sign[p] = -sign[p]


def _volume(patches: Sequence[SewnPatch], sign: Sequence[int]) -> tuple[float, float]:
    """(signed volume, area), by Gauss quadrature."""
    nodes, weights = np.polynomial.legendre.leggauss(VOLUME_POINTS)
    origin = _middle(patches[0].surface)
    spots = [(a, b) for a in nodes for b in nodes]
    cells = np.array([a * b for a in weights for b in weights])
    volume = area = 0.0
    for patch, s in zip(patches, sign, strict=True):
        u0, u1, v0, v1 = patch.surface.domain
        jets = np.array(
            [
                patch.surface.jet(0.5 * (u0 + u1 + a * (u1 - u0)), 0.5 * (v0 + v1 + b * (v1 - v0)))
                for a, b in spots
            ]
        )
        cell = np.cross(jets[:, 1], jets[:, 2]) * cells[:, None]
        scale = 0.25 * (u1 - u0) * (v1 - v0)
        volume += s * scale * float(np.einsum("ij,ij", jets[:, 0] - origin, cell)) / 3.0
        area += scale * float(np.linalg.norm(cell, axis=1).sum())
    return volume, area


def _middle(surface: Surface) -> Array:
    u0, u1, v0, v1 = surface.domain
    return surface.jet(0.5 * (u0 + u1), 0.5 * (v0 + v1))[0]
