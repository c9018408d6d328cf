"""Processes of `standoff paper` and `standoff soak` find the kernels compiled, and are quiet."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from families import paper_figures as fakes
from standoff.kernels.compiler.notices import QUIET
from standoff_studies.paper import processes as paper
from standoff_studies.soak import processes as soak
from standoff_studies.soak.ledger import Ledger

ORDER = paper.Order(Path(), False)

RUNS: list[tuple[ModuleType, Callable[[], object]]] = [
    (paper, lambda: paper.make_all((fakes.GOOD, fakes.MOVING), ORDER, 2, lambda *_: None)),
    (soak, lambda: soak.soak(Ledger(0, 1), 2, 2, lambda done: None)),
]

WORKERS: list[tuple[ModuleType, Callable[[Any], None]]] = [
    (paper, lambda pipe: paper._work(pipe, ORDER)),
    (soak, lambda pipe: soak._work(pipe, 0, 1, multiprocessing.Value("q", 0, lock=False))),
]


class Started(Exception):
    """In place of a process."""


@pytest.mark.parametrize(("module", "run"), RUNS, ids=("paper", "soak"))
def test_the_parent_compiles_before_it_starts_them(
    module: ModuleType, run: Callable[[], object], monkeypatch: pytest.MonkeyPatch
) -> None:
    compiled = []

    def start(*_: object) -> None:
        assert compiled
        raise Started

    monkeypatch.setattr(module, "prepare_all", lambda: compiled.append(True))
    monkeypatch.setattr(module, "_Worker", start)
    with pytest.raises(Started):
        run()


@pytest.mark.parametrize(("module", "work"), WORKERS, ids=("paper", "soak"))
def test_they_leave_it_to_the_parent_to_tell_of_the_compiler(
    module: ModuleType, work: Callable[[Any], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(QUIET, "0")
    monkeypatch.setattr(signal, "signal", lambda *_: None)
    monkeypatch.setattr(threading.Thread, "start", lambda self: None)
    monkeypatch.setattr(soak, "compile_kernels", lambda: None)
    pipe, other = multiprocessing.Pipe()
    other.close()
    work(pipe)  # there is nobody who gives it anything to do
    assert os.environ[QUIET] == "1"
