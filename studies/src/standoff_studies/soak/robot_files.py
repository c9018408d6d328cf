"""Robots' files with one element damaged, judged by the file itself.

A URDF or MJCF file is drawn, and one attribute or element of it deleted, garbled, renamed or
doubled. It must be refused by an error of ours, or read as the file says: every collision geometry
of it, of its kind and size, where a tree of joints that is walked through here puts it, and the
pairs that the rule leaves. What is left out because its name is not known must be told in a note.
"""

from __future__ import annotations

import copy
import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.whole_files import write_whole

Array = NDArray[np.float64]
Draw = np.random.Generator

NEAR = 1e-9
"""Accuracy of the judge's places, length."""
GARBLED = (
    "1,5",
    "",
    "nan",
    "inf",
    "one",
    "1 2 3 4 5 6 7",
    "0x1",
    "--1",
    "1;2;3",
    "1e",
    "${r}",
    "１",
)
"""What is written in place of numbers."""


class Placed(NamedTuple):
    """A geometry as the judge has it: name, link, body, and where it is (4, 4)."""

    name: str
    link: str
    body: so.Body
    pose: Array


class Outcome(NamedTuple):
    """What came of one file; ``wrong`` is empty where the judge agrees."""

    kind: str
    damage: str
    became: str
    wrong: str


# --- files --------------------------------------------------------------------------------------


def numbers(rng: Draw, count: int, low: float = -0.5, high: float = 0.5) -> str:
    return " ".join(f"{x:.6g}" for x in rng.uniform(low, high, count))


def part(tag: str, **given: Any) -> ET.Element:
    return ET.Element(tag, {name: str(x) for name, x in given.items()})


def within(tag: str, *parts: ET.Element, **given: Any) -> ET.Element:
    made = part(tag, **given)
    made.extend(parts)
    return made


def drawn_shape(rng: Draw) -> ET.Element:
    kind = int(rng.integers(3))
    if kind == 0:
        return part("box", size=numbers(rng, 3, 0.05, 0.2))
    radius = numbers(rng, 1, 0.05, 0.2)
    if kind == 1:
        return part("sphere", radius=radius)
    return part("cylinder", radius=radius, length=numbers(rng, 1, 0.05, 0.3))


def drawn_origin(rng: Draw) -> ET.Element:
    return part("origin", xyz=numbers(rng, 3), rpy=numbers(rng, 3, -2.0, 2.0))


JOINTS = ("revolute", "continuous", "prismatic", "fixed", "planar", "floating")


def drawn_urdf(rng: Draw) -> ET.Element:
    """A tree of three to six links, each with a collision element or two."""
    robot = within("robot", part("material", name="red"), name="drawn")
    inertia = part("inertia", ixx=1, ixy=0, ixz=0, iyy=1, iyz=0, izz=1)
    count = int(rng.integers(3, 7))
    for k in range(count):
        shapes = [
            within("collision", drawn_origin(rng), within("geometry", drawn_shape(rng)))
            for _ in range(int(rng.integers(1, 3)))
        ]
        seen = within("visual", within("geometry", drawn_shape(rng)), part("material", name="red"))
        inertial = within("inertial", drawn_origin(rng), part("mass", value=1), inertia)
        robot.append(within("link", inertial, seen, *shapes, name=f"l{k}"))
    single: list[str] = []
    for k in range(1, count):
        kind = str(rng.choice(JOINTS, p=[0.35, 0.1, 0.25, 0.2, 0.05, 0.05]))
        axis = "0 0 1" if kind == "planar" else numbers(rng, 3, 0.2, 1.0)
        made = within(
            "joint",
            part("parent", link=f"l{rng.integers(k)}"),
            part("child", link=f"l{k}"),
            drawn_origin(rng),
            part("axis", xyz=axis),
            part("limit", lower=-2, upper=2, effort=1, velocity=1),
            part("dynamics", damping=0.1, friction=0),
            name=f"j{k}",
            type=kind,
        )
        if kind in ("revolute", "prismatic") and single and rng.random() < 0.3:
            made.append(
                part("mimic", joint=rng.choice(single), multiplier=numbers(rng, 1), offset=0.1)
            )
        if kind in ("revolute", "prismatic"):
            single.append(f"j{k}")
        robot.append(made)
    return robot


