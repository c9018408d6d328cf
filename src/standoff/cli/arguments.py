"""The library's own commands and their options, as tyro reads them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, make_dataclass
from functools import reduce
from operator import or_
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro
from tyro.conf import FlagCreatePairsOff, Positional, arg, subcommand

from standoff.cli.added import AddedCommand, added
from standoff.tracking.law_options import Option
from standoff.tracking.laws import every_option, laws_with


def _flag(option: Option) -> tuple[str, Any, None]:
    """The field of a law's option: a text that is read as a scene's value is."""
    laws = laws_with(option.name)
    whose = "" if len(laws) > 1 else f", for the law {laws[0].name}"
    told = f"In place of the scene's{whose}: {option.kind.words()}. {option.help}"
    name = option.metavar or option.name.upper()
    hint = Annotated[str | None, arg(metavar=name, help=told, help_behavior_hint="")]
    return option.name, hint, None


if TYPE_CHECKING:

    class LawFlags:
        """Of the laws' options, by name, the texts that were given, or None."""
else:
    LawFlags = make_dataclass("LawFlags", map(_flag, every_option().values()), frozen=True)

NO_FLAGS = LawFlags()

SceneFile = Annotated[Positional[Path], arg(metavar="SCENE.toml")]


@dataclass(frozen=True)
class TrackCommand:
    """Track a scene's pairs over time and sum up what was seen.

    Exit codes: 0 done, 1 results could not be written, 2 bad input, 3 finished but not certified.
    """

    scene: SceneFile
    """Scene file; docs/scene-format.md describes the format."""
    output: Annotated[
        Path | None, arg(aliases=["-o"], metavar="OUT.parquet", help_behavior_hint="")
    ] = None
    """Write every frame to this Parquet file; of several pairs each to its own,
    OUT-NAME.parquet."""
    plot: Annotated[Path | None, arg(metavar="OUT.png", help_behavior_hint="")] = None
    """Plot distance, certificate gap and active features to this file (.png, .svg or .pdf); of
    several pairs each to its own, OUT-NAME.png."""
    json: Annotated[bool, arg(help_behavior_hint="")] = False
    """Print the summary as JSON, with all events."""
    pair: Annotated[str | None, arg(metavar="NAME", help_behavior_hint="")] = None
    """Only this one of the scene's [[pairs]]."""
    law: Annotated[str | None, arg(metavar="LAW", help_behavior_hint="")] = None
    """In place of the scene's: predictor-corrector or paper. Options of the scene that this law
    has not are dropped."""
    options: Annotated[LawFlags, arg(name="")] = NO_FLAGS
    step: Annotated[str | None, arg(metavar="SECONDS|samples", help_behavior_hint="")] = None
    """In place of the scene's: time from frame to frame in s, or 'samples'."""
    start: Annotated[float | None, arg(metavar="SECONDS", help_behavior_hint="")] = None
    """In place of the scene's: time of the first frame, s."""
    duration: Annotated[float | None, arg(metavar="SECONDS", help_behavior_hint="")] = None
    """In place of the scene's: time from the first frame to the last, s."""


@dataclass(frozen=True)
class DistanceCommand:
    """Find the certified distance of a scene's pairs at one instant.

    Exit codes: 0 done, 2 bad input, 3 finished but not certified.
    """

    scene: SceneFile
    """Scene file; docs/scene-format.md describes the format."""
    time: Annotated[float | None, arg(metavar="SECONDS", help_behavior_hint="")] = None
    """Scene time in s, from the scene's start to its end; the first frame's if not given."""
    pair: Annotated[str | None, arg(metavar="NAME", help_behavior_hint="")] = None
    """Only this one of the scene's [[pairs]]."""
    json: Annotated[bool, arg(help_behavior_hint="")] = False
    """Print the answer as JSON."""


@dataclass(frozen=True)
class ImpactCommand:
    """Find the first time at which a scene's pairs touch or come to a clearance.

    Exit codes: 0 done, 2 bad input, 3 finished but undecided.
    """

    scene: SceneFile
    """Scene file; docs/scene-format.md describes the format."""
    clearance: Annotated[float, arg(metavar="LENGTH", help_behavior_hint="")] = 0.0
    """Distance that counts as impact, in the scene's unit; 0, contact, if not given."""
    start: Annotated[float | None, arg(metavar="SECONDS", help_behavior_hint="")] = None
    """In place of the scene's: time at which the search begins, s."""
    duration: Annotated[float | None, arg(metavar="SECONDS", help_behavior_hint="")] = None
    """In place of the scene's: time to search, s."""
    pair: Annotated[str | None, arg(metavar="NAME", help_behavior_hint="")] = None
    """Only this one of the scene's [[pairs]]."""
    json: Annotated[bool, arg(help_behavior_hint="")] = False
    """Print the answer as JSON."""


