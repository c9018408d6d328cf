"""Ready-made shapes: ``so.shapes``.

Ellipsoids are given by semi-axes; box, cylinder, capsule (its cylindrical part) and cone by full
lengths. All are centred, with the axis z. A cone's apex is at +height/2, its base at -height/2.
`rounding` is the radius of a ball swept over a shape, which makes it larger; only `box` and
`rounded_polytope` keep their size.
"""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.bodies.shapes.between_poles import gore, spindle
    from standoff.bodies.shapes.eggs import egg
    from standoff.bodies.shapes.lenses import lens
    from standoff.bodies.shapes.planar import planar_loop
    from standoff.bodies.shapes.points_and_sweeps import capsule, point, segment, sphere
    from standoff.bodies.shapes.polygons import polygon
    from standoff.bodies.shapes.polyhedra import box, polytope, rounded_polytope
    from standoff.bodies.shapes.quadrics import (
        cap,
        cone,
        cylinder,
        ellipsoid,
        halfspace,
    )
    from standoff.bodies.shapes.revolved import hull_of_revolution
    from standoff.bodies.shapes.superellipsoids import superellipsoid
    from standoff.geometry.quadrics import sphere_atlas
else:
    __getattr__, __dir__ = on_demand(__name__)

__all__ = [
    "box",
    "cap",
    "capsule",
    "cone",
    "cylinder",
    "egg",
    "ellipsoid",
    "gore",
    "halfspace",
    "hull_of_revolution",
    "lens",
    "planar_loop",
    "point",
    "polygon",
    "polytope",
    "rounded_polytope",
    "segment",
    "sphere",
    "sphere_atlas",
    "spindle",
    "superellipsoid",
]
