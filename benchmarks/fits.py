"""Fits of turned parts and rings on tubes beside their closed forms: status, bound, error and time.

Run it with ``python -m benchmarks.fits``; ``--worst`` leaves out all rows but the slowest of each
kind. Times are of one processor, the better of two cold queries, in milliseconds. It fails where a
row is not proven to 1e-10 of the sizes, or a bound is on the wrong side of the closed form.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator
from functools import cache
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize_scalar

from standoff.solids import Solid
from standoff.solids.answer import SolidProximity
from standoff.solids.spatial.distance import spatial_distance
from standoff.solids.spatial.tolerances import PROOF_TOLERANCE
from standoff.tracking.status import Status
from standoff_studies.soak.solid_parts import elbow, ring, turned_part

BORE, LONG, SLOPE = 3.0, 20.0, 0.05
GAPS = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.5, 1.0, 2.5)
PLACES = ((0.0, 0.0), (0.0, 1e-6), (0.3, 0.0), (1e-9, 0.0), (0.3, 1e-3), (0.99, 0.0))
"""(how far aside, of the gap; how high)."""
OFFSETS = (0.0, 1e-12, 1e-9, 1e-6, 1e-4, 1e-3, 0.1)
TILTS = (1e-12, 1e-9, 1e-6, 1e-4, 1e-3, 1e-2)
BEND, LINK = 2.0, 1.0
"""Radii of the circles in a bend's and in a ring's tube."""
ROUNDED = 1e-14
"""Of the sizes: what the closed form and the parts' radii are rounded by."""
ONTO_TANGENT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])


class Case(NamedTuple):
    """Two solids, the pose of the second, and their distance in closed form."""

    kind: str
    what: str
    a: Solid
    b: Solid
    turn: np.ndarray
    move: np.ndarray
    true: float


@cache
def part(*corners: tuple[float, float]) -> Solid:
    return Solid(turned_part("part", corners).boundary)


def tube(inner: float, outer: float, low: float, high: float) -> Solid:
    return part((inner, low), (outer, low), (outer, high), (inner, high))


def pin(radius: float, low: float, high: float) -> Solid:
    return part((0.0, low), (radius, low), (radius, high), (0.0, high))


def fits(gap: float) -> dict[str, tuple[Solid, Solid, float]]:
    """(what has the bore, what is in it, the distance of the walls over the gap of their radii)."""
    r, bore = BORE - gap, tube(BORE, 6.0, 0.0, LONG)
    blind = part((0.0, 0.0), (6.0, 0.0), (6.0, LONG), (BORE, LONG), (BORE, 5.0), (0.0, 5.0))
    wide = BORE + SLOPE * LONG
    taper = part((BORE, 0.0), (6.0, 0.0), (6.0, LONG), (wide, LONG))
    plug = part((0.0, 0.0), (r, 0.0), (wide - gap, LONG), (0.0, LONG))
    return {
        "pin": (bore, pin(r, 0.0, LONG), 1.0),
        "bush": (bore, tube(0.4, r, 0.0, LONG), 1.0),
        "bearing": (bore, tube(0.4, r, 5.0, 15.0), 1.0),
        "plug in a blind hole": (blind, pin(r, 5.0 + 2.0 * gap, LONG), 1.0),
        "taper": (taper, plug, 1.0 / float(np.hypot(1.0, SLOPE))),
    }


def fitted(gaps: tuple[float, ...]) -> Iterator[Case]:
    for gap in gaps:
        for kind, (a, b, share) in fits(gap).items():
            for aside, lift in PLACES:
                if kind == "taper" and lift:
                    continue
                move = np.array([0.6 * aside * gap, 0.8 * aside * gap, lift])
                what = (
                    f"gap {gap:g}, aside {aside:g} of it, {f'{lift:g} high' if lift else 'flush'}"
                )
                true = gap * (1.0 - aside) * share
                yield Case(kind, what, a, b, np.eye(3), move, true)


