"""Functions and files stay small enough to be read at once; ruff holds arguments and branches."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOURCES = (ROOT / "src", ROOT / "studies" / "src")
LONGEST_FUNCTION = 60
"""Lines, without the docstring."""
LONGEST_FILE = 800
FILES = sorted(file for source in SOURCES for file in source.rglob("*.py"))


def long_functions(text: str) -> list[str]:
    """The functions of a module that are too long, with their lengths."""
    found = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            said = ast.get_docstring(node, clean=False)
            lines = node.end_lineno - node.lineno + 1 - (said.count("\n") + 1 if said else 0)
            if lines > LONGEST_FUNCTION:
                found.append(f"{node.name}: {lines} lines")
    return found


def test_there_are_files():
    assert len(FILES) > 200


@pytest.mark.parametrize("file", FILES, ids=lambda file: str(file.relative_to(ROOT)))
def test_limits(file):
    text = file.read_text(encoding="utf-8")
    assert text.count("\n") <= LONGEST_FILE
    assert long_functions(text) == []


def test_a_long_function_is_found():
    body = "    x = 1\n" * (LONGEST_FUNCTION + 1)
    assert long_functions(f"def f():\n{body}") == ["f: 62 lines"]
    assert long_functions(f'def f():\n    """A\n    B."""\n{body[:-20]}') == []
