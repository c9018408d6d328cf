"""What a command is about to do, said before the library is loaded: that alone takes a second."""

from __future__ import annotations

from standoff.cli.added import AddedCommand
from standoff.cli.arguments import (
    AutomatonCommand,
    CacheCommand,
    CertifyCommand,
    CheckCommand,
    ClearanceCommand,
    Command,
    DistanceCommand,
    ImpactCommand,
    LibraryCommand,
    RobotCommand,
    ServoCommand,
    SimulateCommand,
    SweepCommand,
    TrackCommand,
    ViewCommand,
    WarmupCommand,
)
from standoff.kernels.compiler.notices import ALL_SECONDS, say, takes

SHOWN_CHARACTERS = 100
"""Longest piece of the arguments that is repeated."""


def announce(command: Command) -> None:
    """One line on stderr, also into a pipe: stdout is for results."""
    doing = _doing(command)
    if doing:
        say(f"{doing} ...")


def _doing(command: Command) -> str:
    match command:
        case TrackCommand():
            return f"tracking {_pairs(command.pair)} of {shown(command.scene)}"
        case DistanceCommand():
            return f"finding the distance of {_pairs(command.pair)} of {shown(command.scene)}"
        case ImpactCommand():
            return f"finding the first impact of {_pairs(command.pair)} of {shown(command.scene)}"
        case ClearanceCommand():
            over = " over its motion" if command.motion else ""
            return f"finding the clearance of all pairs of {shown(command.scene)}{over}"
        case CertifyCommand():
            return f"proving the path {shown(command.path)} of {shown(command.model)}"
        case CheckCommand():
            return f"checking {shown(command.what)}"
        case AutomatonCommand():
            return f"finding the modes of {_pairs(command.pair)} of {shown(command.scene)}"
        case SimulateCommand():
            return f"simulating {shown(command.scene)}"
        case ViewCommand():
            return f"making the page of {shown(command.scene)}"
        case ServoCommand():
            return f"running {shown(command.scene)} in real time"
        case _:
            return _doing_without_a_scene(command)


def _doing_without_a_scene(
    command: RobotCommand
    | SweepCommand
    | AddedCommand
    | WarmupCommand
    | CacheCommand
    | LibraryCommand,
) -> str:
    match command:
        case SweepCommand():
            if command.row is not None:
                return f"computing row {command.row} of {shown(command.job)}"
            return f"{'estimating' if command.estimate else 'sweeping'} {shown(command.job)}"
        case RobotCommand():
            return f"reading {shown(command.model)}"
        case WarmupCommand():
            return f"loading all kernels; compiling all of them takes {takes(ALL_SECONDS)}"
        case CacheCommand():
            return ""
        case LibraryCommand():
            return ""  # reported by what builds it, from Python too
        case _:
            return command.announcement()


def _pairs(pair: str | None) -> str:
    return "the pairs" if pair is None else f"the pair {shown(pair)}"


def shown(given: object) -> str:
    """A piece of the arguments on one line, cut where it is long."""
    text = str(given)
    text = text if text.isprintable() else repr(text)
    return text if len(text) <= SHOWN_CHARACTERS else text[: SHOWN_CHARACTERS - 1] + "…"