def circles_apart(turn: np.ndarray, move: np.ndarray) -> float:
    """The distance of a link's circle from a bend's, by the angle on the link's."""

    def away(angle: float) -> float:
        x, y, z = turn @ [LINK * np.cos(angle), LINK * np.sin(angle), 0.0] + move
        return float(np.hypot(np.hypot(x, y) - BEND, z))

    angles = np.linspace(-np.pi, np.pi, 721)
    start = angles[np.argmin([away(t) for t in angles])]
    found = minimize_scalar(away, bounds=(start - 0.01, start + 0.01), method="bounded")
    return min(float(found.fun), away(start))


def turned_by(angle: float, axis: int) -> np.ndarray:
    """Of the axis x, 0, or the axis z, 2."""
    c, s = np.cos(angle), np.sin(angle)
    rows = [[1, 0, 0], [0, c, -s], [0, s, c]] if axis == 0 else [[c, -s, 0], [s, c, 0], [0, 0, 1]]
    return np.array(rows, dtype=float)


def ringed() -> Iterator[Case]:
    """A ring round a link's tube, and round a bend in a pipe, in the middle of it."""
    link = Solid(ring(LINK, 0.2).boundary)
    pipe = Solid(elbow(BEND, 0.3, 0.4, 0.5).boundary)
    half = turned_by(0.25 * np.pi, 2)
    for kind, a, placed in (
        ("link through link", Solid(ring(BEND, 0.4).boundary), np.eye(3)),
        ("O-ring on a bend", pipe, half),
    ):
        poses = [(f"aside {d:g}", np.eye(3), np.array([d, 0.0, 0.0])) for d in OFFSETS]
        poses += [(f"above {d:g}", np.eye(3), np.array([0.0, 0.0, d])) for d in OFFSETS]
        poses += [
            (f"tilted {t:g} about {'xyz'[k]}", turned_by(t, k), np.zeros(3))
            for t in TILTS
            for k in (0, 2)
        ]
        for what, turn, off in poses:
            at = turn @ ONTO_TANGENT, BEND * np.eye(3)[0] + off
            true = circles_apart(*at) - 0.4 - 0.2
            yield Case(kind, what, a, link, placed @ at[0], placed @ at[1], true)


@cache
def cases(gaps: tuple[float, ...] = GAPS) -> tuple[Case, ...]:
    return *fitted(gaps), *ringed()


def holds(case: Case, answer: SolidProximity) -> bool:
    """Is it proven to 1e-10 of the sizes, with the closed form within its bounds?"""
    size = case.a.size + case.b.size
    width, spare = answer.upper_bound - answer.lower_bound, ROUNDED * size
    proven = answer.status in (Status.CONVERGED, Status.CONTINUUM)
    proven = proven and width <= 1.01 * PROOF_TOLERANCE * size
    return proven and answer.lower_bound - spare <= case.true <= answer.upper_bound + spare


def row(case: Case) -> tuple[float, bool, str]:
    """(milliseconds, whether it holds, cells)."""
    spent = []
    for _ in range(2):
        start = time.process_time()
        answer = spatial_distance(case.a, case.b, None, (case.turn, case.move))
        spent.append(1e3 * (time.process_time() - start))
    width = answer.upper_bound - answer.lower_bound
    good = holds(case, answer)
    cells = (
        case.kind,
        case.what,
        answer.status.name,
        f"{width / (case.a.size + case.b.size):.1e}",
        f"{answer.distance - case.true:.1e}",
        f"{answer.counts.boxes}",
        f"{min(spent):.1f}",
        "" if good else "does not hold",
    )
    return min(spent), good, "| " + " | ".join(cells) + " |"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--worst", action="store_true", help="the slowest of each kind only")
    given = parser.parse_args()
    heads = ("fit", "pose", "status", "width / size", "error", "boxes", "ms", "")
    print("| " + " | ".join(heads) + " |\n" + "|---" * len(heads) + "|")
    slowest: dict[str, tuple[float, bool, str]] = {}
    count = failed = 0
    for case in cases():
        told = row(case)
        count += 1
        failed += not told[1]
        if not given.worst or not told[1]:
            print(told[2], flush=True)
        if told[0] > slowest.get(case.kind, (0.0,))[0]:
            slowest[case.kind] = told
    print("The slowest of each kind:")
    for _, _, cells in slowest.values():
        print(cells)
    print(f"{count} rows, {failed} of them do not hold")
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
