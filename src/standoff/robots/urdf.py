"""Robots of URDF files, with the pairs that an SRDF file leaves out."""

from __future__ import annotations

import os
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from standoff.checks.names import one_of
from standoff.checks.numbers import yes_or_no
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError, not_installed
from standoff.robots.loaded import Loaded
from standoff.robots.pinocchio import assembled
from standoff.robots.shapes import MOST_NAMED, Meshes
from standoff.robots.urdf_meshes import stand_ins

try:
    import pinocchio as pin
except ModuleNotFoundError as error:
    raise ModuleNotFoundError(not_installed("Pinocchio", "pinocchio"), name=error.name) from error

FOLDERS_ABOVE = 6
"""Folders above the file in which ``package://`` is sought too: ROS packages are no deeper."""

JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")


class UrdfOptions(NamedTuple):
    """See ``Robot.from_urdf``."""

    package_dirs: tuple[str, ...]
    free_base: bool
    mimic: bool | None
    meshes: Meshes
    skip: tuple[str, ...]


def load(path: Any, srdf: Any, options: UrdfOptions) -> Loaded:
    """See ``Robot.from_urdf``."""
    path = _file(path, "path")
    srdf = None if srdf is None else _file(srdf, "srdf")
    root = _parsed(path, "path")
    _check_joints(root, path)
    free = yes_or_no(options.free_base, "free_base")
    follow = _follows(root, options.mimic, path)
    folders = [*options.package_dirs, *map(str, _above(path))]
    changed, kinds = stand_ins(root, options.meshes, options.skip, (path, folders))
    what = f"{path.name}"
    text = ET.tostring(changed, encoding="unicode")
    try:
        base = [pin.JointModelFreeFlyer()] if free else []
        model = pin.buildModelFromXML(text, *base, mimic=follow)
        geometry = pin.buildGeomFromUrdfString(
            model, text, pin.GeometryType.COLLISION, package_dirs=folders
        )
    except (ValueError, RuntimeError) as error:
        raise StandoffError(f"Pinocchio does not read {path}: {error}", "path", path) from error
    if not geometry.ngeoms:
        raise StandoffError(
            f"{path} has links but no collision geometry, so that nothing has a distance: add "
            "<collision> to its links, or take another file of the robot.",
            "path",
            path,
        )
    _add_pairs(model, geometry, srdf)
    pairs = [(int(p.first), int(p.second)) for p in geometry.collisionPairs]
    return assembled(model, geometry, pairs, (options.meshes, options.skip), what, kinds)


def _file(given: Any, argument: str) -> Path:
    if not isinstance(given, str | Path):
        raise StandoffTypeError(
            f"{argument} = {shown(given)}: give the path of a file.", argument, given
        )
    if not os.path.isfile(given):
        raise FileNotFoundError(f"{argument}: there is no file {shown(str(given))}.")
    return Path(given).absolute()


def _parsed(path: Path, argument: str) -> Any:
    try:
        root = ET.parse(path).getroot()
    except ET.ParseError as error:
        raise StandoffError(f"{path} is not XML: {error}", argument, path) from error
    if root.tag != "robot":
        hint = " Expand it by xacro first." if path.suffix == ".xacro" else ""
        raise StandoffError(
            f"{path} begins with <{root.tag}>, where a robot's file has <robot>.{hint}",
            argument,
            path,
        )
    return root


def _above(path: Path) -> list[Path]:
    return list(path.parents[:FOLDERS_ABOVE])


def _check_joints(root: Any, path: Path) -> None:
    """Refuse joints of a kind that URDF does not have, by name.

    Raises
    ------
    StandoffError
    """
    for joint in root.findall("joint"):  # those of transmissions have no type
        kind = joint.get("type")
        if kind is not None and kind not in JOINT_TYPES:
            raise StandoffError(
                f"{path.name}: the joint {joint.get('name', '?')!r} is of the type {kind!r}; URDF "
                f"has {one_of(JOINT_TYPES)}.",
                "path",
                path,
            )


def _follows(root: Any, mimic: bool | None, path: Path) -> bool:
    """Do mimic joints follow those that they mimic?"""
    found = [
        joint.get("name", "?") for joint in root.iter("joint") if joint.find("mimic") is not None
    ]
    if mimic is not None:
        return yes_or_no(mimic, "mimic")
    if not found:
        return False
    named = ", ".join(found[:MOST_NAMED]) + (", ..." if len(found) > MOST_NAMED else "")
    raise StandoffError(
        f"{path.name} has {len(found)} joints that mimic another ({named}): give mimic=True so "
        "that they follow it and are not in q, or mimic=False so that each has its own number "
        "in q.",
        "mimic",
        mimic,
    )


def _add_pairs(model: Any, geometry: Any, srdf: Path | None) -> None:
    """All pairs but neighbours, less those that the SRDF disables."""
    geometry.addAllCollisionPairs()
    carriers = [int(x.parentJoint) for x in geometry.geometryObjects]
    # by numbers: what Pinocchio hands out are references, which a removal moves
    for first, second in [(int(p.first), int(p.second)) for p in geometry.collisionPairs]:
        i, j = carriers[first], carriers[second]
        if i == model.parents[j] or j == model.parents[i]:
            geometry.removeCollisionPair(pin.CollisionPair(first, second))
    if srdf is None:
        return
    _check_links(srdf, [frame.name for frame in model.frames])
    pin.removeCollisionPairs(model, geometry, str(srdf), False)


def _check_links(srdf: Path, names: Sequence[str]) -> None:
    """Refuse an SRDF of another robot: one that disables no link that this one has."""
    root = _parsed(srdf, "srdf")
    disabled = {
        name
        for entry in root.iter("disable_collisions")
        for name in (entry.get("link1"), entry.get("link2"))
        if name
    }
    if disabled and not disabled & set(names):
        raise StandoffError(
            f"{srdf} is of another robot: it names links {', '.join(sorted(disabled)[:MOST_NAMED])}"
            ", of which the URDF has none.",
            "srdf",
            srdf,
        )
