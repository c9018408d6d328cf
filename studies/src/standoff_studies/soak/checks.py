"""Checks of every answer, only by support functions and without per-frame Python.

With n the reported normal and s(n) = h_A(n) + h_B(-n) in world axes, -s(n) is how far a plane
perpendicular to n keeps the bodies apart: never more than the true signed distance. Two points of
the bodies at that distance prove it; in penetration a push of s(n) along n separates them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.body import layout as L
from standoff.kernels.state import arrays as K
from standoff.kernels.tolerances import BLUR
from standoff.tracking.status import Status
from standoff.typing import Array
from standoff_studies.oracles import HalfSpace, dot, lengths
from standoff_studies.oracles.shape import TINY
from standoff_studies.soak.directions import least_depths
from standoff_studies.soak.motion_checks import number_checks, rate_checks, residual_check
from standoff_studies.soak.motions import Frames
from standoff_studies.soak.placing import heights, outside
from standoff_studies.soak.shapes import Made

ROUNDOFF = 1e-13
"""Fraction of the pair's size and distance from the origin by which roundoff may shift a length: a
few hundred roundings, as poses, chains of charts and the formulas of the checks take a few each."""

LEAST = 1e-100
"""Least length with which others are compared."""

UNIT = 1e-12
"""By how much a normal's length may differ from 1 (dimensionless)."""

ON_BODY = 1e-11
"""Fraction of the size by which a witness point may lie outside its body: the overlap of trimming
curves (1e-12 of their parameters) and the roundoff of charts."""

PROVEN = 1e-3
"""GLOBAL means that no depth is less than (1 - PROVEN) times the reported one."""

BOX_CENTRE = slice(L.BOX_CENTRE, L.BOX_CENTRE + 3)

LOCAL, GLOBAL = K.LOCAL, K.GLOBAL

BLURRED = frozenset(
    {"superellipsoid", "creased superellipsoid", "egg", "spindle", "gore"}
    | {"sewn ellipsoid", "formula power ball", "formula dome"}
)
"""Kinds whose normals have roundoff near collapsed sides, which may be BLUR of the size."""


class Fault(NamedTuple):
    """A failed check: the frame, the value, and what is allowed."""

    frame: int
    what: str
    value: float
    allowed: float


def apart_of(status: Array) -> NDArray[np.bool_]:
    """Return which statuses, (n,), say that the bodies are certified apart."""
    return np.asarray(status == Status.CONVERGED.value)


def deep_of(status: Array) -> NDArray[np.bool_]:
    """Return which statuses, (n,), report a depth."""
    return np.asarray((status == LOCAL) | (status == GLOBAL))


class Judged(NamedTuple):
    """The answers of a pair's frames, and what the checks found.

    Attributes
    ----------
    separation : (n,) array
        -s(n), length.
    size : (n,) array
        Lengths to which roundoff is relative.
    unrest : (n,) array
        How far a depth is from that along its normal, and its points from the farthest points and
        from a line along the normal, divided by what the tolerance allows.
    faults : list of Fault
        In order of frames.
    """

    separation: Array
    size: Array
    unrest: Array
    faults: list[Fault]


def judge(a: Made, b: Made, frames: Frames, rows: Array, tolerance: float, twists: bool) -> Judged:
    """Check every answer.

    Parameters
    ----------
    a, b : Made
    frames : Frames
    rows : ndarray, shape (n, N_OUT)
        As ``standoff.kernels.state.arrays`` lays them out.
    tolerance : float
        That of the tracker.
    twists : bool
        Was the tracker given those of the frames? Otherwise rates and velocities are nan.

    Returns
    -------
    Judged
    """
    told = rows[:, K.NORMAL : K.NORMAL + 3]
    n = _own_normals(a, b, frames, told)
    height_a, _ = heights(a, frames.poses_a, n)
    height_b, _ = heights(b, frames.poses_b, -n)
    separation = -(height_a + height_b)
    size = _sizes(a, b, frames, rows)
    checks = _Checks(a, b, frames, rows, separation, size)
    checks.numbers(told)
    checks.expect("the normal is not the half-space's", lengths(told - n), UNIT)
    checks.bounds()
    checks.points(n)
    checks.certified(tolerance)
    checks.deepest(tolerance, n, height_a, height_b)
    checks.motion(n, height_a, height_b, twists)
    faults = sorted(checks.faults, key=lambda fault: fault.frame)
    return Judged(separation, size, checks.unrest, faults)


def _own_normals(a: Made, b: Made, frames: Frames, n: Array) -> Array:
    """A half-space's normal, if there is one: its support is finite only along that."""
    for made, poses, sign in ((a, frames.poses_a, 1.0), (b, frames.poses_b, -1.0)):
        if isinstance(made.support, HalfSpace):
            return sign * poses[:, [2, 5, 8]]
    return n


