"""Parts at fixed places, and the proven distance of every pair of them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies import Body, Boundary
from standoff.checks.numbers import positive
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.kernels.body import layout as L
from standoff.motion import Pose
from standoff.progress import Progress
from standoff.tracking import distance
from standoff.tracking.cold_query import Queried
from standoff.tracking.status import Status

Array = NDArray[np.float64]


class PartsAnswer:
    """The answer of two parts: that of the pair, with the parts' names.

    Attributes
    ----------
    names : (str, str)
    pieces : (str, str)
        Empty: as of a world's pair of single bodies.
    bodies : pair of Body or Boundary
    found : Proximity or SolidProximity
        The answer itself; its attributes are this one's.
    """

    def __init__(self, names: tuple[str, str], bodies: tuple[Any, Any], found: Any) -> None:
        self.names, self.bodies, self.found = names, bodies, found
        self.pieces = ("", "")

    def __getattr__(self, name: str) -> Any:
        return getattr(self.__dict__["found"], name)

    @property
    def far(self) -> bool:
        """Are they beyond the horizon?"""
        return bool(self.found.status is Status.FAR)

    @property
    def inside(self) -> str:
        """The name of the part that is inside the other's material; empty if none is."""
        side = getattr(self.found, "inside", "")
        return self.names["AB".index(side)] if side else ""

    def __repr__(self) -> str:
        return f"PartsAnswer({self.names[0]!r}, {self.names[1]!r}, {self.found!r})"


@dataclass(frozen=True, eq=False)
class Arrangement:
    """Parts at fixed places.

    Parameters
    ----------
    parts : mapping of str to Solid, Boundary or Body, or of these with a pose
        By name, in their order; a part without a pose stands in the common frame.
    title : str
    unit : str
        Label of lengths.

    Raises
    ------
    StandoffTypeError
        Not a mapping, or a part of another kind.
    StandoffError
        No part, no pose.
    """

    parts: Mapping[str, Any]
    title: str = ""
    unit: str = ""

    def __post_init__(self) -> None:
        if not isinstance(self.parts, Mapping):
            raise StandoffTypeError(
                f"parts = {shown(self.parts)}: give a mapping of names to solids.",
                "parts",
                self.parts,
            )
        if not self.parts:
            raise StandoffError("An arrangement needs parts.", "parts", self.parts)
        placed = {str(name): _placed(str(name), given) for name, given in self.parts.items()}
        object.__setattr__(self, "shapes", {name: shape for name, (shape, _) in placed.items()})
        object.__setattr__(self, "poses", {name: pose for name, (_, pose) in placed.items()})
        boundaries = {name: _boundary(shape) for name, shape in self.shapes.items()}
        object.__setattr__(self, "bodies", boundaries)

    shapes: Mapping[str, Any] = None  # type: ignore[assignment]
    """What is asked: solids and convex bodies, by name."""
    poses: Mapping[str, Pose] = None  # type: ignore[assignment]
    """Of the parts' frames, by name."""
    bodies: Mapping[str, Any] = None  # type: ignore[assignment]
    """The boundaries of the parts, by name."""

    def pairs(self) -> list[tuple[str, str]]:
        """All pairs of names."""
        return list(combinations(self.shapes, 2))

    def distance(self, names: tuple[str, str], within: float | None = None) -> PartsAnswer:
        """The proven answer of one pair; beyond `within` only a bound.

        Raises
        ------
        StandoffError
            A name that there is not.
        """
        for name in names:
            if name not in self.shapes:
                raise StandoffError(f"There is no part {shown(name)}.", "names", names)
        a, b = names
        found = distance(
            self.shapes[a], self.shapes[b], self.poses[a], self.poses[b], within=within
        )
        return PartsAnswer(names, (self.bodies[a], self.bodies[b]), found)

    def distances(
        self, within: float = math.inf, progress: Progress | None = None
    ) -> ArrangementAnswer:
        """Ask all pairs.

        Parameters
        ----------
        within : float
            Horizon, length: pairs whose boxes are farther apart are not asked.
        progress : callable, optional
            Told how many pairs are done, and of how many.
        """
        if within < math.inf:
            within = positive(within, "within")
        horizon = within if within < math.inf else None
        boxes = {name: self._box(name) for name in self.bodies}
        near: dict[tuple[str, str], PartsAnswer] = {}
        far: dict[tuple[str, str], float] = {}
        pairs = self.pairs()
        for k, names in enumerate(pairs):
            gap = _gap(boxes[names[0]], boxes[names[1]])
            if gap > within:
                far[names] = gap
            else:
                answer = self.distance(names, horizon)
                if answer.far:
                    far[names] = float(answer.lower_bound)
                else:
                    near[names] = answer
            if progress is not None:
                progress(k + 1, len(pairs))
        return ArrangementAnswer(self, near, far, within)

    def _box(self, name: str) -> tuple[Array, Array]:
        """(low, high) of a part's box in the common frame, grown by roundoff."""
        body, pose = self.bodies[name], self.poses[name]
        centre = np.asarray(pose.apply(body.reals[L.BOX_CENTRE : L.BOX_CENTRE + 3][None]))[0]
        reach = np.abs(pose.rotation) @ body.reals[L.BOX_HALF : L.BOX_HALF + 3] + body.radius
        spare = BOX_ROUNDINGS * np.finfo(float).eps * (np.abs(centre) + np.abs(reach))
        return centre - reach - spare, centre + reach + spare


BOX_ROUNDINGS = 16.0
"""Roundings of a box's corners: the turn, the shift and the sums of three products."""


@dataclass(frozen=True)
class ArrangementAnswer:
    """What is known of all pairs.

    Attributes
    ----------
    arrangement : Arrangement
    near : mapping of (str, str) to PartsAnswer
        The pairs within the horizon.
    far : mapping of (str, str) to float
        The others: proven to be at least so far apart [length].
    within : float
        The horizon.
    """

    arrangement: Arrangement
    near: Mapping[tuple[str, str], PartsAnswer]
    far: Mapping[tuple[str, str], float]
    within: float

    @property
    def pairs(self) -> Iterator[PartsAnswer]:
        """The answers of the near pairs."""
        return iter(self.near.values())

    @property
    def certified(self) -> bool:
        """Is every near pair's answer proven?"""
        return all(answer.certified for answer in self.near.values())

    def __getitem__(self, names: tuple[str, str]) -> PartsAnswer:
        for each in (names, names[::-1]):
            if each in self.near:
                return self.near[each]
        return self.arrangement.distance(names)


def _placed(name: str, given: Any) -> tuple[Any, Pose]:
    shape, pose = given if isinstance(given, tuple) and len(given) == 2 else (given, None)
    if isinstance(shape, Boundary) and not isinstance(shape, Body):
        from standoff.solids.spatial.solid import Solid

        shape = Solid(shape)
    if not isinstance(shape, Body | Queried):
        raise StandoffTypeError(
            f"Part {name!r} is {shown(shape)}: give a Solid, a Boundary or a Body.", "parts", given
        )
    return shape, Pose.identity() if pose is None else Pose.of(pose)


def _boundary(shape: Any) -> Any:
    """The packed boundary of a part."""
    return getattr(shape, "boundary", shape)


def _gap(one: tuple[Array, Array], other: tuple[Array, Array]) -> float:
    """A lower bound of the distance of two boxes."""
    apart = np.maximum(np.maximum(one[0] - other[1], other[0] - one[1]), 0.0)
    return float(np.linalg.norm(apart)) * (1.0 - BOX_ROUNDINGS * np.finfo(float).eps)
