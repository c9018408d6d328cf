"""The control law w = -M⁻¹(K Psi + b), Eq. (12), with its one rank rule.

H is taken in the metric D = blkdiag(F'F, G'G) of the surfaces' tangents: with the Cholesky
factor D = L L', whitened coordinates measure lengths on the bodies, so thresholds are free of
units and of the parametrisation.
"""

from math import inf
from typing import NamedTuple

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.symmetric import symmetric_eigen
from standoff.kernels.algebra.vectors import dot
from standoff.kernels.compiler.decorators import kernel, shared, stack_reals
from standoff.kernels.tolerances import (
    EPS,
    GRADIENT_NOISE,
    LEAN,
    NEGATIVE,
    PIVOT,
    PIVOT_ROUNDINGS,
    REACH,
    SHARP,
    STIFF,
)


@kernel
def metric_inverse(f1, f2):
    """(i11, i21, i22) of the inverse Cholesky factor of F'F; 1 for a masked parameter."""
    e = dot(f1, f1)
    a11 = sqrt(e) if e > 0.0 else 1.0
    g = dot(f2, f2)
    if g == 0.0:
        return 1.0 / a11, 0.0, 1.0
    a21 = dot(f1, f2) / a11
    rest = g - a21 * a21
    # f_v along f_u is no chart; the floor only keeps a division finite at the chart's very rim
    a22 = sqrt(max(rest, EPS * g))
    return 1.0 / a11, -a21 / (a11 * a22), 1.0 / a22


class Metric(NamedTuple):
    """D = F'F of one body's tangents, factored: its pivots are the squares of L's diagonal."""

    first: float  # 1 / (f_u.f_u)
    across: float  # f_u.f_v / f_u.f_u
    second: float  # 1 / the second pivot


@kernel
def metric(f1, f2):
    """The factored F'F; 1 for a masked parameter."""
    e, g, c = dot(f1, f1), dot(f2, f2), dot(f1, f2)
    first = 1.0 / e if e > 0.0 else 1.0
    across = c * first
    # f_v along f_u is no chart; the floor only keeps a division finite at the chart's very rim
    second = 1.0 / max(g - across * c, EPS * g) if g > 0.0 else 1.0
    return Metric(first, across, second)


@kernel
def pair_metric(jet_a, jet_b):
    return metric(jet_a[1], jet_a[2]), metric(jet_b[1], jet_b[2])


@kernel
def metric_norm(metrics, g):
    """|g| in the metric D: a length² per length, the slope of E on the bodies."""
    a, b = metrics
    along_a, along_b = g[1] - a.across * g[0], g[3] - b.across * g[2]
    of_a = g[0] * g[0] * a.first + along_a * along_a * a.second
    return sqrt(of_a + g[2] * g[2] * b.first + along_b * along_b * b.second)


@kernel
def whiten_gradient(ia, ib, g):
    return (
        ia[0] * g[0],
        ia[1] * g[0] + ia[2] * g[1],
        ib[0] * g[2],
        ib[1] * g[2] + ib[2] * g[3],
    )


@kernel
def unwhiten_step(ia, ib, p):
    return (
        ia[0] * p[0] + ia[1] * p[1],
        ia[2] * p[1],
        ib[0] * p[2] + ib[1] * p[3],
        ib[2] * p[3],
    )


@kernel
def whiten_hessian(ia, ib, H):
    h00, h01, h02, h03, h11, h12, h13, h22, h23, h33 = H
    # rows of A, then of B, of L⁻¹ H; the columns of the same after
    m10 = ia[1] * h00 + ia[2] * h01
    m11 = ia[1] * h01 + ia[2] * h11
    m12 = ia[1] * h02 + ia[2] * h12
    m13 = ia[1] * h03 + ia[2] * h13
    m02 = ia[0] * h02
    m03 = ia[0] * h03
    m32 = ib[1] * h22 + ib[2] * h23
    m33 = ib[1] * h23 + ib[2] * h33
    return (
        ia[0] * h00 * ia[0],
        m10 * ia[0],
        m02 * ib[0],
        m02 * ib[1] + m03 * ib[2],
        m10 * ia[1] + m11 * ia[2],
        m12 * ib[0],
        m12 * ib[1] + m13 * ib[2],
        ib[0] * h22 * ib[0],
        m32 * ib[0],
        m32 * ib[1] + m33 * ib[2],
    )


