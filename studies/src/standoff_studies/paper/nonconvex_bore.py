"""A pin in a bore: one pair of smooth convex patches, of which one faces inwards.

The bore's patch is cut from a disc, so it is convex, but the body is around it. The pin's nearest
points to it are those of the pin that are furthest from the bore's middle: there are one or two,
as the middle is outside or inside the evolute of the pin's ellipse. One begins or ends in the
middle of both patches, where M is singular and no boundary is near.
"""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import standoff as so
from standoff.geometry import ConicArc
from standoff.kernels.state import arrays as K
from standoff.motion import Pose, Twist
from standoff.recording.times import even_times
from standoff.tracking import Tracker, pair_system
from standoff.tracking.laws import PaperLaw
from standoff.typing import Array
from standoff_studies.paper.many_starts import begun, motion_along, stepped
from standoff_studies.paper.pair_simulation import REST

BORE = 1.0
"""Radius [length]."""
AXES = 0.5, 0.42
"""Semi-axes of the pin [length]."""
PERIOD, STEP, GAIN = 4.0, 2e-3, 25.0
"""Of the pin's motion [s], of a frame [s], and K [1/s]."""
SWING, ASIDE = 0.3, 0.02
"""How far the pin goes to and fro along its long axis, and how far off the middle [length]."""
SAMPLES = 20_000
"""Directions in which the pin is tried for its furthest points."""
EVERY = 5
"""Every such frame is looked at."""


class ToAndFro:
    """The pin's path."""

    start, end = 0.0, math.inf

    def __init__(self, swing: float) -> None:
        self.swing = swing

    def pose(self, t: float) -> Pose:
        """Return where the pin is at a time [s]."""
        x = self.swing * math.sin(2.0 * math.pi * t / PERIOD)
        return Pose(np.eye(3), (x, ASIDE, 0.0))

    def twist(self, t: float) -> Twist:
        """Return how it moves."""
        rate = 2.0 * math.pi / PERIOD
        return Twist((self.swing * rate * math.cos(rate * t), 0.0, 0.0), (0.0, 0.0, 0.0))


class InBore(NamedTuple):
    """Two branches of the printed law, one from each minimum at the start, at every fifth frame.

    Attributes
    ----------
    time : ndarray, shape (n,)
        s
    minima : list of ndarray
        All that there are, by brute force, the least first [length],
    sides : list of ndarray of bool
        and which of them are on the right of the pin.
    branches : ndarray, shape (n, 2)
        Their distances [length].
    least : ndarray, shape (n, 2)
        The least eigenvalue of H at each [length²].
    errors : ndarray, shape (n, 2)
        The greatest projection error of each [length²].
    proven : ndarray, shape (n,)
        The distances that the library proves, from nothing [length].
    tracker : Tracker
    """

    time: Array
    minima: list[Array]
    sides: list[NDArray[np.bool_]]
    branches: Array
    least: Array
    errors: Array
    proven: Array
    tracker: Tracker

    @property
    def distance(self) -> Array:
        """The true one."""
        return np.array([apart[0] for apart in self.minima])

    @property
    def wrong(self) -> Array:
        """How far the least branch is from it."""
        return np.asarray(np.abs(self.branches.min(axis=1) - self.distance))


def furthest(pose: Pose) -> tuple[Array, Array]:
    """Return the distances and the directions on the pin of all its minima, the least first."""
    angle = np.linspace(0.0, 2.0 * math.pi, SAMPLES, endpoint=False)
    at = pose.translation[:2] + np.array([AXES[0] * np.cos(angle), AXES[1] * np.sin(angle)]).T
    away = np.linalg.norm(at, axis=1)
    peaks = np.flatnonzero((away > np.roll(away, 1)) & (away >= np.roll(away, -1)))
    peaks = peaks[np.argsort(-away[peaks])]
    return BORE - away[peaks], angle[peaks]


def ellipse(a: float, b: float) -> ConicArc:
    """Return an ellipse whose ends, t = 0 and 2π, are at the bottom, where no minimum goes."""
    return ConicArc((0, 0), (0, -b), (a, 0))


@cache
def in_bore(swing: float = SWING) -> InBore:
    """Track the pin from both of its minima, by the printed law on the one pair of patches."""
    path, time = ToAndFro(swing), even_times(0.0, PERIOD, STEP)
    bore, pin = (so.shapes.planar_loop([each]) for each in (ellipse(BORE, BORE), ellipse(*AXES)))
    law = PaperLaw(gain=GAIN, switching="none", saturation="zero", solve="plain", restarts=False)
    tracker = Tracker(bore, pin, STEP, law=law)
    rows, still = motion_along(REST, path, time), Pose.identity()
    looks = np.arange(0, len(time), EVERY)
    told = np.empty((len(looks), 2, 3))
    for branch, angle in enumerate(furthest(path.pose(0.0))[1].tolist()):
        own = np.array([AXES[0] * math.cos(angle), AXES[1] * math.sin(angle)])
        x, y = path.pose(0.0).translation[:2] + own
        on_bore, on_pin = math.atan2(x, -y), math.atan2(own[0] / AXES[0], -own[1] / AXES[1])
        q = [[u % (2.0 * math.pi) for u in (on_bore, on_pin)]]
        on_a, on_b = ((("edge", 0), (u,)) for u in q[0])
        state = begun(tracker, (REST, path), on_a, on_b)
        q += [buf.out[[K.OUT_Q, K.OUT_Q + 2]].tolist() for buf in stepped(tracker, state, rows)]
        for row, k in enumerate(looks):
            on_both = ((("edge", 0), (u,)) for u in q[k])
            system = pair_system(bore, pin, still, path.pose(time[k]), *on_both)
            least = np.linalg.eigvalsh(system.H)[0]
            told[row, branch] = np.linalg.norm(system.dR), least, np.abs(system.Psi).max()
    poses = [path.pose(t) for t in time[looks].tolist()]
    minima = [furthest(pose) for pose in poses]
    return InBore(
        time[looks],
        [apart for apart, _ in minima],
        [np.cos(angle) > 0.0 for _, angle in minima],
        told[:, :, 0],
        told[:, :, 1],
        told[:, :, 2],
        np.array([so.distance(*_solids(), still, pose).distance for pose in poses]),
        tracker,
    )


@cache
def _solids() -> tuple[so.PlanarSolid, so.PlanarSolid]:
    """The plate with the bore, and the pin."""
    outer = 2.0 * BORE
    plate = so.PlanarSolid.from_loops([ellipse(outer, outer)], [[ellipse(BORE, BORE)]])
    return plate, so.PlanarSolid.from_loops([ellipse(*AXES)])
