"""Commands that other packages add: entry points of the group ``standoff.commands``.

Each leads to the dataclass of the command's options, as tyro reads them, which also says and does
what is to be done (`AddedCommand`). Its module is imported for help and for the command itself, so
it should import nothing heavy; what the command needs is imported by its `run`.
"""

from __future__ import annotations

from importlib.metadata import EntryPoint, entry_points
from typing import Protocol

from standoff.cli.errors import CommandError

GROUP = "standoff.commands"

STUDIES = ("paper", "soak", "accuracy")
"""Commands of the studies, a distribution of its own beside this one."""


class AddedCommand(Protocol):
    """A dataclass of options with these two methods."""

    def announcement(self) -> str:
        """What the command is about to do, without a full stop; "" to say nothing."""

    def run(self) -> int:
        """Do it; returns the exit code, and raises what `standoff.cli.commands.run` does."""


def added(first: str) -> dict[str, type[AddedCommand]]:
    """Return the commands that other packages add, by name.

    Raises CommandError if `first` is the name of one that is not installed, or that cannot be
    imported.

    Parameters
    ----------
    first : str
        The first of the arguments. If it is the name of one, only that one is returned.
    """
    found = {point.name: point for point in sorted(entry_points(group=GROUP))}
    if first in found:
        return {first: _imported(found[first])}
    if first in STUDIES:
        raise CommandError(
            f"the command '{first}' belongs to the studies, which are not installed: "
            "pip install standoff-studies, or, in a clone of Standoff, pip install -e ./studies"
        )
    commands = {}
    for name, point in found.items():
        try:
            commands[name] = _imported(point)
        except CommandError:
            continue  # help and the other commands need not know
    return commands


def _imported(point: EntryPoint) -> type[AddedCommand]:
    try:
        command: type[AddedCommand] = point.load()
    except Exception as error:
        raise CommandError(
            f"the command '{point.name}' cannot be loaded from {point.value} ({error!r}); install "
            "the package that adds it again, or remove it"
        ) from error
    return command
