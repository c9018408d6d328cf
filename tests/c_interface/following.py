"""Pairs and motions, followed by Python and by a C program."""

from __future__ import annotations

import subprocess
import time
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.c_interface import save_pair
from standoff.kernels.pair import events as N
from standoff.kernels.state import arrays as K

FRAMES = Path(__file__).with_name("frames.c")
N_FRAME, N_ANSWER = 38, 32
DT = 1e-3


class Case(NamedTuple):
    a: so.Body
    b: so.Body
    law: Any = so.PredictorCorrector()
    reach: float = 2.6  # between the bodies' origins
    swing: float = 0.0  # how far they come closer
    twists: bool = True


LENS, BOX = so.shapes.lens(1.0, 0.4), so.shapes.box(1.0, 0.8, 0.6)
ELLIPSOID = so.shapes.ellipsoid(1.0, 0.7, 0.5)
CASES = {
    "ellipsoids on their faces": Case(ELLIPSOID, so.shapes.ellipsoid(0.6, 0.8, 0.4)),
    "box and lens, switching": Case(BOX, LENS, reach=2.0),
    "without twists": Case(BOX, so.shapes.capsule(0.3, 1.0), twists=False),
    "polytope on its faces": Case(so.shapes.box(1.0, 1.0, 1.0), ELLIPSOID),
    "in and out of contact": Case(BOX, ELLIPSOID, reach=1.5, swing=0.8),
    "the paper's law": Case(LENS, ELLIPSOID, so.PaperLaw(gain=200.0)),
    "against a half-space": Case(so.shapes.halfspace(), BOX, reach=1.2),
    "one minimum": Case(BOX, BOX, so.PredictorCorrector(restarts=False), reach=1.0, swing=0.8),
    "a horizon": Case(BOX, ELLIPSOID, so.PredictorCorrector(within=0.5), reach=1.9, swing=0.9),
    "no depth is certified": Case(
        so.shapes.sphere(0.5),
        so.shapes.sphere(0.5),
        so.PredictorCorrector(tolerance=1e-16),
        reach=1.2,
        swing=0.8,
    ),
}


def motion(case: Case, count: int) -> np.ndarray:
    """Frames as frames.c reads them: A turns slowly, B passes and tumbles."""
    t = DT * np.arange(count)
    frames = np.zeros((count, N_FRAME))
    turns_a = Rotation.from_rotvec(np.outer(t, [0.1, 0.3, -0.2]))
    turns_b = Rotation.from_rotvec(np.outer(t, [1.9, -2.3, 1.1]))
    frames[:, :9] = turns_a.as_matrix().reshape(count, 9)
    frames[:, 12:21] = turns_b.as_matrix().reshape(count, 9)
    frames[:, 21] = 0.4 * np.sin(2.0 * t)
    frames[:, 22] = 0.3 * np.cos(3.0 * t)
    frames[:, 23] = case.reach - case.swing * np.sin(1.5 * t) ** 2
    frames[:, 27:30], frames[:, 33:36] = [0.1, 0.3, -0.2], [1.9, -2.3, 1.1]
    frames[:, 30] = 0.8 * np.cos(2.0 * t)
    frames[:, 31] = -0.9 * np.sin(3.0 * t)
    frames[:, 32] = -1.5 * case.swing * np.sin(3.0 * t)
    frames[:, 36], frames[:, 37] = float(case.twists), DT
    return frames


def in_python(tracker: so.Tracker, frames: np.ndarray) -> tuple[np.ndarray, float]:
    """What frames.c writes, and the seconds of the steps."""
    answers, spent, buffer = np.empty((len(frames), N_ANSWER)), 0.0, None
    for k, frame in enumerate(frames):
        poses = [np.eye(4), np.eye(4)]
        for pose, flat in zip(poses, (frame[:12], frame[12:24]), strict=True):
            pose[:3, :3], pose[:3, 3] = flat[:9].reshape(3, 3), flat[9:]
        twists = (frame[24:30], frame[30:36]) if frame[36] else (None, None)
        if buffer is None:
            state = tracker.start(*poses, *twists)
            buffer, out = tracker.buffer(state), state.proximity._out[: K.N_OUT]
        else:
            began = time.perf_counter()
            tracker.step_into(buffer, *poses, *twists, frame[37])
            spent += time.perf_counter() - began
            out = buffer.out
        answers[k] = as_in_c(tracker, out)
    return answers, spent


def as_in_c(tracker: so.Tracker, out: np.ndarray) -> list[float]:
    features = []
    for body, number in ((tracker.a, out[K.OUT_MODE]), (tracker.b, out[K.OUT_MODE + 2])):
        counts, number = [body.n_faces, body.n_edges, body.n_vertices], int(number)
        for kind, count in enumerate(counts):
            if number < count:
                features += [kind, number]
                break
            number -= count
    counts = out[K.OUT_COUNTS :]
    return [
        *(out[K.DISTANCE], out[K.LOWER_BOUND], out[K.UPPER_BOUND]),
        *out[K.POINT_A : K.POINT_A + 3],
        *out[K.POINT_B : K.POINT_B + 3],
        *out[K.NORMAL : K.NORMAL + 3],
        *out[K.VELOCITY_A : K.VELOCITY_A + 3],
        *out[K.VELOCITY_B : K.VELOCITY_B + 3],
        *out[K.OUT_Q : K.OUT_Q + 4],
        out[K.RESIDUAL],
        *(0, *features, out[K.STATUS]),
        *(counts[N.EVALUATIONS], counts[N.EVENTS], counts[N.GENERAL_FRAMES]),
    ]


def in_c(
    program: Path, tracker: so.Tracker, frames: np.ndarray, folder: Path
) -> tuple[np.ndarray, float]:
    pair, given, told = folder / "pair", folder / "frames", folder / "answers"
    save_pair(pair, tracker)
    given.write_bytes(frames.tobytes())
    done = subprocess.run(
        [program, pair, given, told], capture_output=True, text=True, check=True, env={}
    )
    return np.frombuffer(told.read_bytes()).reshape(-1, N_ANSWER), float(done.stdout)
