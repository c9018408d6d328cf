"""Kernels as Python calls them: packed arrays in, pointers below.

A kernel that got arrays from Python and pointers from other kernels would be compiled twice with
all that it calls. These are the few that the layers above need.
"""

from standoff.kernels.algebra.rigid import relative_pose, relative_twist
from standoff.kernels.algebra.vectors import unit
from standoff.kernels.body import features, jets, trimming
from standoff.kernels.body import inner_box as inner_boxes
from standoff.kernels.body.net_normals import centred, net_cone, normals_of
from standoff.kernels.compiler.decorators import entry, kernel, pointer
from standoff.kernels.compiler.entry import (
    BOOL,
    INT,
    INTS,
    PAIR,
    READ,
    READ_BLOCKS,
    READ_ROWS,
    REAL,
    ROWS,
    VECTOR,
    WRITE,
)
from standoff.kernels.entries.pointers import pair_pointers
from standoff.kernels.frame.inputs import inputs_at
from standoff.kernels.pair import switching
from standoff.kernels.pair.descent import pair_jets
from standoff.kernels.pair.system import feedforward, hessian, projection_errors
from standoff.kernels.state.state import read_place
from standoff.kernels.values import STILL


@entry(READ, INT, INT, REAL, REAL, work="bodies")
def surface_jet(reals, kind, o, u, v):
    return jets.surface_jet(pointer(reals, 0), kind, o, u, v)


@entry(READ, INT, INT, REAL, work="bodies")
def curve_jet(reals, kind, o, t):
    return jets.curve_jet(pointer(reals, 0), kind, o, t)


@entry(WRITE, INT, INT, REAL, work="bodies")
def pcurve_jet(reals, kind, o, t):
    return jets.pcurve_jet(pointer(reals, 0), kind, o, t)


@entry(READ, INT, INT, READ_ROWS, ROWS, work="bodies")
def surface_jets(reals, kind, o, parameters, out):
    """The jets of a chart at rows (u, v), into rows of 18 numbers."""
    at = pointer(reals, 0)
    for i in range(len(parameters)):
        jet = jets.surface_jet(at, kind, o, parameters[i, 0], parameters[i, 1])
        write_vectors(out, i, jet)


@entry(READ, INT, INT, READ, ROWS, work="bodies")
def curve_jets(reals, kind, o, ts, out):
    """The jets of a curve at parameters, into rows of 9 numbers."""
    at = pointer(reals, 0)
    for i in range(len(ts)):
        write_vectors(out, i, jets.curve_jet(at, kind, o, ts[i]))


@entry(READ, INT, INT, READ, ROWS, work="bodies")
def pcurve_jets(reals, kind, o, ts, out):
    """The homogeneous jets of a trimming curve at parameters, into rows of 9 numbers."""
    at = pointer(reals, 0)
    for i in range(len(ts)):
        write_vectors(out, i, jets.pcurve_jet(at, kind, o, ts[i]))


@entry(READ_ROWS, READ_ROWS, READ_ROWS, INT, INT, READ_ROWS, BOOL, ROWS, work="bodies")
def net_cones(nets, along_u, along_v, p, q, collapsed, rational, out):
    """Cones of normals of nets of degrees (p, q) and their derivatives, one a row, into rows (axis,
    angle); the weights of those that are not rational are one number."""
    for i in range(len(nets)):
        normals = normals_of((nets, along_u, along_v), i, p, q, rational)
        net_cone(normals, i, collapsed, out)


@entry(READ_BLOCKS, ROWS, work="bodies")
def centres(units, out):
    """Axes of nearly smallest cones around unit vectors, (n, k, 3), into rows."""
    for i in range(len(units)):
        x = y = z = 0.0
        for k in range(units.shape[1]):
            x, y, z = x + units[i, k, 0], y + units[i, k, 1], z + units[i, k, 2]
        axis, _ = centred(units[i], units.shape[1], (x, y, z))
        for m in range(3):
            out[i, m] = axis[m]


@kernel
def write_vectors(out, row, vectors):
    for k in range(len(vectors)):
        for m in range(3):
            out[row, 3 * k + m] = vectors[k][m]


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
    ints, reals = pointer(ints, 0), pointer(reals, 0)
    tangent = unit(features.edge_jet(ints, reals, feature, t)[1])
    return features.planar_edge_normal(ints, feature, tangent)


@entry(INTS, READ, INT, REAL, work="bodies")
def coedge_parameters(ints, reals, coedge, t):
    return features.coedge_parameters(pointer(ints, 0), pointer(reals, 0), coedge, t)


@entry(INTS, READ, INT, READ, ROWS, work="bodies")
def coedge_places(ints, reals, coedge, ts, out):
    """(u, v, u_t, v_t) of a coedge at parameters, as rows."""
    ints, reals = pointer(ints, 0), pointer(reals, 0)
    for i in range(len(ts)):
        found = features.coedge_parameters(ints, reals, coedge, ts[i])
        for k in range(4):
            out[i, k] = found[k]


@entry(INTS, READ, INT, VECTOR, REAL, work="bodies")
def coedge_conormal(ints, reals, coedge, tangent, t):
    return features.coedge_conormal(pointer(ints, 0), pointer(reals, 0), coedge, tangent, t)[:2]


@entry(INTS, READ, INT, INT, work="bodies")
def end_direction(ints, reals, edge, end):
    return switching.end_direction(pointer(ints, 0), pointer(reals, 0), edge, end)


@entry(INTS, READ, INT, REAL, REAL, work="bodies")
def on_face(ints, reals, chart, u, v):
    return trimming.on_face(pointer(ints, 0), pointer(reals, 0), chart, u, v)


@entry(INTS, READ, INT, REAL, work="bodies")
def inner_box(ints, reals, chart, reach):
    return inner_boxes.inner_box(pointer(ints, 0), pointer(reals, 0), chart, reach)


# What `pair_system` writes, and how many numbers.
JETS, ERRORS, FEEDFORWARD, HESSIAN, N_SYSTEM = 0, 36, 40, 44, 54


@entry(PAIR, WRITE, WRITE, WRITE, work="bodies")
def pair_system(pair, motion, state, out):
    """Both jets in A's frame (2 x 18 numbers), then Psi (4), b (4) and H (10), into `out`, at the
    state's place."""
    inputs = inputs_at(pointer(motion, 0), True)
    pose = relative_pose(inputs.pose_a, inputs.pose_b)
    v, w = relative_twist(inputs.pose_a, inputs.pose_b, inputs.twist_a, inputs.twist_b)
    jets = pair_jets(pair_pointers(pair), pose, read_place(pointer(state, 0)))
    for side in range(2):
        for i in range(6):
            vector = jets[side][i]
            for k in range(3):
                out[JETS + 18 * side + 3 * i + k] = vector[k]
    psi = projection_errors(jets[0], jets[1])
    b = feedforward(jets[0], jets[1], STILL, (pose.p, v, w))
    H = hessian(jets[0], jets[1])
    for k in range(4):
        out[ERRORS + k] = psi[k]
        out[FEEDFORWARD + k] = b[k]
    for k in range(10):
        out[HESSIAN + k] = H[k]
