"""`standoff robot`: what it tells of a model, and what it refuses."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import standoff as so
from standoff.wording import at_least

Standoff = Callable[..., Any]

ARM = """<mujoco model="small arm"><worldbody>
<geom name="floor" type="plane" size="1 1 1"/>
<body name="upper" pos="0 0 0.5"><joint name="shoulder" axis="0 1 0" range="-90 90"/>
<geom name="arm" type="capsule" size="0.05 0.2" euler="0 90 0" pos="0.2 0 0"/>
<geom name="paint" type="box" size="0.1 0.1 0.1" contype="0" conaffinity="0"/>
</body></worldbody></mujoco>"""

URDF = """<robot name="two"><link name="base"><collision><geometry><sphere radius="0.1"/></geometry>
</collision></link><link name="tip"><collision><geometry><sphere radius="0.2"/></geometry>
</collision></link><link name="between"/>
<joint name="a" type="revolute"><parent link="base"/><child link="between"/><axis xyz="1 0 0"/>
<origin xyz="0 0 0.5"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="b" type="prismatic"><parent link="between"/><child link="tip"/><axis xyz="0 0 1"/>
<origin xyz="0 0 0.5"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""


@pytest.fixture
def arm(tmp_path: Path) -> Path:
    file = tmp_path / "arm.xml"
    file.write_text(ARM)
    return file


def test_nearest_pair_at_zero_and_elsewhere(standoff: Standoff, arm: Path) -> None:
    ended = standoff("robot", arm)
    assert ended.code == 0
    assert "1 joint, 3 geometries" in ended.out
    assert "nearest at the model's own zero: floor (world) - arm (upper), 0.45" in ended.out
    assert "paint" not in ended.out
    robot = so.Robot.from_mujoco(arm)
    told = standoff("robot", arm, "--q", "0.5").out
    assert f"{robot.clearance([0.5]).distance:.9g}" in told
    assert f"proven for all pairs: {at_least(robot.clearance([0.5]).clearance, 9)}" in told
    assert "shoulder is outside its limits" in standoff("robot", arm, "--q", "3").out


def test_report(standoff: Standoff, arm: Path) -> None:
    told = standoff("robot", arm, "--report").out
    assert all(line in told for line in str(so.Robot.from_mujoco(arm).report()).splitlines())
    assert "pair: floor - arm" in told
    assert "does not collide" in told


def test_json(standoff: Standoff, arm: Path) -> None:
    facts = json.loads(standoff("robot", arm, "--json").out)
    assert (facts["nq"], facts["pairs_watched"]) == (1, 1)
    assert facts["nearest"]["links"] == ["world", "upper"]
    assert "geometries" not in facts
    facts = json.loads(standoff("robot", arm, "--json", "--report").out)
    assert [geom["became"] for geom in facts["geometries"]] == [
        "exact",
        "exact",
        "does not collide",
    ]
    assert facts["pairs"] == [["floor", "arm"]]


def test_urdf(standoff: Standoff, tmp_path: Path) -> None:
    file = tmp_path / "two.urdf"
    file.write_text(URDF)
    told = standoff("robot", file, "--q", "0 0.25").out
    assert "nearest at q: base_0 (base) - tip_0 (tip), 0.95" in told
    srdf = tmp_path / "two.srdf"
    srdf.write_text(
        '<robot name="two"><disable_collisions link1="base" link2="tip" reason="x"/></robot>'
    )
    assert "no pair is watched" in standoff("robot", file, "--srdf", srdf).out


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ([], "--q: give numbers"),
        (["--q", "1 2"], "--q:"),
        (["--srdf", "a.srdf"], "--srdf: only a URDF file has it"),
        (["--skip", "nobody"], "nobody"),
    ],
)
def test_bad_input(standoff: Standoff, arm: Path, words: list[str], told: str) -> None:
    ended = standoff("robot", arm, *(words or ["--q", "one"]))
    assert ended.code == 2
    assert told in ended.err


def test_fixes_are_options_of_the_command(standoff: Standoff, tmp_path: Path) -> None:
    file = tmp_path / "mesh.xml"
    file.write_text(
        '<mujoco><asset><mesh name="m" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset><worldbody>'
        '<geom name="f" type="plane" size="1 1 1"/><body pos="0 0 2"><joint type="slide"/>'
        '<geom name="g" type="mesh" mesh="m"/></body></worldbody></mujoco>'
    )
    ended = standoff("robot", file)
    assert ended.code == 2
    assert "give --hulls for its hull" in ended.err
    assert "meshes=" not in ended.err
    assert "hull" in standoff("robot", file, "--hulls", "--report").out


def test_bad_files(standoff: Standoff, tmp_path: Path) -> None:
    for name, told in (("a.xml", "no model file"), ("a.urdf", "a.urdf"), ("a.stl", "MJCF file")):
        ended = standoff("robot", tmp_path / name)
        assert ended.code == 2
        assert told in ended.err
    broken = tmp_path / "broken.xml"
    broken.write_text("<mujoco><worldbody>")
    assert standoff("robot", broken).code == 2
