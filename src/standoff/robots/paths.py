"""Joint paths: waypoints straight in q, a spline in q, or a function with its greatest speeds."""

from __future__ import annotations

from typing import Any

from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.robots.kinematics import Kinematics
from standoff.robots.path_kinds import BoundedPath, FunctionPath, JointPath, StraightPath
from standoff.robots.spline_path import SplinePath, is_spline


def joint_path(path: Any, kinematics: Kinematics, times: Any = None) -> JointPath:
    """Read what may be a path.

    Raises StandoffError: waypoints of another size, fewer than two, NaN; a function without its
    greatest speeds.
    """
    if isinstance(path, JointPath):
        return path
    if is_spline(path):
        if times is not None:
            raise StandoffError("times: a spline has its own.", "times", times)
        return SplinePath(path, kinematics)
    if isinstance(path, FunctionPath):
        if times is not None:
            raise StandoffError("times: a function has its own.", "times", times)
        return BoundedPath(path, kinematics)
    if callable(path):
        raise StandoffTypeError(
            f"path = {shown(path)}: of a function, or of a spline that is no PPoly, BPoly or "
            "BSpline of SciPy, the greatest speeds must be known; give "
            "so.robots.FunctionPath(function, duration, speed).",
            "path",
            path,
        )
    return StraightPath(path, kinematics, times)


__all__ = ["BoundedPath", "FunctionPath", "JointPath", "joint_path"]
