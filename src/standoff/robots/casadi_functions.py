"""Distances of a robot's pairs in CasADi, by q: ``so.robots.casadi_distance``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from standoff.casadi import NamedCallback, check_name
from standoff.checks.names import choice
from standoff.errors import StandoffError, of_extra
from standoff.frameworks.ambient import NO_THIRD, UNDEFINED
from standoff.robots.near import check_robot
from standoff.robots.pairs_by_q import PairsByQ
from standoff.robots.robot import Robot

with of_extra("CasADi", "casadi"):
    import casadi


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

    Raises ModuleNotFoundError: CasADi is not installed; the message names the extra. Raises
    TypeError: no robot. Raises ValueError: a pair that there is not, an unknown choice or a bad
    name. When called, within CasADi's own RuntimeError: q that is not finite; undefined
    derivatives, if asked.

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
    """
    check_robot(robot)
    check_name(name)
    choice(undefined, "undefined", UNDEFINED)
    return _RobotValue(PairsByQ(robot, [(str(a), str(b)) for a, b in pairs], undefined), name)


class _RobotValue(NamedCallback):
    """q to the distances."""

    def __init__(self, pairs: PairsByQ, name: str) -> None:
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
        return _RobotHessian(self.pair, name, sizes, blocks, options)


class _RobotHessian(NamedCallback):
    """The same and the Jacobian to its derivatives, its entries by columns."""

    def eval(self, given: Any) -> Any:
        hessian = self.pair.second(given[0].full().ravel())
        count, nq, _ = hessian.shape
        by_q = hessian.transpose(1, 0, 2).reshape(nq * count, nq)
        return [by_q, casadi.DM(nq * count, count)]

    def get_jacobian(self, name: str, inputs: Any, outputs: Any, options: Any) -> Any:
        raise StandoffError(NO_THIRD)
