"""Which pairs a robot watches, against the packages' own lists."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from robot_models import EXACT, MJCF, ROBOTS, SRDF, URDF, exact_robot, urdf

import standoff as so

mujoco = pytest.importorskip("mujoco")
pin = pytest.importorskip("pinocchio")


def names_of(model: object) -> list[str]:
    """The geometries' names; unnamed ones as a robot calls them."""
    found, counts = [], {}
    for k in range(model.ngeom):
        link = model.body(model.geom_bodyid[k]).name
        name = model.geom(k).name
        if not name:
            name = f"{link}/{counts.get(link, 0)}"
            counts[link] = counts.get(link, 0) + 1
        found.append(name)
    return found


def contacts_of(model: object) -> set[frozenset[str]]:
    """Pairs of which MuJoCo makes contacts where everything is near everything.

    Its own detection, all of it, with a margin beyond the size of the scene.
    """
    names = names_of(model)
    model.geom_margin[:] = model.pair_margin[:] = 1e3
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_MIDPHASE)
    data, found = mujoco.MjData(model), set()
    rng = np.random.default_rng(0)
    for _ in range(5):
        data.qpos[:] = model.qpos0
        mujoco.mj_integratePos(model, data.qpos, rng.normal(size=model.nv), 1.0)
        mujoco.mj_fwdPosition(model, data)
        for contact in data.contact:
            found.add(frozenset(names[g] for g in contact.geom))
    return found


EXTRA = {
    "as it is": lambda text: text,
    "parents too": lambda text: text.replace(
        'contact="enable"', 'contact="enable" filterparent="disable"'
    ),
    "no rules": lambda text: text[: text.index("<contact>")] + "</mujoco>",
}


@pytest.mark.parametrize("change", EXTRA)
def test_pairs_are_those_of_mujoco_s_collision_detection(change: str) -> None:
    model = mujoco.MjModel.from_xml_string(EXTRA[change](MJCF))
    robot = so.Robot.from_mujoco(model)
    assert {frozenset(pair) for pair in robot.pairs} == contacts_of(model)
    assert len(robot.pairs) >= 20


def test_pairs_are_those_of_pinocchio() -> None:
    path = str(urdf("panda"))
    model = pin.buildModelFromUrdf(path)
    geometry = pin.buildGeomFromUrdf(model, path, pin.GeometryType.COLLISION)
    geometry.addAllCollisionPairs()
    pin.removeCollisionPairs(model, geometry, str(ROBOTS / SRDF["panda"]), False)
    robot = so.Robot.from_pinocchio(model, geometry)
    objects = geometry.geometryObjects
    pairs = {(objects[p.first].name, objects[p.second].name) for p in geometry.collisionPairs}
    assert {frozenset(pair) for pair in pairs} == {frozenset(pair) for pair in robot.pairs}


@pytest.mark.parametrize("name", EXACT)
def test_pairs_of_a_urdf_are_all_but_neighbours_and_the_disabled(name: str) -> None:
    """By the tree that the file itself has, joint by joint."""
    import xml.etree.ElementTree as ET

    root = ET.parse(urdf(name)).getroot()
    welded = {link.get("name"): link.get("name") for link in root.iter("link")}
    joints = [
        (j.get("type"), j.find("parent").get("link"), j.find("child").get("link"))
        for j in root.findall("joint")
    ]

    def group(link: str) -> str:
        while welded[link] != link:
            link = welded[link]
        return link

    for kind, parent, child in joints:
        if kind == "fixed":
            welded[group(child)] = group(parent)
    near = {frozenset((group(p), group(c))) for kind, p, c in joints if kind != "fixed"}
    if name in SRDF:
        disabled = ET.parse(ROBOTS / SRDF[name]).getroot().iter("disable_collisions")
        apart = {frozenset((d.get("link1"), d.get("link2"))) for d in disabled}
    else:
        apart = set()
    robot = exact_robot(name)
    geoms = list(zip(robot.geoms.names, robot.geoms.links, strict=True))
    expected = {
        frozenset((a, b))
        for k, (a, link_a) in enumerate(geoms)
        for b, link_b in geoms[:k]
        if group(link_a) != group(link_b)
        and frozenset((group(link_a), group(link_b))) not in near
        and frozenset((link_a, link_b)) not in apart
    }
    assert {frozenset(pair) for pair in robot.pairs} == expected


@pytest.mark.parametrize(
    "given",
    [np.zeros((100, 3)), {"post": np.zeros((100, 3))}, {"post": (np.zeros((100, 3)), np.eye(4))}],
)
def test_an_array_is_no_obstacle_and_is_not_printed(given: object) -> None:
    with pytest.raises(so.StandoffError, match="an array of 100 by 3 numbers") as caught:
        exact_robot(next(iter(EXACT))).with_obstacles(given)
    assert "0., 0., 0.], [0., 0., 0.]" not in str(caught.value)
    assert "\n" not in str(caught.value)


def test_obstacles_are_pairs_with_all_that_moves(tmp_path: Path) -> None:
    path = tmp_path / "arms.urdf"
    path.write_text(URDF.format(grip="revolute"))
    ball = so.shapes.sphere(0.1)
    bare = so.Robot.from_urdf(path, mimic=True)
    robot = bare.with_obstacles({"ball": (ball, so.Pose(np.eye(3), [1.0, 0.0, 0.0]))})
    again = robot.with_obstacles({"floor": so.shapes.halfspace()})
    assert set(robot.pairs) - set(bare.pairs) == {
        (name, "ball")
        for name, joint in zip(bare.geoms.names, bare.geoms.joints, strict=True)
        if joint >= 0
    }
    assert again.geoms.names == (*bare.geoms.names, "ball", "floor")
    assert ("ball", "floor") not in again.pairs
    assert list(again.world.pairs()) == sorted(again.world.pairs(), key=again.pairs.index)
    assert {*map(frozenset, again.world.pairs())} == {*map(frozenset, again.pairs)}
    assert [row.became for row in again.report().geoms[-2:]] == ["given", "given"]
