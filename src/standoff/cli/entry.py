"""From the arguments to an exit code: everything that ends a command passes here."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

from standoff import __version__
from standoff.cli.errors import CommandError, ExitCode, MissingExtra, WriteError
from standoff.cli.terminal import tell


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command.

    Parameters
    ----------
    arguments : sequence of str, optional
        In place of the process's own.

    Returns
    -------
    int
        An `ExitCode`. Bad input ends in one message on stderr, without a traceback.
    """
    given = list(sys.argv[1:] if arguments is None else arguments)
    if given == ["--version"]:
        tell(f"standoff {__version__}")
        return ExitCode.DONE
    try:
        return _run(given)
    except SystemExit as end:
        # tyro leaves this way after help (0) and after a complaint of its own (2).
        return end.code if isinstance(end.code, int) else ExitCode.BAD_INPUT
    except KeyboardInterrupt:
        return _complain("interrupted; nothing was written", ExitCode.INTERRUPTED)
    except BrokenPipeError:
        # The reader of our output, such as `head`, went away. Python would complain once more
        # when it flushes stdout at the end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return ExitCode.NOT_WRITTEN


def _run(given: list[str]) -> int:
    try:
        import rich  # noqa: F401
        import tyro  # noqa: F401
    except ModuleNotFoundError as error:
        return _complain(str(MissingExtra(str(error.name))), ExitCode.BAD_INPUT)
    from standoff.cli.arguments import parse

    try:
        command = parse(given or ["--help"])
    except CommandError as error:
        return _complain(str(error), ExitCode.BAD_INPUT)

    # The library comes after the parse, so that help and typing errors need not wait for it, and
    # after a word to those who do.
    from standoff.cli.announcement import announce

    announce(command)
    from standoff.cli.commands import run
    from standoff.scene import SceneError

    try:
        return run(command)
    except (CommandError, SceneError) as error:
        return _complain(str(error), ExitCode.BAD_INPUT)
    except WriteError as error:
        return _complain(str(error), ExitCode.NOT_WRITTEN)


def _complain(message: str, code: ExitCode) -> int:
    tell(f"standoff: {message}", error=True)
    return code
