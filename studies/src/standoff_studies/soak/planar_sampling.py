"""Plane boundaries of the study's own rows of numbers, sampled."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from standoff_studies.soak.planar_truth import ARC, CUBIC, RUN, Array, Outline, points_of


def cubic(points: Array, weights: Array | None = None) -> Array:
    """The row of a rational Bézier curve of degree one to three."""
    w = np.ones(len(points)) if weights is None else np.asarray(weights, dtype=float)
    net = np.column_stack([np.asarray(points, dtype=float) * w[:, None], w])
    while len(net) < 4:
        n = len(net)
        share = np.arange(n + 1)[:, None] / n
        net = share * np.vstack([net[:1], net]) + (1.0 - share) * np.vstack([net, net[-1:]])
    return np.concatenate([[CUBIC], net.ravel()])


def arc(centre: Array, radius: float, first: float, last: float) -> Array:
    """The row of an arc of a circle; radians."""
    return np.array([ARC, centre[0], centre[1], radius, first, last, *np.zeros(7)])


def outline(loops: list[list[Array]], per_length: float) -> Outline:
    """Loops of rows, each from where the one before it ends, in either direction: sampled."""
    pieces = np.array([row for loop in loops for row in loop])
    at, begins, number = [], [0], 0
    for loop in loops:
        spots = []
        ends = [points_of(row[None], np.array([[0.0, 0.0], [0.0, 1.0]])) for row in loop]
        # the first piece leads to the second, each other one from where the last one ended
        gaps = np.linalg.norm(ends[0][:, None] - ends[1 % len(ends)], axis=2).min(axis=1)
        last = ends[0][0] if gaps[1] <= gaps[0] else ends[0][1]
        for k, (p, q) in enumerate(ends):
            forward = np.linalg.norm(p - last) <= np.linalg.norm(q - last)
            last = q if forward else p
            count = 8 + int(per_length * float(np.linalg.norm(q - p)))
            t = np.linspace(0.0, 1.0, count)
            spots.append(np.column_stack([np.full(count, number + k), t if forward else 1.0 - t]))
        number += len(loop)
        at.append(np.concatenate([*spots, spots[0][:1]]))
        begins.append(begins[-1] + len(at[-1]))
    joined = np.concatenate(at)
    samples = points_of(pieces, joined)
    parted = [0, *(np.flatnonzero(np.diff(joined[:, 0]) != 0.0) + 1).tolist(), len(joined)]
    bounds = [(k, min(k + RUN, e)) for b, e in pairwise(parted)
              for k in range(b, e, RUN)]  # fmt: skip
    runs = np.array(bounds, dtype=np.int64)
    beyond = np.where(np.isin(runs[:, 1], begins), runs[:, 1] - 1, runs[:, 1])
    middles = runs.sum(axis=1) // 2
    radii = np.array([np.linalg.norm(samples[i:j] - samples[m], axis=1).max()
                      for (i, j), m in zip(runs, middles, strict=True)])  # fmt: skip
    twins = np.full(len(samples), -1)
    same = np.flatnonzero(np.diff(joined[:, 0]) != 0.0)
    twins[same], twins[same + 1] = same + 1, same
    for b, e in pairwise(begins):
        twins[b], twins[e - 1] = e - 2, e - 2
        if b:
            twins[b - 1] = b - 2
    loops_at = np.array(begins, dtype=np.int64)
    steps = np.linalg.norm(np.diff(samples, axis=0), axis=1)
    steps[loops_at[1:-1] - 1] = 0.0  # from loop to loop
    # half of the greatest step, and half of that more for what lies between
    reach = 0.75 * float(steps.max())
    return Outline(pieces, samples, joined, twins, loops_at, runs, beyond, middles, radii, reach)
