"""What a URDF file itself says of links, joints and collision geometry, read strictly.

urdfdom leaves out what it cannot parse, with all other geometry of the link, and says so on the
standard error alone. This is read beside it: what is damaged is refused by link and element.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from standoff.checks.names import nearest, one_of
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError
from standoff.motion import Pose
from standoff.robots.frames import frame
from standoff.typing import Array

JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
LIMITED = ("revolute", "prismatic")
ALONG_AXIS = ("revolute", "continuous", "prismatic")

LIKE = 0.75
"""Likeness (difflib ratio, no unit) from which an unknown element is a known one misspelt: of
those that real files add, none is so like one."""


class Element(NamedTuple):
    """What an element of a URDF file has.

    Attributes
    ----------
    numbers : mapping of str to (int, str or None)
        Attributes: how many numbers, and what they are where the attribute is missing; None if it
        must be there.
    words : tuple of str
        Attributes that must be there.
    more : tuple of str or None
        Attributes that may be there; None: any.
    parts : tuple of str
        Elements of which there is at most one.
    """

    numbers: Mapping[str, tuple[int, str | None]] = {}
    words: tuple[str, ...] = ()
    more: tuple[str, ...] | None = ()
    parts: tuple[str, ...] = ()


ELEMENTS = {
    "origin": Element({"xyz": (3, "0 0 0"), "rpy": (3, "0 0 0")}),
    "box": Element({"size": (3, None)}),
    "sphere": Element({"radius": (1, None)}),
    "cylinder": Element({"radius": (1, None), "length": (1, None)}),
    "mesh": Element({"scale": (3, "1 1 1")}, ("filename",)),
    "geometry": Element({}, (), ("name",), ("box", "sphere", "cylinder", "mesh")),
    "collision": Element({}, (), ("name", "group"), ("origin", "geometry", "material", "verbose")),
    "mass": Element({"value": (1, None)}),
    "inertia": Element({f"i{ends}": (1, None) for ends in ("xx", "xy", "xz", "yy", "yz", "zz")}),
    "inertial": Element({}, (), (), ("origin", "mass", "inertia")),
    "parent": Element({}, ("link",)),
    "child": Element({}, ("link",)),
    "axis": Element({"xyz": (3, None)}),
    "limit": Element(
        {"lower": (1, "0"), "upper": (1, "0"), "effort": (1, None), "velocity": (1, None)},
        more=None,
    ),
    "mimic": Element({"multiplier": (1, "1"), "offset": (1, "0")}, ("joint",)),
    "dynamics": Element({"damping": (1, "0"), "friction": (1, "0")}, more=None),
    "safety_controller": Element(
        {
            **dict.fromkeys(("soft_lower_limit", "soft_upper_limit", "k_position"), (1, "0")),
            "k_velocity": (1, None),
        }
    ),
    "calibration": Element(dict.fromkeys(("rising", "falling"), (1, "0")), more=None),
}
"""Those that say where geometry is, and those without which urdfdom drops their link or joint."""

OF_LINK = ("inertial", "collision", "visual", "collision_checking")
OF_JOINT = ("origin", "parent", "child", "axis", "limit", "mimic", "dynamics")
MAY_BE_MISSING = ("safety_controller", "calibration")
OF_ROBOT = ("link", "joint")
UNUSED = ("material", "gazebo", "transmission", "sensor", "ros2_control")
"""Elements of a robot that say nothing of where its geometry is."""


INSTEAD = "; a capsule is a cylinder and two spheres, a collision each, and other shapes are meshes"


class Collision(NamedTuple):
    """One collision element.

    Attributes
    ----------
    name, link, kind : str
        The name is the one that Pinocchio gives it.
    size : tuple of float
        As in the file; of a mesh nothing.
    placement : (4, 4) array
        In the link's frame.
    """

    name: str
    link: str
    kind: str
    size: tuple[float, ...]
    placement: Array


class Joint(NamedTuple):
    """One joint.

    Attributes
    ----------
    name, kind, parent, child : str
    placement : (4, 4) array
        In the frame of its parent link.
    axis : (3,) array
        Of length 1.
    mimic : (str, float, float) or None
        The joint that it mimics, multiplier and offset.
    """

    name: str
    kind: str
    parent: str
    child: str
    placement: Array
    axis: Array
    mimic: tuple[str, float, float] | None


class UrdfTree(NamedTuple):
    """A file's links, joints and collision elements.

    Attributes
    ----------
    links : tuple of str
    joints : tuple of Joint
    collisions : tuple of Collision
    notes : tuple of str
    """

    links: tuple[str, ...]
    joints: tuple[Joint, ...]
    collisions: tuple[Collision, ...]
    notes: tuple[str, ...]


def read_tree(root: Any, file: str) -> UrdfTree:
    """Read a robot element.

    Raises StandoffError: an element that is damaged, by its link or joint, and what it is to be; no
    tree of links.
    """
    reader = _Reader(file)
    reader.check_expanded(root)
    reader.known(root, (*OF_ROBOT, *UNUSED), "the robot")
    links: list[str] = []
    collisions: list[Collision] = []
    for link in root.findall("link"):
        name = reader.name(link, links)
        links.append(name)
        collisions += reader.collisions(link, name)
    joints: list[Joint] = []
    for joint in root.findall("joint"):
        joints.append(reader.joint(joint, [each.name for each in joints]))
    reader.check_tree(links, joints)
    return UrdfTree(tuple(links), tuple(joints), tuple(collisions), tuple(reader.notes))


def masters(tree: UrdfTree, file: str) -> dict[str, tuple[str, float, float]]:
    """Of each joint that mimics another: the joint at the end of the chain, which mimics none, and
    the multiplier and offset by which its number counts.

    Raises StandoffError: a joint that mimics none that moves by one number, or itself.
    """
    joints = {joint.name: joint for joint in tree.joints}
    found = {}
    for joint in tree.joints:
        chain, ratio, offset = [joint], 1.0, 0.0
        while (mimic := chain[-1].mimic) is not None:
            master, multiplier, more = mimic
            ratio, offset = ratio * multiplier, ratio * more + offset
            kind = joints[master].kind if master in joints else None
            if kind not in ALONG_AXIS or master in [each.name for each in chain]:
                what = "no joint of the file" if kind is None else f"a {kind} joint"
                what = "in a circle with it" if kind in ALONG_AXIS else what
                raise StandoffError(
                    f"{file}: joint {joint.name!r}: <mimic>: {master!r} is {what}: name one that "
                    "turns or slides, or give mimic=False.",
                    "path",
                    file,
                )
            chain.append(joints[master])
        if len(chain) > 1:
            found[joint.name] = chain[-1].name, ratio, offset
    return found


class _Reader:
    def __init__(self, file: str) -> None:
        self.file = file
        self.notes: list[str] = []

    def error(self, where: str, what: str) -> StandoffError:
        return StandoffError(f"{self.file}: {where}: {what}", "path", self.file)

    # --- elements -----------------------------------------------------------------------------

    def check_expanded(self, root: Any) -> None:
        for element in root.iter():
            given = [element.tag, *element.attrib.values(), element.text or ""]
            wild = next((x for x in given if "xacro" in str(x) or "${" in x or "$(" in x), None)
            if wild is not None and element.tag not in UNUSED:
                raise self.error(
                    f"<{_local(element.tag)}>", f"{shown(wild)} is of xacro: expand the file first."
                )

    def known(self, element: Any, parts: tuple[str, ...], where: str, strict: bool = False) -> None:
        """Refuse elements that are known ones misspelt; note those that are not known."""
        strange = [x.tag for x in element if isinstance(x.tag, str) and x.tag not in parts]
        for tag in dict.fromkeys(strange):
            meant = nearest(_local(tag), parts, LIKE)
            if meant is not None:
                raise self.error(where, f"<{_local(tag)}> is no element of it: write <{meant}>.")
            if strict:
                raise self.error(
                    where, f"<{_local(tag)}> is no element of it: it has {one_of(parts)}."
                )
        if strange and element.tag != "robot":
            listed = ", ".join(f"<{_local(tag)}>" for tag in dict.fromkeys(strange))
            self.notes.append(f"{where} has {listed}, which is not read")

    def name(self, element: Any, taken: list[str]) -> str:
        name = element.get("name")
        if not name or not name.strip():
            raise self.error(f"<{element.tag}> {len(taken)}", "it has no name: give it one.")
        if name in taken:
            raise self.error(f"{element.tag} {name!r}", "there are two of this name: rename one.")
        return str(name)

    def part(self, element: Any, tag: str, where: str, needed: bool = False) -> Any:
        """The only element of a tag, or None."""
        found = element.findall(tag)
        if len(found) > 1:
            raise self.error(where, f"there are {len(found)} <{tag}>: keep one.")
        if not found and needed:
            raise self.error(where, f"<{tag}> is missing.")
        return found[0] if found else None

    def numbers(self, element: Any, where: str) -> dict[str, Array]:
        """The numbers of an element, all of whose attributes are known."""
        kind, tag = ELEMENTS[element.tag], element.tag
        at = f"{where}: <{tag}>"
        known = (*kind.numbers, *kind.words, *(kind.more or ()))
        for name in element.attrib:
            missing = [x for x in known if x not in element.attrib]
            meant = nearest(name, missing, *((LIKE,) if kind.more is None else ()))
            if name not in known and (kind.more is not None or meant):
                fix = f"write {meant}." if meant else f"it has {one_of(known) or 'none'}."
                raise self.error(at, f"{shown(name)} is no attribute of it: {fix}")
        for word in kind.words:
            if not (element.get(word) or "").strip():
                raise self.error(at, f"{word} is missing.")
        return {name: self._numbers(element, name, at) for name in kind.numbers}

    def _numbers(self, element: Any, name: str, at: str) -> Array:
        count, default = ELEMENTS[element.tag].numbers[name]
        text = element.get(name, default)
        if text is None:
            raise self.error(at, f"{name} is missing: give {_counted(count)}.")
        try:
            found = np.array([_number(x) for x in text.split()])
        except ValueError:
            found = np.zeros(0)
        if len(found) != count or not np.isfinite(found).all():
            raise self.error(
                at, f"{name}={shown(text)}: give {_counted(count)}, with spaces between them."
            )
        return found

    def placement(self, element: Any, where: str) -> Array:
        """(4, 4), of an element's origin."""
        origin = self.part(element, "origin", where)
        if origin is None:
            return np.eye(4)
        given = self.numbers(origin, where)
        roll, pitch, yaw = (
            Pose.exp(a * x, np.zeros(3)) for a, x in zip(given["rpy"], np.eye(3), strict=True)
        )
        return frame((yaw @ pitch @ roll).rotation, given["xyz"])

    # --- links --------------------------------------------------------------------------------

    def collisions(self, link: Any, name: str) -> list[Collision]:
        where = f"link {name!r}"
        self.known(link, OF_LINK, where)
        inertial = self.part(link, "inertial", where)
        if inertial is not None:
            self.known(inertial, ELEMENTS["inertial"].parts, f"{where}: <inertial>", True)
            self.placement(inertial, f"{where}: <inertial>")
            for tag in ("mass", "inertia"):
                self.numbers(self.part(inertial, tag, f"{where}: <inertial>", True), where)
        given = link.findall("collision")
        if not given and link.find("visual") is not None:
            self.notes.append(
                f"{where} has <visual> but no <collision>: no distance of it is known"
            )
        found = [
            self.collision(each, f"{name}_{k}", name, f"{where}: <collision> {k}")
            for k, each in enumerate(given)
        ]
        # Pinocchio's own extension: named cylinders are taken for capsules
        rounded = {each.get("name") for each in link.findall("collision_checking/capsule")}
        return [
            each._replace(kind="capsule")
            if each.kind == "cylinder" and element.get("name") in rounded
            else each
            for each, element in zip(found, given, strict=True)
        ]

    def collision(self, element: Any, name: str, link: str, where: str) -> Collision:
        self.known(element, ELEMENTS["collision"].parts, where, True)
        geometry = self.part(element, "geometry", where, True)
        kinds = ELEMENTS["geometry"].parts
        shapes = list(geometry)
        if len(shapes) != 1 or shapes[0].tag not in kinds:
            listed = ", ".join(f"<{_local(x.tag)}>" for x in shapes) or "nothing"
            raise self.error(
                where,
                f"<geometry> has {listed}: give one of {one_of(kinds)}{INSTEAD}.",
            )
        given = self.numbers(shapes[0], where)
        kind = str(shapes[0].tag)
        size = tuple(float(x) for numbers in given.values() for x in numbers)
        if kind != "mesh" and not all(x > 0.0 for x in size):
            raise self.error(f"{where}: <{kind}>", f"its sizes are {size}: give positive ones.")
        shape = () if kind == "mesh" else size
        return Collision(name, link, kind, shape, self.placement(element, where))

    # --- joints -------------------------------------------------------------------------------

    def joint(self, element: Any, taken: list[str]) -> Joint:
        name, kind = self.name(element, taken), element.get("type")
        where = f"joint {name!r}"
        if kind not in JOINT_TYPES:
            raise self.error(
                where, f"it is of the type {shown(kind)}; URDF has {one_of(JOINT_TYPES)}."
            )
        self.known(element, (*OF_JOINT, *MAY_BE_MISSING), where)
        ends = {}
        for tag in ("parent", "child"):
            end = self.part(element, tag, where, True)
            self.numbers(end, where)
            ends[tag] = str(end.get("link"))
        for tag in ("limit", "dynamics", *MAY_BE_MISSING):
            part = self.part(element, tag, where, tag == "limit" and kind in LIMITED)
            if part is not None:
                self.numbers(part, where)
        given = self.part(element, "axis", where)
        way = np.array([1.0, 0.0, 0.0]) if given is None else self.numbers(given, where)["xyz"]
        size = float(np.linalg.norm(way))
        if size == 0.0 and kind in (*ALONG_AXIS, "planar"):
            raise self.error(f"{where}: <axis>", "xyz is zero: give a direction.")
        if kind == "planar" and (way[:2] != 0.0).any():
            raise self.error(
                f"{where}: <axis>",
                f"xyz is {shown(way.tolist())}, and Pinocchio's planar joints lie in the plane of "
                "x and y: turn the joint's origin so that the axis is 0 0 1.",
            )
        mimic, follows = self.part(element, "mimic", where), None
        if mimic is not None and kind not in ALONG_AXIS:
            self.notes.append(f"{where} is {kind}, and mimics none")
        elif mimic is not None:
            numbers = self.numbers(mimic, where)
            ratio, offset = (float(numbers[x][0]) for x in ("multiplier", "offset"))
            follows = str(mimic.get("joint")), ratio, offset
        placement = self.placement(element, where)
        axis = way / (size or 1.0)
        return Joint(name, kind, ends["parent"], ends["child"], placement, axis, follows)

    def check_tree(self, links: list[str], joints: list[Joint]) -> None:
        """Refuse what is no tree of the links."""
        above: dict[str, Joint] = {}
        for joint in joints:
            where = f"joint {joint.name!r}"
            for tag, end in (("parent", joint.parent), ("child", joint.child)):
                if end not in links:
                    raise self.error(f"{where}: <{tag}>", f"there is no link {end!r}.")
            if joint.child in above:
                other = above[joint.child].name
                raise self.error(
                    f"link {joint.child!r}",
                    f"it is the child of the joints {other!r} and {joint.name!r}: a link has one "
                    "parent; take one of them away.",
                )
            above[joint.child] = joint
        if not links:
            raise self.error("the robot", "it has no <link>.")
        roots = [link for link in links if link not in above]
        if len(roots) != 1:
            raise self.error(
                "its links",
                f"{len(roots)} have no parent ({', '.join(roots[:8]) or 'they go in a circle'}): "
                "one must be the root.",
            )
        for link in links:
            at, steps = link, 0
            while at in above:
                at, steps = above[at].parent, steps + 1
                if steps > len(links):
                    raise self.error(f"link {link!r}", "its parents go in a circle.")


def _local(tag: Any) -> str:
    return str(tag).rpartition("}")[2]


def _number(text: str) -> float:
    """A number as C++ reads it: no digits in groups, no other scripts."""
    if not text.isascii() or "_" in text:
        raise ValueError
    return float(text)


def _counted(count: int) -> str:
    return "one finite number" if count == 1 else f"{count} finite numbers"


__all__ = ["Collision", "Joint", "UrdfTree", "masters", "read_tree"]
