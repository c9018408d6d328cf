"""What ends a command early, and the exit codes."""

from __future__ import annotations

from enum import IntEnum

from standoff.errors import StandoffError, not_installed


class ExitCode(IntEnum):
    """What the shell gets back."""

    DONE = 0
    NOT_WRITTEN = 1  # the results could not be written, as on a full disk
    BAD_INPUT = 2
    NOT_CERTIFIED = 3
    NOT_COMPILED = 3  # the same for `warmup`: a kernel is refused by the compiler
    FAILED = 3  # the same for an added command: finished, but not all is as it should be
    INTERRUPTED = 130  # 128 + SIGINT, the shells' convention


class CommandError(StandoffError):
    """A command that cannot run as it was given; the message names the value and the fix."""


class MissingExtra(CommandError):
    """A library is missing that comes with an extra of this package."""

    def __init__(self, library: str, extra: str = "cli") -> None:
        super().__init__(not_installed(library, extra))


class WriteError(Exception):
    """Results that could not be written although the input was good."""
