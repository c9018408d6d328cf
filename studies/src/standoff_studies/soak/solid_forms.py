"""The closed forms of the study's solids, compiled: distances from plane curves, and signed ones.

Nothing of the library is used. A curve is a row of numbers: its form, 1 where it is no boundary but
closes a loop, up to eight numbers of it, and its ends rounded, so that neighbours end alike.
"""

from __future__ import annotations

from math import atan2, cos, hypot, inf, pi, sin, sqrt
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]

SEGMENT, ARC, CUBIC = 0.0, 1.0, 2.0
ROW = 14
"""Numbers of a curve."""
TURNED, SWEPT, HOLLOWED, ELBOW, EGG = 0, 1, 2, 3, 4
GRID = 33
"""Places of a cubic that Newton's method may begin from."""

compiled: Any = njit(cache=True, error_model="numpy")


class Form(NamedTuple):
    """A solid as the compiled functions read it.

    Attributes
    ----------
    kind : int
    numbers : (8,) array
        Of a swept one its ends, of a hollow one also the cavity's; of an elbow its radius, those of
        its bore and outside, and its leg; semiaxes.
    rows, cavity : (n, ROW) arrays
        Curves of its outline, and of the cavity's.
    """

    kind: int
    numbers: Array
    rows: Array
    cavity: Array


@compiled
def cubic_at(row, t):
    """(x, y) of de Casteljau's rule."""
    s = 1.0 - t
    b0, b1, b2, b3 = s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t
    x = b0 * row[2] + b1 * row[4] + b2 * row[6] + b3 * row[8]
    y = b0 * row[3] + b1 * row[5] + b2 * row[7] + b3 * row[9]
    return x, y


@compiled
def cubic_slopes(row, t):
    """(x', y', x'', y'')."""
    s = 1.0 - t
    c0, c1, c2 = 3.0 * s * s, 6.0 * s * t, 3.0 * t * t
    dx = c0 * (row[4] - row[2]) + c1 * (row[6] - row[4]) + c2 * (row[8] - row[6])
    dy = c0 * (row[5] - row[3]) + c1 * (row[7] - row[5]) + c2 * (row[9] - row[7])
    d0, d1 = row[6] - 2.0 * row[4] + row[2], row[8] - 2.0 * row[6] + row[4]
    e0, e1 = row[7] - 2.0 * row[5] + row[3], row[9] - 2.0 * row[7] + row[5]
    return dx, dy, 6.0 * (s * d0 + t * d1), 6.0 * (s * e0 + t * e1)


@compiled
def place(row, t):
    """A curve's point."""
    if row[0] == SEGMENT:
        return row[2] + t * (row[4] - row[2]), row[3] + t * (row[5] - row[3])
    if row[0] == ARC:
        angle = row[5] + t * (row[6] - row[5])
        return row[2] + row[4] * cos(angle), row[3] + row[4] * sin(angle)
    return cubic_at(row, t)


@compiled
def on_segment(row, x, y):
    """The nearest point."""
    ax, ay = row[4] - row[2], row[5] - row[3]
    t = ((x - row[2]) * ax + (y - row[3]) * ay) / (ax * ax + ay * ay)
    t = min(1.0, max(0.0, t))
    return row[2] + t * ax, row[3] + t * ay


@compiled
def on_arc(row, x, y):
    """The nearest point."""
    ax, ay = x - row[2], y - row[3]
    length = sqrt(ax * ax + ay * ay)
    ux, uy = (ax / length, ay / length) if length > 0.0 else (1.0, 0.0)
    if abs(row[6] - row[5]) <= 6.28:
        low, high = min(row[5], row[6]), max(row[5], row[6])
        turn = (atan2(uy, ux) - low) % (2.0 * pi)
        if turn > high - low:
            px, py = place(row, 0.0)
            qx, qy = place(row, 1.0)
            second = hypot(x - qx, y - qy) < hypot(x - px, y - py)
            return (qx, qy) if second else (px, py)
    return row[2] + row[4] * ux, row[3] + row[4] * uy


