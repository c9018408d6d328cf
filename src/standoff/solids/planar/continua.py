"""Which nearest pairs are one, and which are a whole set: parallel lines, concentric arcs."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np

from standoff.kernels.solids import planar_layout as P
from standoff.solids.answer import Continuum
from standoff.solids.planar.pair import PlanarPair
from standoff.solids.planar.tolerances import LONG_SET, ONE_PAIR
from standoff.typing import Array


def distinct(pair: PlanarPair, rows: Array) -> Array:
    """The nearest of each set of rows that are one, nearest first."""
    sets: list[list[Array]] = []
    for row in rows:
        mine = [each for each in sets if any(_is_one(pair, row, other) for other in each)]
        if not mine:
            sets.append([row])
            continue
        mine[0].append(row)
        for other in mine[1:]:
            mine[0].extend(other)
            sets = [each for each in sets if each is not other]
    return np.array([_best(each) for each in sets]).reshape(-1, rows.shape[1])


def _best(rows: list[Array]) -> Array:
    """The nearest of some rows that are one, with the best bound that any of their pieces has."""
    best = rows[0].copy()
    best[1] = max(float(row[1]) for row in rows)
    return best


def _is_one(pair: PlanarPair, row: Array, other: Array) -> bool:
    """Are two pairs of points the same, or is the pair half way between them as near?

    Where boundaries nearly follow each other, pairs within the tolerance reach far.
    """
    if np.abs(row[2:6] - other[2:6]).max() <= ONE_PAIR * pair.size:
        return True
    halfway = []
    for side, solid in enumerate((pair.a, pair.b)):
        leaves = int(row[10 + side]), int(other[10 + side])
        curves = {solid.outline.leaf_int(leaf, P.CURVE) for leaf in leaves}
        if len(curves) > 1:
            return False
        t = 0.5 * float(row[8 + side] + other[8 + side])
        halfway.append(_moved(pair, side, solid.edges[curves.pop()].point(t)[None, :2])[0])
    gap = float(np.linalg.norm(halfway[1] - halfway[0]))
    return bool(gap <= max(row[0], other[0]) + pair.tolerance)


def continuum_of(pair: PlanarPair, near: Array, least: float) -> Continuum | None:
    """The longest set of nearest pairs, of lines and arcs in closed form."""
    pieces: list[tuple[str, Array, Array]] = []
    for row in near:
        found = _piece(pair, row, least)
        if found is not None:
            pieces.append(found)
    chains = _chained(pieces, ONE_PAIR * pair.size)
    if not chains:
        return None
    kind, first, last, extent = max(chains, key=lambda chain: chain[3])
    if extent <= LONG_SET * pair.size:
        return None
    shape: Literal["line", "arc"] = "line" if kind == "line" else "arc"
    if np.abs(first - last).max() <= ONE_PAIR * pair.size:
        return Continuum(shape, ())
    ends = tuple((pair.world(end[:2]), pair.world(end[2:])) for end in (first, last))
    return Continuum(shape, ends)


def _piece(pair: PlanarPair, row: Array, least: float) -> tuple[str, Array, Array] | None:
    """(kind, first pair, last pair) of the nearest pairs of two leaves: each (ax, ay, bx, by)."""
    a, b = pair.a.outline, pair.b.outline
    leaf_a, leaf_b = int(row[10]), int(row[11])
    forms = a.leaf_int(leaf_a, P.FORM), b.leaf_int(leaf_b, P.FORM)
    limit = least + pair.tolerance
    if forms == (P.LINE, P.LINE):
        return _of_lines(_ends(pair, 0, leaf_a), _ends(pair, 1, leaf_b), limit)
    if forms == (P.ARC, P.ARC):
        return _of_arcs(pair, leaf_a, leaf_b, limit)
    return None


def _moved(pair: PlanarPair, side: int, points: Any) -> Array:
    """Points (n, 2) of a solid's frame in A's."""
    at = np.asarray(points, dtype=np.float64)
    if side == 0:
        return at
    R_a, R_b = (pair.poses[k : k + 9].reshape(3, 3)[:2, :2] for k in (0, 12))
    moved: Array = (at @ R_b.T + pair.poses[21:23] - pair.poses[9:11]) @ R_a
    return moved


def _ends(pair: PlanarPair, side: int, leaf: int) -> Array:
    outline = (pair.a, pair.b)[side].outline
    at = P.N_LEAF * leaf
    points = outline.leaves[at + P.START : at + P.END + 2].reshape(2, 2)
    return _moved(pair, side, points)


def _of_lines(one: Array, two: Array, limit: float) -> tuple[str, Array, Array] | None:
    """Where the segments lie side by side, as far as they are no farther apart than `limit`."""
    along = one[1] - one[0]
    length = float(np.linalg.norm(along))
    along = along / length
    other = two[1] - two[0]
    rate = float(other @ along)
    if rate == 0.0:
        return None
    s = np.sort((two - one[0]) @ along)
    low, high = max(0.0, float(s[0])), min(length, float(s[1]))
    if low >= high:
        return None

    def pair_at(x: float) -> Array:
        a = one[0] + x * along
        part = (x - float((two[0] - one[0]) @ along)) / rate
        return np.concatenate([a, two[0] + part * other])

    ends = np.array([pair_at(low), pair_at(high)])
    gaps = np.linalg.norm(ends[:, 2:] - ends[:, :2], axis=1)
    if gaps.max() > limit:  # only part of it: the gap is linear along it
        if gaps.min() > limit or gaps[0] == gaps[1]:
            return None
        part = (limit - gaps.min()) / (gaps.max() - gaps.min())
        near, far = int(np.argmin(gaps)), int(np.argmax(gaps))
        ends[far] = ends[near] + part * (ends[far] - ends[near])
    return "line", ends[0], ends[1]


def _arc(pair: PlanarPair, side: int, leaf: int) -> tuple[Array, float, float, float]:
    """(centre, radius, first angle, turn counterclockwise) of an arc in A's frame."""
    outline = (pair.a, pair.b)[side].outline
    at = P.N_LEAF * leaf
    centre = _moved(pair, side, outline.leaves[at + P.CENTRE : at + P.CENTRE + 2][None])[0]
    ends = _ends(pair, side, leaf) - centre
    if outline.leaves[at + P.GREATEST_K] < 0.0:  # clockwise
        ends = ends[::-1]
    first = float(np.arctan2(ends[0, 1], ends[0, 0]))
    turn = float(np.arctan2(ends[1, 1], ends[1, 0]) - first) % (2.0 * np.pi)
    return centre, float(np.linalg.norm(ends[0])), first, turn


