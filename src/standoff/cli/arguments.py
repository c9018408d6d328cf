"""The library's own commands and their options, as tyro reads them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from inspect import getdoc
from operator import or_
from pathlib import Path
from typing import Annotated, Any

import tyro
from tyro.conf import (
    FlagCreatePairsOff,
    OmitArgPrefixes,
    Positional,
    UseAppendAction,
    arg,
    subcommand,
)

from standoff.cli.added import AddedCommand, added
from standoff.cli.errors import CommandError
from standoff.cli.option_groups import (
    AS_IN_FILE,
    AS_USUAL,
    NO_FILES,
    NO_FLAGS,
    NO_INSTEAD,
    NO_PAPER_FLAGS,
    NO_SOLID_FLAGS,
    OWN_FRAMES,
    READ_AS_IT_IS,
    WHOLE_SPAN,
    CadFlags,
    FileFlags,
    FrameFlags,
    LawFlags,
    MeshFlags,
    PaperFlags,
    ReportFlags,
    RobotFlags,
    SceneFile,
    SolidFlags,
    SpanFlags,
    group,
)
from standoff.cli.sweep_arguments import SweepCommand as SweepCommand
from standoff.cli.terminal import tell

# The commands of robot models and their options, as tyro reads them.


@dataclass(frozen=True)
class RobotCommand:
    """Read a robot model, and find its nearest pair.

    Example: standoff robot panda.urdf --report --hulls

    Exit codes: 0 done, 2 bad input, 3 finished but not certified.
    """

    model: Annotated[Positional[Path], arg(metavar="MODEL")]
    """MJCF file (.xml) or URDF file (.urdf)."""
    report: Annotated[bool, arg(help_behavior_hint="")] = False
    """Say what became of every geometry, and which pairs are watched."""
    q: Annotated[str | None, arg(metavar="NUMBERS", help_behavior_hint="")] = None
    """Configuration, such as '0 0.5 -1'; the model's own zero if not given."""
    robot: Annotated[RobotFlags, group("robot")] = AS_IN_FILE
    json: Annotated[bool, arg(help_behavior_hint="")] = False
    """Print what was found as JSON."""


@dataclass(frozen=True)
class CertifyCommand:
    """Prove that a robot on a joint path keeps a clearance at every instant.

    Example: standoff certify examples/robots/arm.xml examples/robots/reach.csv --clearance 0.005

    Exit codes: 0 proven, 1 results could not be written, 2 bad input, 3 not proven.
    """

    model: Annotated[Positional[Path], arg(metavar="MODEL")]
    """MJCF file (.xml) or URDF file (.urdf)."""
    path: Annotated[Positional[Path], arg(metavar="PATH.csv")]
    """Waypoints, a row each, straight in q between them; docs/certify.md describes the format."""
    clearance: Annotated[float | None, arg(metavar="LENGTH", help_behavior_hint="")] = None
    """Distance that every pair must keep, in the model's unit; 0.005 if not given."""
    obstacles: Annotated[Path | None, arg(metavar="SCENE.toml", help_behavior_hint="")] = None
    """The bodies of this scene, where they are at its start, are obstacles of the robot."""
    max_steps: Annotated[int, arg(metavar="NUMBER", help_behavior_hint="")] = 1_000_000
    """Most intervals of pairs to look at; 1000000 if not given."""
    output: Annotated[
        Path | None, arg(aliases=["-o"], metavar="OUT.json", help_behavior_hint="")
    ] = None
    """Write the proof with all its steps to this file."""
    plot: Annotated[Path | None, arg(metavar="OUT.png", help_behavior_hint="")] = None
    """Draw the proven clearance over time and the proof's steps (.png, .svg or .pdf)."""
    robot: Annotated[RobotFlags, group("robot")] = AS_IN_FILE
    json: Annotated[bool, arg(help_behavior_hint="")] = False
    """Print the proof as JSON, without its steps."""


