"""Charts: all their trimming curves within the surface's domain, which shows each point once.

Where u is an angle and the domain all of its turn, a loop that crosses the period's end is cut
there, so that (u, v) is on the face exactly if it is in this one period: the kernels bring u into
it and need to know nothing else. Only rims of constant v stay as they are; there the kernels wrap
the angle itself. No other parameter wraps, such as v round the tube of a torus or either one of a
spline that closes: there the curves must lie within the domain. Bounds, theorems and the highest
point of a surface hold over its domain only.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import scipy

from standoff.bodies.packing import Chart, Coedge
from standoff.bodies.tolerances import (
    DOMAIN_SPARE,
    PERIOD_ROUNDOFF,
    PIECE_ROUNDOFF,
    SMALLEST_PART,
)
from standoff.errors import BodyError
from standoff.geometry.bernstein import segments
from standoff.geometry.pcurve_boxes import bezier_box, equal_boxes
from standoff.geometry.torus import full_turn
from standoff.kernels.body import layout as L
from standoff.typing import Array

PERIOD = 2.0 * np.pi
# Points of a trimming curve between which it crosses a line of constant u at most once, and parts
# of it with boxes of their own.
SAMPLES, PARTS = 65, 16


def in_one_period(chart: Chart) -> None:
    """Bring the trimming curves of a chart into one period of its angles and into the surface's
    domain, and prove it.

    Raises BodyError: curves that can't be brought there.
    """
    if chart.surface.periodic and not all(is_rim(c) for c in chart.coedges):
        _cut(chart)
    for k in (0, 1):
        _in_domain(chart, k)


def _cut(chart: Chart) -> None:
    boxes = [_boxes(c, c.first, c.last) for c in chart.coedges]
    ranges = [(float(lows[:, 0].min()), float(highs[:, 0].max())) for lows, highs in boxes]
    low, high = min(r[0] for r in ranges), max(r[1] for r in ranges)
    if high - low > PERIOD + PERIOD_ROUNDOFF:
        low = _start(chart.coedges, ranges)
        high = low + PERIOD
        chart.coedges = [part for c in chart.coedges for part in _parts(c, low)]
        boxes = [_boxes(c, c.first, c.last) for c in chart.coedges]
    chart.period = 0.5 * (low + high) - 0.5 * PERIOD
    for c, around in zip(chart.coedges, boxes, strict=True):
        if not _proven(c, around, 0, chart.period, chart.period + PERIOD, PERIOD_ROUNDOFF):
            raise BodyError(
                f"Face {chart.face}: a trimming curve leaves the period of u that begins at "
                f"{chart.period:.9g}: cut the face along a line of constant u.",
                part=("face", chart.face),
            )


def _in_domain(chart: Chart, k: int) -> None:
    """Prove that u (k = 0) or v stays in its domain, by turns of the chart where it is an angle."""
    low, high = chart.surface.domain[2 * k : 2 * k + 2]
    whole = k == 0 and chart.surface.periodic and full_turn(low, high)
    if whole or not chart.coedges or not np.isfinite([low, high]).any():
        return
    angle = chart.surface.angles[k] and np.isfinite([low, high]).all()
    boxes = [_boxes(c, c.first, c.last) for c in chart.coedges]
    least = min(float(lows[:, k].min()) for lows, _ in boxes)
    most = max(float(highs[:, k].max()) for _, highs in boxes)
    way = PERIOD * round(0.5 * (low + high - least - most) / PERIOD) if angle else 0.0
    if way != 0.0:
        for c in chart.coedges:
            c.pcurve = c.pcurve.turned(way, k)
        boxes = [_boxes(c, c.first, c.last) for c in chart.coedges]
        if k == 0 and chart.period is not None:
            chart.period += way
    room = DOMAIN_SPARE * (high - low if np.isfinite(high - low) else most - least)
    for c, around in zip(chart.coedges, boxes, strict=True):
        if not _proven(c, around, k, low, high, room):
            raise BodyError(
                f"Face {chart.face}: a trimming curve, {'uv'[k]} from {least:.9g} to {most:.9g} "
                f"with the others, leaves the surface's domain from {low:.9g} to {high:.9g}: give "
                f"the surface a domain that holds it, or cut the face along a line of constant "
                f"{'uv'[k]}.",
                part=("face", chart.face),
            )


def is_rim(c: Coedge) -> bool:
    """Is v constant along a coedge, and u its parameter but for its sign and a shift?"""
    if c.pcurve.kind != L.LINE:
        return False
    (slope, _, _), (rise, _, _), last = c.pcurve.matrix
    return bool(abs(slope) == 1.0 and rise == 0.0 and last.tolist() == [0.0, 0.0, 1.0])


def _boxes(c: Coedge, first: float, last: float) -> tuple[Array, Array]:
    """(low, high), each (PARTS, 2), of (u, v) along equal parts of a coedge's range."""
    points = c.pcurve.matrix
    if c.pcurve.kind != L.BEZIER or (first, last) == (c.first, c.last):
        return equal_boxes(c.pcurve.kind, points, first, last, PARTS)
    shares = (np.linspace(first, last, PARTS + 1) - c.first) / (c.last - c.first)
    return bezier_box(segments(len(points) - 1, shares[:-1], shares[1:]) @ points)


def _proven(
    c: Coedge, boxes: tuple[Array, Array], k: int, low: float, high: float, room: float
) -> bool:
    """Is u (k = 0) or v between bounds but for `room`, all along a coedge? `boxes` are those of all
    of it."""
    low, high = low - room, high + room
    waiting = [(c.first, c.last, boxes)]
    least = SMALLEST_PART * (c.last - c.first)
    while waiting:
        first, last, (lows, highs) = waiting.pop()
        out = np.flatnonzero((lows[:, k] < low) | (highs[:, k] > high))
        if not len(out):
            continue
        if last - first < least:
            return False
        steps = np.linspace(first, last, PARTS + 1)
        waiting += [(a, b, _boxes(c, a, b)) for a, b in steps[[out, out + 1]].T.tolist()]
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
