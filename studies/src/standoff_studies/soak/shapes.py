"""Random shapes: plain parameters, from which come the body that is tested and its judge."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies import shapes
from standoff.bodies.body import Body
from standoff.geometry import FormulaSurface, ellipsoid_patches
from standoff_studies import oracles

Array = NDArray[np.float64]
Rng = np.random.Generator
Numbers = dict[str, Any]

ASPECT = 30.0
"""Greatest ratio of two lengths of one body."""

SIZES = 0.1, 10.0
"""Greatest length of a body: between these."""

FORMULA_LIBRARIES = "sympy", "flint"
"""What bodies by formulas need."""

CREASED = 1.8
"""Greatest exponent of a superellipsoid."""


class Shape(NamedTuple):
    """A kind and its parameters, as a failure's file keeps them."""

    kind: str
    numbers: Numbers


class Made(NamedTuple):
    """A shape with its body and its support function."""

    shape: Shape
    body: Body
    support: oracles.Shape


def made(shape: Shape) -> Made:
    """Return a shape's body and support function.

    Raises
    ------
    ValueError
        No such kind, or what the body's constructor refuses.
    """
    if shape.kind not in KINDS:
        raise ValueError(f"{shape.kind!r} is not a kind of shape; there are {', '.join(KINDS)}.")
    return Made(shape, *KINDS[shape.kind].make(**shape.numbers))


def draw_shape(rng: Rng) -> Shape:
    """Draw a kind by its weight, and its parameters."""
    names = list(KINDS)
    weights = np.array([KINDS[name].weight for name in names])
    name = names[int(rng.choice(len(names), p=weights / weights.sum()))]
    return Shape(name, KINDS[name].draw(rng))


def missing_library() -> str:
    """Return the library that formula bodies need and that is not installed; "" if none."""
    try:
        for name in FORMULA_LIBRARIES:
            import_module(name)
    except ModuleNotFoundError as error:
        return str(error.name)
    return ""


def _lengths(rng: Rng, count: int) -> list[float]:
    """Lengths within ASPECT of each other, the greatest within SIZES, in any order."""
    parts = np.exp(rng.uniform(0.0, rng.uniform(0.0, np.log(ASPECT)), count))
    size = float(np.exp(rng.uniform(*np.log(SIZES))))
    return [float(x) for x in parts * (size / parts.max())]


def _axes(rng: Rng) -> Numbers:
    return {"axes": _lengths(rng, 3)}


def _one(name: str) -> Callable[[Rng], Numbers]:
    return lambda rng: {name: _lengths(rng, 1)[0]}


def _two(*names: str) -> Callable[[Rng], Numbers]:
    return lambda rng: dict(zip(names, _lengths(rng, 2), strict=True))


def _rounded_box(rng: Rng) -> Numbers:
    axes = _lengths(rng, 3)
    return {"axes": axes, "rounding": float(min(axes) * 0.5 * rng.uniform(0.01, 0.95))}


