"""From a command, as the arguments give it, to what runs it."""

from __future__ import annotations

from standoff.cli.accuracy import run_accuracy
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
)
from standoff.cli.automaton import run_automaton
from standoff.cli.check import run_check
from standoff.cli.distance import run_distance
from standoff.cli.impact import run_impact
from standoff.cli.paper import run_paper
from standoff.cli.soak import run_soak
from standoff.cli.track import run_track


def run(command: Command) -> int:
    """Run a command; returns its exit code.

    Raises
    ------
    CommandError, SceneError
        If the input is not usable.
    WriteError
        If results could not be written.
    """
    match command:
        case TrackCommand():
            return run_track(command)
        case DistanceCommand():
            return run_distance(command)
        case ImpactCommand():
            return run_impact(command)
        case CheckCommand():
            return run_check(command)
        case AutomatonCommand():
            return run_automaton(command)
        case PaperCommand():
            return run_paper(command)
        case SoakCommand():
            return run_soak(command)
        case AccuracyCommand():
            return run_accuracy(command)
