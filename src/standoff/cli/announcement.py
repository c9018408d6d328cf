"""What a command is about to do, said before the library is loaded: that alone takes a second."""

from __future__ import annotations

from standoff.cli.arguments import (
    AccuracyCommand,
    AutomatonCommand,
    CheckCommand,
    Command,
    DistanceCommand,
    ImpactCommand,
    PaperCommand,
    SoakCommand,
    TrackCommand,
    WarmupCommand,
)
from standoff.kernels.notices import ALL_SECONDS, say

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
            return f"tracking {_pairs(command.pair)} of {_shown(command.scene)}"
        case DistanceCommand():
            return f"finding the distance of {_pairs(command.pair)} of {_shown(command.scene)}"
        case ImpactCommand():
            return f"finding the first impact of {_pairs(command.pair)} of {_shown(command.scene)}"
        case CheckCommand():
            return f"checking {_shown(command.what)}"
        case AutomatonCommand():
            return f"finding the modes of {_pairs(command.pair)} of {_shown(command.scene)}"
        case PaperCommand():
            return "" if command.list else _paper(command)
        case SoakCommand():
            if command.replay is not None:
                return f"running the pair of {_shown(command.replay)} again"
            return (
                f"tracking and checking random pairs up to {command.pairs:,}, each "
                f"{command.frames:,} frames, into {_shown(command.output)}"
            )
        case AccuracyCommand():
            shapes = (
                f"pairs of {_shown(', '.join(command.shapes))}" if command.shapes else "all pairs"
            )
            return f"measuring the errors of {shapes}, {command.cases} cases at each gap and depth"
        case WarmupCommand():
            return f"loading all kernels; what must be compiled takes about {ALL_SECONDS} s in all"


def _pairs(pair: str | None) -> str:
    return "the pairs" if pair is None else f"the pair {_shown(pair)}"


def _paper(command: PaperCommand) -> str:
    which = "all figures" if "all" in command.keys else f"figures {_shown(', '.join(command.keys))}"
    moving = "" if command.no_animations else " and animations"
    return f"making {which}{moving} of the paper into {_shown(command.output)}"


def _shown(given: object) -> str:
    text = str(given)
    text = text if text.isprintable() else repr(text)
    return text if len(text) <= SHOWN_CHARACTERS else text[: SHOWN_CHARACTERS - 1] + "…"
