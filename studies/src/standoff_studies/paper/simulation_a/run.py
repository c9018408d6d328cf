"""Simulation A's runs: the raw law, Eq. (12), from a wrong start, by ``so.Tracker``."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from typing import NamedTuple

import numpy as np

from standoff.geometry.validation import Array
from standoff.kernels.pair import events as N
from standoff.kernels.state import arrays as K
from standoff.motion import Pose, Twist
from standoff.tracking import PairSystem, Tracker
from standoff.tracking.inputs import flat_pose
from standoff.tracking.laws import PaperLaw
from standoff.tracking.pair_system import PairSystems
from standoff.tracking.rows import COUNT_SLOTS, Counts
from standoff_studies.paper.simulation_a.setting import (
    FACE,
    PATH,
    START,
    STEP,
    VERTEX,
    point,
    vault,
)
from standoff_studies.paper.unaided import Part

HOME = Pose.identity()
"""The vault stands still."""

FLAT_HOME = flat_pose(HOME)
"""Its pose as the kernels read it."""

SETTLED = 1e-3
"""Part of its initial value to which an error must fall to count as settled: below what can be
seen in the paper's Fig. 7."""


class Motion(NamedTuple):
    """The point at n instants: x [length] and v [length/s], (n, 3)."""

    x: Array
    v: Array


def motion(time: Array) -> Motion:
    """The point at times [s], (n,)."""
    return Motion(PATH.positions(time), PATH.velocities(time))


@cache
def systems() -> PairSystems:
    """The paper's system of the patch and the point."""
    return PairSystems(vault(), point(), (FACE, START), (VERTEX, ()))


def system_at(q: Array, moving: Motion, k: int) -> PairSystem:
    """The system at parameters (2,), also outside the patch, and instant k of a motion."""
    pose, twist = FLAT_HOME.copy(), np.zeros(6)
    pose[9:], twist[:3] = moving.x[k], moving.v[k]
    return systems().at(q, FLAT_HOME, pose, xi_b=twist)


def projection_errors(q: Array, x: Array) -> Array:
    """Psi at parameters (n, 2) for point positions (n, 3); shape (n, 2) [length²]."""
    pose, found = FLAT_HOME.copy(), np.empty(q.shape)
    for k, at in enumerate(q):
        pose[9:] = x[k]
        found[k] = systems().psi(at, FLAT_HOME, pose)
    return found


@dataclass(frozen=True, eq=False)
class Run:
    """One run, by frame; row k belongs to the time k `STEP`.

    Attributes
    ----------
    gain : float
        K [1/s].
    q : ndarray, shape (n, 2)
        Parameters (u, v).
    witness, target : ndarray, shape (n, 3)
        Witness point on the patch and the moving point [length], world.
    tracker : Tracker
        What followed it.
    counts : Counts
        In all frames.
    """

    gain: float
    q: Array
    witness: Array
    target: Array
    tracker: Tracker
    counts: Counts

    @cached_property
    def psi(self) -> Array:
        """Projection errors [length²], Eqs. (1)-(2), shape (n, 2)."""
        return projection_errors(self.q, self.target)

    @property
    def part(self) -> Part:
        """What its tracker did."""
        return Part(self.tracker.resolved_law, self.counts, len(self.q))

    @property
    def time(self) -> Array:
        """s, shape (n,)."""
        return np.asarray(STEP * np.arange(len(self.q)))

    @property
    def normalised(self) -> Array:
        """Each error's magnitude in parts of its first, shape (n, 2)."""
        return np.asarray(np.abs(self.psi) / np.abs(self.psi[0]))

    @cached_property
    def cosines(self) -> Array:
        """Each error's magnitude over the lengths of ΔR and of its tangent, as the paper normalises
        it: the cosine of the angle between them, shape (n, 2)."""
        (patch,) = vault().face_parts[FACE.index].charts
        tangents = np.array([patch.jet(u, v)[1:3] for u, v in self.q.tolist()])
        lengths = np.linalg.norm(tangents, axis=2)
        apart = np.linalg.norm(self.target - self.witness, axis=1)
        return np.asarray(np.abs(self.psi) / (apart[:, None] * lengths))

    @cached_property
    def cosines_left(self) -> Array:
        """The greatest of both cosines from each step on, shape (n,): it never grows."""
        greatest = self.cosines.max(axis=1)
        return np.asarray(np.maximum.accumulate(greatest[::-1])[::-1])

    def steps_below(self, cosine: float) -> int | None:
        """Steps after which both cosines stay below a level; None if they do not."""
        below = np.flatnonzero(self.cosines_left < cosine)
        return int(below[0]) if len(below) else None

    def levels_between(self, least: int, most: int) -> tuple[float, float]:
        """The levels below which both cosines stay after `least` to `most` steps, neither fewer
        nor more: above the first number, up to the second."""
        return float(self.cosines_left[most]), float(self.cosines_left[least - 1])

    @property
    def steps(self) -> int | None:
        """Steps after which all normalised errors stay below `SETTLED`; None if they do not."""
        above = np.flatnonzero((self.normalised >= SETTLED).any(axis=1))
        return int(above[-1]) + 1 if above[-1] + 1 < len(self.q) else None

    @property
    def monotone(self) -> bool:
        """Does no error grow in any step until all are settled?"""
        end = len(self.q) if self.steps is None else self.steps + 1
        return bool((np.diff(self.normalised[:end], axis=0) <= 0.0).all())


