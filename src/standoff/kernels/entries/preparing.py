"""Loading or compiling ahead what a loop will call, so that no frame waits for it."""

from __future__ import annotations

import importlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from standoff.kernels.compiler import cache
from standoff.kernels.compiler.entry import Entry
from standoff.kernels.compiler.notices import parts
from standoff.kernels.entries import queries, tracker

MODULES = (
    "standoff.kernels.entries.queries",
    "standoff.kernels.entries.tracker",
    "standoff.kernels.entries.laws",
    "standoff.kernels.entries.paper_laws",
    "standoff.kernels.entries.batch",
    "standoff.kernels.entries.derivatives",
    "standoff.kernels.entries.smooth",
    "standoff.kernels.entries.simulation",
    "standoff.kernels.entries.servo",
)
"""Where entries stand."""

LOCATING = ("feature_jet", "edge_jet", "coedge_conormal", "end_direction")
"""What locates the instant of a switch in a recorded run."""

ready_for: set[bool] = set()


def prepare(runs: bool = False) -> None:
    """Have ready what a tracker's frames are called by; the frame of its own law, which reaches
    all that is to be met in contact and out of it, is there by then.

    Parameters
    ----------
    runs : bool
        And the loop over many frames, and what locates a switch in it.
    """
    if runs in ready_for:
        return
    needed = [tracker.query, tracker.step, tracker.value, tracker.value_by_poses]
    if runs:
        needed += [tracker.start, tracker.values, *(getattr(queries, name) for name in LOCATING)]
    _prepare_each(needed)
    ready_for.add(runs)


def prepare_buffer() -> None:
    """Have ready what a frame in a buffer is made by."""
    _prepare_each([tracker.moved, tracker.moved_by_poses])


def prepare_simulation() -> None:
    """Have ready what a simulated system runs by."""
    from standoff.kernels.entries import simulation

    _prepare_each([simulation.run_system])


def prepare_servo() -> None:
    """Have ready what a servo loop runs by, and what the slower side calls meanwhile."""
    from standoff.kernels.entries import servo, simulation

    _prepare_each([simulation.run_system, servo.serve, servo.put_row, servo.take_row])


def _prepare_each(needed: Sequence[Any]) -> None:
    entries = [each for each in needed if isinstance(each, Entry)]  # none with NUMBA_DISABLE_JIT=1
    for each in parts(entries):
        each.prepare()


def every_entry() -> Iterator[Entry]:
    """All entries, in the order of their modules."""
    for name in MODULES:
        for each in vars(importlib.import_module(name)).values():
            if isinstance(each, Entry) and each.py_func.__module__ == name:
                yield each


def prepare_all() -> None:
    """Have every entry ready, before other processes that ask for them are started."""
    _prepare_each(list(every_entry()))


def prepare_named(module: str, name: str) -> None:
    """Have an entry ready for another process that asks for it; nothing where there is none."""
    entry = getattr(importlib.import_module(module), name, None)
    if isinstance(entry, Entry):
        entry.prepare()


def name_of(entry: Entry) -> str:
    """Its module and its own name, such as ``tracker.start``."""
    return f"{entry.py_func.__module__.rpartition('.')[2]}.{entry.py_func.__name__}"


def was_compiled(entry: Entry) -> bool:
    """Was its machine code made in this process? Else it was found on disk."""
    return bool(entry.stats.cache_misses)


def kept_in(entry: Entry) -> Path | None:
    """The folder of its machine code, once it is ready; None where it could not be kept."""
    folder = Path(entry.stats.cache_path)
    return folder if folder.is_dir() and not cache._unsaved.cache_info().misses else None
