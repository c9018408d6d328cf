"""Kernels as Python calls them: packed arrays in, pointers below.

A kernel that got arrays from Python and pointers from other kernels would be compiled twice with
all that it calls. These are the few that the layers above ask for.
"""

from standoff.kernels import features, jets, switching, trimming
from standoff.kernels.compiling import kernel, pointer


@kernel
def surface_jet(reals, kind, o, u, v):
    return jets.surface_jet(pointer(reals, 0), kind, o, u, v)


@kernel
def curve_jet(reals, kind, o, t):
    return jets.curve_jet(pointer(reals, 0), kind, o, t)


@kernel
def pcurve_jet(reals, kind, o, t):
    return jets.pcurve_jet(pointer(reals, 0), kind, o, t)


@kernel
def feature_jet(ints, reals, feature, chart, p, q):
    return features.feature_jet(pointer(ints, 0), pointer(reals, 0), feature, chart, p, q)


@kernel
def edge_jet(ints, reals, feature, t):
    return features.edge_jet(pointer(ints, 0), pointer(reals, 0), feature, t)


@kernel
def chart_normal(ints, reals, chart, u, v):
    return features.chart_normal(pointer(ints, 0), pointer(reals, 0), chart, u, v)


@kernel
def planar_edge_normal(ints, reals, feature, t):
    return features.planar_edge_normal(pointer(ints, 0), pointer(reals, 0), feature, t)


@kernel
def coedge_parameters(ints, reals, coedge, t):
    return features.coedge_parameters(pointer(ints, 0), pointer(reals, 0), coedge, t)


@kernel
def coedge_conormal(ints, reals, coedge, tangent, t):
    return features.coedge_conormal(pointer(ints, 0), pointer(reals, 0), coedge, tangent, t)


@kernel
def end_direction(ints, reals, edge, end):
    return switching.end_direction(pointer(ints, 0), pointer(reals, 0), edge, end)


@kernel
def on_face(ints, reals, chart, u, v):
    return trimming.on_face(pointer(ints, 0), pointer(reals, 0), chart, u, v)
