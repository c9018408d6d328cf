"""`standoff warmup`: every entry is loaded or compiled, and told of as soon as it is done."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
import pytest

from standoff.cli import warmup
from standoff.kernels.compiler import cache
from standoff.kernels.compiler.decorators import entry
from standoff.kernels.compiler.entry import READ, REAL
from standoff.kernels.entries.preparing import every_entry, name_of

Standoff = Callable[..., Any]


def twice(x):  # type: ignore[no-untyped-def]
    return 2.0 * x


def mistyped(reals):  # type: ignore[no-untyped-def]
    return reals.nothing


@pytest.fixture
def two(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Callable[[], None]:
    """Puts two small entries in place of all; the first cannot be compiled."""
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))

    def put() -> None:
        made = [entry(READ, work="bodies")(mistyped), entry(REAL, work="runs")(twice)]
        monkeypatch.setattr(warmup, "every_entry", lambda: iter(made))

    put()
    return put


def test_every_entry_is_told(standoff: Standoff) -> None:
    ended = standoff("warmup")
    assert (ended.code, ended.err) == (0, "")
    *lines, total = [line.split() for line in ended.out.splitlines()]
    names = [name_of(each) for each in every_entry()]
    assert len(names) > 20
    assert [line[0] for line in lines] == [f"{k + 1}/{len(names)}" for k in range(len(names))]
    assert [line[4] for line in lines] == [f"{name.rpartition('.')[2]}:" for name in names]
    assert {line[3] for line in lines} <= {"compiled", "loaded"}
    assert max(map(len, ended.out.splitlines()[:-1])) <= 80  # a terminal's
    assert all(each.ready for each in every_entry())
    assert Path(total[-1]).is_dir()


def test_json_is_all_of_stdout(standoff: Standoff) -> None:
    ended = standoff("warmup", "--json")
    facts = json.loads(ended.out)
    names = [name_of(each) for each in every_entry()]
    assert [one["name"] for one in facts["entries"]] == names
    assert all(one["error"] is None for one in facts["entries"])
    assert Path(facts["folder"]).is_dir()
    assert ended.err.count("\n") == len(names)


def test_what_cannot_be_compiled_is_named_and_the_rest_is_compiled(
    standoff: Standoff, two: Callable[[], None]
) -> None:
    ended = standoff("warmup")
    assert ended.code == 3
    assert "test_warmup_command.mistyped could not be compiled: TypingError: " in ended.err
    assert "Traceback" not in ended.err
    first, second, total = ended.out.splitlines()
    assert ("failed" in first, "compiled" in second) == (True, True)
    assert total.startswith("1 compiled, 0 loaded, ")
    two()
    assert standoff("warmup").out.splitlines()[-1].startswith("0 compiled, 1 loaded, ")


def test_code_that_cannot_be_kept_is_told(
    standoff: Standoff, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    class Full(cache._Nowhere):
        def get_cache_path(self) -> str:
            return str(tmp_path / "none")

    made = entry(REAL, work="runs")(twice)
    monkeypatch.setattr(warmup, "every_entry", lambda: iter([made]))
    monkeypatch.setattr(cache._Modules, "_locator_classes", (Full,))
    ended = standoff("warmup")
    assert ended.code == 1
    assert "what is compiled is kept nowhere" in ended.out
    assert "could not be kept: name a folder of your own in NUMBA_CACHE_DIR" in ended.err
    cache._unsaved.cache_clear()


def test_an_interrupted_warmup_says_how_far_it_came(
    standoff: Standoff, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, second = entry(REAL, work="runs")(twice), entry(REAL, work="runs")(twice)

    def interrupt() -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(first, "prepare", lambda: None)
    monkeypatch.setattr(second, "prepare", interrupt)
    monkeypatch.setattr(warmup, "every_entry", lambda: iter([first, second]))
    ended = standoff("warmup")
    assert ended.code == 130
    assert ended.err.startswith("standoff: interrupted after 1 of 2;")


def test_nothing_is_compiled_where_numba_is_off() -> None:
    command = [sys.executable, "-m", "standoff.cli", "warmup"]
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1"}
    ended = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert ended.returncode == 0
    assert ended.stdout.startswith("nothing to compile: NUMBA_DISABLE_JIT=1")


DIES = """
import os
from standoff.cli import main, warmup
from standoff.kernels.entries.preparing import every_entry

first, second, *_ = every_entry()
first.prepare = lambda: None
second.prepare = lambda: os._exit(9)  # what is still in a buffer is lost
warmup.every_entry = lambda: iter([first, second])
main(["warmup"])
"""


def test_each_line_comes_at_once_into_a_pipe() -> None:
    environment = os.environ | {"PYTHONUNBUFFERED": ""}
    ended = subprocess.run(
        [sys.executable, "-c", DIES], env=environment, capture_output=True, text=True
    )
    assert ended.returncode == 9
    (line,) = ended.stdout.splitlines()
    assert line.endswith("surface_jet: the geometry of bodies")
