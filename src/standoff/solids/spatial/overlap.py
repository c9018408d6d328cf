"""Balls inside two solids that overlap: the largest that is found inside both, and the two about
one point whose radii are the greatest together."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np

from standoff.bodies.hulls.fewer_points import directions
from standoff.solids.answer import Overlap
from standoff.solids.spatial.minimum import evaluations_of
from standoff.solids.spatial.pair import NearestPlace, PlacedPair
from standoff.solids.spatial.points import depth_beside
from standoff.solids.spatial.tolerances import LAST_CLIMB, LEAST_LENGTH, LOOKS
from standoff.typing import Array

# Of the box around both: where depths are looked at first.
LATTICE = np.array(list(product((0.5, 1.0 / 6.0, 5.0 / 6.0), repeat=3)))
# Points of the unit ball, beside its centre, at which slopes are followed.
CLOUD = np.vstack([r * directions(64) for r in (1.0, 0.5, 0.25, 0.1)])
# Starts of an ascent, and steps of one; of a depth: what a step is to gain.
STARTS, MOST_STEPS, GAINED = 2, 24, 0.01
# Of a step that gains nothing the next one's length; of the size: the first step's.
SHORTER, FIRST_STEP = 0.4, 0.25
# Steps of slopes that are kept, and how far away, in steps, they are believed.
MOST_SLOPES, BELIEVED = 24, 4.0
WAYS = np.array([w for w in product((-1.0, 0.0, 1.0), repeat=3) if any(w)])


UNKNOWN = np.zeros((0, 2, 7))


class Ascent:
    """Depths of world points in both solids, for as long as evaluations are left."""

    def __init__(self, pair: PlacedPair, left: int) -> None:
        self.pair, self.left = pair, left
        self.size = min(pair.a.size, pair.b.size)

    def proven(self, point: Array) -> Overlap:
        """The ball around a point that is proven to be inside both; of a negative radius where the
        point is outside one."""
        da, db, _, _, spent = self.pair.depths(point)
        self.left -= spent
        return Overlap(point, min(da, db), da + db if min(da, db) > 0.0 else min(da, db))

    def look(self, point: Array, known: Array) -> Array:
        """(2, 7): of each solid the point, about how deep it is inside, and the slope; from what is
        known of others (n, 2, 7)."""
        pair, rows = self.pair, np.zeros((2, 7))
        feet = known[..., :3] - known[..., 3:4] * known[..., 4:]
        least = np.linalg.norm(point - feet, axis=2).min(axis=0, initial=pair.size)
        sides = ((pair.a, pair.in_a(point), pair.ra), (pair.b, pair.in_b(point), pair.rb))
        for row, about, (solid, own, turn) in zip(rows, least.tolist(), sides, strict=True):
            counts = np.zeros(8, dtype=np.int64)
            depth, nearest = depth_beside(solid, own, about, counts)
            self.left -= evaluations_of(counts)
            away = turn @ (own - nearest) * (1.0 if depth > 0.0 else -1.0)
            length = float(np.linalg.norm(away))
            row[:3], row[3] = point, length if depth > 0.0 else -length
            row[4:] = away / max(length, LEAST_LENGTH)
        return rows

    def climbed(self, start: Array, merit: Any, step: float, known: Array = UNKNOWN) -> Array:
        """Where the merit of both depths is the greatest near a point: the lesser, or the sum.

        About a point each depth is the least of what it grows to by the slopes that were found; the
        next point is the best of some in a ball by these.
        """
        best, top, slopes, trial = start, -np.inf, known, start
        for _ in range(MOST_STEPS):
            if self.left <= 0:
                break
            seen = self.look(trial, slopes)
            slopes = np.concatenate([slopes[-MOST_SLOPES:], seen[None]])
            value = float(_merit(merit, *seen[:, 3]))
            gained = value > top + GAINED * abs(top) or top == -np.inf
            if value > top:
                best, top = trial, value
            step *= 1.0 if gained else SHORTER
            while True:
                if step <= LAST_CLIMB * self.size:
                    return best
                cloud = best + step * CLOUD
                near = slopes[np.linalg.norm(slopes[:, 0, :3] - best, axis=1) <= BELIEVED * step]
                ways = cloud[None, :, None] - near[:, None, :, :3]
                grown = near[:, :, 3, None] + np.einsum("kjc,knjc->kjn", near[:, :, 4:], ways)
                told = _merit(merit, *grown.min(axis=0))
                if float(told.max()) > top + GAINED * abs(top):
                    trial = cloud[int(told.argmax())]
                    break
                step *= SHORTER
        return best


def _merit(merit: Any, in_a: Any, in_b: Any) -> Any:
    """Of depths in both; that of a point outside one is how far it is outside."""
    least = np.minimum(in_a, in_b)
    return np.where(least > 0.0, merit(in_a, in_b), least)


def common_ball(pair: PlacedPair, starts: Array, least: float, left: int) -> Overlap | None:
    """By ascent from world points and some of the box around both; None if no ball is deeper than
    `least`.

    Local maxima, or what was found before `left` evaluations were spent: the ball is inside both
    solids, but another one may be larger.
    """
    ascent = Ascent(pair, left)
    middle, *others = _lattice(pair)
    spots = [middle, *starts, *others]
    looks = []
    for spot in spots:
        looks.append(ascent.look(spot, UNKNOWN)[:, 3])
        if ascent.left <= left // 2:
            break
    in_a, in_b = np.array(looks).T
    tops = []
    for merit in (np.minimum, np.add):
        order = np.argsort(-_merit(merit, in_a, in_b), kind="stable")[:STARTS]
        ends = [ascent.climbed(spots[k], merit, FIRST_STEP * ascent.size) for k in order]
        tops += ends
    found = [ascent.proven(end) for end in tops]
    ball, both = max(found, key=lambda x: x.radius), max(found, key=lambda x: x.depth)
    return ball._replace(depth=both.depth) if ball.radius > least else None


def deepened(pair: PlacedPair, place: NearestPlace, left: int) -> Overlap:
    """The two balls about a point near to a place of overlap."""
    ascent, known = Ascent(pair, left), np.zeros((1, 2, 7))
    known[0, :, :3] = place.point_a, place.point_b
    known[0, :, 3] = pair.size  # it says where the boundaries are, and bounds no depth
    middle = 0.5 * (place.point_a + place.point_b)
    return ascent.proven(ascent.climbed(middle, np.add, -place.distance, known))


def _lattice(pair: PlacedPair) -> Array:
    """World points of the box around both solids."""
    ways = np.vstack([np.eye(3), -np.eye(3)])
    a = pair.a.heights(ways @ pair.ra) + ways @ pair.pa
    b = pair.b.heights(ways @ pair.rb) + ways @ pair.pb
    high = np.minimum(a, b)
    return np.asarray(-high[3:] + LATTICE * (high[:3] + high[3:]))


def ball_beside(
    pair: PlacedPair, starts: Array, least: float, left: int, steps: Sequence[float] = ()
) -> Overlap | None:
    """The same from the first point inside both that is found beside common points of the
    boundaries, or near to them; at steps that are lengths, or else at `LOOKS`."""
    ascent = Ascent(pair, left)
    ways = WAYS / np.linalg.norm(WAYS, axis=1)[:, None]
    for start in starts:
        for step in steps or [look * ascent.size for look in LOOKS]:
            spots = start + step * ways
            depths = [ascent.proven(spot).radius for spot in spots if ascent.left > 0]
            k = int(np.argmax(depths)) if depths else 0
            if depths and depths[k] > least:
                top = ascent.climbed(spots[k], np.minimum, step)
                ball = ascent.proven(top)
                return ball if ball.radius > depths[k] else ascent.proven(spots[k])
    return None
