"""``python -m benchmarks.gpu``: cold rows and tracked frames on a GPU, each answer judged.

Without ``--compile-only`` it needs a GPU and says so where there is none: it times the threads on
rows that are on the GPU already, and with the copies to and from it; every row's bounds and points
are held against the processor's. `mujoco_warp`'s distances of the same ellipsoids stand beside them
where it is installed. With ``--compile-only`` it compiles every kernel, and says what each takes
and the most that a named GPU could do: by arithmetic, not measured.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import standoff as so
from benchmarks.lanes import drawn
from benchmarks.ptx_in_c import compiled_in_c
from standoff.geometry import ellipsoid_octants
from standoff.gpu import cold, compiler, device_arrays, threads, tracks
from standoff.gpu.resources import Resources, compiled, resources_of
from standoff.kernels.state import arrays as K
from standoff.tracking.many_states import TrackerStates
from standoff.tracking.reached import cold_tables
from standoff.tracking.row_pairs import row_pairs
from standoff_studies.kinds import nurbs_ellipsoid

Array = NDArray[np.float64]
AXES = (0.5, 0.8, 0.9), (0.15, 0.3, 0.2)
LENS = (0.4, 0.1)
REACH = (1.3, 4.0)
"""Between the origins, length: the bodies are apart."""
DT, SPEED = 1e-3, 1.0
"""Of tracked frames: s, length/s."""
ROUNDS, LAUNCHES = 5, 10
DIVISION = 10
"""Operations that a division, a reciprocal or a root is taken for: the steps of Newton's method
that ptxas writes for it. An estimate."""
REGISTERS, UNIT = 65536, 256
"""Of a multiprocessor, and how many a warp is given at once."""


class Gpu(NamedTuple):
    """What the arithmetic takes of a GPU, from its maker's data sheet."""

    target: tuple[int, int]
    processors: int  # multiprocessors
    doubles: int  # double operations that each begins in a cycle
    clock: float  # Hz
    memory: float  # bytes/s
    warps: int  # most on a multiprocessor


GPUS = {
    "A100": Gpu((8, 0), 108, 32, 1.41e9, 1.56e12, 64),
    "H200": Gpu((9, 0), 132, 64, 1.98e9, 4.8e12, 64),
    "RTX 4090": Gpu((8, 9), 128, 2, 2.52e9, 1.01e12, 48),
}
# What a row moves to and from the GPU's memory, bytes: a pose, an answer and its mark; what is
# given, read and copied, the state, read and written, the answer and its mark.
MOVED = {
    "cold": 8 * (16 + K.N_OUT + 1),
    "frames": 8 * (2 * threads.N_GIVEN + 2 * K.N_STATE + K.N_OUT + 1),
}


MEASURED = (threads.ELLIPSOIDS, "cold_nurbs_4", "frames_sphere", "frames_nurbs_4")
"""Kernels whose operations are counted, and which are timed on a GPU."""


def bodies_of(kernel: str) -> tuple[so.Body, so.Body]:
    """The pair that a kernel is tried with: ellipsoids, but for cold rows of patches of spheres,
    which are a lens's too."""
    a, b = so.shapes.ellipsoid(*AXES[0]), so.shapes.ellipsoid(*AXES[1])
    if kernel == "cold_sphere":
        return a, so.shapes.lens(*LENS)
    if "nurbs" not in kernel:
        return a, b
    degree = int(kernel[-1])
    if degree == 4:
        return nurbs_ellipsoid(*AXES[0]), nurbs_ellipsoid(*AXES[1])
    a, b = (
        so.Body.from_patches([each.elevated(degree, degree) for each in ellipsoid_octants(*axes)])
        for axes in AXES
    )
    return a, b


def rows_of(kernel: str, n: int) -> Cold | Frames:
    """Rows that a kernel is tried with."""
    return Cold(kernel, n) if kernel.startswith("cold") else Frames(kernel, n)


