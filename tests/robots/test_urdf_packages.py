"""Where the files of a URDF's meshes are sought."""

from __future__ import annotations

from pathlib import Path

import pytest

import standoff as so

pytest.importorskip("pinocchio")

TETRAHEDRON = """o corner
v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
f 1 3 2
f 1 2 4
f 1 4 3
f 2 3 4
"""
URDF = """
<robot name="slider">
  <link name="base"><collision><geometry><sphere radius=".1"/></geometry></collision></link>
  <link name="mid"/>
  <link name="foot">
    <collision><geometry><mesh filename="{file}"/></geometry></collision>
  </link>
  <joint name="rise" type="prismatic"><parent link="base"/><child link="mid"/>
    <axis xyz="0 0 1"/><limit lower="-9" upper="9" effort="1" velocity="1"/></joint>
  <joint name="turn" type="revolute"><parent link="mid"/><child link="foot"/>
    <axis xyz="0 0 1"/><limit lower="-9" upper="9" effort="1" velocity="1"/></joint>
</robot>"""


@pytest.mark.parametrize("slashes", ["package://", "package:///"])
def test_packages_with_two_or_three_slashes(tmp_path: Path, slashes: str) -> None:
    """Talos' file of all links has three."""
    (tmp_path / "shapes").mkdir()
    (tmp_path / "shapes" / "corner.obj").write_text(TETRAHEDRON)
    (tmp_path / "slider.urdf").write_text(URDF.format(file=f"{slashes}shapes/corner.obj"))
    robot = so.Robot.from_urdf(tmp_path / "slider.urdf", meshes="hull")
    assert [geom.became for geom in robot.report().geoms] == ["exact", "hull"]
    assert abs(robot.clearance([2.0, 0.0]).distance - 1.9) <= 1e-12


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    (tmp_path / "slider.urdf").write_text(URDF.format(file="package:///shapes/corner.obj"))
    with pytest.raises(so.StandoffError, match=r"foot_0.*package:///shapes/corner\.obj"):
        so.Robot.from_urdf(tmp_path / "slider.urdf", meshes="hull")
