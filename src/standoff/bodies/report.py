"""What the checks at construction found: ``body.check()``."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class PatchCheck:
    """Convexity of one chart of a face, or of one curve of a planar body.

    Attributes
    ----------
    face : int
        Number of the face, or of the edge of a planar body.
    surface : str
        Class name of the surface or curve.
    method : str
        "theorem" (planes, quadrics, lines and conic arcs), "bernstein" or "interval".
    convex : bool
    defect : float
        How far the patch may dent inward, length, proven over the whole patch.
    hemisphere : bool
        Its normals fit in an open hemisphere.
    place : (float, float)
        (u, v) of the worst point.
    """

    face: int
    surface: str
    method: str
    convex: bool
    defect: float
    hemisphere: bool
    place: tuple[float, float]


@dataclass(frozen=True)
class DihedralAngle:
    """The angle inside the body between the two faces of an edge, and where it is.

    Attributes
    ----------
    angle : float
        Radians: below pi the edge is sharp and convex, pi is smooth, above pi is concave.
    edge : int
        Number of the edge.
    parameter : float
        On its curve.
    point : (3,) tuple
        Body frame, length.
    """

    angle: float
    edge: int
    parameter: float
    point: tuple[float, float, float]


@dataclass(frozen=True)
class BoundaryReport:
    """What construction found out about a boundary; ``boundary.check()`` returns it.

    Attributes
    ----------
    faces, edges, vertices : how many there are.
    charts : how many surfaces the faces have, counting each chart of an atlas.
    shells : the faces of each shell.
    cavities : numbers of the shells that lie inside the outer one.
    size : diagonal of the box around it, length.
    volume : enclosed, length cubed.
    volume_error : a bound on the error of the volume, from quadrature and from rounding.
    area : of all faces, length squared.
    sewing_residual : the greatest distance between parts that were joined, length.
    sewing_tolerance : the distance within which parts were joined, length.
    slack : how far the boundary may lie from the given one, length: the residual, and removed
        knots of splines; 0 if that is roundoff.
    coordinate_roundoff : 16 roundings of the greatest coordinate, length.
    notes : what was turned, split or merged.
    """

    faces: int = 0
    edges: int = 0
    vertices: int = 0
    charts: int = 0
    shells: tuple[tuple[int, ...], ...] = ()
    cavities: tuple[int, ...] = ()
    size: float = 0.0
    volume: float = 0.0
    volume_error: float = 0.0
    area: float = 0.0
    sewing_residual: float = 0.0
    sewing_tolerance: float = 0.0
    slack: float = 0.0
    coordinate_roundoff: float = 0.0
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class BodyReport:
    """What the checks at construction found out about a body; ``body.check()`` returns it.

    Attributes
    ----------
    dimension : 2 for a planar body, 3 for a spatial one.
    faces, edges, vertices : how many there are.
    smooth_edges : how many edges are smooth: their two faces have the same normals all along.
    charts : how many surfaces the faces have, counting each chart of an atlas.
    size : diagonal of the box around the body with its radius, length; inf for a half-space.
    closed : False only for a half-space. Of a bounded body, every edge bounds two faces; if
        planar, two curves meet at every vertex.
    outward : all normals point out of the body, always True.
    patches : convexity of every chart.
    sharpest, flattest : the least and the greatest dihedral angle of all edges, sampled along the
        edges and refined by minimisation, not proven; None for a body without such edges.
    convexity_defect : how far a point of the core may lie above a tangent plane, length, because
        of dents in patches and concave edges, or as seen in samples.
    convexity_tolerance : the greatest convexity defect accepted, length.
    sewing_residual : the greatest distance between parts that were joined, length.
    sewing_tolerance : the distance within which parts were joined, length.
    slack : what the certificate subtracts for the convexity defect, the sewing residual and removed
        knots of splines, length; 0 if these are roundoff.
    coordinate_roundoff : 16 roundings of the greatest coordinate, length. Parts may always miss
        each other by this much; it is not in the slack, because the certificate's own allowance
        covers it. It is below the tolerances except for bodies far from their own origin. 0 for a
        half-space.
    notes : what was turned, split, merged or recentred.
    """

    dimension: int
    faces: int
    edges: int
    vertices: int
    smooth_edges: int
    charts: int
    size: float
    convexity_defect: float
    notes: tuple[str, ...]
    closed: bool
    outward: bool
    patches: tuple[PatchCheck, ...]
    sharpest: DihedralAngle | None
    flattest: DihedralAngle | None
    convexity_tolerance: float
    sewing_residual: float
    sewing_tolerance: float
    slack: float
    coordinate_roundoff: float