class Cold:
    """Rows of a cold query, as the processor or a GPU is given them."""

    def __init__(self, kernel: str, n: int) -> None:
        self.a, self.b = bodies_of(kernel)
        self.poses, self.tables = drawn(n, REACH), cold_tables(row_pairs(self.a, self.b))
        self.rows, self.done = np.full((n, K.N_OUT), np.nan), np.zeros(n, dtype=np.int64)

    def arguments(self) -> tuple[Any, ...]:
        """What a thread is given."""
        *pair, options = self.tables.tables[0].arrays
        return tuple(pair), options, np.eye(4)[None], self.poses, self.rows, self.done

    def judged(self) -> dict[str, float]:
        """The rows beside the processor's."""
        mine = so.distances(self.a, self.b, np.eye(4), self.poses)
        return judgement(self.rows[self.done == 1], mine.rows[self.done == 1], self.a, self.b)


class Frames:
    """Tracked rows a frame after their starts."""

    def __init__(self, kernel: str, n: int) -> None:
        self.a, self.b = bodies_of(kernel)
        self.tracker, self.poses = so.Tracker(self.a, self.b, DT), drawn(n, REACH)
        self.states = [self.tracker.start(np.eye(4), pose) for pose in self.poses]
        self.blocks = TrackerStates.of(self.states).blocks.copy()
        self.done = np.zeros(n, dtype=np.int64)
        self.twist = np.array([SPEED, 0.0, 0.0, 0.0, SPEED, 0.0])

    def move(self) -> Array:
        """Move B on by a frame; what the frame is given."""
        self.poses[:, 0, 3] += SPEED * DT
        turn = np.array([[np.cos(DT), 0, np.sin(DT)], [0, 1, 0], [-np.sin(DT), 0, np.cos(DT)]])
        self.poses[:, :3, :3] = turn @ self.poses[:, :3, :3]
        return tracks.given_rows(len(self.poses), (np.eye(4), self.poses), DT, (None, self.twist))

    def arguments(self) -> tuple[Any, ...]:
        """What a thread is given, after B has moved."""
        *pair, options = self.tracker.reached.table.arrays
        return tuple(pair), options, self.move(), self.blocks, self.done

    def judged(self) -> dict[str, float]:
        """The rows beside the processor's."""
        stepped = [
            self.tracker.step(state, np.eye(4), pose, twist_b=self.twist)[0]
            for state, pose in zip(self.states, self.poses, strict=True)
        ]
        self.states = stepped
        mine, made = np.array([state.proximity.row for state in stepped]), self.done == 1
        return judgement(self.blocks[made, : K.N_OUT], mine[made], self.a, self.b)


def judgement(rows: Array, mine: Array, a: so.Body, b: so.Body) -> dict[str, float]:
    """Rows (n, N_OUT) of threads beside the processor's.

    `distance` and `points`: largest difference over the size. `broken`: number of rows whose lower
    bound is above the processor's upper one, or the other way round. `gap`: largest difference of
    bounds over the size.
    """
    size = a.size + b.size
    lower, upper = rows[:, K.LOWER_BOUND], rows[:, K.UPPER_BOUND]
    broken = (lower > mine[:, K.UPPER_BOUND]) | (mine[:, K.LOWER_BOUND] > upper)
    points = slice(K.POINT_A, K.NORMAL)
    return {
        "rows": float(len(rows)),
        "distance": float(np.abs(rows[:, K.DISTANCE] - mine[:, K.DISTANCE]).max() / size),
        "points": float(np.abs(rows[:, points] - mine[:, points]).max() / size),
        "gap": float((upper - lower).max() / size),
        "broken": float(broken.sum()),
    }


def operations(kernel: str, n: int = 200) -> dict[str, float]:
    """Double operations of a row, by kind: counted, by the PTX in C."""
    rows = rows_of(kernel, n)
    run = compiled_in_c(compiled(kernel, (9, 0))[0])
    if isinstance(rows, Frames):
        run(rows.arguments(), n)  # the first frame behind a start corrects more
    return {kind: count / n for kind, count in run(rows.arguments(), n).items()}


