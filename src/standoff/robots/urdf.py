"""Robots of URDF files, with the pairs that an SRDF file leaves out."""

from __future__ import annotations

import os
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any, NamedTuple

from standoff.checks.numbers import yes_or_no
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError, of_extra
from standoff.robots.loaded import Loaded
from standoff.robots.mimics import Followed, followed
from standoff.robots.pinocchio import Reading, assembled
from standoff.robots.shapes import MOST_NAMED, Meshes
from standoff.robots.urdf_checks import check_geometry, check_joints, places_of
from standoff.robots.urdf_meshes import stand_ins
from standoff.robots.urdf_pairs import disabled, pairs_left_out
from standoff.robots.urdf_xml import UrdfTree, masters, read_tree

with of_extra("Pinocchio", "pinocchio"):
    import pinocchio as pin

FOLDERS_ABOVE = 6
"""Folders above the file in which ``package://`` is sought too: ROS packages are no deeper."""


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
    tree = read_tree(root, path.name)
    free = yes_or_no(options.free_base, "free_base")
    follows = masters(tree, path.name) if _follows(tree, options.mimic, path) else {}
    left_out = pairs_left_out(tree, [name for name, (_, by, _) in follows.items() if not by])
    notes = list(tree.notes)
    if srdf is not None:
        apart, more = disabled(srdf, _parsed(srdf, "srdf"), tree.links)
        left_out, notes = apart | left_out, notes + more
    folders = [*options.package_dirs, *map(str, _above(path))]
    changed, shapes = stand_ins(
        root, tree.collisions, options.meshes, options.skip, (path, folders)
    )
    text = ET.tostring(changed, encoding="unicode")
    try:
        base = [pin.JointModelFreeFlyer()] if free else []
        model = pin.buildModelFromXML(text, *base)
        geometry = pin.buildGeomFromUrdfString(
            model, text, pin.GeometryType.COLLISION, package_dirs=folders
        )
    except (ValueError, RuntimeError, IndexError) as error:
        raise StandoffError(f"Pinocchio does not read {path}: {error}", "path", path) from error
    if not tree.collisions:
        raise StandoffError(
            f"{path} has links but no collision geometry, so that nothing has a distance: add "
            "<collision> to its links, or take another file of the robot.",
            "path",
            path,
        )
    places = places_of(tree, model)
    check_geometry(tree, geometry, places, shapes)
    reading = Reading(
        f"{path.name}",
        _numbered(model, follows),
        shapes,
        lambda a, b: left_out.get(frozenset((a, b))),
        tuple(notes),
    )
    found = assembled(model, geometry, (options.meshes, options.skip), reading)
    check_joints(tree, model, found.joints, places)
    return found


def _numbered(model: Any, follows: dict[str, tuple[str, float, float]]) -> Followed | None:
    """The joints that follow others, by their numbers in the model."""
    if not follows:
        return None
    at = {name: model.getJointId(name) for name in model.names}
    return followed(model, {at[j]: (at[m], ratio, more) for j, (m, ratio, more) in follows.items()})


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
        hint = (
            " Expand it by xacro first." if "xacro" in path.name or "prefix" in str(error) else ""
        )
        raise StandoffError(f"{path} is not XML: {error}.{hint}", argument, path) from error
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


def _follows(tree: UrdfTree, mimic: bool | None, path: Path) -> bool:
    """Do mimic joints follow those that they mimic?"""
    found = [joint.name for joint in tree.joints if joint.mimic is not None]
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
