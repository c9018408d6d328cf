"""Plane boundaries by formulas of the study's own: curves, samples, and the least distance of two.

Nothing of the library is used. A piece is a row of 13 numbers: its form, and of a rational cubic
four control points (w x, w y, w), of an arc its centre, radius, first and last angle. t goes from 0
to 1. Samples come in runs of neighbours on one piece, within a radius of one of them.
"""

from __future__ import annotations

from math import cos, inf, sin, sqrt
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

CUBIC, ARC = 0.0, 1.0
RUN = 24
"""Samples of a run."""
STEPS = 160
"""Of a descent; some ten are usual."""
FIRST_DAMPING = 1e-3
"""Relative."""
LEAST_BESIDE = 1e-6
"""Of a piece: how near to the end of a descent others begin."""
FINE = 20_000
"""Parts of a chord near a point: how far a curve is off them is a reach by the square of this."""
MOST_STARTS = 400
"""Pairs of samples that are descended from; those of the nearest runs."""


class Outline(NamedTuple):
    """The boundary of a plane solid.

    Attributes
    ----------
    pieces : (m, 13) array
    samples : (n, 2) array
        Points along each loop in turn; a loop's last one is its first.
    at : (n, 2) array
        Of each sample its piece's number and t.
    twins : (n,) array of int
        The sample at the same place on the next or last piece; -1 where there is none.
    loops : (l + 1,) array of int
        Where the loops begin in `samples`.
    runs : (k, 2) array of int
        First sample of a run and one beyond its last.
    ends : (k,) array of int
        The first sample of the next run, or the last of the loop.
    middles, radii : (k,) arrays
        A sample's number, and how far others of its run are from it.
    reach : float
        No point of the boundary is farther from its nearest sample.
    """

    pieces: Array
    samples: Array
    at: Array
    twins: Ints
    loops: Ints
    runs: Ints
    ends: Ints
    middles: Ints
    radii: Array
    reach: float


@njit(cache=True, error_model="numpy")
def jet(row, t):
    """(x, y, x', y', x'', y'') of a piece."""
    if row[0] == ARC:
        turn = row[5] - row[4]
        angle = row[4] + t * turn
        x, y = row[3] * cos(angle), row[3] * sin(angle)
        return row[1] + x, row[2] + y, -turn * y, turn * x, -turn * turn * x, -turn * turn * y
    s = 1.0 - t
    b0, b1, b2, b3 = s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t
    c0, c1, c2 = 3.0 * s * s, 6.0 * s * t, 3.0 * t * t
    X, Y, W = 0.0, 0.0, 0.0
    X1, Y1, W1 = 0.0, 0.0, 0.0
    X2, Y2, W2 = 0.0, 0.0, 0.0
    for k in range(3):
        p, q, u, v = row[1 + k], row[4 + k], row[7 + k], row[10 + k]
        value = b0 * p + b1 * q + b2 * u + b3 * v
        first = c0 * (q - p) + c1 * (u - q) + c2 * (v - u)
        second = 6.0 * (s * (u - 2.0 * q + p) + t * (v - 2.0 * u + q))
        if k == 0:
            X, X1, X2 = value, first, second
        elif k == 1:
            Y, Y1, Y2 = value, first, second
        else:
            W, W1, W2 = value, first, second
    x, y = X / W, Y / W
    dx, dy = (X1 - x * W1) / W, (Y1 - y * W1) / W
    ddx = (X2 - 2.0 * dx * W1 - x * W2) / W
    ddy = (Y2 - 2.0 * dy * W1 - y * W2) / W
    return x, y, dx, dy, ddx, ddy


@njit(cache=True, error_model="numpy")
def placed(move, x, y):
    """Of a move (c, s, x, y)."""
    return move[0] * x - move[1] * y + move[2], move[1] * x + move[0] * y + move[3]


@njit(cache=True, error_model="numpy")
def clipped(t):
    return min(1.0, max(0.0, t))


