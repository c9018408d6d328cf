"""FCL through python-fcl, at its defaults."""

from __future__ import annotations

from typing import Any

import numpy as np

from benchmarks.bench.contender import Array, Contender, Found, asked
from benchmarks.bench.motion import Frames, Pair
from standoff_studies.accuracy.peers.answer import require
from standoff_studies.accuracy.peers.fcl_peer import fcl_shape


def contenders(pair: Pair, frames: Frames) -> list[Contender]:
    """python-fcl's, if it has the pair."""
    fcl = require("fcl")
    shapes = fcl_shape(pair.a), fcl_shape(pair.b)
    if None in shapes:
        return []
    first, second = (fcl.CollisionObject(shape, fcl.Transform()) for shape in shapes)
    request = fcl.DistanceRequest(enable_nearest_points=True, enable_signed_distance=True)
    place, distance, result_of = fcl.Transform, fcl.distance, fcl.DistanceResult

    def ask(pose_a: Array, pose_b: Array) -> Any:
        first.setTransform(place(pose_a[:3, :3], pose_a[:3, 3]))
        second.setTransform(place(pose_b[:3, :3], pose_b[:3, 3]))
        result = result_of()
        distance(first, second, request, result)
        return result

    def read(result: Any) -> Found:
        points = (np.array(point) for point in result.nearest_points)
        return Found(float(result.min_distance), *points)

    return [asked("python-fcl", frames.pairs, ask, read, keeps=shapes)]
