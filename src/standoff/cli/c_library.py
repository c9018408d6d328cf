"""``standoff c-library``: the shared library for programs in C, and its header."""

from __future__ import annotations

import time

from standoff.c_interface import build_library
from standoff.c_interface.library import link_command
from standoff.cli.arguments import LibraryCommand
from standoff.cli.errors import CommandError, ExitCode, WriteError
from standoff.cli.facts import json_text
from standoff.cli.progress import progress_bar
from standoff.cli.terminal import tell
from standoff.errors import StandoffError


def run_c_library(command: LibraryCommand) -> int:
    """Build the library into a folder and say where it is.

    Raises CommandError if there is no compiler, or it fails. Raises WriteError if the files could
    not be written.
    """
    started = time.perf_counter()
    try:
        command.folder.mkdir(parents=True, exist_ok=True)
        with progress_bar("compiling the library's parts") as progress:
            library, header = build_library(
                command.folder, processor=command.processor, progress=progress
            )
    except StandoffError as error:
        raise CommandError(str(error)) from error
    except OSError as error:
        raise WriteError(str(error)) from error
    if command.json:
        tell(json_text({"library": str(library), "header": str(header)}))
        return ExitCode.DONE
    tell(f"{library} and {header}, built in {time.perf_counter() - started:.0f} s")
    tell(f"compile a program with: {link_command(command.folder)}")
    return ExitCode.DONE
