"""Ready-made shapes, all from the same parts: ``so.shapes``.

Semi-axes for ellipsoids; full lengths for box, cylinder, capsule (its cylindrical part) and
cone; all centred, axis z. A cone's apex is at +height/2, its base at -height/2.
"""

from standoff.bodies.shapes.lenses import lens
from standoff.bodies.shapes.planar import planar_loop
from standoff.bodies.shapes.points_and_sweeps import capsule, point, segment, sphere
from standoff.bodies.shapes.polyhedra import box, polytope
from standoff.bodies.shapes.quadrics import (
    cap,
    cone,
    cylinder,
    ellipsoid,
    halfspace,
    sphere_atlas,
)
from standoff.bodies.shapes.superellipsoids import superellipsoid

__all__ = [
    "box",
    "cap",
    "capsule",
    "cone",
    "cylinder",
    "ellipsoid",
    "halfspace",
    "lens",
    "planar_loop",
    "point",
    "polytope",
    "segment",
    "sphere",
    "sphere_atlas",
    "superellipsoid",
]
