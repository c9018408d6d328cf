"""Distances of named pairs of a robot, and their derivatives by q, for frameworks."""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.errors import StandoffError
from standoff.robots.configurations import made_unit
from standoff.robots.curvature import Twists
from standoff.robots.robot import Robot
from standoff.robots.tolerances import TIED, TIED_APART, TURN_LOST
from standoff.tracking.derivatives import Smoothness, flagged_gradient
from standoff.typing import Array
from standoff.world import World
from standoff.world.answer import WorldAnswer
from standoff.world.pair_answer import PairAnswer, convex
from standoff.world.solid_pairs import refuse_solids

TWO_PIECES = "two pairs of pieces are equally near."


class PairsByQ:
    """Some pairs of a robot: their answers at q, and derivatives by it."""

    def __init__(self, robot: Robot, names: list[tuple[str, str]], undefined: str) -> None:
        known = dict(zip(robot.geoms.names, robot.geoms.bodies, strict=True))
        used = [name for name in known if any(name in pair for pair in names)]
        unknown = {name for pair in names for name in pair} - known.keys()
        if unknown or not names:
            raise StandoffError(
                f"pairs = {names}: give pairs of names in robot.geoms.names.", "pairs", names
            )
        refuse_solids(
            {name: known[name] for name in used},
            "A function of CasADi",
            "give its convex pieces, as a Compound",
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
        answer = self._answer(self.robot.poses(q))
        return np.array([answer[pair].distance for pair in self.names])

    def first(self, q: Any) -> Array:
        """(k, nq) gradients."""
        return np.array([gradient for gradient, _ in self._derived(q, second=False)])

    def second(self, q: Any) -> Array:
        """(k, nq, nq) Hessians."""
        return np.array([hessian for _, hessian in self._derived(q, second=True)])

    def _answer(self, poses: Array) -> WorldAnswer:
        return self.world.distances(poses[self.moving])

    def _derived(self, q: Any, *, second: bool) -> list[tuple[Array, Array]]:
        twists = Twists(self.robot, q)
        answer = self._answer(twists.poses)
        found = []
        for pair, names in zip(self.numbers, self.names, strict=True):
            each = [_by_q(twists, pair, one, second=second) for one in nearest(answer, names)]
            gradient, hessian = (agreed(np.array(parts)) for parts in zip(*each, strict=True))
            if self.undefined == "raise" and np.isnan(hessian if second else gradient).any():
                reason = flagged_gradient(convex(answer[names]))[1] or TWO_PIECES
                raise StandoffError(f"The distance of {names} has no derivative: {reason}")
            found.append((gradient, hessian))
        return found


def _by_q(
    twists: Twists, pair: tuple[int, int], answer: PairAnswer, *, second: bool
) -> tuple[Array, Array]:
    """Gradient by q, and the Hessian if it is asked."""
    none = flagged_gradient(answer)[0] is Smoothness.UNDEFINED
    by_twists = np.full(12, np.nan) if none else answer.gradient
    gradient = _through(by_twists, twists.of(pair))
    return gradient, twists.hessian(pair, answer) if second else gradient


def nearest(answer: WorldAnswer, names: tuple[str, str]) -> list[PairAnswer]:
    """The nearest pair of pieces of two bodies, and all others that are as near."""
    first = convex(answer[names])
    others = map(convex, answer.minima(names, first.distance + TIED))
    return [first, *(one for one in others if one.pieces != first.pieces)]


def agreed(parts: Array) -> Array:
    """Of (n, ...) numbers one where all are the same, else nan."""
    found: Array = parts[0].copy()
    size = 1.0 + float(np.abs(np.nan_to_num(parts)).max(initial=0.0))
    found[~(np.abs(parts - found) <= TIED_APART * size).all(axis=0)] = np.nan
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