@kernel
def ldl(H):
    """H = L D L' without pivoting: (pivots, their reciprocals, (l10, l20, l30, l21, l31, l32)).

    A pivot may be <= 0; of 0 the reciprocal is given as 0.
    """
    h00, h01, h02, h03, h11, h12, h13, h22, h23, h33 = H
    d0 = h00
    i0 = 1.0 / d0 if d0 != 0.0 else 0.0
    l10, l20, l30 = h01 * i0, h02 * i0, h03 * i0
    d1 = h11 - l10 * h01
    i1 = 1.0 / d1 if d1 != 0.0 else 0.0
    c21 = h12 - l20 * h01
    c31 = h13 - l30 * h01
    l21, l31 = c21 * i1, c31 * i1
    d2 = h22 - l20 * h02 - l21 * c21
    i2 = 1.0 / d2 if d2 != 0.0 else 0.0
    c32 = h23 - l30 * h02 - l31 * c21
    l32 = c32 * i2
    d3 = h33 - l30 * h03 - l31 * c31 - l32 * c32
    i3 = 1.0 / d3 if d3 != 0.0 else 0.0
    return (d0, d1, d2, d3), (i0, i1, i2, i3), (l10, l20, l30, l21, l31, l32)


@kernel
def ldl_solve(factors, g):
    """H⁻¹ g, where no pivot is 0."""
    _, (i0, i1, i2, i3), (l10, l20, l30, l21, l31, l32) = factors
    y0 = g[0]
    y1 = g[1] - l10 * y0
    y2 = g[2] - l20 * y0 - l21 * y1
    y3 = g[3] - l30 * y0 - l31 * y1 - l32 * y2
    x3 = y3 * i3
    x2 = y2 * i2 - l32 * x3
    x1 = y1 * i1 - l21 * x2 - l31 * x3
    x0 = y0 * i0 - l10 * x1 - l20 * x2 - l30 * x3
    return x0, x1, x2, x3


@kernel
def negate(a):
    return -a[0], -a[1], -a[2], -a[3]


@kernel
def eigen(H, V, values):
    """The largest magnitude of the eigenvalues of a whitened H; these, ascending, into `values`,
    unit vectors into V: 4 numbers each. Negative where H is not finite.
    """
    k = 0
    for i in range(4):
        for j in range(i, 4):
            V[4 * i + j] = H[k]
            V[4 * j + i] = H[k]
            k += 1
    if not symmetric_eigen(V, values, 4):
        return -1.0
    return max(abs(values[0]), abs(values[3]))


@kernel
def decomposed_solve(H, g, g_t, noise, scale):
    """Newton step and feedforward where H is not safely positive definite (whitened).

    Magnitudes for negative eigenvalues; a flat direction without slope is dropped (minimum
    norm: truly parallel), one with a slope is walked REACH scales, to its face's boundary.
    Without finite numbers there is no step.
    """
    V, values, p, w = stack_reals(), stack_reals(), stack_reals(), stack_reals()
    for j in range(4):
        p[j], w[j] = 0.0, 0.0
    top = eigen(H, V, values)
    if top < 0.0:
        return (0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)
    for i in range(4):
        slope = 0.0
        drift = 0.0
        for j in range(4):
            slope += V[4 * i + j] * g[j]
            drift += V[4 * i + j] * g_t[j]
        lam = values[i]
        if abs(lam) > NEGATIVE * top:
            along = -slope / abs(lam)
            forward = -drift / lam
        else:
            forward = 0.0
            along = 0.0
            if abs(slope) > noise:
                along = -slope / max(abs(lam), abs(slope) / (REACH * scale))
        limit = REACH * scale
        along = max(-limit, min(limit, along))
        for j in range(4):
            p[j] += V[4 * i + j] * along
            w[j] += V[4 * i + j] * forward
    return (p[0], p[1], p[2], p[3]), (w[0], w[1], w[2], w[3])


@kernel
def stiff_step(jet_a, jet_b, g, H):
    """The part of the Newton step that lies in the stiff directions of H alone.

    A long step in a flat direction of curved features leaves the valley's floor (a rim's witness
    moves on a circle, its partner on a plane straight on); this brings it back.
    """
    ia = metric_inverse(jet_a[1], jet_a[2])
    ib = metric_inverse(jet_b[1], jet_b[2])
    gw = whiten_gradient(ia, ib, g)
    V, values, p = stack_reals(), stack_reals(), stack_reals()
    top = eigen(whiten_hessian(ia, ib, H), V, values)
    for j in range(4):
        p[j] = 0.0
    if top < 0.0:
        return 0.0, 0.0, 0.0, 0.0
    for i in range(4):
        if values[i] > STIFF * top:
            v = 4 * i
            slope = V[v] * gw[0] + V[v + 1] * gw[1] + V[v + 2] * gw[2] + V[v + 3] * gw[3]
            for j in range(4):
                p[j] -= V[v + j] * slope / values[i]
    return unwhiten_step(ia, ib, (p[0], p[1], p[2], p[3]))


@kernel
def levelled(inverse, first, second):
    """An inverse metric whose whitened Hessian has a diagonal of at most 1."""
    a = 1.0 / sqrt(max(first, 1.0))
    b = 1.0 / sqrt(max(second, 1.0))
    return inverse[0] * a, inverse[1] * b, inverse[2] * b