@dataclass(frozen=True)
class TrackCommand:
    """Track a scene's pairs over time.

    Example: standoff track examples/helix.toml -o run.parquet --plot run.png

    Exit codes: 0 done, 1 results could not be written, 2 bad input, 3 finished but not certified.
    """

    scene: SceneFile
    """Scene file; docs/scene-format.md describes the format."""
    pair: Annotated[str | None, arg(metavar="NAME", help_behavior_hint="")] = None
    """Only this one of the scene's [[pairs]]."""
    files: Annotated[FileFlags, group("file")] = NO_FILES
    report: Annotated[ReportFlags, group("report")] = AS_USUAL
    times: Annotated[FrameFlags, group("time")] = OWN_FRAMES
    options: Annotated[LawFlags, group("law", "Overrides the scene's own.")] = NO_FLAGS
    paper_options: Annotated[
        PaperFlags, group("paper law", "For the paper's law alone; overrides the scene's own.")
    ] = NO_PAPER_FLAGS
    solid_options: Annotated[SolidFlags, group("solids")] = NO_SOLID_FLAGS


@dataclass(frozen=True)
class DistanceCommand:
    """Find the certified distance of a scene's pairs at one instant.

    Example: standoff distance examples/helix.toml --time 2.5

    Exit codes: 0 done, 2 bad input, 3 finished but not certified.
    """

    scene: SceneFile
    """Scene file; docs/scene-format.md describes the format."""
    time: Annotated[float | None, arg(metavar="SECONDS", help_behavior_hint="")] = None
    """Scene time in s, from the scene's start to its end; the first frame's if not given."""
    pair: Annotated[str | None, arg(metavar="NAME", help_behavior_hint="")] = None
    """Only this one of the scene's [[pairs]]."""
    report: Annotated[ReportFlags, group("report")] = AS_USUAL


@dataclass(frozen=True)
class ImpactCommand:
    """Find the first time of contact, or of a clearance.

    Example: standoff impact examples/lenses.toml --clearance 0.1

    Exit codes: 0 done, 2 bad input, 3 finished but undecided.
    """

    scene: SceneFile
    """Scene file; docs/scene-format.md describes the format."""
    clearance: Annotated[float, arg(metavar="LENGTH", help_behavior_hint="")] = 0.0
    """Distance that counts as impact, in the scene's unit; 0, contact, if not given."""
    pair: Annotated[str | None, arg(metavar="NAME", help_behavior_hint="")] = None
    """Only this one of the scene's [[pairs]]."""
    times: Annotated[SpanFlags, group("time")] = WHOLE_SPAN
    report: Annotated[ReportFlags, group("report")] = AS_USUAL


@dataclass(frozen=True)
class ClearanceFiles:
    """Other files to write."""

    page: Annotated[Path | None, arg(metavar="OUT.html", help_behavior_hint="")] = None
    """Write a page with the table and pictures, which needs no other file."""
    plot: Annotated[Path | None, arg(metavar="OUT.png", help_behavior_hint="")] = None
    """Draw the clearances of all pairs as a matrix (.png, .svg or .pdf)."""


@dataclass(frozen=True)
class PairFlags:
    """Which pairs are looked at, and how far."""

    within: Annotated[float | None, arg(metavar="LENGTH", help_behavior_hint="")] = None
    """Horizon: of pairs that are farther apart only that is proven. If not given, the scene's; else
    --min; else as far as the closest pairs are."""
    closest: Annotated[int | None, arg(metavar="N", help_behavior_hint="")] = None
    """How many pairs these are, at least, and how many are listed without --verbose; 40 if not
    given."""
    parts: Annotated[
        UseAppendAction[tuple[str, ...]], arg(metavar="NAME", help_behavior_hint="")
    ] = ()
    """Only bodies of this name, which may have wildcards, such as 'bolt*'; may be given again."""
    pairs: Annotated[
        UseAppendAction[tuple[tuple[str, str], ...]], arg(metavar="A B", help_behavior_hint="")
    ] = ()
    """Only pairs of a body A and a body B, as --parts; may be given again."""


ALL_PAIRS = PairFlags()


