"""What is said while somebody waits for the compiler: in a program, without a terminal, once."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import pytest

from standoff.kernels.compiler import modules, notices
from standoff.kernels.entries.preparing import every_entry
from waiting import until

SEGMENT = "import standoff as so; so.shapes.segment(1.0); so.shapes.segment(2.0)"
OTHER = "from standoff.kernels.entries.queries import pcurve_jet as entry; entry.prepare()"


def said(folder: Path, program: str = SEGMENT, **settings: str) -> list[str]:
    """The lines on stderr, a pipe, of a program; a segment needs one entry."""
    environment = {key: value for key, value in os.environ.items() if key != notices.QUIET}
    ended = subprocess.run(
        [sys.executable, "-c", program],
        env=environment | {"NUMBA_CACHE_DIR": str(folder)} | settings,
        capture_output=True,
        text=True,
    )
    assert (ended.returncode, ended.stdout) == (0, ""), ended.stderr
    stock = modules.why_stock() or None  # told beside the rest where another Numba is tried
    return [line for line in ended.stderr.splitlines() if stock is None or stock not in line]


def test_a_numba_that_compiles_each_kernel_by_itself_is_told_once(tmp_path: Path) -> None:
    other = "import numba; numba.__version__ = '0.99.0'; "
    lines = said(tmp_path, f"{other}{SEGMENT}; {OTHER}")
    told = [line for line in lines if "0.99.0" in line]
    assert told == [
        "standoff: Numba 0.99.0 is not the version that one module an entry was written for "
        f"({modules.WRITTEN_FOR}x): each kernel is compiled by itself, which takes ten times as "
        "long; the answers are the same."
    ]
    assert lines[0] == told[0]
    # who asks for it knows
    asked = said(tmp_path / "asked", OTHER, STANDOFF_STOCK_COMPILER="1")
    assert not [line for line in asked if "by itself" in line]


def test_the_first_use_is_told_once_and_later_ones_are_silent(tmp_path: Path) -> None:
    first, *rest = said(tmp_path)
    assert re.fullmatch(
        r"standoff: compiling the kernels for the geometry of bodies \(curve_jet, part 1 of at "
        r"most 19\): about 15 s of processor time(, \d+ s or so as busy as this machine is)?, "
        r"kept for next time; `standoff warmup` compiles all of them ahead \.\.\.",
        first,
    )
    ended = r"standoff: curve_jet compiled in \d+ s(, \d+ s of them on a processor)?"
    rest = [line for line in rest if "still compiling" not in line]  # as on a busy machine
    assert len(rest) <= 1
    assert all(re.fullmatch(ended, line) for line in rest)
    assert said(tmp_path) == []


def test_another_part_in_the_next_program_is_told_in_other_words(tmp_path: Path) -> None:
    """Of the same work: what a program does not call is compiled in a later one."""
    first, *_ = said(tmp_path)
    other, *_ = said(tmp_path, program=OTHER)
    assert "(pcurve_jet, part 1 of at most 19)" in other
    assert first.partition("(")[0] == other.partition("(")[0]
    assert first != other


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
    entries = Counter(each.work for each in every_entry())
    assert set(entries) == set(notices.WORK)
    assert all(work.parts in (entries[name], 0) for name, work in notices.WORK.items())


@pytest.fixture
def heard(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> Callable[[], list[str]]:
    """The lines on stderr of a process that has compiled nothing and is not quiet."""
    monkeypatch.delenv(notices.QUIET, raising=False)
    monkeypatch.setattr(notices, "_said", set())
    monkeypatch.setattr(notices, "_begun", Counter())
    monkeypatch.setattr(notices, "_taken", [100.0, 100.0])
    return lambda: capsys.readouterr().err.splitlines()


def compiled(
    work: str, name: str = "start", seconds: float = 0.0, kept: bool = True, told: bool = False
) -> None:
    """What an entry does that is not on disk; `told`: until a line more is said."""
    with notices.waiting(work, name):
        notices.compiling(kept)
        said = notices._spoken
        time.sleep(seconds)
        if told:
            until(lambda: notices._spoken > said)


def test_who_tells_of_it_himself_is_not_told_twice(heard: Callable[[], list[str]]) -> None:
    with notices.told_elsewhere():
        compiled("query")
    assert heard() == []
    compiled("query")
    compiled("query")
    compiled("contact")
    alone, after = heard()
    query, contact = notices.WORK["query"], notices.WORK["contact"]
    assert (
        f"about {query.alone} s of processor time, kept for next time; `standoff warmup`" in alone
    )
    assert f"about {contact.seconds} s of processor time, kept for next time ..." in after


@pytest.mark.parametrize(
    ("load", "seen", "words"),
    [
        (0.0, (0.0, 0.0), "about 20 s of processor time"),
        (15.0, (0.0, 0.0), "about 20 s of processor time, 80 s or so as busy as this machine is"),
        (0.0, (50.0, 10.0), "about 20 s of processor time, 100 s or so as busy as this machine is"),
        (15.0, (10.0, 10.0), "about 20 s of processor time"),
    ],
)
def test_a_time_is_told_as_the_machine_is_busy(
    load: float, seen: tuple[float, float], words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By its load, and once something was compiled by what that took."""
    monkeypatch.setattr(os, "getloadavg", lambda: (load, 0.0, 0.0), raising=False)
    monkeypatch.setattr(os, "cpu_count", lambda: 4)
    monkeypatch.setattr(notices, "_taken", list(seen))
    assert notices.takes(20) == words


