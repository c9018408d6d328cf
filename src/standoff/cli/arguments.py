"""The commands and their options, as tyro reads them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro
from tyro.conf import FlagCreatePairsOff, Positional, arg, subcommand

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
    """In place of the scene's: predictor-corrector or paper."""
    predictor: Annotated[str | None, arg(metavar="PREDICTOR", help_behavior_hint="")] = None
    """In place of the scene's: feedforward-2, feedforward, secant or none."""
    integrator: Annotated[str | None, arg(metavar="INTEGRATOR", help_behavior_hint="")] = None
    """In place of the scene's: heun, euler, midpoint or rk4."""
    gain: Annotated[float | None, arg(metavar="K", help_behavior_hint="")] = None
    """In place of the scene's, and of its feedback: feedback gain, 1/s."""
    realisation: Annotated[str | None, arg(metavar="REALISATION", help_behavior_hint="")] = None
    """In place of the scene's, for the paper's law: evaluated or integrated."""
    saturation: Annotated[str | None, arg(metavar="SATURATION", help_behavior_hint="")] = None
    """In place of the scene's, for the paper's law: hold or zero."""
    switching: Annotated[str | None, arg(metavar="SWITCHING", help_behavior_hint="")] = None
    """In place of the scene's, for the paper's law: multipliers, voronoi or none."""
    solve: Annotated[str | None, arg(metavar="SOLVE", help_behavior_hint="")] = None
    """In place of the scene's, for the paper's law: ranked or plain."""
    depth: Annotated[str | None, arg(metavar="DEPTH", help_behavior_hint="")] = None
    """In place of the scene's, in penetration: global (proven the least) or local."""
    deadline: Annotated[int | None, arg(metavar="N", help_behavior_hint="")] = None
    """In place of the scene's: most evaluations a step."""
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
class PaperCommand:
    """Make the figures of the paper, their data, and a report that sets it beside the measured.

    Exit codes: 0 done, 1 files could not be written, 2 bad input, 3 finished, but a figure failed.
    """

    keys: Annotated[
        Positional[tuple[str, ...]], arg(metavar="[KEY ...|all]", help_behavior_hint="")
    ] = ("all",)
    """Figures by number (7, 8-11) or word (voronoi); --list shows them. If none is given, all."""
    output: Annotated[Path, arg(aliases=["-o"], metavar="DIR", help_behavior_hint="")] = Path(
        "standoff-paper"
    )
    """Folder of the pictures, tables, animations and report.html; made if it does not exist. If
    not given, standoff-paper."""
    list: Annotated[bool, arg(help_behavior_hint="")] = False
    """Only list the figures."""
    json: Annotated[bool, arg(help_behavior_hint="")] = False
    """Print what was made and every statement as JSON."""
    no_animations: Annotated[bool, arg(help_behavior_hint="")] = False
    """Leave the moving pictures out, which take most of the time."""
    jobs: Annotated[int | None, arg(metavar="N", help_behavior_hint="")] = None
    """Most processes at once; 2 if not given."""


@dataclass(frozen=True)
class SoakCommand:
    """Track random pairs, check every answer by support functions, and stop at the first failure.

    Exit codes: 0 done, 1 files could not be written, 2 bad input, 3 a check failed.
    """

    pairs: Annotated[int, arg(metavar="N", help_behavior_hint="")] = 1000
    """Pairs in all; 1000 if not given."""
    seed: Annotated[int, arg(metavar="S", help_behavior_hint="")] = 0
    """Seed of the pairs, 0 or more; 0 if not given."""
    frames: Annotated[int, arg(metavar="M", help_behavior_hint="")] = 2000
    """Frames of each pair; 2000 if not given."""
    jobs: Annotated[int | None, arg(metavar="J", help_behavior_hint="")] = None
    """Processes; 2 if not given. With 1 in this process, where a pair that hangs is not noticed."""
    output: Annotated[Path, arg(aliases=["-o"], metavar="DIR", help_behavior_hint="")] = Path(
        "standoff-soak"
    )
    """Folder of the ledger soak.json and of a failure's file; made if it does not exist. If not
    given, standoff-soak."""
    resume: Annotated[bool, arg(help_behavior_hint="")] = False
    """Go on with the soak in DIR, of the same seed and frames."""
    replay: Annotated[Path | None, arg(metavar="FILE", help_behavior_hint="")] = None
    """Only run the pair of a failure's file again."""
    json: Annotated[bool, arg(help_behavior_hint="")] = False
    """Print the ledger as JSON."""


@dataclass(frozen=True)
class AccuracyCommand:
    """Measure the errors of distance, witness points and normal by pair of shapes.

    The pairs are exact by construction, at gaps of 1e-6, 1e-3 and 1 and depths of 1e-6, 1e-3 and
    1e-1 of their size.

    Exit codes: 0 done, 1 files could not be written, 2 bad input, 3 finished, but an answer is
    wrong or missing.
    """

    shapes: Annotated[
        Positional[tuple[str, ...]], arg(metavar="[SHAPE ...]", help_behavior_hint="")
    ] = ()
    """Only pairs of these, such as sphere 'rounded box'; all if none is given."""
    output: Annotated[Path | None, arg(aliases=["-o"], metavar="DIR", help_behavior_hint="")] = None
    """Write accuracy.parquet (a row a case and engine), accuracy.md, gaps.md and depths.md (tables)
    and accuracy.png to this folder; made if it does not exist."""
    cases: Annotated[int, arg(metavar="N", help_behavior_hint="")] = 10
    """Cases of each pair at each gap and depth; 10 if not given."""
    seed: Annotated[int, arg(metavar="S", help_behavior_hint="")] = 0
    """Seed of all draws; 0 if not given. A pair's cases do not depend on the other pairs."""
    peers: Annotated[bool, arg(help_behavior_hint="")] = False
    """Ask Coal, MuJoCo, python-fcl and OpenCASCADE too: the extra 'peers'."""
    json: Annotated[bool, arg(help_behavior_hint="")] = False
    """Print the summary as JSON."""


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
    | PaperCommand
    | SoakCommand
    | AccuracyCommand
    | WarmupCommand
)

DESCRIPTION = """Exact, certified minimum distance of curved convex bodies in motion.

standoff --version prints the version."""


def parse(arguments: Sequence[str]) -> Command:
    """Return the command that the arguments give.

    Raises
    ------
    SystemExit
        With code 0 after help was printed, 2 after a complaint on stderr.
    """
    return tyro.cli(
        Annotated[TrackCommand, subcommand("track")]
        | Annotated[DistanceCommand, subcommand("distance")]
        | Annotated[ImpactCommand, subcommand("impact")]
        | Annotated[CheckCommand, subcommand("check")]
        | Annotated[AutomatonCommand, subcommand("automaton")]
        | Annotated[PaperCommand, subcommand("paper")]
        | Annotated[SoakCommand, subcommand("soak")]
        | Annotated[AccuracyCommand, subcommand("accuracy")]
        | Annotated[WarmupCommand, subcommand("warmup")],
        prog="standoff",
        description=DESCRIPTION,
        args=arguments,
        config=(FlagCreatePairsOff,),
    )