def drawn_mjcf(rng: Draw) -> ET.Element:
    """A chain of three to five bodies, with a geom or two and a joint or none."""
    world = within("worldbody", _geom(rng, "w"))
    above = world
    for k in range(int(rng.integers(3, 6))):
        body = part("body", name=f"b{k}", pos=numbers(rng, 3))
        if k == 0 or rng.random() < 0.8:
            kind = str(rng.choice(["hinge", "slide"]))
            body.append(
                part(
                    "joint",
                    name=f"j{k}",
                    type=kind,
                    axis=numbers(rng, 3, 0.2, 1.0),
                    pos=numbers(rng, 3),
                )
            )
        for n in range(int(rng.integers(1, 3))):
            body.append(_geom(rng, f"g{k}{n}"))
        above.append(body)
        above = body
    compiler = part("compiler", angle="radian", autolimits="true")
    return within("mujoco", compiler, world, model="drawn")


def _geom(rng: Draw, name: str) -> ET.Element:
    kind = str(rng.choice(["sphere", "capsule", "box", "cylinder"]))
    size = numbers(rng, {"sphere": 1, "capsule": 2, "box": 3, "cylinder": 2}[kind], 0.05, 0.2)
    return part("geom", name=name, type=kind, size=size, pos=numbers(rng, 3), mass=1)


# --- damage -------------------------------------------------------------------------------------


def misspelt(rng: Draw, word: str) -> str:
    """A word with a letter lost, doubled or swapped, in capitals, or another word."""
    k = int(rng.integers(len(word)))
    made = (
        word[:k] + word[k + 1 :] or "x",
        word[:k] + word[k] + word[k:],
        word[:k] + word[k : k + 2][::-1] + word[k + 2 :],
        word.capitalize(),
        f"my_own_{word[0]}",
    )
    return str(rng.choice([each for each in made if each != word]))


def damaged(rng: Draw, whole: ET.Element) -> tuple[ET.Element, str]:
    """A copy with one thing wrong, and what."""
    root = copy.deepcopy(whole)
    above = {child: element for element in root.iter() for child in element}
    element = list(above)[int(rng.integers(len(above)))]
    kind = str(
        rng.choice(["delete", "delete attribute", "garble", "rename", "rename attribute", "double"])
    )
    if "attribute" in kind or kind == "garble":
        if not element.attrib:
            return root, "nothing"
        name = str(rng.choice(list(element.attrib)))
        value = element.attrib[name]
        if kind == "garble":
            element.set(name, str(rng.choice([x for x in GARBLED if x != value])))
        else:
            del element.attrib[name]
        if kind == "rename attribute":
            element.set(misspelt(rng, name), value)
        return root, f"{kind} {name} of {element.tag}"
    tag = element.tag
    if kind == "delete":
        above[element].remove(element)
    elif kind == "rename":
        element.tag = misspelt(rng, tag)
    else:
        above[element].append(copy.deepcopy(element))
    return root, f"{kind} {tag}"


# --- the judge ----------------------------------------------------------------------------------


def read(element: ET.Element | None, name: str, count: int, default: str = "") -> Array:
    """Numbers of an attribute; ValueError if it does not have so many."""
    text = default if element is None else element.get(name, default)
    found = np.array([float(x) for x in text.split()])
    if len(found) != count or not text.isascii() or not np.isfinite(found).all():
        raise ValueError(f"{name}={text!r}")
    return found


def moved(kind: str, axis: Array, number: float) -> Array:
    """(4, 4) the motion of a hinge or slide."""
    pose, axis = np.eye(4), axis / np.linalg.norm(axis)
    if kind in ("prismatic", "slide"):
        pose[:3, 3] = number * axis
    else:
        pose[:3, :3] = Rotation.from_rotvec(number * axis).as_matrix()
    return pose


def at_origin(element: ET.Element) -> Array:
    """(4, 4) of an element's origin."""
    origin, pose = element.find("origin"), np.eye(4)
    pose[:3, 3] = read(origin, "xyz", 3, "0 0 0")
    pose[:3, :3] = Rotation.from_euler("xyz", read(origin, "rpy", 3, "0 0 0")).as_matrix()
    return pose


def shape_of(geometry: ET.Element) -> so.Body:
    for shape in geometry:
        if shape.tag == "box":
            return so.shapes.box(*read(shape, "size", 3))
        radius = read(shape, "radius", 1)[0]
        if shape.tag == "sphere":
            return so.shapes.sphere(radius)
        return so.shapes.cylinder(radius, read(shape, "length", 1)[0])
    raise ValueError("no shape")


