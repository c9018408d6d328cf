"""Random features of a body, and random parameters on them."""

from __future__ import annotations

import numpy as np

import standoff as so
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import coedge_parameters
from standoff.kernels.body.trimming import on_face

TRIES = 1000
"""Draws in a chart's box before giving up: slender faces fill little of it."""
OUTLINE = 33
"""Points of a trimming curve that bound a chart's box."""
UNBOUNDED = 3.0
"""Half the side of the square drawn from on a plane without a boundary, lengths."""

Start = tuple[tuple[str, int], tuple[float, ...]]


def _chart_box(body: so.Body, chart: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the corners of a box in (u, v) around a chart's part of its face."""
    _, offset, first, count, _ = body.ints[body.ints[L.CHARTS] + L.CHART_STRIDE * chart :][:5]
    limit = body.reals[offset + L.LIMIT]
    if np.isfinite(limit):
        return np.full(2, -limit), np.full(2, limit)
    spots = []
    for coedge in range(first, first + count):
        at = body.ints[body.ints[L.COEDGES] + L.COEDGE_STRIDE * coedge + L.COEDGE_REALS]
        for t in np.linspace(body.reals[at], body.reals[at + 1], OUTLINE):
            u, v, _, _, depth = coedge_parameters(body.ints, body.reals, coedge, t)
            if depth > 0:
                spots.append((u, v))
    if not spots:
        return np.full(2, -UNBOUNDED), np.full(2, UNBOUNDED)
    return np.min(spots, axis=0), np.max(spots, axis=0)


def random_face_parameters(
    body: so.Body, face: int, rng: np.random.Generator
) -> tuple[float, float]:
    """Return parameters inside a face, in one of its charts."""
    first, count = body.ints[body.ints[L.FACES] + L.FACE_STRIDE * face :][:2]
    for chart in first + rng.permutation(count):
        low, high = _chart_box(body, int(chart))
        for _ in range(TRIES):
            u, v = (float(x) for x in rng.uniform(low, high))
            if on_face(body.ints, body.reals, int(chart), u, v):
                return u, v
    raise AssertionError(f"no point found on face {face} of {body!r}")


def random_start(body: so.Body, rng: np.random.Generator) -> Start:
    """Return a random feature, of any kind the body has, and random parameters on it."""
    sizes = {"face": body.n_faces, "edge": body.n_edges, "vertex": body.n_vertices}
    kinds = [kind for kind, size in sizes.items() if size]
    kind = kinds[rng.integers(len(kinds))]
    index = int(rng.integers(sizes[kind]))
    if kind == "face":
        return (kind, index), random_face_parameters(body, index, rng)
    if kind == "edge":
        curve = body.edge_parts[index].curve
        return (kind, index), (float(rng.uniform(curve.first, curve.last)),)
    return (kind, index), ()
