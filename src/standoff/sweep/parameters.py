"""What a sweep changes: numbers of a row, and the poses that they make."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from standoff.motion import Pose
from standoff.scene.shapes import NO_LENGTHS
from standoff.typing import Array

SHIFTS = ("x", "y", "z")
TURNS = ("turn_x", "turn_y", "turn_z")
ANGLE, SLIDE = "angle", "slide"
"""Of a robot's joint: the angle of one that turns, the length of one that slides."""

UNIFORM = "uniform"
"""In place of a shift or turn: any orientation, all equally likely."""

QUATERNION = 3
"""Numbers that a uniform rotation takes."""


@dataclass(frozen=True)
class Parameter:
    """A number, or the three of a rotation, of which each row has its own.

    Attributes
    ----------
    name : str
    moves : str
        The body, or the joint of a robot.
    what : str
        One of `SHIFTS`, of the body's origin along an axis of the world; one of `TURNS`, about an
        axis of the body through its origin; `UNIFORM`; or of a joint `ANGLE` or `SLIDE`. Of a
        shape, a key of the body's table, with the number of its entry if it has several, from 1
        on: ``"radius"``, ``"semi_axes.2"``.
    low, high : float
        Its range, in the scene's length, rad, or degrees; 0 and 1 where it has none.
    degrees : bool
        Are its numbers angles in degrees?
    steps : int
        Of a grid, the number of values; otherwise 0.
    shape : bool
        Does it change the body's shape, and not where it is?
    """

    name: str
    moves: str
    what: str
    low: float = 0.0
    high: float = 1.0
    degrees: bool = False
    steps: int = 0
    shape: bool = False

    @property
    def width(self) -> int:
        """How many numbers of a row it has."""
        return QUATERNION if self.what == UNIFORM else 1

    @property
    def columns(self) -> list[str]:
        """Their names."""
        if self.width == 1:
            return [self.name]
        return [f"{self.name}.{k + 1}" for k in range(self.width)]

    @property
    def unit(self) -> str:
        """Unit of its numbers, empty of lengths and of numbers without one."""
        if self.what in (*TURNS, ANGLE):
            return "deg" if self.degrees else "rad"
        return ""

    @property
    def is_length(self) -> bool:
        """Is its number a length, in the scene's unit?"""
        pure = self.shape and self.what.partition(".")[0] in NO_LENGTHS
        return self.what not in (*TURNS, ANGLE, UNIFORM) and not pure

    @property
    def told(self) -> str:
        """What it changes, for a reader."""
        if self.what in (ANGLE, SLIDE):
            return f"joint {self.moves}"
        what = "uniform rotation" if self.what == UNIFORM else self.what
        return f"{what} of {self.moves}"

    def facts(self) -> dict[str, Any]:
        """Return plain data, as a job's file has it."""
        joint = self.what in (ANGLE, SLIDE)
        key = "joint" if joint else "shapes" if self.shape else "moves"
        known: dict[str, Any] = {key: self.moves}
        if self.what == UNIFORM:
            return known | {"rotation": UNIFORM}
        ending = "_degrees" if self.degrees else ""
        known |= {"what": self.what, f"from{ending}": self.low, f"to{ending}": self.high}
        return known | ({"steps": self.steps} if self.steps else {})


def columns_of(parameters: Sequence[Parameter]) -> list[tuple[int, Parameter]]:
    """Return each parameter with the place of its first number in a row."""
    ends = np.cumsum([0, *(p.width for p in parameters)]).tolist()
    return list(zip(ends[:-1], parameters, strict=True))


def in_ranges(parameters: Sequence[Parameter], points: Array) -> Array:
    """Return the numbers of rows, shape (n, columns), by their points of the unit cube.

    Both ends are met exactly.
    """
    low = np.array([p.low for p in parameters for _ in range(p.width)])
    high = np.array([p.high for p in parameters for _ in range(p.width)])
    numbers: Array = (1.0 - points) * low + points * high
    return numbers


def moved(home: Pose, body: str, parameters: Sequence[Parameter], numbers: Array) -> Array:
    """Return the world poses (n, 4, 4) of a body; (1, 4, 4) of one that no parameter moves.

    Turns are carried out in the order of the parameters, each about an axis of the body as the
    ones before have left it. All sums are of single rows, so that a row's pose does not depend on
    which others are computed with it.

    Parameters
    ----------
    home : Pose
        In the world, where all of its parameters are zero.
    body : str
    parameters : sequence of Parameter
        Of both bodies.
    numbers : (n, columns) array
    """
    own = [(at, p) for at, p in columns_of(parameters) if p.moves == body and not p.shape]
    n = len(numbers) if own else 1
    turn = np.repeat(home.rotation[:, :, None], n, axis=2)
    shift = np.repeat(home.translation[:, None], n, axis=1)
    for at, p in own:
        given = np.ascontiguousarray(numbers[:, at : at + p.width].T)
        if p.what == UNIFORM:
            turn = _product(turn, _uniform(given))
        elif p.what in SHIFTS:
            shift[SHIFTS.index(p.what)] += given[0]
        else:
            turn = turned_by(
                turn, TURNS.index(p.what), np.radians(given[0]) if p.degrees else given[0]
            )
    poses = np.zeros((n, 4, 4))
    poses[:, :3, :3], poses[:, :3, 3] = turn.transpose(2, 0, 1), shift.T
    poses[:, 3, 3] = 1.0
    return poses


def turned_by(turn: Array, axis: int, angle: Array) -> Array:
    """Rotations (3, 3, n), each followed by a turn about an axis of the body; or directions as seen
    from a body that has turned so."""
    found = turn.copy()
    j, k = (axis + 1) % 3, (axis + 2) % 3
    cosine, sine = np.cos(angle), np.sin(angle)
    found[:, j] = cosine * turn[:, j] + sine * turn[:, k]
    found[:, k] = cosine * turn[:, k] - sine * turn[:, j]
    return found


def _product(left: Array, right: Array) -> Array:
    found = left[:, 0, None] * right[None, 0]
    for k in (1, 2):
        found = found + left[:, k, None] * right[None, k]
    return found


def _uniform(points: Array) -> Array:
    """Rotations (3, 3, n) by points (3, n) of the unit cube: of uniform points, uniform ones.

    The quaternion is that of K. Shoemake, Uniform random rotations, Graphics Gems III, 1992.
    """
    short, long = np.sqrt(1.0 - points[0]), np.sqrt(points[0])
    first, second = 2.0 * np.pi * points[1], 2.0 * np.pi * points[2]
    x, y = short * np.sin(first), short * np.cos(first)
    z, w = long * np.sin(second), long * np.cos(second)
    return np.array(
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
        ]
    )