@dataclass(frozen=True)
class CheckCommand:
    """Tell what a body's checks at construction found and proved.

    Exit codes: 0 done, 1 the picture could not be written, 2 bad input: also a body that is
    refused.
    """

    what: Annotated[Positional[str], arg(metavar="SCENE.toml|BODY.json|SHAPE")]
    """A scene, a file of patches, or a shape written as in a scene, such as
    'shape = "box", size = [1, 2, 3]'."""
    body: Annotated[str | None, arg(metavar="NAME", help_behavior_hint="")] = None
    """Only this one of a scene's bodies."""
    plot: Annotated[Path | None, arg(metavar="OUT.png", help_behavior_hint="")] = None
    """Draw the body with its features and normals to this file (.png, .svg or .pdf); of several
    bodies each to its own, OUT-NAME.png."""
    json: Annotated[bool, arg(help_behavior_hint="")] = False
    """Print the report as JSON."""


@dataclass(frozen=True)
class AutomatonCommand:
    """List or draw the modes, switching functions and resets of a scene's pairs.

    Exit codes: 0 done, 1 the file could not be written, 2 bad input, 3 with --visited: finished
    but not certified.
    """

    scene: SceneFile
    """Scene file; docs/scene-format.md describes the format."""
    pair: Annotated[str | None, arg(metavar="NAME", help_behavior_hint="")] = None
    """Only this one of the scene's [[pairs]]."""
    format: Annotated[str | None, arg(metavar="FORMAT", help_behavior_hint="")] = None
    """text, mermaid or svg; if not given, by the ending of OUT, else text."""
    output: Annotated[
        Path | None, arg(aliases=["-o"], metavar="OUT.svg", help_behavior_hint="")
    ] = None
    """Write to this file (.txt, .mmd or .svg) in place of stdout; of several pairs each to its
    own, OUT-NAME.svg."""
    visited: Annotated[bool, arg(help_behavior_hint="")] = False
    """Track the scene first, and mark the visited modes and switches with their times."""


@dataclass(frozen=True)
class SimulateCommand:
    """Let a scene's bodies fall, roll, slide and bounce, and sum up what was seen.

    Exit codes: 0 done, 1 results could not be written, 2 bad input, 3 finished but not certified.
    """

    scene: SceneFile
    """Scene of a simulation; docs/simulation.md describes the format."""
    output: Annotated[
        Path | None, arg(aliases=["-o"], metavar="OUT.parquet", help_behavior_hint="")
    ] = None
    """Write every record to this Parquet file."""
    plot: Annotated[Path | None, arg(metavar="OUT.png", help_behavior_hint="")] = None
    """Plot paths, distances, forces and energies to this file (.png, .svg or .pdf)."""
    json: Annotated[bool, arg(help_behavior_hint="")] = False
    """Print the summary as JSON."""
    step: Annotated[float | None, arg(metavar="SECONDS", help_behavior_hint="")] = None
    """In place of the scene's: time of a tick, s."""
    duration: Annotated[float | None, arg(metavar="SECONDS", help_behavior_hint="")] = None
    """In place of the scene's: time that is simulated, s."""
    method: Annotated[str | None, arg(metavar="METHOD", help_behavior_hint="")] = None
    """In place of the scene's: semi-implicit, euler, heun, midpoint or rk4."""
    tracker: Annotated[str | None, arg(metavar="inside|beside", help_behavior_hint="")] = None
    """In place of the scene's: the tracker inside the operator, or beside it."""


@dataclass(frozen=True)
class WarmupCommand:
    """Compile all kernels ahead, once for this installation, so that no later use waits for it.

    What is compiled already is only loaded. Bodies of formulas bring code of their own, which each
    process compiles where it makes them: that is no part of this.

    Exit codes: 0 done, 1 the machine code could not be kept, 3 finished, but a kernel could not be
    compiled.
    """

    json: Annotated[bool, arg(help_behavior_hint="")] = False
    """Print what was compiled as JSON; what is done meanwhile is told on stderr."""


Command = (
    TrackCommand
    | DistanceCommand
    | ImpactCommand
    | CheckCommand
    | AutomatonCommand
    | SimulateCommand
    | WarmupCommand
    | AddedCommand
)

OWN: dict[str, type] = {
    "track": TrackCommand,
    "distance": DistanceCommand,
    "impact": ImpactCommand,
    "check": CheckCommand,
    "automaton": AutomatonCommand,
    "simulate": SimulateCommand,
    "warmup": WarmupCommand,
}
"""The library's own commands, by name."""

DESCRIPTION = """Exact, certified minimum distance of curved convex bodies in motion.

standoff --version prints the version."""


def parse(arguments: Sequence[str]) -> Command:
    """Return the command that the arguments give.

    Raises
    ------
    SystemExit
        With code 0 after help was printed, 2 after a complaint on stderr.
    CommandError
        If they name a command of another package that is not installed or cannot be loaded.
    """
    first = arguments[0] if arguments else ""
    # The library's own commands wait for nobody else's, and nobody replaces them.
    commands = OWN if first in OWN else OWN | added(first) | OWN
    each = [Annotated[command, subcommand(name)] for name, command in commands.items()]
    any_of_them: Any = reduce(or_, each)
    found: Command = tyro.cli(
        any_of_them,
        prog="standoff",
        description=DESCRIPTION,
        args=arguments,
        config=(FlagCreatePairsOff,),
    )
    return found