@kernel
def plainly_definite(metrics, H, pivots):
    """(does H pass the law's rank rule by far, is every direction stiff): by the pivots of H
    itself.

    L⁻¹ H L⁻ᵀ with a lower triangular L has the pivots of H over those of D. Where they are all
    above LEAN of its greatest diagonal, no factor's square exceeds 1 / LEAN, and the bound of the
    rank rule is far below; where not, the rule itself decides.
    """
    a, b = metrics
    least = min(
        min(pivots[0] * a.first, pivots[1] * a.second),
        min(pivots[2] * b.first, pivots[3] * b.second),
    )
    h_a = (H[4] - 2.0 * a.across * H[1] + a.across * a.across * H[0]) * a.second
    h_b = (H[9] - 2.0 * b.across * H[8] + b.across * b.across * H[7]) * b.second
    top = max(max(H[0] * a.first, h_a), max(H[7] * b.first, h_b))
    return top <= SHARP and least > LEAN * top, least > STIFF * top


@kernel
def law(metrics, jet_a, jet_b, g, H, g_t, scale):
    """(p, w_ff, regularised, flat, sharp): p = -H⁻¹ g, w_ff = -H⁻¹ g_t.

    Eq. (12) is w = K p + w_ff. `regularised` is 1 where H had to be decomposed, `flat` 1 where
    it has a direction that is not stiff, `sharp` where one is curved as beside a crease.
    """
    factors = ldl(H)
    safe, stiff = plainly_definite(metrics, H, factors[0])
    if safe:
        p, w = negate(ldl_solve(factors, g)), negate(ldl_solve(factors, g_t))
        return p, w, 0, 0 if stiff else 1, False
    return ranked_law(jet_a, jet_b, g, H, g_t, scale)


@shared
def ranked_law(jet_a, jet_b, g, H, g_t, scale):
    """`law` by its rank rule."""
    ia = metric_inverse(jet_a[1], jet_a[2])
    ib = metric_inverse(jet_b[1], jet_b[2])
    Hw = whiten_hessian(ia, ib, H)
    top = max(max(Hw[0], Hw[4]), max(Hw[7], Hw[9]))
    sharp = top > SHARP
    if sharp:
        # a direction of great curvature must not make the others look flat
        ia, ib = levelled(ia, Hw[0], Hw[4]), levelled(ib, Hw[7], Hw[9])
        Hw = whiten_hessian(ia, ib, H)
        top = 1.0
    gw, tw = whiten_gradient(ia, ib, g), whiten_gradient(ia, ib, g_t)
    factors = ldl(Hw)
    pivots, _, lower = factors
    least = min(min(pivots[0], pivots[1]), min(pivots[2], pivots[3]))
    # a pivot that ought to vanish keeps the roundings of those before it, times l²
    growth = 1.0
    for k in range(6):
        growth += lower[k] * lower[k]
    if least > max(PIVOT, PIVOT_ROUNDINGS * EPS * growth) * top:
        p, w = negate(ldl_solve(factors, gw)), negate(ldl_solve(factors, tw))
        flat = 0 if least > STIFF * top else 1
        return unwhiten_step(ia, ib, p), unwhiten_step(ia, ib, w), 0, flat, sharp
    noise = GRADIENT_NOISE * EPS * scale
    p, w = decomposed_solve(Hw, gw, tw, noise, scale)
    return unwhiten_step(ia, ib, p), unwhiten_step(ia, ib, w), 1, 1, sharp


@kernel
def plain_law(jet_a, jet_b, g, H, g_t):
    """(p, w_ff, solved) of H as it is, be it indefinite: the raw law, without any safeguard.

    Where a pivot vanishes there is no step: solved is 0.
    """
    ia = metric_inverse(jet_a[1], jet_a[2])
    ib = metric_inverse(jet_b[1], jet_b[2])
    factors = ldl(whiten_hessian(ia, ib, H))
    d = factors[0]
    if d[0] == 0.0 or d[1] == 0.0 or d[2] == 0.0 or d[3] == 0.0:
        return (0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0), 0
    p = unwhiten_step(ia, ib, negate(ldl_solve(factors, whiten_gradient(ia, ib, g))))
    w = unwhiten_step(ia, ib, negate(ldl_solve(factors, whiten_gradient(ia, ib, g_t))))
    total = 0.0
    for k in range(4):
        total += abs(p[k]) + abs(w[k])
    if total < inf:
        return p, w, 1
    return (0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0), 0


@kernel
def gradient_norm(jet_a, jet_b, g):
    """|g| in the metric D of the jets' tangents."""
    return metric_norm(pair_metric(jet_a, jet_b), g)