@compiled
def cubic_foot(row, x, y, t):
    """The parameter of a nearest point by Newton's method, held near a place of the grid."""
    low, high = max(t - 1.0 / (GRID - 1), 0.0), min(t + 1.0 / (GRID - 1), 1.0)
    for _ in range(12):
        px, py = cubic_at(row, t)
        dx, dy, ddx, ddy = cubic_slopes(row, t)
        ax, ay = px - x, py - y
        slope = ax * dx + ay * dy
        if slope == 0.0:
            break
        if slope < 0.0:
            low = t
        else:
            high = t
        bend = dx * dx + dy * dy + ax * ddx + ay * ddy
        step = t - slope / bend if bend > 0.0 else -1.0
        t = step if low <= step <= high else 0.5 * (low + high)
    return t


@compiled
def on_cubic(row, x, y):
    """The nearest point: from all places of a grid that are nearer than their neighbours."""
    least, fx, fy = inf, 0.0, 0.0
    before, here = inf, inf
    for k in range(GRID + 1):
        after = inf
        if k < GRID:
            px, py = cubic_at(row, k / (GRID - 1.0))
            after = (px - x) ** 2 + (py - y) ** 2
            if after < least and (k == 0 or k == GRID - 1):
                least, fx, fy = after, px, py
        if k > 0 and here <= before and here <= after:
            px, py = cubic_at(row, cubic_foot(row, x, y, (k - 1) / (GRID - 1.0)))
            square = (px - x) ** 2 + (py - y) ** 2
            if square < least:
                least, fx, fy = square, px, py
        before, here = here, after
    return fx, fy


@compiled
def on_curve(row, x, y):
    """The curve's point that is nearest to (x, y)."""
    if row[0] == SEGMENT:
        return on_segment(row, x, y)
    return on_arc(row, x, y) if row[0] == ARC else on_cubic(row, x, y)


@compiled
def beyond_chord(row, x, y):
    """Is a point between the curve and its chord? Of a cubic, with monotone y, at its height."""
    if row[0] == ARC:
        inside = (x - row[2]) ** 2 + (y - row[3]) ** 2 < row[4] ** 2
        if not inside or abs(row[6] - row[5]) > 6.28:
            return inside
        px, py = place(row, 0.0)
        mx, my = place(row, 0.5)
        qx, qy = place(row, 1.0)
        ax, ay = py - qy, qx - px
        return ((x - px) * ax + (y - py) * ay) * ((mx - px) * ax + (my - py) * ay) > 0.0
    if row[0] == CUBIC:
        px, py, qx, qy = row[2], row[3], row[8], row[9]
        if not min(py, qy) < y < max(py, qy):
            return False
        a, b = 0.0, 1.0
        for _ in range(54):
            t = 0.5 * (a + b)
            if (cubic_at(row, t)[1] < y) == (qy > py):
                a = t
            else:
                b = t
        curve = cubic_at(row, 0.5 * (a + b))[0]
        chord = px + (y - py) / (qy - py) * (qx - px)
        return (x < curve) != (x < chord)
    return False


@compiled
def holds(rows, x, y):
    """Is a point inside? Crossings of a ray with the chords, and what lies between these and the
    curves."""
    odd = False
    for k in range(len(rows)):
        row = rows[k]
        px, py, qx, qy = row[10], row[11], row[12], row[13]
        if py != qy and (py > y) != (qy > y) and x < px + (y - py) / (qy - py) * (qx - px):
            odd = not odd
        if beyond_chord(row, x, y):
            odd = not odd
    return odd


@compiled
def nearest(rows, x, y):
    """(distance, x, y) of the nearest point of an outline's boundary."""
    least, fx, fy = inf, 0.0, 0.0
    for k in range(len(rows)):
        if rows[k, 1] == 0.0:
            px, py = on_curve(rows[k], x, y)
            square = (px - x) ** 2 + (py - y) ** 2
            if square < least:
                least, fx, fy = square, px, py
    return sqrt(least), fx, fy


@compiled
def flat_signed(rows, x, y):
    """The distance from an outline, negative inside."""
    length, _, _ = nearest(rows, x, y)
    return -length if holds(rows, x, y) else length


