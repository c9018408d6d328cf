"""A pair of solids at poses: what is found in A's frame, and as world vectors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import islice

import numpy as np

from standoff.kernels.entries.solids import gradient, leaf_points, nearest_in_leaves
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.spatial_progress import BOUND
from standoff.kernels.solids.spatial_tolerances import SURE_NORMAL
from standoff.motion.pose import Pose
from standoff.motion.vectors import pose_row
from standoff.solids.answer import NearestPair
from standoff.solids.spatial.half_space import of_pair
from standoff.solids.spatial.minimum import LeastFound, SearchOptions, leaf_jet_of, least_distance
from standoff.solids.spatial.points import signed_distances
from standoff.solids.spatial.sides import outside_direction
from standoff.solids.spatial.solid_model import SolidModel
from standoff.solids.spatial.tolerances import (
    COLLAPSED_FRAME,
    LEAST_LENGTH,
    PROOF_ROUNDING,
)
from standoff.typing import Array

# Reference points, which are tried until one is off the other's boundary.
REFERENCES = 6


@dataclass(frozen=True)
class NearestPlace:
    """A pair of nearest points in world axes, with their leaves."""

    row: Array
    point_a: Array
    point_b: Array
    normal: Array

    @property
    def distance(self) -> float:
        return float(self.row[0])

    @cached_property
    def spot(self) -> Array:
        """Both points and the distance (7,)."""
        return np.array([*self.point_a, *self.point_b, self.row[0]])


class PlacedPair:
    """Two solids at world poses; of a half-space the part of its plane beside the other.

    ra, pa, rb, pb : the poses of the frames that the search is in.
    """

    def __init__(self, a: SolidModel, b: SolidModel, pose_a: Pose, pose_b: Pose) -> None:
        a, b = of_pair(a, pose_a, b, pose_b), of_pair(b, pose_b, a, pose_a)
        self.a, self.b = a, b
        self._given = pose_a, pose_b
        self.ra, self.pa = a.placed(pose_a)
        self.rb, self.pb = b.placed(pose_b)
        rotation = self.ra.T @ self.rb
        self.relative = pose_row(rotation, self.ra.T @ (self.pb - self.pa))
        self.size = a.size + b.size

    def in_a(self, points: Array) -> Array:
        """World points in A's frame."""
        return np.asarray((points - self.pa) @ self.ra)

    def in_b(self, points: Array) -> Array:
        return np.asarray((points - self.pb) @ self.rb)

    @property
    def frames(self) -> tuple[Array, Array]:
        """World poses (12,) of the frames of both boundaries: R by rows, p."""
        return pose_row(self.ra, self.pa), pose_row(self.rb, self.pb)

    @property
    def slack(self) -> float:
        """Of both solids, length."""
        return self.a.slack + self.b.slack

    @property
    def poses(self) -> tuple[Array, Array]:
        """World poses (12,) of both as they were given: R by rows, p."""
        a, b = (pose_row(p.rotation, p.translation) for p in self._given)
        return a, b

    def provable(self, tolerance: float) -> float:
        """A tolerance, length, that is not below what rounding allows."""
        away = float(np.linalg.norm(self.pb - self.pa))
        return max(tolerance, 4.0 * PROOF_ROUNDING * (self.size + away))

    def least(self, senses: tuple[int, int], sought: SearchOptions) -> LeastFound:
        """The search between both boundaries, each seen from outside or inside."""
        return least_distance(
            self.a.packed, self.b.packed, self.relative, senses, self.size, sought
        )

    def moved(self, way: Array) -> PlacedPair:
        """The same pair with B moved by a world vector."""
        pose_a, pose_b = self._given
        return PlacedPair(self.a, self.b, pose_a, Pose(pose_b.rotation, pose_b.translation + way))

    def swapped(self) -> PlacedPair:
        """The same pair with A and B changed over."""
        pose_a, pose_b = self._given
        return PlacedPair(self.b, self.a, pose_b, pose_a)

    def place(self, row: Array, senses: tuple[int, int]) -> NearestPlace:
        """Of a row (distance, leaf_a, leaf_b, parameters)."""
        return self.places([row], senses)[0]

    def places(self, rows: Sequence[Array] | Array, senses: tuple[int, int]) -> list[NearestPlace]:
        """Of rows (distance, leaf_a, leaf_b, parameters)."""
        found = []
        for row, x, y in zip(rows, *self.points_of(np.array(rows)), strict=True):
            away = y - x
            length = float(np.linalg.norm(away))
            told = length > SURE_NORMAL * self.size
            normal = away / length if told else self._normal_at(row, senses)
            found.append(NearestPlace(row, x, y, normal))
        return found

    def points_of(self, rows: Array) -> tuple[Array, Array]:
        """The points (n, 3) of A and of B of rows, world axes."""
        own = np.empty((len(rows), 6))
        leaf_points((self.a.packed, self.b.packed), rows, own)
        x, y = own[:, None, :3] @ self.ra.T, own[:, None, 3:] @ self.rb.T
        return x[:, 0] + self.pa, y[:, 0] + self.pb

    def _normal_at(self, row: Array, senses: tuple[int, int]) -> Array:
        """From a face, or across two edges, where the points are too near to each other for a
        direction."""
        sides = (
            (self.a, int(row[1]), row[3:5], self.ra, 1.0 if senses[0] == S.OUTSIDE else -1.0),
            (self.b, int(row[2]), row[5:7], self.rb, -1.0 if senses[1] == S.OUTSIDE else 1.0),
        )
        across = self._across_edges(row)
        ordered = sorted(sides, key=lambda side: -side[0].leaves[side[1]].dim)
        for solid, leaf, (u, v), rotation, sign in ordered:
            out = outside_direction(solid, leaf, float(u), float(v))
            if out is not None:
                found = sign * (rotation @ out)
                if across is not None:
                    found = across if across @ found > 0.0 else -across
                return np.asarray(found / np.linalg.norm(found))
        return np.array([0.0, 0.0, 1.0])

    def _across_edges(self, row: Array) -> Array | None:
        """Normal to both edges of a row; None where it has no two, or they are parallel."""
        ways = []
        for solid, leaf, at, rotation in (
            (self.a, int(row[1]), row[3:5], self.ra),
            (self.b, int(row[2]), row[5:7], self.rb),
        ):
            if solid.leaves[leaf].dim != 1:
                return None
            tangent = rotation @ leaf_jet_of(solid.packed, leaf, *at)[1]
            ways.append(tangent / max(float(np.linalg.norm(tangent)), LEAST_LENGTH))
        normal = np.cross(*ways)
        return normal if float(np.linalg.norm(normal)) > COLLAPSED_FRAME else None

    def nearest_pair(self, place: NearestPlace, lower: float) -> NearestPair:
        row = place.row
        leaf_a, leaf_b = int(row[1]), int(row[2])
        return NearestPair(
            place.distance,
            min(max(lower, float(row[BOUND])), place.distance) - self.slack,
            place.point_a,
            place.point_b,
            place.normal,
            self.a.feature_of(leaf_a),
            self.b.feature_of(leaf_b),
            self.a.parameters_of(leaf_a, row[3:5]),
            self.b.parameters_of(leaf_b, row[5:7]),
        )

    def gradient(self, place: NearestPlace) -> Array:
        """(12,) by unit twists (v_A, omega_A, v_B, omega_B), world axes."""
        to = np.zeros(12)
        origins = [np.asarray(pose.translation) for pose in self._given]
        arms = [place.normal, place.point_a - origins[0], place.point_b - origins[1]]
        gradient(np.concatenate(arms), False, to)
        return to

    def found_from(self, row: Array, starts: Array, most: float) -> Array:
        """Rows of the local minima up to a distance that Newton's method finds in a row's leaves
        from other parameters (n, 4), on both solids."""
        rows = np.zeros((len(starts), 8))
        rows[:, 1:3], rows[:, 3:7] = row[1:3], starts
        counts = np.zeros(8, dtype=np.int64)
        nearest_in_leaves((self.a.packed, self.b.packed), self.relative, rows, counts)
        return rows[rows[:, 0] <= most]

    def depths(self, point: Array) -> tuple[float, float, Array, Array, int]:
        """(how deep a world point is in A and in B, at least; how each grows there; how many
        evaluations it took)."""
        found = [
            signed_distances(solid, inside(point)[None])
            for solid, inside in ((self.a, self.in_a), (self.b, self.in_b))
        ]
        ga, gb = -self.ra @ found[0].gradient[0], -self.rb @ found[1].gradient[0]
        da, db = (-float(each.upper_bound[0]) for each in found)
        return da, db, ga, gb, sum(int(each.evaluations[0]) for each in found)


def references_of(solid: SolidModel) -> Array:
    """Some points of a solid's boundary, own frame: vertices first, then middles of leaves."""
    if solid.references is None:
        vertices = np.asarray(solid.boundary.vertex_points).reshape(-1, 3)[:REFERENCES]
        whole = (k for k, leaf in enumerate(solid.leaves) if leaf.dim and not leaf.cut)
        others = [
            leaf_jet_of(solid.packed, k, *middle_of(solid, k))[0]
            for k in islice(whole, REFERENCES - len(vertices))
        ]
        solid.references = np.vstack([vertices, np.reshape(others, (-1, 3))])
    return solid.references


def middle_of(solid: SolidModel, leaf: int) -> tuple[float, float]:
    u0, u1, v0, v1 = solid.leaves[leaf].reals[:4]
    return 0.5 * (u0 + u1), 0.5 * (v0 + v1)
