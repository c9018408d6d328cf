"""Poses of many frames and rows: every form gives the same answers, in about the same time."""

from __future__ import annotations

import copy
import pickle
import statistics
import time
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.errors import RefusedRowsWarning
from standoff.kernels.entries import batch
from standoff.kernels.state import arrays as K
from standoff.kernels.tolerances import ROTATION
from standoff.tracking.pose_arrays import mended
from standoff.tracking.reached import cold_table

LENS, TOOL = so.shapes.lens(1.0, 0.45), so.shapes.ellipsoid(0.15, 0.3, 0.2)
REST = np.eye(4)
TRACKER = so.Tracker(LENS, TOOL)
DISC = so.shapes.planar_loop([so.geometry.ConicArc((0, 0), (1, 0), (0, 1))])


def motion(n: int) -> np.ndarray:
    """Poses (n, 4, 4) of a body that turns and passes the lens."""
    poses, turns = np.tile(REST, (n, 1, 1)), 2e-3 * np.arange(n)
    poses[:, :3, :3] = Rotation.from_rotvec(np.outer(turns, [0.3, 0.5, 1.0])).as_matrix()
    poses[:, :3, 3] = np.c_[1.6 * np.cos(turns), 1.6 * np.sin(turns), 0.2 * turns]
    return poses


def rows_of(poses: np.ndarray) -> np.ndarray:
    return np.hstack([poses[:, :3, :3].reshape(-1, 9), poses[:, :3, 3]])


def answered(poses: Any) -> dict[str, Any]:
    """By every call that takes many poses."""
    state = TRACKER.start(REST, motion(1)[0])
    return {
        "cold": so.distances(LENS, TOOL, REST, poses),
        "warm": so.distances(LENS, TOOL, REST, poses, warm=True),
        "of A": so.distances(TOOL, LENS, poses, REST),
        "run": TRACKER.run(state, REST, poses)[1],
    }


def same(found: Any, expected: Any) -> None:
    """To the last bit."""
    rows, those = (answers._numbers[:, : K.N_OUT] for answers in (found, expected))
    assert rows.tobytes() == those.tobytes()
    assert found.repaired.tolist() == expected.repaired.tolist()
    assert found.status.tolist() == expected.status.tolist()


SINGLE = motion(60).astype(np.float32)
WHOLE = SINGLE.astype(np.float64)
TURNS, SHIFTS = WHOLE[:, :3, :3], WHOLE[:, :3, 3]
FORMS: dict[str, Any] = {
    "float32": SINGLE,
    "float32 rows of 12": rows_of(SINGLE),
    "rows of 12": rows_of(WHOLE),
    "big-endian": WHOLE.astype(">f8"),
    "big-endian float32": SINGLE.astype(">f4"),
    "Fortran order": np.asfortranarray(WHOLE),
    "every second": np.repeat(SINGLE, 2, axis=0)[::2],
    "backwards": np.ascontiguousarray(WHOLE[::-1])[::-1],
    "objects": WHOLE.astype(object),
    "lists": WHOLE.tolist(),
    "list of arrays": list(SINGLE),
    "pair of stacks": (TURNS, SHIFTS),
    "list of two stacks": [TURNS.astype(np.float32), SHIFTS.tolist()],
    "list of pairs": list(zip(TURNS, SHIFTS, strict=True)),
    "list of matrices and pairs": [*WHOLE[:30], *zip(TURNS[30:], SHIFTS[30:], strict=True)],
}


@pytest.mark.parametrize("form", FORMS)
def test_a_form_gives_the_answers_of_float64(form: str) -> None:
    expected = answered(WHOLE)
    assert expected["run"].repaired.sum() > 50
    for call, found in answered(FORMS[form]).items():
        same(found, expected[call])


@pytest.mark.parametrize("dtype", [np.int64, np.float16, np.uint8])
def test_other_numbers_that_are_exact(dtype: type) -> None:
    poses = np.tile(REST, (4, 1, 1))
    poses[:, 0, 3] = 3.0, 4.0, 5.0, 6.0
    expected = answered(poses)
    for call, found in answered(poses.astype(dtype)).items():
        same(found, expected[call])


