"""How far two faces of one boundary reach beyond each other where they cross."""

from __future__ import annotations

import numpy as np

from standoff.kernels.entries.queries import on_face
from standoff.solids.spatial.minimum import leaf_jet_of
from standoff.solids.spatial.solid_model import SolidModel
from standoff.solids.spatial.tolerances import LEAST_ANGLE, LEAST_LENGTH
from standoff.typing import Array

# Halvings of a length, from the solid's size on, and of what is left of it.
HALVINGS, REFINED = 40, 6


def crossing_depth(
    solid: SolidModel, leaves: tuple[int, int], at: Array
) -> tuple[float, tuple[Array, Array]]:
    """(depth, jets (6, 3) of both) of two faces' leaves at parameters (4,) of a common point.

    The depth is the least distance from one face's tangent plane to what the other reaches, on
    either side, seen across the line in which they cross; 0 where they only touch.
    """
    jets = (
        leaf_jet_of(solid.packed, leaves[0], *at[:2]),
        leaf_jet_of(solid.packed, leaves[1], *at[2:]),
    )
    normals = []
    for jet in jets:
        normal = np.cross(jet[1], jet[2])
        normals.append(normal / max(float(np.linalg.norm(normal)), LEAST_LENGTH))
    line = np.cross(normals[0], normals[1])
    sine = float(np.linalg.norm(line))
    if sine <= LEAST_ANGLE:
        return 0.0, jets
    reaches = [
        _reach(solid, leaf, uv, jet, sign * np.cross(line / sine, normal))
        for leaf, uv, jet, normal in zip(leaves, (at[:2], at[2:]), jets, normals, strict=True)
        for sign in (-1.0, 1.0)
    ]
    return sine * min(reaches), jets


def _reach(solid: SolidModel, leaf: int, uv: Array, jet: Array, way: Array) -> float:
    """How far a face reaches from its point in a direction of its tangent plane, length: the
    longest of some lengths at whose end it still is, found by halving."""
    chart = solid.leaves[leaf].chart
    step = np.linalg.lstsq(jet[1:3].T, way, rcond=None)[0]

    def is_on(length: float) -> bool:
        u, v = uv + length * step
        return bool(on_face(solid.boundary.ints, solid.boundary.reals, chart, float(u), float(v)))

    low, high = 0.0, solid.size
    for _ in range(HALVINGS):
        if is_on(high):
            low = high
            break
        high *= 0.5
    high = min(2.0 * low, solid.size)
    for _ in range(REFINED):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if is_on(middle) else (low, middle)
    return low
