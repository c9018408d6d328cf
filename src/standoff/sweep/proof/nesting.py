"""Which numbers of a shape nest its bodies: of two bodies that differ in it, one holds the other.

A cell of such a number is then proven by its largest body alone, and violated by its smallest. All
of these are exact, whatever the shape's other numbers are, and hold of images under an `affine` or
`scale` of the scene as well:

- Sums with a larger ball: radii of spheres and capsules, `rounding`; a segment in a longer one.
- The map that stretches an axis takes a body into a larger one where the body holds, with each
  point, its foot on the plane across that axis: semi-axes, sizes, lengths and heights of bodies
  that are the same on both sides of the plane. Likewise radii that stretch sections about the axis:
  of cylinders, cones, gores and eggs.
- Intersections of larger balls, `radius` of lens and cap; a lens's balls with their centres farther
  out hold less, since the nearer centre is within the triangle of the farther ones.
- Arcs through the same poles with more bulge, and of the same bulge with poles farther apart, lie
  farther out: spindle and gore.
- Of a superellipsoid the exponents 2/e are those of norms, which fall as these grow.
- A box or polytope that keeps its size is a union of balls; that of larger ones holds less.
- `scale` of a body that holds its origin.

A cone's `height` moves its base, an egg's `length` and `taper` its widest place: they do not nest.
"""

from __future__ import annotations

from collections.abc import Mapping

from standoff.scene.shapes import SAME_SIZE

AXES = ("semi_axes.1", "semi_axes.2", "semi_axes.3")
SIZES = ("size.1", "size.2", "size.3")

GROWS, SHRINKS = 1.0, -1.0

OWN: Mapping[str, Mapping[str, float]] = {
    "point": {},
    "segment": {"length": GROWS},
    "sphere": {"radius": GROWS},
    "ellipsoid": dict.fromkeys(AXES, GROWS),
    "capsule": dict.fromkeys(("radius", "length"), GROWS),
    "cylinder": dict.fromkeys(("radius", "height"), GROWS),
    "cone": {"radius": GROWS},
    "box": dict.fromkeys(SIZES, GROWS),
    "lens": {"radius": GROWS, "offset": SHRINKS},
    "cap": {"radius": GROWS, "offset": SHRINKS},
    "halfspace": {"offset": GROWS},
    "spindle": dict.fromkeys(("radius", "length"), GROWS),
    "gore": dict.fromkeys(("radius", "height"), GROWS),
    "egg": {"radius": GROWS},
    "superellipsoid": {
        **dict.fromkeys(AXES, GROWS),
        **dict.fromkeys(("exponents.1", "exponents.2"), SHRINKS),
    },
}
"""By shape and number: does the body of a greater number hold that of a lesser one, or the other
way round? What is not here does not nest; `sense_of` adds `rounding` and `scale`."""

OFF_ORIGIN = ("segment", "cap", "halfspace")
"""Shapes of which not all hold their origin."""


def sense_of(shape: str, what: str) -> float | None:
    """Return `GROWS`, `SHRINKS`, or None where bodies do not nest.

    Parameters
    ----------
    shape : str
        As a scene names it.
    what : str
        As a parameter names the number.
    """
    if what == "rounding":
        return SHRINKS if shape in SAME_SIZE else GROWS
    if what == "scale":
        return GROWS if shape in OWN and shape not in OFF_ORIGIN else None
    return OWN.get(shape, {}).get(what)
