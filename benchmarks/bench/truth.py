"""What is true of a frame, and how much of it other code than the library's has shown.

The witness points are those of ``so.distance``. Support functions, which share no code with the
library, prove its distance: along any unit direction n the bodies are at least -s_A(n) - s_B(-n)
apart, and no two points of them are nearer than the least distance.
"""

from __future__ import annotations

import numpy as np

import standoff as so
from benchmarks.bench.contender import Contender, Found
from benchmarks.bench.motion import Frames, Pair
from standoff_studies.oracles import Placed

CHECKS = 25
"""About so many frames are compared."""


def truths(pair: Pair, frames: Frames, count: int, checks: int = CHECKS) -> dict[int, so.Proximity]:
    """The cold answers of frames spread over the first ``count``."""
    chosen = np.unique(np.linspace(1, count, min(count, checks)).astype(int))
    return {
        int(k): so.distance(pair.a.body, pair.b.body, frames.poses_a[k], frames.poses_b[k])
        for k in chosen
    }


def doubt(pair: Pair, frames: Frames, k: int, known: so.Proximity) -> float:
    """How far the support functions' bound lies from the distance of frame k, over the size.

    In penetration the bound is that of one direction; that no other is less deep is the library's
    own proof (``benchmarks.penetration`` checks it).
    """
    a, b = (
        Placed(solid.support, pose[:3, :3], pose[:3, 3])
        for solid, pose in zip((pair.a, pair.b), frames.pairs[k], strict=True)
    )
    bound = -float(a.support(known.normal)[0]) - float(b.support(-known.normal)[0])
    return abs(bound - known.distance) / pair.size


def errors(
    pair: Pair, contender: Contender, known: dict[int, so.Proximity]
) -> tuple[float, float, float]:
    """Greatest errors of distance and witness points and gap of certificates, over the size.

    Of the frames of ``known`` that the contender has answered; NaN where it has no answer.
    """
    rows = []
    for k, truth in known.items():
        found: Found = contender.found(k)
        witness = max(
            float(np.linalg.norm(found.point_a - truth.point_a)),
            float(np.linalg.norm(found.point_b - truth.point_b)),
        )
        rows.append((abs(found.distance - truth.distance), witness, found.gap))
    worst = np.array(rows).max(axis=0) / pair.size
    return float(worst[0]), float(worst[1]), float(worst[2])