def numbers_of(robot: so.Robot, q: Array) -> Callable[[str], Array]:
    """The numbers of q of a joint by its name, or of its first motion."""
    joints = robot.joints

    def found(name: str) -> Array:
        own = name if name in joints.names else f"{name}/0"
        return q[int(joints.q_at[joints.names.index(own)]) :]

    return found


def urdf_placed(root: ET.Element, of: Callable[[str], Array]) -> list[Placed]:
    """All collision geometries of a URDF file where the file puts them."""
    joints = {joint.find("child").get("link"): joint for joint in root.findall("joint")}  # type: ignore[union-attr]
    by_name = {joint.get("name"): joint for joint in root.findall("joint")}

    def number(name: str) -> float:
        joint = by_name[name]
        mimic = joint.find("mimic")
        if mimic is not None:
            ratio, offset = read(mimic, "multiplier", 1, "1")[0], read(mimic, "offset", 1, "0")[0]
            return float(ratio * number(str(mimic.get("joint"))) + offset)
        given = of(name)
        turns = joint.get("type") == "continuous"
        return float(np.arctan2(given[1], given[0]) if turns else given[0])

    def motion(joint: ET.Element) -> Array:
        name, kind = str(joint.get("name")), joint.get("type")
        pose = np.eye(4)
        if kind == "planar":
            x, y, c, s = of(name)[:4]
            pose[:2, 3], pose[:2, :2] = (x, y), ((c, -s), (s, c))
        elif kind == "floating":
            pose[:3, 3] = of(name)[:3]
            pose[:3, :3] = Rotation.from_quat(of(name)[3:7]).as_matrix()
        elif kind != "fixed":
            pose = moved(str(kind), read(joint.find("axis"), "xyz", 3, "1 0 0"), number(name))
        return pose

    def pose(link: str) -> Array:
        if link not in joints:
            return np.eye(4)
        joint = joints[link]
        above = pose(str(joint.find("parent").get("link")))  # type: ignore[union-attr]
        return np.asarray(above @ at_origin(joint) @ motion(joint))

    found = []
    for link in root.findall("link"):
        name = str(link.get("name"))
        for k, collision in enumerate(link.findall("collision")):
            geometry = collision.find("geometry")
            if geometry is None:
                raise ValueError("no geometry")
            where = pose(name) @ at_origin(collision)
            found.append(Placed(f"{name}_{k}", name, shape_of(geometry), where))
    return found


def urdf_pairs(root: ET.Element, placed: list[Placed]) -> set[frozenset[str]]:
    """By the rule: not rigid to each other, and not joined by one joint."""
    joined = {
        frozenset((j.find("parent").get("link"), j.find("child").get("link")))  # type: ignore[union-attr]
        for j in root.findall("joint")
    }
    still = {
        frozenset((j.find("parent").get("link"), j.find("child").get("link")))  # type: ignore[union-attr]
        for j in root.findall("joint")
        if j.get("type") == "fixed" or _stands(root, j)
    }

    def group(link: str) -> set[str]:
        found, before = {link}, 0
        while len(found) > before:
            before = len(found)
            for pair in still:
                found |= set(pair) if found & set(pair) else set()  # type: ignore[arg-type]
        return found

    groups = {link: group(link) for link in {each.link for each in placed}}
    return {
        frozenset((a.name, b.name))
        for k, a in enumerate(placed)
        for b in placed[:k]
        if b.link not in groups[a.link] and frozenset((a.link, b.link)) not in joined
    }


def _stands(root: ET.Element, joint: ET.Element) -> bool:
    mimic = joint.find("mimic")
    if mimic is None:
        return False
    master = next(j for j in root.findall("joint") if j.get("name") == mimic.get("joint"))
    return read(mimic, "multiplier", 1, "1")[0] == 0.0 or _stands(root, master)


def read_mjcf(element: ET.Element, name: str, default: str) -> Array:
    """Numbers of an attribute as MuJoCo reads them: nothing is the default, and 0x1 is one."""
    text = (element.get(name) or default).split()
    return np.array([float.fromhex(x) if "x" in x else float(x) for x in text])


