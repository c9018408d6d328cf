"""The potential that is constant along a screw: on both flanks of a thread, so that one does for a
whole piece of it."""

from math import atan2

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.vectors import add, axpy, cross, dot, norm, scale, sub
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.coaxial import NO_POTENTIAL
from standoff.kernels.solids.spatial_likeness import moved_line
from standoff.kernels.solids.spatial_pieces import ZERO, along, leaf_ints, leaf_jet, leaf_reals
from standoff.kernels.solids.spatial_progress import middle
from standoff.kernels.solids.spatial_tolerances import (
    NEAREST_AXIS,
    OFF_SCREW,
    ONE_THREAD,
    STEEP_FLANK,
)
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
def around_axis(x, line):
    """(distance from the axis, height, angle from `out`) of a point."""
    point, axis, out = line
    y = sub(x, point)
    z = dot(y, axis)
    angle = atan2(dot(cross(axis, out), y), dot(out, y))
    return norm(axpy(-z, axis, y)), z, angle


@kernel
def local_thread(part, line, rise, slope):
    """(rise, slope of the height by the distance from the axis) of the screw that a part's middle
    lines have at their ends, where it is near to the one given: a spline is a thread only nearly,
    and a part of it has a screw that fits it better."""
    box = part.box
    u, v = middle(box)
    a = around_axis(leaf_jet(part.side, part.leaf, box.u0, v)[0], line)
    b = around_axis(leaf_jet(part.side, part.leaf, box.u1, v)[0], line)
    c = around_axis(leaf_jet(part.side, part.leaf, u, box.v0)[0], line)
    d = around_axis(leaf_jet(part.side, part.leaf, u, box.v1)[0], line)
    r1, z1, t1 = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    r2, z2, t2 = d[0] - c[0], d[1] - c[1], d[2] - c[2]
    det = t1 * r2 - t2 * r1
    if det != 0.0:
        own_rise, own_slope = (z1 * r2 - z2 * r1) / det, (t1 * z2 - t2 * z1) / det
    elif t1 != 0.0:  # of an edge
        own_rise, own_slope = (z1 - slope * r1) / t1, slope
    else:
        return rise, slope
    near = abs(own_rise - rise) <= ONE_THREAD * abs(rise)
    if near and abs(own_slope - slope) <= ONE_THREAD * (1.0 + slope * slope):
        return own_rise, own_slope
    return rise, slope


@kernel
def common_screw(a, b):
    """(known, rise, point, axis, part) of the screw of one of two parts, a face rather than an
    edge."""
    known, rise, point, axis = own_screw(a.side, a.leaf)
    other = own_screw(b.side, b.leaf)
    edge = a.side.own[leaf_ints(a.side, a.leaf) + S.DIM] < 2
    if known and not (edge and other[0]):
        return known, rise, point, axis, a
    return other[0], other[1], other[2], other[3], b


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
    """(known, potential) half way from x to y with the slope n there, constant along a screw
    (known, rise, point, axis, part); it serves for the parts a and b only."""
    _, rise, point, axis, own = screw
    between = sub(scale(0.5, add(x, y)), point)
    radial = axpy(-dot(between, axis), axis, between)
    rho = norm(radial)
    if rho <= 0.0:
        return False, NO_POTENTIAL
    out = scale(1.0 / rho, radial)
    nz, nr, around = dot(n, axis), dot(n, out), dot(n, cross(axis, out))
    if abs(around + rise / rho * nz) > OFF_SCREW:
        return False, NO_POTENTIAL
    # the parts' convex hull is on one side of the axis
    least = BESIDE_HULL * min(least_along(a, out, point), least_along(b, out, point))
    if least <= NEAREST_AXIS * rho:
        return False, NO_POTENTIAL
    if abs(nz) >= STEEP_FLANK * abs(nr):
        rise, slope = local_thread(own, (point, axis, out), rise, -nr / nz)
        nr = -slope * nz
    steepest = sqrt(nz * nz * (1.0 + rise * rise / (least * least)) + nr * nr)
    if steepest <= 0.0:
        return False, NO_POTENTIAL
    slopes = (nz / steepest, nr / steepest, 0.0)
    return True, Potential(SCREW_OF, point, out, slopes, axis, rise, least, 1.0)
