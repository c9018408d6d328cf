"""What is read from a model, before it is a robot."""

from __future__ import annotations

from itertools import combinations
from typing import NamedTuple

import numpy as np

from standoff.robots.geoms import Geoms
from standoff.robots.joints import Joints
from standoff.robots.kinematics import Kinematics
from standoff.robots.report import STILL, GeomReport
from standoff.robots.shapes import GeometryBodies


class Loaded(NamedTuple):
    """A model as the robot takes it.

    Attributes
    ----------
    source : str
        Where it came from, for messages.
    kinematics : Kinematics
    joints : Joints
    geoms : Geoms
    left_out : dict of (int, int) to str
        Numbers i < j of geometries that are not watched, and why; all others are.
    reports : tuple of GeomReport
        Of all geometries of the model, in its order.
    notes : tuple of str
    """

    source: str
    kinematics: Kinematics
    joints: Joints
    geoms: Geoms
    left_out: dict[tuple[int, int], str]
    reports: tuple[GeomReport, ...]
    notes: tuple[str, ...]

    @property
    def pairs(self) -> frozenset[tuple[int, int]]:
        """Numbers i < j of the geometries that are watched."""
        return frozenset(combinations(range(len(self.geoms.names)), 2)) - set(self.left_out)


def loaded(
    source: str,
    kinematics: Kinematics,
    joints: Joints,
    made: GeometryBodies,
    left_out: dict[tuple[int, int], str],
    notes: tuple[str, ...],
) -> Loaded:
    """A model as the robot takes it; what stands still beside what stands still is left out too."""
    still = np.flatnonzero(made.geoms.joints < 0).tolist()
    both = dict.fromkeys(combinations(still, 2), STILL)
    return Loaded(source, kinematics, joints, made.geoms, both | left_out, made.reports, notes)