@njit(cache=True, error_model="numpy")
def apart(rows_a, i, rows_b, j, move, t, s):
    ax, ay, _, _, _, _ = jet(rows_a[i], t)
    bx, by, _, _, _, _ = jet(rows_b[j], s)
    bx, by = placed(move, bx, by)
    return sqrt((bx - ax) ** 2 + (by - ay) ** 2)


@njit(cache=True, error_model="numpy")
def descended(rows_a, i, rows_b, j, move, t, s):
    """(distance, t, s): the least of two pieces downhill from t and s, by Newton's method on the
    square, damped, with parameters that would leave their piece held at its end. A piece may be a
    point."""
    least = apart(rows_a, i, rows_b, j, move, t, s)
    damping = FIRST_DAMPING
    for _ in range(STEPS):
        ax, ay, ux, uy, uux, uuy = jet(rows_a[i], t)
        bx, by, vx, vy, vvx, vvy = jet(rows_b[j], s)
        bx, by = placed(move, bx, by)
        vx, vy = move[0] * vx - move[1] * vy, move[1] * vx + move[0] * vy
        vvx, vvy = move[0] * vvx - move[1] * vvy, move[1] * vvx + move[0] * vvy
        ex, ey = bx - ax, by - ay
        gt, gs = -(ux * ex + uy * ey), vx * ex + vy * ey
        tt, ss = ux * ux + uy * uy, vx * vx + vy * vy
        ts = -(ux * vx + uy * vy)
        ht, hs = tt - uux * ex - uuy * ey, ss + vvx * ex + vvy * ey
        if ht <= 0.0 or ht * hs <= ts * ts:
            ht, hs = tt, ss
        ht, hs = ht + damping * tt, hs + damping * ss
        held_t = (t <= 0.0 and gt > 0.0) or (t >= 1.0 and gt < 0.0)
        held_s = ss == 0.0 or (s <= 0.0 and gs > 0.0) or (s >= 1.0 and gs < 0.0)
        if held_t and held_s:
            break
        if held_t:
            dt, ds = 0.0, -gs / hs
        elif held_s:
            dt, ds = -gt / ht, 0.0
        else:
            area = ht * hs - ts * ts
            dt, ds = (-gt * hs + gs * ts) / area, (-gs * ht + gt * ts) / area
        new_t, new_s = clipped(t + dt), clipped(s + ds)
        if new_t == t and new_s == s:
            break
        found = apart(rows_a, i, rows_b, j, move, new_t, new_s)
        if found < least:
            t, s, least = new_t, new_s, found
            damping *= 0.1
        else:
            if found == least and damping > 1.0:
                break
            damping = max(10.0 * damping, 1e-9)
    return least, t, s


@njit(cache=True, error_model="numpy")
def beside(rows_a, i, rows_b, j, move, found):
    """The least distance downhill from places beside where a descent ended: boundaries that cross
    twice have a place between both where a descent may end too, at the depth."""
    least, t, s = found
    _, _, ux, uy, _, _ = jet(rows_a[i], t)
    _, _, vx, vy, _, _ = jet(rows_b[j], s)
    vx, vy = move[0] * vx - move[1] * vy, move[1] * vx + move[0] * vy
    square = vx * vx + vy * vy
    share = (ux * vx + uy * vy) / square if square > 0.0 else 0.0
    step = 0.5
    while step > LEAST_BESIDE and least > 0.0:
        for side in (-step, step):
            p, q = clipped(t + side), clipped(s + side * share)
            if apart(rows_a, i, rows_b, j, move, p, q) < least:
                least = min(least, descended(rows_a, i, rows_b, j, move, p, q)[0])
        step *= 0.25
    return least


@njit(cache=True, error_model="numpy")
def run_distance(a, b, move):
    """A number that the distance between the nearest samples is not above: between middles."""
    least = inf
    for j in range(len(b.radii)):
        m = b.middles[j]
        x, y = placed(move, b.samples[m, 0], b.samples[m, 1])
        for i in range(len(a.radii)):
            p = a.middles[i]
            least = min(least, (a.samples[p, 0] - x) ** 2 + (a.samples[p, 1] - y) ** 2)
    return sqrt(least)


