"""The ready-made shapes with random lengths, each as the library's body and as its support."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull, HalfspaceIntersection

from standoff.bodies.body import Body
from standoff_studies import oracles
from standoff_studies.kinds import TWINS, Twin
from standoff_studies.oracles import Array

SHORTEST, LONGEST = 0.35, 1.05
"""Range of lengths, as multiples of the solid's scale: ratios of lengths up to 3."""
SMALLEST, GREATEST = 0.5, 2.0
"""Range of a solid's scale."""

SAMPLES = 2000
"""Directions of a search of s(n): 4.5 degrees apart."""


def _spread(count: int) -> Array:
    """Return ``count`` unit vectors evenly distributed over the sphere: a Fibonacci spiral."""
    z = 1 - (2 * np.arange(count) + 1) / count
    turn = np.pi * (3 - np.sqrt(5)) * np.arange(count)
    r = np.sqrt(1 - z * z)
    return np.column_stack([r * np.cos(turn), r * np.sin(turn), z])


DIRECTIONS = _spread(SAMPLES)

Values = dict[str, Any]
Rng = np.random.Generator


@dataclass(frozen=True)
class Kind:
    """A kind of shape: how to draw the lengths of its twin, in the order of its arguments."""

    name: str
    draw: Callable[[Rng], Values]
    flat: bool = False
    """A point or a segment: two of them have no volume and cannot penetrate."""
    call: str = ""
    """How ``import standoff as so`` builds it from its lengths, as a format string; that of
    ``so.shapes`` if empty."""
    judge: Callable[..., oracles.Shape] | None = None
    """Its support function, if different from that of the twin."""
    own: Twin | None = None
    """Its twin, if it is not among `TWINS`."""

    @property
    def twin(self) -> Twin:
        return self.own or TWINS[self.name]

    @property
    def build(self) -> Callable[..., Body]:
        return self.twin.body

    @property
    def support(self) -> Callable[..., oracles.Shape]:
        return self.judge or self.twin.support


@dataclass(frozen=True, eq=False)
class Solid:
    """One shape of a kind, with its lengths. Two are equal only if they are the same object."""

    kind: Kind
    values: Values

    @cached_property
    def body(self) -> Body:
        return self.kind.build(*self.values.values())

    @property
    def call(self) -> str:
        """The Python expression that builds the body after ``import standoff as so``."""
        values = {name: np.asarray(value).tolist() for name, value in self.values.items()}
        if self.kind.call:
            return self.kind.call.format(**values)
        arguments = ", ".join(repr(value) for value in values.values())
        return f"so.shapes.{self.kind.build.__name__}({arguments})"

    @cached_property
    def support(self) -> oracles.Shape:
        return self.kind.support(*self.values.values())

    @property
    def lengths(self) -> list[float]:
        """Its values that are numbers."""
        return [float(x) for x in self.values.values() if np.ndim(x) == 0]

    @property
    def bounded(self) -> bool:
        return self.kind.name != "halfspace"

    @cached_property
    def sampled(self) -> Array:
        """Support values (k,) along `DIRECTIONS`, float64."""
        return self.support.heights(DIRECTIONS)


def _scale(rng: Rng) -> float:
    return float(np.exp(rng.uniform(np.log(SMALLEST), np.log(GREATEST))))


def _lengths(*names: str) -> Callable[[Rng], Values]:
    def draw(rng: Rng) -> Values:
        lengths = _scale(rng) * np.exp(rng.uniform(np.log(SHORTEST), np.log(LONGEST), len(names)))
        return dict(zip(names, map(float, lengths), strict=True))

    return draw


def _superellipsoid(low: float, high: float) -> Callable[[Rng], Values]:
    def draw(rng: Rng) -> Values:
        e1, e2 = rng.uniform(low, high, 2)
        return {**_lengths("a", "b", "c")(rng), "e1": float(e1), "e2": float(e2)}

    return draw


def _rounded_box(rng: Rng) -> Values:
    lengths = _lengths("x", "y", "z")(rng)
    return {**lengths, "rounding": float(rng.uniform(0.05, 0.4)) * min(lengths.values())}


def _cap(rng: Rng) -> Values:
    radius = _scale(rng)
    return {"radius": radius, "offset": radius * float(rng.uniform(-0.7, 0.6))}


def _lens(rng: Rng) -> Values:
    radius = _scale(rng)
    return {"radius": radius, "offset": radius * float(rng.uniform(0.2, 0.6))}


