"""What a URDF file says is read, or refused by the element that is damaged, or told."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import standoff as so
from standoff_studies.soak import robot_files

mujoco = pytest.importorskip("mujoco")
pin = pytest.importorskip("pinocchio")

LINK = """<link name="{name}"><inertial><mass value="1"/>
<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
<visual><geometry><sphere radius=".1"/></geometry><material name="red"/></visual>
<collision><origin xyz="0 0 {at}"/><geometry><{shape}/></geometry></collision></link>"""
JOINT = """<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>
<origin xyz="1 0 0" rpy="0 0 0"/><axis xyz="0 0 1"/>
<limit lower="-2" upper="2" effort="1" velocity="1"/></joint>"""


def robot(**changes: str) -> str:
    """A file of three links, with one text in place of another: ``old=new`` by name."""
    links = [("a", 'sphere radius=".1"'), ("b", 'box size=".1 .2 .3"')]
    links.append(("c", 'cylinder radius=".1" length=".4"'))
    text = "".join(
        LINK.format(name=name, at=k, shape=shape) for k, (name, shape) in enumerate(links)
    )
    text += JOINT.format(name="j", kind="revolute", parent="a", child="b")
    text += JOINT.format(name="k", kind="prismatic", parent="b", child="c")
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new, 1)
    return f'<robot name="r">{text}</robot>'


def read(tmp_path: Path, text: str, **options: object) -> so.Robot:
    path = tmp_path / "r.urdf"
    path.write_text(text)
    return so.Robot.from_urdf(path, **options)


BOX, CYLINDER = 'box size=".1 .2 .3"', 'cylinder radius=".1" length=".4"'
INERTIA = 'ixx="1" ixy="0"'
DAMAGED = {
    "a capsule": (CYLINDER, 'capsule radius=".1" length=".4"', "link 'c'.*<capsule>.*two spheres"),
    "a cone": (CYLINDER, 'cone radius=".1" length=".4"', "link 'c': <collision> 0.*<cone>"),
    "two sizes": (BOX, 'box size=".1 .2"', "link 'b'.*<box>: size='.1 .2': give 3"),
    "commas": (BOX, 'box size="1,1,1"', "link 'b'.*<box>: size='1,1,1'.*spaces"),
    "a flat box": (BOX, 'box size="1 1 0"', "link 'b'.*positive"),
    "no radius": (CYLINDER, 'cylinder length=".4"', "link 'c'.*radius is missing"),
    "a name misspelt": (CYLINDER, 'cylinder raduis=".1" length=".4"', "'raduis'.*write radius"),
    "an inertia": (INERTIA, 'ixx="1,5" ixy="0"', "link 'a': <inertia>: ixx='1,5'"),
    "no mass": ('<mass value="1"/>', "", "link 'a': <inertial>: <mass> is missing"),
    "an axis": ('<axis xyz="0 0 1"/>', '<axis xyz="0,0,1"/>', "joint 'j': <axis>: xyz='0,0,1'"),
    "no axis": ('<axis xyz="0 0 1"/>', '<axis xyz="0 0 0"/>', "joint 'j': <axis>.*direction"),
    "an origin": ('rpy="0 0 0"', 'rpy="0 0 nan"', "joint 'j': <origin>: rpy='0 0 nan'"),
    "xyz misspelt": ('<origin xyz="1 0 0"', '<origin xzy="1 0 0"', "'xzy'.*write xyz"),
    "collision misspelt": ("<collision>", "<colision>", "link 'a': <colision>.*<collision>"),
    "two parents": ('child link="c"', 'child link="b"', "link 'b'.*joints 'j' and 'k'"),
    "no parent": ('parent link="b"', 'parent link="z"', "joint 'k': <parent>: .*no link 'z'"),
    "one name twice": ('<link name="c"', '<link name="b"', "link 'b': there are two"),
    "xacro": ('radius=".1"', 'radius="${r}"', "xacro: expand"),
    "a limit": ('lower="-2"', 'lower="low"', "joint 'j': <limit>: lower='low'"),
    "no limit": ('<limit lower="-2" upper="2" effort="1" velocity="1"/>', "", "<limit> is missing"),
}


@pytest.mark.parametrize("name", DAMAGED)
def test_what_is_damaged_is_refused_by_its_element(tmp_path: Path, name: str) -> None:
    old, new, said = DAMAGED[name]
    text = robot(**{old: new})
    if name == "collision misspelt":
        text = text.replace("</collision>", "</colision>", 1)
    with pytest.raises(so.StandoffError, match=f"r.urdf: .*{said}"):
        read(tmp_path, text)


BALL = '<sphere radius=".1" /></geometry></collision>'
MISREAD = {
    "no geometry": (
        BALL,
        "<capsule /></geometry></collision>",
        "link 'a': <collision> 0 .* is not in what",
    ),
    "a size": (BOX, 'box size=".1 .2 .4"', "link 'b': <collision> 0 .* is not what"),
    "a kind": (CYLINDER, 'sphere radius=".1"', "link 'c': <collision> 0 .* is not what"),
    "a place": ('xyz="0 0 2"', 'xyz="0 0 2.001"', "link 'c': <collision> 0 .* is not what"),
    "one more": (
        "</collision>",
        f"</collision><collision><geometry><{BOX}/></geometry></collision>",
        "the file does not have: a_1",
    ),
    "a joint's place": ('xyz="1 0 0"', 'xyz="1 0 0.001"', "joint 'j' is not what"),
    "an axis": ('axis xyz="0 0 1"', 'axis xyz="0 1 1"', "joint 'j' is not what"),
    "a link": ('"c"', '"z"', "link 'c' is not in what"),
}


@pytest.mark.parametrize("name", MISREAD)
def test_what_pinocchio_reads_otherwise_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    """It is given another text than that of the file."""
    old, new, said = MISREAD[name]
    model, geometry = pin.buildModelFromXML, pin.buildGeomFromUrdfString

    def other(text: str) -> str:
        assert old in text
        return text.replace(old, new, -1 if name == "a link" else 1)

    monkeypatch.setattr(pin, "buildModelFromXML", lambda text, *x: model(other(text), *x))
    monkeypatch.setattr(
        pin,
        "buildGeomFromUrdfString",
        lambda of, text, *x, **given: geometry(of, other(text), *x, **given),
    )
    with pytest.raises(so.StandoffError, match=said):
        read(tmp_path, robot())


def test_what_says_nothing_of_geometry_takes_none_away(tmp_path: Path) -> None:
    """urdfdom leaves a link out for a material without a name in what is only seen."""
    whole = read(tmp_path, robot())
    for old, new in (('<material name="red"/>', "<material/>"), ('radius=".1"', 'radius="?"')):
        again = read(tmp_path, robot(**{old: new}))
        assert again.geoms.names == whole.geoms.names == ("a_0", "b_0", "c_0")
        assert again.clearance([0.1, 0.2]).distance == whole.clearance([0.1, 0.2]).distance


def test_a_capsule_may_be_written_as_a_cylinder_and_two_spheres(tmp_path: Path) -> None:
    ends = "".join(
        f'<collision><origin xyz="0 0 {z}"/><geometry><sphere radius=".1"/></geometry></collision>'
        for z in (2.2, 1.8)
    )
    found = read(tmp_path, robot(**{"</link><joint": f"{ends}</link><joint"}))
    capsule = so.shapes.capsule(0.1, 0.4)
    ball = {"ball": (so.shapes.sphere(0.1), so.Pose(np.eye(3), [2.0, 0.0, 9.0]))}
    at = so.Pose(np.eye(3), [2.0, 0.0, 2.0])
    alone = so.distance(capsule, ball["ball"][0], at, ball["ball"][1]).distance
    rows = found.with_obstacles(ball).distances([0.0, 0.0])
    least = min(d for pair, d in zip(rows.names, rows.distance, strict=True) if "ball" in pair)
    assert abs(least - alone) <= 1e-12


def test_a_cylinder_may_be_named_as_a_capsule(tmp_path: Path) -> None:
    """Pinocchio's ``<collision_checking>``, as in its humanoid."""
    shape = '<collision name="rod"><origin xyz="0 0 2"/>'
    for name, kind in (("rod", "capsule"), ("other", "cylinder")):
        checking = f'<collision_checking><capsule name="{name}"/></collision_checking>'
        text = robot(**{'<collision><origin xyz="0 0 2"/>': checking + shape})
        told = read(tmp_path, text).report()
        assert re.search(rf"c_0 +c +{kind} +exact", str(told)), told


