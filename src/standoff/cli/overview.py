"""What ``standoff --help`` prints: one line a command, and examples."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from inspect import getdoc

USAGE = """usage: standoff COMMAND [OPTIONS]

Exact, certified minimum distance of curved bodies, convex or not, at rest and in motion."""

EXAMPLES = """Examples:
  standoff distance examples/helix.toml --time 2.5
  standoff track examples/helix.toml -o run.parquet --plot run.png
  standoff check 'shape = "box", size = [1, 2, 3]' --plot box.png

standoff COMMAND --help lists a command's options; standoff --version prints the version.
Exit codes: 0 done, 1 results could not be written, 2 bad input, 3 finished but not certified."""

MARGIN = 12
"""Width of the column of commands, in characters."""

LONGEST = 60
"""Longest piece of a misspelt command that is repeated, in characters."""


def overview(commands: Mapping[str, type], own: int) -> str:
    """Return the help of the whole: the library's own commands, which come first, and others."""
    lines = [f"  {name:<{MARGIN}}{_summary(command)}" for name, command in commands.items()]
    parts = [USAGE, "\n".join(["Commands:", *lines[:own]])]
    if lines[own:]:
        parts.append("\n".join(["Commands of other packages:", *lines[own:]]))
    return "\n\n".join([*parts, EXAMPLES])


def unknown_command(name: str, known: Iterable[str]) -> str:
    """Return the sentence that refuses a command, with the nearest one that there is."""
    from standoff.checks.names import nearest
    from standoff.checks.real_numbers import shown

    likely = nearest(name, known)
    said = f"did you mean '{likely}'? " if likely is not None else ""
    return f"unknown command {shown(name, LONGEST)}; {said}standoff --help lists the commands"


def _summary(command: type) -> str:
    """The first line of what a command says of itself."""
    return (getdoc(command) or "").partition("\n")[0]
