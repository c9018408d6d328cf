"""GJK on patches, after Turnbull and Cameron: support points by climbing over the boundary."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.typing import Array
from standoff_studies.paper.field.shells import Jet, Shell, Spot, held

CLIMBED = 1e-9
"""Greatest cosine between the direction and a free tangent at a support point: its height is then
off by its square."""

CLOSED = 1e-12
"""Part of the squared distance by which GJK's bounds may differ at its end: witness points are then
off by some 1e-6 of it."""

NEGLIGIBLE = 1e-12
"""Weight of a corner of GJK's simplex below which it is dropped."""

MOST_CLIMBS, MOST_SUPPORTS, HALVINGS = 60, 60, 30
"""Steps of a climb, support points of a frame, halvings of a step, after which it gives up."""


class Lost(ArithmeticError):
    """A method did not come to an end."""


def climb(shell: Shell, spot: Spot, way: Array) -> tuple[Spot, Array]:
    """Climb from a place to the support point along a direction: place and point.

    Newton's step where the height is concave, else along the gradient, halved until it climbs; over
    sides to the patches beyond. A convex body has one top.
    """
    if shell.n == 0:
        return spot, shell.jet(spot, 0).x
    way = way / np.linalg.norm(way)
    at = shell.jet(spot, 2)
    for _ in range(MOST_CLIMBS):
        slope = -at.tangents @ way
        free = ~held(spot.q, slope, at.tangents)
        steep = np.abs(slope[free]) / np.linalg.norm(at.tangents[free], axis=1)
        higher = None
        if steep.max(initial=0.0) > CLIMBED:
            higher = _higher(shell, spot, at, _uphill(at, slope, free, way), way)
        if higher is None:
            if free.all() and shell.is_bottom(at.x, way):
                # a flat face's, from which no gradient leads: on from its corner
                spot = Spot(spot.patch, np.zeros(shell.n))
            onward = _across(shell, spot, way)
            if onward is None:
                return spot, at.x
            higher = onward, shell.jet(onward, 2)
        spot, at = higher
    raise Lost("a climb did not end")


def _higher(shell: Shell, spot: Spot, at: Jet, step: Array, way: Array) -> tuple[Spot, Jet] | None:
    """The place after a step, halved until it climbs; None if roundoff hides any rise."""
    for _ in range(HALVINGS):
        new = Spot(spot.patch, np.clip(spot.q + step, 0.0, 1.0))
        there = shell.jet(new, 2)
        if (there.x - at.x) @ way > 0.0:
            return new, there
        step = 0.5 * step
    return None


def _uphill(at: Jet, slope: Array, free: NDArray[np.bool_], way: Array) -> Array:
    """Newton's step to the top; where the height is not concave the steepest way, up to a side."""
    curved = -at.bends[np.ix_(free, free)] @ way
    concave = np.linalg.eigvalsh(curved).min() > 0.0
    if not concave:
        curved = at.tangents[free] @ at.tangents[free].T
    step = np.zeros(len(slope))
    step[free] = -np.linalg.lstsq(curved, slope[free], rcond=None)[0]
    return step if concave else step / np.abs(step).max()


def _across(shell: Shell, spot: Spot, way: Array) -> Spot | None:
    """The steepest way up over a side, if any goes up."""
    best, found = CLIMBED, None
    for other, inward in shell.beyond(spot):
        if inward @ way > best:
            best, found = float(inward @ way), other
    return found


class Nearest(NamedTuple):
    """The point of a hull nearest to the origin: itself, and its weights on some of its corners."""

    point: Array
    corners: list[Any]
    weights: Array


Support = Callable[[Array], tuple[Array, Any]]
"""The farthest corner along a direction, and what is known about it."""


def nearest(support: Support, first: tuple[Array, Any], closed: float = CLOSED) -> Nearest:
    """Return the point nearest to the origin of a convex set, by GJK's sequence of simplices.

    The nearest point of a simplex is found by Wolfe's rule: towards the nearest point of its plane,
    dropping the corner whose weight vanishes on the way.
    """
    points, known, weights = [first[0]], [first[1]], np.ones(1)
    v = first[0]
    for _ in range(MOST_SUPPORTS):
        w, about = support(-v)
        if v @ (v - w) <= closed * (v @ v) or any((w == p).all() for p in points):
            return Nearest(v, known, weights)
        points, known, weights = [*points, w], [*known, about], np.append(weights, 0.0)
        while True:
            wanted = _plane_weights(np.array(points))
            if (wanted > NEGLIGIBLE).all():
                weights = wanted
                break
            down = wanted <= NEGLIGIBLE
            fall = weights[down] - wanted[down]
            part = float(np.min(weights[down] / np.where(fall > 0.0, fall, np.inf), initial=1.0))
            weights = weights + part * (wanted - weights)
            kept = weights > NEGLIGIBLE
            if kept.all():
                kept[int(np.argmin(np.where(down, weights, np.inf)))] = False
            points = [p for p, k in zip(points, kept, strict=True) if k]
            known = [p for p, k in zip(known, kept, strict=True) if k]
            weights = weights[kept] / weights[kept].sum()
        v = weights @ np.array(points)
    raise Lost("GJK did not end")


def _plane_weights(points: Array) -> Array:
    """Weights of the point nearest to the origin in the plane of some points."""
    edges = points[1:] - points[0]
    rest = np.linalg.lstsq(edges @ edges.T, -edges @ points[0], rcond=None)[0]
    return np.append(1.0 - rest.sum(), rest)


def gjk(shells: tuple[Shell, Shell], spots: tuple[Spot, Spot]) -> tuple[tuple[Spot, Spot], Array]:
    """A frame of GJK from the last frame's places: new places, and the witness points (2, 3)."""
    places = list(spots)
    x = [shell.jet(spot, 0).x for shell, spot in zip(shells, spots, strict=True)]

    def support(way: Array) -> tuple[Array, Array]:
        found = []
        for k, (shell, sign) in enumerate(zip(shells, (1.0, -1.0), strict=True)):
            places[k], point = climb(shell, places[k], sign * way)
            found.append(point)
        return found[0] - found[1], np.array(found)

    got = nearest(support, (x[0] - x[1], np.array(x)))
    return (places[0], places[1]), np.tensordot(got.weights, np.array(got.corners), 1)
