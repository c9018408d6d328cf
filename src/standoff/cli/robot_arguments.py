"""The commands of robot models and their options, as tyro reads them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional, arg

from standoff.cli.option_groups import AS_IN_FILE, RobotFlags, group


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