def _vertices(rng: Rng) -> Array:
    """Four to sixteen points near an ellipsoid, some cut to coordinate planes."""
    points = rng.normal(size=(int(rng.integers(4, 17)), 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    points *= rng.uniform(0.6, 1.0, (len(points), 1))
    return np.asarray(points * _lengths(rng, 3))


def _polytope(rng: Rng) -> Numbers:
    return {"vertices": _vertices(rng).tolist()}


def _rounded_polytope(rng: Rng) -> Numbers:
    vertices = _vertices(rng)
    inward = -oracles.Polytope(vertices).outside(vertices.mean(axis=0)[None])[0]
    return {
        "vertices": vertices.tolist(),
        "rounding": float(inward * rng.uniform(0.02, 0.8)),
    }


def _lens(rng: Rng) -> Numbers:
    (radius,) = _lengths(rng, 1)
    return {"radius": radius, "offset": float(radius * rng.uniform(0.02, 0.97))}


def _cap(rng: Rng) -> Numbers:
    (radius,) = _lengths(rng, 1)
    return {"radius": radius, "offset": float(radius * rng.uniform(-0.95, 0.95))}


def _superellipsoid(rng: Rng) -> Numbers:
    e1, e2 = (float(e) for e in rng.uniform(0.15, 1.0, 2))
    return {"axes": _lengths(rng, 3), "e1": e1, "e2": e2}


def _creased(rng: Rng) -> Numbers:
    e1, e2 = (
        float(e) for e in rng.permutation([rng.uniform(1.01, CREASED), rng.uniform(0.3, 1.6)])
    )
    return {"axes": _lengths(rng, 3), "e1": e1, "e2": e2}


def _egg(rng: Rng) -> Numbers:
    return _two("radius", "length")(rng) | {"taper": float(rng.uniform(-0.65, 0.65))}


def _bow(rng: Rng) -> tuple[float, float]:
    (length,) = _lengths(rng, 1)
    return float(length * 0.5 * rng.uniform(1.0 / ASPECT, 0.95)), length


def _spindle(rng: Rng) -> Numbers:
    return dict(zip(("radius", "length"), _bow(rng), strict=True))


def _gore(rng: Rng) -> Numbers:
    sides = int(rng.integers(3, 8))
    return dict(zip(("radius", "height"), _bow(rng), strict=True)) | {"sides": sides}


def _made_polytope(vertices: Any) -> tuple[Body, oracles.Shape]:
    return shapes.polytope(vertices), oracles.Polytope(vertices)


def _made_rounded_polytope(vertices: Any, rounding: float) -> tuple[Body, oracles.Shape]:
    return (
        shapes.rounded_polytope(vertices, rounding),
        oracles.RoundedPolytope(vertices, rounding),
    )


@lru_cache(maxsize=1)
def _sewn_ball() -> Body:
    return Body.from_patches(ellipsoid_patches(1.0, 1.0, 1.0))


def _sewn_ellipsoid(axes: Any) -> tuple[Body, oracles.Shape]:
    """Six rational patches of degree (4, 4), stretched."""
    return _sewn_ball().transformed(np.diag(axes)), oracles.Ellipsoid(*axes)


@lru_cache(maxsize=1)
def _formula_power_ball() -> Body:
    cube = [np.roll([f"{sign}1", "u", "v"], k) for k in range(3) for sign in ("", "-")]
    patches = []
    for side in cube:
        x, y, z = (f"({n})*(1 + u**4 + v**4)**(-1/4)" for n in side)
        patches.append(FormulaSurface(x, y, z, (-1, 1, -1, 1)))
    return Body.from_patches(patches)


def _power_ball(axes: Any) -> tuple[Body, oracles.Shape]:
    """|x/a|^4 + |y/b|^4 + |z/c|^4 <= 1, six patches by formulas."""
    a, b, c = axes
    body = _formula_power_ball().transformed(np.diag(axes))
    return body, oracles.Superellipsoid(a, b, c, 0.5, 0.5)


@lru_cache(maxsize=1)
def _formula_dome() -> Body:
    sectors = [(2 * np.pi * j / 3, 2 * np.pi * (j + 1) / 3, 0, 1) for j in range(3)]
    return Body.from_patches(
        [
            FormulaSurface("v*cos(u)", "v*sin(u)", z, sector)
            for sector in sectors
            for z in ("1 - v**2", "0")
        ]
    )


def _dome(radius: float, height: float) -> tuple[Body, oracles.Shape]:
    """A paraboloid on a disc, six patches by formulas."""
    body = _formula_dome().transformed(np.diag([radius, radius, height]))
    return body, oracles.Dome(radius, height)


def _made_box(axes: Any, rounding: float = 0.0) -> tuple[Body, oracles.Shape]:
    x, y, z = axes
    body = shapes.box(x, y, z, rounding=rounding)
    return body, oracles.Box(x, y, z, rounding) if rounding > 0.0 else oracles.SharpBox(x, y, z)


def _made_ellipsoid(axes: Any) -> tuple[Body, oracles.Shape]:
    return shapes.ellipsoid(*axes), oracles.Ellipsoid(*axes)


def _made_superellipsoid(axes: Any, e1: float, e2: float) -> tuple[Body, oracles.Shape]:
    x, y, z = axes
    return shapes.superellipsoid(x, y, z, e1, e2), oracles.Superellipsoid(x, y, z, e1, e2)


def _made_gore(radius: float, height: float, sides: int) -> tuple[Body, oracles.Shape]:
    return shapes.gore(radius, height, sides), oracles.Gore(radius, height, sides)


def _made_segment(length: float) -> tuple[Body, oracles.Shape]:
    return shapes.segment(length), oracles.Segment(length)


def _made_sphere(r: float) -> tuple[Body, oracles.Shape]:
    return shapes.sphere(r), oracles.Sphere(r)


def _made_capsule(r: float, length: float) -> tuple[Body, oracles.Shape]:
    return shapes.capsule(r, length), oracles.Capsule(r, length)


def _both(
    body: Callable[..., Body], support: Callable[..., oracles.Shape]
) -> Callable[..., tuple[Body, oracles.Shape]]:
    """Both take the same parameters."""
    return lambda **numbers: (
        body(*numbers.values()),
        support(**{_OWN.get(k, k): v for k, v in numbers.items()}),
    )


_OWN = {"r": "radius"}
"""Parameters that the supports call by another name."""


class Kind(NamedTuple):
    """How often a kind comes, how its parameters are drawn, and what is made of them."""

    weight: float
    draw: Callable[[Rng], Numbers]
    make: Callable[..., tuple[Body, oracles.Shape]]


KINDS: Mapping[str, Kind] = {
    "point": Kind(1, lambda rng: {}, lambda: (shapes.point(), oracles.Point())),
    "segment": Kind(1, _one("length"), _made_segment),
    "sphere": Kind(2, _one("r"), _made_sphere),
    "capsule": Kind(3, _two("r", "length"), _made_capsule),
    "ellipsoid": Kind(6, _axes, _made_ellipsoid),
    "cylinder": Kind(5, _two("r", "length"), _both(shapes.cylinder, oracles.Cylinder)),
    "cone": Kind(5, _two("r", "height"), _both(shapes.cone, oracles.Cone)),
    "box": Kind(5, _axes, _made_box),
    "rounded box": Kind(3, _rounded_box, _made_box),
    "polytope": Kind(4, _polytope, _made_polytope),
    "rounded polytope": Kind(1, _rounded_polytope, _made_rounded_polytope),
    "lens": Kind(4, _lens, _both(shapes.lens, oracles.Lens)),
    "cap": Kind(4, _cap, _both(shapes.cap, oracles.Cap)),
    "halfspace": Kind(2, lambda rng: {}, _both(shapes.halfspace, oracles.HalfSpace)),
    "superellipsoid": Kind(3, _superellipsoid, _made_superellipsoid),
    "creased superellipsoid": Kind(1, _creased, _made_superellipsoid),
    "egg": Kind(2, _egg, _both(shapes.egg, oracles.Egg)),
    "spindle": Kind(1.5, _spindle, _both(shapes.spindle, oracles.Spindle)),
    "gore": Kind(1.5, _gore, _made_gore),
    "sewn ellipsoid": Kind(0.5, _axes, _sewn_ellipsoid),
    "formula power ball": Kind(0.4, _axes, _power_ball),
    "formula dome": Kind(0.4, _two("radius", "height"), _dome),
}
