"""Where a straight line of the (u, v) plane meets a trimming curve.

Lines and conics in closed form; a Bezier piece turns by less than 180 degrees, so a line meets it
at most twice, on both sides of the one point that is farthest along the line's normal.
"""

from math import atan2, hypot, inf, pi

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.body import layout as L
from standoff.kernels.body.jets import pcurve_jet
from standoff.kernels.compiler.decorators import uncontracted
from standoff.kernels.tolerances import (
    BRACKET_ROUNDINGS,
    EPS,
    HULL_SPARE,
    NEAR_TANGENT,
    PCURVE_OVERLAP,
)

HALF_TURN = pi
# Instead of a count: the line touches the curve but for noise, and its two roots are one. Then
# t1 is where, and t2 is the side of the line on which the curve lies: negative on its left.
TOUCHING_LINE = -1
# Steps of a bracketed root: regula falsi (Illinois) needs some ten, bisection never more.
ROOT_STEPS = 80


@uncontracted
def line_roots(reals, kind, o, u, v, du, dv, noise):
    """(count, t1, t2): parameters where the pcurve meets the line through (u, v) along (du, dv).

    noise : how far (parameter units) a curve may miss the line and still touch it.
    """
    a, b = dv, -du
    c = -(a * u + b * v)
    if kind == L.BEZIER:
        return bezier_roots(reals, o, (a, b, c), noise)
    m0 = a * reals[o] + b * reals[o + 3] + c * reals[o + 6]
    m1 = a * reals[o + 1] + b * reals[o + 4] + c * reals[o + 7]
    m2 = a * reals[o + 2] + b * reals[o + 5] + c * reals[o + 8]
    if kind == L.LINE:
        if m0 == 0.0:
            return 0, 0.0, 0.0
        return 1, -m2 / m0, 0.0
    amplitude = hypot(m0, m1)
    if amplitude == 0.0:
        return 0, 0.0, 0.0
    middle = atan2(m1, m0)
    depth = amplitude - abs(m2)  # how far the line cuts in
    if depth < NEAR_TANGENT * amplitude:
        t = middle if m2 < 0.0 else middle + HALF_TURN
        h = pcurve_jet(reals, kind, o, t)[0]
        if h[2] > 0.0 and abs(depth) <= noise * h[2] * hypot(a, b):
            return TOUCHING_LINE, t, m2
    if depth < 0.0:
        return 0, 0.0, 0.0
    half = atan2(sqrt((amplitude - m2) * (amplitude + m2)), -m2)
    return 2, middle + half, middle - half


@uncontracted
def level(reals, o, line, t):
    """(f, slope): height over the line of the pcurve's homogeneous point, and h_2² d(f/h_2)/dt."""
    a, b, c = line
    h, ht, _ = pcurve_jet(reals, L.BEZIER, o, t)
    f = a * h[0] + b * h[1] + c * h[2]
    ft = a * ht[0] + b * ht[1] + c * ht[2]
    return f, ft * h[2] - f * ht[2]


@uncontracted
def bracketed(reals, o, line, which, start, end):
    """Root of `level`'s value (which 0) or slope (1) between two points (t, value), where its signs
    differ."""
    t0, f0 = start
    t1, f1 = end
    least = BRACKET_ROUNDINGS * EPS * (abs(t0) + abs(t1))  # a bracket this wide is a point
    for k in range(ROOT_STEPS):
        if abs(t1 - t0) <= least:
            break
        # every third step halves, so that no bracket stays wide
        t = 0.5 * (t0 + t1) if k % 3 == 2 else (t0 * f1 - t1 * f0) / (f1 - f0)
        # never an end: a root at one is closed in on from the other
        t = min(max(t, min(t0, t1) + 0.5 * least), max(t0, t1) - 0.5 * least)
        f, slope = level(reals, o, line, t)
        if which == 1:
            f = slope
        if f == 0.0:
            return t
        if (f > 0.0) == (f1 > 0.0):
            t1, f1 = t, f
            f0 *= 0.5
        else:
            t0, f0 = t1, f1
            t1, f1 = t, f
    return t1


@uncontracted
def is_off_line(reals, o, line, noise):
    """Do all points of a Bezier pcurve lie on one side of a line, and not near it? Then so does
    the curve, which is in their hull, and a little beyond its ends."""
    a, b, c = line
    low, high, weight = inf, -inf, 0.0
    for i in range(int(reals[o]) + 1):
        p = o + 1 + 3 * i
        f = a * reals[p] + b * reals[p + 1] + c * reals[p + 2]
        low, high, weight = min(low, f), max(high, f), max(weight, reals[p + 2])
    spare = HULL_SPARE * (high - low) + noise * weight * hypot(a, b)
    return low > spare or high < -spare


@uncontracted
def bezier_roots(reals, o, line, noise):
    a, b, _ = line
    if is_off_line(reals, o, line, noise):
        return 0, 0.0, 0.0
    first, last = reals[o - 2], reals[o - 1]
    margin = PCURVE_OVERLAP * (last - first)
    t0, t1 = first - margin, last + margin
    f0, slope0 = level(reals, o, line, t0)
    f1, slope1 = level(reals, o, line, t1)
    if (f0 > 0.0) != (f1 > 0.0):
        return 1, bracketed(reals, o, line, 0, (t0, f0), (t1, f1)), 0.0
    if (slope0 > 0.0) == (slope1 > 0.0):
        # tangent at an end, where roundoff has the farthest point beyond it
        h = pcurve_jet(reals, L.BEZIER, o, t0)[0]
        if abs(f0) <= noise * h[2] * hypot(a, b):
            return TOUCHING_LINE, first, f1
        h = pcurve_jet(reals, L.BEZIER, o, t1)[0]
        if abs(f1) <= noise * h[2] * hypot(a, b):
            return TOUCHING_LINE, last, f0
        return 0, 0.0, 0.0
    t = bracketed(reals, o, line, 1, (t0, slope0), (t1, slope1))
    f = level(reals, o, line, t)[0]
    h = pcurve_jet(reals, L.BEZIER, o, t)[0]
    if abs(f) <= noise * h[2] * hypot(a, b):
        return TOUCHING_LINE, t, f0 if abs(f0) > abs(f1) else f1
    if (f > 0.0) != (f0 > 0.0):
        before = bracketed(reals, o, line, 0, (t0, f0), (t, f))
        return 2, before, bracketed(reals, o, line, 0, (t, f), (t1, f1))
    return 0, 0.0, 0.0
