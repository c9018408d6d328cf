"""What a peer answers: world frame, poses (R, p), the normal from A to B."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from importlib.metadata import version
from typing import Any

import numpy as np

from standoff.typing import Array
from standoff_studies.accuracy.solids import Solid

Pose = tuple[Array, Array]


@dataclass(frozen=True)
class PeerAnswer:
    """A peer's signed distance, witness points (3,) and unit normal (3,) from A to B, in world."""

    distance: float
    point_a: Array
    point_b: Array
    normal: Array


NOTHING = PeerAnswer(np.nan, *[np.full(3, np.nan)] * 3)
"""That of a peer that has none."""

SAME_LENGTHS = {
    "sphere": "Sphere",
    "capsule": "Capsule",
    "ellipsoid": "Ellipsoid",
    "cylinder": "Cylinder",
    "cone": "Cone",
    "box": "Box",
}
"""Kinds whose lengths Coal and FCL take in the same order, with the names that both have."""

Query = Callable[[Pose, Pose], PeerAnswer]


class Peer(ABC):
    """One package at one setting.

    Attributes
    ----------
    name : str
        Package and setting, as tables show it.
    package : str
        The distribution whose version counts.
    overlaps : bool
        Does it measure depths?
    """

    name: str
    package: str
    overlaps: bool = True

    @property
    def version(self) -> str:
        return version(self.package)

    @abstractmethod
    def query(self, a: Solid, b: Solid) -> Query | None:
        """Return the query of a pair; None where the package has no such pair."""


def require(name: str) -> Any:
    """Import a peer, or say how to get it.

    Raises
    ------
    ImportError
        The package is not installed.
    """
    try:
        return import_module(name)
    except ImportError as error:
        raise ImportError(not_installed(name)) from error


def not_installed(name: str) -> str:
    """What is said where a peer is missing."""
    return f"{name} is not installed; get it with: pip install 'standoff-studies[peers]'"


def by_points(distance: float, point_a: Array, point_b: Array) -> PeerAnswer:
    """Return the answer of a peer that reports no normal: the direction between its points.

    NaN where they coincide.
    """
    step = point_b - point_a
    length = float(np.linalg.norm(step))
    normal = step / length if length > 0 else np.full(3, np.nan)
    return PeerAnswer(distance, point_a, point_b, -normal if distance < 0 else normal)


def once_a_solid(make: Callable[[Solid], Any]) -> Callable[[Solid], Any]:
    """Keep what is made for each solid, which is equal to itself only."""
    return cache(make)
