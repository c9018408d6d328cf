"""Robots: exact shapes on the links of a model, distances and gradients by its joints."""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.robots.answer import RobotAnswer
    from standoff.robots.batch import RobotAnswers
    from standoff.robots.geoms import Geoms
    from standoff.robots.joints import JointKind, Joints
    from standoff.robots.kinematics import Kinematics
    from standoff.robots.paths import FunctionPath
    from standoff.robots.proof import BoxProof, PathProof, Verdict, Witness
    from standoff.robots.report import GeomReport, RobotReport
    from standoff.robots.robot import Robot
    from standoff.robots.rows import RobotRows
else:
    __getattr__, __dir__ = on_demand(
        __name__,
        {
            "standoff.robots.answer": ("RobotAnswer",),
            "standoff.robots.batch": ("RobotAnswers",),
            "standoff.robots.geoms": ("Geoms",),
            "standoff.robots.joints": ("JointKind", "Joints"),
            "standoff.robots.kinematics": ("Kinematics",),
            "standoff.robots.paths": ("FunctionPath",),
            "standoff.robots.proof": ("BoxProof", "PathProof", "Verdict", "Witness"),
            "standoff.robots.report": ("GeomReport", "RobotReport"),
            "standoff.robots.robot": ("Robot",),
            "standoff.robots.rows": ("RobotRows",),
        },
    )

__all__ = [
    "BoxProof",
    "FunctionPath",
    "GeomReport",
    "Geoms",
    "JointKind",
    "Joints",
    "Kinematics",
    "PathProof",
    "Robot",
    "RobotAnswer",
    "RobotAnswers",
    "RobotReport",
    "RobotRows",
    "Verdict",
    "Witness",
]
