"""Pairs in C: answers to the last bit, files that are refused, the program of the page."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import standoff as so
from c_interface.following import CASES, DT, FRAMES, Case, in_c, in_python, motion
from families import formula_bodies, nurbs_bodies
from standoff.c_interface import build_library, save_pair
from standoff.c_interface.objects import LAWS, SYMBOLS
from standoff.c_interface.pair_file import SMOOTH_FRAMES
from standoff.geometry import ConicArc
from standoff.tracking.status import Status
from standoff.whole_files import MissingFolder

HEADER = Path(__file__).with_name("header.cpp")
ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples" / "c"
PAGE = ROOT / "docs" / "c-interface.md"

BALL = so.shapes.sphere(0.5)
OK, NO_FILE, NOT_A_PAIR, DAMAGED, OTHER_VERSION = 0, -10, -11, -12, -13


@pytest.mark.parametrize("name", CASES)
def test_answers_are_those_of_python_to_the_last_bit(
    name: str, program: Callable[..., Path], tmp_path: Path
) -> None:
    case = CASES[name]
    tracker = so.Tracker(case.a, case.b, DT, case.law)
    frames = motion(case, 1500)
    answers, _ = in_c(program(FRAMES), tracker, frames, tmp_path)
    expected, _ = in_python(tracker, frames)
    np.testing.assert_array_equal(answers.view(np.int64), expected.view(np.int64))
    switches, status = answers[:, 30], answers[:, 28]
    if name == "box and lens, switching":
        assert switches.sum() > 3
    if name == "in and out of contact":
        assert {Status.CONVERGED.value, Status.GLOBAL.value} <= set(status)
    if name == "one minimum":
        assert {Status.GLOBAL.value, Status.NOT_RESTARTED.value} <= set(status)
    if name == "a horizon":
        assert {Status.CONVERGED.value, Status.FAR.value} <= set(status)
    if name == "no depth is certified":
        assert {Status.OVERLAPPING.value, Status.NOT_CERTIFIED.value} <= set(status)
    if name == "ellipsoids on their faces":
        assert answers[1:, 31].mean() < 0.05  # by the frame for spheres' patches, as in Python


def test_nurbs_bodies_go_to_files_too(
    program: Callable[..., Path], tmp_path: Path, rng: np.random.Generator
) -> None:
    a, b = nurbs_bodies.cushion(rng).body, nurbs_bodies.lens(rng).body
    case = Case(a, b, reach=2.0 * (a.size + b.size))
    tracker, frames = so.Tracker(a, b, DT), motion(case, 300)
    answers, _ = in_c(program(FRAMES), tracker, frames, tmp_path)
    expected, _ = in_python(tracker, frames)
    np.testing.assert_array_equal(answers.view(np.int64), expected.view(np.int64))


def test_each_part_that_was_compiled_was_told(library: Path) -> None:
    told = [line.split() for line in (library / "progress").read_text().splitlines()]
    parts = len(SYMBOLS) + len(SMOOTH_FRAMES) + len(LAWS)
    assert told == [[str(done), str(parts)] for done in range(parts + 1)]


def test_no_interpreter_is_in_the_process(library: Path, program: Callable[..., Path]) -> None:
    if not sys.platform.startswith("linux"):
        pytest.skip("ldd is a tool of Linux")
    told = subprocess.run(["ldd", program(FRAMES)], capture_output=True, text=True, check=True)
    assert "libstandoff" in told.stdout
    assert "python" not in told.stdout.lower().replace(str(library).lower(), "")


def test_a_step_in_c_is_no_slower_than_one_from_python(
    program: Callable[..., Path], tmp_path: Path
) -> None:
    case = CASES["box and lens, switching"]
    tracker, frames = so.Tracker(case.a, case.b, DT), motion(case, 1500)
    in_python(tracker, frames[:10])
    c = min(in_c(program(FRAMES), tracker, frames, tmp_path)[1] for _ in range(3))
    python = min(in_python(tracker, frames)[1] for _ in range(3))
    assert c < python, (c, python)


def test_formula_bodies_are_refused(tmp_path: Path, rng: np.random.Generator) -> None:
    formula = formula_bodies.egg(rng).body
    target = tmp_path / "pair"
    for bodies, name in (((formula, BALL), "A"), ((BALL, formula), "B")):
        with pytest.raises(so.StandoffError, match=f"Body {name} is made of formulas"):
            save_pair(target, so.Tracker(*bodies))
    assert not target.exists()


def test_what_is_not_a_tracker_is_refused(tmp_path: Path) -> None:
    with pytest.raises(so.StandoffError, match="tracker is"):
        save_pair(tmp_path / "pair", BALL)  # type: ignore[arg-type]
    with pytest.raises(MissingFolder):
        save_pair(tmp_path / "nowhere" / "pair", so.Tracker(BALL, BALL))


def test_a_frame_compiled_for_this_pair_is_refused(tmp_path: Path) -> None:
    capsule = so.shapes.capsule(0.2, 1.0)
    save_pair(tmp_path / "pair", so.Tracker(capsule, capsule))
    cone, egg = so.shapes.cone(0.5, 1.0), so.shapes.ellipsoid(0.3, 0.2, 0.1)
    with pytest.raises(so.StandoffError, match="specialise=True"):
        save_pair(tmp_path / "other", so.Tracker(cone, egg, specialise=True))
    assert not (tmp_path / "other").exists()


def test_no_compiler_is_told_before_anything_is_built(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(so.StandoffError, match="no C compiler 'no-such-cc'"):
        build_library(tmp_path, compiler="no-such-cc")
    monkeypatch.setenv("CC", "no-cc-either -m64")
    with pytest.raises(so.StandoffError, match="no C compiler 'no-cc-either -m64'"):
        build_library(tmp_path)
    with pytest.raises(MissingFolder, match="make it first"):
        build_library(tmp_path / "nowhere")
    assert list(tmp_path.iterdir()) == []


def test_the_header_serves_c_plus_plus(program: Callable[..., Path]) -> None:
    told = subprocess.run([program(HEADER, "c++")], capture_output=True, text=True, check=True)
    assert told.stdout == f"{so.__version__} 1 1 1\n"


def test_a_state_serves_its_own_pair_alone(program: Callable[..., Path], tmp_path: Path) -> None:
    box = so.shapes.box(1.0, 0.8, 0.6)
    save_pair(tmp_path / "own", so.Tracker(box, BALL, 2e-3))
    save_pair(tmp_path / "other", so.Tracker(box, so.shapes.sphere(0.6), 2e-3))
    command = [program(HEADER, "c++"), tmp_path / "own", tmp_path / "other"]
    told = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert told.split() == ["0", "-6", "12", "-1", "0", "0.002"]


def load(program: Path, file: Path) -> int:
    told = subprocess.run([program, file], capture_output=True, text=True, check=True).stdout
    code, message = told.split(" ", 1)
    assert len(message) > 10
    return int(code)


def test_damaged_files_are_refused(
    program: Callable[..., Path], tmp_path: Path, rng: np.random.Generator
) -> None:
    made, file = program(FRAMES), tmp_path / "pair"
    assert load(made, file) == NO_FILE
    save_pair(file, so.Tracker(so.shapes.lens(1.0, 0.4), BALL))
    whole = file.read_bytes()
    assert load(made, file) == OK
    for content, code in (
        (b"", NOT_A_PAIR),
        (b"solid a\n", NOT_A_PAIR),
        (whole[:60], DAMAGED),
        (whole[:200], DAMAGED),
        (whole[:-8], DAMAGED),
        (whole[:-1], DAMAGED),
        (whole + b"\0" * 8, DAMAGED),
        (whole[:8] + b"0" * 64 + whole[72:], OTHER_VERSION),
    ):
        file.write_bytes(content)
        assert load(made, file) == code, content[:10]
    for at in rng.integers(72, len(whole), 25):
        changed = bytearray(whole)
        changed[at] ^= 1 << rng.integers(8)
        file.write_bytes(changed)
        assert load(made, file) == DAMAGED, at


def test_refused_frames_change_nothing(
    program: Callable[..., Path], tmp_path: Path, rng: np.random.Generator
) -> None:
    """A frame whose input is bad is told by its code; the next goes on as if it had not been."""
    case = Case(so.shapes.box(1.0, 0.8, 0.6), BALL)
    frames = motion(case, 60)
    bad = np.repeat(frames[30:31], 6, axis=0)
    bad[0, 0] = np.nan
    bad[1, 12:15] *= 1.01
    bad[2, 31] = np.inf
    bad[3, 37], bad[4, 37], bad[5, 37] = 0.0, -DT, np.nan
    tracker = so.Tracker(case.a, case.b, DT)
    plain, _ = in_c(program(FRAMES), tracker, frames, tmp_path)
    mixed, _ = in_c(program(FRAMES), tracker, np.insert(frames, 30, bad, axis=0), tmp_path)
    np.testing.assert_array_equal(mixed[30:36, 23], [-1, -2, -3, -4, -4, -4])
    np.testing.assert_array_equal(np.delete(mixed, np.s_[30:36], axis=0), plain)


def test_planar_pairs_stay_in_their_plane(program: Callable[..., Path], tmp_path: Path) -> None:
    disc = so.shapes.planar_loop([ConicArc([0.0, 0.0], [1.0, 0.0], [0.0, 1.0])])
    tracker = so.Tracker(disc, disc, DT)
    frames = motion(Case(disc, disc), 4)
    frames[:, :9] = frames[:, 12:21] = np.eye(3).ravel()
    frames[:, 9:12], frames[:, 21:24] = 0.0, [3.0, 0.2, 0.0]
    frames[:, 24:36] = 0.0
    frames[2, 23] = 1e-3
    codes, _ = in_c(program(FRAMES), tracker, frames, tmp_path)
    np.testing.assert_array_equal(codes[:, 23], [0, 0, -5, 0])
    assert codes[3, 0] == pytest.approx(np.hypot(3.0, 0.2) - 2.0, rel=1e-12)


def test_no_byte_is_read_that_is_not_there(
    library: Path, program: Callable[..., Path], tmp_path: Path
) -> None:
    if shutil.which("valgrind") is None:
        pytest.skip("there is no valgrind")
    file = tmp_path / "pair"
    save_pair(file, so.Tracker(BALL, BALL))
    whole = file.read_bytes()
    for content in (whole, whole[:-16], b"STANDOF1"):
        file.write_bytes(content)
        done = subprocess.run(
            ["valgrind", "--error-exitcode=9", "--leak-check=full", "-q", program(FRAMES), file],
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr


def test_the_probe_prints_what_the_page_shows(program: Callable[..., Path], tmp_path: Path) -> None:
    subprocess.run([sys.executable, EXAMPLE / "save_pair.py"], cwd=tmp_path, check=True)
    made = program(EXAMPLE / "probe.c")
    told = subprocess.run([made], cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    assert f"./probe\n{told}```" in PAGE.read_text()
    assert "box edge 7" in told


def test_without_a_pair_it_says_so(program: Callable[..., Path], tmp_path: Path) -> None:
    ended = subprocess.run(
        [program(EXAMPLE / "probe.c")], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert ended.returncode == 1
    assert ended.stderr == "standoff: the file cannot be opened or read\n"


def test_the_page_shows_what_python_saves() -> None:
    code = (EXAMPLE / "save_pair.py").read_text().split('"""\n\n', 1)[1]
    assert code in PAGE.read_text()
