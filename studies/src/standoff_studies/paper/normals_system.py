"""The equation set of the paper's reference [28], with the tangents of A and the normals of both.

r = (f_u.dR, f_v.dR, f_u.n_h, f_v.n_h): dR is along A's normal, and B's normal is parallel to A's.
If dR is not zero it has the same roots as Eqs. (1)-(4); at dR = 0 it still requires parallel
normals, which (1)-(4) do not. Parallel normals could also be written n_f x n_h = 0: along A's unit
tangents these are the same two numbers, rotated by a right angle.

Only for two faces: an edge or a vertex has no normal. Notation and frames as in
``standoff.kernels.pair.system``.
"""

from standoff.kernels.algebra.vectors import add, cross, dot, scale, sub, unit
from standoff.kernels.compiler.decorators import pointer
from standoff.kernels.pair.system import (
    contact_feedforward,
    contact_jacobian,
    contact_residual,
    feedforward,
    hessian,
    point_velocity,
    projection_errors,
)
from standoff_studies.own_kernels import own_kernel


@own_kernel
def unit_normal(jet):
    """h_r x h_s, normalised; outward or inward by the chart, which does not change r = 0."""
    return unit(cross(jet[1], jet[2]))


@own_kernel
def normal_partials(jet, n):
    """(n_r, n_s) by Weingarten's equations, with second but no third derivatives of h.

    n_i = -sum_jk h_j (I^-1)_jk (n.h_ik), with I the first fundamental form.
    """
    hr, hs = jet[1], jet[2]
    e, f, g = dot(hr, hr), dot(hr, hs), dot(hs, hs)
    area = e * g - f * f
    # second fundamental form, with the sign of n
    rr, rs, ss = dot(n, jet[3]), dot(n, jet[4]), dot(n, jet[5])
    n_r = add(scale((f * rs - g * rr) / area, hr), scale((f * rr - e * rs) / area, hs))
    n_s = add(scale((f * ss - g * rs) / area, hr), scale((f * rs - e * ss) / area, hs))
    return n_r, n_s


@own_kernel
def normals_residual(jet_a, jet_b):
    """r: two lengths squared per parameter, two lengths per parameter."""
    dR = sub(jet_a[0], jet_b[0])
    n = unit_normal(jet_b)
    return dot(jet_a[1], dR), dot(jet_a[2], dR), dot(jet_a[1], n), dot(jet_a[2], n)


@own_kernel
def normals_jacobian(jet_a, jet_b, J):
    """dr/dq into the 4 x 4 array J, q = (u, v, r, s). Not symmetric, as r is not a gradient."""
    fu, fv, fuu, fuv, fvv = jet_a[1], jet_a[2], jet_a[3], jet_a[4], jet_a[5]
    dR = sub(jet_a[0], jet_b[0])
    n = unit_normal(jet_b)
    n_r, n_s = normal_partials(jet_b, n)
    J[0, 0] = dot(fu, fu) + dot(dR, fuu)
    J[0, 1] = dot(fu, fv) + dot(dR, fuv)
    J[1, 0] = J[0, 1]
    J[1, 1] = dot(fv, fv) + dot(dR, fvv)
    J[0, 2], J[0, 3] = -dot(fu, jet_b[1]), -dot(fu, jet_b[2])
    J[1, 2], J[1, 3] = -dot(fv, jet_b[1]), -dot(fv, jet_b[2])
    J[2, 0], J[2, 1] = dot(n, fuu), dot(n, fuv)
    J[3, 0], J[3, 1] = dot(n, fuv), dot(n, fvv)
    J[2, 2], J[2, 3] = dot(fu, n_r), dot(fu, n_s)
    J[3, 2], J[3, 3] = dot(fv, n_r), dot(fv, n_s)


@own_kernel
def normals_feedforward(jet_a, jet_b, motion_a, motion_b):
    """r_t, the rate of r from the bodies' motion: F' dV(x_h), then F' ((w_B - w_A) x n_h)."""
    x_h = jet_b[0]
    slip = sub(point_velocity(x_h, motion_a), point_velocity(x_h, motion_b))
    turn = cross(sub(motion_b[2], motion_a[2]), unit_normal(jet_b))
    return dot(jet_a[1], slip), dot(jet_a[2], slip), dot(jet_a[1], turn), dot(jet_a[2], turn)


@own_kernel
def vector(rows, k):
    return (rows[k, 0], rows[k, 1], rows[k, 2])


@own_kernel
def jet(rows):
    return (
        vector(rows, 0),
        vector(rows, 1),
        vector(rows, 2),
        vector(rows, 3),
        vector(rows, 4),
        vector(rows, 5),
    )


@own_kernel
def both_motions(rows):
    """(p, v, w) of A and of B, as feedforward takes them."""
    return (
        (vector(rows, 0), vector(rows, 1), vector(rows, 2)),
        (vector(rows, 3), vector(rows, 4), vector(rows, 5)),
    )


# Called from Python, for batches: jets of A and B and the motions are arrays (n, 6, 3).


@own_kernel
def evaluate_normals(jets_a, jets_b, motions, r, J, r_t):
    """Into r (n, 4), J (n, 4, 4) and r_t (n, 4): the set of reference [28]."""
    for k in range(len(jets_a)):
        a, b, m = jet(jets_a[k]), jet(jets_b[k]), both_motions(motions[k])
        residual = normals_residual(a, b)
        rate = normals_feedforward(a, b, m[0], m[1])
        normals_jacobian(a, b, J[k])
        for i in range(4):
            r[k, i], r_t[k, i] = residual[i], rate[i]


@own_kernel
def evaluate_projection_errors(jets_a, jets_b, motions, Psi, M, b):
    """Into Psi (n, 4), M (n, 4, 4) and b (n, 4): Eqs. (1)-(14)."""
    for k in range(len(jets_a)):
        first, second, m = jet(jets_a[k]), jet(jets_b[k]), both_motions(motions[k])
        errors = projection_errors(first, second)
        rate = feedforward(first, second, m[0], m[1])
        H = hessian(first, second)
        at = 0
        for i in range(4):
            Psi[k, i], b[k, i] = errors[i], rate[i]
            for j in range(i, 4):
                # M = S H, with S = diag(1, 1, -1, -1)
                M[k, i, j] = H[at] if i < 2 else -H[at]
                M[k, j, i] = H[at] if j < 2 else -H[at]
                at += 1


@own_kernel
def evaluate_contact(jets_a, jets_b, normals, depths, motions, r, J, r_t):
    """Into r (n, 8), J (n, 8, 8) and r_t (n, 8): the contact-regular form at (q, n, d)."""
    for k in range(len(jets_a)):
        a, b, m = jet(jets_a[k]), jet(jets_b[k]), both_motions(motions[k])
        n = vector(normals, k)
        residual = contact_residual(a, b, n, depths[k])
        rate = contact_feedforward(a, b, n, m[0], m[1])
        contact_jacobian(a, b, n, depths[k], pointer(J.ravel(), 64 * k))
        for i in range(8):
            r[k, i], r_t[k, i] = residual[i], rate[i]