@dataclass(frozen=True)
class ClearanceCommand:
    """Report the proven clearance of all pairs of a scene's bodies or a file's parts.

    Example: standoff clearance examples/fits.toml --min 0.3 --allow examples/fits-allowed.toml

    Exit codes: 0 done, and all that --min, --allow and margins ask is proven, 1 results could not
    be written, 2 bad input, 3 a pair is not proven to keep what it must.
    """

    scene: SceneFile
    """Scene file (docs/scene-format.md), or a file of parts: CAD, DXF or meshes."""
    time: Annotated[float | None, arg(metavar="SECONDS", help_behavior_hint="")] = None
    """Scene time in s; the first frame's if not given."""
    motion: Annotated[bool, arg(help_behavior_hint="")] = False
    """Over all frames of the scene's times: the least of each pair, and when."""
    scope: Annotated[PairFlags, group("pair")] = ALL_PAIRS
    min: Annotated[float | None, arg(metavar="LENGTH", help_behavior_hint="")] = None
    """The clearance that every pair must keep; margins in the scene hold besides."""
    min_tolerance: Annotated[float | None, arg(metavar="LENGTH", help_behavior_hint="")] = None
    """By how much what is proven may miss it; the touching tolerance of the parts if not given."""
    allow: Annotated[Path | None, arg(metavar="FITS.toml", help_behavior_hint="")] = None
    """Fits that are meant; docs/clearance.md describes the format."""
    volume: Annotated[bool, arg(help_behavior_hint="")] = False
    """Of parts of a CAD file that overlap the volume that they have in common, too, by a boolean
    operation of OpenCASCADE: it is not proven."""
    meshes: Annotated[MeshFlags, group("meshes")] = NO_INSTEAD
    workers: Annotated[int, arg(metavar="NUMBER", help_behavior_hint="")] = 1
    """Processes that share the reading of an assembly's parts; 1 if not given."""
    files: Annotated[ClearanceFiles, group("file")] = ClearanceFiles()
    report: Annotated[ReportFlags, group("report")] = AS_USUAL
    cad: Annotated[CadFlags, group("CAD")] = READ_AS_IT_IS


@dataclass(frozen=True)
class CheckCommand:
    """Report what a body's checks found and proved, and draw the body.

    Example: standoff check 'shape = "box", size = [1, 2, 3]' --plot box.png

    Exit codes: 0 done, 1 the picture could not be written, 2 bad input, or a body that is rejected.
    """

    what: Annotated[Positional[str], arg(metavar="SCENE.toml|BODY.json|PART.step|SHAPE")]
    """A scene, a file of patches, a CAD file (STEP, BREP or IGES), a DXF drawing, a file of meshes
    (STL, OBJ, PLY or 3MF), or a shape written as in a scene, such as
    'shape = "box", size = [1, 2, 3]'."""
    body: Annotated[str | None, arg(metavar="NAME", help_behavior_hint="")] = None
    """Only this one of a scene's bodies or a file's parts."""
    meshes: Annotated[MeshFlags, group("meshes")] = NO_INSTEAD
    plot: Annotated[Path | None, arg(metavar="OUT.png", help_behavior_hint="")] = None
    """Draw the body with its features and normals, or a CAD file's part with its edges by kind, to
    this file (.png, .svg or .pdf); with several, each gets its own, OUT-NAME.png."""
    workers: Annotated[int, arg(metavar="NUMBER", help_behavior_hint="")] = 1
    """Processes that share the reading of a CAD file's parts; 1 if not given."""
    json: Annotated[bool, arg(help_behavior_hint="")] = False
    """Print the report as JSON."""
    cad: Annotated[CadFlags, group("CAD")] = READ_AS_IT_IS


@dataclass(frozen=True)
class AutomatonCommand:
    """List or draw the modes and switches of a scene's pairs.

    Example: standoff automaton examples/helix.toml --visited -o helix.svg

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
    """Write to this file (.txt, .mmd or .svg) instead of stdout; with several pairs, each gets its
    own, OUT-NAME.svg."""
    visited: Annotated[bool, arg(help_behavior_hint="")] = False
    """Track the scene first, and mark the visited modes and switches with their times."""
    minima: Annotated[float | None, arg(metavar="LENGTH", help_behavior_hint="")] = None
    """With --visited, of a pair with a solid that need not be convex: follow all local minima below
    this distance; that of the scene's [track] if not given."""