def test_what_is_not_read_is_told(tmp_path: Path) -> None:
    text = robot(**{"<collision>": "<shape_of_my_own>", "</collision>": "</shape_of_my_own>"})
    notes = read(tmp_path, text).report().notes
    assert "link 'a' has <shape_of_my_own>, which is not read" in notes
    assert any("link 'a' has <visual> but no <collision>" in note for note in notes)
    srdf = tmp_path / "r.srdf"
    for inside, said in (
        ("", "disables no pair"),
        ('<disable_collisions link1="a" link2="x"/>', "names links .* not have: x"),
        ('<enable_collisions link1="a" link2="b"/>', "<enable_collisions>, which is not read"),
    ):
        srdf.write_text(f'<robot name="r">{inside}</robot>')
        notes = read(tmp_path, robot(), srdf=srdf).report().notes
        assert any(re.search(said, note) for note in notes)
    srdf.write_text('<robot name="r"><disable_collisions link1="a"/></robot>')
    with pytest.raises(so.StandoffError, match="names no two links"):
        read(tmp_path, robot(), srdf=srdf)
    srdf.write_text('<robot><disable_collisions link1="a" link2="c" reason="Never"/></robot>')
    found = read(tmp_path, robot(), srdf=srdf, obstacles={"o": so.shapes.sphere(0.1)})
    assert ("a_0", "c_0", "disabled by the SRDF (Never)") in found.report().left_out


def test_a_model_that_is_changed_later_is_not_the_robot_s(tmp_path: Path) -> None:
    text = '<mujoco><worldbody><geom size=".1"/><body pos="1 0 0"><joint type="slide"/>'
    model = mujoco.MjModel.from_xml_string(f'{text}<geom size=".1"/></body></worldbody></mujoco>')
    (tmp_path / "r.urdf").write_text(robot())
    other = pin.buildModelFromUrdf(str(tmp_path / "r.urdf"))
    geometry = pin.buildGeomFromUrdf(other, str(tmp_path / "r.urdf"), pin.GeometryType.COLLISION)
    geometry.addAllCollisionPairs()
    robots = [so.Robot.from_mujoco(model), so.Robot.from_pinocchio(other, geometry)]
    before = [each.clearance(np.zeros(each.nq)).distance for each in robots]
    model.body_pos[1] = 9.0, 0.0, 0.0
    other.jointPlacements[1] = pin.SE3.Random()
    assert [each.clearance(np.zeros(each.nq)).distance for each in robots] == before


@pytest.mark.parametrize(
    "count", [pytest.param(24, id="some"), pytest.param(400, marks=pytest.mark.soak)]
)
def test_files_with_one_thing_wrong_are_read_as_they_say_or_refused(
    tmp_path: Path, count: int
) -> None:
    found = [robot_files.case_of(2, number, tmp_path) for number in range(count)]
    assert not [each for each in found if each.wrong]
    assert {each.became for each in found} == {"refused", "read"}
