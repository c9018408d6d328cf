"""Checks of a medial axis by brute force: that it is correct and complete."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from standoff.bodies.voronoi.discs import edge_distances, greatest_disc
from standoff.bodies.voronoi.outline import Outline
from standoff.bodies.voronoi.regions import MedialBranch
from standoff.bodies.voronoi.tolerances import CHECK_SAMPLES, SAME_DEPTH
from standoff.errors import VoronoiError
from standoff.typing import Array

# The polyline may miss the true axis by its tolerance between two points, but this was checked at
# only one point between them: this many times more is certainly wrong.
DOUBT = 8.0


def check_axis(outline: Outline, branches: Sequence[MedialBranch], tolerance: float) -> None:
    """Raise VoronoiError if the edges of a branch are not nearest, or if a branch is missing."""
    for branch in branches:
        _check_nearest(outline, branch)
    _check_complete(outline, branches, DOUBT * tolerance)


def _check_nearest(outline: Outline, branch: MedialBranch) -> None:
    allowed = SAME_DEPTH * outline.size
    for point, depth in zip(branch.points, branch.depth, strict=True):
        found = edge_distances(outline, point[:2])
        least = min(distance for distance, _ in found.values())
        worst = max(abs(found[f.index][0] - depth) for f in branch.features)
        if not (worst <= allowed and abs(least - depth) <= allowed):
            raise VoronoiError(
                f"The branch of {branch.features[0]} and {branch.features[1]} fails its check at "
                f"{point[:2]}: depth {depth:.12g}, the two edges' distances differ from it by up "
                f"to {worst:.3g}, the nearest edge's by {abs(least - depth):.3g}; allowed is "
                f"{allowed:.3g}."
            )


def _check_complete(outline: Outline, branches: Sequence[MedialBranch], allowed: float) -> None:
    """Check that the largest disc at every boundary point has its centre on the axis."""
    starts = np.vstack([b.points[: max(len(b.points) - 1, 1), :2] for b in branches])
    stops = np.vstack([b.points[min(len(b.points) - 1, 1) :, :2] for b in branches])
    count = len(outline.arcs)
    for n, arc in enumerate(outline.arcs):
        for share in (np.arange(CHECK_SAMPLES) + 0.5) / CHECK_SAMPLES:
            u = float(arc.lo + share * (arc.hi - arc.lo))
            foot = arc.foot(u)
            radius = greatest_disc(outline, foot, (n, u), (n + count, u), graded=False).radius
            if foot.curvature > 0.0:
                radius = min(radius, 1.0 / foot.curvature)
            miss = _to_segments(foot.x - radius * foot.n, starts, stops)
            if not miss <= allowed:
                raise VoronoiError(
                    f"A branch of the medial axis is missing: the largest disc inside at {foot.x} "
                    f"(edge {arc.edge}) has its centre {miss:.3g} off the axis found."
                )


def _to_segments(point: Array, starts: Array, stops: Array) -> float:
    """Distance to the nearest of segments, (m, 2) each."""
    along, out = stops - starts, point - starts
    square = np.einsum("ij,ij->i", along, along)
    dots = np.einsum("ij,ij->i", along, out)
    share = np.clip(dots / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    return float(np.linalg.norm(out - share[:, None] * along, axis=1).min())
