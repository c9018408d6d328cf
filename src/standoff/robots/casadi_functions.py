"""Distances of a robot's pairs in CasADi, by q: ``so.robots.casadi_distance``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.casadi import NamedCallback, check_name
from standoff.checks.names import choice
from standoff.errors import StandoffError, not_installed
from standoff.frameworks.ambient import LACKING, NO_THIRD, UNDEFINED
from standoff.robots.configurations import made_unit
from standoff.robots.curvature import Twists
from standoff.robots.near import check_robot
from standoff.robots.robot import Robot
from standoff.robots.tolerances import TURN_LOST
from standoff.tracking.derivatives import Smoothness, flagged_gradient
from standoff.world import World

try:
    import casadi
except ModuleNotFoundError as error:
    raise ModuleNotFoundError(not_installed("CasADi", "casadi"), name=error.name) from error

Array = NDArray[np.float64]


def casadi_distance(
    robot: Robot,
    pairs: Sequence[tuple[str, str]],
    *,
    undefined: str = "nan",
    name: str = "distance",
) -> Any:
    """A CasADi function: the signed distances of some pairs of a robot by q.

    With exact first and second derivatives, for costs and constraints. Make it once: it is kept
    until the program ends. Call it with MX expressions, not SX.

    Parameters
    ----------
    robot : Robot
        With joints of any kind. Derivatives are by the numbers of q themselves: a quaternion's
        four, or (cos, sin), which count as made unit, as the packages read them.
    pairs : list of (str, str)
        Names of geometries or obstacles.
    undefined : "nan" or "raise"
        Where a derivative is not defined: nan, or an error.
    name : str
        Of the function, as CasADi takes it.

    Returns
    -------
    casadi.Callback
        q (nq, 1) to the distances (k, 1), length.

    Raises
    ------
    ModuleNotFoundError
        CasADi is not installed; the message names the extra.
    TypeError
        No robot.
    ValueError
        A pair that there is not, an unknown choice or a bad name. When called, within CasADi's own
        RuntimeError: q that is not finite; undefined derivatives, if asked.
    """
    check_robot(robot)
    check_name(name)
    choice(undefined, "undefined", UNDEFINED)
    return _Value(_Pairs(robot, [(str(a), str(b)) for a, b in pairs], undefined), name)


class _Pairs:
    """Some pairs of a robot: their answers at q, and derivatives by it."""

    def __init__(self, robot: Robot, names: list[tuple[str, str]], undefined: str) -> None:
        known = dict(zip(robot.geoms.names, robot.geoms.bodies, strict=True))
        used = [name for name in known if any(name in pair for pair in names)]
        unknown = {name for pair in names for name in pair} - known.keys()
        if unknown or not names:
            raise StandoffError(
                f"pairs = {names}: give pairs of names in robot.geoms.names.", "pairs", names
            )
        still = dict(zip(robot.geoms.names, robot.geoms.joints < 0, strict=True))
        at = {name: k for k, name in enumerate(robot.geoms.names)}
        self.robot, self.names, self.undefined = robot, names, undefined
        self.numbers = [(at[a], at[b]) for a, b in names]
        fixed = {name: robot.geoms.placements[at[name]] for name in used if still[name]}
        self.moving = [at[name] for name in used if not still[name]]
        self.world = World({name: known[name] for name in used}, fixed=fixed, only=names)

    def value(self, q: Any) -> Array:
        """(k,) distances."""
        q = self.robot.kinematics.check(made_unit(self.robot.joints, q))
        return np.array([answer.distance for answer in self._answers(self.robot.poses(q))])

    def first(self, q: Any) -> Array:
        """(k, nq) gradients."""
        return np.array([gradient for gradient, _ in self._derived(q, second=False)])

    def second(self, q: Any) -> Array:
        """(k, nq, nq) Hessians."""
        return np.array([hessian for _, hessian in self._derived(q, second=True)])

    def _answers(self, poses: Array) -> list[Any]:
        answer = self.world.distances(poses[self.moving])
        return [answer[pair] for pair in self.names]

    def _derived(self, q: Any, *, second: bool) -> list[tuple[Array, Array]]:
        twists = Twists(self.robot, q)
        found = []
        for pair, answer in zip(self.numbers, self._answers(twists.poses), strict=True):
            flag, reason, _ = flagged_gradient(answer)
            none = flag is Smoothness.UNDEFINED
            by_twists = np.full(12, np.nan) if none else answer.gradient
            gradient = _through(by_twists, twists.of(pair))
            lacks = second if flag in LACKING else False
            if self.undefined == "raise" and (lacks or np.isnan(gradient).any()):
                raise StandoffError(f"The distance of {answer.names} has no derivative: {reason}")
            found.append((gradient, twists.hessian(pair, answer) if second else gradient))
        return found


def _through(by_twists: Array, jacobian: Array) -> Array:
    """(nq,) derivatives by q; nan where one that is not defined has a part in it."""
    lost = np.isnan(by_twists)
    found: Array = np.where(lost, 0.0, by_twists) @ jacobian
    if lost.any():
        # turns that move both bodies alike do not change the distance
        either = lost.reshape(2, 2, 3).any(axis=0)
        apart = np.abs(jacobian[6:] - jacobian[:6])
        apart[:3] = np.abs(jacobian[[0, 1, 2]]) + np.abs(jacobian[[6, 7, 8]])
        found[(apart[either.ravel()] > TURN_LOST).any(axis=0)] = np.nan
    return found


class _Value(NamedCallback):
    """q to the distances."""

    def __init__(self, pairs: _Pairs, name: str) -> None:
        q, distances = (casadi.Sparsity.dense(n, 1) for n in (pairs.robot.nq, len(pairs.names)))
        super().__init__(pairs, name, {"q": q}, {"distances": distances})

    def eval(self, given: Any) -> Any:
        return [self.pair.value(given[0].full().ravel())]

    def get_jacobian(self, name: str, inputs: Any, outputs: Any, options: Any) -> Any:
        count = len(self.pair.names)
        sizes = dict(zip(inputs, [self.inputs["q"], casadi.Sparsity(count, 1)], strict=True))
        return _Jacobian(self.pair, name, sizes, self.jacobian_outputs(outputs), options)


class _Jacobian(NamedCallback):
    """(q, distances) to their Jacobian."""

    def eval(self, given: Any) -> Any:
        return [self.pair.first(given[0].full().ravel())]

    def get_jacobian(self, name: str, inputs: Any, outputs: Any, options: Any) -> Any:
        empty = casadi.Sparsity(next(iter(self.outputs.values())).shape)
        sizes = dict(zip(inputs, [*self.inputs.values(), empty], strict=True))
        blocks = self.jacobian_outputs(outputs)
        last = list(blocks)[-1]  # nothing depends on the values that come in with q
        blocks[last] = casadi.Sparsity(blocks[last].shape)
        return _Hessian(self.pair, name, sizes, blocks, options)


class _Hessian(NamedCallback):
    """The same and the Jacobian to its derivatives, its entries by columns."""

    def eval(self, given: Any) -> Any:
        hessian = self.pair.second(given[0].full().ravel())
        count, nq, _ = hessian.shape
        by_q = hessian.transpose(1, 0, 2).reshape(nq * count, nq)
        return [by_q, casadi.DM(nq * count, count)]

    def get_jacobian(self, name: str, inputs: Any, outputs: Any, options: Any) -> Any:
        raise StandoffError(NO_THIRD)
