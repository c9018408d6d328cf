"""The work that `benchmarks.regression` times on each commit: a script, run with that commit's src.

Prints JSON: rows of a name, a time in the unit that the name ends with, and the answer in full.
With a text as argument only the pairs and pieces whose names hold it are worked on.
"""

from __future__ import annotations

import gc
import json
import resource
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

begun = resource.getrusage(resource.RUSAGE_SELF)

import standoff as so  # noqa: E402 - what is imported and compiled is timed too

DT = 1e-3
"""Frame time, s."""
TURN, SHIFT = 2e-3, 1e-3
"""Motion of B between two frames, rad and size: what a 1 kHz loop moves by at most."""
FRAMES = 1500
REPEATS = 5
"""The least of so many is the time: what disturbs a run only adds to it."""
Rows = list[tuple[str, float, str]]


def pairs() -> dict[str, tuple[so.Body, so.Body, float]]:
    """Bodies, and how far apart their centres are."""
    tool = so.shapes.ellipsoid(0.15, 0.30, 0.20)
    ball = so.shapes.ellipsoid(0.52, 1.04, 0.89)
    egg = so.shapes.superellipsoid(0.5, 0.7, 0.9, 0.6, 1.3)
    return {
        "ellipsoids": (ball, tool, 1.7),
        "lens, ellipsoid": (so.shapes.lens(1.0, 0.45), tool, 1.6),
        "box, ellipsoid": (so.shapes.box(1.0, 0.7, 0.5), tool, 1.3),
        "boxes": (so.shapes.box(1.0, 0.7, 0.5), so.shapes.box(0.3, 0.4, 0.5), 1.4),
        "superellipsoid, capsule": (egg, so.shapes.capsule(0.2, 0.5), 1.6),
        "ellipsoids in contact": (ball, tool, 0.5),
        "boxes in contact": (so.shapes.box(1.0, 0.7, 0.5), so.shapes.box(0.3, 0.4, 0.5), 0.5),
    }


def motion(far: float, frames: int) -> tuple[np.ndarray, np.ndarray]:
    """B's poses (n, 4, 4) and twists (n, 6): round A, turning and rocking."""
    k = np.arange(frames)
    angle = TURN * k
    poses = np.tile(np.eye(4), (frames, 1, 1))
    poses[:, 0, 0] = poses[:, 1, 1] = np.cos(angle)
    poses[:, 1, 0], poses[:, 0, 1] = np.sin(angle), -np.sin(angle)
    poses[:, 0, 3], poses[:, 1, 3] = far * np.cos(angle), far * np.sin(angle)
    poses[:, 2, 3] = 0.05 * np.sin(SHIFT * k)
    rate = TURN / DT
    twists = np.zeros((frames, 6))
    twists[:, 0], twists[:, 1] = -rate * poses[:, 1, 3], rate * poses[:, 0, 3]
    twists[:, 2] = 0.05 * SHIFT / DT * np.cos(SHIFT * k)
    twists[:, 5] = rate
    return poses, twists


def least(work: Callable[[], Any], count: int) -> float:
    """Time of one of `count`, s."""
    work()
    found = []
    gc.disable()
    for _ in range(REPEATS):
        start = time.perf_counter()
        work()
        found.append((time.perf_counter() - start) / count)
    gc.enable()
    return min(found)


def frames_of_a_run(tracker: so.Tracker, poses: np.ndarray, twists: np.ndarray) -> Rows:
    """The compiled frames of a run: by the public call alone, which every commit has."""
    rest, still = np.eye(4), np.zeros(6)
    begin = tracker.start(rest, poses[0], still, twists[0])
    told = []

    def run() -> None:
        _, answers = tracker.run(begin, rest, poses[1:], still, twists[1:])
        told.append(answers.distance.sum())

    time_of_one = least(run, len(poses) - 1)
    return [("a frame of Tracker.run, ns", 1e9 * time_of_one, repr(told[-1]))]


