"""Every command says first what it is about to do, on stderr, before the library is loaded."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from standoff.cli.announcement import announce
from standoff.cli.arguments import parse
from standoff.kernels.compiler import notices
from standoff.kernels.compiler.notices import ALL_SECONDS, QUIET

SAID = {
    "track s.toml": "tracking the pairs of s.toml ...",
    "track s.toml --pair near": "tracking the pair near of s.toml ...",
    "distance s.toml --json": "finding the distance of the pairs of s.toml ...",
    "impact s.toml": "finding the first impact of the pairs of s.toml ...",
    "clearance s.toml": "finding the clearance of all pairs of s.toml ...",
    "clearance s.toml --motion": (
        "finding the clearance of all pairs of s.toml over its motion ..."
    ),
    "sweep j.toml -o f": "sweeping j.toml ...",
    "sweep j.toml --estimate": "estimating j.toml ...",
    "sweep j.toml --row 7": "computing row 7 of j.toml ...",
    "check s.toml": "checking s.toml ...",
    "automaton s.toml": "finding the modes of the pairs of s.toml ...",
    "paper": "making all figures and animations of the paper into standoff-paper ...",
    "paper 7 voronoi --no-animations -o f": "making figures 7, voronoi of the paper into f ...",
    "soak --pairs 5000 -o f": (
        "tracking and checking random pairs up to 5,000, each 2,000 frames, into f ..."
    ),
    "soak --replay f.json": "running the pair of f.json again ...",
    "accuracy box lens": (
        "measuring the errors of pairs of box, lens, 10 cases at each gap and depth ..."
    ),
    "accuracy": "measuring the errors of all pairs, 10 cases at each gap and depth ...",
    "warmup": (
        "loading all kernels; compiling all of them takes about "
        f"{ALL_SECONDS} s of processor time ..."
    ),
}


@pytest.fixture(autouse=True)
def not_quiet(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(QUIET, raising=False)
    monkeypatch.setattr(notices, "_taken", [10.0, 10.0])  # a machine that is not busy


@pytest.mark.parametrize("arguments", SAID)
def test_a_command_says_what_it_does(arguments: str, capsys: pytest.CaptureFixture[str]) -> None:
    announce(parse(arguments.split()))
    assert tuple(capsys.readouterr()) == ("", f"standoff: {SAID[arguments]}\n")


def test_a_line_stays_a_line(capsys: pytest.CaptureFixture[str]) -> None:
    announce(parse(["check", "two\nlines"]))
    announce(parse(["check", "x" * 5000]))
    named, cut = capsys.readouterr().err.splitlines()
    assert named == r"standoff: checking 'two\nlines' ..."
    assert cut == f"standoff: checking {'x' * 99}… ..."


def test_a_list_of_figures_needs_no_announcement(capsys: pytest.CaptureFixture[str]) -> None:
    announce(parse(["paper", "--list"]))
    assert tuple(capsys.readouterr()) == ("", "")


def test_it_can_be_silenced(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(QUIET, "1")
    announce(parse(["warmup"]))
    assert tuple(capsys.readouterr()) == ("", "")


LOADED = """
import sys
from standoff.cli import announcement, main

def say(text):
    print([name for name in ("numba", "numpy", "scipy") if name in sys.modules])

announcement.say = say
main(["distance", sys.argv[1]])
"""


def test_it_is_said_before_the_library_is_loaded(tmp_path: Path) -> None:
    command = [sys.executable, "-c", LOADED, str(tmp_path / "none.toml")]
    ended = subprocess.run(command, capture_output=True, text=True, check=True)
    assert ended.stdout == "[]\n"
