"""What the options of ``standoff clearance`` ask: of a scene, or of an assembly in its place."""

from __future__ import annotations

import math

from standoff.cad.files import ENDINGS as CAD_ENDINGS
from standoff.clearance.checked_pairs import Scope
from standoff.clearance.fits import load_fits
from standoff.clearance.report import Wanted
from standoff.cli.arguments import ClearanceCommand
from standoff.cli.errors import CommandError


def check_options(command: ClearanceCommand) -> None:
    """Refuse numbers that are none, and options that do not go together.

    Raises CommandError.
    """
    for value, name in ((command.min, "--min"), (command.min_tolerance, "--min-tolerance")):
        if value is not None and not 0.0 <= value < math.inf:
            raise CommandError(f"{name}: must be zero or more and finite, got {value}")
    if command.scope.within is not None and not command.scope.within > 0.0:
        raise CommandError(f"--within: must be above zero, got {command.scope.within}")
    if command.scope.closest is not None and command.scope.closest < 1:
        raise CommandError(f"--closest: must be one or more, got {command.scope.closest}")
    if command.volume and command.scene.suffix.lower() not in CAD_ENDINGS:
        raise CommandError(f"--volume: only of a CAD file's parts, got {command.scene}")
    if command.motion and command.time is not None:
        raise CommandError("--time and --motion: give one of them, an instant or all frames")


def wanted_by(command: ClearanceCommand) -> Wanted:
    """What a command asks of the pairs."""
    fits = None if command.allow is None else load_fits(command.allow)
    return Wanted(command.min, fits, command.min_tolerance)


def scope_of(command: ClearanceCommand) -> Scope:
    """Which pairs a command looks at."""
    return Scope(**{key: value for key, value in vars(command.scope).items() if value is not None})


def option_error(error: Exception) -> CommandError | None:
    """The error of an option that selects pairs; None of another one."""
    selects = getattr(error, "argument", "") in ("parts", "pairs")
    return CommandError(f"--{error}") if selects else None
