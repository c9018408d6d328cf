"""Simulation D, Figs. 16-18: the lens and a point on a helix, through faces, edges and a vertex."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache

import numpy as np

from standoff.automaton import Visit
from standoff.bodies import shapes
from standoff.motion import Fixed, Helix
from standoff.recording import Recording
from standoff.typing import Array
from standoff_studies.paper.bodies import lens_of_patches
from standoff_studies.paper.many_starts import Ends
from standoff_studies.paper.pair_simulation import (
    AT_POINT,
    REST,
    Simulation,
    Start,
    ends_of,
    moves_from,
)
from standoff_studies.paper.patch_places import place_on
from standoff_studies.paper.resets import Move

RADIUS, OFFSET = 1.0, 0.45
"""Radius of the lens's balls, and offset of their centres from its middle [length]."""

HELIX = Helix(
    radius=1.6,
    pitch=0.6,
    rate=2.0,
    centre=(-0.29, 0.05, 0.37),
    axis=(15.0, 0.0, 4.0),
    phase=np.radians(100.0),
)
"""The point's path [length, rad/s]: chosen so that the sequence the paper describes occurs."""

SIMULATION = Simulation(
    bodies=lambda: (lens_of_patches(RADIUS, OFFSET), shapes.point()),
    paths=(REST, HELIX),
    duration=5.34,  # 1.7 turns of the helix
    step=1e-3,  # the paper's 1 kHz
    gain=25.0,  # "a very low controller gain"
    # Two that arrive; the closest point is on face 1 at about (0.2, 0.6).
    starts=(
        ((("face", 0), (0.8, 0.3)), AT_POINT),
        ((("face", 2), (0.5, 0.5)), AT_POINT),
    ),
    entered=0.005,  # the guards see the point alone, and a frame passes several
)

SETTLED = 1e-4
"""Greatest normalised projection error at which a start counts as settled."""

TRIED = (0.1, 0.3, 0.5, 0.7, 0.9)
"""u and v of the starts that are tried, on each of three faces: 75."""

PATIENCE = 1.0
"""Time after which a start that has not arrived counts as such [s]: 25 / K."""

ARRIVED = 1e-3
"""Greatest error of a start that has arrived [length]."""


@cache
def arrivals(*, moving: bool = True) -> Ends:
    """Try starts all over the three faces with the printed system, for `PATIENCE`.

    The point goes along its helix, or rests where that begins.
    """
    paths = REST, HELIX if moving else Fixed(HELIX.pose(0.0))
    return ends_of(
        SIMULATION,
        tried(),
        PATIENCE,
        lambda answer, due: bool(np.linalg.norm(answer.point_a - due.point_a) < ARRIVED),
        "starts on a grid",
        paths,
    )


def tried() -> list[Start]:
    """Return the starts that are tried: on each face a grid of (u, v)."""
    faces = range(SIMULATION.a.n_faces)
    return [((("face", k), (u, v)), AT_POINT) for k in faces for u in TRIED for v in TRIED]


@cache
def moves_by_resets() -> list[Move]:
    """Return how the printed resets move the witness points, from every tried start.

    By then its switches to the true feature are over.
    """
    return moves_from(SIMULATION, tried(), SIMULATION.entered)


def face_parameters(recording: Recording, face: int) -> Array:
    """Return (u, v) on one face in every frame, (n, 2): nan in frames that are not on it.

    Answers on the face's edges and at its vertices are included.
    """
    assert recording.pair is not None, "not opened from a file"
    found = np.full((len(recording), 2), np.nan)
    for k, (feature, parameters) in enumerate(
        zip(recording.feature_a, recording.parameters_a, strict=True)
    ):
        place = place_on(recording.pair[0], face, feature, parameters)
        if place is not None:
            found[k] = place
    return found


def settling_steps(recording: Recording) -> int:
    """Return the first frame with projection errors below `SETTLED`."""
    return int((recording.residual < SETTLED).argmax())


def sequence(visits: Iterable[Visit]) -> tuple[str, ...]:
    """Return the visited features of the lens in order."""
    return tuple(str(visit.feature_a) for visit in visits)
