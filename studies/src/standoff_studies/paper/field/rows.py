"""The study: every method on every work, as rows of a table; kept as JSON."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from functools import cache
from importlib.resources import files
from typing import NamedTuple

import numpy as np

from standoff_studies.paper.field.methods import METHODS, Found
from standoff_studies.paper.field.work import DURATIONS, Work, drawn_work, simulation

SUMMARY = "summary.json"
"""The study as last run, beside this module."""

DIGITS = 4
"""Significant digits of the numbers that are kept."""


class Row(NamedTuple):
    """A method on a work.

    Attributes
    ----------
    method, work : str
        Keys of the method and the work.
    frames : int
    median, worst : float
        Evaluations of a frame.
    error, off : float
        Greatest error of a witness point and of the distance, of frames that did not fail [length].
    guards : float
        Evaluations that the foot points of the printed law's guards add to a frame, in the median.
    failures : int
        Frames that gave up, or are off by more than `WRONG`.
    arrived, tried : int
        Starts.
    corners : int
        Of the greater polyhedron.
    """

    method: str
    work: str
    frames: int
    median: float
    worst: float
    error: float
    off: float
    guards: float
    failures: int
    arrived: int
    tried: int
    corners: int


class Size(NamedTuple):
    """How much work: stretches of a motion evenly and at switches, their frames, starts, drawn
    pairs, and how many of these interval Newton is given, which takes two seconds of each."""

    evenly: int
    switches: int
    frames: int
    starts: int
    pairs: int
    boxes: int = 1000


FULL = Size(evenly=20, switches=20, frames=4, starts=40, pairs=1000)
"""The committed study: three quarters of an hour of one core, most of it interval Newton."""


def works(size: Size) -> Iterator[Work]:
    """The simulations' work, then the drawn pairs'."""
    for key in DURATIONS:
        yield simulation(key, size.evenly, size.switches, size.frames, size.starts)
    for number in range(size.pairs):
        yield drawn_work(number, size.frames)


def study(
    some: Iterable[Work], methods: Iterable[str] = METHODS, boxes: int = FULL.boxes
) -> tuple[Row, ...]:
    """Run methods on some work; work of the same name makes one row."""
    keys = tuple(methods)
    found: dict[tuple[str, str], Found] = {}
    for work in some:
        for key in keys:
            if key == "boxes" and work.number >= boxes:
                continue
            done = METHODS[key].run(work)
            if done is not None:
                found.setdefault((key, work.name), Found()).add(done)
    return tuple(_row(*key, done) for key, done in found.items())


def _row(method: str, work: str, done: Found) -> Row:
    cost = np.array([frame.cost for frame in done.frames])
    good = [frame for frame in done.frames if not frame.failed]
    return Row(
        method,
        work,
        len(done.frames),
        _short(float(np.median(cost))),
        _short(float(cost.max())),
        _short(max((frame.error for frame in good), default=np.nan)),
        _short(max((frame.off for frame in good), default=np.nan)),
        _short(float(np.median([frame.guards for frame in done.frames]))),
        len(done.frames) - len(good),
        done.arrived,
        done.tried,
        done.corners,
    )


def _short(number: float) -> float:
    return float(f"{number:.{DIGITS}g}")


def as_json(rows: Iterable[Row]) -> str:
    """Return the study as JSON, a row a line."""
    return "[\n" + ",\n".join(json.dumps(row._asdict()) for row in rows) + "\n]\n"


@cache
def committed() -> tuple[Row, ...]:
    """The study as last run and stored."""
    text = (files(__package__) / SUMMARY).read_text("utf-8")
    return tuple(Row(**row) for row in json.loads(text))
