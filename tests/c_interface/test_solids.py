"""Two solids in C: the answers of Python's tracker, apart, in overlap, and one inside the other."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import standoff as so
from c_interface import solid_following as F
from families.solid_shapes import bolt, tube
from standoff.c_interface import save_pair
from standoff.kernels.entries import solid_blocks as B
from standoff.solids import SolidProximity, SolidTracker
from standoff.tracking.status import Status

Made = Callable[..., Path]
ROOT = Path(__file__).parents[2]
EXAMPLE, PAGE = ROOT / "examples" / "c", ROOT / "docs" / "c-interface.md"
LID, PAD = so.Solid(so.shapes.box((4, 4, 1))), so.shapes.box((1, 1, 1))
TILT = (0.02, 0.03, 0.0)


def followed(
    program: Made, tracker: SolidTracker, frames: np.ndarray, folder: Path
) -> tuple[F.Told, list[SolidProximity]]:
    """In both languages."""
    told = F.in_c(program(F.SOLID_FRAMES), tracker, frames, folder)
    assert (told.rows[:, F.CODE] == 0.0).all()
    return told, F.in_python(tracker, frames)


def lowered(heights: np.ndarray, tilt: tuple[float, float, float] = TILT) -> np.ndarray:
    return F.carried([so.Pose.exp(tilt, (0.1, 0.2, height)).matrix for height in heights])


def same_apart(row: np.ndarray, answer: SolidProximity, size: float) -> None:
    for k, name in ((F.DISTANCE, "distance"), (F.LOWER, "lower_bound"), (F.UPPER, "upper_bound")):
        assert row[k] == pytest.approx(getattr(answer, name), abs=1e-12 * size, rel=0.0), name
    assert row[F.CERTIFIED] == answer.certified
    assert "_AB"[int(row[F.INSIDE])].strip("_") == answer.inside


def test_apart_the_distance_is_that_of_python(program: Made, tmp_path: Path) -> None:
    a, b = bolt(), tube(1.2, 2.0, 0.0, 1.0)
    tracker = so.Tracker(a, b)
    turned = [
        so.Pose.exp((0.01 * k, 0.02 * k, 0.3), (4.0 + 0.02 * k, 0.5, -0.2)) for k in range(60)
    ]
    frames = F.carried([pose.matrix for pose in turned])
    told, answers = followed(program, tracker, frames, tmp_path)
    singles = 0
    for row, answer in zip(told.rows, answers, strict=True):
        same_apart(row, answer, a.size + b.size)
        assert answer.certified
        if row[F.SINGLE]:
            singles += 1
            assert row[F.STATUS] == answer.status.value
            spots = np.concatenate([row[F.POINT_A], row[F.POINT_B]])
            here = np.concatenate([answer.point_a, answer.point_b])
            np.testing.assert_allclose(spots, here, rtol=0.0, atol=1e-9 * a.size)
            np.testing.assert_allclose(row[F.NORMAL], answer.normal, rtol=0.0, atol=1e-9)
            kinds = ["face", "edge", "vertex"]
            named = row[F.FEATURES].astype(int)
            for k, feature in enumerate((answer.feature_a, answer.feature_b)):
                assert (kinds[named[2 * k]], named[2 * k + 1]) == tuple(feature)
            count = len(answer.parameters_a)
            assert row[F.PARAMETERS][:count] == pytest.approx(answer.parameters_a, abs=1e-9)
    assert singles > 50
    assert not told.rows[1:, F.RESTARTS].any()


@pytest.mark.parametrize("asked", [{}, {"minima": 0.2}])
def test_through_contact_and_out_again(
    asked: dict[str, float], program: Made, tmp_path: Path
) -> None:
    down = np.linspace(1.1, 0.99, 30)
    heights = np.concatenate([down, down[::-1]])
    tracker = so.Tracker(LID, PAD, **asked)
    told, answers = followed(program, tracker, lowered(heights), tmp_path)
    met = 0
    for k, (row, answer) in enumerate(zip(told.rows, answers, strict=True)):
        assert (row[F.STATUS] == Status.OVERLAPPING.value) == (answer.status is Status.OVERLAPPING)
        if answer.status is not Status.OVERLAPPING:
            same_apart(row, answer, 6.0)
            continue
        met += 1
        assert row[F.DISTANCE] == pytest.approx(answer.distance, abs=1e-9)
        assert row[F.CERTIFIED] == 0.0
        assert row[F.UPPER] == pytest.approx(answer.upper_bound, abs=1e-9)
        assert row[F.LOWER] == pytest.approx(answer.lower_bound, abs=1e-9)
        assert row[F.DISTANCE] - 1e-12 <= row[F.UPPER] < 0.0
        np.testing.assert_allclose(row[F.NORMAL], answer.normal, rtol=0.0, atol=1e-8)
        minima = told.minima(k)
        if asked:
            assert row[F.COMPLETE] == 1.0
            assert [m.key for m in answer.minima[: F.N_TOLD]] == minima[:, 2].tolist()
            assert [m.felt for m in answer.minima[: F.N_TOLD]] == minima[:, 3].tolist()
        expected = [m.distance for m in answer.minima[: F.N_TOLD]]
        np.testing.assert_allclose(minima[:, 0], expected, rtol=0.0, atol=1e-9)
        expected = [m.lower_bound for m in answer.minima[: F.N_TOLD]]
        np.testing.assert_allclose(minima[:, 1], expected, rtol=0.0, atol=1e-9)
    assert met > 10
    assert not told.rows[1:, F.RESTARTS].any()


def test_one_inside_the_other(program: Made, tmp_path: Path) -> None:
    """A leap into the material, and out of it."""
    block, ball = so.Solid(so.shapes.box((4, 4, 4))), so.shapes.sphere(0.3)
    for a, b, inside in ((block, ball, 2.0), (ball, block, 1.0)):
        moved = [so.Pose.exp((0, 0, 0), (x, 0.1, 0.2)).matrix for x in (3.0, 0.5, 0.6, 3.1)]
        told, answers = followed(program, so.Tracker(a, b), F.carried(moved), tmp_path)
        assert told.rows[:, F.INSIDE].tolist() == [0.0, inside, inside, 0.0]
        assert told.rows[1, F.STATUS] == Status.CONTAINED.value == B.CONTAINED
        for row, answer in zip(told.rows, answers, strict=True):
            same_apart(row, answer, 8.0)


def test_a_tie_is_proven_and_not_single(program: Made, tmp_path: Path) -> None:
    frames = lowered(np.array([1.2, 1.19, 1.18]), (0.0, 0.0, 0.0))
    told, answers = followed(program, so.Tracker(LID, PAD), frames, tmp_path)
    for row, answer in zip(told.rows[1:], answers[1:], strict=True):
        assert answer.status is Status.CONTINUUM
        same_apart(row, answer, 6.0)
        assert (row[F.STATUS], row[F.SINGLE]) == (Status.CONVERGED.value, 0.0)


def test_a_start_in_overlap_feels_all_places(program: Made, tmp_path: Path) -> None:
    told, answers = followed(program, so.Tracker(LID, PAD), lowered(np.full(3, 0.95)), tmp_path)
    assert (told.rows[:, F.STATUS] == Status.OVERLAPPING.value).all()
    assert answers[1].distance == pytest.approx(told.rows[1, F.DISTANCE], abs=1e-9)


def test_a_bad_pose_changes_nothing(program: Made, tmp_path: Path) -> None:
    frames = lowered(np.linspace(1.1, 1.05, 12))
    bad = np.repeat(frames[6:7], 3, axis=0)
    bad[0, 0], bad[2, 20] = np.nan, np.inf
    bad[1, 12:15] *= 1.01
    made, tracker = program(F.SOLID_FRAMES), so.Tracker(LID, PAD)
    plain = F.in_c(made, tracker, frames, tmp_path).rows
    mixed = F.in_c(made, tracker, np.insert(frames, 6, bad, axis=0), tmp_path).rows
    assert mixed[6:9, F.CODE].tolist() == [-1.0, -2.0, -2.0]
    np.testing.assert_array_equal(np.delete(mixed, np.s_[6:9], axis=0), plain)


def test_a_copied_state_is_returned_to(program: Made, tmp_path: Path) -> None:
    """Apart and in contact: the same frames again give the same bytes."""
    down = lowered(np.linspace(1.06, 0.99, 24))
    made, tracker = program(F.SOLID_FRAMES), so.Tracker(LID, PAD, minima=0.2)
    for at in (4, 20):
        frames = np.concatenate([down, down[at:]])
        frames[at, 24], frames[len(down), 24] = F.KEPT_STEP, F.RETURNED
        rows = F.in_c(made, tracker, frames, tmp_path).rows
        assert rows[at : len(down)].tobytes() == rows[len(down) :].tobytes()
    assert rows[20, F.STATUS] == Status.OVERLAPPING.value


def told_code(program: Path, *files: Path) -> int:
    done = subprocess.run([program, *files], capture_output=True, text=True, check=True)
    code, message = done.stdout.split(" ", 1)
    assert len(message) > 10
    return int(code)


def test_what_is_no_file_of_solids_is_refused(
    program: Made, tmp_path: Path, rng: np.random.Generator
) -> None:
    made, file, other = program(F.SOLID_FRAMES), tmp_path / "pair", tmp_path / "other"
    assert told_code(made, file) == -10
    save_pair(other, so.Tracker(PAD, PAD))
    assert told_code(made, other) == -11  # of convex bodies
    save_pair(file, so.Tracker(LID, PAD))
    whole = file.read_bytes()
    assert told_code(made, file) == 0
    for content, code in (
        (b"", -11),
        (whole[:60], -12),
        (whole[:-8], -12),
        (whole + b"\0" * 8, -12),
        (whole[:8] + b"0" * 64 + whole[72:], -13),
    ):
        file.write_bytes(content)
        assert told_code(made, file) == code
    for at in rng.integers(72, len(whole), 10):
        changed = bytearray(whole)
        changed[at] ^= 1 << rng.integers(8)
        file.write_bytes(changed)
        assert told_code(made, file) == -12, at


def test_a_state_serves_its_own_solids_in_all_its_memory(program: Made, tmp_path: Path) -> None:
    made, tracker = program(F.SOLID_FRAMES), so.Tracker(LID, PAD)
    file, other = tmp_path / "pair", tmp_path / "other"
    save_pair(file, tracker)
    save_pair(other, so.Tracker(LID, so.shapes.sphere(0.5)))
    assert told_code(made, file, other) == -6
    assert told_code(made, file, file) == 1  # of the same pair it is none that is refused
    frames = lowered(np.array([1.1, 1.09, 1.08]))
    frames[1, 24] = F.TOO_LITTLE
    rows = F.in_c(made, tracker, frames, tmp_path).rows
    assert rows[:, F.CODE].tolist() == [0.0, -8.0, 0.0]


def test_solids_made_of_formulas_are_refused(tmp_path: Path, rng: np.random.Generator) -> None:
    from families import formula_bodies

    egg = formula_bodies.egg(rng).body
    with pytest.raises(so.StandoffError, match="Body B is made of formulas"):
        save_pair(tmp_path / "pair", so.Tracker(LID, egg))
    assert not (tmp_path / "pair").exists()


def test_the_links_print_what_the_page_shows(program: Made, tmp_path: Path) -> None:
    subprocess.run([sys.executable, EXAMPLE / "save_links.py"], cwd=tmp_path, check=True)
    made = program(EXAMPLE / "links.c")
    told = subprocess.run([made], cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    assert f"./links\n{told}```" in PAGE.read_text()
    assert "-0.006001  overlap" in told
    code = (EXAMPLE / "save_links.py").read_text().split("half = ", 1)[1]
    assert code in PAGE.read_text()


def test_numbers_are_those_of_python() -> None:
    assert Status(B.WITHIN) is Status.WITHIN
    assert Status(B.CONTAINED) is Status.CONTAINED
