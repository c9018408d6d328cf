"""An assembly's file in the place of a scene: what a report and its page ask of either."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeAlias

from standoff.motion import Pose
from standoff.scene.scene import Scene
from standoff.world import World


@dataclass(frozen=True)
class AssemblyFile:
    """An assembly's file: parts at rest, all of which are a world.

    Attributes
    ----------
    file : Path
    title, length_unit : str
    notes : tuple of str
        What was found when it was read.
    places : mapping of str to Pose
        Of the parts' frames.
    colours : mapping of str to (red, green, blue)
        Of the parts that have one in the file, each within [0, 1].
    """

    file: Path
    title: str
    length_unit: str
    notes: tuple[str, ...] = ()
    places: Mapping[str, Pose] = field(default_factory=dict)
    colours: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)

    def poses(self, world: World, time: float) -> dict[str, Pose]:
        """Where the parts of a world are: at any time the same."""
        del time
        return {name: self.places[name] for name in world.moving}


Source: TypeAlias = "Scene | AssemblyFile"
"""What a report is on."""
