"""Processes of `standoff paper` and `standoff soak` find the kernels compiled, and are quiet."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numba
import pytest

from standoff.kernels.compiler import cache
from standoff.kernels.compiler.decorators import entry
from standoff.kernels.compiler.entry import REAL
from standoff.kernels.compiler.notices import QUIET
from standoff.kernels.entries.preparing import prepare_named
from standoff.kernels.entries.queries import curve_jet
from standoff_studies.paper import processes as paper
from standoff_studies.soak import processes as soak
from standoff_studies.soak.ledger import Ledger

ORDER = paper.Order(Path(), False)

WORKERS: list[tuple[ModuleType, Callable[[Any], None]]] = [
    (paper, lambda pipe: paper._work(pipe, ORDER)),
    (soak, lambda pipe: soak._work(pipe, 0, 1, multiprocessing.Value("q", 0, lock=False))),
]


def twice(x):  # type: ignore[no-untyped-def]
    return 2.0 * x


class Started(Exception):
    """In place of a process."""


def test_the_parent_compiles_before_it_starts_the_soak_s(monkeypatch: pytest.MonkeyPatch) -> None:
    compiled = []

    def start(*_: object) -> None:
        assert compiled
        raise Started

    monkeypatch.setattr(soak, "prepare_all", lambda: compiled.append(True))
    monkeypatch.setattr(soak, "_Worker", start)
    with pytest.raises(Started):
        soak.soak(Ledger(0, 1), 2, 2, lambda done: None)


def asked(pipe: Any) -> list[object]:
    """What a worker of the paper's figures asks for; each is answered."""
    words = []
    while not isinstance(word := pipe.recv(), str):
        words.append(word)
        pipe.send(word)
    return words


def test_the_paper_s_have_the_parent_compile_what_they_call_and_no_more(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))
    made = entry(REAL, work="runs")(twice)
    near, far = multiprocessing.Pipe()
    monkeypatch.setattr(cache, "compiled_elsewhere", paper.asking(near))
    answering = threading.Thread(target=lambda: words.extend(asked(far)))
    words: list[object] = []
    answering.start()
    assert made(2.0) == 4.0
    assert made(3.0) == 6.0
    near.send("done")
    answering.join()
    assert words == [paper.Needed(__name__, "twice")]


def test_the_parent_compiles_what_a_worker_needs(monkeypatch: pytest.MonkeyPatch) -> None:
    prepared = []
    monkeypatch.setattr(paper, "prepare_named", lambda *named: prepared.append(named))
    pipe, other = multiprocessing.Pipe()
    needed = paper.Needed("standoff.kernels.entries.queries", "on_face")
    other.send(needed)
    assert paper._receive(SimpleNamespace(pipe=pipe), lambda *_: None) is None  # type: ignore[arg-type]
    assert prepared == [needed]
    assert other.recv() == needed


def test_an_entry_is_prepared_by_its_name() -> None:
    for name in ("curve_jet", "not_there", "pointer"):  # an entry, nothing, and no entry
        prepare_named("standoff.kernels.entries.queries", name)
    assert curve_jet.ready


@pytest.mark.parametrize(("module", "work"), WORKERS, ids=("paper", "soak"))
def test_they_leave_it_to_the_parent_to_tell_of_the_compiler(
    module: ModuleType, work: Callable[[Any], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(QUIET, "0")
    monkeypatch.setattr(signal, "signal", lambda *_: None)
    monkeypatch.setattr(threading.Thread, "start", lambda self: None)
    monkeypatch.setattr(soak, "compile_kernels", lambda: None)
    monkeypatch.setattr(cache, "compiled_elsewhere", None)  # put back afterwards
    pipe, other = multiprocessing.Pipe()
    other.close()
    work(pipe)  # there is nobody who gives it anything to do
    assert os.environ[QUIET] == "1"
