"""Groups of options that several commands share, as tyro reads them."""

from __future__ import annotations

from dataclasses import dataclass, make_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from tyro.conf import Positional, arg

from standoff.tracking.law_options import Option
from standoff.tracking.laws import every_option, laws_with


def _flag(option: Option) -> tuple[str, Any, None]:
    """The field of a law's option: a text that is read as a scene's value is."""
    laws = [law.name for law in laws_with(option.name)]
    # The group of the paper's law says of itself whose it is.
    whose = f"For the law {laws[0]}: " if len(laws) == 1 and laws != ["paper"] else ""
    told = f"{whose}{option.kind.words()}. {option.help}"
    name = option.metavar or option.name.upper()
    hint = Annotated[str | None, arg(metavar=name, help=told, help_behavior_hint="")]
    return option.name, hint, None


LAW_TOLD = (
    "predictor-corrector or paper. Options of the scene that this law does not have are dropped."
)


def _of_paper_alone(option: Option) -> bool:
    return [law.name for law in laws_with(option.name)] == ["paper"]


@dataclass(frozen=True)
class CadFlags:
    """How a CAD file (STEP, BREP or IGES) is read."""

    tolerance: Annotated[float | None, arg(metavar="LENGTH", help_behavior_hint="")] = None
    """By how much faces, edges and vertices may miss each other, in mm; by default what the file
    claims. What they miss each other by becomes slack."""
    heal: Annotated[bool, arg(help_behavior_hint="")] = False
    """Let OpenCASCADE repair shapes that are refused as they are."""


READ_AS_IT_IS = CadFlags()

if TYPE_CHECKING:

    class LawFlags:
        """The law, and the options of both laws: by name the texts that were given, or None."""

        law: str | None

    class PaperFlags:
        """Of those of the paper's law alone."""
else:
    _OPTIONS = every_option().values()
    _WHICH = (
        "law",
        Annotated[str | None, arg(metavar="LAW", help=LAW_TOLD, help_behavior_hint="")],
        None,
    )
    LawFlags = make_dataclass(
        "LawFlags", [_WHICH, *(_flag(x) for x in _OPTIONS if not _of_paper_alone(x))], frozen=True
    )
    PaperFlags = make_dataclass(
        "PaperFlags", [_flag(x) for x in _OPTIONS if _of_paper_alone(x)], frozen=True
    )

NO_FLAGS, NO_PAPER_FLAGS = LawFlags(), PaperFlags()


@dataclass(frozen=True)
class SolidFlags:
    """For pairs with a solid that need not be convex; overrides the scene's own."""

    minima: Annotated[str | None, arg(metavar="LENGTH", help_behavior_hint="")] = None
    """Keep all local minima of the distance below this one, in the scene's unit."""


@dataclass(frozen=True)
class ReportFlags:
    """How the result is printed."""

    json: Annotated[bool, arg(help_behavior_hint="")] = False
    """As JSON, with everything there is to know."""
    verbose: Annotated[bool, arg(help_behavior_hint="")] = False
    """With all counts of the work, also those that are zero."""


@dataclass(frozen=True)
class FileFlags:
    """Other files to write; with several pairs, each gets its own file, OUT-NAME."""

    output: Annotated[
        Path | None, arg(aliases=["-o"], metavar="OUT.parquet", help_behavior_hint="")
    ] = None
    """Write every frame to this Parquet file."""
    plot: Annotated[Path | None, arg(metavar="OUT.png", help_behavior_hint="")] = None
    """Plot distance, certificate gap and active features (.png, .svg or .pdf)."""
    export: Annotated[Path | None, arg(metavar="OUT.html", help_behavior_hint="")] = None
    """Show the motion: a page without a server (.html), a video (.mp4, .gif), or a rerun file
    (.rrd)."""


@dataclass(frozen=True)
class SpanFlags:
    """Overrides the scene's own."""

    start: Annotated[float | None, arg(metavar="SECONDS", help_behavior_hint="")] = None
    """When to begin, s."""
    duration: Annotated[float | None, arg(metavar="SECONDS", help_behavior_hint="")] = None
    """How long to track, s."""


@dataclass(frozen=True)
class FrameFlags(SpanFlags):
    """Overrides the scene's own."""

    step: Annotated[str | None, arg(metavar="SECONDS|samples", help_behavior_hint="")] = None
    """Time from frame to frame, s, or 'samples'."""


def group(name: str, told: str = "") -> Any:
    """A group of options, which help shows under its name; the options' own names do not contain
    it."""
    return arg(name=name, help=told or None)


SceneFile = Annotated[Positional[Path], arg(metavar="SCENE.toml")]


NO_FILES, AS_USUAL = FileFlags(), ReportFlags()
WHOLE_SPAN, OWN_FRAMES = SpanFlags(), FrameFlags()
NO_SOLID_FLAGS = SolidFlags()
"""What holds where no option of a group is given."""


@dataclass(frozen=True)
class MeshFlags:
    """What stands for the meshes of a file, which must be convex without it."""

    hulls: Annotated[bool, arg(help_behavior_hint="")] = False
    """Take their hulls."""
    pieces: Annotated[bool, arg(help_behavior_hint="")] = False
    """Take convex pieces of them, by CoACD, which are not exactly the meshes."""


NO_INSTEAD = MeshFlags()


@dataclass(frozen=True)
class RobotFlags:
    """How a robot's model is read."""

    hulls: Annotated[bool, arg(help_behavior_hint="")] = False
    """Take the hulls of meshes, which are refused without it."""
    skip: Annotated[tuple[str, ...], arg(metavar="NAME", help_behavior_hint="")] = ()
    """Geometries or links to leave out."""
    srdf: Annotated[Path | None, arg(metavar="FILE.srdf", help_behavior_hint="")] = None
    """Of a URDF: which pairs are disabled."""
    packages: Annotated[tuple[Path, ...], arg(metavar="FOLDER", help_behavior_hint="")] = ()
    """Of a URDF: folders in which package:// begins; those above the file are tried too."""
    free_base: Annotated[bool, arg(help_behavior_hint="")] = False
    """Of a URDF: the base moves freely."""
    mimic: Annotated[
        Literal["follow", "free"] | None, arg(metavar="follow|free", help_behavior_hint="")
    ] = None
    """Of a URDF with joints that mimic others: whether they do, or move by themselves."""


AS_IN_FILE = RobotFlags()
