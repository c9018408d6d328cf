"""Which pairs a robot watches, against the packages' own lists."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from robot_models import EXACT, MJCF, ROBOTS, SRDF, URDF, exact_robot, urdf

import standoff as so
from standoff.robots.report import RIGID, STILL

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


def welded_to(model: object, body: int) -> int:
    """The body at the end of those that have no joints: what this one is rigid to."""
    while body and not model.body_jntnum[body]:
        body = int(model.body_parentid[body])
    return body


@pytest.mark.parametrize("change", EXTRA)
def test_pairs_are_mujoco_s_and_those_of_bodies_welded_to_a_neighbour(change: str) -> None:
    """MuJoCo takes welded bodies for one before it looks for parent and child."""
    model = mujoco.MjModel.from_xml_string(EXTRA[change](MJCF))
    robot = so.Robot.from_mujoco(model)
    own, names = contacts_of(model), names_of(model)
    watched = {frozenset(pair) for pair in robot.pairs}
    assert own <= watched
    excluded = [frozenset(("base", "lower"))] if "<exclude" in EXTRA[change](MJCF) else []
    bodies = dict(zip(names, model.geom_bodyid.tolist(), strict=True))
    for pair in watched - own:
        a, b = (bodies[name] for name in pair)
        assert a not in (b, model.body_parentid[b])
        assert b != model.body_parentid[a]
        assert welded_to(model, a) != welded_to(model, b)
        assert frozenset(model.body(x).name for x in (a, b)) not in excluded
    more = len(watched - own)
    assert more == {"as it is": 3, "parents too": 0, "no rules": 3}[change]
    noted = [note for note in robot.report().notes if "welded" in note]
    assert [note.split()[0] for note in noted] == ([str(more)] if more else [])
    assert len(robot.pairs) >= 20
    count = len(robot.geoms.names)
    assert len(robot.report().left_out) + len(robot.pairs) == count * (count - 1) // 2


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
    near = {frozenset((parent, child)) for _, parent, child in joints}
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
        and frozenset((link_a, link_b)) not in near
        and frozenset((link_a, link_b)) not in apart
    }
    assert {frozenset(pair) for pair in robot.pairs} == expected


@pytest.mark.parametrize(
    ("name", "more"), [("baxter", 51), ("tiago", 61), ("pr2", 11), ("panda", 3)]
)
def test_links_beyond_a_fixed_joint_are_watched(name: str, more: int) -> None:
    """Pairs of links that are lost where fixed links are merged before neighbours are taken."""
    from standoff.robots.urdf import pairs_left_out
    from standoff.robots.urdf_xml import read_tree

    file = {"tiago": "tiago_description/robots/tiago.urdf", "pr2": "pr2_description/urdf/pr2.urdf"}
    path = ROBOTS / file[name] if name in file else urdf(name)
    tree = read_tree(ET.parse(path).getroot(), path.name)
    left_out = pairs_left_out(tree, ())
    rigid = {link: {link} for link in tree.links}
    for pair, reason in left_out.items():
        if reason == RIGID:
            for link in pair:
                rigid[link] |= pair
    joined = [pair for pair, reason in left_out.items() if reason != RIGID]
    merged = {
        frozenset((a, b))
        for pair in joined
        for x, y in [tuple(pair)]
        for a in rigid[x]
        for b in rigid[y]
    }
    geoms = [each.link for each in tree.collisions]
    lost = {
        frozenset((a, b))
        for k, a in enumerate(geoms)
        for b in geoms[:k]
        if frozenset((a, b)) in merged - set(left_out)
    }
    assert len(lost) == more


def test_a_boom_meets_a_post_that_is_fixed_to_its_base(tmp_path: Path) -> None:
    """The same robot as URDF and as MJCF; what the MJCF watches beside is told."""
    shapes = {
        "base": ("sphere radius='.1'", "0 0 0"),
        "post": ("cylinder radius='.1' length='2'", "0 0 0"),
        "boom": ("box size='1.5 .1 .1'", "0.85 0 0"),
    }
    links = "".join(
        f"<link name='{name}'><collision><origin xyz='{at}'/><geometry><{shape}/></geometry>"
        "</collision></link>"
        for name, (shape, at) in shapes.items()
    )
    path = tmp_path / "boom.urdf"
    path.write_text(
        f"<robot name='r'>{links}<joint name='f' type='fixed'><parent link='base'/>"
        "<child link='post'/><origin xyz='1 0 0'/></joint><joint name='j' type='continuous'>"
        "<parent link='base'/><child link='boom'/><axis xyz='0 0 1'/></joint></robot>"
    )
    model = """<mujoco><worldbody><body name="base"><freejoint/><geom name="base" size=".1"/>
<body name="post" pos="1 0 0"><geom name="post" type="cylinder" size=".1 1"/></body>
<body name="boom"><joint name="j" axis="0 0 1"/>
<geom name="boom" type="box" size=".75 .05 .05" pos=".85 0 0"/>
</body></body></worldbody></mujoco>"""
    one = so.Robot.from_urdf(path, free_base=True)
    other = so.Robot.from_mujoco(mujoco.MjModel.from_xml_string(model))
    assert {frozenset(x.removesuffix("_0") for x in pair) for pair in one.pairs} == {
        frozenset(pair) for pair in other.pairs
    }
    still = so.Robot.from_urdf(path)
    turns = [[np.cos(a), np.sin(a)] for a in (-1.0, 1.0)]
    proof = still.certify(turns, clearance=0.01)
    assert (proof.verdict.name, set(proof.witness.links)) == ("VIOLATED", {"boom", "post"})
    assert {pair[2] for pair in still.report().left_out} == {RIGID, "joined by the joint 'j'"}
    assert still.report().overlapping == (("post_0", "boom_0"),)
    assert "overlap at the model's zero: post_0 and boom_0" in str(still.report())
    base = mujoco.MjModel.from_xml_string(model.replace("<freejoint/>", ""))
    assert any("fixed in the world" in note for note in so.Robot.from_mujoco(base).report().notes)


def test_two_still_geometries_of_a_mujoco_pair_are_told() -> None:
    model = MJCF.replace('geom1="seen only" geom2="paddle"', 'geom1="floor" geom2="post"')
    report = so.Robot.from_mujoco(mujoco.MjModel.from_xml_string(model)).report()
    assert ("floor", "post", STILL) in report.left_out
    so.robots.MujocoContacts(so.Robot.from_mujoco(mujoco.MjModel.from_xml_string(model)))


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
