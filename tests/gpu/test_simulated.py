"""The GPU's part in Python: threads in numba-cuda's simulator, over kernels that are not compiled.

Each row must be that of the processor's own functions, to the last bit where these are the same;
and what is refused, and what is said without a GPU.
"""

import os
import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
there = pytest.mark.skipif(
    find_spec("numba_cuda") is None, reason="numba-cuda is not installed: make gpu"
)
SIMULATED = {"NUMBA_ENABLE_CUDASIM": "1", "NUMBA_DISABLE_JIT": "1"}

BODIES = """
import numpy as np
import standoff as so
from scipy.spatial.transform import Rotation
a, b = so.shapes.ellipsoid(0.5, 0.8, 0.9), so.shapes.ellipsoid(0.15, 0.3, 0.2)
rest, poses = np.eye(4), np.tile(np.eye(4), (5, 1, 1))
poses[:, :3, :3] = Rotation.random(5, random_state=1).as_matrix()
poses[:, :3, 3] = [[2, 0, 0], [0, 1.5, 0.4], [-1, 1, 1], [0, 0, -2], [1, -1, 1]]
"""
COLD = """
from standoff import gpu
poses[1, :3, 3] = 0.2
poses[3, 0, 3] = np.nan
found, mine = gpu.distances(a, b, rest, poses), so.distances(a, b, rest, poses)
assert (found.rows.view(np.int64) == mine.rows.view(np.int64)).all()
assert list(found.errors) == [3] and found.distance[1] < 0.0 and found.certified[[0, 2, 4]].all()
assert found.by_threads == 3
"""
SMOOTH = """
from standoff import gpu
from standoff_studies.kinds import nurbs_ellipsoid
a, b = nurbs_ellipsoid(0.5, 0.8, 0.9), nurbs_ellipsoid(0.15, 0.3, 0.2)
poses[1, :3, 3] = 0.2
found, mine = gpu.distances(a, b, rest, poses), so.distances(a, b, rest, poses)
assert found.by_threads == 4 and found.distance[1] < 0.0 and found.certified[[0, 2, 3, 4]].all()
assert (found.status == mine.status).all()
assert (found.rows[1].view(np.int64) == mine.rows[1].view(np.int64)).all()
for name in ("distance", "point_a", "point_b", "normal", "lower_bound", "upper_bound"):
    there, here = getattr(found, name), getattr(mine, name)
    np.testing.assert_allclose(there, here, rtol=0.0, atol=1e-12 * (a.size + b.size))
lens = so.shapes.lens(0.4, 0.1, rounding=0.05)
found, mine = gpu.distances(a, a, rest, poses[:1]), gpu.distances(lens, lens, rest, poses[:1])
assert found.by_threads == 1 and mine.bodies == (lens, lens)
"""
FRAMES = """
from standoff import gpu
from standoff.kernels.state import arrays as K
tracker = so.Tracker(a, b, 1e-3)
states = [tracker.start(rest, pose) for pose in poses]
rows = gpu.Tracks(tracker, states)
twist = np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
for frame in range(4):
    poses[:, 0, 3] += 1e-3
    if frame >= 2:
        poses[1, :3, 3] = 0.2 - 0.01 * frame  # into each other: no thread makes that
    found = rows.step(rest, poses, twists_b=twist)
    states = [tracker.step(s, rest, p, twist_b=twist)[0] for s, p in zip(states, poses)]
    mine = np.array([state.proximity.row for state in states])
    assert rows.by_threads == (4 if frame >= 2 else 5)
    # this tracker's frames are the general ones: the smooth ones are called by address
    for part in (slice(0, K.OUT_MODE), slice(K.OUT_Q, K.UPPER_BOUND + 1)):
        np.testing.assert_allclose(found[:, part], mine[:, part], rtol=1e-9, atol=1e-12)
    own = rows.blocks[:, K.BLOCK_STATE : K.BLOCK_MOTION]
    theirs = np.array([state.data for state in states])
    np.testing.assert_allclose(own, theirs, rtol=1e-6, atol=1e-9)
assert found[1, 0] < 0.0
before = rows.states  # a value, from which others go on
assert before[1].proximity.row[0] == states[1].proximity.row[0] == found[1, 0]
assert len(before[1].proximity._out) > K.N_BLOCK  # with what it has kept of its proof
more = gpu.Tracks(tracker, before)
assert np.array_equal(more.step(rest, poses), rows.step(rest, poses), equal_nan=True)
mine, _ = tracker.step(before[1], rest, poses[1])
assert mine.proximity.row[0] == more.states[1].proximity.row[0]
"""
REFUSED = """
from standoff import gpu
def said(call, *arguments, **named):
    try:
        call(*arguments, **named)
    except ValueError as error:
        print(error)
said(gpu.distances, a, so.shapes.box(1, 1, 1), rest, poses)
said(gpu.Tracks, so.Tracker(a, so.shapes.box(1, 1, 1), 1e-3), [])
said(gpu.Tracks, so.Tracker(a, b, 1e-3, so.PredictorCorrector(within=1.0)), [])
tracker = so.Tracker(a, b, 1e-3)
said(gpu.Tracks, tracker, [])
rows = gpu.Tracks(tracker, [tracker.start(rest, pose) for pose in poses[:2]])
before = rows.blocks
said(rows.step, rest, poses)
said(rows.step, rest, 2.0 * poses[:2])
said(rows.step, rest, poses[:2], twists_b=np.ones((3, 6)))
said(rows.step, rest, poses[:2], twists_b=np.full(6, np.inf))
said(rows.step, rest, poses[:2], dt=-1.0)
assert np.array_equal(rows.blocks, before, equal_nan=True)
"""


