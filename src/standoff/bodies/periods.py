"""Charts whose u is an angle: all their trimming curves within one period.

A loop that crosses the period's end is cut there, so that (u, v) is on the face exactly if it is in
this one period: the kernels bring u into it and need to know nothing else. Only rims of constant v
stay as they are; there the kernels wrap the angle itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import scipy

from standoff.bodies.packing import Chart, Coedge
from standoff.bodies.tolerances import PERIOD_ROUNDOFF, PIECE_ROUNDOFF, SMALLEST_PART
from standoff.errors import BodyError
from standoff.geometry.bernstein import segment
from standoff.geometry.pcurve_boxes import bezier_box, pcurve_boxes
from standoff.geometry.validation import Array
from standoff.kernels.body import layout as L

PERIOD = 2.0 * np.pi
# Points of a trimming curve between which it crosses a line of constant u at most once, and parts
# of it with boxes of their own.
SAMPLES, PARTS = 65, 16


def in_one_period(chart: Chart) -> None:
    """Bring the trimming curves of a chart into one period of u, and prove it.

    Raises
    ------
    BodyError
        Curves that can't be cut so.
    """
    if all(is_rim(c) for c in chart.coedges):
        return
    ranges = [_range(c) for c in chart.coedges]
    low, high = min(r[0] for r in ranges), max(r[1] for r in ranges)
    if high - low > PERIOD + PERIOD_ROUNDOFF:
        low = _start(chart.coedges, ranges)
        high = low + PERIOD
        chart.coedges = [part for c in chart.coedges for part in _parts(c, low)]
    chart.period = 0.5 * (low + high) - 0.5 * PERIOD
    for c in chart.coedges:
        if not _proven(c, chart.period - PERIOD_ROUNDOFF):
            raise BodyError(
                f"Face {chart.face}: a trimming curve leaves the period of u that begins at "
                f"{chart.period:.9g}: cut the face along a line of constant u.",
                part=("face", chart.face),
            )


def is_rim(c: Coedge) -> bool:
    """Is v constant along a coedge, and u its parameter but for its sign and a shift?"""
    if c.pcurve.kind != L.LINE:
        return False
    (slope, _, _), (rise, _, _), last = c.pcurve.matrix
    return bool(abs(slope) == 1.0 and rise == 0.0 and last.tolist() == [0.0, 0.0, 1.0])


def _boxes(c: Coedge, first: float, last: float, parts: int) -> tuple[Array, Array]:
    """(low, high), each (n,), of u along equal parts of a coedge."""
    ends = np.linspace(first, last, parts + 1)
    if c.pcurve.kind != L.BEZIER:
        low, high = pcurve_boxes(c.pcurve.kind, c.pcurve.matrix, ends)
        return low[:, 0], high[:, 0]
    points = c.pcurve.matrix
    shares = ((ends - c.first) / (c.last - c.first)).tolist()
    found = [bezier_box(segment(len(points) - 1, a, b) @ points) for a, b in pairwise(shares)]
    return np.array([b[0][0] for b in found]), np.array([b[1][0] for b in found])


def _range(c: Coedge) -> tuple[float, float]:
    low, high = _boxes(c, c.first, c.last, PARTS)
    return float(low.min()), float(high.max())


def _proven(c: Coedge, low: float) -> bool:
    """Is u within a period and its roundoff from `low` on, all along a coedge?"""
    high = low + PERIOD + 2.0 * PERIOD_ROUNDOFF
    waiting = [(c.first, c.last)]
    least = SMALLEST_PART * (c.last - c.first)
    while waiting:
        first, last = waiting.pop()
        lows, highs = _boxes(c, first, last, PARTS)
        steps = np.linspace(first, last, PARTS + 1)
        out = np.flatnonzero((lows < low) | (highs > high))
        if len(out) and last - first < least:
            return False
        waiting += [(float(steps[k]), float(steps[k + 1])) for k in out]
    return True


def _start(coedges: Sequence[Coedge], ranges: Sequence[tuple[float, float]]) -> float:
    """Where the period begins: amid the widest range of angles without a trimming curve, rims not
    counted; where there is none, at the end of a curve where the fewest others have to be cut."""
    own = [k for k, c in enumerate(coedges) if not is_rim(c)]
    low, high = (np.array([ranges[k][end] for k in own]) for end in (0, 1))
    spans = sorted(zip(low % PERIOD, low % PERIOD + high - low, strict=True))
    reach, widest = spans[0][1], (0.0, 0.0)
    for start, end in [*spans[1:], (spans[0][0] + PERIOD, 0.0)]:
        widest = max(widest, (start - reach, 0.5 * (start + reach)))
        reach = max(reach, end)
    if widest[0] > PERIOD_ROUNDOFF:
        return float(widest[1])
    ends = [c.pcurve.point(t)[0] for c in (coedges[k] for k in own) for t in (c.first, c.last)]
    low, high = low + PERIOD_ROUNDOFF, high - PERIOD_ROUNDOFF
    cut = [int((np.ceil((low - u) / PERIOD) < np.ceil((high - u) / PERIOD)).sum()) for u in ends]
    return float(ends[int(np.argmin(cut))])


def _parts(c: Coedge, start: float) -> list[Coedge]:
    """A coedge cut where a period ends, its parts turned into the one from `start` on."""

    def turns(t: float) -> float:
        return (c.pcurve.point(t)[0] - start) / PERIOD

    steps = np.linspace(c.first, c.last, SAMPLES).tolist()
    cuts = []
    for a, b in pairwise(steps):
        low, high = sorted((turns(a), turns(b)))
        level = np.floor(high)
        if low < level < high:
            cuts.append(float(scipy.optimize.brentq(lambda t, n=level: turns(t) - n, a, b)))
        elif level == turns(b):
            cuts.append(b)
    room = PIECE_ROUNDOFF * (1.0 + abs(c.first) + abs(c.last))
    cuts = [c.first, *(t for t in cuts if c.first + room < t < c.last - room)]
    found = []
    for a, b in pairwise([*cuts, c.last]):
        turned = c.pcurve.turned(-PERIOD * float(np.floor(turns(0.5 * (a + b)))))
        found += [replace(c, pcurve=p, first=s, last=e) for p, s, e in turned.pieces(a, b)]
    return found