def warps(registers: int, gpu: Gpu) -> int:
    """How many warps of a kernel fit a multiprocessor, in blocks of `threads.PER_BLOCK`."""
    each = -(-32 * registers // UNIT) * UNIT
    per_block = threads.PER_BLOCK // 32
    return min(REGISTERS // each, gpu.warps) // per_block * per_block


def bound(counts: dict[str, float], moved: float, gpu: Gpu) -> tuple[float, float]:
    """Most rows a second by arithmetic: (by double operations, by memory)."""
    costly = counts["div"] + counts["rcp"] + counts["sqrt"]
    plain = sum(counts[kind] for kind in ("add", "sub", "mul", "fma"))
    return (
        gpu.processors * gpu.doubles * gpu.clock / (plain + DIVISION * costly),
        gpu.memory / moved,
    )


def compile_all(targets: list[tuple[int, int]]) -> list[dict[str, Any]]:
    """Print what each kernel takes, and the bounds; as rows to be written."""
    print("Compiled without a GPU; the bounds are arithmetic, not measurements.")
    told = []
    for kernel in threads.KERNELS:
        for target in targets:
            found: Resources = resources_of(kernel, target)
            print(
                f"{kernel}, sm_{target[0]}{target[1]}: {found.registers} registers, "
                f"{found.stack} bytes of local memory ({found.spilt} of them spilt), "
                f"{found.shared} shared, {sum(found.doubles.values())} double operations in the "
                f"PTX, {found.calls} calls, {found.seconds:.0f} s"
            )
            told.append(found._asdict())
    for kernel in MEASURED:
        counts = operations(kernel)
        print(f"{kernel}: a row makes", ", ".join(f"{v:.0f} {k}" for k, v in counts.items()))
        registers = resources_of(kernel).registers
        for name, gpu in GPUS.items():
            by_work, by_memory = bound(counts, MOVED[kernel.partition("_")[0]], gpu)
            fit = warps(registers, gpu)
            print(
                f"  {name}: at most {min(by_work, by_memory):.1e} rows a second by arithmetic "
                f"({by_work:.1e} by operations, {by_memory:.1e} by memory); "
                f"{fit} of {gpu.warps} warps"
            )
    return told


def timed(work: Callable[[], None], n: int) -> float:
    """Rows a second, the median of some rounds."""
    work()
    device_arrays.finish()
    taken = []
    for _ in range(ROUNDS):
        begun = time.perf_counter()
        for _ in range(LAUNCHES):
            work()
        device_arrays.finish()
        taken.append((time.perf_counter() - begun) / LAUNCHES)
    return n / median(taken)


def measured_cold(kernel: str, n: int) -> dict[str, float]:
    """Rows a second of cold queries, on the GPU and with the copies, and the judgement."""
    rows = Cold(kernel, n)
    pair, options = device_arrays.pair_and_options(rows.tables.tables[0].arrays)
    rest, there = device_arrays.sent(np.eye(4)[None]), device_arrays.sent(rows.poses)
    outs, done = device_arrays.empty(rows.rows.shape), device_arrays.empty((n,), np.int64)
    arguments = pair, options, rest, there, outs, done
    fast = timed(lambda: threads.start_threads(kernel, n, arguments), n)
    rows.rows[:], rows.done[:] = outs.copy_to_host(), done.copy_to_host()
    given, answers = (np.eye(4)[None], rows.poses), np.empty_like(rows.rows)
    answering = cold.ColdKernel(kernel)
    whole = timed(lambda: answering(rows.tables, given, answers), n)
    return {"rate": fast, "rate with copies": whole, "share": rows.done.mean(), **rows.judged()}


def measured_frames(kernel: str, n: int) -> dict[str, float]:
    """Frames a second, and the judgement of two; the poses are on the GPU."""
    rows = Frames(kernel, n)
    on_gpu = tracks.Tracks(rows.tracker, rows.states)
    found: dict[str, float] = {}
    for _ in range(2):
        given = rows.move()
        on_gpu.start_step(device_arrays.sent(given))
        rows.blocks, rows.done = on_gpu.blocks, on_gpu.done
        found = rows.judged()
    there = [device_arrays.sent(rows.move()) for _ in range(LAUNCHES)]
    turns = iter(range(10**9))
    rate = timed(lambda: on_gpu.start_step(there[next(turns) % LAUNCHES]), n)
    return {"rate": rate, "share": on_gpu.done.mean(), **found}


MUJOCO = """<mujoco><option ccd_iterations="{}"/><worldbody>
<body><freejoint/><geom type="ellipsoid" size="{}" margin="9"/></body>
<body><freejoint/><geom type="ellipsoid" size="{}" margin="9"/></body>
</worldbody></mujoco>"""


ITERATIONS = (35, 500)
"""Of MuJoCo's GJK: as it comes, and until it no longer matters."""


def measured_mujoco(n: int, iterations: int, device: str = "cuda") -> dict[str, float]:
    """`mujoco_warp`'s distances of the ellipsoids of `Cold`, and their error over the size."""
    import mujoco
    import mujoco_warp
    import warp
    from scipy.spatial.transform import Rotation

    rows = Cold(threads.ELLIPSOIDS, n)
    sizes = [" ".join(str(x) for x in axes) for axes in AXES]
    model = mujoco.MjModel.from_xml_string(MUJOCO.format(iterations, *sizes))
    places = np.zeros((n, 14))
    places[:, 3] = 1.0
    places[:, 7:10] = rows.poses[:, :3, 3]
    places[:, 10:] = Rotation.from_matrix(rows.poses[:, :3, :3]).as_quat()[:, [3, 0, 1, 2]]
    with warp.ScopedDevice(device):
        there = mujoco_warp.put_model(model)
        data = mujoco_warp.put_data(model, mujoco.MjData(model), nworld=n, nconmax=4)
        data.qpos.assign(places.astype(np.float32))

        def work() -> None:
            mujoco_warp.kinematics(there, data)
            mujoco_warp.collision(there, data)

        work()
        warp.synchronize()
        begun = time.perf_counter()
        for _ in range(LAUNCHES):
            work()
        warp.synchronize()
        rate = LAUNCHES * n / (time.perf_counter() - begun)
        count = int(data.nacon.numpy()[0])
        world, found = data.contact.worldid.numpy()[:count], data.contact.dist.numpy()[:count]
    truth = so.distances(rows.a, rows.b, np.eye(4), rows.poses).distance[world]
    size = rows.a.size + rows.b.size
    return {
        "rate": rate,
        "rows": float(count),
        "distance": float(np.abs(found - truth).max() / size),
    }


def measure(n: int) -> dict[str, dict[str, float]]:
    """Print and return what a GPU does."""
    compiler.check_there()
    found = {}
    for kernel in MEASURED:
        cold_rows = kernel.startswith("cold")
        found[kernel] = (
            measured_cold(kernel, n) if cold_rows else measured_frames(kernel, min(n, 100_000))
        )
    try:
        if compiler.SIMULATED:
            raise ModuleNotFoundError("Python has the GPU's place")
        for iterations in ITERATIONS:
            found[f"mujoco_warp, {iterations} iterations"] = measured_mujoco(n, iterations)
    except ModuleNotFoundError as missing:
        print(f"mujoco_warp is left out: {missing}")
    for name, row in found.items():
        print(f"{name}:", ", ".join(f"{key} {value:.3g}" for key, value in row.items()))
    return found


def main(arguments: list[str] | None = None) -> int:
    """Run; 0 where all bounds hold, 1 where one is broken, 2 without a GPU."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.gpu", description=__doc__)
    parser.add_argument("--compile-only", action="store_true", help="needs no GPU")
    parser.add_argument("--targets", nargs="+", default=["8.0", "9.0"], help="compute capabilities")
    parser.add_argument("--rows", type=int, default=1_000_000)
    parser.add_argument("-o", "--output", type=Path, help="a JSON file")
    given = parser.parse_args(arguments)
    if given.compile_only:
        targets = [tuple(int(x) for x in each.split(".")) for each in given.targets]
        told: Any = compile_all(targets)  # type: ignore[arg-type]
    else:
        try:
            told = measure(given.rows)
        except so.StandoffError as error:
            print(error, file=sys.stderr)
            return 2
    if given.output:
        given.output.write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")
    broken = not given.compile_only and any(row.get("broken", 0.0) for row in told.values())
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
