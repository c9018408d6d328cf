"""A step from C, from Python and in a compiled run: ``python -m benchmarks.c_interface``.

Builds the library into a temporary folder (some minutes) and needs a C compiler. Each figure is
the median of repeated runs over the same frames; the answers of C and Python are compared bit by
bit on the way.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "tests"))

import standoff as so  # noqa: E402
from c_interface import following, solid_following  # noqa: E402
from standoff.c_interface import build_library  # noqa: E402

COUNT, COUNT_OF_SOLIDS, REPEATS = 2000, 200, 7


def matrices(flat: np.ndarray) -> np.ndarray:
    poses = np.tile(np.eye(4), (len(flat), 1, 1))
    poses[:, :3, :3], poses[:, :3, 3] = flat[:, :9].reshape(-1, 3, 3), flat[:, 9:12]
    return poses


def run_seconds(tracker: so.Tracker, frames: np.ndarray) -> float:
    """Of all frames but the first in one compiled run."""
    poses_a, poses_b = matrices(frames[:, :12]), matrices(frames[:, 12:24])
    twists = (frames[:, 24:30], frames[:, 30:36]) if frames[0, 36] else (None, None)
    first = [None if way is None else way[0] for way in twists]
    state = tracker.start(poses_a[0], poses_b[0], *first)
    rest = [None if way is None else way[1:] for way in twists]
    began = time.perf_counter()
    tracker.run(state, poses_a[1:], poses_b[1:], *rest)
    return time.perf_counter() - began


def main() -> None:
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        build_library(folder)
        program = folder / "follow"
        command = ["cc", "-std=c11", "-O2", "-D_POSIX_C_SOURCE=199309L", f"-I{folder}", "-o"]
        command += [str(program), str(following.FRAMES), f"-L{folder}", "-lstandoff", "-lm"]
        subprocess.run([*command, "-Wl,-rpath,$ORIGIN"], check=True)
        print("| pair | C, us | `tracker.run`, us | `step_into`, us | C / run | bits |")
        print("|---|---|---|---|---|---|")
        for name, case in following.CASES.items():
            tracker = so.Tracker(case.a, case.b, following.DT, case.law)
            frames = following.motion(case, COUNT)
            in_c, in_run, in_python = [], [], []
            for _ in range(REPEATS):
                answers, seconds = following.in_c(program, tracker, frames, folder)
                expected, called = following.in_python(tracker, frames)
                in_c.append(seconds)
                in_run.append(run_seconds(tracker, frames))
                in_python.append(called)
            same = (answers.view(np.int64) == expected.view(np.int64)).all()
            c, run, python = (
                1e6 * statistics.median(each) / (COUNT - 1) for each in (in_c, in_run, in_python)
            )
            bits = "the same" if same else "OTHERS"
            print(f"| {name} | {c:.2f} | {run:.2f} | {python:.2f} | {c / run:.2f} | {bits} |")
        solids(folder)


def solids(folder: Path) -> None:
    """A frame of two solids from C beside `step_into`, at the least of some runs."""
    program = folder / "follow_solids"
    command = ["cc", "-std=c11", "-O2", "-D_POSIX_C_SOURCE=199309L", f"-I{folder}", "-o"]
    command += [str(program), str(solid_following.SOLID_FRAMES), f"-L{folder}", "-lstandoff", "-lm"]
    subprocess.run([*command, "-Wl,-rpath,$ORIGIN"], check=True)
    print("\n| solids | C, us | `step_into`, us |\n|---|---|---|")
    for name, (a, b, poses) in solid_following.cases(COUNT_OF_SOLIDS).items():
        tracker, frames = so.Tracker(a, b), solid_following.carried(poses)
        in_c, in_python = [], []
        for _ in range(REPEATS):
            in_c.append(solid_following.in_c(program, tracker, frames, folder).seconds)
            in_python.append(solid_following.buffer_seconds(tracker, frames))
        c, python = (
            1e6 * statistics.median(each) / (len(frames) - 1) for each in (in_c, in_python)
        )
        print(f"| {name} | {c:.1f} | {python:.1f} |")


if __name__ == "__main__":
    main()
