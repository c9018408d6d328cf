"""The potential that is constant along a screw: on both flanks of a thread, so that one does for a
whole piece of it."""

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.vectors import add, axpy, cross, dot, norm, scale, sub
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.coaxial import NO_POTENTIAL
from standoff.kernels.solids.spatial_likeness import moved_line
from standoff.kernels.solids.spatial_pieces import ZERO, along, leaf_ints, leaf_jet, leaf_reals
from standoff.kernels.solids.spatial_progress import middle
from standoff.kernels.solids.spatial_tolerances import NEAREST_AXIS, ONE_THREAD
from standoff.kernels.solids.torus_potential import SCREW_OF, Potential

# Of the hull's distance from the axis: the potential serves a little beyond it, for the parts of
# trimming curves that reach out of a part.
BESIDE_HULL = 0.98


@kernel
def own_screw(side, leaf):
    """(known, rise per radian, point, axis) of the screw motion that moves a leaf along itself."""
    r = leaf_ints(side, leaf)
    if side.own[r + S.NATURAL] != S.SCREWED:
        return False, 0.0, ZERO, ZERO
    o = leaf_reals(side, leaf) + S.NATURAL_REALS
    point, axis = moved_line(side, o + 3)
    return True, side.numbers[o + 1], point, axis


@kernel
def local_rise(side, leaf, jet, screw):
    """The rise of the screw about the same axis that is tangential to a leaf at a point with this
    jet, where it is near to its thread's: a spline is a thread only nearly."""
    rise, point, axis = screw
    y = sub(jet[0], point)
    around = cross(axis, y)
    own = rise
    if side.own[leaf_ints(side, leaf) + S.DIM] == 2:
        n = cross(jet[1], jet[2])
        if dot(n, axis) != 0.0:
            own = -dot(n, around) / dot(n, axis)
    elif dot(jet[1], around) != 0.0:
        own = dot(jet[1], axis) * dot(around, around) / dot(jet[1], around)
    return own if abs(own - rise) <= ONE_THREAD * abs(rise) else rise


@kernel
def common_screw(a, b, leaves, jets):
    """(known, rise, point, axis) of the screw of one of two leaves at the points of their jets, a
    face rather than an edge."""
    known, rise, point, axis = own_screw(a.side, leaves[0])
    other, b_rise, b_point, b_axis = own_screw(b.side, leaves[1])
    edge = a.side.own[leaf_ints(a.side, leaves[0]) + S.DIM] < 2
    if known and not (edge and other):
        return known, local_rise(a.side, leaves[0], jets[0], (rise, point, axis)), point, axis
    if other:
        rise = local_rise(b.side, leaves[1], jets[1], (b_rise, b_point, b_axis))
    return other, rise, b_point, b_axis


@kernel
def least_along(part, e, point):
    """A bound below the coordinate along e, from a point on, of all of a part."""
    side, leaf, box = part.side, part.leaf, part.box
    q = middle(box)
    jet = leaf_jet(side, leaf, q[0], q[1])
    hu, hv = 0.5 * (box.u1 - box.u0), 0.5 * (box.v1 - box.v0)
    return dot(e, sub(jet[0], point)) - along(side, leaf, jet, e, (hu, hv))


@kernel
def screw_between(a, b, x, y, n, screw):
    """(known, potential) half way from x to y with the slope n there, less what n has along the
    screw line, constant along a screw (known, rise, point, axis); it serves for the parts a and b
    only."""
    _, rise, point, axis = screw
    between = sub(scale(0.5, add(x, y)), point)
    radial = axpy(-dot(between, axis), axis, between)
    rho = norm(radial)
    if rho <= 0.0:
        return False, NO_POTENTIAL
    out = scale(1.0 / rho, radial)
    nr, pitch = dot(n, out), rise / rho
    nz = (dot(n, axis) - pitch * dot(n, cross(axis, out))) / (1.0 + pitch * pitch)
    # the parts' convex hull is on one side of the axis
    least = BESIDE_HULL * min(least_along(a, out, point), least_along(b, out, point))
    if least <= NEAREST_AXIS * rho:
        return False, NO_POTENTIAL
    steepest = sqrt(nz * nz * (1.0 + rise * rise / (least * least)) + nr * nr)
    if steepest <= 0.0:
        return False, NO_POTENTIAL
    slopes = (nz / steepest, nr / steepest, 0.0)
    return True, Potential(SCREW_OF, point, out, slopes, axis, rise, least, 1.0)
