"""How long a run stays in one mode."""

from __future__ import annotations

from typing import NamedTuple

from standoff.bodies.features import Feature


class Visit(NamedTuple):
    """A stay in one mode.

    Attributes
    ----------
    feature_a, feature_b : Feature
        Active features of A and B.
    start, end : float
        Times, s.
    """

    feature_a: Feature
    feature_b: Feature
    start: float
    end: float
