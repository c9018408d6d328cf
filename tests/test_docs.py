"""The documents: every block of code does what its page says, and every public name is listed."""

import importlib
import re
from collections.abc import Iterator
from inspect import getmembers, isfunction
from pathlib import Path
from typing import Any

import pytest

import standoff as so

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
FENCE = re.compile(r"^```(\w*|\{[^\n]*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
DIRECTIVE = re.compile(r"^\.\. (auto\w+|py:type):: ([\w.]+)\n((?:   .*\n)*)", re.MULTILINE)
# Blocks that read a file of the reader's own; what they read is tested with what writes it.
READS_A_FILE = {"scene-format.md"}

Block = tuple[str, str]


def pages_with_code() -> list[Path]:
    pages = sorted(DOCS.rglob("*.md"))
    assert DOCS / "index.md" in pages
    return [
        p for p in pages if p.name not in READS_A_FILE and "```python\n" in p.read_text("utf-8")
    ]


def blocks(page: Path) -> list[Block]:
    return FENCE.findall(page.read_text("utf-8"))


@pytest.mark.parametrize("page", pages_with_code(), ids=lambda page: page.stem)
def test_code_of_a_page_prints_what_the_page_says(
    page: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A page's Python blocks run in their order; a text block right after one is what it prints."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "examples").symlink_to(DOCS.parent / "examples")
    found = blocks(page)
    names: dict[str, Any] = {}
    for k, (language, code) in enumerate(found):
        if language != "python":
            continue
        exec(compile(code, page.name, "exec"), names)
        printed = capsys.readouterr().out
        following = found[k + 1] if k + 1 < len(found) else ("", "")
        promised = following[1] if following[0] == "text" else ""
        assert printed == promised, f"{page.name}:\n{code}"


def test_each_of_the_ten_tasks_takes_ten_lines() -> None:
    tasks = [code for language, code in blocks(DOCS / "ten-tasks.md") if language == "python"]
    assert len(tasks) == 10
    for code in tasks:
        lines = [line for line in code.splitlines() if line.strip()]
        assert len(lines) <= 10, code
        assert max(len(line) for line in lines) <= 100, code
        alone: dict[str, Any] = {}
        exec(compile("\n".join(x for x in lines if "import " in x), "imports", "exec"), alone)
        assert "so" in alone, code  # each can be copied as it stands


def documented(page: str) -> Iterator[str]:
    """Full names that a page of the reference lists."""
    for kind, name, options in DIRECTIVE.findall((DOCS / "api" / page).read_text("utf-8")):
        if kind != "automodule":
            yield name
            continue
        module = importlib.import_module(name)
        assert ":members:" in options
        excluded = re.findall(r":exclude-members: (.*)", options)
        left_out = set(re.split(r",\s*", excluded[0])) if excluded else set()
        yield from (f"{name}.{member}" for member in public(module) if member not in left_out)


def public(module: Any) -> list[str]:
    own = getattr(module, "__all__", None)
    if own is not None:
        return list(own)
    return [
        name
        for name, value in getmembers(module, isfunction)
        if value.__module__ == module.__name__ and not name.startswith("_")
    ]


def named(full: str) -> Any:
    """The object of a full name, which must be there."""
    home, name = full.rsplit(".", 1)
    return getattr(importlib.import_module(home), name)


REFERENCE = {page.name: sorted(documented(page.name)) for page in (DOCS / "api").glob("*.md")}


@pytest.mark.parametrize("page", REFERENCE)
def test_every_name_of_the_reference_is_there(page: str) -> None:
    for full in REFERENCE[page]:
        assert named(full) is not None, full


@pytest.mark.parametrize(
    "module",
    [
        "standoff",
        *("standoff.automaton", "standoff.bodies", "standoff.bodies.shapes", "standoff.control"),
        *("standoff.geometry", "standoff.impact", "standoff.motion", "standoff.points"),
        *("standoff.recording", "standoff.scene", "standoff.simulation", "standoff.tracking"),
        *("standoff.voronoi", "standoff.jax", "standoff.casadi", "standoff.view"),
    ],
)
def test_every_public_name_is_in_the_reference(module: str) -> None:
    """By any of the names by which a reader may come to it."""
    listed = {id(named(full)) for names in REFERENCE.values() for full in names}
    elsewhere = {"shapes", "feedback"}  # modules, with a page and a section of their own
    names = set(public(importlib.import_module(module))) - elsewhere
    assert not {name for name in names if id(named(f"{module}.{name}")) not in listed}


def test_the_first_page_lists_every_page_once() -> None:
    index = (DOCS / "index.md").read_text("utf-8")
    trees = re.findall(r"^```\{toctree\}\n(.*?)^```$", index, re.DOTALL | re.MULTILINE)
    pages = [line for tree in trees for line in tree.splitlines() if line and line[0] != ":"]
    linked = re.findall(r"\]\(([\w/-]+)\.md\)", index)
    assert sorted(linked) == sorted(pages)
    own = {file.stem for file in DOCS.glob("*.md")} - {"index"}
    assert own <= set(pages)


def test_every_public_object_says_what_it_is() -> None:
    for name in so.__all__:
        doc = getattr(so, name).__doc__
        assert doc, name
        assert not doc.startswith(f"{name}("), f"{name} has no docstring of its own"
