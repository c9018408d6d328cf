"""Loading or compiling ahead of time what a loop will call, so that no frame waits for it."""

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
    "standoff.kernels.entries.patches",
    "standoff.kernels.entries.smooth",
    "standoff.kernels.entries.simulation",
    "standoff.kernels.entries.servo",
    "standoff.kernels.entries.world",
    "standoff.kernels.entries.world_answers",
    "standoff.kernels.entries.planar_solids",
    "standoff.kernels.entries.solids",
    "standoff.kernels.entries.minima",
    "standoff.kernels.entries.tracked_solids",
    "standoff.kernels.entries.solid_contact",
    "standoff.kernels.entries.solid_points",
)
"""The modules that have entries."""

LOCATING = ("feature_jet", "edge_jet", "coedge_conormal", "end_direction")
"""What locates the instant of a switch in a recorded run."""

ready_for: set[bool] = set()


def prepare(runs: bool = False) -> None:
    """Prepare what calls a tracker's frames; the frame of its own law, which reaches everything
    needed in contact and out of it, is ready by then.

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
    """Prepare what makes a frame in a buffer."""
    _prepare_each([tracker.moved, tracker.moved_by_poses])


def prepare_simulation() -> None:
    """Prepare what runs a simulated system."""
    from standoff.kernels.entries import simulation

    _prepare_each([simulation.run_system])


def prepare_servo() -> None:
    """Prepare what runs a servo loop, and what the slower side calls meanwhile."""
    from standoff.kernels.entries import servo, simulation

    _prepare_each([simulation.run_system, servo.serve, servo.put_row, servo.take_row])


def prepare_tracked_solids() -> None:
    """Prepare what calls frames of two solids, and queries from nothing."""
    from standoff.kernels.entries import (
        minima,
        solid_contact,
        solid_points,
        solids,
        tracked_solids,
    )

    needed = [tracked_solids.solid_frames, solids.boundary_distance, solids.solid_point]
    needed += [solids.leaf_points, solids.nearest_in_leaves]
    needed += [
        tracked_solids.number_minima,
        tracked_solids.placed_beside,
        minima.stationary,
        minima.one_place,
        minima.greatest_gap,
    ]
    needed += [minima.span_patches, solid_contact.follow_contact, solid_contact.signed_minima]
    needed += [solid_contact.pieces_parted, solid_points.point_depth]
    needed += [solid_points.side_beside, solid_points.outward_at]
    _prepare_each(needed)


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
    """Prepare every entry, before other processes that ask for them are started."""
    _prepare_each(list(every_entry()))


def prepare_named(module: str, name: str) -> None:
    """Prepare an entry for another process that asks for it; does nothing if there is none."""
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
