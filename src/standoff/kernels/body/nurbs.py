"""Jets of rational Bezier curves and nets, and of the NURBS made of them.

A NURBS is kept as its Bezier pieces: a span is looked up, then one evaluator serves every degree
and weight. Points are homogeneous, (w x, w y, w z, w).
"""

from standoff.kernels.compiler.decorators import kernel, small, stack_reals


@small
def unrolled_basis(n, t, out):
    """The n + 1 Bernstein polynomials at t, their first and their second derivatives, in turn.

    By raising the degree from 0: on [0, 1] every sum is of one sign, so nothing cancels. The
    derivatives are differences of the two degrees before the last.
    """
    s = 1.0 - t
    m = n + 1
    for i in range(3 * m):
        out[i] = 0.0
    out[0] = 1.0
    for k in range(1, n + 1):
        # out holds degree k - 1
        if k == n - 1:
            for i in range(m):
                a = out[i - 2] if i >= 2 else 0.0
                b = out[i - 1] if 1 <= i <= n - 1 else 0.0
                c = out[i] if i <= n - 2 else 0.0
                out[2 * m + i] = n * (n - 1) * (a - 2.0 * b + c)
        if k == n:
            for i in range(m):
                a = out[i - 1] if i >= 1 else 0.0
                b = out[i] if i <= n - 1 else 0.0
                out[m + i] = n * (a - b)
        out[k] = t * out[k - 1]
        for i in range(k - 1, 0, -1):
            out[i] = s * out[i] + t * out[i - 1]
        out[0] = s * out[0]


@kernel
def bernstein_basis(n, t, out):
    """`unrolled_basis`, whose loops are unrolled where the degree is a constant, as a call."""
    unrolled_basis(n, t, out)


@kernel
def span_of(reals, o, n, t):
    """The span of the n + 1 breaks at reals[o:] that holds t; the first or last beyond them."""
    low, high = 0, n
    while high - low > 1:
        middle = (low + high) // 2
        if t >= reals[o + middle]:
            low = middle
        else:
            high = middle
    return low


@small
def quotient(h, w, x, n):
    """(h - n x)/w by components: one term of the quotient rule."""
    return ((h[0] - n * x[0]) / w, (h[1] - n * x[1]) / w, (h[2] - n * x[2]) / w)


@kernel
def bezier_jet(reals, o, n, t):
    """(x, x_t, x_tt) of the rational Bezier curve of degree n whose points begin at reals[o]."""
    basis = stack_reals()
    bernstein_basis(n, t, basis)
    m = n + 1
    hx = hy = hz = hw = 0.0
    dx = dy = dz = dw = 0.0
    ex = ey = ez = ew = 0.0
    for i in range(m):
        b0, b1, b2 = basis[i], basis[m + i], basis[2 * m + i]
        k = o + 4 * i
        px, py, pz, pw = reals[k], reals[k + 1], reals[k + 2], reals[k + 3]
        hx += b0 * px
        hy += b0 * py
        hz += b0 * pz
        hw += b0 * pw
        dx += b1 * px
        dy += b1 * py
        dz += b1 * pz
        dw += b1 * pw
        ex += b2 * px
        ey += b2 * py
        ez += b2 * pz
        ew += b2 * pw
    x = (hx / hw, hy / hw, hz / hw)
    xt = quotient((dx, dy, dz), hw, x, dw)
    two = (ex - 2.0 * dw * xt[0], ey - 2.0 * dw * xt[1], ez - 2.0 * dw * xt[2])
    return x, xt, quotient(two, hw, x, ew)


@kernel
def nurbs_curve_jet(reals, o, t):
    n, spans = int(reals[o]), int(reals[o + 1])
    k = span_of(reals, o + 2, spans, t)
    t0 = reals[o + 2 + k]
    rate = 1.0 / (reals[o + 3 + k] - t0)
    x, xt, xtt = bezier_jet(reals, o + 3 + spans + 4 * (n + 1) * k, n, (t - t0) * rate)
    return (
        x,
        (xt[0] * rate, xt[1] * rate, xt[2] * rate),
        (xtt[0] * rate * rate, xtt[1] * rate * rate, xtt[2] * rate * rate),
    )


