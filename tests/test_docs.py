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


@pytest.mark.parametrize(
    ("page", "module"),
    [
        ("standoff.md", "standoff"),
        ("control.md", "standoff.control"),
        ("geometry.md", "standoff.geometry"),
        ("motion.md", "standoff.motion"),
        ("scene.md", "standoff.scene"),
        ("shapes.md", "standoff.bodies.shapes"),
    ],
)
def test_every_public_name_is_in_the_reference(page: str, module: str) -> None:
    listed = set(documented(page))
    elsewhere = {"standoff.shapes", "standoff.motion.Pose", "standoff.motion.Twist"}
    elsewhere |= {"standoff.control.min_gain", "standoff.feedback"}
    missing = {f"{module}.{name}" for name in public(importlib.import_module(module))}
    assert not missing - listed - elsewhere


def test_every_public_object_says_what_it_is() -> None:
    for name in so.__all__:
        doc = getattr(so, name).__doc__
        assert doc, name
        assert not doc.startswith(f"{name}("), f"{name} has no docstring of its own"
