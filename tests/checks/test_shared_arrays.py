"""Arrays of other libraries are read where they are, by ``__array__`` or DLPack; on a device they
are refused."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import standoff as so
from standoff.checks.real_numbers import as_given, real_array, shape_of
from standoff.errors import StandoffError

LENS, TOOL = so.shapes.lens(1.0, 0.45), so.shapes.ellipsoid(0.15, 0.30, 0.20)
POSES = np.tile(np.eye(4), (5, 1, 1))
POSES[:, 0, 3] = np.linspace(1.5, 2.5, 5)
GPU = (2, 0)


class Exported:
    """An array that another library owns: all that it tells is DLPack."""

    def __init__(self, array: np.ndarray, device: tuple[int, int] = (1, 0)) -> None:
        self.array, self.device = array, device

    @property
    def shape(self) -> tuple[int, ...]:
        return self.array.shape

    def __dlpack_device__(self) -> tuple[int, int]:
        return self.device

    def __dlpack__(self, **options: Any) -> Any:
        assert self.device == (1, 0), "it is not read"
        return self.array.__dlpack__(**options)


def of_jax(array: np.ndarray) -> Any:
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    return jax.numpy.asarray(array)


def of_torch(array: np.ndarray) -> Any:
    return pytest.importorskip("torch").from_numpy(array)


MAKERS = [Exported, of_jax, of_torch]


@pytest.mark.parametrize("make", MAKERS)
def test_nothing_is_copied(make: Callable[[np.ndarray], Any]) -> None:
    given = make(POSES)
    memory = POSES if make is not of_jax else np.asarray(given)  # JAX takes a copy
    assert np.shares_memory(as_given(given), memory)
    assert np.shares_memory(real_array(given, copy=False), memory)
    assert shape_of(given) == (5, 4, 4)


@pytest.mark.parametrize("make", MAKERS)
def test_answers_are_those_of_numpy_s_arrays(make: Callable[[np.ndarray], Any]) -> None:
    wanted = so.distances(LENS, TOOL, np.eye(4), POSES).distance
    home, turns, shifts = (make(x.copy()) for x in (np.eye(4), POSES[:, :3, :3], POSES[:, :3, 3]))
    for poses in (make(POSES), (turns, shifts), make(POSES.copy(order="F"))):
        np.testing.assert_array_equal(so.distances(LENS, TOOL, home, poses).distance, wanted)
    one = so.distance(LENS, TOOL, home, make(POSES[1].copy()))
    assert one.distance == so.distance(LENS, TOOL, np.eye(4), POSES[1]).distance
    tracker = so.Tracker(LENS, TOOL)
    runs = []
    for form in (np.asarray, make):
        state = tracker.start(form(np.eye(4)), form(POSES[0]))
        steps = form(np.full(4, 0.1))
        runs.append(tracker.run(state, form(np.eye(4)), form(POSES[1:]), dt=steps)[1])
    np.testing.assert_array_equal(runs[0].distance, runs[1].distance)
    design = so.Design(so.shapes.ellipsoid, semi_axes=make(np.array([0.15, 0.30, 0.20])))
    assert design.body.digest == TOOL.digest


def world() -> so.World:
    ball = so.shapes.sphere(0.3)
    return so.World({"a": ball, "b": ball}, within=3.0)


@pytest.mark.parametrize("make", [Exported, of_torch])
def test_frames_of_a_world(make: Callable[[np.ndarray], Any]) -> None:
    balls, poses = world(), np.tile(np.eye(4), (5, 2, 1, 1))
    poses[:, 1, 0, 3] = np.linspace(1.0, 2.0, 5)
    twists = np.zeros((4, 2, 6))
    twists[:, 1, 0] = 1.0
    found = []
    for form in (np.asarray, make):
        state = balls.start(form(poses[0].copy()))
        _, answers = balls.run(state, form(poses[1:]), form(twists))
        found.append([(pair.distance, pair.rate) for each in answers for pair in each.pairs])
    assert found[0] == found[1]
    with pytest.raises(StandoffError, match="poses is on a device"):
        balls.run(state, Exported(poses, GPU))
    with pytest.raises(StandoffError, match="twists is on a device"):
        balls.step(state, poses[1], Exported(twists[0], GPU))


def test_an_array_on_a_device_is_refused() -> None:
    for call in (
        lambda: so.distances(LENS, TOOL, np.eye(4), Exported(POSES, GPU)),
        lambda: so.distances(LENS, TOOL, Exported(np.eye(4), GPU), POSES),
        lambda: so.distances(
            LENS, TOOL, np.eye(4), (Exported(POSES[:, :3, :3], GPU), POSES[:, :3, 3])
        ),
        lambda: so.distance(LENS, TOOL, np.eye(4), Exported(np.eye(4), GPU)),
        lambda: so.shapes.polytope(Exported(np.eye(3), GPU)),
        lambda: so.shapes.polytope([Exported(row, GPU) for row in np.eye(4, 3)]),
        lambda: so.shapes.sphere(Exported(np.array(1.0), GPU)),
        lambda: so.Twist.of(Exported(np.zeros(6), GPU)),
        lambda: so.Poses.from_xyzw(Exported(np.eye(4), GPU), np.zeros((4, 3))),
    ):
        with pytest.raises(StandoffError, match=r"is on a device \(CUDA, number 0\): copy it to"):
            call()
    with pytest.raises(StandoffError, match=r"poses_b is on a device \(kind 99, number 1\)"):
        so.distances(LENS, TOOL, np.eye(4), Exported(POSES, (99, 1)))


def test_memory_that_the_cpu_reads_is_not_on_a_device() -> None:
    class Pinned(Exported):
        def __dlpack__(self, **options: Any) -> Any:
            return self.array.__dlpack__(**options)

    assert np.shares_memory(real_array(Pinned(POSES, (3, 0)), copy=False), POSES)


def test_a_tensor_that_requires_a_gradient_says_what_to_do() -> None:
    torch = pytest.importorskip("torch")
    poses = torch.tensor(POSES, requires_grad=True)
    with pytest.raises(StandoffError, match=r"poses_b cannot be read.*detach\(\)"):
        so.distances(LENS, TOOL, np.eye(4), poses)


def test_results_go_on_to_other_libraries_without_a_copy() -> None:
    found = so.distances(LENS, TOOL, np.eye(4), POSES).distance
    torch = pytest.importorskip("torch")
    tensor = torch.from_dlpack(found)
    assert tensor.data_ptr() == found.ctypes.data
