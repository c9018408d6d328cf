"""Where the tests' random numbers come from."""

from pathlib import Path

import numpy as np
import pytest

import draws

TESTS = Path(__file__).parent


def test_no_test_draws_without_a_seed() -> None:
    """A generator without one would draw anew in every run: tests take the fixture `rng`."""
    without = "default_rng" + "()"
    assert [p.name for p in TESTS.rglob("*.py") if without in p.read_text()] == []


@pytest.mark.parametrize("number", [0, 1])
def test_a_test_s_draws_follow_from_its_name(number, rng, rng_of, request) -> None:
    first = rng.random(4)
    np.testing.assert_array_equal(first, rng_of(request.node.nodeid).random(4))
    assert (first != rng_of("another name").random(4)).all()


def test_draws_are_multiplied(monkeypatch) -> None:
    monkeypatch.setattr(draws, "FACTOR", 2.5)
    assert (draws.draws(10), draws.draws(1)) == (25, 2)
    monkeypatch.setattr(draws, "FACTOR", 0.01)
    assert draws.draws(10) == 1
