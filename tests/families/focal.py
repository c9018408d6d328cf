"""Smooth pairs pushed together along a chosen normal, as a share of their focal depth.

The direction n stays a local minimum of s(n) up to the focal depth, the least eigenvalue of the
radii of curvature rho_A(n) + rho_B(-n); there its branch bifurcates. Depth, points and normal are
known by construction wherever the reference finds no lesser depth.
"""

from __future__ import annotations

from collections import Counter

import numpy as np
from numpy.typing import NDArray

import standoff as so
from families import curved_shapes, nurbs_bodies, penetrating, shapes
from families.shapes import Maker, Rng, Twin
from oracles.bounds import pair_size
from oracles.depth import least_depth
from oracles.depth_inertia import side
from oracles.exact_pairs import exact_pair, random_normal, random_rotation
from standoff_studies import oracles as oracle
from standoff_studies.oracles import Placed

Array = NDArray[np.float64]

LEAST = 1e-9
"""How much a lesser depth, over the size, may be below the constructed one: the reference's own."""
PER_PAIR = 10
"""Poses of one pair of bodies: those of patches take a second to make."""
SHARES = ((1e-6, 1e-2), (1e-2, 0.5), (0.5, 0.9), (0.9, 0.99), (0.99, 0.9999))
"""Ranges of the depth over the focal depth; from the first's low end the size counts."""


def mild_superellipsoid(rng: Rng) -> Twin:
    """Exponents near 1: curved everywhere, as far as float64 can tell."""
    a, b, c = shapes.random_lengths(rng, 3, 0.5, 1.5)
    e1, e2 = (float(x) for x in rng.uniform(0.8, 1.2, 2))
    body = so.shapes.superellipsoid(a, b, c, e1, e2)
    return Twin(curved_shapes.Superellipsoid(a, b, c, e1, e2), body)


def sphere(rng: Rng) -> Twin:
    (radius,) = shapes.random_lengths(rng, 1)
    return Twin(oracle.Sphere(radius), so.shapes.sphere(radius))


KINDS: dict[str, tuple[Maker, Maker]] = {
    "ellipsoids": (penetrating.ellipsoid, penetrating.ellipsoid),
    "ellipsoid-sphere": (penetrating.ellipsoid, sphere),
    "ellipsoid-capsule": (penetrating.ellipsoid, shapes.capsule),
    "superellipsoids": (mild_superellipsoid, mild_superellipsoid),
    "eggs": (curved_shapes.egg, curved_shapes.egg),
    "NURBS ellipsoids": (nurbs_bodies.ellipsoid, nurbs_bodies.ellipsoid),
}


def focal_depth(a: Placed, b: Placed, normal: Array) -> float:
    """The least eigenvalue of rho_A(n) + rho_B(-n) of two smooth bodies; inf along a cylinder."""
    extent = pair_size(a, b)
    first, second = side(a, normal, extent, False), side(b, -normal, extent, False)
    # On a straight line of a cylinder the radius along it is infinite: the other one counts.
    if len(first.flat) or len(second.flat):
        flat, bent = (first, second) if len(first.flat) else (second, first)
        if len(flat.flat) == 2 or len(bent.flat):
            return np.inf
        turn = bent.across @ flat.across[0]
        return float(flat.radii.mean(axis=0)[0, 0] + turn @ bent.radii[0] @ turn)
    frame = first.across
    turn = second.across @ frame.T
    return float(np.linalg.eigvalsh(first.radii[0] + turn.T @ second.radii[0] @ turn)[0])


def focal_errors(
    name: str, low: float, high: float, count: int, seed: int
) -> tuple[Array, int, Counter[str]]:
    """Return errors of distance, points and normal (k, 3), how many were drawn, and statuses.

    The depth is drawn log-uniformly between shares of the focal depth.
    """
    rng = np.random.default_rng([seed, int(1e6 * low)])
    rows, statuses = [], Counter[str]()
    for number in range(count):
        if number % PER_PAIR == 0:
            a, b = (maker(rng) for maker in KINDS[name])
        turns = random_rotation(rng), random_rotation(rng)
        n = random_normal(rng)
        first, second = (
            Placed(x.shape, turn, np.zeros(3)) for x, turn in zip((a, b), turns, strict=True)
        )
        focal = min(focal_depth(first, second, n), pair_size(first, second))
        depth = focal * float(np.exp(rng.uniform(np.log(low), np.log(high))))
        pair = exact_pair(
            a.shape, b.shape, -depth, rng, normal=n, rotation_a=turns[0], rotation_b=turns[1]
        )
        size = pair_size(pair.a, pair.b)
        if least_depth(pair.a, pair.b)[1] < depth - LEAST * size:
            continue
        found = so.distance(a.body, b.body, pair.pose_a, pair.pose_b)
        points = [found.point_a - pair.point_a, found.point_b - pair.point_b]
        statuses[found.status.name] += 1
        rows.append(
            [
                abs(found.distance - pair.distance) / size,
                max(float(np.linalg.norm(x)) for x in points) / size,
                float(np.linalg.norm(found.normal - pair.normal)),
            ]
        )
    return np.array(rows).reshape(-1, 3), count, statuses