@dataclass(frozen=True)
class SimulateCommand:
    """Simulate bodies that fall, roll, slide and bounce.

    Example: standoff simulate examples/simulation/rattleback.toml --plot run.png

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
    """Time of a tick, s; overrides the scene's."""
    duration: Annotated[float | None, arg(metavar="SECONDS", help_behavior_hint="")] = None
    """Time to simulate, s; overrides the scene's."""
    method: Annotated[str | None, arg(metavar="METHOD", help_behavior_hint="")] = None
    """Semi-implicit, euler, heun, midpoint or rk4; overrides the scene's."""
    tracker: Annotated[str | None, arg(metavar="inside|beside", help_behavior_hint="")] = None
    """The tracker inside the operator, or beside it; overrides the scene's."""


@dataclass(frozen=True)
class ViewCommand:
    """Show a scene or a file's parts in the browser: drag a body, and watch the distance.

    The scene of a simulation is run first, then played with all its contacts.

    Example: standoff view examples/lenses.toml --open

    Exit codes: 0 closed, 2 bad input.
    """

    scene: SceneFile
    """Scene file (docs/scene-format.md), or a file of parts: CAD, DXF or meshes."""
    pair: Annotated[str | None, arg(metavar="NAME", help_behavior_hint="")] = None
    """This one of the scene's [[pairs]]; the first if not given."""
    host: Annotated[str, arg(metavar="HOST", help_behavior_hint="")] = "127.0.0.1"
    """Name or address to serve the page at; 127.0.0.1, this machine alone, if not given."""
    port: Annotated[int | None, arg(metavar="PORT", help_behavior_hint="")] = None
    """Port to serve the page at; any that is free, if not given."""
    gallery: Annotated[Path | None, arg(metavar="FOLDER", help_behavior_hint="")] = None
    """Folder whose scenes the page can open too; that of SCENE, if not given."""
    minima: Annotated[float | None, arg(metavar="LENGTH", help_behavior_hint="")] = None
    """Of a pair with a solid that need not be convex: show all local minima below this distance,
    0.3 of the smaller one's size if not given."""
    patch: Annotated[float | None, arg(metavar="LENGTH", help_behavior_hint="")] = None
    """Of such a pair: show the patch of each minimum, what is farther by no more than this."""
    meshes: Annotated[MeshFlags, group("meshes")] = NO_INSTEAD
    open: Annotated[bool, arg(help_behavior_hint="")] = False
    """Open the page in the usual browser."""


@dataclass(frozen=True)
class ServoCommand:
    """Run a scene with a coupler in real time, and report how well the loop kept time.

    It ends after its seconds, on Ctrl-C or SIGTERM, or when the coupler lets go; always without a
    force.

    Example: standoff servo examples/simulation/hand-on-lens.toml --seconds 10

    Exit codes: 0 done, 1 the log could not be written, 2 bad input, 3 the coupler let go, or the
    loop ended by itself.
    """

    scene: SceneFile
    """Scene of a simulation with [coupler] and [device]; docs/servo.md."""
    rate: Annotated[float | None, arg(metavar="HZ", help_behavior_hint="")] = None
    """Ticks a second, 10 to 10000; those of the scene's device if not given."""
    seconds: Annotated[float | None, arg(metavar="SECONDS", help_behavior_hint="")] = None
    """How long to run; until Ctrl-C if not given."""
    device: Annotated[str, arg(metavar="DEVICE", help_behavior_hint="")] = "path"
    """path (the scene's, there and back, which feels no force), simulated (the scene's device with
    its hand, in Python), haply, haply=ws://HOST:PORT, or a trace (.parquet, .csv, .tum)."""
    output: Annotated[
        Path | None, arg(aliases=["-o"], metavar="OUT.parquet", help_behavior_hint="")
    ] = None
    """Write the last 100 000 ticks to this Parquet file."""
    json: Annotated[bool, arg(help_behavior_hint="")] = False
    """Print the summary as JSON."""


