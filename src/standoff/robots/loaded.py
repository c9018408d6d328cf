"""What is read from a model, before it is a robot."""

from __future__ import annotations

from typing import NamedTuple

from standoff.robots.geoms import Geoms
from standoff.robots.joints import Joints
from standoff.robots.kinematics import Kinematics
from standoff.robots.report import GeomReport


class Loaded(NamedTuple):
    """A model as the robot takes it.

    Attributes
    ----------
    source : str
        Where it came from, for messages.
    kinematics : Kinematics
    joints : Joints
    geoms : Geoms
    pairs : frozenset of (int, int)
        Numbers i < j of the geometries that the model's own rules watch.
    reports : tuple of GeomReport
        Of all geometries of the model, in its order.
    notes : tuple of str
    """

    source: str
    kinematics: Kinematics
    joints: Joints
    geoms: Geoms
    pairs: frozenset[tuple[int, int]]
    reports: tuple[GeomReport, ...]
    notes: tuple[str, ...]