def test_an_estimate_is_corrected_while_one_waits(
    heard: Callable[[], list[str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A machine that gives the compiler a fifth of a processor."""
    monkeypatch.setattr(notices, "PERIOD", 0.2)
    now = time.perf_counter()
    monkeypatch.setattr(time, "process_time", lambda: 10.0 + 0.2 * (time.perf_counter() - now))
    compiled("query", seconds=1.2)
    first, *still, last = heard()
    assert f"about {notices.WORK['query'].alone} s of processor time" in first
    assert still
    for line in still:
        told = re.fullmatch(
            r"standoff: still compiling start, part 1 of at most 2: \d s so far, \d s of them on a "
            r"processor, which others use too; at this pace 24 s of it take (\d+) s \.\.\.",
            line,
        )
        assert told is not None, line
        assert float(told[1]) == pytest.approx(120.0, rel=0.1)
    assert last == "standoff: start compiled in 1 s, 0 s of them on a processor"
    # and the next estimate is by what was seen
    monkeypatch.setattr(notices, "_taken", [clock - 100.0 for clock in notices._taken])
    monkeypatch.setattr(notices, "SEEN", 0.1)
    compiled("contact")
    (words,) = heard()
    told = re.search(r"about 20 s of processor time, (\d+) s or so", words)
    assert told is not None, words
    assert float(told[1]) == pytest.approx(100.0, rel=0.1)


def test_which_part_of_how_many(heard: Callable[[], list[str]]) -> None:
    for work in notices.parts(["bodies", "query", "frames"]):
        compiled(work)
    compiled("contact")
    assert [line.partition("(")[2].partition(")")[0] for line in heard()] == [
        *("start, part 1 of 3", "start, part 2 of 3", "start, part 3 of 3"),
        "start, part 1 of at most 3",
    ]


def test_what_cannot_be_kept_is_not_said_to_be(heard: Callable[[], list[str]]) -> None:
    compiled("query", kept=False)
    assert "kept" not in heard()[0]


@pytest.mark.parametrize("quiet", ["0", "1"])
def test_a_long_wait_is_told_to_go_on(
    quiet: str, heard: Callable[[], list[str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(notices, "PERIOD", 0.2)
    monkeypatch.setenv(notices.QUIET, quiet)
    with notices.alive(lambda: "the wait that this one is part of"), notices.told_elsewhere():
        for work in notices.parts(["query", "contact"]):
            compiled(work, work, 0.5, told=quiet == "0")
    lines = heard()
    told = ["query, part 1 of 2", "contact, part 2 of 2"] if quiet == "0" else []
    assert list(dict.fromkeys(line.rpartition(":")[0] for line in lines)) == [
        f"standoff: still compiling {part}" for part in told
    ]


def test_nothing_is_said_while_nothing_is_compiled(
    heard: Callable[[], list[str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(notices, "PERIOD", 0.05)
    with notices.waiting("query", "start"):
        time.sleep(0.3)
    compiled("query")
    time.sleep(0.2)
    assert len(heard()) == 1


def test_a_watch_goes_on_where_nobody_reads(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.delenv(notices.QUIET, raising=False)
    monkeypatch.setattr(notices, "PERIOD", 0.05)
    with (tmp_path / "closed").open("w") as closed:
        pass
    monkeypatch.setattr(sys, "stderr", closed)
    asked: list[bool] = []
    with notices.alive(lambda: str(asked.append(True))):
        until(lambda: len(asked) > 1)


def test_the_works_add_up_to_the_whole() -> None:
    total = sum(work.seconds for work in notices.WORK.values())
    assert 0.9 * total <= notices.ALL_SECONDS <= 1.1 * total