def python_steps(tracker: so.Tracker, poses: np.ndarray, twists: np.ndarray) -> Rows:
    rest, still = np.eye(4), np.zeros(6)
    begin = tracker.start(rest, poses[0], still, twists[0])
    told = []

    def run() -> None:
        state = begin
        for pose, twist in zip(poses[1:], twists[1:], strict=True):
            state, answer = tracker.step(state, rest, pose, still, twist)
        told.append(answer.distance)

    return [("Tracker.step, us", 1e6 * least(run, len(poses) - 1), repr(told[-1]))]


def cold_queries(a: so.Body, b: so.Body, poses: np.ndarray) -> Rows:
    rest = np.eye(4)
    chosen = poses[:: len(poses) // 40]
    told = []

    def run() -> None:
        told.append(sum(so.distance(a, b, rest, pose).distance for pose in chosen))

    return [("so.distance, us", 1e6 * least(run, len(chosen)), repr(told[-1]))]


def steps_without_twists(tracker: so.Tracker, poses: np.ndarray) -> Rows:
    """As users of other packages call it: poses alone."""
    rest = np.eye(4)
    begin = tracker.start(rest, poses[0])
    given = [np.array(pose) for pose in poses[1:]]
    told, told_in_place = [], []

    def step() -> None:
        state = begin
        for pose in given:
            state, answer = tracker.step(state, rest, pose)
        told.append(answer.distance)

    def step_into() -> None:
        buffer = tracker.buffer(begin)
        for pose in given:
            distance = tracker.step_into(buffer, rest, pose)
        told_in_place.append(distance)

    return [
        ("Tracker.step without twists, us", 1e6 * least(step, len(given)), repr(told[-1])),
        (
            "Tracker.step_into without twists, us",
            1e6 * least(step_into, len(given)),
            repr(told_in_place[-1]),
        ),
    ]


def first_trackers(a: so.Body, b: so.Body, poses: np.ndarray) -> Rows:
    """A tracker of bodies seen before, and its start."""
    rest = np.eye(4)
    chosen = poses[:: len(poses) // 40]
    told = []

    def run() -> None:
        started = [so.Tracker(a, b, DT).start(rest, pose) for pose in chosen]
        told.append(sum(state.proximity.distance for state in started))

    return [("so.Tracker and start, us", 1e6 * least(run, len(chosen)), repr(told[-1]))]


EDGE_SPAN = 0.15
"""How far from the middle of the box's edge, 0.7 long, the ellipsoid goes."""


def along_an_edge(frames: int) -> tuple[so.Body, so.Body, np.ndarray]:
    """(box, ellipsoid, poses (n, 4, 4) of the ellipsoid): it turns and goes to and fro along an
    edge of the box, which is nearest to it in every frame."""
    box, tool = so.shapes.box(1.0, 0.7, 0.5), so.shapes.ellipsoid(0.15, 0.30, 0.20)
    k = np.arange(frames)
    poses = np.tile(np.eye(4), (frames, 1, 1))
    angle = TURN * k
    poses[:, 0, 0] = poses[:, 1, 1] = np.cos(angle)
    poses[:, 1, 0], poses[:, 0, 1] = np.sin(angle), -np.sin(angle)
    poses[:, 0, 3], poses[:, 2, 3] = 0.5 + 0.4, 0.25 + 0.4
    poses[:, 1, 3] = EDGE_SPAN * np.sin(SHIFT / EDGE_SPAN * k)
    return box, tool, poses


def on_edges() -> Rows:
    """Frames of a run without twists; the answer tells how many were on an edge."""
    box, tool, poses = along_an_edge(FRAMES)
    tracker = so.Tracker(box, tool, DT)
    rest = np.eye(4)
    begin = tracker.start(rest, poses[0])
    told = []

    def run() -> None:
        _, answers = tracker.run(begin, rest, poses[1:])
        told.append(answers.distance.sum())

    return [("a frame of Tracker.run, us", 1e6 * least(run, FRAMES - 1), repr(told[-1]))]


TICK = 2e-5
"""Of the simulation, s."""
TICKS = 4000
"""After SETTLING ones, in which the bodies fall and roll."""
SETTLING = 30_000


def five_bodies() -> Any:
    """An operator of five bodies of different kinds over a plane, beside each other."""
    sim = so.simulation
    law = sim.HuntCrossley(stiffness=3e6, damping=0.05, friction=0.4, slip_speed=0.02, depth=5e-3)
    solids = (
        so.shapes.sphere(0.1),
        so.shapes.ellipsoid(0.1, 0.12, 0.15),
        so.shapes.box(0.2, 0.3, 0.1),
        so.shapes.cylinder(0.1, 0.3),
        so.shapes.superellipsoid([0.2, 0.15, 0.1], [0.5, 0.5]),
    )
    turn = so.Pose.exp([0.7, -0.4, 0.3]).rotation
    bodies = [sim.RigidBody.fixed(so.shapes.halfspace())]
    bodies += [
        sim.RigidBody.free(solid, density=800.0, pose=so.Pose(turn, [0.6 * k, 0.0, 0.25]))
        for k, solid in enumerate(solids)
    ]
    return sim.Operator(sim.System(bodies, law), TICK)


def ticks() -> Rows:
    operator = five_bodies()
    begin = operator.run(operator.start(), SETTLING, every=SETTLING).final
    told = []

    def run() -> None:
        found = operator.run(begin, TICKS, every=TICKS)
        told.append(found.energy.kinetic[-1])

    return [("a tick of Operator.run, us", 1e6 * least(run, TICKS), repr(told[-1]))]


PIECES = {"box, ellipsoid on an edge": on_edges, "five bodies on a plane": ticks}
"""Work on bodies of their own."""


def gradients(tracker: so.Tracker, poses: np.ndarray) -> Rows:
    """Of the answers of a motion, each asked once."""
    rest = np.eye(4)
    begin = tracker.start(rest, poses[0])
    told, found = [], []
    for _ in range(REPEATS):
        state, answers = begin, []
        for pose in poses[1:]:
            state, answer = tracker.step(state, rest, pose)
            answers.append(answer)
        start = time.perf_counter()
        total = sum(answer.gradient.sum() for answer in answers)
        found.append((time.perf_counter() - start) / len(answers))
        told.append(total)
    return [("Proximity.gradient, us", 1e6 * min(found), repr(float(told[-1])))]


def processor_time() -> float:
    """Of this process since it began to import, s."""
    now = resource.getrusage(resource.RUSAGE_SELF)
    return now.ru_utime + now.ru_stime - begun.ru_utime - begun.ru_stime


def worked(a: so.Body, b: so.Body, far: float, frames: int) -> tuple[Rows, float]:
    """All pieces of work on a pair, and the processor time until its tracker was ready, s."""
    poses, twists = motion(far, frames)
    tracker = so.Tracker(a, b, DT)
    spent = processor_time()
    found = frames_of_a_run(tracker, poses, twists)
    found += python_steps(tracker, poses, twists) + steps_without_twists(tracker, poses)
    found += cold_queries(a, b, poses) + first_trackers(a, b, poses)
    return found + (gradients(tracker, poses) if frames < FRAMES else []), spent


def main() -> None:
    asked = sys.argv[1] if len(sys.argv) > 1 else ""
    rows: Rows = []
    compiling = []
    for name, (a, b, far) in pairs().items():
        if asked not in name:
            continue
        found, spent = worked(a, b, far, FRAMES // 10 if "contact" in name else FRAMES)
        compiling.append(spent)
        rows += [(f"{name}: {what}", taken, answer) for what, taken, answer in found]
    for name, piece in PIECES.items():
        if asked in name:
            rows += [(f"{name}: {what}", taken, answer) for what, taken, answer in piece()]
    if compiling:
        rows.append(("compile, s of processor", compiling[0], ""))
    print(json.dumps(rows))


if __name__ == "__main__":
    main()
