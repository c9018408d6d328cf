"""How far points lie above planes at most: the proof that faces bound the hull of points.

A body's certificate asks one thing of its faces: that no point of the body is above their planes
by more than the slack. Every given point is compared with every plane. Points go by blocks, each
in a ball; a ball that is below a plane is so with all its points. On a closed surface a plane
meets few balls, so that the work grows little faster than the number of faces.
"""

from __future__ import annotations

import numpy as np

from standoff.typing import Array, Ints

# Points of one block.
BLOCK = 128
# Heights that are computed at once, to bound the memory.
AT_ONCE = 4_000_000


def highest(points: Array, normals: Array, offsets: Array) -> tuple[Array, Ints]:
    """Of every plane how far the highest point is above it, and which it is.

    Parameters
    ----------
    points : (n, 3) array
    normals, offsets : (f, 3) unit vectors and (f,) lengths of the planes

    Returns
    -------
    heights : (f,) array
        The greatest of normal . x - offset, length, a few roundings of the points' size off; 0
        where no point is above.
    numbers : (f,) array of int
        The points; -1 where none is above.
    """
    blocks = _blocks(points)
    middles = np.array([0.5 * (x.min(axis=0) + x.max(axis=0)) for x in (points[b] for b in blocks)])
    reaches = np.array(
        [np.linalg.norm(points[b] - m, axis=1).max() for b, m in zip(blocks, middles, strict=True)]
    )
    greatest, numbers = np.zeros(len(normals)), np.full(len(normals), -1)
    many = max(1, AT_ONCE // len(blocks))
    for start in range(0, len(normals), many):
        part = slice(start, start + many)
        over = normals[part] @ middles.T - offsets[part, None] + reaches > 0.0
        for k, block in enumerate(blocks):
            near = start + np.flatnonzero(over[:, k])
            if len(near):
                along = normals[near] @ points[block].T
                best = along.argmax(axis=1)
                heights = np.take_along_axis(along, best[:, None], axis=1)[:, 0] - offsets[near]
                higher = heights > greatest[near]
                greatest[near[higher]] = heights[higher]
                numbers[near[higher]] = block[best[higher]]
    return greatest, numbers


def _blocks(points: Array) -> list[Ints]:
    """The numbers of points in blocks, by halving them along their longest extent."""
    waiting, done = [np.arange(len(points))], []
    while waiting:
        block = waiting.pop()
        if len(block) <= BLOCK:
            done.append(block)
            continue
        own = points[block]
        axis = int(np.ptp(own, axis=0).argmax())
        half = len(block) // 2
        order = np.argpartition(own[:, axis], half)
        waiting += [block[order[:half]], block[order[half:]]]
    return done