@kernel
def net_jet(reals, o, degrees, at, rates):
    """`net_jet_of` any degrees."""
    return net_jet_of(bernstein_basis, reals, o, degrees, at, rates)


@small
def net_jet_of(basis, reals, o, degrees, at, rates):
    """Jet of a rational Bezier net at local (s, t), by a function that gives the polynomials; the
    rates are ds/du and dt/dv."""
    (p, q), (s, t), (ru, rv) = degrees, at, rates
    bu = stack_reals()
    bv = stack_reals()
    basis(p, s, bu)
    basis(q, t, bv)
    m, n = p + 1, q + 1
    h = stack_reals()  # H, H_s, H_t, H_ss, H_st, H_tt: four numbers each
    for k in range(24):
        h[k] = 0.0
    for i in range(m):
        u0, u1, u2 = bu[i], bu[m + i], bu[2 * m + i]
        for c in range(4):
            c0 = c1 = c2 = 0.0
            k = o + 4 * n * i + c
            for j in range(n):
                x = reals[k + 4 * j]
                c0 += bv[j] * x
                c1 += bv[n + j] * x
                c2 += bv[2 * n + j] * x
            h[c] += u0 * c0
            h[4 + c] += u1 * c0
            h[8 + c] += u0 * c1
            h[12 + c] += u2 * c0
            h[16 + c] += u1 * c1
            h[20 + c] += u0 * c2
    w = h[3]
    wu, wv = h[7], h[11]
    x = (h[0] / w, h[1] / w, h[2] / w)
    xu = quotient((h[4], h[5], h[6]), w, x, wu)
    xv = quotient((h[8], h[9], h[10]), w, x, wv)
    uu = (h[12] - 2.0 * wu * xu[0], h[13] - 2.0 * wu * xu[1], h[14] - 2.0 * wu * xu[2])
    uv = (
        h[16] - wu * xv[0] - wv * xu[0],
        h[17] - wu * xv[1] - wv * xu[1],
        h[18] - wu * xv[2] - wv * xu[2],
    )
    vv = (h[20] - 2.0 * wv * xv[0], h[21] - 2.0 * wv * xv[1], h[22] - 2.0 * wv * xv[2])
    xuu = quotient(uu, w, x, h[15])
    xuv = quotient(uv, w, x, h[19])
    xvv = quotient(vv, w, x, h[23])
    a, b, c = ru * ru, ru * rv, rv * rv
    return (
        x,
        (xu[0] * ru, xu[1] * ru, xu[2] * ru),
        (xv[0] * rv, xv[1] * rv, xv[2] * rv),
        (xuu[0] * a, xuu[1] * a, xuu[2] * a),
        (xuv[0] * b, xuv[1] * b, xuv[2] * b),
        (xvv[0] * c, xvv[1] * c, xvv[2] * c),
    )


@kernel
def nurbs_jet(reals, o, u, v):
    """Jet of a NURBS surface kept as its grid of Bezier nets (see ``layout.NURBS``)."""
    net, at, rates = net_at(reals, o, u, v)
    return net_jet(reals, net, (int(reals[o]), int(reals[o + 1])), at, rates)


@small
def net_at(reals, o, u, v):
    """(where the Bezier net begins that holds (u, v), its own parameters there, their rates)."""
    p, q = int(reals[o]), int(reals[o + 1])
    spans_u, spans_v = int(reals[o + 2]), int(reals[o + 3])
    breaks_u, breaks_v = o + 4, o + 5 + spans_u
    i = span_of(reals, breaks_u, spans_u, u)
    j = span_of(reals, breaks_v, spans_v, v)
    u0, v0 = reals[breaks_u + i], reals[breaks_v + j]
    ru = 1.0 / (reals[breaks_u + i + 1] - u0)
    rv = 1.0 / (reals[breaks_v + j + 1] - v0)
    net = breaks_v + spans_v + 1 + 4 * (p + 1) * (q + 1) * (i * spans_v + j)
    return net, ((u - u0) * ru, (v - v0) * rv), (ru, rv)
