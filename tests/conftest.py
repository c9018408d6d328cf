"""Settings shared by all tests: where their random draws come from.

Tests draw from the fixture `rng`, or by Hypothesis. What they get follows from the test's own name
and a base, STANDOFF_SEED (0), so a test draws the same in every run and in any order.
STANDOFF_FRESH=1 takes a new base, and a failure tells it. STANDOFF_DRAWS=10 draws ten times as many
cases (`draws.py`).
"""

import gc
import hashlib
import os
import secrets
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

# Before NumPy is loaded, which reads them once: the tests are many processes of small matrices.
for threads in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(threads, "1")
# Parts are made, not found: tests of the store name one of their own.
os.environ["STANDOFF_CACHE_SIZE"] = "0"

import hypothesis
import numpy as np
import pytest
from xdist.scheduler import LoadFileScheduling

from draws import draws
from tiers import FAST, LONG, TOGETHER

FRESH = os.environ.get("STANDOFF_FRESH", "0") not in ("", "0")
BASE = int(os.environ.get("STANDOFF_SEED") or (secrets.randbelow(1 << 32) if FRESH else 0))

# The first call of a compiled function takes seconds, so no example has a deadline.
hypothesis.settings.register_profile(
    "standoff",
    max_examples=draws(40),
    deadline=None,
    derandomize=True,
    print_blob=True,
    database=None,
)
hypothesis.settings.load_profile("standoff")


def stream(name: str) -> np.random.Generator:
    """Return the generator of a name, under the base of this run."""
    digest = hashlib.sha256(f"{BASE} {name} 0".encode()).digest()
    return np.random.default_rng(int.from_bytes(digest[:16], "little"))


@pytest.fixture
def rng(request: pytest.FixtureRequest) -> np.random.Generator:
    """A generator of the test's own, which follows from its name."""
    return stream(request.node.nodeid)


@pytest.fixture(scope="session")
def rng_of() -> Callable[[str], np.random.Generator]:
    """A generator by any name, for fixtures that outlive the test that asks first."""
    return stream


TESTS = Path(__file__).parent
QUICKLY = "not slow"
SOAK = "soak"
"""Marks what `make soak` alone runs: `-m` has to name it."""


def is_fast(path: Path) -> bool:
    return path.is_relative_to(TESTS) and path.relative_to(TESTS).as_posix() in FAST


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """`-m "not slow"` does not even import the others: that alone takes half a minute."""
    others = collection_path.suffix == ".py" and not is_fast(collection_path)
    return True if config.option.markexpr == QUICKLY and others else None


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if SOAK not in config.option.markexpr:
        longer = [item for item in items if item.get_closest_marker(SOAK)]
        config.hook.pytest_deselected(items=longer)
        items[:] = [item for item in items if not item.get_closest_marker(SOAK)]
    items.sort(key=lambda item: place(item.nodeid))
    drawn = set()
    for item in items:
        if not is_fast(item.path):
            item.add_marker("slow")
        test = getattr(item, "obj", None)
        # once a function: its parametrised items share it
        if hypothesis.is_hypothesis_test(test) and test not in drawn:
            drawn.add(test)
            hypothesis.seed(BASE)(test)


SELDOM = 20_000
"""Objects made between two rounds of the garbage collector; Python's own is 700."""


def keep_what_is_there() -> None:
    """Take all objects that live now out of the garbage collector's rounds.

    A process that has collected all tests holds millions of objects that stay, and each full round
    would go through them. Rounds through what is young begin seldom, too: tests make many small
    objects that live long.
    """
    gc.collect()
    gc.freeze()
    gc.set_threshold(SELDOM)


def pytest_collection_finish() -> None:
    keep_what_is_there()


@pytest.fixture(scope="module")
def quick_collections() -> None:
    """For tests of timings, which collect garbage before each of them."""
    keep_what_is_there()


def place(nodeid: str) -> int:
    """Where a test's file stands among those that take long; behind them all if it is none."""
    file = nodeid.partition("::")[0].removeprefix(f"{TESTS.name}/")
    return LONG.index(file) if file in LONG else len(LONG)


class ByFile(LoadFileScheduling):  # type: ignore[misc]
    """A file in one process, as by `--dist loadfile`, and those that share what takes long, too.

    Where the longest came last, one core would wait for it.
    """

    def _split_scope(self, nodeid: str) -> str:
        file = nodeid.partition("::")[0]
        name = file.removeprefix(f"{TESTS.name}/")
        return next((group[0] for group in TOGETHER if name in group), file)


def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> ByFile | None:
    if config.option.dist != "loadfile":
        return None
    config.option.loadscopereorder = False  # it puts files of many tests first, not the long ones
    return ByFile(config, log)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Iterator[None]:
    report = yield
    if report.failed:
        report.sections.append(("random draws", f"set STANDOFF_SEED={BASE} to draw the same"))
    return report
