"""Does a witness point lie where its feature gives way to another?

A face is C2: patches are cut where they are not, so the curvature jumps at edges alone.
"""

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.vectors import dot, unit
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import (
    chart_jet,
    coedge_conormal,
    dimension,
    edge_jet,
    edge_record,
    vertex_record,
)
from standoff.kernels.body.trimming import on_face
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.pair.switching import end_direction, steepest_in_sector
from standoff.kernels.tolerances import BESIDE_FEATURE


@kernel
def beside_another(ints, reals, side, n):
    """Is a feature's point, to BESIDE_FEATURE, one of a neighbouring feature as well?

    n is the unit vector towards the other body, in this body's frame.
    """
    dim = dimension(ints, side.feature)
    if dim == 2:
        return beside_loop(ints, reals, side)
    if dim == 1:
        return beside_end(ints, reals, side) or beside_face(ints, reals, side, n)
    return beside_fan(ints, reals, side, n)


@kernel
def beside_loop(ints, reals, side):
    """Of a face: is a point around this one off it?"""
    if ints[L.UNBOUNDED]:
        return False
    jet = chart_jet(ints, reals, side.chart, side.p, side.q)
    along_u, along_v = sqrt(dot(jet[1], jet[1])), sqrt(dot(jet[2], jet[2]))
    reach = BESIDE_FEATURE * reals[L.SIZE]
    if along_u <= reach or along_v <= reach:
        return True  # a pole: other parameters name the same point
    du, dv = reach / along_u, reach / along_v
    for i in range(-1, 2):
        for j in range(-1, 2):
            if not on_face(ints, reals, side.chart, side.p + i * du, side.q + j * dv):
                return True
    return False


@kernel
def beside_end(ints, reals, side):
    """Of an edge: is an end near?"""
    e = edge_record(ints, side.feature)
    if ints[e + L.EDGE_FLAGS] & L.CLOSED:
        return False
    o = ints[e + L.EDGE_REALS]
    tangent = edge_jet(ints, reals, side.feature, side.p)[1]
    to_end = min(side.p - reals[o + L.EDGE_T0], reals[o + L.EDGE_T1] - side.p)
    return to_end * sqrt(dot(tangent, tangent)) <= BESIDE_FEATURE * reals[L.SIZE]


@kernel
def beside_face(ints, reals, side, n):
    """Of an edge: does the distance not rise along a face's inward conormal?"""
    e = edge_record(ints, side.feature)
    tangent = unit(edge_jet(ints, reals, side.feature, side.p)[1])
    for k in range(2):
        coedge = ints[e + L.EDGE_COEDGE_0 + k]
        if coedge >= 0:
            inward = coedge_conormal(ints, reals, coedge, tangent, side.p)[0]
            if dot(n, inward) > -BESIDE_FEATURE:
                return True
    return False


@kernel
def beside_fan(ints, reals, side, n):
    """Of a vertex: does the distance not rise along one of its edges, or into a face's sector?"""
    r = vertex_record(ints, side.feature)
    fan = ints[r + L.VERTEX_FAN]
    for k in range(ints[r + L.VERTEX_N_FAN]):
        edge = ints[L.N_FACES] + ints[fan + 2 * k]
        if dot(n, end_direction(ints, reals, edge, ints[fan + 2 * k + 1])) > -BESIDE_FEATURE:
            return True
    sectors = ints[r + L.VERTEX_SECTORS]
    for k in range(ints[r + L.VERTEX_N_SECTORS]):
        if steepest_in_sector(ints, reals, sectors + 2 * k, n)[0] < BESIDE_FEATURE:
            return True
    return False
