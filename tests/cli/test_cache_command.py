"""`standoff cache`: where finished parts are, how large, and their removal."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from standoff.cad import store


@pytest.fixture
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv(store.FOLDER, str(tmp_path / "store"))
    monkeypatch.setenv(store.SIZE, "3")
    store.put("1", bytes(200_000))
    store.put("2", bytes(300_000))
    return tmp_path / "store"


def test_what_is_kept_is_told_and_removed(standoff: Any, kept: Path) -> None:
    ended = standoff("cache")
    told = f"finished parts: 2 files, 0.5 MB, of at most 3 MB, in {kept}\n"
    assert (ended.code, ended.out, ended.err) == (0, told, "")
    (kept / "other.txt").write_text("not of the store")
    ended = standoff("cache", "--clear")
    assert ended.out.startswith("removed 2 files\nfinished parts: 0 files, 0.0 MB")
    assert [path.name for path in kept.iterdir()] == ["other.txt"]
    facts = json.loads(standoff("cache", "--json").out)
    assert (facts["folder"], facts["files"], facts["bytes"]) == (str(kept), 0, 0)
    assert facts["most_bytes"] == 3_000_000


def test_a_store_that_is_off_or_misnamed(
    standoff: Any, kept: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(store.SIZE, "0")
    assert "not used, as STANDOFF_CACHE_SIZE is 0" in standoff("cache").out
    monkeypatch.setenv(store.SIZE, "2 GB")
    ended = standoff("cache")
    assert (ended.code, ended.out) == (2, "")
    assert "STANDOFF_CACHE_SIZE = '2 GB': give a number of megabytes" in ended.err
    monkeypatch.setenv(store.FOLDER, str(kept / "missing"))
    monkeypatch.setenv(store.SIZE, "1")
    assert "0 files" in standoff("cache").out
    assert not (kept / "missing").exists()


def test_a_file_that_can_t_be_removed(
    standoff: Any, kept: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "unlink", refuse)
    ended = standoff("cache", "--clear")
    assert ended.code == 1
    assert "not all was removed" in ended.err
