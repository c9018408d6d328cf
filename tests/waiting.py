"""How tests wait: for what they assert, however slow the machine is, never for a time."""

import time
from collections.abc import Callable

LONG = 300.0
"""Seconds after which something will not come about: kernels may have to be compiled meanwhile, on
a machine that does other work."""
LOOK = 1e-3
"""Seconds between two looks."""


def happens(holds: Callable[[], object], seconds: float) -> bool:
    """Does something come about within some time?"""
    end = time.monotonic() + seconds
    while not holds():
        if time.monotonic() > end:
            return False
        time.sleep(LOOK)
    return True


def until(holds: Callable[[], object]) -> None:
    """Wait until something holds; fail after `LONG`."""
    assert happens(holds, LONG), "it did not come about"
