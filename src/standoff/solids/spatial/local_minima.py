"""Local minima of the distance of two solids in space: of the pairs that a search found, those that
are one, each once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from standoff.bodies.features import Feature
from standoff.geometry.validation import Array
from standoff.kernels.entries.queries import on_face
from standoff.kernels.solids.spatial_progress import BOUND
from standoff.solids.spatial.minimum import Found, leaf_jet_of
from standoff.solids.spatial.pair import Place, PlacedPair
from standoff.solids.spatial.points import distance_to_boundary
from standoff.solids.spatial.solid_model import SolidModel
from standoff.solids.spatial.stationary import is_stationary
from standoff.solids.spatial.ties import is_same
from standoff.solids.spatial.tolerances import HAS_DIRECTION


def local_minima(pair: PlacedPair, found: Found, senses: tuple[int, int]) -> list[Place]:
    """All that were found, the nearest first; of each set of nearest pairs one."""
    sets: list[list[Place]] = []
    for k, row in enumerate([found.best, *found.minima]):
        place = pair.place(row, senses)
        if k > 0 and not is_stationary(pair, place):
            continue
        mine = [
            each for each in sets if any(_is_one(pair, place, k, found.tolerance) for k in each)
        ]
        if not mine:
            sets.append([place])
            continue
        mine[0].append(place)
        for other in mine[1:]:
            mine[0].extend(other)
            sets = [each for each in sets if each is not other]
    return [_best(each) for each in sets]


def _best(places: list[Place]) -> Place:
    """The nearest of some that are one, with the best bound that any of their pieces has."""
    best = min(places, key=lambda place: place.distance)
    row = best.row.copy()
    row[BOUND] = max(float(place.row[BOUND]) for place in places)
    return replace(best, row=row)


def _is_one(pair: PlacedPair, place: Place, other: Place, tolerance: float) -> bool:
    """Are two pairs the same, or is the pair half way between them as near?"""
    if abs(place.distance - other.distance) > tolerance:
        return False
    if is_same(place, other, pair.size):
        return True
    halfway = []
    for side, (solid, turn, shift) in enumerate(
        ((pair.a, pair.ra, pair.pa), (pair.b, pair.rb, pair.pb))
    ):
        middle = _middle(solid, side, place.row, other.row)
        if middle is None:
            return False
        halfway.append(middle @ turn.T + shift)
    gap = float(np.linalg.norm(halfway[1] - halfway[0]))
    return gap <= max(place.distance, other.distance) + tolerance


def _middle(solid: SolidModel, side: int, row: Array, other: Array) -> Array | None:
    """The point half way between two points of one feature, own frame; of a face and an edge or a
    vertex of it, if the face is plane. None where there is none on the boundary."""
    leaves = int(row[1 + side]), int(other[1 + side])
    features = [solid.part_of(leaf) for leaf in leaves]
    at = 0.5 * (row[3 + 2 * side : 5 + 2 * side] + other[3 + 2 * side : 5 + 2 * side])
    parts = [solid.leaves[leaf] for leaf in leaves]
    if features[0] == features[1] and parts[0].chart == parts[1].chart:
        if parts[0].dim == 2:
            ints, reals = solid.boundary.ints, solid.boundary.reals
            if not on_face(ints, reals, parts[0].chart, float(at[0]), float(at[1])):
                return None
        return np.asarray(leaf_jet_of(solid.packed, leaves[0], float(at[0]), float(at[1]))[0])
    if not _share_plane(solid, features[0], features[1]):
        return None
    ends = [
        leaf_jet_of(solid.packed, leaf, *each[3 + 2 * side : 5 + 2 * side])[0]
        for leaf, each in zip(leaves, (row, other), strict=True)
    ]
    middle = 0.5 * (ends[0] + ends[1])
    off = distance_to_boundary(solid, middle).upper
    return np.asarray(middle) if off <= HAS_DIRECTION * solid.size else None


def _share_plane(solid: SolidModel, one: Feature, other: Feature) -> bool:
    """Do two features belong to one plane face?"""
    return bool(_plane_faces(solid, one) & _plane_faces(solid, other))


def _plane_faces(solid: SolidModel, feature: Feature) -> set[int]:
    """The numbers of the plane faces that a feature is, or bounds."""
    faces = solid.boundary.face_parts
    if feature.kind == "face":
        near = {feature.index}
    elif feature.kind == "edge":
        near = {k for k, face in enumerate(faces) if any(j == feature.index for j, _ in face.loop)}
    else:
        edges = solid.boundary.edge_parts
        ends = {j for j, e in enumerate(edges) if feature.index in (e.first, e.last)}
        near = {k for k, face in enumerate(faces) if any(j in ends for j, _ in face.loop)}
    return {k for k in near if all(chart.flat for chart in faces[k].charts)}
