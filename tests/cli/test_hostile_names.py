"""Names and titles of a scene that a terminal would obey: shown as escapes, on every way out."""

from __future__ import annotations

import ast
import json
import re
import unicodedata
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import standoff as so
from cli.conftest import PASSING
from standoff.bodies.plain_data import json_text
from standoff.wording import printable, short_name

Standoff = Callable[..., Any]
ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"
OBEYED = "\x1b]0;mine\x07\x1b[2J\r\x7f\x9b31m\u202eback\u2066\n[red]ends[/b] as text"
"""Sets a title, clears, goes back, C1's CSI, turns what follows, begins a line, rich's markup."""


def toml(text: str) -> str:
    return json.dumps(text).replace("\x7f", "\\u007f")


def hostile(scene: str) -> str:
    """A scene with all of its names, and its title, as hostile as they can be."""
    for name in re.findall(r"(?m)^\[bodies\.(\w+)\]", scene):
        key = toml(f"{OBEYED} {name}")
        scene = re.sub(rf"(?m)^\[(\w+)\.{name}\b", lambda found, k=key: f"[{found[1]}.{k}", scene)
        scene = re.sub(rf'(?<!shape = )"{name}"', lambda _, k=key: k, scene)
    title = f"title = {toml(OBEYED)}"
    return re.sub(r"(?m)^title = .*$", lambda found: title, scene)


def obeyed(text: str) -> list[str]:
    """Characters of a text that a terminal would obey, or that turn what is read."""
    kept = (letter for letter in text if letter != "\n")
    return [x for x in kept if not x.isprintable() and unicodedata.category(x) != "Zs"]


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    file = tmp_path / "hostile.toml"
    file.write_text(hostile(PASSING), encoding="utf-8")
    assert "tool]" not in file.read_text()
    return file


COMMANDS = [
    ("distance",),
    ("distance", "--json"),
    ("check",),
    ("check", "--json"),
    ("track",),
    ("track", "--json"),
    ("impact",),
    ("impact", "--json"),
    ("automaton",),
    ("automaton", "--format", "mermaid"),
    ("automaton", "--visited"),
]


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_no_command_lets_a_scene_speak_to_the_terminal(
    standoff: Standoff, scene: Path, command: tuple[str, ...]
) -> None:
    ended = standoff(command[0], scene, *command[1:])
    assert ended.code in (0, 3), ended.err
    assert obeyed(ended.out + ended.err) == []
    if "--json" in command:
        assert OBEYED in _texts(json.loads(ended.out)) or command[0] == "check"
    else:
        assert "\\x1b" in ended.out
        assert not [line for line in ended.out.splitlines() if line.startswith("[red]")]


def _texts(facts: Any) -> list[str]:
    if isinstance(facts, dict):
        return [text for item in facts.values() for text in _texts(item)]
    if isinstance(facts, list):
        return [text for item in facts for text in _texts(item)]
    return [facts] if isinstance(facts, str) else []


@pytest.mark.parametrize("name", ["bounce", "hand-on-lens"])
@pytest.mark.parametrize("json_too", [False, True])
def test_simulations(standoff: Standoff, tmp_path: Path, name: str, json_too: bool) -> None:
    text = (EXAMPLES / "simulation" / f"{name}.toml").read_text()
    file = tmp_path / "hostile.toml"
    file.write_text(hostile(text), encoding="utf-8")
    ended = standoff("simulate", file, "--duration", "0.02", *(["--json"] if json_too else []))
    assert obeyed(ended.out + ended.err) == []
    assert ended.code == 0, ended.err
    assert ("\\u001b" if json_too else "\\x1b") in ended.out


@pytest.mark.parametrize("command", ["distance", "check", "simulate", "servo", "view"])
@pytest.mark.parametrize(
    "fault",
    [
        ('shape = "box"', f"shape = {toml(OBEYED)}"),
        ("size = [1.0, 1.0, 1.0]", f"size = {toml(OBEYED)}"),
        ("[pair]", f"[{toml(OBEYED)}]\n[pair]"),
        ('shape = "box"', f'shape = "patches"\nfile = {toml(OBEYED)}'),
    ],
)
def test_errors(
    standoff: Standoff, tmp_path: Path, scene: Path, command: str, fault: tuple[str, str]
) -> None:
    scene.write_text(scene.read_text().replace(*fault))
    ended = standoff(command, scene)
    assert ended.code == 2
    assert not [line for line in ended.err.splitlines() if line.startswith("[red]")]
    assert obeyed(ended.out + ended.err) == []


def test_a_files_own_name(standoff: Standoff, tmp_path: Path) -> None:
    file = tmp_path / "\x1b[2J\udc80.toml"
    for text in ("not = [toml", PASSING.replace("title = ", "subject = ")):
        file.write_text(text)
        ended = standoff("distance", file)
        assert ended.code == 2
        assert "\\x1b[2J\\udc80" in ended.err
        assert obeyed(ended.err) == []


def test_the_name_of_what_was_written(standoff: Standoff, passing: Path) -> None:
    ended = standoff("automaton", passing, "-o", passing.with_name("\x1b[2J.txt"))
    assert ended.code == 0, ended.err
    assert "wrote" in ended.out
    assert obeyed(ended.out) == []


def test_errors_and_reprs_of_the_library() -> None:
    body = so.Body.from_brep([[0.0, 0.0, 0.0]], name=OBEYED)
    pair = so.distance(body, so.shapes.sphere(1.0), np.eye(4), (np.eye(3), [3.0, 0.0, 0.0]))
    for text in (repr(body), str(so.StandoffError(f"{OBEYED} is refused")), repr(pair)):
        assert obeyed(text) == []
    assert pair.to_json() == json_text(json.loads(pair.to_json()))


def test_what_is_printable_stays() -> None:
    plain = "µ – ü 漢 ‘…’ 1\u00a0mm"
    assert printable(plain) is plain or printable(plain) == plain
    assert printable("a\tb\nc", keep="\n") == "a\\tb\nc"
    assert printable("\x9b \u202e \U000e0001 \udc80") == r"\x9b \u202e \U000e0001 \udc80"
    assert short_name("\x1b" * 30) == "\\x1b" * 4 + "\\x1…"
    facts = {"title": OBEYED + "\U000e0001"}
    assert json.loads(json_text(facts, 2)) == facts
    assert obeyed(json_text(facts, 2)) == []


def test_all_commands_speak_through_one_function() -> None:
    for package in ("src/standoff/cli", "studies/src/standoff_studies"):
        for file in (ROOT / package).rglob("*.py"):
            if file.name in ("terminal.py", "__main__.py"):
                continue
            called = [x for x in ast.walk(ast.parse(file.read_text())) if isinstance(x, ast.Call)]
            names = [call.func.id for call in called if isinstance(call.func, ast.Name)]
            assert "print" not in names, file
