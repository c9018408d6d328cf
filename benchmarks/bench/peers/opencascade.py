"""OpenCASCADE on ellipsoids of six biquartic patches: shapes, and all pairs of surfaces."""

from __future__ import annotations

from typing import Any

import numpy as np

from benchmarks.bench.contender import Array, Contender, Found, asked
from benchmarks.bench.motion import Frames, Pair
from standoff.geometry.ellipsoid_patches import ellipsoid_patches
from standoff_studies.accuracy.peers.answer import require
from standoff_studies.accuracy.peers.opencascade_peer import (
    NURBS,
    bezier_surface,
    cascade_shape,
    placed,
    transform_of,
)

SHAPES = "OpenCASCADE, DistShapeShape"
SURFACES = "OpenCASCADE, ExtremaSurfaceSurface, all pairs of patches"
NOTHING = Found(np.nan, np.full(3, np.nan), np.full(3, np.nan))


def contenders(pair: Pair, frames: Frames) -> list[Contender]:
    """OpenCASCADE's, on a NURBS pair."""
    require("OCP")
    if not pair.a.kind.name == pair.b.kind.name == NURBS:
        return []
    return [shapes(pair, frames), surfaces(pair, frames)]


def _split(pose: Array) -> tuple[Array, Array]:
    return pose[:3, :3], pose[:3, 3]


def _points(one: Any, other: Any) -> tuple[Array, Array]:
    return np.array(one.Coord()), np.array(other.Coord())


def shapes(pair: Pair, frames: Frames) -> Contender:
    """``BRepExtrema_DistShapeShape`` on the sewn shells."""
    extrema = require("OCP.BRepExtrema").BRepExtrema_DistShapeShape
    a, b = cascade_shape(pair.a), cascade_shape(pair.b)

    def ask(pose_a: Array, pose_b: Array) -> Any:
        return extrema(placed(a, _split(pose_a)), placed(b, _split(pose_b)))

    def read(found: Any) -> Found:
        if not found.IsDone() or found.NbSolution() == 0:
            return NOTHING
        return Found(found.Value(), *_points(found.PointOnShape1(1), found.PointOnShape2(1)))

    return asked(SHAPES, frames.pairs, ask, read)


def surfaces(pair: Pair, frames: Frames) -> Contender:
    """``GeomAPI_ExtremaSurfaceSurface`` on all pairs of patches; the least of them."""
    extrema = require("OCP.GeomAPI").GeomAPI_ExtremaSurfaceSurface
    point = require("OCP.gp").gp_Pnt
    patches_a, patches_b = (
        [bezier_surface(patch) for patch in ellipsoid_patches(*solid.values.values())]
        for solid in (pair.a, pair.b)
    )

    def ask(pose_a: Array, pose_b: Array) -> list[Any]:
        turn_a, turn_b = transform_of(_split(pose_a)), transform_of(_split(pose_b))
        placed_a = [patch.Transformed(turn_a) for patch in patches_a]
        placed_b = [patch.Transformed(turn_b) for patch in patches_b]
        return [extrema(one, other) for one in placed_a for other in placed_b]

    def read(answers: list[Any]) -> Found:
        answers = [answer for answer in answers if answer.NbExtrema() > 0]
        if not answers:
            return NOTHING
        least = min(answers, key=lambda answer: answer.LowerDistance())
        ends = point(), point()
        least.NearestPoints(*ends)
        return Found(least.LowerDistance(), *_points(*ends))

    return asked(SURFACES, frames.pairs, ask, read)
