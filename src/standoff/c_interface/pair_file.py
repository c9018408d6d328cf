"""Files of pairs: what the C interface loads."""

from __future__ import annotations

import struct
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.boundary import Boundary
from standoff.bodies.packed_parts import formulas_of
from standoff.c_interface import solid_file
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.kernels.compiler.machine import source_digest
from standoff.solids.tracked.tracker import SolidTracker
from standoff.tracking.laws import PaperLaw
from standoff.tracking.options import with_frames
from standoff.tracking.reached import packed
from standoff.tracking.specialised import COMPILED_AHEAD, smooth_frame_of
from standoff.tracking.tracker import Tracker
from standoff.whole_files import file_name, write_whole

MAGIC = b"STANDOF1"
SMOOTH_FRAMES = tuple(COMPILED_AHEAD.values())
"""Numbered from 1 in files; 0 is none."""

OFFSET_BASIS, PRIME, BITS_64 = 0xCBF29CE484222325, 0x100000001B3, (1 << 64) - 1


def save_pair(path: str | Path, tracker: Tracker | SolidTracker) -> None:
    """Write a tracker's two bodies, its law and its frame time to a file for ``standoff_load``; of
    a tracker of solids for ``standoff_solids_load``.

    The file fits the library that the same version of Standoff builds. It is written whole or not
    at all.

    Raises StandoffTypeError: not a tracker. Raises StandoffError: a body with a surface or curve
    made of formulas, whose machine code lives in this process; a tracker with ``specialise=True``
    for kinds of faces for which the library has no frame. Raises OSError if the file cannot be
    written.

    Parameters
    ----------
    path : str or Path
        New, or replaced.
    tracker : Tracker or SolidTracker
    """
    target = file_name(path)
    if isinstance(tracker, SolidTracker):
        _save_solids(target, tracker)
        return
    if not isinstance(tracker, Tracker):
        raise StandoffTypeError(f"tracker is {shown(tracker)}: give a Tracker.", "tracker", tracker)
    for name, body in (("A", tracker.a), ("B", tracker.b)):
        _refuse_formulas(name, body)
    write_whole({target: partial(_put, _content(tracker, _smooth_number(tracker)))})


def _save_solids(target: Path, tracker: SolidTracker) -> None:
    for name, solid in (("A", tracker.a), ("B", tracker.b)):
        _refuse_formulas(name, solid.boundary)
    arrays = [_plain(each) for each in solid_file.arrays_of(tracker)]
    header = solid_file.header_of(tracker, [len(each) for each in arrays])
    write_whole({target: partial(_put, _stamped(solid_file.MAGIC, header, arrays))})


def _refuse_formulas(name: str, body: Boundary) -> None:
    formulas = formulas_of(body.edge_parts, body.face_parts)
    if formulas:
        raise StandoffError(
            f"Body {name} is made of formulas ({', '.join(map(str, formulas[0].expressions))}): "
            "their machine code lives in this process and cannot go to a file. Make the body of "
            "NURBS, revolved or extruded surfaces whose curves are not formulas.",
            "tracker",
            body,
        )


def _smooth_number(tracker: Tracker) -> int:
    """Which frame is tried first, as files number them."""
    if isinstance(tracker.law, PaperLaw):
        return 0
    frame = smooth_frame_of(tracker.a, tracker.b, tracker.specialise)
    if frame is None:
        return 0
    if frame not in SMOOTH_FRAMES:
        raise StandoffError(
            "specialise=True has compiled a frame for these bodies' kinds of faces, which the C "
            "library does not have: make the tracker without it.",
            "tracker",
            tracker,
        )
    return SMOOTH_FRAMES.index(frame) + 1


def _content(tracker: Tracker, smooth: int) -> bytes:
    paper = isinstance(tracker.law, PaperLaw)
    options = with_frames(tracker.options)
    arrays = [_plain(x) for x in (*packed(tracker.a, tracker.b), options)]
    # a shorter step than the paper's law was made for is stable as well
    longest = tracker.dt if paper else float("inf")
    header = struct.pack("<qq5qdd", int(paper), smooth, *map(len, arrays), tracker.dt, longest)
    return _stamped(MAGIC, header, arrays)


def _plain(array: NDArray[Any]) -> NDArray[Any]:
    return np.ascontiguousarray(array, "<i8" if array.dtype.kind == "i" else "<f8")


def _stamped(magic: bytes, header: bytes, arrays: list[NDArray[Any]]) -> bytes:
    """A file's content: for which kernels it is and its checksum, then the header and arrays."""
    checked = header + b"".join(x.tobytes() for x in arrays)
    return magic + source_digest().encode() + struct.pack("<Q", fnv1a(checked)) + checked


def fnv1a(content: bytes) -> int:
    """The 64-bit Fowler-Noll-Vo hash, 1a."""
    found = OFFSET_BASIS
    for byte in content:
        found = ((found ^ byte) * PRIME) & BITS_64
    return found


def _put(content: bytes, file: BinaryIO) -> None:
    file.write(content)
