"""`standoff automaton`: its formats, its files, and what it refuses."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from standoff.automaton.graph import automaton
from standoff.automaton.text import automaton_mermaid, automaton_text
from standoff.scene import load_scene, record

Standoff = Callable[..., Any]


def test_text_and_mermaid(standoff: Standoff, passing: Path) -> None:
    bare = automaton(*load_scene(passing).pair_bodies)
    ended = standoff("automaton", passing)
    assert ended == (0, automaton_text(bare, ("tool", "part")) + "\n", "")
    ended = standoff("automaton", passing, "--format", "mermaid")
    assert ended == (0, automaton_mermaid(bare, ("tool", "part")) + "\n", "")


def test_visited(standoff: Standoff, passing: Path) -> None:
    recording = record(load_scene(passing))
    ended = standoff("automaton", passing, "--visited")
    assert ended.code == 0
    assert f"visited from 0 s to 2 s: {len({v[:2] for v in recording.modes()})} of 26" in ended.out
    for event in recording.events:
        assert f"{event.time:.6g}" in ended.out


def test_an_uncertified_run_tells_in_the_exit_code(standoff: Standoff, crossing: Path) -> None:
    text = crossing.read_text()
    crossing.write_text(text.replace("[track]\n", '[track]\ndepth = "local"\n'))
    assert standoff("automaton", crossing).code == 0
    ended = standoff("automaton", crossing, "--visited")
    assert ended.code == 3
    assert "visited from" in ended.out


@pytest.mark.parametrize(
    ("name", "head"),
    [("a.svg", "<?xml"), ("a.mmd", "flowchart"), ("a.txt", "modes: 1 feature of A × ")],
)
def test_files(standoff: Standoff, passing: Path, name: str, head: str) -> None:
    target = passing.with_name(name)
    ended = standoff("automaton", passing, "-o", target)
    assert ended == (0, f"wrote {target}\n", "")
    assert target.read_text().startswith(head)


def test_each_pair_has_its_file(standoff: Standoff, passing: Path) -> None:
    text = passing.read_text().replace("[pair]", "[[pairs]]")
    passing.write_text(text + '[[pairs]]\nname = "back"\na = "part"\nb = "tool"\n')
    assert standoff("automaton", passing, "-o", passing.with_name("a.svg")).code == 0
    names = sorted(path.name for path in passing.parent.iterdir())
    assert names == ["a-back.svg", "a-tool-part.svg", "passing.toml"]
    assert standoff("automaton", passing, "--pair", "back").out.startswith("modes: 26 features")
    assert standoff("automaton", passing).out.count("modes: ") == 2


@pytest.mark.parametrize(
    ("options", "piece"),
    [
        (["--format", "mermiad"], "--format: unknown format 'mermiad'; did you mean 'mermaid'?"),
        (["--format", "svg"], "a picture needs a file; add -o automaton.svg"),
        (["--format", "svg", "-o", "a.mmd"], "the ending '.mmd' is not known here"),
        (["-o", "a.dot"], "ends in .txt or .mmd or .svg"),
        (["-o", "no/a.svg"], "the folder no does not exist"),
        (["--pair", "x"], "--pair: unknown pair 'x'"),
    ],
)
def test_refused(
    standoff: Standoff,
    passing: Path,
    monkeypatch: pytest.MonkeyPatch,
    options: list[str],
    piece: str,
) -> None:
    monkeypatch.chdir(passing.parent)
    ended = standoff("automaton", "passing.toml", "--visited", *options)
    assert (ended.code, ended.out) == (2, "")
    assert ended.err.startswith("standoff: ")
    assert piece in ended.err
    assert [path.name for path in Path().iterdir()] == ["passing.toml"]
