"""How far a command has come, where stderr is no terminal: a line now and then."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pytest

from families import paper_figures as fakes
from standoff.cli.progress import progress_bar
from standoff.kernels.compiler import notices
from standoff_studies.paper.progress import figures_bar
from waiting import until

Lines = Callable[[], list[str]]


@pytest.fixture
def lines(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Lines:
    """The lines on stderr, said every 0.2 s."""
    monkeypatch.setattr(notices, "PERIOD", 0.2)
    monkeypatch.delenv(notices.QUIET, raising=False)
    return lambda: capsys.readouterr().err.splitlines()


@contextmanager
def a_while() -> Iterator[None]:
    """Until a line is said, or half a second where none ever is."""
    said = notices._spoken
    yield
    if notices.quiet():
        time.sleep(0.5)
    else:
        until(lambda: notices._spoken > said)


def rounded(lines: list[str]) -> list[str]:
    """On a busy machine half a second is one or two."""
    return [re.sub(r"\d+ s so", "0 s so", line) for line in lines]


def test_a_line_says_how_far_it_has_come(lines: Lines) -> None:
    with progress_bar("drawing the film") as show, a_while():
        for done in range(41):
            show(done, 300)
    assert rounded(lines())[-1] == "standoff: drawing the film: 40 of 300 done, 0 s so far ..."
    time.sleep(0.3)
    assert lines() == []


def test_what_is_over_at_once_says_nothing(lines: Lines) -> None:
    with progress_bar() as show:
        show(1, 1)
    assert lines() == []


def test_it_can_be_silenced(lines: Lines, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(notices.QUIET, "1")
    with progress_bar(), a_while():
        pass
    assert lines() == []


def test_the_figures_at_work_are_named_and_those_done_counted(lines: Lines) -> None:
    with figures_bar(31) as tell, a_while():
        tell(fakes.GOOD, None)
        tell(fakes.MOVING, None)
        tell(fakes.GOOD, object())
        tell(fakes.FAILING, None)
    assert rounded(lines())[-1] == (
        "standoff: making figures 12 and 13: 1 of 31 done, 0 s so far ..."
    )