def _sizes(a: Made, b: Made, frames: Frames, rows: Array) -> Array:
    """The tolerance is relative to sizes, distance, and the bodies' offsets from their origins."""
    bodies = [made.body for made in (a, b) if made.body.bounded]
    sizes = sum(body.size + float(np.linalg.norm(body.reals[BOX_CENTRE])) for body in bodies)
    away = lengths(frames.poses_a[:, 9:]) + lengths(frames.poses_b[:, 9:])
    # a point that touches a half-space at the origin has size zero
    return np.maximum(sizes + away + np.abs(np.nan_to_num(rows[:, K.DISTANCE])), LEAST)


class _Checks:
    """The checks of a run in progress."""

    def __init__(
        self, a: Made, b: Made, frames: Frames, rows: Array, separation: Array, size: Array
    ) -> None:
        self.a, self.b, self.frames, self.rows = a, b, frames, rows
        self.separation, self.size = separation, size
        self.distance, self.bound = rows[:, K.DISTANCE], rows[:, K.LOWER_BOUND]
        self.status = rows[:, K.STATUS].astype(int)
        self.noise = ROUNDOFF * size
        self.slack = a.body.reals[L.SLACK] + b.body.reals[L.SLACK]
        self.between = rows[:, K.POINT_B : K.POINT_B + 3] - rows[:, K.POINT_A : K.POINT_A + 3]
        self.unrest = np.zeros(len(rows))
        self.faults: list[Fault] = []

    def expect(
        self,
        what: str,
        value: Array,
        allowed: Array | float,
        where: NDArray[np.bool_] | bool = True,
    ) -> None:
        """Note the first frame where a value is above what is allowed, or is not a number."""
        wrong = ~(value <= allowed) & where
        if wrong.any():
            k = int(wrong.argmax())
            limit = float(np.broadcast_to(allowed, value.shape)[k])
            self.faults.append(Fault(k, what, float(value[k]), limit))

    def numbers(self, n: Array) -> None:
        """No nan, no infinite number; a unit normal."""
        told = np.column_stack([self.rows[:, : K.NORMAL + 3], self.rows[:, K.UPPER_BOUND]])
        unknown = (self.status == Status.NOT_CERTIFIED.value) & (self.bound == -np.inf)
        told[unknown, K.LOWER_BOUND] = 0.0  # with a half-space it may be -inf: no bound is known
        self.expect("a number that is not finite", (~np.isfinite(told)).sum(axis=1), 0.0)
        self.expect("the normal is not a unit vector", np.abs(lengths(n) - 1.0), UNIT)
        known = np.isin(self.status, [s.value for s in Status])
        self.expect("an unknown status", np.where(known, 0.0, self.status), 0.0)
        silent = (self.distance == 0.0) & (np.abs(self.separation) > self.noise)
        self.expect("a silent zero", np.where(silent, np.abs(self.separation), 0.0), self.noise)

    def bounds(self) -> None:
        """lower_bound <= -s(n) <= true distance <= distance while apart; upper_bound above."""
        self.expect(
            "the lower bound is above what the normal separates",
            self.bound - self.separation,
            self.noise,
        )
        apart = self.distance >= 0.0
        self.expect(
            "the normal separates by more than the distance",
            self.separation - self.distance,
            self.noise,
            apart,
        )
        upper = self.rows[:, K.UPPER_BOUND]
        self.expect("the upper bound is too low", self.separation - upper, self.noise)
        self.expect("the distance is above its upper bound", self.distance - upper, self.noise)

    def points(self, n: Array) -> None:
        """Witness points lie on their bodies, and their distance is the reported one."""
        x_a = self.rows[:, K.POINT_A : K.POINT_A + 3]
        x_b = self.rows[:, K.POINT_B : K.POINT_B + 3]
        allowed = ON_BODY * self.size + self.slack
        self.expect("point_a is off A", outside(self.a, self.frames.poses_a, x_a, n), allowed)
        self.expect("point_b is off B", outside(self.b, self.frames.poses_b, x_b, -n), allowed)
        apart = apart_of(self.status)
        # points on swept balls are along n, which is not exactly the direction between the cores
        radii = self.a.body.radius + self.b.body.radius
        short = np.abs(self.distance - self.separation) + self.noise
        turned = radii * short / np.maximum(self.distance, TINY)
        off = np.abs(lengths(self.between) - np.abs(self.distance))
        self.expect("the points are not at the distance", off, allowed + turned, apart)

    def certified(self, tolerance: float) -> None:
        """Apart: the normal separates by the distance. In penetration: the depth separates them."""
        apart, deep = apart_of(self.status), deep_of(self.status)
        allowed = self._gap(tolerance)
        short = self.distance - self.separation
        self.expect("certified, but the normal separates by less", short, allowed, apart)
        self.expect("certified apart at no distance", -self.distance, 0.0, apart)
        self.expect("the depth does not part the bodies", short, allowed, deep)
        proven = self.status == GLOBAL
        # within the tolerance of touching, the sign is not significant
        self.expect("a depth where there is none", self.distance, allowed, proven)

    def deepest(self, tolerance: float, n: Array, height_a: Array, height_b: Array) -> None:
        """In penetration: is the depth that along the normal, and are the points in line with it?

        A depth is stationary in its normal: if it is accurate to a fraction of itself, the line is
        accurate to the square root of that. Beyond what the tolerance allows, the answer is not at
        rest, which is counted; it is a fault only if GLOBAL does not allow it.
        """
        deep, proven = deep_of(self.status), self.status == GLOBAL
        gap = self._gap(tolerance) + ON_BODY * self.size
        short = self.separation - self.distance
        aside = lengths(self.between - self.distance[:, None] * n)
        reach_a = np.abs(dot(n, self.rows[:, K.POINT_A : K.POINT_A + 3]) - height_a)
        reach_b = np.abs(dot(n, self.rows[:, K.POINT_B : K.POINT_B + 3]) + height_b)
        off = np.maximum(np.maximum(reach_a, reach_b), short) / gap
        off = np.maximum(off, aside / np.sqrt(2.0 * gap * self.size))
        self.unrest = np.where(deep, off, 0.0)
        loose = gap + PROVEN * np.abs(self.distance)
        self.expect("the depth is not that along the normal", short, loose, proven)
        self.expect("point_a is not the farthest along the normal", reach_a, loose, proven)
        self.expect("point_b is not the farthest along the normal", reach_b, loose, proven)
        limit = np.sqrt(2.0 * loose * self.size)
        self.expect("the points are not on the normal", aside, limit, proven)

    def motion(self, n: Array, height_a: Array, height_b: Array, twists: bool) -> None:
        """All other numbers: features, parameters, residual, counts, rates and velocities."""
        for check in number_checks(self.a, self.b, self.rows, twists):
            self.expect(*check)
        self.expect(*residual_check(self.a, self.b, self.rows, self.noise))
        if twists:
            reach_a = np.abs(dot(n, self.rows[:, K.POINT_A : K.POINT_A + 3]) - height_a)
            reach_b = np.abs(dot(n, self.rows[:, K.POINT_B : K.POINT_B + 3]) + height_b)
            resting = np.maximum(reach_a, reach_b) <= self.noise
            resting &= apart_of(self.status) | deep_of(self.status)
            radii = self.a.body.radius, self.b.body.radius
            with np.errstate(invalid="ignore"):  # numbers that are not finite are reported above
                for check in rate_checks(self.frames, self.rows, resting, radii):
                    self.expect(*check)

    def _gap(self, tolerance: float) -> Array:
        """How far an answer may be from its bound, (n,)."""
        blur = BLUR if {self.a.shape.kind, self.b.shape.kind} & BLURRED else 0.0
        return np.asarray((tolerance + blur) * self.size + self.slack + self.noise)


