"""What is compiled for a GPU, without one: what each kernel takes, and its PTX, written in C and
run here, beside the processor's answers and gaps that are exact by construction."""

import re
import shutil
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
from standoff.gpu.threads import COLD, KERNELS

TARGET = (9, 0)
# Most bytes of local memory and double operations in the PTX: a tenth more than there are.
MOST = {
    COLD: (0, 1_620),
    "frames_sphere": (340, 1_860),
    "frames_nurbs_2": (360, 3_120),
    "frames_nurbs_3": (400, 3_700),
    "frames_nurbs_4": (450, 4_400),
    "frames_nurbs_5": (530, 5_230),
}
AXES_A, AXES_B = np.array([0.5, 0.8, 0.9]), np.array([0.15, 0.3, 0.2])
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
    """The functions that a kernel was compiled from."""
    listed = re.findall(r"\.common \.global \.align 8 \.u64 _ZN08NumbaEnv(\w+)", ptx)
    found = set()
    for mangled in listed:
        while part := re.match(r"(\d+)", mangled):
            name, mangled = (
                mangled[len(part[1]) :][: int(part[1])],
                mangled[len(part[1]) + int(part[1]) :],
            )
        found.add(name)
    return found


@pytest.mark.parametrize("kernel", [COLD, "frames_sphere", "frames_nurbs_4"])
def test_no_kernel_relies_on_a_product_rounded_by_itself(kernel):
    """A GPU's compiler fuses products and sums in all of them, `uncontracted` or not."""
    folder = Path(so.__file__).parent / "kernels"
    text = "\n".join(file.read_text("utf-8") for file in folder.rglob("*.py"))
    apart = set(re.findall(r"^@uncontracted\ndef (\w+)", text, re.MULTILINE))
    assert {"well_inside", "line_roots"} <= apart
    found = names_in(compiled(kernel, TARGET)[0])
    assert {"certify_cones", "hessian"} <= found
    assert found & apart <= {"well_inside"}  # which only compares


def test_operations_are_counted():
    ptx = (
        "\tadd.rn.f64 \t%fd1, %fd2, %fd3;\n@%p1 sqrt.rn.f64 %fd1, %fd2;\n\tadd.s64 %rd1, %rd2, 1;\n"
    )
    assert DOUBLE.findall(ptx) == ["add", "sqrt"]


def test_an_unknown_kernel_is_refused():
    with pytest.raises(so.StandoffError, match="give one of cold_ellipsoids, frames_sphere"):
        resources_of("warm", TARGET)


def exact_rows(n, rng):
    """Poses (n, 4, 4) of the second ellipsoid whose gaps (n,) and normals are known."""
    normal, gaps = rng.normal(size=(n, 3)), 10.0 ** rng.uniform(-4.0, 1.0, size=n)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    poses = np.tile(np.eye(4), (n, 1, 1))
    poses[:, :3, :3] = R = Rotation.random(n, random_state=rng).as_matrix()
    x = normal * AXES_A**2 / np.linalg.norm(normal * AXES_A, axis=1, keepdims=True)
    own = np.einsum("kji,kj->ki", R, -normal)
    arm = own * AXES_B**2 / np.linalg.norm(own * AXES_B, axis=1, keepdims=True)
    poses[:, :3, 3] = x + gaps[:, None] * normal - np.einsum("kij,kj->ki", R, arm)
    return poses, gaps, normal


@needs_c
@pytest.mark.parametrize("contract", [False, True])
def test_cold_rows_of_exact_gaps(rng, contract):
    n = 2_000
    poses, gaps, normal = exact_rows(n, rng)
    a, b = so.shapes.ellipsoid(*AXES_A), so.shapes.ellipsoid(*AXES_B)
    *pair, options = cold_table(a, b).arrays
    rows, done = np.full((n, K.N_OUT), np.nan), np.full(n, -1)
    run = compiled_in_c(compiled(COLD, TARGET)[0], contract=contract)
    counts = run((tuple(pair), options, np.eye(4)[None], poses, rows, done), n)
    assert (done == 1).mean() > 0.99
    rows, gaps, normal = rows[done == 1], gaps[done == 1], normal[done == 1]
    roundoff = 1e-14 * (a.size + b.size + gaps)
    assert (rows[:, K.LOWER_BOUND] <= gaps + roundoff).all()
    assert (rows[:, K.UPPER_BOUND] >= gaps - roundoff).all()
    assert (rows[:, K.LOWER_BOUND] > gaps - 100.0 * roundoff).all()
    np.testing.assert_allclose(rows[:, K.DISTANCE], gaps, rtol=0.0, atol=roundoff.min())
    np.testing.assert_allclose(rows[:, K.NORMAL : K.NORMAL + 3], normal, atol=1e-9)
    assert counts["sqrt"] > n


@needs_c
def test_a_row_that_cannot_be_proven_is_left_to_the_processor(rng):
    """Bodies in each other, a mirror in place of a pose, nan."""
    a, b = so.shapes.ellipsoid(*AXES_A), so.shapes.ellipsoid(*AXES_B)
    *pair, options = cold_table(a, b).arrays
    poses = exact_rows(5, rng)[0]
    poses[1, :3, 3] = 0.1
    poses[2, :3, :3] *= -1.0
    poses[3, 0, 3] = np.nan
    rows, done = np.full((5, K.N_OUT), np.nan), np.full(5, -1)
    compiled_in_c(compiled(COLD, TARGET)[0])(
        (tuple(pair), options, np.eye(4)[None], poses, rows, done), 5
    )
    assert done.tolist() == [1, 0, 0, 0, 1]


@needs_c
@pytest.mark.parametrize("kernel", ["frames_sphere", "frames_nurbs_4"])
def test_frames_beside_the_trackers(kernel):
    """With twists, frame after frame: state, answer and rates."""
    n = 40
    frames = benchmark.Frames(kernel, n)
    run = compiled_in_c(compiled(kernel, TARGET)[0])
    for _ in range(5):
        run(frames.arguments(), n)
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
