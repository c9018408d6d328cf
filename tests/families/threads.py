"""Pieces of threads made of splines: bars that are swept along a helix, and a pair of them side by
side, as the flanks of a bolt and its nut."""

from functools import cache

import numpy as np
from scipy.interpolate import make_interp_spline

from standoff.geometry import NurbsSurface
from standoff.solids import Solid

RISE = 1.0 / (2.0 * np.pi)
FLANK = [(2.4, -0.4), (3.0, -0.1), (3.0, 0.1), (2.4, 0.4)]
GAP = 0.01


def helix(radius: float, height: float, angles: np.ndarray) -> np.ndarray:
    along = [radius * np.cos(angles), radius * np.sin(angles), height + RISE * angles]
    return np.stack(along, axis=1)


def bar(profile: list[tuple[float, float]], first: float, last: float, parts: int) -> Solid:
    """A profile (radius, height) swept from one angle to another: cubic splines through so many
    parts of each corner's helix."""
    angles = np.linspace(first, last, parts + 1)
    curves = [make_interp_spline(angles, helix(r, z, angles), k=3) for r, z in profile]
    sides = [
        NurbsSurface(np.array([one.c, other.c]), [0, 0, 1, 1], one.t)
        for one, other in zip(curves, curves[1:] + curves[:1], strict=True)
    ]
    ends = []
    for angle in (first, last):
        a, b, c, d = (helix(r, z, np.array([angle]))[0] for r, z in profile)
        ends.append(NurbsSurface([[a, d], [b, c]], [0, 0, 1, 1], [0, 0, 1, 1]))
    return Solid.from_patches([*sides, *ends])


def beside() -> list[tuple[float, float]]:
    """A profile whose lower flank is `GAP` above the upper one of `FLANK`."""
    up = GAP / np.cos(np.arctan(0.5))
    return [
        (2.45, 0.1 + 0.5 * 0.55 + up),
        (3.05, 0.1 - 0.5 * 0.05 + up),
        (3.05, 0.7),
        (2.45, 0.7),
    ]


@cache
def flanks() -> tuple[Solid, Solid]:
    return bar(FLANK, 0.0, 1.0, 5), bar(beside(), -0.2, 0.8, 5)
