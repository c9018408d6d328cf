"""The cells of the study of convergence: each a law and a motion, run from many random starts."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from importlib.resources import files
from itertools import product

import numpy as np
from numpy.typing import NDArray

from standoff.motion import Fixed, Path, Twist
from standoff.recording import simulate
from standoff.recording.times import even_times
from standoff.tracking import Tracker
from standoff.tracking.laws import PaperLaw
from standoff_studies.paper.many_starts import distances, motion_along
from standoff_studies.paper.simulation_e.runs import PATH_A, PATH_B, STEP, pair

Array = NDArray[np.float64]

GAINS = (25.0, 100.0, 400.0, 1000.0)
"""K [1/s]: from "a very low controller gain" to K h = 1."""

STARTS = 1000
"""Random starts a cell: one in a hundred that fails is then known to half of itself."""

PATIENCE = 15.0
"""Times 1/K after which a start has arrived or counts as one that has not: exp(-15) is 3e-7."""

LEAST_FRAMES = 20
"""Added to it: a start may have to walk over several features, one a frame."""

ARRIVED = 1e-4
"""Greatest error of the distance of a start that has arrived [length]; the bodies are of size 2."""

SEED = 12
"""Of the starts; every cell has the same ones."""

CONFIDENCE = 1.96
"""Half width of a 95 % interval of a normal variable, in standard deviations."""

SOLVES = {"plain": "M as it is", "ranked": "rank rule"}
SWITCHINGS = {"voronoi": "Voronoi tests", "multipliers": "multipliers"}
MOTIONS = {"rest": "at rest", "moving": "moving"}
"""What the cells' options are called."""

SUMMARY = "summary.json"


@dataclass(frozen=True)
class Cell:
    """One law and motion, and what became of its starts.

    Attributes
    ----------
    motion, switching, solve : str
    gain : float
        1/s
    tried, arrived : int
    median, slowest : float
        Time to arrive of those that do: the middle one and that of 99 of 100 [s]; nan if none do.
    """

    motion: str
    switching: str
    solve: str
    gain: float
    tried: int
    arrived: int
    median: float
    slowest: float

    @property
    def part(self) -> float:
        """Part of the starts that arrive."""
        return self.arrived / self.tried

    @property
    def interval(self) -> tuple[float, float]:
        """Wilson's 95 % interval of that part."""
        n, p, z = self.tried, self.part, CONFIDENCE
        middle = (p + z * z / (2.0 * n)) / (1.0 + z * z / n)
        half = z / (1.0 + z * z / n) * math.sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n))
        return max(0.0, middle - half), min(1.0, middle + half)


def law_of(switching: str, solve: str, gain: float) -> PaperLaw:
    """Return a cell's law; "voronoi" and "plain" are the system as printed."""
    if switching == "voronoi":
        return PaperLaw(
            gain=gain,
            saturation="zero",
            switching="voronoi",
            solve=solve,
            reset="nearest",
            restarts=False,
        )
    return PaperLaw(gain=gain, switching=switching, solve=solve, restarts=False)


def path_of(motion: str) -> Path:
    """Return B's path: at rest at its first pose, or moving as in simulation E."""
    return PATH_B if motion == "moving" else Fixed(PATH_B.pose(0.0))


def frames_of(gain: float) -> int:
    """Return how many frames a start is given."""
    return round(PATIENCE / gain / STEP) + LEAST_FRAMES


def arrival_times(motion: str, law: PaperLaw, starts: int = STARTS) -> Array:
    """Return when each start has arrived for good [s], shape (starts,); nan where it never does.

    Starts are uniform in the parameters of a random face of each body.
    """
    a, b = pair()
    assert law.gain is not None
    tracker, path, n = Tracker(a, b, STEP, law=law), path_of(motion), frames_of(law.gain)
    rows = motion_along(PATH_A, path, even_times(0.0, n * STEP, STEP))
    due = simulate(Tracker(a, b, STEP), PATH_A, path, n * STEP).distance[1:]
    rng, found = np.random.default_rng(SEED), np.full(starts, np.nan)
    poses, twists = (PATH_A.pose(0.0), path.pose(0.0)), (Twist.zero(), path.twist(0.0))
    for k in range(starts):
        faces, at = rng.integers(3, size=2).tolist(), rng.uniform(size=(2, 2))
        places = (("face", faces[0]), at[0]), (("face", faces[1]), at[1])
        state = tracker.start_from(*poses, *places, *twists, settle=False)
        off = np.flatnonzero(~(np.abs(distances(tracker, state, rows) - due) < ARRIVED))
        last = int(off[-1]) if len(off) else -1
        if last < n - 1:
            found[k] = (last + 2) * STEP
    return found


def made(cell: tuple[str, str, str, float], starts: int = STARTS) -> Cell:
    """Run one cell."""
    motion, switching, solve, gain = cell
    times = arrival_times(motion, law_of(switching, solve, gain), starts)
    there = times[np.isfinite(times)]
    median, slowest = np.quantile(there, (0.5, 0.99)).tolist() if len(there) else (np.nan, np.nan)
    return Cell(motion, switching, solve, gain, starts, len(there), median, slowest)


def every_cell() -> Iterator[tuple[str, str, str, float]]:
    """Yield the options of all cells."""
    yield from product(MOTIONS, SWITCHINGS, SOLVES, GAINS)


def study(processes: int = 2, starts: int = STARTS) -> tuple[Cell, ...]:
    """Run all cells, some side by side; eight minutes of processor time with kernels compiled."""
    cells = list(every_cell())
    with ProcessPoolExecutor(processes) as pool:
        return tuple(pool.map(made, cells, [starts] * len(cells)))


def committed() -> tuple[Cell, ...]:
    """Return the cells as they were run when the summary was last written."""
    text = files("standoff_studies.paper.convergence").joinpath(SUMMARY).read_text()
    return tuple(Cell(**row) for row in json.loads(text)["cells"])


def summary(cells: tuple[Cell, ...]) -> str:
    """Return the text of a summary: every cell a line."""
    rows = ",\n  ".join(json.dumps(asdict(cell)) for cell in cells)
    return f'{{"seed": {SEED}, "cells": [\n  {rows}\n]}}\n'