def mjcf_placed(root: ET.Element, of: Callable[[str], Array]) -> list[Placed]:
    """All geoms of an MJCF file where the file puts them."""
    found: list[Placed] = []
    seen: list[str] = []

    def geom(each: ET.Element, link: str, pose: Array) -> None:
        kind, at = each.get("type", "sphere"), np.eye(4)
        size = read_mjcf(each, "size", "")
        at[:3, 3] = read_mjcf(each, "pos", "0 0 0")
        body = {
            "sphere": lambda: so.shapes.sphere(size[0]),
            "capsule": lambda: so.shapes.capsule(size[0], 2.0 * size[1]),
            "cylinder": lambda: so.shapes.cylinder(size[0], 2.0 * size[1]),
            "box": lambda: so.shapes.box(*(2.0 * size[:3])),
        }[kind]()
        found.append(Placed(each.get("name", ""), link, body, pose @ at))

    def walk(body: ET.Element, link: str, pose: Array) -> None:
        for joint in body.findall("joint"):
            anchor = np.eye(4)
            anchor[:3, 3] = read_mjcf(joint, "pos", "0 0 0")
            axis = read_mjcf(joint, "axis", "0 0 1")
            name = joint.get("name") or f"joint {len(seen)}"
            seen.append(name)
            turn = moved(joint.get("type", "hinge"), axis, float(of(name)[0]))
            pose = pose @ anchor @ turn @ np.linalg.inv(anchor)
        for each in body.findall("geom"):
            geom(each, link, pose)
        for child in body.findall("body"):
            place = np.eye(4)
            place[:3, 3] = read_mjcf(child, "pos", "0 0 0")
            walk(child, child.get("name", ""), pose @ place)

    for world in root.findall("worldbody"):
        walk(world, "world", np.eye(4))
    return found


# --- one case -----------------------------------------------------------------------------------


def case_of(seed: int, number: int, folder: Path) -> Outcome:
    """One file with one thing wrong."""
    rng = np.random.default_rng((seed, number))
    kind = "urdf" if number % 3 else "mjcf"
    whole = drawn_urdf(rng) if kind == "urdf" else drawn_mjcf(rng)
    root, damage = damaged(rng, whole)
    path = folder / f"drawn.{'urdf' if kind == 'urdf' else 'xml'}"
    write_whole({path: lambda file: file.write(ET.tostring(root))})
    try:
        if kind == "urdf":
            robot = so.Robot.from_urdf(path, mimic=True)
        else:
            robot = so.Robot.from_mujoco(path)
    except so.StandoffError as error:
        wrong = "" if damage != "nothing" else f"refused, whole as it is: {error}"
        return Outcome(kind, damage, "refused", wrong)
    except Exception as error:
        return Outcome(kind, damage, "raised", f"{type(error).__name__}: {error}")
    try:
        wrong = judged(robot, root, whole, kind, rng)
    except (ValueError, KeyError, AttributeError, StopIteration, IndexError) as error:
        wrong = f"read, though the file is damaged: {type(error).__name__} {error}"
    return Outcome(kind, damage, "read", wrong)


def judged(robot: so.Robot, root: ET.Element, whole: ET.Element, kind: str, rng: Draw) -> str:
    """What of a robot is not as its file says."""
    kinematics = robot.kinematics
    q = kinematics.integrate(kinematics.neutral(), rng.uniform(-1.0, 1.0, robot.nv))
    of = numbers_of(robot, q)
    placed = urdf_placed(root, of) if kind == "urdf" else mjcf_placed(root, of)
    poses = dict(zip(robot.geoms.names, robot.poses(q), strict=True))
    bodies = dict(zip(robot.geoms.names, robot.geoms.bodies, strict=True))
    if len(placed) != len(poses):
        return f"{len(poses)} geometries of {len(placed)}"
    for each in placed:
        name = each.name or next(iter(set(poses) - {other.name for other in placed}))
        if name not in poses or getattr(bodies[name], "digest", "") != each.body.digest:
            return f"{name} is not there, or is another body"
        if not np.abs(poses[name] - each.pose).max() <= NEAR:
            return f"{name} is {np.abs(poses[name] - each.pose).max():.3g} off"
    if kind == "urdf" and urdf_pairs(root, placed) != {frozenset(p) for p in robot.pairs}:
        return "other pairs are watched"
    lost = _unknown(root, whole)
    if lost and not any(lost in note for note in robot.report().notes):
        return f"<{lost}> is not read, and no note says so"
    return ""


def _unknown(root: ET.Element, whole: ET.Element) -> str:
    """The element of a link or joint that has a name which the whole file does not have."""
    known = {element.tag for element in whole.iter()}
    inner = (child for tag in ("link", "joint") for each in root.findall(tag) for child in each)
    return next((child.tag for child in inner if child.tag not in known), "")
