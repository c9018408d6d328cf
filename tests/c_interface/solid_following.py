"""Two solids and their motion, followed by Python and by a C program."""

from __future__ import annotations

import subprocess
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np

import standoff as so
from families.solid_shapes import bolt, tube
from standoff.c_interface import save_pair
from standoff.solids import SolidProximity, SolidTracker

SOLID_FRAMES = Path(__file__).with_name("solid_frames.c")
N_FRAME, N_TOLD = 25, 4
N_ANSWER = 30 + 4 * N_TOLD
STEP, START, KEPT_STEP, RETURNED, TOO_LITTLE = range(5)
DISTANCE, LOWER, UPPER = 0, 1, 2
POINT_A, POINT_B, NORMAL, PARAMETERS = slice(3, 6), slice(6, 9), slice(9, 12), slice(12, 16)
FEATURES = slice(16, 20)
STATUS, CERTIFIED, INSIDE, SINGLE, N_MINIMA, COMPLETE, EVALUATIONS, RESTARTS = range(20, 28)
CODE, MINIMA = 29, 30


class Told(NamedTuple):
    """What the C program has written, and the seconds of its steps."""

    rows: np.ndarray
    seconds: float

    def minima(self, k: int) -> np.ndarray:
        """(distance, lower bound, key, felt) of a frame's local minima, rows."""
        count = min(int(self.rows[k, N_MINIMA]), N_TOLD)
        found: np.ndarray = self.rows[k, MINIMA:].reshape(-1, 4)[:count]
        return found


def frames_of(a: list[np.ndarray], b: list[np.ndarray]) -> np.ndarray:
    """Frames as solid_frames.c reads them, of poses (4, 4) of A and B; the first one starts."""
    frames = np.zeros((len(b), N_FRAME))
    for k, poses in enumerate(zip(a, b, strict=True)):
        for o, pose in zip((0, 12), poses, strict=True):
            frames[k, o : o + 9], frames[k, o + 9 : o + 12] = pose[:3, :3].ravel(), pose[:3, 3]
    frames[0, 24] = START
    return frames


def in_c(program: Path, tracker: SolidTracker, frames: np.ndarray, folder: Path) -> Told:
    pair, given, told = folder / "pair", folder / "frames", folder / "answers"
    save_pair(pair, tracker)
    given.write_bytes(frames.tobytes())
    done = subprocess.run(
        [program, pair, given, told], capture_output=True, text=True, check=True, env={}
    )
    return Told(np.frombuffer(told.read_bytes()).reshape(-1, N_ANSWER), float(done.stdout))


def in_python(tracker: SolidTracker, frames: np.ndarray) -> list[SolidProximity]:
    poses = [matrices(frames[:, o : o + 12]) for o in (0, 12)]
    state = tracker.start(poses[0][0], poses[1][0])
    answers = [state.proximity]
    for a, b in zip(poses[0][1:], poses[1][1:], strict=True):
        state, answer = tracker.step(state, a, b)
        answers.append(answer)
    return answers


def buffer_seconds(tracker: SolidTracker, frames: np.ndarray) -> float:
    """Of all frames but the first, in place."""
    poses = [matrices(frames[:, o : o + 12]) for o in (0, 12)]
    buffer = tracker.buffer(tracker.start(poses[0][0], poses[1][0]))
    began = time.perf_counter()
    for a, b in zip(poses[0][1:], poses[1][1:], strict=True):
        tracker.step_into(buffer, a, b)
    return time.perf_counter() - began


def matrices(flat: np.ndarray) -> np.ndarray:
    poses = np.tile(np.eye(4), (len(flat), 1, 1))
    poses[:, :3, :3], poses[:, :3, 3] = flat[:, :9].reshape(-1, 3, 3), flat[:, 9:12]
    return poses


def carried(moved: list[np.ndarray]) -> np.ndarray:
    """Frames with A at a pose that turns slowly, B at poses in its frame."""
    a = [
        so.Pose.exp((0.1 + 1e-3 * k, -0.2, 0.3), (1.0, 2.0, -0.5)).matrix for k in range(len(moved))
    ]
    return frames_of(a, [at @ pose for at, pose in zip(a, moved, strict=True)])


def cases(count: int) -> dict[str, tuple[so.Solid, so.Solid, list[np.ndarray]]]:
    """Pairs for the benchmark, with B's poses in A's frame."""
    lid, pad = so.Solid(so.shapes.box((4, 4, 1))), so.Solid(so.shapes.box((1, 1, 1)))
    tilt, t = (0.02, 0.03, 0.0), np.linspace(0.0, 1.0, count)
    past = [so.Pose.exp((x, 2.0 * x, 0.3), (4.0 + x, 0.5, -0.2)).matrix for x in t]
    down = [so.Pose.exp(tilt, (0.1, 0.2, 0.99 - 0.02 * x)).matrix for x in t]
    return {
        "bolt and tube, apart": (bolt(), tube(1.2, 2.0, 0.0, 1.0), past),
        "two boxes in overlap": (lid, pad, down),
    }
