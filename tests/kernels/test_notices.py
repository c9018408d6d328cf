"""What is said while somebody waits for the compiler: in a program, without a terminal, once."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from standoff.kernels.compiler import notices
from standoff.kernels.entries.preparing import every_entry

SEGMENT = "import standoff as so; so.shapes.segment(1.0); so.shapes.segment(2.0)"


def said(folder: Path, **settings: str) -> list[str]:
    """The lines on stderr, a pipe, of a program that makes a segment, which needs one entry."""
    environment = {key: value for key, value in os.environ.items() if key != notices.QUIET}
    ended = subprocess.run(
        [sys.executable, "-c", SEGMENT],
        env=environment | {"NUMBA_CACHE_DIR": str(folder)} | settings,
        capture_output=True,
        text=True,
    )
    assert (ended.returncode, ended.stdout) == (0, ""), ended.stderr
    return ended.stderr.splitlines()


def test_the_first_use_is_told_once_and_later_ones_are_silent(tmp_path: Path) -> None:
    first, *rest = said(tmp_path)
    assert first == (
        "standoff: compiling the kernels for the geometry of bodies: once for this installation, "
        "about 10 s (`standoff warmup` compiles all of them ahead) ..."
    )
    assert [line.rstrip(" s0123456789") for line in rest] in ([], ["standoff: compiled in"])
    assert said(tmp_path) == []


def test_it_can_be_silenced(tmp_path: Path) -> None:
    assert said(tmp_path, STANDOFF_QUIET="1") == []
    assert any(tmp_path.rglob("*.nbi"))  # it was compiled


def test_a_closed_stderr_stops_nothing(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.delenv(notices.QUIET, raising=False)
    notices.say("everybody reads this")
    assert "everybody reads this" in capsys.readouterr().err
    with (tmp_path / "closed").open("w") as closed:
        pass
    monkeypatch.setattr(sys, "stderr", closed)
    notices.say("nobody reads this")
    assert capsys.readouterr().err == ""


def test_every_entry_is_needed_for_something_and_all_that_is_named_is_an_entry_s() -> None:
    assert {each.work for each in every_entry()} == set(notices.WORK)


def test_who_tells_of_it_himself_is_not_told_twice(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv(notices.QUIET, raising=False)
    monkeypatch.setattr(notices, "_said", set())
    with notices.told_elsewhere():
        notices.compiling("query")
    assert capsys.readouterr().err == ""
    notices.compiling("query")
    notices.compiling("query")
    notices.compiling("contact")
    alone, after = capsys.readouterr().err.splitlines()
    query, contact = notices.WORK["query"], notices.WORK["contact"]
    assert f"about {query.alone} s (`standoff warmup`" in alone
    assert f"about {contact.seconds} s ..." in after


def test_the_works_add_up_to_the_whole() -> None:
    total = sum(work.seconds for work in notices.WORK.values())
    assert 0.9 * total <= notices.ALL_SECONDS <= 1.1 * total
