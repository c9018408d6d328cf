"""How an entry is prepared."""

from __future__ import annotations

import gc
from collections.abc import Iterator

import numpy as np
import pytest

from standoff.kernels.compiler.entry import REAL, ROWS, Entry, WrongKind


def doubled(x: float) -> float:
    return 2.0 * x


@pytest.fixture(params=[True, False], ids=["collecting", "not collecting"])
def collecting(request: pytest.FixtureRequest) -> Iterator[bool]:
    was_enabled = gc.isenabled()
    (gc.enable if request.param else gc.disable)()
    yield request.param
    (gc.enable if was_enabled else gc.disable)()


@pytest.mark.parametrize("failing", [False, True])
def test_garbage_is_collected_as_before_once_an_entry_is_compiled(
    monkeypatch: pytest.MonkeyPatch, collecting: bool, failing: bool
) -> None:
    seen = []

    def compiled(self: Entry, signature: object) -> None:
        seen.append(gc.isenabled())
        if failing:
            raise MemoryError

    monkeypatch.setattr(Entry, "compile", compiled)
    monkeypatch.setattr(Entry, "disable_compile", lambda self: None)
    entry = Entry(doubled, {"nopython": True}, (REAL,), "query")
    if failing:
        with pytest.raises(MemoryError):
            entry.prepare()
    else:
        entry.prepare()
    assert seen == [False]
    assert gc.isenabled() == collecting


@pytest.mark.parametrize("terse", [True, False])
def test_the_first_call_of_a_terse_entry_says_wrong_kind_as_later_ones_do(
    monkeypatch: pytest.MonkeyPatch, terse: bool
) -> None:
    """The first query of a program may be of a matrix that is read-only, such as JAX's."""
    entry = Entry(doubled, {"nopython": True}, (ROWS,), "query", terse)
    monkeypatch.setattr(entry, "prepare", lambda: None)
    matrix = np.eye(4)
    matrix.flags.writeable = False
    with pytest.raises(TypeError) as caught:
        entry(matrix)
    assert isinstance(caught.value, WrongKind) == terse