def test_checked_poses_and_lists_of_them_keep_their_marks() -> None:
    several = so.Poses.of(SINGLE)
    assert several.repaired.sum() > 50
    expected = answered(several)
    direct = answered(SINGLE)
    singles = list(several)
    mixed = [*singles[:20], *SINGLE[20:]]
    for given in (singles, tuple(singles), [so.Pose.of(pose) for pose in SINGLE], mixed):
        for call, found in answered(given).items():
            same(found, expected[call])
    for call, found in direct.items():
        np.testing.assert_array_equal(found.distance, expected[call].distance)
        assert found.repaired.tolist() == expected[call].repaired.tolist()


def test_quaternions_by_their_named_order() -> None:
    xyzw = Rotation.from_matrix(motion(60)[:, :3, :3]).as_quat()
    rows = np.hstack([motion(60)[:, :3, 3], xyzw])  # XYZ-QUAT
    singles = [so.Pose.from_xyzw(row[3:], row[:3]) for row in rows]
    expected = answered(singles)
    wxyz = so.Poses.from_wxyz(np.roll(xyzw, 1, axis=1), rows[:, :3])
    for given in (so.Poses.from_xyzw(rows[:, 3:], rows[:, :3]), wxyz):
        for call, found in answered(given).items():
            same(found, expected[call])
    for given in (rows, (xyzw, rows[:, :3]), [xyzw, rows[:, :3]], (xyzw[0], rows[0, :3])):
        for call in (lambda x: so.distances(LENS, TOOL, REST, x), answered):
            with pytest.raises(so.StandoffError, match="order of a quaternion must be named"):
                call(given)


def test_scipys_stacks_are_read() -> None:
    turns = Rotation.from_matrix(motion(9)[:, :3, :3])
    expected = answered((turns.as_matrix(), SHIFTS[:9]))
    for call, found in answered((turns, SHIFTS[:9])).items():
        same(found, expected[call])


@pytest.mark.parametrize("call", ["distances", "run"])
def test_rounded_rows_are_those_of_steps(call: str) -> None:
    """The same answers, and the same count, as `step` and `distance` have one by one."""
    given = motion(40)
    given[7] = np.round(given[7], 6)
    given[20:] = given[20:].astype(np.float32)
    given[25, 3, 3] = 1.0 + 1e-10
    state = TRACKER.start(REST, given[0])
    found = answered(given)["run" if call == "run" else "cold"]
    for k, pose in enumerate(given):
        if call == "run":
            state, one = TRACKER.step(state, REST, pose)
        else:
            one = so.distance(LENS, TOOL, REST, pose)
        np.testing.assert_array_equal(found[k].row, one.row)
        assert found.repaired[k] == found[k].repaired == one.repaired
        np.testing.assert_array_equal(found[k].poses, one.poses)


def test_what_many_at_once_pass_no_kernel_refuses(rng: np.random.Generator) -> None:
    """Rotations within roundoff of the defect that is allowed."""
    n = 20_000
    poses = np.tile(REST, (n, 1, 1))
    poses[:, :3, :3] = Rotation.random(n, random_state=rng).as_matrix()
    stretch = np.sqrt(1.0 + ROTATION + rng.uniform(-4e-15, 4e-15, n))
    poses[:, 0, :3] *= stretch[:, None]
    poses[:, 0, 3] = 3.0
    checked = mended(poses)
    assert 0.1 < checked.repaired.mean() < 0.9
    assert not checked.refused.any()
    table = cold_table(so.shapes.sphere(1.0), so.shapes.point())
    rows, done = np.empty((n, K.N_OUT)), np.zeros(n, dtype=np.int64)
    which = np.zeros(1, dtype=np.int64)
    batch.starts(table.numbers.ravel(), which, REST[None], checked.matrices, 0, n, rows, done)
    assert (done == K.FINE).all()


def test_no_array_of_the_callers_is_changed() -> None:
    for given in (WHOLE.copy(), np.asfortranarray(WHOLE), SINGLE.copy()):
        before = given.copy()
        answered(given)
        np.testing.assert_array_equal(given, before)


