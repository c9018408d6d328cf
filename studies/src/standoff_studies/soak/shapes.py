"""Random shapes: plain parameters, from which the tested body and its support function are made."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np

from standoff.bodies.body import Body
from standoff.typing import Array
from standoff_studies import oracles
from standoff_studies.kinds import TWINS

Rng = np.random.Generator
Numbers = dict[str, Any]

ASPECT = 30.0
"""Greatest ratio of two lengths of one body."""

SIZES = 0.1, 10.0
"""Range of the greatest length of a body."""

FORMULA_LIBRARIES = "sympy", "flint"
"""Libraries that bodies given by formulas need."""

CREASED = 1.8
"""Greatest exponent of a superellipsoid."""


class Shape(NamedTuple):
    """A kind and its parameters, as in a failure's file."""

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
        No such kind, or parameters that the body's constructor rejects.
    """
    if shape.kind not in KINDS:
        raise ValueError(f"{shape.kind!r} is not a kind of shape; there are {', '.join(KINDS)}.")
    names = KINDS[shape.kind].draw(np.random.default_rng(0))
    if names.keys() != dict(shape.numbers).keys():
        raise ValueError(f"a {shape.kind} has {list(names)}, not {list(shape.numbers)}.")
    values = [shape.numbers[name] for name in names]
    if "axes" in names:
        values = [*values[0], *values[1:]]
    twin = TWINS[shape.kind]
    return Made(shape, twin.body(*values), twin.support(*values))


def draw_shape(rng: Rng) -> Shape:
    """Draw a kind by its weight, and its parameters."""
    names = list(KINDS)
    weights = np.array([KINDS[name].weight for name in names])
    name = names[int(rng.choice(len(names), p=weights / weights.sum()))]
    return Shape(name, KINDS[name].draw(rng))


def missing_library() -> str:
    """Return a library that formula bodies need and that is not installed; "" if none."""
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


class Kind(NamedTuple):
    """How often a kind is drawn, and how its parameters are, in the order of its `Twin`."""

    weight: float
    draw: Callable[[Rng], Numbers]


KINDS: Mapping[str, Kind] = {
    "point": Kind(1, lambda rng: {}),
    "segment": Kind(1, _one("length")),
    "sphere": Kind(2, _one("r")),
    "capsule": Kind(3, _two("r", "length")),
    "ellipsoid": Kind(6, _axes),
    "cylinder": Kind(5, _two("r", "length")),
    "cone": Kind(5, _two("r", "height")),
    "box": Kind(5, _axes),
    "rounded box": Kind(3, _rounded_box),
    "polytope": Kind(4, _polytope),
    "rounded polytope": Kind(1, _rounded_polytope),
    "lens": Kind(4, _lens),
    "cap": Kind(4, _cap),
    "halfspace": Kind(2, lambda rng: {}),
    "superellipsoid": Kind(3, _superellipsoid),
    "creased superellipsoid": Kind(1, _creased),
    "egg": Kind(2, _egg),
    "spindle": Kind(1.5, _spindle),
    "gore": Kind(1.5, _gore),
    "sewn ellipsoid": Kind(0.5, _axes),
    "formula power ball": Kind(0.4, _axes),
    "formula dome": Kind(0.4, _two("radius", "height")),
}
