"""The tests of `make check`: every file is there, and every part of the library has some."""

from pathlib import Path

import pytest

from tiers import FAST

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


def test_every_file_is_there_once() -> None:
    assert [name for name in FAST if not (TESTS / name).is_file()] == []
    assert len(set(FAST)) == len(FAST)


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
