"""Jets: a point of a surface or curve with its first and second partial derivatives.

Canonical forms stand behind an affine map, so an affine image of a body is exact. Adding a kind
is one function, one number in ``layout`` and one line in a chain here: of ``canonical_jet``, which
is inlined wherever a jet is taken and so holds the small kinds, or of ``patch_jet``, a call.
"""

from math import cos, sin

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.body import layout as L
from standoff.kernels.body.formulas import formula_curve_jet, formula_jet
from standoff.kernels.body.layout import AFFINE, CONE, CYLINDER, PLANE, SPHERE, SURFACE_DATA
from standoff.kernels.body.nurbs import bernstein_basis, bezier_jet, nurbs_curve_jet, nurbs_jet
from standoff.kernels.body.superellipsoid import superellipsoid_jet
from standoff.kernels.compiler.decorators import kernel, small, stack_reals

ZERO = (0.0, 0.0, 0.0)


@small
def plane_jet(u, v):
    return (u, v, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), ZERO, ZERO, ZERO


@small
def sphere_jet(u, v):
    """Unit sphere in the gnomonic chart (u, v, 1)/sqrt(1 + u² + v²): no pole, no trigonometry."""
    s = 1.0 / sqrt(1.0 + u * u + v * v)
    s3 = s * s * s
    s5 = s3 * s * s
    # s = (1 + u² + v²)^(-1/2) and its partials
    su = -u * s3
    sv = -v * s3
    suu = 3.0 * u * u * s5 - s3
    suv = 3.0 * u * v * s5
    svv = 3.0 * v * v * s5 - s3
    return (
        (u * s, v * s, s),
        (s + u * su, v * su, su),
        (u * sv, s + v * sv, sv),
        (2.0 * su + u * suu, v * suu, suu),
        (sv + u * suv, su + v * suv, suv),
        (u * svv, 2.0 * sv + v * svv, svv),
    )


@small
def cylinder_jet(u, v):
    c, s = cos(u), sin(u)
    return (c, s, v), (-s, c, 0.0), (0.0, 0.0, 1.0), (-c, -s, 0.0), ZERO, ZERO


@small
def cone_jet(u, v):
    """Apex at the origin, v = 0; v grows along the generators."""
    c, s = cos(u), sin(u)
    return (
        (v * c, v * s, v),
        (-v * s, v * c, 0.0),
        (c, s, 1.0),
        (-v * c, -v * s, 0.0),
        (-s, c, 0.0),
        ZERO,
    )


@small
def linear_map(reals, o, a):
    """The 3x3 at reals[o:o+9] applied to a."""
    return (
        reals[o] * a[0] + reals[o + 1] * a[1] + reals[o + 2] * a[2],
        reals[o + 3] * a[0] + reals[o + 4] * a[1] + reals[o + 5] * a[2],
        reals[o + 6] * a[0] + reals[o + 7] * a[1] + reals[o + 8] * a[2],
    )


@small
def affine_map(reals, o, a):
    x = linear_map(reals, o, a)
    return (x[0] + reals[o + 9], x[1] + reals[o + 10], x[2] + reals[o + 11])


@kernel
def piecewise_jet(reals, kind, o, t):
    """(x, x_t, x_tt) of the curve kinds that have no affine map."""
    if kind == L.BEZIER:
        return bezier_jet(reals, o + 1, int(reals[o]), t)
    if kind == L.NURBS_CURVE:
        return nurbs_curve_jet(reals, o, t)
    return formula_curve_jet(int(reals[o + 12]), t)


@small
def curve_jet(reals, kind, o, t):
    """(x, x_t, x_tt) of the curve whose data begin at o."""
    if kind == L.BEZIER or kind == L.NURBS_CURVE:
        return piecewise_jet(reals, kind, o, t)
    if kind == L.CONIC:
        c, s = cos(t), sin(t)
        y, yt, ytt = (c, s, 0.0), (-s, c, 0.0), (-c, -s, 0.0)
    elif kind == L.LINE:
        y, yt, ytt = (t, 0.0, 0.0), (1.0, 0.0, 0.0), ZERO
    else:
        y, yt, ytt = piecewise_jet(reals, kind, o, t)
    return affine_map(reals, o, y), linear_map(reals, o, yt), linear_map(reals, o, ytt)


@kernel
def pcurve_jet(reals, kind, o, t):
    """(h, h_t, h_tt): homogeneous (u, v) of the pcurve whose data begin at o, by t."""
    if kind == L.BEZIER:
        first, last = reals[o - 2], reals[o - 1]
        rate = 1.0 / (last - first)
        n = int(reals[o])
        basis = stack_reals()
        bernstein_basis(n, (t - first) * rate, basis)
        h = stack_reals()
        for k in range(9):
            h[k] = 0.0
        for i in range(n + 1):
            for c in range(3):
                x = reals[o + 1 + 3 * i + c]
                h[c] += basis[i] * x
                h[3 + c] += basis[n + 1 + i] * x * rate
                h[6 + c] += basis[2 * (n + 1) + i] * x * rate * rate
        return (h[0], h[1], h[2]), (h[3], h[4], h[5]), (h[6], h[7], h[8])
    if kind == L.CONIC:
        c, s = cos(t), sin(t)
        y, yt, ytt = (c, s, 1.0), (-s, c, 0.0), (-c, -s, 0.0)
    else:
        y, yt, ytt = (t, 0.0, 1.0), (1.0, 0.0, 0.0), ZERO
    return linear_map(reals, o, y), linear_map(reals, o, yt), linear_map(reals, o, ytt)


