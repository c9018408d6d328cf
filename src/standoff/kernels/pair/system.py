"""The pair system: Eqs. (1)-(14) of Patoglu and Gillespie (2005) and the contact-regular form.

Every feature pair is this one system. A feature is given by its jet with the columns it lacks
set to zero: an edge has no second tangent, a vertex none. Rows and columns of such parameters
vanish from Psi, b and g and are the identity in H, so they stay where they are.

All quantities of one call are in one frame. Notation as in the paper: x_f on A, x_h on B,
F = [f_u f_v], G = [h_r h_s], dR = x_f - x_h. S = diag(1, 1, -1, -1).
"""

from standoff.kernels.algebra.vectors import active, add, cross, dot, scale, sub
from standoff.kernels.compiler.decorators import small
from standoff.kernels.tolerances import SHORT_TANGENT


@small
def projection_errors(jet_a, jet_b):
    """Psi = (f_u.dR, f_v.dR, h_r.dR, h_s.dR): the errors to be driven to zero.  Eqs. (1)-(4)"""
    dR = sub(jet_a[0], jet_b[0])
    return dot(jet_a[1], dR), dot(jet_a[2], dR), dot(jet_b[1], dR), dot(jet_b[2], dR)


@small
def gradient(psi):
    """g = S Psi, the gradient of E = |dR|²/2 by q = (u, v, r, s)."""
    return psi[0], psi[1], -psi[2], -psi[3]


@small
def energy(jet_a, jet_b):
    dR = sub(jet_a[0], jet_b[0])
    return 0.5 * dot(dR, dR)


@small
def diagonal(x, tangent):
    """An entry of the diagonal of H or J; 1 where the parameter is masked, its tangent zero.

    The sum with that 1 rounds the entry, by some eps of it. Where the tangent is short, that would
    be more than it has to say.
    """
    if 0.0 < dot(tangent, tangent) < SHORT_TANGENT:
        return x
    return x + 1.0 - active(tangent)


@small
def hessian(jet_a, jet_b):
    """H = S M, the Hessian of E, with M of Eq. (9).

    Upper triangle by rows: (H00, H01, H02, H03, H11, H12, H13, H22, H23, H33); a masked
    parameter has 1 on the diagonal.
    """
    dR = sub(jet_a[0], jet_b[0])
    fu, fv, fuu, fuv, fvv = jet_a[1], jet_a[2], jet_a[3], jet_a[4], jet_a[5]
    hr, hs, hrr, hrs, hss = jet_b[1], jet_b[2], jet_b[3], jet_b[4], jet_b[5]
    return (
        diagonal(dot(fu, fu) + dot(dR, fuu), fu),
        dot(fu, fv) + dot(dR, fuv),
        -dot(fu, hr),
        -dot(fu, hs),
        diagonal(dot(fv, fv) + dot(dR, fvv), fv),
        -dot(fv, hr),
        -dot(fv, hs),
        diagonal(dot(hr, hr) - dot(dR, hrr), hr),
        dot(hr, hs) - dot(dR, hrs),
        diagonal(dot(hs, hs) - dot(dR, hss), hs),
    )


@small
def bending(away, jet):
    """(uu, uv, vv): away·II, of the second derivatives the part along the normal, or along what is
    square to an edge's tangent; 0 where it is negative.

    `away` is x - y, from the opposing point y. Over a convex patch it is semidefinite: positive
    where y is in front of the tangent plane, negative behind it. What is left out, the part along
    the tangents, belongs to the parametrisation, and vanishes with Psi.
    """
    xu, xv = jet[1], jet[2]
    if active(xu) == 0.0 or active(xv) == 0.0:
        t, tt = (xv, jet[5]) if active(xu) == 0.0 else (xu, jet[3])
        square = dot(t, t)
        along = dot(tt, t) / square if square > 0.0 else 0.0
        bent = max(dot(away, tt) - along * dot(away, t), 0.0)
        return (0.0, 0.0, bent) if active(xu) == 0.0 else (bent, 0.0, 0.0)
    n = cross(xu, xv)
    square = dot(n, n)
    height = dot(away, n) / square if square > 0.0 else 0.0
    uu, uv, vv = height * dot(n, jet[3]), height * dot(n, jet[4]), height * dot(n, jet[5])
    return (uu, uv, vv) if uu + vv > 0.0 else (0.0, 0.0, 0.0)


