"""From a command, as the arguments give it, to what runs it."""

from __future__ import annotations

from standoff.cad.files import is_cad_file
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


def run(command: Command) -> int:
    """Run a command; returns its exit code.

    Raises CommandError, SceneError if the input is not usable. Raises WriteError if results could
    not be written.
    """
    # Each command imports its own module: tracking needs none of the others.
    match command:
        case TrackCommand():
            from standoff.cli.track import run_track

            return run_track(command)
        case DistanceCommand():
            from standoff.cli.distance import run_distance

            return run_distance(command)
        case ImpactCommand():
            from standoff.cli.impact import run_impact

            return run_impact(command)
        case ClearanceCommand():
            from standoff.cli.clearance import run_clearance

            return run_clearance(command)
        case CertifyCommand():
            from standoff.cli.certify import run_certify

            return run_certify(command)
        case CheckCommand() if is_cad_file(command.what):
            from standoff.cli.check_cad import run_check_cad

            return run_check_cad(command)
        case CheckCommand():
            from standoff.cli.check import run_check

            return run_check(command)
        case AutomatonCommand():
            from standoff.cli.automaton import run_automaton

            return run_automaton(command)
        case SimulateCommand():
            from standoff.cli.simulate import run_simulate

            return run_simulate(command)
        case ViewCommand():
            from standoff.cli.view import run_view

            return run_view(command)
        case ServoCommand():
            from standoff.cli.servo import run_servo

            return run_servo(command)
        case _:
            return _run_without_a_scene(command)


def _run_without_a_scene(
    command: RobotCommand
    | SweepCommand
    | WarmupCommand
    | CacheCommand
    | LibraryCommand
    | AddedCommand,
) -> int:
    match command:
        case SweepCommand():
            from standoff.cli.sweep import run_sweep_command

            return run_sweep_command(command)
        case RobotCommand():
            from standoff.cli.robot import run_robot

            return run_robot(command)
        case WarmupCommand():
            from standoff.cli.warmup import run_warmup

            return run_warmup(command)
        case CacheCommand():
            from standoff.cli.cache import run_cache

            return run_cache(command)
        case LibraryCommand():
            from standoff.cli.c_library import run_c_library

            return run_c_library(command)
        case _:
            return command.run()
