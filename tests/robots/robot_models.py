"""Robots that packages bring along, and small models for single rules."""

from __future__ import annotations

import sys
from functools import cache
from pathlib import Path

import numpy as np

ROBOTS = (
    Path(sys.prefix)
    / f"lib/python3.{sys.version_info.minor}"
    / "site-packages/cmeel.prefix/share/example-robot-data/robots"
)

EXACT = {
    "laikago": "laikago_description/urdf/laikago.urdf",
    "go1": "go1_description/urdf/go1.urdf",
    "panda": "panda_description/urdf/panda_collision.urdf",
    "allegro right": "allegro_hand_description/urdf/allegro_right_hand.urdf",
    "allegro left": "allegro_hand_description/urdf/allegro_left_hand.urdf",
    "anymal c": "anymal_c_simple_description/urdf/anymal.urdf",
    "anymal b": "anymal_b_simple_description/robots/anymal.urdf",
    "b1": "b1_description/urdf/b1.urdf",
    "romeo": "romeo_description/urdf/romeo_laas_small.urdf",
    "iris": "iris_description/robots/iris.urdf",
    "pendulum": "double_pendulum_description/urdf/double_pendulum_simple.urdf",
    "a1": "a1_description/urdf/a1.urdf",
    "quadruped": "quadruped_description/urdf/quadruped.urdf",
}
"""Robots all of whose collision geometries are boxes, cylinders and spheres."""

WITH_MESHES = {
    "baxter": "baxter_description/urdf/baxter.urdf",
    "z1": "z1_description/urdf/z1.urdf",
    "ur5": "ur_description/urdf/ur5_robot.urdf",
    "ur3 gripper": "ur_description/urdf/ur3_gripper.urdf",
    "xarm7": "xarm_description/urdf/xarm7.urdf",
    "kinova": "kinova_description/robots/kinova.urdf",
    "so100": "so_arm_description/urdf/so100.urdf",
    "solo12": "solo_description/robots/solo12.urdf",
    "finger": "finger_edu_description/robots/finger_edu.urdf",
    "hyq": "hyq_description/robots/hyq_no_sensors.urdf",
    "bolt": "bolt_description/robots/bolt.urdf",
    "borinot": "borinot_description/urdf/borinot_flying_arm_2.urdf",
}
"""Robots with meshes, of which the hulls are taken."""

SRDF = {"panda": "panda_description/srdf/panda.srdf"}


def urdf(name: str) -> Path:
    """The file of a robot."""
    return ROBOTS / (EXACT | WITH_MESHES)[name]


@cache
def exact_robot(name: str):
    """A robot of `EXACT`; joints that mimic follow."""
    import standoff as so

    srdf = SRDF.get(name)
    return so.Robot.from_urdf(urdf(name), srdf and ROBOTS / srdf, mimic=True)


def drawn(robot, rng: np.random.Generator) -> np.ndarray:
    """A configuration within the limits, or within a turn or a metre where there are none."""
    v = rng.uniform(-np.pi, np.pi, robot.nv)
    q = np.array(robot.kinematics.integrate(robot.kinematics.neutral(), v))
    bounded = np.isfinite(robot.lower) & np.isfinite(robot.upper)
    q[bounded] = rng.uniform(robot.lower[bounded], robot.upper[bounded])
    return robot.kinematics.check(q)


MJCF = """
<mujoco model="every joint">
  <option><flag contact="enable"/></option>
  <worldbody>
    <geom name="floor" type="plane" size="2 2 .1"/>
    <geom name="post" type="cylinder" size=".05 .4" pos="1 0 .4" contype="2" conaffinity="2"/>
    <body name="base" pos="0 0 1">
      <freejoint name="float"/>
      <geom name="trunk" type="ellipsoid" size=".2 .15 .1"/>
      <geom name="seen only" type="sphere" size=".3" contype="0" conaffinity="0"/>
      <body name="upper" pos=".2 .1 0" euler="10 20 30">
        <joint name="yaw" axis="0 0 1" ref="20" range="-90 90" limited="true"/>
        <joint name="pitch" axis="1 2 0" pos=".02 0 .01" range="-1 1"/>
        <geom name="upper" type="capsule" size=".03 .1" pos=".1 0 0" euler="0 90 0"/>
        <body name="lower" pos=".25 0 0">
          <joint name="push" type="slide" axis="1 0 1" ref=".05" range="-.2 .2"/>
          <geom name="lower" type="box" size=".05 .03 .02" contype="3" conaffinity="3"/>
          <body name="tip" pos=".1 0 0">
            <geom type="sphere" size=".02"/>
            <body name="wheel" pos=".1 0 0">
              <joint name="ball" type="ball" pos="-.02 0 0"/>
              <geom type="cylinder" size=".04 .01"/>
              <geom type="box" size=".01 .01 .05"/>
            </body>
          </body>
        </body>
      </body>
    </body>
    <body name="other" pos="-.6 0 .5">
      <joint name="turn" axis="0 1 0"/>
      <geom name="paddle" type="box" size=".2 .05 .05" pos=".2 0 0"/>
      <body name="fixed to it" pos=".4 0 0"><geom type="sphere" size=".06"/></body>
    </body>
  </worldbody>
  <contact>
    <exclude body1="base" body2="lower"/>
    <pair geom1="seen only" geom2="paddle"/>
  </contact>
</mujoco>
"""
"""Every kind of joint and exact geometry, and every rule about pairs."""

URDF = """
<robot name="two arms">
  <link name="base">
    <collision><geometry><box size=".2 .2 .1"/></geometry></collision>
    <collision><origin xyz="0 0 .1"/><geometry><cylinder radius=".05" length=".1"/></geometry>
    </collision>
  </link>
  <link name="upper">
    <collision><origin xyz="0 0 .2"/><geometry><cylinder radius=".03" length=".3"/></geometry>
    </collision>
  </link>
  <link name="plate"><collision><geometry><sphere radius=".04"/></geometry></collision></link>
  <link name="lower"><collision><geometry><box size=".04 .04 .2"/></geometry></collision></link>
  <link name="finger">
    <collision><origin xyz="0 .1 0"/><geometry><sphere radius=".02"/></geometry></collision>
  </link>
  <joint name="turn" type="continuous">
    <parent link="base"/><child link="upper"/><origin xyz="0 0 .2" rpy=".1 .2 .3"/>
    <axis xyz="0 .6 .8"/>
  </joint>
  <joint name="weld" type="fixed">
    <parent link="upper"/><child link="plate"/><origin xyz="0 0 .4"/>
  </joint>
  <joint name="bend" type="revolute">
    <parent link="plate"/><child link="lower"/><origin xyz="0 .1 .1"/><axis xyz="1 0 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/>
  </joint>
  <joint name="grip" type="{grip}">
    <parent link="lower"/><child link="finger"/><origin xyz="0 .1 .1"/><axis xyz="0 .6 .8"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/>
    <mimic joint="bend" multiplier="-0.5" offset="0.1"/>
  </joint>
</robot>
"""
"""A continuous joint, a weld, and a joint that mimics another; `grip` is revolute or prismatic."""