def test_planar_runs_are_compiled_while_they_stay_in_their_plane() -> None:
    poses = np.tile(REST, (50, 1, 1))
    poses[:, :3, :3] = Rotation.from_euler("z", 0.02 * np.arange(50)[:, None]).as_matrix()
    poses[:, 0, 3] = 3.0
    single = poses.astype(np.float32)
    tracker = so.Tracker(DISC, DISC)
    begin = state = tracker.start(REST, poses[0])
    _, found = tracker.run(begin, REST, single)
    for k, pose in enumerate(single):
        state, one = tracker.step(state, REST, pose)
        np.testing.assert_array_equal(found[k].row, one.row)
        assert found[k].repaired == one.repaired
    single[7, 2, 3] = 0.1
    with pytest.raises(so.StandoffError, match="Frame 7: pose_b takes a planar body out"):
        tracker.run(begin, REST, single)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rows = so.distances(DISC, DISC, REST, single)
    assert list(rows.errors) == [7]
    assert "Row 7 of poses_b: pose_b takes a planar body out" in str(rows.errors[7])


WRONG = {
    "p first": (lambda p: np.roll(rows_of(p), 3, axis=1), "the position stands first"),
    "3 by 4": (lambda p: p[:, :3].reshape(-1, 12), r"rows are 3 by 4 matrices \[R p\]"),
    "transposed": (lambda p: p.transpose(0, 2, 1), "transpose the matrix"),
    "half precision": (lambda p: p.astype(np.float16), "Pose.nearest"),
    "nan": (lambda p: p * np.nan, "NaN or infinite"),
}


@pytest.mark.parametrize("how", WRONG)
def test_an_order_that_fits_no_row_is_told(how: str) -> None:
    spoil, words = WRONG[how]
    poses = motion(30)
    poses[:, :3, :3] = Rotation.from_rotvec([0.1, 0.2, 0.3]).as_matrix() @ poses[:, :3, :3]
    given = spoil(poses)
    for warm in (False, True):
        with pytest.warns(RefusedRowsWarning, match=f"30 of 30 rows are refused.*{words}") as told:
            found = so.distances(LENS, TOOL, REST, given, warm=warm)
        assert told[0].filename == __file__
        assert len(found.errors) == 30
        assert set(found.status) == {so.Status.REFUSED}
    with pytest.raises(so.StandoffError, match=f"Frame 0.*{words}"):
        TRACKER.run(TRACKER.start(REST, REST), REST, given)


def test_the_advice_is_right() -> None:
    """The columns that the warning names put the numbers in order."""
    poses = motion(30)
    poses[:, :3, :3] = Rotation.from_rotvec([0.1, 0.2, 0.3]).as_matrix() @ poses[:, :3, :3]
    for given in (np.roll(rows_of(poses), 3, axis=1), poses[:, :3].reshape(-1, 12)):
        with pytest.warns(RefusedRowsWarning) as told:
            so.distances(LENS, TOOL, REST, given)
        columns = str(told[0].message).split("rows[:, [")[1].split("]")[0]
        np.testing.assert_array_equal(
            given[:, [int(x) for x in columns.split(",")]], rows_of(poses)
        )


def test_few_refused_rows_are_no_warning() -> None:
    given = motion(30)
    given[:15, 0, 0] = np.nan
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = so.distances(LENS, TOOL, REST, given)
    assert list(found.errors) == list(range(15))
    with pytest.warns(RefusedRowsWarning, match="30 of 30.*Row 0 of poses_a"):
        so.distances(LENS, TOOL, REST * np.nan, given)


