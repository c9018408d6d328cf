"""``standoff paper``: what it prints, writes and refuses, and its exit codes."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, BinaryIO

import pytest

from families import paper_figures as fakes
from standoff_studies.paper import catalogue, writers
from standoff_studies.paper import command as paper

Standoff = Callable[..., Any]


@pytest.fixture(autouse=True)
def fake_catalogue(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(catalogue, "CATALOGUE", fakes.ALL)
    monkeypatch.setattr(paper, "CATALOGUE", fakes.ALL)


def test_figures_are_written_and_summed_up(standoff: Standoff, tmp_path: Path) -> None:
    folder = tmp_path / "new" / "folder"
    ended = standoff("paper", "7", "12", "-o", folder, "--jobs", 1)
    assert (ended.code, ended.err) == (0, "")
    assert sorted(path.name for path in folder.iterdir()) == [
        *("figure-07-steps.parquet", "figure-07.png", "figure-07.svg"),
        *("figure-12.png", "figure-12.svg", "figure-12.webp", "report.html"),
    ]
    rows = [line.split() for line in ended.out.splitlines()]
    assert ["figure", "shows", "hold", "not", "open", "true", "own", "s"] in rows
    (row,) = [row for row in rows if row[:1] == ["7"]]
    assert row[1:-1] == ["A", "line", "&", "a", "<dot>", "1", "1", "1", "1"]
    (row,) = [row for row in rows if row[:1] == ["all"]]
    assert row[1:-1] == ["1", "1", "1", "0", "1"]
    assert f"wrote {folder / 'report.html'}, and 6 files beside it" in ended.out


def test_a_failing_figure_is_told_and_the_others_are_made(
    standoff: Standoff, tmp_path: Path
) -> None:
    ended = standoff("paper", "13", "14", "-o", tmp_path)
    assert ended.code == 3
    assert ended.err.startswith("standoff: figure 13 failed: ZeroDivisionError: no reason (")
    assert ended.err.count("\n") == 1
    assert "A figure that fails (failed)" in ended.out
    assert (tmp_path / "figure-14.png").exists()
    assert "This figure could not be made" in (tmp_path / "report.html").read_text("utf-8")


def test_two_processes_give_the_same_as_one(standoff: Standoff, tmp_path: Path) -> None:
    for jobs in (1, 2):
        assert standoff("paper", "7-12", "-o", tmp_path / str(jobs), "--jobs", jobs).code == 0
    names = sorted(path.name for path in (tmp_path / "1").iterdir())
    assert names == sorted(path.name for path in (tmp_path / "2").iterdir())
    for name in names:
        assert (tmp_path / "1" / name).read_bytes() == (tmp_path / "2" / name).read_bytes(), name


def test_json_tells_every_statement(standoff: Standoff, tmp_path: Path) -> None:
    ended = standoff("paper", "7", "13", "-o", tmp_path, "--json", "--no-animations", "--jobs", 1)
    assert ended.code == 3
    told = json.loads(ended.out)
    verdicts = ("holds", "does_not_hold", "open", "own")
    assert told["statements"] == dict.fromkeys(verdicts, 1) | {"by_construction": 0}
    assert told["failed"] == ["13"]
    assert told["report"] == str(tmp_path / "report.html")
    good, failed = told["figures"]
    assert {Path(file).name for file in good["files"]} == {
        *("figure-07-steps.parquet", "figure-07.png", "figure-07.svg")
    }
    assert good["error"] is None
    assert [(s["holds"], s["verdict"]) for s in good["statements"]] == [
        *((True, "holds"), (False, "does_not_hold"), (None, "open"), (True, "own"))
    ]
    assert failed["error"].startswith("ZeroDivisionError")


def test_an_interruption_tells_what_is_complete(
    standoff: Standoff, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted() -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(fakes, "failing", interrupted)
    ended = standoff("paper", "7-14", "-o", tmp_path, "--no-animations", "--jobs", 1)
    assert (ended.code, ended.out) == (130, "")
    assert ended.err == (
        f"standoff: interrupted; figures complete in {tmp_path}: 7, 12; no report was written\n"
    )
    assert not (tmp_path / "report.html").exists()
    assert not list(tmp_path.glob("*.webp"))


def test_without_a_key_all_are_made_into_a_folder_of_this_name(
    standoff: Standoff, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(catalogue, "CATALOGUE", (fakes.GOOD,))
    assert standoff("paper").code == 0
    assert (tmp_path / "standoff-paper" / "figure-07.svg").exists()


def test_the_list_makes_nothing(standoff: Standoff, tmp_path: Path) -> None:
    ended = standoff("paper", "--list", "-o", tmp_path / "figures")
    assert ended.code == 0
    assert ended.out.splitlines()[:2] == ["7        A line & a <dot>", "12       A dot that moves"]
    assert not list(tmp_path.iterdir())
    told = json.loads(standoff("paper", "--list", "--json").out)
    assert [figure["key"] for figure in told["figures"]] == [entry.key for entry in fakes.ALL]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["77"], "unknown figure '77'; known here: 7, 12"),
        (["7", "--jobs", "0"], "--jobs 0: give 1 or more"),
        (["7", "-o", "taken"], "-o taken: is a file, not a folder; name a folder"),
        (["7", "-o", "taken/x"], "-o taken/x: the folder cannot be made (Not a directory)"),
    ],
)
def test_bad_input_ends_in_one_message(
    standoff: Standoff,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    arguments: list[str],
    message: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "taken").write_text("a file")
    ended = standoff("paper", *arguments)
    assert (ended.code, ended.out) == (2, "")
    assert message in ended.err
    assert ended.err.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["taken"]


def test_files_that_cannot_be_written_have_their_code(
    standoff: Standoff, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(file: BinaryIO) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(writers, "_writer", lambda data: full)
    ended = standoff("paper", "7", "-o", tmp_path)
    assert ended.code == 1
    assert "figure 7 failed: could not be written" in ended.err
    assert "No space left on device" in ended.err


def test_other_commands_do_not_import_what_only_the_figures_need() -> None:
    code = (
        "import sys\n"
        "from standoff.cli import automaton, check, distance, impact, track\n"
        "from standoff_studies.accuracy import command\n"
        "from standoff_studies.paper import command\n"
        "from standoff_studies.soak import command\n"
        "print([m for m in ('matplotlib', 'pyarrow', 'jinja2', 'PIL') if m in sys.modules])"
    )
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ended.stdout == "[]\n"
