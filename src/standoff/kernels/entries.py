"""Kernels as Python calls them: packed arrays in, pointers below.

A kernel that got arrays from Python and pointers from other kernels would be compiled twice with
all that it calls. These are the few that the layers above ask for.
"""

from standoff.kernels import features, jets, switching, trimming
from standoff.kernels.compiling import entry, pointer
from standoff.kernels.descent import ORIGIN, pair_jets
from standoff.kernels.entry import INT, INTS, PAIR, READ, REAL, VECTOR, WRITE, WRITE_INTS
from standoff.kernels.rigid import relative_pose, relative_twist
from standoff.kernels.system import feedforward, hessian, projection_errors
from standoff.kernels.tracker import pair_pointers


@entry(READ, INT, INT, REAL, REAL, work="bodies")
def surface_jet(reals, kind, o, u, v):
    return jets.surface_jet(pointer(reals, 0), kind, o, u, v)


@entry(READ, INT, INT, REAL, work="bodies")
def curve_jet(reals, kind, o, t):
    return jets.curve_jet(pointer(reals, 0), kind, o, t)


@entry(WRITE, INT, INT, REAL, work="bodies")
def pcurve_jet(reals, kind, o, t):
    return jets.pcurve_jet(pointer(reals, 0), kind, o, t)


@entry(INTS, READ, INT, INT, REAL, REAL, work="bodies")
def feature_jet(ints, reals, feature, chart, p, q):
    return features.feature_jet(pointer(ints, 0), pointer(reals, 0), feature, chart, p, q)


@entry(INTS, READ, INT, REAL, work="bodies")
def edge_jet(ints, reals, feature, t):
    return features.edge_jet(pointer(ints, 0), pointer(reals, 0), feature, t)


@entry(INTS, READ, INT, REAL, REAL, work="bodies")
def chart_normal(ints, reals, chart, u, v):
    return features.chart_normal(pointer(ints, 0), pointer(reals, 0), chart, u, v)


@entry(INTS, READ, INT, REAL, work="bodies")
def planar_edge_normal(ints, reals, feature, t):
    return features.planar_edge_normal(pointer(ints, 0), pointer(reals, 0), feature, t)


@entry(INTS, READ, INT, REAL, work="bodies")
def coedge_parameters(ints, reals, coedge, t):
    return features.coedge_parameters(pointer(ints, 0), pointer(reals, 0), coedge, t)


@entry(INTS, READ, INT, VECTOR, REAL, work="bodies")
def coedge_conormal(ints, reals, coedge, tangent, t):
    return features.coedge_conormal(pointer(ints, 0), pointer(reals, 0), coedge, tangent, t)[:2]


@entry(INTS, READ, INT, INT, work="bodies")
def end_direction(ints, reals, edge, end):
    return switching.end_direction(pointer(ints, 0), pointer(reals, 0), edge, end)


@entry(INTS, READ, INT, REAL, REAL, work="bodies")
def on_face(ints, reals, chart, u, v):
    return trimming.on_face(pointer(ints, 0), pointer(reals, 0), chart, u, v)


@entry(PAIR, WRITE, WRITE, WRITE, WRITE, WRITE_INTS, WRITE, WRITE, work="bodies")
def pair_system(pair, Ta, Tb, xi_a, xi_b, mode, q, out):
    """Both jets in A's frame (2 x 18 numbers), then Psi (4), b (4) and H (10), into `out`."""
    R, p = relative_pose(pointer(Ta, 0), pointer(Tb, 0))
    v, w = relative_twist(pointer(Ta, 0), pointer(Tb, 0), pointer(xi_a, 0), pointer(xi_b, 0))
    jets = pair_jets(pair_pointers(pair), R, p, pointer(mode, 0), pointer(q, 0))
    for side in range(2):
        for i in range(6):
            vector = jets[side][i]
            for k in range(3):
                out[18 * side + 3 * i + k] = vector[k]
    psi = projection_errors(jets[0], jets[1])
    b = feedforward(jets[0], jets[1], ORIGIN, ORIGIN, ORIGIN, p, v, w)
    H = hessian(jets[0], jets[1])
    for k in range(4):
        out[36 + k] = psi[k]
        out[40 + k] = b[k]
    for k in range(10):
        out[44 + k] = H[k]