@pytest.mark.filterwarnings("ignore::standoff.errors.RefusedRowsWarning")
def test_errors_are_a_mapping_of_rows() -> None:
    given = motion(6)
    given[[1, 2, 4], 0, 0] = np.nan, 2.0, 1e200
    errors = so.distances(LENS, TOOL, REST, given).errors
    assert (list(errors), len(errors), bool(errors)) == ([1, 2, 4], 3, True)
    assert [row in errors for row in (0, 1, -1, 6, 4, "1", np.int64(2))] == [
        *(False, True, False, False, True, False, True)
    ]
    assert [error.argument for error in errors.values()] == ["poses_b"] * 3
    assert [str(error)[:16] for error in errors.values()] == [
        f"Row {k} of poses_b" for k in (1, 2, 4)
    ]
    with pytest.raises(KeyError):
        errors[0]
    assert errors.get(3) is None
    for again in (pickle.loads(pickle.dumps(errors)), copy.deepcopy(errors)):
        assert str(again[2]) == str(errors[2])
    assert repr(errors).startswith("{1: StandoffError('Row 1 of")
    assert not so.distances(LENS, TOOL, REST, motion(3)).errors
    both = so.distances(LENS, TOOL, given, given[::-1]).errors
    assert [(k, both[k].argument) for k in both] == [
        *((1, "poses_a"), (2, "poses_a"), (3, "poses_b"), (4, "poses_a"))
    ]


BAD_FORMS = {
    "no shape of poses": (np.zeros((3, 4)), r"has the shape \(3, 4\)"),
    "no pose in a list": ([so.Pose.identity(), np.eye(3)], "Row 1 of poses_b"),
    "an unnamed quaternion in a list": (
        [so.Pose.identity(), ([1.0, 0, 0, 0], [0.0, 0, 0])],
        "Row 1 of poses_b: .*order of a quaternion must be named",
    ),
    "different lengths": ((TURNS, SHIFTS[1:]), r"\(60, 3, 3\) and \(59, 3\)"),
    "text": ([so.Pose.identity(), "there"], "Row 1 of poses_b"),
    "complex pair": ((TURNS.astype(complex), SHIFTS), "all of them real"),
    "masked": ((np.ma.masked_greater(TURNS, 0.5), SHIFTS), "masked"),
}


@pytest.mark.parametrize("how", BAD_FORMS)
def test_what_is_no_form_of_poses(how: str) -> None:
    given, words = BAD_FORMS[how]
    for call in (
        lambda: so.distances(LENS, TOOL, REST, given),
        lambda: TRACKER.run(TRACKER.start(REST, REST), REST, given),
    ):
        with pytest.raises(so.StandoffError, match=words):
            call()


def test_a_bad_row_of_a_list_or_pair_spoils_no_other() -> None:
    turns = TURNS.copy()
    turns[3] *= 2.0
    expected = so.distances(LENS, TOOL, REST, WHOLE)
    for given in (
        (turns, SHIFTS),
        [so.Pose.of(WHOLE[0]), *list(zip(turns, SHIFTS, strict=True))[1:]],
    ):
        found = so.distances(LENS, TOOL, REST, given)
        assert list(found.errors) == [3]
        np.testing.assert_array_equal(np.delete(found.distance, 3), np.delete(expected.distance, 3))


def seconds(call: Callable[[], object], other: Callable[[], object]) -> tuple[float, float]:
    """Medians of two calls, in turn."""
    times: tuple[list[float], list[float]] = ([], [])
    for _ in range(9):
        for done, each in zip((call, other), times, strict=True):
            begun = time.perf_counter()
            done()
            each.append(time.perf_counter() - begun)
    return statistics.median(times[0]), statistics.median(times[1])


@pytest.mark.slow
def test_single_precision_costs_no_more_than_half_as_much_again() -> None:
    poses = motion(4000)
    single = poses.astype(np.float32)
    for call in (
        lambda x: so.distances(LENS, TOOL, REST, x),
        lambda x: so.distances(LENS, TOOL, REST, x, warm=True),
    ):
        call(single)
        found, plain = seconds(lambda: call(single), lambda: call(poses))  # noqa: B023
        assert found < 2.0 * plain  # 1.1 on a quiet machine; it was 20


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::standoff.errors.RefusedRowsWarning")
def test_refused_rows_cost_less_than_answers() -> None:
    poses = motion(4000)
    wrong = poses * 1.01
    found, plain = seconds(
        lambda: so.distances(LENS, TOOL, REST, wrong), lambda: so.distances(LENS, TOOL, REST, poses)
    )
    assert found < plain  # a tenth on a quiet machine; it was 40 times as much
