"""The oracles' shapes of the accuracy report's kinds, made from the same arguments."""

from oracles import support as oracle
from oracles.between_poles import Gore, Spindle
from oracles.revolved import Egg
from oracles.rounded_polytopes import RoundedPolytope
from oracles.superellipsoids import Superellipsoid

TWINS = {
    "point": oracle.Point,
    "segment": oracle.Segment,
    "sphere": oracle.Sphere,
    "capsule": oracle.Capsule,
    "ellipsoid": oracle.Ellipsoid,
    "NURBS ellipsoid": oracle.Ellipsoid,
    "superellipsoid": Superellipsoid,
    "creased superellipsoid": Superellipsoid,
    "egg": Egg,
    "cylinder": oracle.Cylinder,
    "cone": oracle.Cone,
    "cap": oracle.Cap,
    "lens": oracle.Lens,
    "spindle": Spindle,
    "gore": Gore,
    "box": oracle.Box,
    "rounded box": oracle.Box,
    "polytope": oracle.Polytope,
    "rounded polytope": RoundedPolytope,
}
