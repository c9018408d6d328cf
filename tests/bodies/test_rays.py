"""Whether points are inside, by rays alone, against closed forms: about apexes and poles too."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.random import Generator

import standoff as so
from standoff.bodies.crossings import DIRECTIONS, Crossings
from standoff.typing import Array

COUNT = 200
"""Points of each body and about each place of it."""
Inside = Callable[[Array], Array]


def cone(radius: float, height: float) -> tuple[so.Body, Inside, list[tuple[float, ...]]]:
    def inside(p: Array) -> Array:
        """Positive inside, by how far from the side or the base."""
        down = 0.5 * height - p[:, 2]
        off = radius * down - height * np.hypot(p[:, 0], p[:, 1])
        return np.minimum(off / np.hypot(radius, height), height - down)

    return (
        so.shapes.cone(radius, height),
        inside,
        [(0, 0, 0.5 * height), (radius, 0, -0.5 * height)],
    )


def ball() -> tuple[so.Body, Inside, list[tuple[float, ...]]]:
    body = so.shapes.ellipsoid(1.0, 1.0, 1.0)
    return body, lambda p: 1.0 - np.linalg.norm(p, axis=1), [(0, 0, 1), (0, 0, -1), (1, 0, 0)]


BODIES = {
    "cone": lambda: cone(0.5, 0.5),
    "flat cone": lambda: cone(2.0, 0.2),
    "needle": lambda: cone(0.05, 1.0),
    "ball": ball,
}


@pytest.mark.parametrize("name", BODIES)
def test_rays_tell_inside_from_outside(name: str, rng: Generator) -> None:
    body, inside, places = BODIES[name]()
    rays = Crossings(body)
    points = [rng.uniform(-1.2, 1.2, (COUNT, 3))]
    for place in places:  # about it, and so that the first ray passes it by
        ways = rng.normal(size=(COUNT, 3)) * 10.0 ** rng.uniform(-5.0, 0.0, (COUNT, 1))
        back = (
            DIRECTIONS[0] * rng.uniform(0.0, 1.0, (COUNT, 1)) * (np.arange(COUNT) % 4 > 0)[:, None]
        )
        points.append(np.array(place) + ways - back)
    for point in np.concatenate(points):
        (off,) = inside(point[None])
        if abs(off) > 1e-7:
            assert rays.inside(point) == (off > 0.0), point
