"""The cells of the study of convergence: each a pair, a motion, a law and a gain."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass
from functools import partial
from importlib.resources import files
from itertools import product
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from standoff.tracking.laws import PaperLaw
from standoff.whole_files import write_whole
from standoff_studies.paper.convergence.pairs import (
    DRAWN_PAIRS,
    GRIDS,
    LENSES,
    SHARP,
    TURNING,
    pair,
)
from standoff_studies.paper.convergence.starts import outcome, trial

GAINS = (25.0, 100.0, 400.0, 1000.0)
"""K [1/s]: from "a very low controller gain" to K h = 1."""

SEED = 12
"""Of the starts; every cell of a pair has the same ones."""

SUMMARY = "summary.json"

CONFIDENCE = 1.96
"""Half width of a 95 % interval of a normal variable, in standard deviations."""

MOTIONS = {"rest": "at rest", "moving": "moving"}
"""The motions of the bodies."""


class LawOf(NamedTuple):
    """A law of the study.

    Attributes
    ----------
    name : str
    starts : int
        How many starts a cell has.
    options : dict
        Options of `PaperLaw`, in addition to the gain and no restarts.
    """

    name: str
    starts: int
    options: dict[str, Any]


PRINTED = {"saturation": "zero", "switching": "voronoi", "reset": "nearest"}
"""Zeroing, switching and resets as printed."""

LAWS = {
    "printed": LawOf("as printed", 300, {**PRINTED, "solve": "plain", "far_side": "kept"}),
    "printed-left": LawOf("as printed, far side left", 300, {**PRINTED, "solve": "plain"}),
    "covariant": LawOf("covariant M", 1000, {**PRINTED, "solve": "covariant"}),
    "covariant-hold": LawOf(
        "covariant M, boundaries held",
        1000,
        {**PRINTED, "solve": "covariant", "saturation": "hold"},
    ),
    "ranked": LawOf("rank rule", 200, {**PRINTED, "solve": "ranked"}),
    "own": LawOf("multipliers, rank rule", 1000, {}),
    "newton": LawOf("Newton", 200, {**PRINTED, "integrator": "euler", "solve": "plain"}),
}
"""The laws by key, with the starts of a cell."""

FEWER = {("printed", "drawn"): 100, ("covariant-hold", "lens"): 300}
"""Starts of laws that have fewer on some pairs: on each drawn pair, and on the bodies of D, E and
C, where every start arrives without holding boundaries."""

HARDER_STARTS = 100
"""Starts of each cell with a harder pair."""

Options = tuple[str, str, str, float]
"""The key of a cell: the pair, the motion, the law, the gain."""


@dataclass(frozen=True)
class Cell:
    """One pair, motion, law and gain, and the results of its starts.

    Attributes
    ----------
    pair, motion, law : str
        Keys.
    gain : float
        1/s
    tried, arrived : int
    median, slowest : float or None
        Time to arrive of those that do: the median and the 99th percentile [s]; None if none do.
    right, settled : int
        On the features of the closest points after the first frame, and at the end.
    definite, definite_arrived : int
        Of the `right` ones, those with the printed M definite after the first frame, and how many
        of these arrive.
    right_arrived : int
        How many of the `right` ones arrive.
    causes : dict
        How many of those that do not arrive, by cause. A cause with "elsewhere" is on features
        other than those of the closest points.
    """

    pair: str
    motion: str
    law: str
    gain: float
    tried: int
    arrived: int
    median: float | None
    slowest: float | None
    right: int
    settled: int
    definite: int
    definite_arrived: int
    right_arrived: int
    causes: dict[str, int]

    @property
    def part(self) -> float:
        """Fraction of the starts that arrive."""
        return self.arrived / self.tried

    @property
    def interval(self) -> tuple[float, float]:
        """Wilson's 95 % interval of that fraction."""
        return wilson(self.arrived, self.tried)

    @property
    def options(self) -> Options:
        """The key of the cell."""
        return self.pair, self.motion, self.law, self.gain


def wilson(arrived: int, tried: int) -> tuple[float, float]:
    """Return Wilson's 95 % interval of a fraction."""
    n, p, z = tried, arrived / tried, CONFIDENCE
    middle = (p + z * z / (2.0 * n)) / (1.0 + z * z / n)
    half = z / (1.0 + z * z / n) * math.sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n))
    return max(0.0, middle - half), min(1.0, middle + half)


def law_of(key: str, gain: float) -> PaperLaw:
    """Return a law of the study; "printed" is the system as printed."""
    return PaperLaw(gain=gain, restarts=False, **LAWS[key].options)


def starts_of(options: Options) -> int:
    """Return how many starts a cell has."""
    name, _, law, _ = options
    if name in GRIDS:
        return len(pair(name).grid)
    if name.startswith(("turning", "sharp")):
        return HARDER_STARTS
    kind = "drawn" if name in DRAWN_PAIRS else "vaults" if name == "A vaults" else "lens"
    return FEWER.get((law, kind), LAWS[law].starts)


