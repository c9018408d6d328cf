"""Corners inside edges, and creases inside faces.

A search goes by tangents and normals that change continuously over a leaf, so it finds no nearest
point at a corner that is no vertex, nor at a crease that is no edge.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from standoff.bodies.tolerances import SMOOTH_ANGLE
from standoff.errors import BodyError
from standoff.geometry.curves import Curve
from standoff.geometry.surfaces import Surface
from standoff.solids.spatial.leaves import Leaf
from standoff.solids.spatial.tolerances import BESIDE_KNOT, TANGENT_ROUNDOFF
from standoff.typing import Array, Bools

ACROSS = np.array([0.0, 0.19, 0.43, 0.71, 1.0])
"""Of a leaf's side along a knot: where the normals on both sides of the knot are compared."""


class CornerError(BodyError):
    """An edge with a corner inside, or a face with a crease."""


def check_corners(curves: Mapping[int, Curve]) -> None:
    """Edges by their numbers; raises CornerError for the first that has a corner inside."""
    for number, curve in curves.items():
        spans = np.asarray(curve.spans(), dtype=float)
        if len(spans) < 3:
            continue
        steps = BESIDE_KNOT * np.diff(spans)
        before = curve.jets(spans[1:-1] - steps[:-1])
        after = curve.jets(spans[1:-1] + steps[1:])
        noise = _tangent_noise(before, np.diff(spans).min())
        turned = np.flatnonzero(_turned(before[:, 1], after[:, 1], noise))
        if len(turned):
            t = float(spans[1 + turned[0]])
            x, y, z = curve.point(t)
            raise CornerError(
                f"Edge {number} has a corner inside, at t = {t:.6g}, ({x:.6g}, {y:.6g}, {z:.6g}): "
                "split it there, with a vertex.",
                part=("edge", number),
            )


def check_creases(surfaces: Mapping[int, tuple[int, Surface]], leaves: Sequence[Leaf]) -> None:
    """Face and surface of each chart; raises CornerError for the first that has a crease between
    two of its leaves."""
    for chart, (face, surface) in surfaces.items():
        breaks = surface.breaks()
        if not any(len(each) for each in breaks):
            continue
        own = np.array([leaf.reals[:4] for leaf in leaves if leaf.dim == 2 and leaf.chart == chart])
        for along, knots in enumerate(breaks):
            for knot in knots:
                _check_crease(face, surface, own.reshape(-1, 2, 2), along, float(knot))


def _check_crease(face: int, surface: Surface, own: Array, along: int, knot: float) -> None:
    """own: (n, 2, 2), of each leaf the ends of both parameters."""
    sides = own[own[:, along, 1] == knot], own[own[:, along, 0] == knot]
    if not all(len(side) for side in sides):
        return
    ends = sides[0][:, 1 - along]
    across = (ends[:, :1] + ACROSS * np.diff(ends, axis=1)).ravel()
    spans = [float(np.diff([low, *inner, high]).min()) for (low, high), inner in _sides_of(surface)]
    normals, noise = [], np.zeros(len(across))
    for way, side in zip((-1.0, 1.0), sides, strict=True):
        at = np.empty((len(across), 2))
        width = float(np.diff(side[:, along], axis=1).max())
        at[:, along], at[:, 1 - along] = knot + way * BESIDE_KNOT * width, across
        jets = surface.jets(at)
        tangents = np.linalg.norm(jets[:, 1:3], axis=2)
        normals.append(np.cross(jets[:, 1], jets[:, 2]))
        # a product of tangents, each with its own roundoff: much beside a pole
        errors = [_tangent_noise(jets, span) for span in spans]
        both = errors[0] * tangents[:, 1] + errors[1] * tangents[:, 0]
        noise = np.maximum(noise, both)
    turned = np.flatnonzero(_turned(normals[0], normals[1], noise))
    if len(turned):
        name, other = ("u", "v") if along == 0 else ("v", "u")
        raise CornerError(
            f"Face {face} has a crease inside, at {name} = {knot:.6g}, {other} = "
            f"{across[turned[0]]:.6g}: split it there, with an edge.",
            part=("face", face),
        )


def _sides_of(surface: Surface) -> Iterator[tuple[tuple[float, float], Sequence[float]]]:
    """Of u, then of v: the ends of the domain, and the knots between them."""
    u0, u1, v0, v1 = surface.domain
    return zip(((u0, u1), (v0, v1)), surface.breaks(), strict=True)


def _tangent_noise(jets: Array, span: float) -> Array:
    """What roundoff may change tangents by, in their own unit: differences of points, over a span
    of parameters."""
    noise: Array = TANGENT_ROUNDOFF * np.abs(jets[:, 0]).max(axis=1) / span
    return noise


def _turned(before: Array, after: Array, noise: Array) -> Bools:
    """Do vectors (n, 3), each within its noise, differ in direction?"""
    lengths = np.linalg.norm(before, axis=1), np.linalg.norm(after, axis=1)
    sizes = lengths[0] * lengths[1]
    sine = np.linalg.norm(np.cross(before, after), axis=1)
    doubt = noise * (lengths[0] + lengths[1])
    turned: Bools = (sine > SMOOTH_ANGLE * sizes + doubt) | ((before * after).sum(axis=1) < -doubt)
    return turned
