"""The pairs of convex pieces that a proof watches, and the motions between the two of each.

The *chain* of a pair leads from B to A: up from B's link to the last link that carries both, and
down to A's. Only the motions on it move the two against each other.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.world import arrays as W
from standoff.robots.motions import WORLD, LinkFrames, Motions
from standoff.typing import Array, Ints
from standoff.world.model import Model


class Cores(NamedTuple):
    """The boxes around the cores of the pieces, in the frames of the motions that carry them.

    Attributes
    ----------
    motions : (n,) array of int
        -1 for a piece that stands still.
    centres : (n, 3) array
        Of a half-space a point of its boundary.
    axes : (n, 3, 3) array
        Unit vectors along the box's sides, as columns.
    half : (n, 3) array
        Half its sides; 0 for a half-space.
    radius : (n,) array
        Swept radius, and slack of the surfaces.
    planes : (n,) array of bool
    normals : (n, 3) array
        Outward, of half-spaces.
    """

    motions: Ints
    centres: Array
    axes: Array
    half: Array
    radius: Array
    planes: NDArray[np.bool_]
    normals: Array


class PlacedCores(NamedTuple):
    """Cores in the world, each at one of several configurations.

    Attributes
    ----------
    centres : (k, 3) array
    axes : (k, 3, 3) array
    """

    centres: Array
    axes: Array


class LinkChains(NamedTuple):
    """The chains of the pairs of links, filled up to the length of the longest.

    Attributes
    ----------
    motions : (n, k) array of int
        From B to A; -1 behind the end.
    frames : (n, k + 1) array of int
        What carries the frame before each motion and behind the last; -1 for the world.
    """

    motions: Ints
    frames: Ints


class Watched(NamedTuple):
    """Pairs of pieces, their chains, and what is needed of a robot's tree.

    Attributes
    ----------
    motions : Motions
    cores : Cores
    a, b : (n,) arrays of int
        Pieces of each pair.
    bodies : (n, 2) array of int
        Numbers of the bodies that they belong to, in the world's order.
    chains : LinkChains
    chain : (n,) array of int
        The chain of each pair.
    length : float
        What the robot's lengths add up to: no point of it is farther from the world's origin while
        its slides stand at 0.
    """

    motions: Motions
    cores: Cores
    a: Ints
    b: Ints
    bodies: Ints
    chains: LinkChains
    chain: Ints
    length: float

    def see(self, frames: LinkFrames, at: Ints, pieces: Ints) -> PlacedCores:
        """Cores of pieces in the world, each in the frames of one configuration."""
        carrier = self.cores.motions[pieces]
        rotations, origins = frames.rotations[at, carrier], frames.origins[at, carrier]
        centres = origins + turned(rotations, self.cores.centres[pieces])
        return PlacedCores(centres, rotations @ self.cores.axes[pieces])


def watched_of(world: Model, motions: Motions, carriers: Ints, placements: Array) -> Watched:
    """The pairs that count in a world whose bodies are carried by a robot's links.

    Parameters
    ----------
    world : Model
    motions : Motions
    carriers : (n,) array of int
        The motion that carries each body of the world, in its order; -1 for those that are fixed.
    placements : (n, 4, 4) array
        Of each body in the frame of that motion.
    """
    cores = _cores(world, carriers, placements)
    bodies, a, b = _pairs(world)
    links = np.stack([cores.motions[a], cores.motions[b]], axis=1).reshape(-1, 2)
    unique, chain = np.unique(links, axis=0, return_inverse=True)
    chains = _chains(motions, unique)
    lengths = [float(np.linalg.norm(motions.placements[:, :3, 3], axis=1).sum())]
    lengths.append(float(np.abs(cores.centres).max(initial=0.0)) * 2.0)
    lengths.append(float((cores.half.sum(axis=1) + cores.radius).max(initial=0.0)))
    return Watched(motions, cores, a, b, bodies, chains, chain.reshape(-1), sum(lengths))


def _cores(world: Model, carriers: Ints, placements: Array) -> Cores:
    pieces = world.search.pieces
    facts, owners = pieces.facts, pieces.owners
    inner = facts[:, W.F_ROTATION : W.F_SHIFT].reshape(-1, 3, 3)
    outer, shift = placements[owners, :3, :3], placements[owners, :3, 3]
    axes = outer @ inner
    origins = shift + turned(outer, facts[:, W.F_SHIFT : W.F_SHIFT + 3])
    planes = pieces.planes != 0
    normals = facts[:, W.F_NORMAL : W.F_NORMAL + 3]
    points = np.where(
        planes[:, None],
        normals * facts[:, W.F_OFFSET, None],
        facts[:, W.F_CENTRE : W.F_CENTRE + 3],
    )
    return Cores(
        carriers[owners],
        origins + turned(axes, points),
        axes,
        facts[:, W.F_HALF : W.F_HALF + 3],
        facts[:, W.F_RADIUS],
        planes,
        turned(axes, normals),
    )


def _pairs(world: Model) -> tuple[Ints, Ints, Ints]:
    """(numbers of the bodies, piece of A, piece of B) of all pairs of pieces that count."""
    pieces, rules = world.search.pieces, world.search.rules
    n = len(world.listed)
    i, j = np.triu_indices(n, 1)
    count = (rules.meets[rules.kinds[i], rules.kinds[j]] != 0) & ~np.isin(i * n + j, rules.left_out)
    i, j = i[count], j[count]
    sizes = np.diff(pieces.first[:-1])
    of_b = sizes[j]
    each = sizes[i] * of_b
    row = np.repeat(np.arange(len(i)), each)
    within = np.arange(len(row)) - np.repeat(np.cumsum(each) - each, each)
    a = pieces.first[i][row] + within // of_b[row]
    b = pieces.first[j][row] + within % of_b[row]
    return np.stack([i[row], j[row]], axis=1), a, b


def _chains(motions: Motions, links: Ints) -> LinkChains:
    """Of pairs (link of A, link of B)."""
    ways, frames = [], []
    for a, b in links.tolist():
        to_a, to_b = _carriers(motions, a), _carriers(motions, b)
        shared = len(set(to_a) & set(to_b))
        down = to_a[: len(to_a) - shared][::-1]
        up = to_b[: len(to_b) - shared]
        ways.append([*up, *down])
        frames.append([b, *(int(motions.parents[m]) for m in up), *down])
    most = max((len(way) for way in ways), default=0)
    of_motions = np.full((len(ways), most), WORLD, dtype=np.int64)
    of_frames = np.full((len(ways), most + 1), WORLD, dtype=np.int64)
    for k, (way, carried) in enumerate(zip(ways, frames, strict=True)):
        of_motions[k, : len(way)] = way
        of_frames[k, : len(carried)] = carried
        of_frames[k, len(carried) :] = carried[-1]
    return LinkChains(of_motions, of_frames)


def _carriers(motions: Motions, link: int) -> list[int]:
    """A link's own motion and those that carry it, up to the world."""
    found = []
    while link >= 0:
        found.append(link)
        link = int(motions.parents[link])
    return found


def turned(rotations: Array, vectors: Array) -> Array:
    """Rotations (..., 3, 3) of vectors (..., 3)."""
    found: Array = np.einsum("...ij,...j->...i", rotations, vectors)
    return found
