"""What the checks at construction found: ``body.check()``."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class PatchCheck:
    """Convexity of one chart of a face; of a planar body, of one curve (face: the edge's number).

    surface : name of its class; method : "theorem" (planes and quadrics), "bernstein" or
    "interval"; defect : how far the patch may dent inward, length, proven over the whole patch;
    hemisphere : its normals fit an open hemisphere; place : (u, v) of the worst.
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
    """The angle inside the body between the two faces of an edge, radians, and where it is.

    Below pi the edge is sharp and convex, pi is smooth, above pi is concave.
    """

    angle: float
    edge: int
    parameter: float
    point: tuple[float, float, float]


@dataclass(frozen=True)
class BodyReport:
    """What the checks at construction found; ``body.check()`` returns it.

    Attributes
    ----------
    closed : every edge bounds two faces (a planar body: two curves meet at every vertex).
    outward : all normals point out of the body.
    patches : convexity of every chart.
    sharpest, flattest : the least and the greatest dihedral angle over every edge, sampled along
        the edges and refined by minimisation, not proven; None for a body without such edges.
    convexity_defect : how far a point of the core may lie above a tangent plane, length, from
        the defects of patches and concave edges.
    convexity_tolerance : the greatest convexity defect accepted, length.
    sewing_residual : the greatest distance met between parts that were joined, length.
    sewing_tolerance : within which parts were joined, length.
    slack : what the certificate subtracts for both, and for spare knots of a spline that were left
        out, length; 0 where that is roundoff.
    notes : what was turned, split or merged.
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
