"""``python -m benchmarks.memory [--steps N]``: what memory a process holds over many Python steps.

The tool passes in and out of contact with the lens, over its edge: all ways that a frame can go.
"""

from __future__ import annotations

import argparse
import gc
import os
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import standoff as so

Array = NDArray[np.float64]
FRAMES = 1000
STEPS = 10_000_000
STATM = Path("/proc/self/statm")


def resident() -> int:
    """Bytes of memory that the process holds, of Linux's account."""
    return int(STATM.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def placed() -> Array:
    """Poses (FRAMES, 4, 4) of the tool on a closed way, a tenth of it in the lens."""
    angles = 2.0 * np.pi * np.arange(FRAMES) / FRAMES
    poses = np.tile(np.eye(4), (FRAMES, 1, 1))
    poses[:, :3, :3] = Rotation.from_euler("zx", np.c_[angles, 0.3 * np.sin(angles)]).as_matrix()
    poses[:, 0, 3] = (1.15 + 0.25 * np.sin(3.0 * angles)) * np.cos(angles)
    poses[:, 2, 3] = (1.15 + 0.25 * np.sin(3.0 * angles)) * np.sin(angles)
    return poses


def calls() -> dict[str, Callable[[], None]]:
    """FRAMES steps of each kind."""
    tracker = so.Tracker(so.shapes.lens(1.0, 0.45), so.shapes.ellipsoid(0.15, 0.30, 0.20))
    rest, poses = np.eye(4), placed()
    begin = tracker.start(rest, poses[0])
    buffer = tracker.buffer(begin)

    def as_values() -> None:
        state = begin
        for pose in poses:
            state, _ = tracker.step(state, rest, pose)

    def in_place() -> None:
        for pose in poses:
            tracker.step_into(buffer, rest, pose)

    def in_a_run() -> None:
        tracker.run(begin, rest, poses)

    return {"step": as_values, "step_into": in_place, "run": in_a_run}


def grown(call: Callable[[], None], steps: int) -> int:
    """By how many bytes the process has grown over so many steps, after a first round."""
    for _ in range(10):
        call()
    gc.collect()
    before = resident()
    for _ in range(steps // FRAMES):
        call()
    gc.collect()
    return resident() - before


def main(given: Sequence[str] | None = None) -> None:
    """Print a line for each kind of step."""
    reader = argparse.ArgumentParser(description="Memory over many Python steps.")
    reader.add_argument("--steps", type=int, default=STEPS)
    steps = reader.parse_args(given).steps
    for name, call in calls().items():
        begun = time.perf_counter()
        more = grown(call, steps)
        taken = time.perf_counter() - begun
        print(f"{name}: {steps} steps in {taken:.0f} s, {more / 1024:.0f} kB more", flush=True)


if __name__ == "__main__":
    main()
