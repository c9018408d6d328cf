"""Every writer refuses what is not a regular file, leaves it as it was, and follows links."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from families import file_kinds
from families import paper_figures as fakes
from standoff.cli.errors import WriteError
from standoff.scene import load_scene, record
from standoff_studies.paper import catalogue
from standoff_studies.paper import command as paper
from standoff_studies.soak.command import _write_failure
from standoff_studies.soak.ledger import Ledger
from standoff_studies.soak.processes import Done
from standoff_studies.soak.tally import Tally

Standoff = Callable[..., Any]
KINDS = [kind for kind in file_kinds.MAKERS if kind != "folder"]

FAILED = Done((0, 1), Tally(), 7, {"what": "nothing"})

COMMANDS = {
    "run.parquet": "track {scene} -o {target}",
    "run.png": "track {scene} --plot {target}",
    "body.svg": "check {scene} --body part --plot {target}",
    "modes.txt": "automaton {scene} -o {target}",
    "modes.svg": "automaton {scene} -o {target}",
    "soak.json": "soak --pairs 1 --frames 3 --jobs 1 -o {folder} --resume",
    "accuracy.parquet": "accuracy sphere --cases 1 -o {folder}",
    "gaps.md": "accuracy sphere --cases 1 -o {folder}",
    "accuracy.png": "accuracy sphere --cases 1 -o {folder}",
    "report.html": "paper 7 --jobs 1 -o {folder}",
}
LATE = {"figure-07.png": "paper 7 --jobs 1 -o {folder}"}
"""Whose names are not known before the figure is made."""


@pytest.fixture(autouse=True)
def fake_catalogue(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(catalogue, "CATALOGUE", fakes.ALL)
    monkeypatch.setattr(paper, "CATALOGUE", fakes.ALL)


@pytest.mark.parametrize("kind", file_kinds.MAKERS)
@pytest.mark.parametrize("name", COMMANDS)
def test_a_command_refuses_it_before_its_work(
    standoff: Standoff, passing: Path, tmp_path: Path, name: str, kind: str
) -> None:
    folder = tmp_path / "out"
    folder.mkdir()
    target = folder / name
    file_kinds.make(kind, target)
    before = file_kinds.looks(target)
    words = COMMANDS[name].split()
    ended = standoff(*(w.format(scene=passing, target=target, folder=folder) for w in words))
    assert ended.code == 2
    assert ended.out == ""
    assert f"{target}: is a {kind}; name" in ended.err
    assert ended.err.count("\n") == 1
    assert file_kinds.looks(target) == before
    assert list(folder.iterdir()) == [target]


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_met_only_when_writing_is_refused_then(
    standoff: Standoff, tmp_path: Path, kind: str
) -> None:
    for name, command in LATE.items():
        target = tmp_path / name
        file_kinds.make(kind, target)
        before = file_kinds.looks(target)
        ended = standoff(*command.format(folder=tmp_path).split())
        assert ended.code == 1
        assert f"{target}: is a {kind}" in ended.err
        assert file_kinds.looks(target) == before
    for name, write, error in (
        ("soak.json", lambda: Ledger(0, 1).write(tmp_path), OSError),
        ("failure-7.json", lambda: _write_failure(FAILED, tmp_path), WriteError),
    ):
        target = tmp_path / name
        file_kinds.make(kind, target)
        before = file_kinds.looks(target)
        with pytest.raises(error, match=f"is a {kind}"):
            write()
        assert file_kinds.looks(target) == before
    assert not list(tmp_path.glob(".*"))


@pytest.mark.parametrize("kind", file_kinds.MAKERS)
def test_a_recording_is_not_written_over_it(passing: Path, tmp_path: Path, kind: str) -> None:
    recording = record(load_scene(passing))
    for name, write in (("run.parquet", recording.save), ("run.png", recording.plot)):
        target = tmp_path / name
        file_kinds.make(kind, target)
        before = file_kinds.looks(target)
        with pytest.raises(OSError, match=f"{name}: is a {kind}"):
            write(target)
        assert file_kinds.looks(target) == before
        with pytest.raises(ValueError, match="an empty string is not a file name"):
            write("")
        with pytest.raises(TypeError, match="give a file name"):
            write(7)
    assert {p.name for p in tmp_path.iterdir()} == {"passing.toml", "run.parquet", "run.png"}


@pytest.mark.parametrize("name", [name for name in COMMANDS if "target" in COMMANDS[name]])
def test_a_command_follows_a_link(
    standoff: Standoff, passing: Path, tmp_path: Path, name: str
) -> None:
    folder = tmp_path / "elsewhere"
    folder.mkdir()
    link = tmp_path / name
    file_kinds.link(link, folder / "last")
    words = COMMANDS[name].split()
    for _ in range(2):
        ended = standoff(*(w.format(scene=passing, target=link) for w in words))
        assert (ended.code, ended.err) == (0, "")
        assert link.is_symlink()
        assert [path.name for path in folder.iterdir()] == ["last"]
    assert (folder / "last").stat().st_size > 0


@pytest.mark.parametrize("target", ["", ".", "/"])
@pytest.mark.parametrize("command", ["track -o", "track --plot", "automaton -o", "check --plot"])
def test_an_option_that_names_no_file(
    standoff: Standoff, passing: Path, monkeypatch: pytest.MonkeyPatch, command: str, target: str
) -> None:
    monkeypatch.chdir(passing.parent)
    name, option = command.split()
    pair = 'a = "tool"\nb = "part"\n'
    pairs = "".join(f'[[pairs]]\nname = "{name}"\n{pair}' for name in "xy")
    two_pairs = passing.read_text().replace(f"[pair]\n{pair}", pairs)
    assert "[[pairs]]" in two_pairs
    for text in (passing.read_text(), two_pairs):
        passing.write_text(text)
        ended = standoff(name, passing, option, target)
        assert ended.code == 2, ended
        assert ended.err.startswith(f"standoff: {option}"), ended.err
        assert "is a folder" in ended.err
        assert ended.err.count("\n") == 1
    assert list(passing.parent.iterdir()) == [passing]
