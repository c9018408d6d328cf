"""The program of docs/c-interface.md: built as the page says, it prints what the page shows."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples" / "c"
PAGE = ROOT / "docs" / "c-interface.md"


def test_the_probe_prints_what_the_page_shows(program: Callable[..., Path], tmp_path: Path) -> None:
    subprocess.run([sys.executable, EXAMPLE / "save_pair.py"], cwd=tmp_path, check=True)
    made = program(EXAMPLE / "probe.c")
    told = subprocess.run([made], cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    assert f"./probe\n{told}```" in PAGE.read_text()
    assert "box edge 7" in told


def test_without_a_pair_it_says_so(program: Callable[..., Path], tmp_path: Path) -> None:
    ended = subprocess.run(
        [program(EXAMPLE / "probe.c")], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert ended.returncode == 1
    assert ended.stderr == "standoff: the file cannot be opened or read\n"


def test_the_page_shows_what_python_saves() -> None:
    code = (EXAMPLE / "save_pair.py").read_text().split('"""\n\n', 1)[1]
    assert code in PAGE.read_text()
