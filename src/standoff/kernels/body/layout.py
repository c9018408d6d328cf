"""Where everything is in a packed body: two flat arrays, ``ints`` and ``reals``.

A packed body is read by every kernel and written by one place, ``standoff.bodies.packing``.
Features have one number: faces 0 .. F-1, then edges, then vertices. A *chart* is one surface
with its trimming loop in (u, v); a face owns one chart, or an atlas of overlapping ones. A
*coedge* is one side of an edge: the edge's trimming curve (pcurve) in a chart.
"""

# ints, header: counts, then the offset of each table in ints.
DIMENSION = 0  # 2 for a planar body, 3 for a spatial one
N_FACES = 1
N_EDGES = 2
N_VERTICES = 3
N_CHARTS = 4
N_SAMPLES = 5
FACES = 6
CHARTS = 7
COEDGES = 8
EDGES = 9
VERTICES = 10
SAMPLES = 11  # in ints: (feature, chart) a sample; the reals' offset is SAMPLE_REALS
SAMPLE_REALS = 12
UNBOUNDED = 13  # 1 for a half-space: no bounding box
INT_HEADER = 14

# reals, header.
RADIUS = 0  # swept radius, length
SIZE = 1  # diameter of the core, length
SLACK = 2  # sewing tolerance and convexity defect, length
BOX_CENTRE = 3  # 3 numbers, body frame
BOX_HALF = 6  # 3 numbers
OFFSET = 9  # distance of the box's centre from the body's origin
REAL_HEADER = 10

# A face: first chart, number of charts.
FACE_STRIDE = 2

# A chart: surface kind, offset in reals, first coedge, number of coedges, face, and where u is an
# angle not 0: REPEATS where all coedges are rims of constant v, which wrap; else the offset in
# reals of the start of the period in which they lie.
REPEATS = 1
CHART_STRIDE = 6
CHART_KIND, CHART_REALS, CHART_COEDGE, CHART_N_COEDGES, CHART_FACE, CHART_PERIODIC = range(6)
# Its reals: affine map (3x3 row-major, shift), inverse of the 3x3, then the three below, then
# what the surface kind needs.
AFFINE = 0
INVERSE = 12
OUTWARD = 21  # +1 where f_u x f_v points outward, else -1
LIMIT = 22  # |u|, |v| where an atlas's chart ends; inf for a chart that stands alone
INNER = (
    23  # u0, u1, v0, v1: a rectangle of parameters on the face (see `inner_box`); empty: u0 > u1
)
SURFACE_DATA = 27

NO_INNER = (1.0, -1.0, 1.0, -1.0)

# A coedge: edge (or -1 - vertex for a collapsed side), pcurve kind, offset in reals, side, chart.
COEDGE_STRIDE = 5
COEDGE_EDGE, COEDGE_KIND, COEDGE_REALS, COEDGE_SIDE, COEDGE_CHART = range(5)
# side: +1 where the face lies on the left of the pcurve as its parameter grows, else -1.
# Its reals: the first and last parameter, then a 3x3 matrix P (row-major): homogeneous (u, v) is
# P (t, 0, 1) for a line and P (cos t, sin t, 1) for a conic. For a Bezier piece of a NURBS pcurve
# the degree and homogeneous points (w u, w v, w); it turns by less than 180 degrees, so that no
# line meets it more than twice, and an edge has as many coedges in a chart as it has pieces.
PCURVE_FIRST = 0
PCURVE_LAST = 1
PCURVE_DATA = 2

# An edge: curve kind, offset in reals, flags, first vertex, last vertex, coedge, coedge.
EDGE_STRIDE = 7
EDGE_KIND, EDGE_REALS, EDGE_FLAGS, EDGE_FIRST, EDGE_LAST, EDGE_COEDGE_0, EDGE_COEDGE_1 = range(7)
CLOSED = 1  # a period and no vertex
SMOOTH = 2  # both faces share their normal along it: passed by its reset, not a mode
OUTWARD_RIGHT = 4  # planar bodies: the outward normal is on the right of the tangent
CREASED = 8  # one normal along it, but infinite curvature across it (superellipsoids)
REFLEX = 16  # the material fills more than half a turn round it, all along: no minimum while apart
MIXED = 32  # convex somewhere and reflex elsewhere
# Its reals: first and last parameter, then what the curve kind needs (see the jets).
EDGE_T0 = 0
EDGE_T1 = 1
CURVE_DATA = 2

# A vertex: offset in reals of its point; fan (offset in ints, count); sectors (offset in ints,
# count); generators of the normal cone (offset in reals, count).
VERTEX_STRIDE = 7
(
    VERTEX_REALS,
    VERTEX_FAN,
    VERTEX_N_FAN,
    VERTEX_SECTORS,
    VERTEX_N_SECTORS,
    VERTEX_CONE,
    VERTEX_N_CONE,
) = range(7)
# A fan entry: edge, end (0 or 1). A sector entry: chart, offset in reals.
# A sector's reals: kind, u, v, lo, hi.
SECTOR_APEX = 0  # collapsed side: start anywhere in [lo, hi] of it; its side and level for u, v
SECTOR_WIDE = 1  # a face's angle of 180 degrees or more: directions lo .. hi in the (u, v) plane
# Sides of a patch: v = level with the face at greater v, at lesser v; u = level likewise.
SIDE_V0, SIDE_V1, SIDE_U0, SIDE_U1 = range(4)

# A sample's reals: point, outward normal (zero at edges and vertices), parameters.
SAMPLE_STRIDE = 8

# Surface kinds; what stands at SURFACE_DATA.
PLANE = 0
SPHERE = 1  # gnomonic
CYLINDER = 2
CONE = 3
NURBS = 4  # degrees p, q; spans m, n; m + 1 and n + 1 breaks; m n Bezier nets of homogeneous points
TORUS = 5  # major and minor radius
SUPERELLIPSOID_POLE = 6  # 2/e1, 2/e2: gnomonic chart about the axis
SUPERELLIPSOID_SIDE = 7  # the same about a point of the equator
REVOLUTION = 8  # kind of the profile curve, then its data
EXTRUSION = 9  # kind of the profile curve, direction, then its data
FORMULA = 10  # address of a compiled jet

# Curve kinds; pcurves are lines, conics or Bezier pieces.
LINE = 0  # affine map
CONIC = 1  # affine map
BEZIER = 2  # degree, homogeneous points
NURBS_CURVE = 3  # degree, spans n, n + 1 breaks, n times the homogeneous points of a Bezier curve
FORMULA_CURVE = 4  # address of a compiled jet
ON_SURFACE = 5  # the image of the edge's own pcurve: nothing


def noisy(kind):
    """May roundoff turn the normal of a surface kind beside a collapsed side? The other kinds'
    tangents are products and keep their digits."""
    keeps = kind != NURBS and kind != REVOLUTION and kind != EXTRUSION and kind != FORMULA
    return not keeps


def dimension(ints, feature):
    """2 for a face, 1 for an edge, 0 for a vertex."""
    if feature < ints[N_FACES]:
        return 2
    if feature < ints[N_FACES] + ints[N_EDGES]:
        return 1
    return 0


def chart_record(ints, chart):
    return ints[CHARTS] + CHART_STRIDE * chart


def edge_record(ints, feature):
    return ints[EDGES] + EDGE_STRIDE * (feature - ints[N_FACES])


def vertex_record(ints, feature):
    return ints[VERTICES] + VERTEX_STRIDE * (feature - ints[N_FACES] - ints[N_EDGES])


def coedge_record(ints, coedge):
    return ints[COEDGES] + COEDGE_STRIDE * coedge
