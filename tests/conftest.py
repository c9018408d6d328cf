"""Settings shared by all tests: where their random draws come from.

Tests draw by `np.random.default_rng()` without a seed, or by Hypothesis. What they get follows from
the test's own name and a base, STANDOFF_SEED (0), so a test draws the same in every run and in any
order. STANDOFF_FRESH=1 takes a new base, and a failure tells it.
"""

import hashlib
import itertools
import os
import secrets
import sys
from collections.abc import Iterator

import hypothesis
import numpy as np
import pytest

FRESH = os.environ.get("STANDOFF_FRESH", "0") not in ("", "0")
BASE = int(os.environ.get("STANDOFF_SEED") or (secrets.randbelow(1 << 32) if FRESH else 0))

# The first call of a compiled function takes seconds, so no example has a deadline.
hypothesis.settings.register_profile(
    "standoff", deadline=None, derandomize=True, print_blob=True, database=None
)
hypothesis.settings.load_profile("standoff")

seeded_rng = np.random.default_rng


class Draws:
    """The name that draws are made from, None outside of tests, and how many were made."""

    name: str | None = None
    numbers = itertools.count()

    @classmethod
    def start(cls, name: str | None) -> None:
        cls.name, cls.numbers = name, itertools.count()


def named_rng(seed: object = None) -> np.random.Generator:
    """`numpy.random.default_rng`; without a seed it is drawn from the running test's name."""
    if seed is not None:
        return seeded_rng(seed)  # type: ignore[arg-type]
    # while a module is imported it is the module that draws
    name = Draws.name or str(sys._getframe(1).f_globals.get("__name__"))
    digest = hashlib.sha256(f"{BASE} {name} {next(Draws.numbers)}".encode()).digest()
    return seeded_rng(int.from_bytes(digest[:16], "little"))


# Here, not in a fixture: modules may draw while they are collected.
np.random.default_rng = named_rng


def pytest_collectstart() -> None:
    Draws.start(None)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    drawn = set()
    for item in items:
        test = getattr(item, "obj", None)
        # once a function: its parametrised items share it
        if hypothesis.is_hypothesis_test(test) and test not in drawn:
            drawn.add(test)
            hypothesis.seed(BASE)(test)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    Draws.start(item.nodeid)
    try:
        return (yield)
    finally:
        Draws.start(None)


@pytest.hookimpl(wrapper=True)
def pytest_fixture_setup(fixturedef: pytest.FixtureDef, request: pytest.FixtureRequest):
    """A fixture draws by its own name: it may outlive the test that asks first."""
    name, numbers = Draws.name, Draws.numbers
    Draws.start(f"{request.node.nodeid} {fixturedef.argname}")
    try:
        return (yield)
    finally:
        Draws.name, Draws.numbers = name, numbers


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Iterator[None]:
    report = yield
    if report.failed:
        report.sections.append(("random draws", f"set STANDOFF_SEED={BASE} to draw the same"))
    return report