@dataclass(frozen=True)
class WarmupCommand:
    """Compile all kernels ahead of time, so that nobody waits for it later.

    Once per installation: what is already compiled is only loaded. Bodies made of formulas have
    their own code, which each process compiles when it creates them; that is not done here.

    Exit codes: 0 done, 1 the machine code could not be kept, 3 finished, but a kernel could not be
    compiled.
    """

    json: Annotated[bool, arg(help_behavior_hint="")] = False
    """Print what was compiled as JSON; progress goes to stderr."""


@dataclass(frozen=True)
class CacheCommand:
    """Tell where finished parts of CAD files are kept, and their size, or remove them.

    Example: standoff cache --clear

    Exit codes: 0 done, 1 a file could not be removed, 2 bad input.
    """

    clear: Annotated[bool, arg(help_behavior_hint="")] = False
    """Remove all of them: the next reading of each file makes its parts again."""
    json: Annotated[bool, arg(help_behavior_hint="")] = False
    """Print it as JSON."""


@dataclass(frozen=True)
class LibraryCommand:
    """Build the shared library and the header for programs in C and C++.

    It takes some minutes and needs a C compiler: `cc`, or the one that CC names in the
    environment. standoff.c_interface.save_pair writes the files of pairs that it loads;
    docs/c-interface.md has a complete program.

    Exit codes: 0 done, 1 not written, 2 the input is not usable or the compiler failed.

    Example: standoff c-library build
    """

    folder: Annotated[Positional[Path], arg(metavar="FOLDER")]
    """Folder for libstandoff.so and standoff.h; created if it is missing."""
    processor: Annotated[str | None, arg(metavar="NAME", help_behavior_hint="")] = None
    """What the code is for, in LLVM's words, such as x86-64-v3; this machine if not given."""
    json: Annotated[bool, arg(help_behavior_hint="")] = False
    """Print where the files are as JSON."""


Command = (
    TrackCommand
    | DistanceCommand
    | ImpactCommand
    | ClearanceCommand
    | CheckCommand
    | AutomatonCommand
    | SimulateCommand
    | ViewCommand
    | RobotCommand
    | CertifyCommand
    | SweepCommand
    | ServoCommand
    | WarmupCommand
    | CacheCommand
    | LibraryCommand
    | AddedCommand
)

OWN: dict[str, type] = {
    "track": TrackCommand,
    "distance": DistanceCommand,
    "impact": ImpactCommand,
    "clearance": ClearanceCommand,
    "check": CheckCommand,
    "automaton": AutomatonCommand,
    "simulate": SimulateCommand,
    "view": ViewCommand,
    "robot": RobotCommand,
    "certify": CertifyCommand,
    "sweep": SweepCommand,
    "servo": ServoCommand,
    "warmup": WarmupCommand,
    "cache": CacheCommand,
    "c-library": LibraryCommand,
}
"""The library's own commands, by name."""


def parse(arguments: Sequence[str]) -> Command:
    """Return the command that the arguments give.

    Raises SystemExit: with code 0 after help was printed, 2 after a complaint on stderr. Raises
    CommandError if they name no command, or one of another package that is not installed or cannot
    be loaded.
    """
    first = arguments[0] if arguments else ""
    # The library's own commands wait for nobody else's, and nobody replaces them.
    commands = OWN if first in OWN else OWN | added(first) | OWN
    if first in ("-h", "--help"):
        tell(overview(commands, len(OWN)))
        raise SystemExit(0)
    if not first.startswith("-") and first not in commands:
        raise CommandError(unknown_command(first, commands))
    any_of_them: Any = reduce(or_, (Annotated[c, subcommand(n)] for n, c in commands.items()))
    found: Command = tyro.cli(
        any_of_them,
        prog="standoff",
        description="standoff --help lists the commands.",
        args=arguments,
        config=(FlagCreatePairsOff, OmitArgPrefixes),
    )
    return found


# What ``standoff --help`` prints: one line a command, and examples.

USAGE = """usage: standoff COMMAND [OPTIONS]

Exact, certified distances of curved bodies, convex or not, still or in motion."""

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
