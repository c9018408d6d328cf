"""The clearance report of an assembly: what `report_on` and the page ask of a world and a scene."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from standoff.clearance.report import Nearest, Report, Wanted, report_on
from standoff.motion import Pose
from standoff.solids.arrangement import Arrangement, ArrangementAnswer


class PartsAtRest:
    """An assembly in the place of a report's world.

    Attributes
    ----------
    bodies : mapping of str to Body or Boundary
    within : float
        The horizon [length].
    fixed_poses : mapping of str to Pose
    dimension : int
        3.
    """

    dimension = 3

    def __init__(self, arrangement: Arrangement, within: float) -> None:
        self.arrangement, self.within = arrangement, within

    @property
    def bodies(self) -> Mapping[str, Any]:
        return self.arrangement.bodies

    @property
    def fixed_poses(self) -> Mapping[str, Pose]:
        return self.arrangement.poses

    def pairs(self) -> list[tuple[str, str]]:
        """All pairs of names."""
        return self.arrangement.pairs()

    def margin(self, a: str, b: str) -> float:
        """An assembly's file has no margins: `--min` asks for one."""
        del a, b
        return 0.0


@dataclass(frozen=True)
class AssemblyFile:
    """An assembly's file in the place of a report's scene.

    Attributes
    ----------
    file : Path
    title, length_unit : str
    notes : tuple of str
        What was found when it was read.
    """

    file: Path
    title: str
    length_unit: str
    notes: tuple[str, ...] = ()

    def poses(self, world: Any, time: float) -> dict[str, Pose]:
        """Nothing moves."""
        del world, time
        return {}


def assembly_report(answer: ArrangementAnswer, wanted: Wanted) -> Report:
    """Return the report on an assembly's pairs."""
    world: Any = PartsAtRest(answer.arrangement, answer.within)
    near: Any = {
        names: Nearest(found, 0.0, float(found.lower_bound), int(not found.certified))  # type: ignore[arg-type]
        for names, found in answer.near.items()
    }
    return report_on(world, near, answer.far, wanted)
