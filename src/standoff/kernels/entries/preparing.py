"""Loading or compiling ahead what a loop will call, so that no frame waits for it."""

from __future__ import annotations

import importlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from standoff.kernels.compiler import cache
from standoff.kernels.compiler.entry import Entry
from standoff.kernels.compiler.notices import parts
from standoff.kernels.entries import queries, servo, simulation, tracker

MODULES = (
    "standoff.kernels.entries.queries",
    "standoff.kernels.entries.tracker",
    "standoff.kernels.entries.laws",
    "standoff.kernels.entries.batch",
    "standoff.kernels.entries.derivatives",
    "standoff.kernels.entries.smooth",
    "standoff.kernels.entries.simulation",
    "standoff.kernels.entries.servo",
    "standoff.kernels.pair.normals_system",
)
"""Where entries stand."""

BODIES = ("on_face", "inner_box", "chart_normal", "surface_jet", "curve_jet")
"""What places a start."""

PLANAR = ("pcurve_jet", "planar_edge_normal")
"""What that of planar bodies needs beside it."""

LOCATING = ("feature_jet", "edge_jet", "coedge_conormal", "end_direction")
"""What locates the instant of a switch in a recorded run."""

ready_for: set[tuple[bool, bool]] = set()


def prepare(planar: bool, runs: bool = False) -> None:
    """Have ready what a tracker can reach, in contact and out of it; the frame of its own law is
    there by then.

    Parameters
    ----------
    planar : bool
        Of planar bodies.
    runs : bool
        And the loop over many frames, and what locates a switch in it.
    """
    if (planar, runs) in ready_for:
        return
    names = BODIES + (PLANAR if planar else ()) + (LOCATING if runs else ())
    needed = [getattr(queries, name) for name in names]
    needed += [tracker.start, tracker.value, tracker.step]
    if runs:
        needed.append(tracker.values)
    _prepare_each(needed)
    ready_for.add((planar, runs))


def prepare_buffer() -> None:
    """Have ready what a frame in a buffer is made by."""
    _prepare_each([tracker.moved])


def prepare_simulation() -> None:
    """Have ready what a simulated system runs by."""
    _prepare_each([simulation.run_system])


def prepare_servo() -> None:
    """Have ready what a servo loop runs by, and what the slower side calls meanwhile."""
    _prepare_each([simulation.run_system, servo.serve, servo.put_row, servo.take_row])
    prepare_simulation()


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
