"""A contender: it answers the frames of a pair, and says afterwards what it answered."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FEWEST = 2
"""Frames of one run of the slowest contenders."""


@dataclass(frozen=True)
class Found:
    """Signed distance, witness points (3,) in world, and the gap of a certificate if there is one.

    Lengths.
    """

    distance: float
    point_a: Array
    point_b: Array
    gap: float = np.nan


@dataclass(frozen=True)
class Contender:
    """One package at one setting, on one pair.

    Attributes
    ----------
    name : str
        Package and setting, as the table shows it.
    run : Callable[[int], float | None]
        Answers the first so many frames after the start; its own time, s, if it has a clock of
        its own, as another process has.
    found : Callable[[int], Found]
        What it answers at a frame; not timed.
    most : int
        Frames that it can answer in one run.
    memory : int
        Bytes that both bodies take; 0 where it is not known.
    whole : bool
        Does it go through all frames in every run, as what carries a state does? Others are
        asked as many as the budget allows, and are judged on any.
    keeps : object
        What must live as long: Coal's functor does not own its shapes.
    """

    name: str
    run: Callable[[int], float | None]
    found: Callable[[int], Found]
    most: int
    memory: int = 0
    whole: bool = True
    keeps: Any = None


@dataclass(frozen=True)
class Missing:
    """A contender that cannot run here, and how it could."""

    name: str
    why: str


def asked(
    name: str,
    frames: list[tuple[Array, Array]],
    ask: Callable[[Array, Array], Any],
    read: Callable[[Any], Found],
    memory: int = 0,
    keeps: Any = None,
) -> Contender:
    """Return a contender that is asked frame by frame, by the poses (4, 4) of both bodies.

    ``frames[0]`` is the start; ``read`` makes the answer of what ``ask`` returned last.
    """

    def run(count: int) -> None:
        for pose_a, pose_b in frames[1 : count + 1]:
            ask(pose_a, pose_b)

    def found(k: int) -> Found:
        ask(*frames[k - 1])  # a guess that is kept comes from the frame before
        return read(ask(*frames[k]))

    return Contender(name, run, found, len(frames) - 1, memory, whole=False, keeps=keeps)


def timed(contender: Contender, count: int) -> float:
    """Return the time of one of ``count`` frames, s, in one run."""
    gc.collect()
    gc.disable()
    try:
        contender.run(FEWEST)  # others have used the caches since its last turn
        begun = time.perf_counter()
        own = contender.run(count)
        taken = time.perf_counter() - begun
    finally:
        gc.enable()
    return (taken if own is None else own) / count
