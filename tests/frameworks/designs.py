"""Designs, and numbers of their parameters and poses, that the tests of all frameworks use."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

import standoff as so
from frameworks.cases import APART, INSIDE, pose

LENS = so.Design(so.shapes.lens, radius=1.0, offset=0.45)
EGG = so.Design(so.shapes.ellipsoid, semi_axes=[0.5, 0.3, 0.4])
BOX = so.Design(so.shapes.box, size=[1.0, 1.0, 1.0])
PARAMETERS = {"radius": 1.05, "offset": 0.4}, {"semi_axes": np.array([0.45, 0.33, 0.4])}
"""Of A and of B: not those of the designs themselves."""
POSES = {name: (pose(q[:6]), pose(q[6:])) for name, q in (("apart", APART), ("overlap", INSIDE))}


def answer_of(where: str, parameters: Any = PARAMETERS) -> Any:
    """The answer at those parameters, and the changed designs."""
    a, b = LENS.changed(**parameters[0]), EGG.changed(**parameters[1])
    return so.distance(a.body, b.body, *POSES[where]), a, b


@lru_cache
def told(where: str) -> so.design.ShapeGradient:
    """What `shape_gradient` says at those parameters."""
    answer, a, b = answer_of(where)
    return so.shape_gradient(answer, a=a, b=b)


@lru_cache
def differences(where: str, step: float = 1e-3) -> list[np.ndarray]:
    """Of the distance by radius, offset and semi-axes: central ones of the fourth order."""
    numbers = np.array([1.05, 0.4, 0.45, 0.33, 0.4])

    def distance(x: np.ndarray) -> float:
        given = {"radius": x[0], "offset": x[1]}, {"semi_axes": x[2:]}
        return answer_of(where, given)[0].distance

    weights = {-2: 1 / 12, -1: -2 / 3, 1: 2 / 3, 2: -1 / 12}
    found = np.array(
        [
            sum(w * distance(numbers + k * e) for k, w in weights.items()) / step
            for e in step * np.eye(5)
        ]
    )
    return [found[0], found[1], found[2:]]