@small
def covariant_hessian(jet_a, jet_b):
    """H of the first fundamental forms plus the distance times the second ones, laid out as by
    `hessian`, to which it is equal where Psi is 0.

    (F x - G y)² + s_A x'II_A x + s_B y'II_B y with s = max(height of the opposing point, 0): of
    convex bodies semidefinite anywhere, and the same in every parametrisation.
    """
    dR = sub(jet_a[0], jet_b[0])
    fu, fv, hr, hs = jet_a[1], jet_a[2], jet_b[1], jet_b[2]
    a_uu, a_uv, a_vv = bending(dR, jet_a)
    b_rr, b_rs, b_ss = bending(scale(-1.0, dR), jet_b)
    return (
        diagonal(dot(fu, fu) + a_uu, fu),
        dot(fu, fv) + a_uv,
        -dot(fu, hr),
        -dot(fu, hs),
        diagonal(dot(fv, fv) + a_vv, fv),
        -dot(fv, hr),
        -dot(fv, hs),
        diagonal(dot(hr, hr) + b_rr, hr),
        dot(hr, hs) + b_rs,
        diagonal(dot(hs, hs) + b_ss, hs),
    )


@small
def point_velocity(x, motion):
    """V(x) = v + w x (x - p): velocity of the body's point now at x."""
    p, v, w = motion
    return add(v, cross(w, sub(x, p)))


@small
def feedforward(jet_a, jet_b, motion_a, motion_b):
    """b = (F' dV(x_h), G' dV(x_f)), with dV = V_A - V_B and the points crossed.  Eq. (10)

    A motion is (p, v, w): a body's origin, its velocity and the angular velocity. The paper prints
    b for rotation only; the translation is here too.
    """
    x_f, x_h = jet_a[0], jet_b[0]
    at_h = sub(point_velocity(x_h, motion_a), point_velocity(x_h, motion_b))
    at_f = sub(point_velocity(x_f, motion_a), point_velocity(x_f, motion_b))
    return dot(jet_a[1], at_h), dot(jet_a[2], at_h), dot(jet_b[1], at_f), dot(jet_b[2], at_f)


@small
def contact_residual(jet_a, jet_b, n, d):
    """r of the contact-regular form in y = (q, n, d): 8 numbers."""
    miss = sub(sub(jet_b[0], jet_a[0]), scale(d, n))
    return (
        -dot(jet_a[1], n),
        -dot(jet_a[2], n),
        dot(jet_b[1], n),
        dot(jet_b[2], n),
        miss[0],
        miss[1],
        miss[2],
        0.5 * (1.0 - dot(n, n)),
    )


@small
def at(i, j):
    """Where row i and column j of an 8 x 8 matrix by rows stand."""
    return 8 * i + j


@small
def contact_jacobian(jet_a, jet_b, n, d, J):
    """J = dr/dy into J, 64 numbers; symmetric. Masked parameters get 1 on the diagonal."""
    fu, fv = jet_a[1], jet_a[2]
    hr, hs = jet_b[1], jet_b[2]
    for k in range(64):
        J[k] = 0.0
    J[at(0, 0)] = diagonal(-dot(n, jet_a[3]), fu)
    J[at(0, 1)] = -dot(n, jet_a[4])
    J[at(1, 1)] = diagonal(-dot(n, jet_a[5]), fv)
    J[at(2, 2)] = diagonal(dot(n, jet_b[3]), hr)
    J[at(2, 3)] = dot(n, jet_b[4])
    J[at(3, 3)] = diagonal(dot(n, jet_b[5]), hs)
    for i in range(3):
        J[at(0, 4 + i)] = -fu[i]
        J[at(1, 4 + i)] = -fv[i]
        J[at(2, 4 + i)] = hr[i]
        J[at(3, 4 + i)] = hs[i]
        J[at(4 + i, 4 + i)] = -d
        J[at(4 + i, 7)] = -n[i]
    for i in range(8):
        for j in range(i):
            J[at(i, j)] = J[at(j, i)]


@small
def contact_feedforward(jet_a, jet_b, n, motion_a, motion_b):
    """r_t, the partial time derivative of r under the bodies' motion: 8 numbers."""
    spin_a = cross(n, motion_a[2])
    spin_b = cross(n, motion_b[2])
    slip = sub(point_velocity(jet_b[0], motion_b), point_velocity(jet_a[0], motion_a))
    return (
        -dot(jet_a[1], spin_a),
        -dot(jet_a[2], spin_a),
        dot(jet_b[1], spin_b),
        dot(jet_b[2], spin_b),
        slip[0],
        slip[1],
        slip[2],
        0.0,
    )
