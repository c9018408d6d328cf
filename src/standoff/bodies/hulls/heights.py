"""How far points lie above planes at most: the proof that faces bound the hull of points.

A body's certificate asks one thing of its faces: that no point of the body is above their planes
by more than the slack. Every given point is compared with every plane. Points go by blocks, each
in a ball; a ball that is below a plane is so with all its points. On a closed surface a plane
meets few balls, so that the work grows little faster than the number of faces.
"""

from __future__ import annotations

import numpy as np

from standoff.geometry.validation import Array

# Points of one block.
BLOCK = 128
# Heights that are computed at once, to bound the memory.
AT_ONCE = 4_000_000


def greatest_heights(points: Array, normals: Array, offsets: Array) -> Array:
    """(f,) the greatest of normal . x - offset over the points; 0 where all are below.

    Parameters
    ----------
    points : (n, 3) array
    normals, offsets : (f, 3) unit vectors and (f,) lengths of the planes

    Returns
    -------
    (f,) array, length; a few roundings of the points' size off.
    """
    blocks = _blocks(points)
    middles = np.array([0.5 * (b.min(axis=0) + b.max(axis=0)) for b in blocks])
    reaches = np.array(
        [np.linalg.norm(b - m, axis=1).max() for b, m in zip(blocks, middles, strict=True)]
    )
    greatest = np.zeros(len(normals))
    many = max(1, AT_ONCE // len(blocks))
    for start in range(0, len(normals), many):
        part = slice(start, start + many)
        over = normals[part] @ middles.T - offsets[part, None] + reaches > 0.0
        for k, block in enumerate(blocks):
            near = start + np.flatnonzero(over[:, k])
            if len(near):
                heights = (normals[near] @ block.T).max(axis=1) - offsets[near]
                greatest[near] = np.maximum(greatest[near], heights)
    return greatest


def _blocks(points: Array) -> list[Array]:
    """The points in blocks, by halving them along their longest extent."""
    waiting, done = [points], []
    while waiting:
        block = waiting.pop()
        if len(block) <= BLOCK:
            done.append(block)
            continue
        axis = int(np.ptp(block, axis=0).argmax())
        half = len(block) // 2
        order = np.argpartition(block[:, axis], half)
        waiting += [block[order[:half]], block[order[half:]]]
    return done
