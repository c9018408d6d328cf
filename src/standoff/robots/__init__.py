"""Robots: exact shapes on the links of a model, distances and gradients by its joints."""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.robots.answer import RobotAnswer
    from standoff.robots.batch import RobotAnswers
    from standoff.robots.casadi_functions import casadi_distance
    from standoff.robots.geoms import Geoms
    from standoff.robots.joints import JointKind, Joints
    from standoff.robots.kinematics import Kinematics
    from standoff.robots.mink_limit import MinkLimit
    from standoff.robots.mujoco_contacts import MujocoContacts
    from standoff.robots.mujoco_sensor import MujocoSensor
    from standoff.robots.paths import FunctionPath
    from standoff.robots.pink_barrier import PinkBarrier
    from standoff.robots.proof import BoxProof, PathProof, Span, Verdict, Witness
    from standoff.robots.report import GeomReport, RobotReport
    from standoff.robots.robot import Robot
    from standoff.robots.rows import RobotRows
    from standoff.robots.safety_filter import FilterStatus, SafetyFilter, SafeVelocity
else:
    __getattr__, __dir__ = on_demand(__name__)

__all__ = [
    "BoxProof",
    "FilterStatus",
    "FunctionPath",
    "GeomReport",
    "Geoms",
    "JointKind",
    "Joints",
    "Kinematics",
    "MinkLimit",
    "MujocoContacts",
    "MujocoSensor",
    "PathProof",
    "PinkBarrier",
    "Robot",
    "RobotAnswer",
    "RobotAnswers",
    "RobotReport",
    "RobotRows",
    "SafeVelocity",
    "SafetyFilter",
    "Span",
    "Verdict",
    "Witness",
    "casadi_distance",
]
