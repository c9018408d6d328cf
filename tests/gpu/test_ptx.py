"""What is compiled for a GPU, without one: what each kernel takes, and its PTX, written in C and
run here, beside the processor's answers and gaps that are exact by construction."""

import re
import shutil
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.kernels.state import arrays as K
from standoff.tracking.reached import cold_table

if find_spec("numba_cuda") is None:
    pytest.skip("numba-cuda is not installed: make gpu", allow_module_level=True)

from benchmarks import gpu as benchmark
from benchmarks.ptx_in_c import compiled_in_c, written_in_c

from standoff.gpu.resources import DOUBLE, compiled, resources_of
from standoff.gpu.threads import ELLIPSOIDS, KERNELS

TARGET = (9, 0)
# Most bytes of local memory and double operations in the PTX: a tenth more than there are.
MOST = {
    ELLIPSOIDS: (0, 1_620),
    "cold_sphere": (220, 1_510),
    "cold_nurbs_2": (230, 2_180),
    "cold_nurbs_3": (250, 2_470),
    "cold_nurbs_4": (265, 2_820),
    "cold_nurbs_5": (295, 3_240),
    "frames_sphere": (310, 1_440),
    "frames_nurbs_2": (345, 2_120),
    "frames_nurbs_3": (400, 2_410),
    "frames_nurbs_4": (450, 2_760),
    "frames_nurbs_5": (530, 3_170),
}
AXES_A, AXES_B = map(np.array, benchmark.AXES)
needs_c = pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")


def test_every_kernel_has_its_limits():
    assert MOST.keys() == KERNELS.keys()


@pytest.mark.parametrize("kernel", KERNELS)
def test_what_a_kernel_takes(kernel):
    found, (stack, doubles) = resources_of(kernel, TARGET), MOST[kernel]
    assert 0 < found.registers <= 255
    assert found.stack <= stack
    assert found.calls == found.shared == 0
    assert 1_000 < sum(found.doubles.values()) <= doubles


def names_in(ptx):
    """The functions that a kernel was compiled from, behind the names of their modules."""
    listed = re.findall(r"\.common \.global \.align 8 \.u64 _ZN08NumbaEnv(\w+)", ptx)
    found = set()
    for mangled in listed:
        parts = []
        while part := re.match(r"(\d+)", mangled):
            end = len(part[1]) + int(part[1])
            parts.append(mangled[len(part[1]) : end])
            mangled = mangled[end:]
        found.add(".".join(parts[-2:]))
    return found


@pytest.mark.parametrize("kernel", KERNELS)
def test_no_kernel_relies_on_a_product_rounded_by_itself(kernel):
    """A GPU's compiler fuses products and sums in all of them, `uncontracted` or not."""
    apart = {
        f"{file.stem}.{name}"
        for file in (Path(so.__file__).parent / "kernels").rglob("*.py")
        for name in re.findall(r"^@uncontracted\ndef (\w+)", file.read_text("utf-8"), re.MULTILINE)
    }
    inside = {name for name in apart if name.endswith(".well_inside")}  # which only compares
    assert inside
    assert any(name.endswith(".line_roots") for name in apart)
    found = names_in(compiled(kernel, TARGET)[0])
    assert {"certify_cones", "hessian"} <= {name.split(".")[-1] for name in found}
    assert found & apart <= inside


def test_operations_are_counted():
    ptx = (
        "\tadd.rn.f64 \t%fd1, %fd2, %fd3;\n@%p1 sqrt.rn.f64 %fd1, %fd2;\n\tadd.s64 %rd1, %rd2, 1;\n"
    )
    assert DOUBLE.findall(ptx) == ["add", "sqrt"]


def test_an_unknown_kernel_is_refused():
    with pytest.raises(so.StandoffError, match="give one of cold_ellipsoids, cold_sphere"):
        resources_of("warm", TARGET)


@lru_cache(maxsize=8)
def in_c(kernel, contract=False):
    """A kernel's PTX in C."""
    return compiled_in_c(compiled(kernel, TARGET)[0], contract=contract)


def exact_rows(n, rng, least=-4.0):
    """Poses (n, 4, 4) of the second ellipsoid whose gaps (n,), from 10^least, and normals are
    known."""
    normal, gaps = rng.normal(size=(n, 3)), 10.0 ** rng.uniform(least, 1.0, size=n)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    poses = np.tile(np.eye(4), (n, 1, 1))
    poses[:, :3, :3] = R = Rotation.random(n, random_state=rng).as_matrix()
    x = normal * AXES_A**2 / np.linalg.norm(normal * AXES_A, axis=1, keepdims=True)
    own = np.einsum("kji,kj->ki", R, -normal)
    arm = own * AXES_B**2 / np.linalg.norm(own * AXES_B, axis=1, keepdims=True)
    poses[:, :3, 3] = x + gaps[:, None] * normal - np.einsum("kij,kj->ki", R, arm)
    return poses, gaps, normal