@njit(cache=True, error_model="numpy")
def near_runs(a, b, move, seen, margin):
    """Pairs of runs whose samples may be nearer than `seen` and a margin, (count, 2)."""
    pairs = np.empty((len(a.radii) * len(b.radii), 2), np.int64)
    count = 0
    for j in range(len(b.radii)):
        m = b.middles[j]
        x, y = placed(move, b.samples[m, 0], b.samples[m, 1])
        for i in range(len(a.radii)):
            p = a.middles[i]
            most = seen + margin + a.radii[i] + b.radii[j]
            if (a.samples[p, 0] - x) ** 2 + (a.samples[p, 1] - y) ** 2 <= most * most:
                pairs[count, 0], pairs[count, 1] = i, j
                count += 1
    return pairs[:count]


@njit(cache=True, error_model="numpy")
def seen_of_runs(a, i, b, j, move, near, at):
    """Fills, for each sample of B's run, its distance from A's run and the sample there."""
    for q in range(b.runs[j, 0], b.runs[j, 1]):
        x, y = placed(move, b.samples[q, 0], b.samples[q, 1])
        least = inf
        k = q - b.runs[j, 0]
        for p in range(a.runs[i, 0], a.runs[i, 1]):
            square = (a.samples[p, 0] - x) ** 2 + (a.samples[p, 1] - y) ** 2
            if square < least:
                least, at[k] = square, p
        near[k] = sqrt(least)
    return b.runs[j, 1] - b.runs[j, 0]


@njit(cache=True, error_model="numpy")
def from_samples(a, p, b, q, move):
    """The least distance downhill from two samples, on both pieces that end at one."""
    least = inf
    for m in (p, a.twins[p]):
        for n in (q, b.twins[q]):
            if m >= 0 and n >= 0:
                i, j = int(a.at[m, 0]), int(b.at[n, 0])
                found = descended(a.pieces, i, b.pieces, j, move, a.at[m, 1], b.at[n, 1])
                least = min(least, beside(a.pieces, i, b.pieces, j, move, found))
    return least


@njit(cache=True, error_model="numpy")
def least_distance(a, b, move):
    """(of samples, of the curves downhill from all samples that may be nearest)."""
    margin = a.reach + b.reach
    near, at = np.empty(RUN), np.empty(RUN, np.int64)
    seen = run_distance(a, b, move)
    pairs = near_runs(a, b, move, seen, margin)
    best = np.empty(len(pairs))
    for k in range(len(pairs)):
        n = seen_of_runs(a, pairs[k, 0], b, pairs[k, 1], move, near, at)
        best[k] = near[:n].min()
        seen = min(seen, best[k])
    least, starts = seen, 0
    for k in np.argsort(best):
        if best[k] > seen + margin or least == 0.0 or starts >= MOST_STARTS:
            break
        j = pairs[k, 1]
        n = seen_of_runs(a, pairs[k, 0], b, j, move, near, at)
        for q in range(n):
            left, right = near[max(q - 1, 0)], near[min(q + 1, n - 1)]
            if near[q] <= seen + margin and near[q] <= left and near[q] <= right:
                starts += 1
                least = min(least, from_samples(a, at[q], b, b.runs[j, 0] + q, move))
    return seen, least


