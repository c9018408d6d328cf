"""All contenders on a pair, in turn, several rounds: their times and errors."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from benchmarks.bench import library
from benchmarks.bench.contender import FEWEST, Contender, Missing, timed
from benchmarks.bench.motion import Frames, Pair, motion
from benchmarks.bench.peers import coal, coal_cpp, coal_mesh, fcl, mujoco, opencascade, slsqp
from benchmarks.bench.truth import doubt, errors, truths


@dataclass(frozen=True)
class Effort:
    """How long the table may take.

    Attributes
    ----------
    frames, contact_frames : int
        Frames apart and in penetration.
    rounds : int
        Times in turn.
    budget : float
        Time of one run of a contender that can answer as few frames as we like, s.
    finest : float
        The finest tessellation, over the size.
    """

    frames: int = 1000
    contact_frames: int = 200
    rounds: int = 9
    budget: float = 0.1
    finest: float = 1e-5


QUICK = Effort(frames=40, contact_frames=20, rounds=3, budget=0.01, finest=1e-3)
"""That of a look, and of the test."""


@dataclass(frozen=True)
class Row:
    """A contender's times of a frame, s, round by round, and its errors over the size."""

    pair: str
    contender: str
    times: tuple[float, ...]
    distance_error: float
    witness_error: float
    gap: float
    frames: int
    memory: int = 0
    missing: str = ""

    @property
    def median(self) -> float:
        return float(np.median(self.times)) if self.times else np.nan

    @property
    def spread(self) -> tuple[float, float, float, float]:
        """Least, lower and upper quartile, greatest, s."""
        if not self.times:
            return (np.nan,) * 4
        found = np.quantile(self.times, [0.0, 0.25, 0.75, 1.0])
        return tuple(found.tolist())


Entrants = Callable[[Pair, Frames], list[Contender | Missing]]


def peers(finest: float) -> dict[str, Entrants]:
    """Every package, by the name that a missing one is told under."""
    return {
        "Coal": coal.contenders,
        "Coal, C++": coal_cpp.contenders,
        "Coal, triangles": lambda pair, frames: coal_mesh.contenders(pair, frames, finest),
        "MuJoCo": mujoco.contenders,
        "python-fcl": fcl.contenders,
        "OpenCASCADE": opencascade.contenders,
        "SciPy SLSQP": slsqp.contenders,
    }


def entrants(pair: Pair, frames: Frames, finest: float) -> list[Contender | Missing]:
    """The library's contenders, then every peer's; a peer that is not installed says so."""
    found: list[Contender | Missing] = [*library.ours(pair, frames)]
    for name, enter in peers(finest).items():
        try:
            found += enter(pair, frames)
        except ImportError as error:
            found.append(Missing(name, str(error)))
    return found


def raced(pair: Pair, effort: Effort) -> tuple[list[Row], float]:
    """A row for each contender of a pair, and the doubt of the truth they are held to."""
    count = effort.contact_frames if pair.overlap else effort.frames
    frames = motion(pair.far, count)
    all_of = entrants(pair, frames, effort.finest)
    able = [c for c in all_of if isinstance(c, Contender)]
    counts = [_count(contender, effort, count) for contender in able]
    known = truths(pair, frames, count)
    judged = [errors(pair, contender, known) for contender in able]
    times = np.array(
        [[timed(c, n) for c, n in zip(able, counts, strict=True)] for _ in range(effort.rounds)]
    )
    rows = [
        Row(pair.name, c.name, tuple(column.tolist()), *error, n, c.memory)
        for c, column, error, n in zip(able, times.T, judged, counts, strict=True)
    ]
    rows += [
        Row(pair.name, m.name, (), np.nan, np.nan, np.nan, 0, missing=m.why)
        for m in all_of
        if isinstance(m, Missing)
    ]
    return rows, max(doubt(pair, frames, k, truth) for k, truth in known.items())


def _count(contender: Contender, effort: Effort, count: int) -> int:
    """Frames of one run: all of them where a state is carried on; it is warm after that."""
    if contender.whole:
        contender.run(count)  # its answers are judged
        return count
    contender.run(FEWEST)
    fitting = int(effort.budget / max(timed(contender, FEWEST), 1e-9))
    return min(max(fitting, FEWEST), count)