@cache
def run(
    gain: float,
    frames: int,
    start: tuple[float, float] = START,
    feedforward: bool = True,
    integrator: str = "heun",
) -> Run:
    """Track the point with the raw law from parameters `start`, which need not be right.

    Parameters
    ----------
    gain : float
        K [1/s].
    frames : int
        Steps of `STEP`.
    start : (float, float)
        (u, v).
    feedforward, integrator
        As `PaperLaw` takes them.

    Raises
    ------
    RuntimeError
        If the witness point leaves the patch: a step had a component that leads out of it.
    """
    moving = motion(np.asarray(STEP * np.arange(frames + 1)))
    tracker = raw_tracker(gain, feedforward, integrator)
    rows = track(tracker, moving, start)
    leaves = rows[:, K.OUT_COUNTS + N.SATURATIONS] > 0
    if leaves.any():
        raise RuntimeError(
            f"K = {gain:g} 1/s from {start}: the witness point left the patch at step "
            f"{int(np.argmax(leaves))}."
        )
    q, witness = rows[:, K.OUT_Q : K.OUT_Q + 2], rows[:, K.POINT_A : K.POINT_A + 3]
    counts = Counts(*rows[:, COUNT_SLOTS].sum(axis=0).astype(int).tolist())
    return Run(gain, q.copy(), witness.copy(), moving.x, tracker, counts)


def raw_tracker(gain: float, feedforward: bool = True, integrator: str = "heun") -> Tracker:
    """The law as it is: H is not made definite, and no feature is left for another."""
    law = PaperLaw(
        integrator=integrator,
        gain=gain,
        feedforward=feedforward,
        switching="none",
        saturation="zero",
        solve="plain",
        restarts=False,
    )
    return Tracker(vault(), point(), STEP, law=law)


def track(tracker: Tracker, moving: Motion, start: tuple[float, float]) -> Array:
    """Answers of all frames, (n, N_OUT), as ``standoff.kernels.state.arrays`` lays them out."""
    poses, twists = (HOME, PATH.pose(0.0)), (Twist.zero(), PATH.twist(0.0))
    state = tracker.start_from(*poses, (FACE, start), (VERTEX, ()), *twists, settle=False)
    buffer = tracker.buffer(state)
    rows = np.empty((len(moving.x), K.N_OUT))
    rows[0] = state.proximity.row
    for k in range(1, len(rows)):
        buffer.pose_b[9:], buffer.twist_b[:3] = moving.x[k], moving.v[k]
        tracker.step_into(buffer)
        rows[k] = buffer.out
    return rows
