"""The greatest value of a quadratic function over an interval or a rectangle."""

from math import inf

from standoff.kernels.compiler.decorators import kernel


@kernel
def line_max(g, c, lo, hi):
    """The greatest g e + c e² / 2 for lo <= e <= hi."""
    best = max(g * lo + 0.5 * c * lo * lo, g * hi + 0.5 * c * hi * hi)
    if c < 0.0 and lo < -g / c < hi:
        best = max(best, -0.5 * g * g / c)
    return best


@kernel
def quadratic_max(g, H, e):
    """The greatest g . e + eᵀ H e / 2 over a rectangle; H = (uu, uv, vv), e = (u0, u1, v0, v1)."""
    gu, gv = g
    a, b, c = H
    best = -inf
    for k in range(2):
        eu, ev = e[k], e[2 + k]
        best = max(best, gu * eu + 0.5 * a * eu * eu + line_max(gv + b * eu, c, e[2], e[3]))
        best = max(best, gv * ev + 0.5 * c * ev * ev + line_max(gu + b * ev, a, e[0], e[1]))
    det = a * c - b * b
    if a < 0.0 and det > 0.0:
        eu, ev = (b * gv - c * gu) / det, (b * gu - a * gv) / det
        if e[0] < eu < e[1] and e[2] < ev < e[3]:
            best = max(best, 0.5 * (gu * eu + gv * ev))
    return best


@kernel
def widened(second, thirds, spread, mu, mv):
    """Second derivatives that bound F with its remainder for |e_u| <= mu, |e_v| <= mv."""
    a, b, c = second
    return (
        a + (thirds[0] * mu + 3.0 * thirds[1] * mv) / 3.0 + spread[0] + spread[1],
        b,
        c + (3.0 * thirds[2] * mu + thirds[3] * mv) / 3.0 + spread[2] + spread[1],
    )