def ellipsoids_of(kernel):
    """The ellipsoids of `exact_rows`, of the faces that a kernel takes."""
    return benchmark.bodies_of(ELLIPSOIDS if kernel == "cold_sphere" else kernel)


def run_rows(kernel, poses, contract=False):
    """(rows, done, counts) of a kernel's PTX in C; the first body stands in the world's origin."""
    *pair, options = cold_table(*ellipsoids_of(kernel)).arrays
    rows, done = np.full((len(poses), K.N_OUT), np.nan), np.full(len(poses), -1)
    counts = in_c(kernel, contract)(
        (tuple(pair), options, np.eye(4)[None], poses, rows, done), len(poses)
    )
    return rows, done, counts


@needs_c
@pytest.mark.parametrize(
    ("kernel", "contract"),
    [(ELLIPSOIDS, False), (ELLIPSOIDS, True), ("cold_sphere", True), ("cold_nurbs_4", False)],
)
def test_cold_rows_of_exact_gaps(rng, kernel, contract):
    n = 2_000
    poses, gaps, normal = exact_rows(n, rng)
    a, b = ellipsoids_of(kernel)
    rows, done, counts = run_rows(kernel, poses, contract)
    # nearer, a smooth start leaves more to the processor
    assert (done[gaps >= (0.0 if kernel == ELLIPSOIDS else 0.1)] == 1).mean() > 0.99
    mine = so.distances(a, b, np.eye(4), poses).rows[done == 1]
    rows, gaps, normal = rows[done == 1], gaps[done == 1], normal[done == 1]
    roundoff = 1e-14 * (a.size + b.size + gaps)
    assert (rows[:, K.LOWER_BOUND] <= gaps + roundoff).all()
    assert (rows[:, K.UPPER_BOUND] >= gaps - roundoff).all()
    assert (rows[:, K.LOWER_BOUND] > gaps - 100.0 * roundoff).all()
    np.testing.assert_allclose(rows[:, K.DISTANCE], gaps, rtol=0.0, atol=roundoff.min())
    np.testing.assert_allclose(rows[:, K.NORMAL : K.NORMAL + 3], normal, atol=1e-9)
    assert (rows[:, K.STATUS] == mine[:, K.STATUS]).all()
    size = 1e-12 * (a.size + b.size)
    np.testing.assert_allclose(rows[:, K.DISTANCE], mine[:, K.DISTANCE], rtol=0.0, atol=size)
    assert counts["sqrt"] > n


@needs_c
@pytest.mark.parametrize("kernel", [ELLIPSOIDS, "cold_nurbs_4"])
def test_a_row_that_cannot_be_proven_is_left_to_the_processor(rng, kernel):
    """Bodies in each other, a mirror in place of a pose, nan."""
    poses = exact_rows(5, rng, -1.0)[0]
    poses[1, :3, 3] = 0.1
    poses[2, :3, :3] *= -1.0
    poses[3, 0, 3] = np.nan
    assert run_rows(kernel, poses)[1].tolist() == [1, 0, 0, 0, 1]


@needs_c
@pytest.mark.parametrize("kernel", ["frames_sphere", "frames_nurbs_4"])
def test_frames_beside_the_trackers(kernel):
    """With twists, frame after frame: state, answer and rates."""
    n = 40
    frames = benchmark.Frames(kernel, n)
    for _ in range(5):
        in_c(kernel)(frames.arguments(), n)
        found = frames.judged()
        assert found["rows"] == n
        assert found["broken"] == 0.0
        assert max(found["distance"], found["points"]) < 1e-14
        states = np.array([state.data for state in frames.states])
        mine = frames.blocks[:, K.BLOCK_STATE : K.BLOCK_MOTION]
        np.testing.assert_allclose(mine, states, rtol=1e-8, atol=1e-9)
        rows = np.array([state.proximity.row for state in frames.states])
        assert not np.isnan(rows[:, K.OUT_RATE : K.STATUS]).any()
        np.testing.assert_allclose(frames.blocks[:, : K.N_OUT], rows, rtol=1e-8, atol=1e-9)


def test_the_bound_by_arithmetic():
    gpu = benchmark.Gpu((9, 0), 2, 10, 1e3, 1e6, 64)
    counts = {"add": 3, "sub": 0, "mul": 5, "fma": 2, "div": 1, "rcp": 0, "sqrt": 0}
    assert benchmark.bound(counts, 100.0, gpu) == (1e3, 1e4)
    assert [benchmark.warps(each, gpu) for each in (255, 222, 128, 32)] == [8, 8, 16, 64]


def test_c_of_a_kernel_that_is_not_understood():
    with pytest.raises(ValueError, match=r"bfind\.u32"):
        written_in_c(".visible .entry k()\n{\n\tbfind.u32 \t%r1, %r2;\n\tret;\n}\n")
