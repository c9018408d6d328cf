"""Bodies that stand in the world beside a robot."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

import numpy as np

from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.motion import Pose
from standoff.robots.geoms import WORLD, Geoms
from standoff.world import Compound
from standoff.world.pieces import name_of
from standoff.world.shapes import Shape, as_shape

Obstacles = dict[str, tuple[Shape | Compound, Pose]]
"""By name: the body or solid, and its pose in the world."""


def read_obstacles(given: Any, taken: Collection[str]) -> Obstacles:
    """Obstacles by name.

    Raises StandoffTypeError, StandoffError: no mapping, no body, no pose, a name that a geometry
    has.
    """
    if not isinstance(given, Mapping):
        raise StandoffTypeError(
            f"obstacles = {shown(given)}: give a mapping of names to (body, pose).",
            "obstacles",
            given,
        )
    found: Obstacles = {}
    for name, what in given.items():
        if name_of(name) in taken:
            raise StandoffError(
                f"obstacles has {name!r}, which is a geometry or an obstacle of the robot already: "
                "give it another name.",
                "obstacles",
                name,
            )
        body, pose = what if isinstance(what, tuple) and len(what) == 2 else (what, None)
        shape = body if isinstance(body, Compound) else as_shape(body)
        if shape is None:
            raise StandoffTypeError(
                f"The obstacle {name!r} is {shown(what)}: give (body, pose), with a Body, a Solid "
                "or a Compound.",
                "obstacles",
                what,
            )
        try:
            found[name] = shape, Pose.identity() if pose is None else Pose.of(pose)
        except StandoffError as error:
            raise type(error)(f"The obstacle {name!r}: {error}", "obstacles", what) from error
    return found


def with_obstacles(geoms: Geoms, obstacles: Obstacles) -> Geoms:
    """Geometries with the obstacles after them, each a link of its own."""
    if not obstacles:
        return geoms
    names = tuple(obstacles)
    poses = np.array([pose.matrix for _, pose in obstacles.values()])
    return Geoms(
        geoms.names + names,
        geoms.links + names,
        np.concatenate([geoms.joints, np.full(len(names), WORLD)]),
        np.concatenate([geoms.placements, poses]),
        geoms.bodies + tuple(body for body, _ in obstacles.values()),
    )
