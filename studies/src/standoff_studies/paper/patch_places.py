"""Features of bodies of patches: their names, and where they lie in (u, v)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from standoff.bodies import Body
from standoff.recording import Recording
from standoff.tracking import Feature
from standoff.typing import Array

FeaturePlace = tuple[Feature, Array]
"""A feature, and the parameters of a point on it."""

BothPlaces = tuple[FeaturePlace, FeaturePlace]
"""Those of A and of B."""


class Place(NamedTuple):
    """Where a feature's point lies on one of its faces.

    Attributes
    ----------
    u, v : float
        Parameters of the face; u is nan at a vertex, where a whole side is collapsed.
    """

    u: float
    v: float


def place_on(body: Body, face: int, feature: Feature, parameters: Array) -> Place | None:
    """Return where an answer lies in the parameters of a face; None if it is not on the face.

    Parameters
    ----------
    body : Body
        Of untrimmed patches.
    face : int
    feature : Feature
        Of the answer.
    parameters : ndarray, shape (3,)
        As in a recording.
    """
    part = body.face_parts[face]
    if feature.kind == "face":
        return Place(*parameters[:2].tolist()) if feature.index == face else None
    if feature.kind == "edge":
        for pcurve, (edge, _) in zip(part.pcurves, part.loop, strict=True):
            if edge == feature.index and pcurve is not None:
                u, v, _ = pcurve.point(float(parameters[0]))
                return Place(float(u), float(v))
        return None
    for apex in part.apexes:
        if apex.vertex == feature.index:
            across = apex.side.startswith("u")
            return Place(apex.level, np.nan) if across else Place(np.nan, apex.level)
    return None


def short(feature: Feature) -> str:
    """Return the name of a feature in the pictures: F, E or V and its number."""
    return f"{feature.kind[0].upper()}{feature.index}"


def places_at(recording: Recording, frame: int) -> BothPlaces:
    """Return the features of both bodies in one frame, with their parameters."""
    rows = recording.parameters_a[frame], recording.parameters_b[frame]
    first, second = (row[~np.isnan(row)] for row in rows)
    return (recording.feature_a[frame], first), (recording.feature_b[frame], second)