def made(options: Options, starts: int | None = None) -> tuple[Cell, list[dict[str, Any]]]:
    """Run one cell; return also the traces of the starts that do not arrive."""
    name, motion, law, gain = options
    subject = pair(name)
    tried = trial(subject, motion, law_of(law, gain))
    rng, n = np.random.default_rng(SEED), starts_of(options) if starts is None else starts
    places = [*subject.grid[:n]] or [subject.draw(rng) for _ in range(n)]
    found = [outcome(tried, *place) for place in places]
    there = [each.time for each in found if np.isfinite(each.time)]
    median, slowest = np.quantile(there, (0.5, 0.99)).tolist() if there else (None, None)
    ends = [(k, each.end) for k, each in enumerate(found) if each.end is not None]
    cell = Cell(
        *options,
        n,
        len(there),
        median,
        slowest,
        right=sum(each.right for each in found),
        settled=sum(each.settled for each in found),
        definite=sum(each.definite for each in found),
        definite_arrived=sum(each.definite and each.end is None for each in found),
        right_arrived=sum(each.right and each.end is None for each in found),
        causes=dict(Counter(end.cause + ("" if end.placed else ", elsewhere") for _, end in ends)),
    )
    return cell, [{"start": k, "places": places[k], **end._asdict()} for k, end in ends]


def every_cell() -> Iterator[Options]:
    """Yield the options of all cells."""
    every = (*LENSES, "A point", "A vaults", "B", "C", *DRAWN_PAIRS)
    yield from product(every, MOTIONS, ("covariant", "printed"), GAINS)
    held = ("E patches", "D patches", "A point", "A vaults", "C", *DRAWN_PAIRS)
    yield from product(held, MOTIONS, ("covariant-hold",), GAINS)
    left = (*(name for name in LENSES if name != "D gnomonic" and name != "D stereographic"),)
    yield from product(
        (*left, "A point", "A vaults", *DRAWN_PAIRS), ("rest",), ("printed-left",), GAINS
    )
    yield from product(("E patches", *DRAWN_PAIRS), ("rest",), ("ranked",), (GAINS[0], GAINS[-1]))
    yield from product(("D patches", "E patches"), ("rest",), ("own",), GAINS[-1:])
    yield from product(GRIDS, ("rest",), ("printed", "printed-left", "covariant"), GAINS[:1])


HARDER_LAWS = {"printed": 100.0, "covariant-hold": 100.0, "newton": 1000.0}
"""The laws of the harder cells, and their gains [1/s]: K h = 0.1, and 1 for Newton's method."""


def harder_cells() -> Iterator[Options]:
    """Yield the options of the cells with faster bodies and with sharper ones."""
    turning = [("moving", name) for names in TURNING.values() for name in names]
    still = [("rest", name) for name in next(iter(TURNING.values()))]
    sharp = [("rest", name) for names in SHARP.values() for name in names]
    for (motion, name), (law, gain) in product([*still, *turning, *sharp], HARDER_LAWS.items()):
        yield name, motion, law, gain


def study(
    kept: Path,
    processes: int = 2,
    starts: int | None = None,
    every: Callable[[], Iterable[Options]] = every_cell,
) -> None:
    """Run all cells that are not in a file yet; the whole file is written again after each."""
    lines = kept.read_text("utf-8").splitlines() if kept.exists() else []
    have = {cell.options for cell, _ in read(lines)}
    waiting = [options for options in every() if options not in have]
    with ProcessPoolExecutor(processes) as pool:
        runs = [pool.submit(made, options, starts) for options in waiting]
        for run in as_completed(runs):
            lines.append(line(*run.result()))
            write_whole({kept: partial(_put, "\n".join([*lines, ""]))})


def _put(text: str, stream: BinaryIO) -> None:
    stream.write(text.encode())


def line(cell: Cell, traces: list[dict[str, Any]]) -> str:
    """Return a cell and its traces as a line of JSON."""
    return json.dumps({"cell": asdict(cell), "traces": traces})


def read(lines: Iterable[str]) -> list[tuple[Cell, list[dict[str, Any]]]]:
    """Return cells and traces from such lines."""
    rows = [json.loads(text) for text in lines if text.strip()]
    return [(Cell(**row["cell"]), row["traces"]) for row in rows]


def committed(name: str = SUMMARY) -> tuple[Cell, ...]:
    """Return the cells as they were run when a summary was last written."""
    text = files("standoff_studies.paper.convergence").joinpath(name).read_text("utf-8")
    return tuple(Cell(**row) for row in json.loads(text)["cells"])


def summary(
    run: Iterable[tuple[Cell, list[dict[str, Any]]]],
    every: Callable[[], Iterable[Options]] = every_cell,
) -> str:
    """Return the text of a summary: one line per cell, in the order of `every`."""
    found = {cell.options: cell for cell, _ in run}
    ordered = [found[options] for options in every() if options in found]
    rows = ",\n  ".join(json.dumps(asdict(cell)) for cell in ordered)
    return f'{{"seed": {SEED}, "cells": [\n  {rows}\n]}}\n'