def run(code: str, **environment: str) -> subprocess.CompletedProcess[str]:
    paths = os.pathsep.join(str(ROOT / each) for each in ("src", "studies/src", "."))
    return subprocess.run(
        [sys.executable, "-c", code],
        env=os.environ | {"PYTHONPATH": paths, "STANDOFF_QUIET": "1"} | environment,
        capture_output=True, text=True,
    )  # fmt: skip


@there
@pytest.mark.parametrize("code", [COLD, SMOOTH, FRAMES], ids=["cold", "smooth", "frames"])
def test_threads_in_the_simulator(code):
    done = run(BODIES + code, **SIMULATED)
    assert done.returncode == 0, done.stderr


@there
def test_what_is_refused():
    done = run(BODIES + REFUSED, **SIMULATED)
    assert done.returncode == 0, done.stderr
    told = done.stdout.splitlines()
    expected = [
        "cold rows of two bodies", "frames of two bodies of patches", "without a horizon",
        "states is empty", "poses_b has 5 poses: give 2", r"poses_b\[0\] is not a pose",
        r"twists_b has the shape \(3, 6\): give \(2, 6\)", "twists_b holds numbers", "dt = -1.0",
    ]  # fmt: skip
    assert len(told) == len(expected)
    for line, words in zip(told, expected, strict=True):
        assert re.search(words, line), line


@there
def test_the_page_and_the_benchmark_in_the_simulator():
    page = (ROOT / "docs" / "gpu.md").read_text("utf-8")
    blocks = re.findall(r"^```\{code-block\} python\n:class: gpu\n(.*?)^```$", page, re.S | re.M)
    done = run("\n".join(blocks), **SIMULATED)
    assert blocks
    assert done.returncode == 0, done.stderr
    done = run(
        "import sys\nfrom benchmarks import gpu\nsys.exit(gpu.main(['--rows', '2']))", **SIMULATED
    )
    assert done.returncode == 0, done.stderr
    assert "cold_ellipsoids: rate" in done.stdout
    assert "frames_nurbs_4: rate" in done.stdout


@there
def test_without_a_gpu_it_says_so():
    code = BODIES + "from standoff import gpu\ngpu.distances(a, b, rest, poses)"
    done = run(code, CUDA_VISIBLE_DEVICES="")
    assert done.returncode == 1
    assert "StandoffError: standoff.gpu: no NVIDIA GPU with a driver was found" in done.stderr


def test_without_numba_cuda_it_names_the_extra():
    code = (
        "import importlib.util as util\nfound = util.find_spec\n"
        "util.find_spec = lambda name, *of: None if name == 'numba_cuda' else found(name, *of)\n"
        "from standoff import gpu"
    )
    done = run(code)
    assert done.returncode == 1
    assert "install the extra 'gpu': pip install 'standoff[gpu]'" in done.stderr
