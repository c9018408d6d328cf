"""The answer of one pair of a world's bodies of which one has a solid."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from standoff.bodies.features import NO_FEATURE
from standoff.solids.answer import SolidCounts, SolidProximity
from standoff.solids.of_pieces import turned as turned_answer
from standoff.tracking.derivatives import Smoothness
from standoff.tracking.status import Status
from standoff.typing import Array


@dataclass(frozen=True, eq=False, repr=False)
class SolidPairAnswer(SolidProximity):
    """A `SolidProximity` of two bodies of a world, with their names.

    Of a pair beyond the horizon, with status FAR, only ``lower_bound`` is known: ``distance`` and
    ``upper_bound`` are inf, points and normal are nan, and there are no features.

    Attributes
    ----------
    names : (str, str)
        Of the bodies.
    bodies : (Body or solid, the same)
        The nearest pieces, or the bodies themselves.
    time : float
        Since the start, s.
    """

    names: tuple[str, str] = ("", "")
    bodies: tuple[Any, Any] = (None, None)
    time: float = 0.0

    @property
    def far(self) -> bool:
        """Is the pair beyond its horizon?"""
        return self.status is Status.FAR

    def as_dict(self) -> dict[str, Any]:
        told = super().as_dict()
        del told["bodies"]
        return told

    def __repr__(self) -> str:
        a, b = (" ".join(filter(None, each)) for each in zip(self.names, self.pieces, strict=True))
        if self.far:
            return f"SolidPairAnswer({a!r}, {b!r}, FAR: at least {self.lower_bound:.6g} apart)"
        return (
            f"SolidPairAnswer({a!r}, {b!r}, distance={self.distance:.12g}, {self.feature_a} - "
            f"{self.feature_b}, {self.status.name})"
        )


def named_answer(
    found: SolidProximity,
    names: tuple[str, str],
    bodies: tuple[Any, Any],
    time: float,
    turned: bool = False,
) -> SolidPairAnswer:
    """An answer with the names of its bodies; `turned`: of (B, A), as the names and bodies are."""
    found = turned_answer(found) if turned else found
    facts = {field.name: getattr(found, field.name) for field in fields(SolidProximity)}
    return SolidPairAnswer(**facts, names=names, bodies=bodies, time=time)


def beyond(bound: float, poses: tuple[Array, Array]) -> SolidProximity:
    """The answer of a pair of which only a lower bound is known [length]."""
    unseen: Array = np.full(3, np.nan)
    return SolidProximity(
        status=Status.FAR,
        distance=np.inf,
        lower_bound=bound,
        upper_bound=np.inf,
        slack=0.0,
        point_a=unseen,
        point_b=unseen,
        normal=unseen,
        feature_a=NO_FEATURE,
        feature_b=NO_FEATURE,
        parameters_a=(),
        parameters_b=(),
        minima=(),
        continuum=None,
        overlap=None,
        inside="",
        open=(),
        gradient_rows=np.full(12, np.nan),
        smoothness=Smoothness.UNDEFINED,
        counts=SolidCounts(),
        poses=poses,
    )
