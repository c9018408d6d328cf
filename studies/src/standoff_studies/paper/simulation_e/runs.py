"""The pair, its motion, and the runs that both figures show."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from standoff.automaton import Visit
from standoff.bodies import Body
from standoff.motion import Carried, ConstantTwist, Helix, Pose, Twist
from standoff.recording import Recording
from standoff.typing import Array
from standoff_studies.paper.bodies import lens_of_patches
from standoff_studies.paper.many_starts import Ends
from standoff_studies.paper.pair_simulation import (
    REST,
    Simulation,
    Start,
    ends_of,
    moves_from,
    random_starts,
)
from standoff_studies.paper.patch_places import place_on, short
from standoff_studies.paper.resets import Move

SEMI_AXES = (0.8, 0.6, 0.7)
"""Factors by which body B, a lens, is stretched along x, y and z."""

PATH_A = REST

PATH_B = Carried(
    Helix(radius=1.7, pitch=-0.2, rate=0.5, centre=(0.0, 0.0, -0.2), phase=-0.5),
    ConstantTwist(Pose.exp((-0.1, 0.0, 0.3)), Twist((0.0, 0.0, 0.0), (-0.15, -0.4, 0.25))),
)
"""B's centre moves on a helix about A's axis while B rotates [length, rad/s], so that the witness
points of both bodies pass from a face over an edge to the next face."""

CONVERGED = 0.3
"""When the start has converged [s]: exp(-K t) is 3e-7."""

TRIED, PATIENCE, ARRIVED = 30, 0.6, 1e-4
"""Number of random starts, and the time [s] and error [length] at which they count as arrived."""

SWITCHED = 0.1
"""When a tried start has reached the features where it stays [s]: 5 / K."""


@cache
def pair() -> tuple[Body, Body]:
    """Return the two lenses of patches."""
    a = lens_of_patches()
    return a, a.transformed(np.diag(SEMI_AXES))


SIMULATION = Simulation(
    bodies=pair,
    paths=(PATH_A, PATH_B),
    duration=4.0,  # A's point is on its edge for a second, as the paper's is from 2.67 to 3.66 s
    step=1e-3,  # the paper's 1 kHz
    gain=50.0,  # "a very low controller gain"
    # One that arrives; the closest points are on faces 0 and 1.
    starts=(((("face", 2), (0.85, 0.39)), (("face", 2), (0.56, 0.36))),),
    entered=0.005,  # the guards see the opposing points alone, and a frame passes several
)


def tried() -> list[Start]:
    """Return the random starts on both bodies that are tried."""
    return random_starts("face", TRIED)


@cache
def arrivals() -> Ends:
    """Try random starts on both bodies with the printed system: which are there at `PATIENCE`."""
    return ends_of(
        SIMULATION,
        tried(),
        PATIENCE,
        lambda answer, due: abs(answer.distance - due.distance) < ARRIVED,
        "random starts",
    )


@cache
def moves_by_resets() -> list[Move]:
    """Return how the printed resets move the witness points, from every tried start."""
    return moves_from(SIMULATION, tried(), SWITCHED)


def sequence(visits: Iterable[Visit]) -> tuple[tuple[str, str], ...]:
    """Return the visited modes in order, as named in the pictures: ("F0", "E2") and so on."""
    return tuple((short(visit.feature_a), short(visit.feature_b)) for visit in visits)


def features_of(visits: Iterable[Visit], body: str) -> tuple[str, ...]:
    """Return the features that one body's witness point goes through, in order."""
    names = [pair["AB".index(body)] for pair in sequence(visits)]
    return tuple(name for k, name in enumerate(names) if k == 0 or name != names[k - 1])


@dataclass(frozen=True)
class FaceParameters:
    """Where one body's witness point lies in the parameters of a face, by frame.

    While it is on an edge, they are those of the face from which it came.

    Attributes
    ----------
    face : ndarray of int, shape (n,)
    u, v : ndarray, shape (n,)
    on_edge : ndarray of bool, shape (n,)
    """

    face: NDArray[np.int64]
    u: Array
    v: Array
    on_edge: NDArray[np.bool_]

    @property
    def pieces(self) -> list[slice]:
        """Stretches of frames on one face, once the true features are entered: between them the
        parameters jump."""
        cuts = [0, *(np.flatnonzero(np.diff(self.face)) + 1).tolist(), len(self.face)]
        entered = round(SIMULATION.entered / SIMULATION.step)
        return [slice(i, k) for i, k in pairwise(cuts) if k > entered]


def face_parameters(recording: Recording, body: str) -> FaceParameters:
    """Return the face parameters of body "A" or "B" in every frame.

    Raises
    ------
    ValueError
        If the run begins on an edge, or comes to a vertex, whose u has no meaning.
    """
    assert recording.pair is not None, "not opened from a file"
    part = recording.pair["AB".index(body)]
    features = recording.feature_a if body == "A" else recording.feature_b
    parameters = recording.parameters_a if body == "A" else recording.parameters_b
    if features[0].kind != "face" or any(feature.kind == "vertex" for feature in features):
        raise ValueError(f"body {body}: the run must begin on a face and come to no vertex")
    face, rows = int(features[0].index), []
    for feature, own in zip(features, parameters, strict=True):
        face = int(feature.index) if feature.kind == "face" else face
        place = place_on(part, face, feature, own)
        assert place is not None, "an edge is entered from one of its faces"
        rows.append((face, place.u, place.v, feature.kind == "edge"))
    columns = list(zip(*rows, strict=True))
    return FaceParameters(*(np.array(column) for column in columns))