@njit(cache=True, error_model="numpy")
def to_boundary(a, x, y):
    """The distance of a point from a boundary."""
    point = np.zeros((1, 13))
    for k in range(4):
        point[0, 1 + 3 * k], point[0, 2 + 3 * k], point[0, 3 + 3 * k] = x, y, 1.0
    still = (1.0, 0.0, 0.0, 0.0)
    n = len(a.radii)
    seen = inf
    for i in range(n):
        m = a.middles[i]
        seen = min(seen, sqrt((a.samples[m, 0] - x) ** 2 + (a.samples[m, 1] - y) ** 2))
    least = seen
    for i in range(n):
        m = a.middles[i]
        far = sqrt((a.samples[m, 0] - x) ** 2 + (a.samples[m, 1] - y) ** 2)
        if far > least + a.radii[i] + a.reach:
            continue
        for p in range(a.runs[i, 0], a.runs[i, 1]):
            near = sqrt((a.samples[p, 0] - x) ** 2 + (a.samples[p, 1] - y) ** 2)
            if near <= least + a.reach:
                k = int(a.at[p, 0])
                found = descended(a.pieces, k, point, 0, still, a.at[p, 1], 0.5)
                least = min(least, found[0])
    return least


@njit(cache=True, error_model="numpy")
def holds(a, x, y):
    """Is a point inside, that is not nearer to the boundary than its reach? By the crossings of a
    ray with the chords of the samples."""
    odd = False
    for k in range(len(a.loops) - 1):
        for p in range(a.loops[k], a.loops[k + 1] - 1):
            px, py = a.samples[p, 0], a.samples[p, 1]
            qx, qy = a.samples[p + 1, 0], a.samples[p + 1, 1]
            if (py > y) != (qy > y) and x < px + (y - py) / (qy - py) * (qx - px):
                odd = not odd
    return odd


@njit(cache=True, error_model="numpy")
def holds_finely(a, x, y):
    """The same of a point that may be near the boundary: where samples are within three reaches of
    it the curve is followed in `FINE` steps between them."""
    odd = False
    for k in range(len(a.loops) - 1):
        for p in range(a.loops[k], a.loops[k + 1] - 1):
            px, py = a.samples[p, 0], a.samples[p, 1]
            qx, qy = a.samples[p + 1, 0], a.samples[p + 1, 1]
            near = min((px - x) ** 2 + (py - y) ** 2, (qx - x) ** 2 + (qy - y) ** 2)
            whole = near > 9.0 * a.reach**2 or a.at[p, 0] != a.at[p + 1, 0]
            steps = 1 if whole else FINE
            for step in range(steps):
                if step + 1 < steps:
                    t = a.at[p, 1] + (a.at[p + 1, 1] - a.at[p, 1]) * (step + 1) / steps
                    ex, ey, _, _, _, _ = jet(a.pieces[int(a.at[p, 0])], t)
                else:
                    ex, ey = qx, qy
                if (py > y) != (ey > y) and x < px + (y - py) / (ey - py) * (ex - px):
                    odd = not odd
                px, py = ex, ey
    return odd


@njit(cache=True, error_model="numpy")
def points_of(rows, at):
    """Samples (n, 2) of pieces at (piece, t)."""
    found = np.empty((len(at), 2))
    for k in range(len(at)):
        x, y, _, _, _, _ = jet(rows[int(at[k, 0])], at[k, 1])
        found[k, 0], found[k, 1] = x, y
    return found


@njit(cache=True, error_model="numpy")
def roughly_holds(a, x, y):
    """The same by one chord of each run."""
    odd = False
    for k in range(len(a.radii)):
        p, q = a.runs[k, 0], a.ends[k]
        px, py = a.samples[p, 0], a.samples[p, 1]
        qx, qy = a.samples[q, 0], a.samples[q, 1]
        if (py > y) != (qy > y) and x < px + (y - py) / (qy - py) * (qx - px):
            odd = not odd
    return odd


@njit(cache=True, error_model="numpy")
def any_held(a, b, move):
    """(is the middle of any run of B inside A, are all of them), roughly."""
    some, every = False, True
    for j in range(len(b.radii)):
        m = b.middles[j]
        x, y = placed(move, b.samples[m, 0], b.samples[m, 1])
        inside = roughly_holds(a, x, y)
        some, every = some or inside, every and inside
        if some and not every:
            break
    return some, every


@njit(cache=True, error_model="numpy")
def inverse(move):
    """The move back."""
    c, s, x, y = move
    return c, -s, -(c * x + s * y), s * x - c * y
