"""The convex hull of a planar curve (r, z), r >= 0, and its mirror image about the axis r = 0.

Its right side, from the lowest point up, is a chain of arcs of the curve and of straight pieces
that touch it (bitangents), found from samples and then refined to roundoff.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy

from standoff.bodies.tolerances import (
    BITANGENT_STEP,
    HELD_ENDS_RANK,
    NO_ABSOLUTE_WIDTH,
    ON_AXIS,
    ROOT_WIDTH,
    SHORTEST_ARC,
)
from standoff.errors import BodyError
from standoff.geometry.curves import ConicArc, Curve
from standoff.typing import Array

# Samples of the curve: a concavity narrower than a sample interval counts as convex.
SAMPLES = 2048
# Newton steps from samples to a bitangent; convergence is quadratic.
TANGENT_STEPS = 40
# A tangent point may move this many samples from the sample on the hull.
TANGENT_REACH = 3.0


@dataclass(frozen=True)
class ProfileArc:
    """The curve from parameter `low` (the lower end) to `high`; low > high if it runs downwards."""

    low: float
    high: float


@dataclass(frozen=True, eq=False)
class Chain:
    """The hull's right side: rings (r, z) from the lowest to the highest, and pieces between them.

    pieces[k] joins rings k and k + 1: an Arc, or None for a straight piece.
    """

    rings: Array
    pieces: list[ProfileArc | None]


@dataclass
class _HullRun:
    """Consecutive samples on the hull, from the lower to the upper end."""

    first: float
    last: float


def hull_chain(curve: Curve) -> Chain:
    """The right side of the hull of a curve and its mirror image.

    Raises BodyError: the curve lies on the axis or along a line through it that spans no area, or
    its hull is finer than the samples.
    """
    if curve.closed and not isinstance(curve, ConicArc):
        raise BodyError(
            f"A closed {type(curve).__name__} as a profile: open it where its hull is straight or "
            "on the inside, or give a closed ConicArc."
        )
    t = np.linspace(curve.first, curve.last, SAMPLES + 1)
    if curve.closed:
        t = t[:-1]
    points = np.array([_flat(curve, s) for s in t])
    runs = _runs(curve, t, points)
    step = float(t[1] - t[0])
    _touch_axis(curve, runs, step)
    for lower, upper in pairwise(runs):
        lower.last, upper.first = _touching(curve, lower.last, upper.first, step)
    return _joined(curve, runs, step)


def _flat(curve: Curve, t: float) -> Array:
    return curve.point(float(t))[[0, 2]]


def _runs(curve: Curve, t: Array, points: Array) -> list[_HullRun]:
    """Runs of samples on the hull's right side, from the lowest up."""
    mirrored = points * np.array([-1.0, 1.0])
    try:
        hull = scipy.spatial.ConvexHull(np.concatenate([points, mirrored]))
    except (scipy.spatial.QhullError, ValueError) as error:
        raise BodyError(
            "The revolved curve spans no volume: it lies on the axis or in a plane normal to it."
        ) from error
    n = len(points)
    order = hull.vertices  # counterclockwise: from the lowest up on the right
    right = [int(k) if k < n else int(k) - n for k in order if k < n or points[k - n, 0] <= 0.0]
    heights = points[right, 1]
    start = int(np.lexsort((-points[right, 0], heights))[0])
    chain = list(dict.fromkeys(right[start:] + right[:start]))
    step = float(t[1] - t[0])
    runs: list[_HullRun] = []
    previous, sense = chain[0], 0
    runs.append(_HullRun(t[previous], t[previous]))
    for k in chain[1:]:
        jump = k - previous
        if curve.closed and abs(jump) > n // 2:
            jump -= int(np.sign(jump)) * n
        if abs(jump) == 1 and sense in (0, jump):
            # a closed curve's parameter continues across its seam
            turns = round((runs[-1].last + jump * step - float(t[k])) / (n * step))
            runs[-1].last = float(t[k]) + turns * n * step
            sense = jump
        else:
            runs.append(_HullRun(t[k], t[k]))
            sense = 0
        previous = k
    return runs


