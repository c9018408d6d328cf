"""The public function `voronoi_regions`."""

from __future__ import annotations

from standoff.bodies.body import Body
from standoff.bodies.voronoi.planar import planar_regions
from standoff.bodies.voronoi.regions import VoronoiRegions
from standoff.bodies.voronoi.spatial import spatial_regions
from standoff.checks.numbers import magnitude
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError

# Default reach for a point and a half-space, length.
REACH_WITHOUT_SIZE = 1.0


def voronoi_regions(
    body: Body, reach: float | None = None, tolerance: float | None = None
) -> VoronoiRegions:
    """Compute what separates the Voronoi regions of a body's features, for pictures and checks.

    Outside a convex body, regions are separated by the outward normals at edges and vertices:
    rays for a planar body, ruled surfaces and plane sectors for a spatial one. Inside a planar body
    they are separated by its medial axis. The trackers do not need any of this. Vertices and edges
    where the normal turns by less than 1e-5 rad count as smooth.

    Raises VoronoiError: the medial axis did not pass its own check by brute force, or a junction
    was not found. Raises TypeError: not a body. Raises ValueError: NaN, infinite or negative
    numbers, or a tolerance too fine.

    Parameters
    ----------
    body : Body
    reach : float, optional
        How far to draw the external boundaries, length; the body's size by default.
    tolerance : float, optional
        How far the medial axis's polylines may be from it, length; 1e-4 of the size by default.

    Returns
    -------
    VoronoiRegions

    Notes
    -----
    Where a disc inside a planar body touches its curves at x_i with the outward normals n_i, its
    centre is c = x_i - r n_i for all of them. The axis is traced from one of its ends to all
    others; junctions, with three such points, are solved to roundoff. Finally every point is
    checked against the distances to all edges, and the largest disc at points all along the
    boundary must have its centre on the axis.
    """
    if not isinstance(body, Body):
        raise StandoffTypeError(f"body = {shown(body)}: give a standoff.Body.", "body", body)
    if reach is None:
        reach = body.size if body.bounded and body.size > 0.0 else REACH_WITHOUT_SIZE
    reach = magnitude(reach, "reach")
    if body.dimension == 2:
        return planar_regions(body, reach, tolerance)
    if tolerance is not None:
        raise StandoffError(
            f"tolerance = {shown(tolerance)} is for planar bodies; {body!r} is spatial.",
            "tolerance",
            tolerance,
        )
    return spatial_regions(body, reach)
