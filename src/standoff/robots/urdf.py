"""Robots of URDF files, with the pairs that an SRDF file leaves out."""

from __future__ import annotations

import os
import xml.etree.ElementTree as ET
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from standoff.checks.numbers import yes_or_no
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError, of_extra
from standoff.robots.joints import Joints
from standoff.robots.loaded import Loaded
from standoff.robots.mimics import MimicModel, followed
from standoff.robots.pinocchio import Reading, assembled
from standoff.robots.pinocchio_shapes import read_shape
from standoff.robots.report import RIGID
from standoff.robots.shapes import MOST_NAMED, Meshes
from standoff.robots.tolerances import SAME_READING
from standoff.robots.urdf_meshes import Shapes, stand_ins
from standoff.robots.urdf_xml import ALONG_AXIS, UrdfTree, masters, read_tree

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


def _numbered(model: Any, follows: dict[str, tuple[str, float, float]]) -> MimicModel | None:
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


# What Pinocchio made of a URDF file, held against the file.

with of_extra("Pinocchio", "pinocchio"):
    import pinocchio as pin


def check_geometry(tree: UrdfTree, geometry: Any, places: dict[str, Any], shapes: Shapes) -> None:
    """Hold the geometries against the collision elements: all of them, their kinds, sizes and
    places. ``places``: of each link (Pinocchio's frame of it).

    Raises StandoffError: the first that is not there, or not as in the file.
    """
    objects = {x.name: x for x in geometry.geometryObjects}
    for each in tree.collisions:
        where = f"link {each.link!r}: <collision> {each.name.removeprefix(each.link + '_')}"
        found = objects.pop(each.name, None)
        if found is None:
            raise StandoffError(
                f"{where} (<{each.kind}>) is not in what Pinocchio read of the file: something of "
                "the link is not as URDF has it; see what urdfdom printed, or leave the link out "
                "of the file.",
                "path",
            )
        of_link = places[each.link].placement
        placed = of_link.actInv(found.placement).homogeneous
        same = _near(placed, each.placement)
        if each.name not in shapes:
            kind, size, _ = read_shape(found.geometry)
            same &= kind == each.kind and _near(size[:-1], each.size) if each.size else True
        if not same:
            raise StandoffError(
                f"{where} (<{each.kind}>) is not what Pinocchio read of the file. Please report "
                "the file.",
                "path",
            )
    if objects:
        names = ", ".join(sorted(objects))
        raise StandoffError(f"Pinocchio read geometries that the file does not have: {names}.")


def check_joints(tree: UrdfTree, model: Any, joints: Joints, places: dict[str, Any]) -> None:
    """Hold the joints' places and axes against the file.

    Raises StandoffError.
    """
    data = model.createData()
    pin.framesForwardKinematics(model, data, pin.neutral(model))
    poses = {link: data.oMf[model.getFrameId(link, pin.FrameType.BODY)] for link in places}
    for joint in tree.joints:
        apart = poses[joint.parent].actInv(poses[joint.child]).homogeneous
        same = _near(apart, joint.placement)
        if joint.kind in ALONG_AXIS:
            same &= joint.name in joints.names
            same = same and _near(joints.axes[joints.names.index(joint.name)], joint.axis)
        if not same:
            raise StandoffError(
                f"joint {joint.name!r} is not what Pinocchio read of the file. Please report the "
                "file.",
                "path",
            )


def places_of(tree: UrdfTree, model: Any) -> dict[str, Any]:
    """Pinocchio's frame of each link.

    Raises StandoffError: a link that Pinocchio did not read.
    """
    found = {}
    for link in tree.links:
        if not model.existFrame(link, pin.FrameType.BODY):
            raise StandoffError(f"link {link!r} is not in what Pinocchio read of the file.", "path")
        found[link] = model.frames[model.getFrameId(link, pin.FrameType.BODY)]
    return found


def _near(given: Any, wanted: Any) -> bool:
    a, b = np.asarray(given, dtype=float), np.asarray(wanted, dtype=float)
    if a.shape != b.shape:
        return False
    return bool((np.abs(a - b) <= SAME_READING * np.maximum(1.0, np.abs(b))).all())


# Which pairs of a URDF file's geometries are left out, and why.

Pairs = Mapping[frozenset[str], str]
"""Of two links, or of one: why nothing of them is watched."""


def pairs_left_out(tree: UrdfTree, standing: Collection[str]) -> dict[frozenset[str], str]:
    """Links that are rigid to each other, and those that one joint of the file joins.

    ``standing``: joints that do not move, beside those that are fixed.
    """
    groups = {link: [link] for link in tree.links}
    for joint in tree.joints:
        if joint.kind == "fixed" or joint.name in standing:
            one = groups[joint.parent] + groups[joint.child]
            groups.update(dict.fromkeys(one, one))
    found = {
        frozenset((joint.parent, joint.child)): f"joined by the joint {joint.name!r}"
        for joint in tree.joints
    }
    for link in tree.links:
        found |= {frozenset((link, other)): RIGID for other in groups[link]}
    return found


def disabled(
    srdf: Path, root: Any, links: Collection[str]
) -> tuple[dict[frozenset[str], str], list[str]]:
    """Links whose pairs an SRDF disables, and what should be known of the file.

    Raises StandoffError: an entry that names fewer than two links; a file of another robot, which
    names none of this one's.
    """
    found: dict[frozenset[str], str] = {}
    notes: list[str] = []
    named: set[str] = set()
    for entry in root.iter("disable_collisions"):
        pair = [(entry.get(end) or "").strip() for end in ("link1", "link2")]
        if not all(pair):
            raise StandoffError(
                f"{srdf}: {ET.tostring(entry, encoding='unicode').strip()} names no two links: "
                "give link1 and link2.",
                "srdf",
                srdf,
            )
        named.update(pair)
        reason = entry.get("reason")
        found[frozenset(pair)] = "disabled by the SRDF" + (f" ({reason})" if reason else "")
    strange = sorted(named - set(links))
    if named and len(strange) == len(named):
        raise StandoffError(
            f"{srdf} is of another robot: it names links {', '.join(strange[:MOST_NAMED])}"
            ", of which the URDF has none.",
            "srdf",
            srdf,
        )
    if strange:
        notes.append(f"{srdf.name} names links that the robot does not have: {', '.join(strange)}")
    if not named:
        notes.append(f"{srdf.name} disables no pair")
    unread = sorted({x.tag for x in root if x.tag in UNREAD})
    if unread:
        listed = ", ".join(f"<{tag}>" for tag in unread)
        notes.append(f"{srdf.name} has {listed}, which is not read")
    return found, notes


UNREAD = ("disable_default_collisions", "enable_collisions", "link_sphere_approximation")
"""Elements of an SRDF that speak of collisions too."""