def search(
    a: Made, b: Made, frames: Frames, rows: Array, judged: Judged, numbers: NDArray[np.int64]
) -> list[Fault]:
    """Search for depths below GLOBAL ones, in some frames, along many directions.

    Also for planes that separate bodies reported as overlapping, and for upper bounds below the
    separation along a direction.
    """
    if not len(numbers):
        return []
    found = least_depths(a, b, frames, numbers)
    slack = a.body.reals[L.SLACK] + b.body.reals[L.SLACK]
    faults = []
    for k, least in zip(numbers.tolist(), found.tolist(), strict=True):
        depth, noise = -rows[k, K.DISTANCE], ROUNDOFF * judged.size[k]
        # neither a distance above 0 nor a depth within the bodies' own slack claims this
        limit = noise + slack + max(-depth, 0.0)
        if -least > limit:
            faults.append(Fault(k, "said to overlap, but a plane separates them", -least, limit))
        limit = PROVEN * depth + noise
        if rows[k, K.STATUS] == GLOBAL and depth - least > limit:
            faults.append(Fault(k, "GLOBAL, but a lesser depth exists", depth - least, limit))
        if -least > rows[k, K.UPPER_BOUND] + noise:
            over = -least - rows[k, K.UPPER_BOUND]
            faults.append(Fault(k, "a direction separates beyond the upper bound", over, noise))
    return faults
