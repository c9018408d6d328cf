"""`standoff c-library`: where it writes, and what it says where there is no compiler."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from standoff.cli import c_library

Standoff = Callable[..., Any]


def built(
    folder: Path, processor: str | None, progress: Callable[[int, int], None]
) -> tuple[Path, Path]:
    progress(1, 2)
    (folder / "processor").write_text(str(processor))
    return folder / "libstandoff.so", folder / "standoff.h"


def test_it_makes_the_folder_and_tells_the_files(
    standoff: Standoff, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(c_library, "build_library", built)
    folder = tmp_path / "a" / "b"
    ended = standoff("c-library", str(folder))
    assert (ended.code, ended.err) == (0, "")
    assert f"-I{folder} -L{folder} -lstandoff" in ended.out
    ended = standoff("c-library", str(folder), "--processor", "x86-64-v3", "--json")
    assert json.loads(ended.out) == {
        "library": str(folder / "libstandoff.so"),
        "header": str(folder / "standoff.h"),
    }
    assert (folder / "processor").read_text() == "x86-64-v3"


def test_no_compiler_is_bad_input(
    standoff: Standoff, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CC", "no-such-cc")
    ended = standoff("c-library", str(tmp_path))
    assert (ended.code, ended.out) == (2, "")
    assert "no C compiler 'no-such-cc'" in ended.err