def _bow(length: str) -> Callable[[Rng], Values]:
    def draw(rng: Rng) -> Values:
        size = _scale(rng)
        return {"radius": 0.5 * size * float(rng.uniform(0.4, 0.9)), length: size}

    return draw


def _gore(rng: Rng) -> Values:
    return {**_bow("height")(rng), "patches": int(rng.integers(3, 7))}


def _egg(rng: Rng) -> Values:
    return {**_lengths("radius", "length")(rng), "taper": float(rng.uniform(0.1, 0.6))}


def _ring(rng: Rng) -> Values:
    drawn = _lengths("ring", "width", "height")(rng)
    # the profile does not touch the axis
    return {**drawn, "width": min(drawn["width"], 0.8 * drawn["ring"])}


def _polytope(rng: Rng) -> Values:
    points = _scale(rng) * rng.normal(size=(int(rng.integers(6, 16)), 3)) * 0.5
    return {"vertices": points[ConvexHull(points).vertices]}


def _tangential(rng: Rng) -> Values:
    """A polytope whose planes all touch one sphere, so that its core is a smaller copy of it."""
    while True:
        normals = oracles.unit(rng.normal(size=(int(rng.integers(8, 14)), 3)))
        planes = np.column_stack([normals, -np.ones(len(normals))])
        inside = ConvexHull(normals).equations[:, 3].max() < -0.2
        if inside:
            break
    spots = HalfspaceIntersection(planes, np.zeros(3)).intersections
    scale = 0.3 * _scale(rng)
    return {"vertices": scale * spots, "rounding": scale * float(rng.uniform(0.1, 0.6))}


def _rounded_support(vertices: Array, rounding: float) -> oracles.Shape:
    """The support function for `_tangential`: its core is exact, without solving for vertices."""
    facets = oracles.Polytope(vertices).facets
    nearest = zip(facets.long_normals, facets.corners, strict=True)
    inscribed = min(float(normal @ vertices[corners[0]]) for normal, corners in nearest)
    return oracles.Swept(oracles.Polytope((1 - rounding / inscribed) * vertices), rounding)


KINDS: tuple[Kind, ...] = (
    Kind("point", lambda rng: {}, flat=True),
    Kind("segment", _lengths("length"), flat=True),
    Kind("sphere", _lengths("r")),
    Kind("capsule", _lengths("r", "length")),
    Kind("ellipsoid", _lengths("a", "b", "c")),
    Kind(
        "NURBS ellipsoid",
        _lengths("a", "b", "c"),
        call="so.Body.from_patches(so.geometry.ellipsoid_patches({a!r}, {b!r}, {c!r}))",
    ),
    Kind("superellipsoid", _superellipsoid(0.4, 1.0)),
    Kind("creased superellipsoid", _superellipsoid(1.1, 1.6)),
    Kind("egg", _egg),
    Kind("cylinder", _lengths("r", "length")),
    Kind("cone", _lengths("r", "height")),
    Kind("cap", _cap),
    Kind("lens", _lens),
    Kind("spindle", _bow("length")),
    Kind("gore", _gore),
    Kind(
        "torus hull",
        _ring,
        call="so.shapes.hull_of_revolution(so.geometry.ConicArc("
        "[{ring!r}, 0.0, 0.0], [{width!r}, 0.0, 0.0], [0.0, 0.0, {height!r}]))",
    ),
    Kind("box", _lengths("x", "y", "z")),
    Kind("rounded box", _rounded_box),
    Kind("polytope", _polytope),
    Kind("rounded polytope", _tangential, judge=_rounded_support),
    Kind("halfspace", lambda rng: {}),
)
"""All kinds: those of ``so.shapes``, two of superellipsoids, and an ellipsoid of NURBS patches.
There is no planar loop, because it can only be paired with other planar bodies."""


def named(names: Sequence[str]) -> tuple[Kind, ...]:
    """Return the kinds of these names, in the order of `KINDS`; all if none is given.

    Raises
    ------
    ValueError
        A name that is not a kind.
    """
    known = [kind.name for kind in KINDS]
    for name in names:
        if name not in known:
            raise ValueError(f"no shape '{name}'; there are: {', '.join(known)}")
    return tuple(kind for kind in KINDS if not names or kind.name in names)


def draw_solids(kind: Kind, count: int, rng: Rng) -> tuple[Solid, ...]:
    """Return ``count`` solids of a kind; only one if the kind has no lengths."""
    if not kind.draw(np.random.default_rng(0)):
        return (Solid(kind, {}),)
    return tuple(Solid(kind, kind.draw(rng)) for _ in range(count))