@small
def torus_jet(reals, o, u, v):
    """((R + r cos v) cos u, (R + r cos v) sin u, r sin v); R and r at reals[o:]."""
    cu, su, cv, sv = cos(u), sin(u), cos(v), sin(v)
    r = reals[o + 1]
    ring = reals[o] + r * cv
    rc, rs = r * cv, r * sv
    return (
        (ring * cu, ring * su, rs),
        (-ring * su, ring * cu, 0.0),
        (-rs * cu, -rs * su, rc),
        (-ring * cu, -ring * su, 0.0),
        (rs * su, -rs * cu, 0.0),
        (-rc * cu, -rc * su, -rs),
    )


@small
def revolution_jet(reals, o, u, v):
    """(r(v) cos u, r(v) sin u, z(v)) of a profile (r, 0, z); its kind and data at reals[o:]."""
    y, yt, ytt = curve_jet(reals, int(reals[o]), o + 1, v)
    c, s = cos(u), sin(u)
    return (
        (y[0] * c, y[0] * s, y[2]),
        (-y[0] * s, y[0] * c, 0.0),
        (yt[0] * c, yt[0] * s, yt[2]),
        (-y[0] * c, -y[0] * s, 0.0),
        (-yt[0] * s, yt[0] * c, 0.0),
        (ytt[0] * c, ytt[0] * s, ytt[2]),
    )


@small
def extrusion_jet(reals, o, u, v):
    """c(u) + v d: kind of the profile c, direction d, then the profile's data at reals[o:]."""
    y, yt, ytt = curve_jet(reals, int(reals[o]), o + 4, u)
    d = (reals[o + 1], reals[o + 2], reals[o + 3])
    return (
        (y[0] + v * d[0], y[1] + v * d[1], y[2] + v * d[2]),
        yt,
        d,
        ytt,
        ZERO,
        ZERO,
    )


@kernel
def patch_jet(reals, kind, o, u, v):
    """Canonical jet of the kinds that have data at reals[o:]."""
    if kind == L.NURBS:
        return nurbs_jet(reals, o, u, v)
    if kind == L.TORUS:
        return torus_jet(reals, o, u, v)
    if kind == L.SUPERELLIPSOID_POLE or kind == L.SUPERELLIPSOID_SIDE:
        pole = kind == L.SUPERELLIPSOID_POLE
        return superellipsoid_jet(reals[o], reals[o + 1], pole, u, v)
    if kind == L.REVOLUTION:
        return revolution_jet(reals, o, u, v)
    if kind == L.EXTRUSION:
        return extrusion_jet(reals, o, u, v)
    return formula_jet(int(reals[o]), u, v)


@small
def canonical_jet(reals, kind, o, u, v):
    if kind == PLANE:
        return plane_jet(u, v)
    if kind == SPHERE:
        return sphere_jet(u, v)
    if kind == CYLINDER:
        return cylinder_jet(u, v)
    if kind == CONE:
        return cone_jet(u, v)
    return patch_jet(reals, kind, o, u, v)


@small
def surface_jet(reals, kind, o, u, v):
    """(x, x_u, x_v, x_uu, x_uv, x_vv) of the chart whose reals begin at o."""
    return mapped_jet(reals, o, canonical_jet(reals, kind, o + SURFACE_DATA, u, v))


@small
def mapped_jet(reals, o, canonical):
    """The jet of a chart whose reals begin at o, from that of its canonical form."""
    return mapped_by(affine_at(reals, o + AFFINE), canonical)


@small
def affine_at(reals, m):
    """The affine map at reals[m:], as 12 numbers: the 3x3 by rows, the shift."""
    return (
        reals[m], reals[m + 1], reals[m + 2], reals[m + 3], reals[m + 4], reals[m + 5],
        reals[m + 6], reals[m + 7], reals[m + 8], reals[m + 9], reals[m + 10], reals[m + 11],
    )  # fmt: skip


@small
def mapped_by(affine, canonical):
    """A jet behind an affine map, from that of its canonical form."""
    x, xu, xv, xuu, xuv, xvv = canonical
    return (
        affine_map(affine, 0, x),
        linear_map(affine, 0, xu),
        linear_map(affine, 0, xv),
        linear_map(affine, 0, xuu),
        linear_map(affine, 0, xuv),
        linear_map(affine, 0, xvv),
    )


@small
def chart_parameters(reals, o, x):
    """(u, v, depth) of a point of a gnomonic chart's surface; depth > 0 where the chart sees it."""
    m = o + AFFINE
    shift = (reals[m + 9], reals[m + 10], reals[m + 11])
    return gnomonic(linear_map(reals, o + 12, (x[0] - shift[0], x[1] - shift[1], x[2] - shift[2])))


@small
def gnomonic(y):
    """(u, v, depth) of a point of the unit sphere, in the chart's own axes."""
    if y[2] <= 0.0:
        return 0.0, 0.0, y[2]
    return y[0] / y[2], y[1] / y[2], y[2]
