"""What Pinocchio made of a URDF file, held against the file."""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.errors import StandoffError, of_extra
from standoff.robots.joints import Joints
from standoff.robots.pinocchio_shapes import read_shape
from standoff.robots.tolerances import SAME_READING
from standoff.robots.urdf_meshes import Shapes
from standoff.robots.urdf_xml import ALONG_AXIS, UrdfTree

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
