"""A sweep of a robot over the numbers of its joints."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np

from standoff.errors import StandoffError
from standoff.robots.joints import SINGLE, JointKind
from standoff.robots.limits import check_limits
from standoff.robots.robot import Robot
from standoff.sweep.parameters import Parameter
from standoff.sweep.rows import Rows
from standoff.sweep.subjects.nearest import drawn_answer, names_of, nearest_of, rows_of
from standoff.sweep.subjects.shapes import digest_of_arrays, digest_of_shape
from standoff.sweep.subjects.subject import Alone, Subject
from standoff.typing import Array
from standoff.world.answer import WorldAnswer

ONE_NUMBER = (*SINGLE, JointKind.CONTINUOUS)
"""Joints that a parameter can move."""


@dataclass(frozen=True, eq=False)
class RobotSubject(Subject):
    """A robot, its obstacles among its geometries.

    Attributes
    ----------
    robot : Robot
        With the horizon.
    rest : (nq,) array
        The configuration of the joints that no parameter moves.
    unit : str
        Label of lengths.
    within : float or None
    """

    robot: Robot
    rest: Array
    unit: str
    within: float | None

    @property
    def length_unit(self) -> str:
        return self.unit

    @property
    def name(self) -> str:
        return self.robot.loaded.source

    @property
    def movable(self) -> tuple[str, ...]:
        return self.robot.joints.names

    @property
    def planar(self) -> bool:
        return False

    def configurations(self, parameters: Sequence[Parameter], numbers: Array) -> Array:
        """Return the configurations (n, nq) of rows; each row's by itself."""
        joints, at = self.robot.joints, 0
        found = np.repeat(self.rest[None], len(numbers), axis=0)
        for p in parameters:
            given = np.radians(numbers[:, at]) if p.degrees else numbers[:, at]
            at += p.width
            j = joints.names.index(p.moves)
            q = int(joints.q_at[j])
            if joints.kinds[j] == JointKind.CONTINUOUS:
                found[:, q], found[:, q + 1] = np.cos(given), np.sin(given)
            else:
                found[:, q] = given
        return found

    def _answers(self, q: Array, first: int) -> Iterator[WorldAnswer]:
        try:
            check_limits(self.robot, q, "q")
        except StandoffError:
            for k, one in enumerate(q):  # to tell the row
                check_limits(self.robot, one[None], f"row {first + k}")
        check = self.robot.kinematics.check
        ask = self.robot.nearest_rows if self.within is None else self.robot.distances
        return (ask(check(one)).answer for one in q)

    def rows(self, parameters: Sequence[Parameter], numbers: Array, first: int) -> Rows:
        return rows_of(self._answers(self.configurations(parameters, numbers), first), first)

    def alone(self, parameters: Sequence[Parameter], numbers: Array, row: int) -> Alone:
        q = self.configurations(parameters, numbers)
        answer = next(self._answers(q, row))
        rows, nearest, state = rows_of([answer], row), nearest_of(answer), {"q": q[0].tolist()}
        if nearest is None:
            return Alone(rows, None, ("", ""), (None, None), (), state)
        poses = dict(zip(self.robot.geoms.names, self.robot.poses(q[0]), strict=True))
        named = tuple((name, poses[name]) for name in nearest.names)
        shown = drawn_answer(self.robot.world, nearest)
        return Alone(rows, shown, nearest.names, nearest.bodies, named, state)

    def facts(self) -> dict[str, Any]:
        joints, geoms = self.robot.joints, self.robot.geoms
        moves = (joints.kinds, joints.parents, joints.placements, joints.axes, joints.q_at)
        follows = (joints.ratios, joints.offsets, np.array([joints.scalar_first]))
        package = type(self.robot.kinematics).__module__.rpartition(".")[2]
        version = import_module(package).__version__
        return {
            "robot": {
                "joints": list(joints.names),
                "joints_sha256": digest_of_arrays((*moves, *follows)),
                "geometries": {
                    name: digest_of_shape(body)
                    for name, body in zip(geoms.names, geoms.bodies, strict=True)
                },
                "placed_sha256": digest_of_arrays((geoms.joints, geoms.placements)),
                "pairs": [list(pair) for pair in self.robot.pairs],
                "kinematics": f"{package} {version}",
            },
            "q": self.rest.tolist(),
        }

    def reported(self) -> dict[str, Any]:
        return {"robot": self.robot.loaded.source, "joints": list(self.robot.joints.names)}

    def pair_names(self, number: int) -> tuple[str, str] | None:
        return names_of(self.robot.geoms.names, number)