def _of_arcs(
    pair: PlanarPair, leaf_a: int, leaf_b: int, limit: float
) -> tuple[str, Array, Array] | None:
    """Where arcs round nearly the same centre stand over each other."""
    centre_a, r_a, first_a, turn_a = _arc(pair, 0, leaf_a)
    centre_b, r_b, first_b, turn_b = _arc(pair, 1, leaf_b)
    offset = (first_b - first_a + np.pi) % (2.0 * np.pi) - np.pi
    low, high = max(0.0, offset), min(turn_a, offset + turn_b)
    if low >= high or np.linalg.norm(centre_b - centre_a) > 0.5 * (r_a + r_b):
        return None

    def pair_at(angle: float) -> Array:
        u = np.array([np.cos(first_a + angle), np.sin(first_a + angle)])
        return np.concatenate([centre_a + r_a * u, centre_b + r_b * u])

    inside = [x for x in np.linspace(low, high, 65) if _gap(pair_at(x)) <= limit]
    if len(inside) < 2:
        return None
    return "arc", pair_at(float(inside[0])), pair_at(float(inside[-1]))


def _gap(ends: Array) -> float:
    return float(np.linalg.norm(ends[2:] - ends[:2]))


def _chained(
    pieces: list[tuple[str, Array, Array]], reach: float
) -> list[tuple[str, Array, Array, float]]:
    """Pieces that go on from each other as one, with its length on A or B, the longer."""
    left: list[list[Any]] = [
        [kind, p, q, _long(p, q)] for kind, p, q in _without_copies(pieces, reach)
    ]
    merged = True
    while merged:
        merged = False
        for one in left:
            for two in left:
                if one is not two and one[0] == two[0] and _joined(one, two, reach):
                    left = [each for each in left if each is not two]
                    merged = True
                    break
            if merged:
                break
    return [(kind, p, q, extent) for kind, p, q, extent in left]


def _long(p: Array, q: Array) -> float:
    return float(max(np.linalg.norm(q[:2] - p[:2]), np.linalg.norm(q[2:] - p[2:])))


def _without_copies(
    pieces: list[tuple[str, Array, Array]], reach: float
) -> list[tuple[str, Array, Array]]:
    kept: list[tuple[str, Array, Array]] = []
    for kind, p, q in pieces:
        middle = 0.5 * (p + q)
        if all(np.abs(0.5 * (a + b) - middle).max() > reach for _, a, b in kept):
            kept.append((kind, p, q))
    return kept


def _joined(one: list[Any], two: list[Any], reach: float) -> bool:
    """Let piece `one` go on by piece `two` where they share an end; False if they share none."""
    for k in (1, 2):
        for j in (1, 2):
            if np.abs(one[k] - two[j]).max() <= reach:
                one[k] = two[3 - j]
                one[3] += two[3]
                return True
    return False
