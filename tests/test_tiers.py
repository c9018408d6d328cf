"""The tests of `make check`, `make test` and `make soak`: which files, and in which order."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from tiers import FAST, LONG, TOGETHER

TESTS = Path(__file__).parent
PARTS = (
    "bodies",
    "cli",
    "control",
    "geometry",
    "kernels",
    "motion",
    "recording",
    "scene",
    "tracking",
)


@pytest.mark.parametrize("names", [FAST, LONG, sum(TOGETHER, ())], ids=["fast", "long", "together"])
def test_every_file_is_there_once(names: tuple[str, ...]) -> None:
    assert [name for name in names if not (TESTS / name).is_file()] == []
    assert len(set(names)) == len(names)


@pytest.mark.parametrize("part", PARTS)
def test_every_part_has_fast_tests(part: str) -> None:
    assert any(name.startswith(f"{part}/") for name in FAST)


def test_the_others_are_slow(request: pytest.FixtureRequest) -> None:
    """This file is named; the marks of a whole run follow from the same list."""
    marks = {
        item.path.relative_to(TESTS).as_posix(): item.get_closest_marker("slow") is not None
        for item in request.session.items
        if item.path.is_relative_to(TESTS)
    }
    assert not marks["test_tiers.py"]
    assert all(slow is (name not in FAST) for name, slow in marks.items())


class Item:
    """A test as it is collected."""

    obj = None

    def __init__(self, file: str, *marks: str) -> None:
        self.path, self.nodeid, self.marks = TESTS / file, f"tests/{file}::test_it", {*marks}

    def get_closest_marker(self, name: str) -> bool | None:
        return name in self.marks or None

    def add_marker(self, name: str) -> None:
        self.marks.add(name)


@pytest.fixture
def collected(request: pytest.FixtureRequest) -> Any:
    """The items that are left of some by an expression of marks, in their order."""
    here = request.config.pluginmanager.get_plugin(str(TESTS / "conftest.py"))
    assert here is not None

    def left(expression: str, *items: Item) -> tuple[list[Item], list[Item]]:
        out: list[Item] = []
        hook = SimpleNamespace(pytest_deselected=lambda items: out.extend(items))
        config = SimpleNamespace(option=SimpleNamespace(markexpr=expression), hook=hook)
        kept = list(items)
        here.pytest_collection_modifyitems(config, kept)
        return kept, out

    return left


def test_what_only_draws_more_runs_where_it_is_asked_for(collected: Any) -> None:
    plain, more = Item("test_errors.py"), Item("test_errors.py", "soak")
    for expression in ("", "not slow"):
        assert collected(expression, plain, more) == ([plain], [more])
    # Pytest itself leaves out what the expression does not ask for
    assert collected("soak", plain, more) == ([plain, more], [])


def test_long_files_begin_first(collected: Any) -> None:
    names = ["test_errors.py", LONG[1], "test_limits.py", LONG[0]]
    kept, _ = collected("", *map(Item, names))
    found = [item.path.relative_to(TESTS).as_posix() for item in kept]
    assert found == [LONG[0], LONG[1], "test_errors.py", "test_limits.py"]


def test_files_that_share_what_takes_long_are_one_piece_of_work(
    request: pytest.FixtureRequest,
) -> None:
    here = request.config.pluginmanager.get_plugin(str(TESTS / "conftest.py"))
    assert here is not None

    def pieces(names: tuple[str, ...]) -> list[str]:
        return [here.ByFile._split_scope(None, f"tests/{name}::test_it") for name in names]

    together = [{*pieces(group)} for group in TOGETHER]
    assert all(len(group) == 1 for group in together)
    assert len(set.union(*together)) == len(TOGETHER)
    assert pieces(FAST) == [f"tests/{name}" for name in FAST]
