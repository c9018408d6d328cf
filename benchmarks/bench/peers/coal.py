"""Coal 3 on its own shapes: ``coal.distance`` and the functor ``ComputeDistance``."""

from __future__ import annotations

from typing import Any

import numpy as np

from benchmarks.bench.contender import Array, Contender, Found, asked
from benchmarks.bench.motion import Frames, Pair
from standoff_studies.accuracy.peers.answer import require
from standoff_studies.accuracy.peers.coal_peer import coal_request, coal_shape

DISTANCE = "Coal, distance"
GUESS = "Coal, ComputeDistance, cached guess"


def read(result: Any) -> Found:
    """Coal's answer as the table compares it."""
    points = np.array(result.getNearestPoint1()), np.array(result.getNearestPoint2())
    return Found(float(result.min_distance), *points)


def contenders(pair: Pair, frames: Frames) -> list[Contender]:
    """Coal's, if it has the pair."""
    require("coal")
    shapes = coal_shape(pair.a), coal_shape(pair.b)
    if None in shapes:
        return []
    found = []
    for tight in (False, True):
        setting = "tight" if tight else "default"
        found.append(by_function(f"{DISTANCE}, {setting}", frames, shapes, tight))
        found.append(by_functor(f"{GUESS}, {setting}", frames, shapes, tight))
    return found


def by_function(
    name: str,
    frames: Frames,
    shapes: tuple[Any, Any],
    tight: bool = False,
    memory: int = 0,
    at_rest: bool = False,
) -> Contender:
    """``coal.distance`` on any two geometries. A's transform is made once where it is at rest."""
    coal = require("coal")
    request, result = coal_request(tight), coal.DistanceResult()
    place, distance = coal.Transform3s, coal.distance
    a, b = shapes
    kept = place(frames.poses_a[0, :3, :3], frames.poses_a[0, :3, 3])

    def ask(pose_a: Array, pose_b: Array) -> Any:
        result.clear()
        place_a = kept if at_rest else place(pose_a[:3, :3], pose_a[:3, 3])
        distance(a, place_a, b, place(pose_b[:3, :3], pose_b[:3, 3]), request, result)
        return result

    return asked(name, frames.pairs, ask, read, memory, shapes)


def by_functor(
    name: str, frames: Frames, shapes: tuple[Any, Any], tight: bool, at_rest: bool = False
) -> Contender:
    """The functor, each query begun in the last one's direction. As `by_function` at rest."""
    coal = require("coal")
    request, result = coal_request(tight), coal.DistanceResult()
    request.gjk_initial_guess = coal.GJKInitialGuess.CachedGuess
    place, query = coal.Transform3s, coal.ComputeDistance(*shapes)
    kept = place(frames.poses_a[0, :3, :3], frames.poses_a[0, :3, 3])

    def ask(pose_a: Array, pose_b: Array) -> Any:
        result.clear()
        place_a = kept if at_rest else place(pose_a[:3, :3], pose_a[:3, 3])
        query(place_a, place(pose_b[:3, :3], pose_b[:3, 3]), request, result)
        request.updateGuess(result)
        return result

    return asked(name, frames.pairs, ask, read, keeps=shapes)