def _touch_axis(curve: Curve, runs: list[_HullRun], step: float) -> None:
    """Move the chain's ends to where the curve is lowest and highest."""

    def rise(t: float) -> float:
        return float(curve.jet(t)[1][2])

    runs[0].first = _root(curve, rise, runs[0].first, step, -1.0)
    runs[-1].last = _root(curve, rise, runs[-1].last, step, 1.0)


def _root(
    curve: Curve, slope: Callable[[float], float], t: float, step: float, sign: float
) -> float:
    """The parameter near t where sign * (a function of this slope) is greatest."""
    low, high = t - step, t + step
    if not curve.closed:
        low, high = max(low, curve.first), min(high, curve.last)
    at_low, at_high = sign * slope(low), sign * slope(high)
    if at_low <= 0.0 or at_high >= 0.0:  # no interior maximum: an end of the curve, or flat
        ends = [low] if at_low <= 0.0 else [high]
        return ends[0] if ends[0] in (curve.first, curve.last) and not curve.closed else t
    widths = {"xtol": NO_ABSOLUTE_WIDTH, "rtol": ROOT_WIDTH}
    return float(scipy.optimize.brentq(slope, low, high, **widths))


def _cross(a: Array, b: Array) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def _touching(curve: Curve, a: float, b: float, step: float) -> tuple[float, float]:
    """Parameters near a and b where one line touches the curve from outside at both."""
    ends = [] if curve.closed else [curve.first, curve.last]
    first, second = a, b
    for _ in range(TANGENT_STEPS):
        jet_a, jet_b = (np.array(curve.jet(t))[:, [0, 2]] for t in (a, b))
        chord = jet_b[0] - jet_a[0]
        # outward is to the right when going up; an end of the curve is held if the curve would
        # go further out beyond it
        slopes = np.array([_cross(chord, jet_a[1]), _cross(chord, jet_b[1])])
        held = [
            t in ends and slope * (1.0 if t == curve.first else -1.0) >= 0.0
            for t, slope in ((a, slopes[0]), (b, slopes[1]))
        ]
        matrix = np.array(
            [
                [_cross(chord, jet_a[2]), _cross(jet_b[1], jet_a[1])],
                [_cross(-jet_a[1], jet_b[1]), _cross(chord, jet_b[2])],
            ]
        )
        for k in range(2):
            if held[k]:
                matrix[k], slopes[k] = np.eye(2)[k], 0.0
        change = np.linalg.lstsq(matrix, -slopes, rcond=HELD_ENDS_RANK)[0]
        change[held] = 0.0  # not even by roundoff: an end stays an end
        new_a, new_b = a + change[0], b + change[1]
        if ends:
            new_a, new_b = (min(max(float(t), ends[0]), ends[1]) for t in (new_a, new_b))
        if abs(new_a - a) + abs(new_b - b) <= BITANGENT_STEP * (abs(a) + abs(b)):
            break
        a, b = float(new_a), float(new_b)
    reach = TANGENT_REACH * step
    if abs(a - first) > reach or abs(b - second) > reach:
        raise BodyError(
            f"The curve's hull is finer than its {SAMPLES} samples near its parameters {first:.6g} "
            f"and {second:.6g}: give a simpler curve."
        )
    return a, b


def _joined(curve: Curve, runs: list[_HullRun], step: float) -> Chain:
    """Rings and pieces; a run whose ends met is a single ring."""
    size = float(np.abs([_flat(curve, s) for r in runs for s in (r.first, r.last)]).max())
    rings: list[Array] = []
    pieces: list[ProfileArc | None] = []
    for k, run in enumerate(runs):
        if k:
            pieces.append(None)
        low = _flat(curve, run.first)
        rings.append(low)
        if abs(run.last - run.first) > SHORTEST_ARC * step:
            pieces.append(ProfileArc(run.first, run.last))
            rings.append(_flat(curve, run.last))
    found = np.array(rings)
    found[found[:, 0] <= ON_AXIS * size, 0] = 0.0
    return Chain(found, pieces)
