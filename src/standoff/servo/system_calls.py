"""What a servo loop needs of the operating system: two functions' addresses, its scheduler."""

from __future__ import annotations

import ctypes
import os
import sys
import time
from typing import Final, NamedTuple

from standoff.errors import StandoffError

PRIORITY: Final = 50
"""Of SCHED_FIFO, 1 to 99: half way, above the threads that use interrupts, below those that serve
them."""

TIMER_SLACK: Final = 29
"""Linux's PR_SET_TIMERSLACK."""

LOCK_ALL: Final = 3
"""MCL_CURRENT and MCL_FUTURE."""


class Clocks(NamedTuple):
    """Addresses of clock_gettime and clock_nanosleep, and the numbers of two clocks."""

    gettime: int
    nanosleep: int
    monotonic: int
    boot: int


def clocks() -> Clocks:
    """Return what the compiled loop waits with.

    Raises StandoffError: the system has no clock_nanosleep.
    """
    try:
        libc = ctypes.CDLL(None)
        found = [
            ctypes.cast(getattr(libc, name), ctypes.c_void_p).value or 0
            for name in ("clock_gettime", "clock_nanosleep")
        ]
        boot = time.CLOCK_BOOTTIME
    except (AttributeError, OSError, TypeError) as error:
        raise StandoffError(
            "A servo needs clock_nanosleep and CLOCK_BOOTTIME, which Linux has and "
            f"{sys.platform} does not ({error}): run it on Linux. Simulations run everywhere."
        ) from error
    return Clocks(found[0], found[1], time.CLOCK_MONOTONIC, boot)


def ask_for_real_time() -> list[str]:
    """Give the calling thread a real-time priority and lock all memory, where that is allowed.

    Returns
    -------
    list of str
        What was refused, and what to do; empty if all was granted.
    """
    notes = []
    libc = ctypes.CDLL(None, use_errno=True)
    libc.prctl(TIMER_SLACK, 1, 0, 0, 0)
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
    except OSError as error:
        notes.append(
            f"no real-time priority ({error.strerror}): other programs can hold the loop up; "
            "allow it with `ulimit -r 50`, or rtprio in /etc/security/limits.conf"
        )
    if libc.mlockall(LOCK_ALL) != 0:
        reason = os.strerror(ctypes.get_errno())
        notes.append(
            f"memory is not locked ({reason}): a page swapped out to disk can hold the loop up; "
            "allow it with `ulimit -l unlimited`, or memlock in /etc/security/limits.conf"
        )
    return notes


def unlock_memory() -> None:
    """Undo the locking of memory."""
    ctypes.CDLL(None).munlockall()
