"""Joints that mimic others: which numbers of a Pinocchio model follow which, and by how much."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from standoff.errors import StandoffError
from standoff.robots.joints import SLIDES, JointKind
from standoff.typing import Array, Ints


class MimicModel(NamedTuple):
    """A model all of whose joints have numbers of their own, some of which follow others'.

    Attributes
    ----------
    mimics : dict of int to (int, float, float)
        Of each joint that follows: the joint it follows, which follows none, ratio and offset.
    own_q, own_v : arrays of int
        Of a robot's q and v: their numbers in the model's.
    q_at, v_at : (njoints,) arrays of int
        Where each joint's numbers begin in the robot's q and v; of those that follow, nothing.
    fold : (model's nv, nv) array
        The model's velocity by the robot's.
    places : tuple of ((int, int), (int, int), float, float)
        Of each that follows: first number and count in the model's q, those of its master, ratio,
        offset.
    """

    mimics: dict[int, tuple[int, float, float]]
    own_q: Ints
    own_v: Ints
    q_at: Ints
    v_at: Ints
    fold: Array
    places: tuple[tuple[tuple[int, int], tuple[int, int], float, float], ...]

    def whole(self, q: Array) -> Array:
        """The model's configuration by the robot's."""
        found = np.empty(len(self.own_q) + sum(own[1] for own, *_ in self.places))
        found[self.own_q] = q
        for (at, count), (first, numbers), ratio, offset in self.places:
            given = found[first : first + numbers]
            number = float(given[0] if numbers == 1 else np.arctan2(given[1], given[0]))
            number = ratio * number + offset
            found[at : at + count] = number if count == 1 else (np.cos(number), np.sin(number))
        return found


def followed(model: Any, mimics: Mapping[int, tuple[int, float, float]]) -> MimicModel:
    """The numbers of a model by those that follow no other."""
    own = [j for j in range(1, model.njoints) if j not in mimics]
    own_q, own_v = (
        np.array([at[j] + k for j in own for k in range(count[j])], dtype=np.int64)
        for at, count in ((model.idx_qs, model.nqs), (model.idx_vs, model.nvs))
    )
    q_at, v_at = (
        np.searchsorted(numbers, list(at))
        for numbers, at in ((own_q, model.idx_qs), (own_v, model.idx_vs))
    )
    fold = np.zeros((model.nv, len(own_v)))
    fold[own_v, np.arange(len(own_v))] = 1.0
    for j, (master, ratio, _) in mimics.items():
        fold[model.idx_vs[j], v_at[master]] = ratio
    places = tuple(
        (
            (int(model.idx_qs[j]), int(model.nqs[j])),
            (int(model.idx_qs[master]), int(model.nqs[master])),
            ratio,
            offset,
        )
        for j, (master, ratio, offset) in mimics.items()
    )
    return MimicModel(dict(mimics), own_q, own_v, q_at, v_at, fold, places)


def read_as(
    kind: JointKind, numbers: int, ratio: float, names: tuple[str, str], what: str
) -> JointKind:
    """How a joint of a kind reads a joint of one number, or of (cos, sin).

    Raises StandoffError: after a turn of the one the other would be elsewhere.
    """
    if numbers == 1:
        return JointKind.HINGE if kind is JointKind.CONTINUOUS else kind
    slides = kind in SLIDES
    if ratio and (slides or ratio != round(ratio)):
        after = "slides" if slides else f"turns {ratio:g} times as far"
        raise StandoffError(
            f"The joint {names[0]!r} of {what} mimics {names[1]!r}, which turns endlessly and is "
            f"read as (cos, sin), and {after}: after a turn of the one the other is elsewhere, "
            "and no configuration tells where. Give mimic=False, or make the first a revolute "
            "joint with limits.",
            "mimic",
        )
    return kind if slides else JointKind.CONTINUOUS