@compiled
def swept_signed(rows, low, high, x, y, z):
    """Of an outline swept along z."""
    flat, tall = flat_signed(rows, x, y), max(low - z, z - high)
    out, up = max(flat, 0.0), max(tall, 0.0)
    return sqrt(out * out + up * up) + min(max(flat, tall), 0.0)


@compiled
def elbow_signed(numbers, x, y, z):
    """Of a pipe: a quarter turn, and two legs along -y and -x."""
    major, leg = numbers[0], numbers[3]
    off = hypot(hypot(x, y) - major, z)
    sector = x >= 0.0 and y >= 0.0
    inside = sector and numbers[1] < off < numbers[2]
    least = inf
    if sector:
        least = min(abs(off - numbers[1]), abs(off - numbers[2]))
    for k in range(2):
        if k == 0:
            rho, t = hypot(z, x - major), -y
        else:
            rho, t = hypot(z, y - major), -x
        beyond = max(-t, t - leg, 0.0)
        least = min(least, hypot(rho - numbers[1], beyond), hypot(rho - numbers[2], beyond))
        past = max(numbers[1] - rho, rho - numbers[2], 0.0)
        least = min(least, hypot(past, t - leg))
        # closed at the bend, which the sector leaves open on its negative side only
        inside = inside or (0.0 <= t < leg and numbers[1] < rho < numbers[2])
    return -least if inside else least


@compiled
def egg_root(a2, b2, c2, x, y, z):
    """The root s > 0 of x / (s + a2 - c2)² + y / (s + b2 - c2)² + z / s² = 1, from its left by
    Newton's method, whose steps stay there; 0 where there is none."""
    s = sqrt(z)
    if s == 0.0:
        if x / (a2 - c2) ** 2 + y / (b2 - c2) ** 2 <= 1.0:
            return 0.0
        s = 1e-300
    for _ in range(2000):
        u, v = s + (a2 - c2), s + (b2 - c2)
        p, q, r = x / u**2, y / v**2, z / s**2 if z > 0.0 else 0.0
        step = 0.5 * (p + q + r - 1.0) / (p / u + q / v + r / s)
        if not step > 1e-17 * s:
            break
        s += step
    return s


@compiled
def egg_signed(semiaxes, x, y, z):
    """Of an ellipsoid whose last semiaxis is the shortest."""
    a, b, c = semiaxes[0], semiaxes[1], semiaxes[2]
    px, py, pz = abs(x), abs(y), abs(z)
    s = egg_root(a * a, b * b, c * c, (a * px) ** 2, (b * py) ** 2, (c * pz) ** 2)
    fx, fy = a * a * px / (s + (a * a - c * c)), b * b * py / (s + (b * b - c * c))
    # where s is small, so is what is divided by it
    fz = c * c * pz / s if s > 0.0 else c * sqrt(max(0.0, 1.0 - (fx / a) ** 2 - (fy / b) ** 2))
    length = sqrt((px - fx) ** 2 + (py - fy) ** 2 + (pz - fz) ** 2)
    return -length if s < c * c else length


@compiled
def signed(form, x, y, z):
    """The signed distance of a point from a solid."""
    n = form.numbers
    if form.kind == TURNED:
        return flat_signed(form.rows, sqrt(x * x + y * y), z)
    if form.kind == SWEPT:
        return swept_signed(form.rows, n[0], n[1], x, y, z)
    if form.kind == HOLLOWED:
        outer = swept_signed(form.rows, n[0], n[1], x, y, z)
        return max(outer, -swept_signed(form.cavity, n[2], n[3], x, y, z))
    return elbow_signed(n, x, y, z) if form.kind == ELBOW else egg_signed(n, x, y, z)


@compiled
def signed_of(form, points):
    """(n,) of points (n, 3)."""
    found = np.empty(len(points))
    for k in range(len(points)):
        found[k] = signed(form, points[k, 0], points[k, 1], points[k, 2])
    return found


@compiled
def flat_signed_of(rows, points):
    """(n,) of points (n, 2)."""
    found = np.empty(len(points))
    for k in range(len(points)):
        found[k] = flat_signed(rows, points[k, 0], points[k, 1])
    return found


def no_rows() -> Array:
    """Of no curve."""
    return np.zeros((0, ROW))
