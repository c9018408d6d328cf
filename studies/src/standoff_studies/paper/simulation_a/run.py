"""Simulation A's runs: the raw law, Eq. (12), from a wrong start, by ``so.Tracker``."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np

from standoff.motion import Path
from standoff.recording import Recording
from standoff.recording.track import track_along
from standoff.tracking import PairSystem, Tracker
from standoff.tracking.inputs import flat_pose, flat_twist
from standoff.tracking.laws import PaperLaw
from standoff.tracking.pair_system import PairSystems
from standoff.tracking.rows import Counts
from standoff.typing import Array
from standoff_studies.paper.many_starts import begun
from standoff_studies.paper.pair_simulation import REST
from standoff_studies.paper.simulation_a.setting import (
    FACE,
    PATH,
    START,
    STEP,
    VERTEX,
    point,
    vault,
)

FLAT_HOME = flat_pose(REST.pose(0.0))
"""The vault's constant pose, as the kernels read it."""

SETTLED = 1e-3
"""Fraction of its initial value to which an error must fall to count as settled: below what can be
seen in the paper's Fig. 7."""

SATURATIONS = Counts._fields.index("saturations")
"""Column of a recording's counts."""


def times_of(frames: int) -> Array:
    """The times of a run's start and of the frames after it [s], (frames + 1,)."""
    return np.asarray(STEP * np.arange(frames + 1))


@cache
def systems() -> PairSystems:
    """The paper's system of the patch and the point."""
    return PairSystems(vault(), point(), (FACE, START), (VERTEX, ()))


def system_at(q: Array, time: float) -> PairSystem:
    """The system at parameters (2,), also outside the patch, and a time [s]."""
    pose = PATH.pose(time)
    return systems().at(q, FLAT_HOME, flat_pose(pose), xi_b=flat_twist(PATH.twist(time), pose))


def projection_errors(q: Array, x: Array) -> Array:
    """Psi at parameters (n, 2) for point positions (n, 3); shape (n, 2) [length²]."""
    pose, found = FLAT_HOME.copy(), np.empty(q.shape)
    for k, at in enumerate(q):
        pose[9:] = x[k]
        found[k] = systems().psi(at, FLAT_HOME, pose)
    return found


@dataclass(frozen=True, eq=False)
class Run:
    """One run, by frame.

    Attributes
    ----------
    gain : float
        K [1/s].
    recording : Recording
    """

    gain: float
    recording: Recording

    @property
    def q(self) -> Array:
        """Parameters (u, v), shape (n, 2)."""
        return self.recording.parameters_a[:, :2]

    @property
    def witness(self) -> Array:
        """Witness point on the patch [length], world, shape (n, 3)."""
        return self.recording.point_a

    @property
    def target(self) -> Array:
        """The moving point [length], world, shape (n, 3)."""
        return self.recording.point_b

    @cached_property
    def psi(self) -> Array:
        """Projection errors [length²], Eqs. (1)-(2), shape (n, 2)."""
        return projection_errors(self.q, self.target)

    @property
    def normalised(self) -> Array:
        """Each error's magnitude divided by its first one, shape (n, 2)."""
        return np.asarray(np.abs(self.psi) / np.abs(self.psi[0]))

    @cached_property
    def cosines(self) -> Array:
        """Each error's magnitude divided by the lengths of ΔR and of its tangent, the paper's
        normalisation: the cosine of the angle between them, shape (n, 2)."""
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
        """The levels below which both cosines stay after `least` to `most` steps, not fewer and not
        more: above the first number, up to the second."""
        return float(self.cosines_left[most]), float(self.cosines_left[least - 1])

    @property
    def steps(self) -> int | None:
        """Steps after which all normalised errors stay below `SETTLED`; None if they do not."""
        above = np.flatnonzero((self.normalised >= SETTLED).any(axis=1))
        return int(above[-1]) + 1 if above[-1] + 1 < len(self.q) else None

    @property
    def monotone(self) -> bool:
        """Does no error grow in any step until all have settled?"""
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
        As for `PaperLaw`.

    Raises
    ------
    RuntimeError
        If the witness point leaves the patch.
    """
    tracker = raw_tracker(gain, feedforward, integrator)
    recording = track(tracker, frames, start)
    leaves = recording.counts[:, SATURATIONS] > 0
    if leaves.any():
        raise RuntimeError(
            f"K = {gain:g} 1/s from {start}: the witness point left the patch at step "
            f"{int(np.argmax(leaves))}."
        )
    return Run(gain, recording)


def raw_tracker(gain: float, feedforward: bool = True, integrator: str = "heun") -> Tracker:
    """The law as it is: H is not made definite, and there is no switching."""
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


def track(
    tracker: Tracker, frames: int, start: tuple[float, float], path: Path = PATH
) -> Recording:
    """Track the point from parameters (u, v) for a number of steps of `STEP`."""
    state = begun(tracker, (REST, path), (FACE, start), (VERTEX, ()))
    return track_along(tracker, REST, path, times_of(frames), state=state)
