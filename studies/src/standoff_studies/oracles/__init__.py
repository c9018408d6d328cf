"""Ground truth: support functions of convex shapes in closed form, independent of the library.

Nothing here imports ``standoff``: these shapes check it. Only NumPy and SciPy are used, and mpmath
in `optima`. The tests, the soak and the accuracy by pair of shapes use them. All shapes are
centred, with the axis z, and have the same lengths as in ``so.shapes``.
"""

from standoff_studies.oracles.between_poles import Gore, Spindle
from standoff_studies.oracles.ellipsoids import Ellipsoid, Superellipsoid
from standoff_studies.oracles.flats import Flat
from standoff_studies.oracles.lens import Lens
from standoff_studies.oracles.polytopes import (
    HalfSpace,
    Point,
    Polytope,
    Segment,
    SharpBox,
    Vertices,
)
from standoff_studies.oracles.revolved import Cap, Cone, Cylinder, Dome, Egg, RingHull
from standoff_studies.oracles.shape import (
    Affine,
    Array,
    Placed,
    Region,
    Shape,
    directions,
    dot,
    extended,
    lengths,
    unit,
)
from standoff_studies.oracles.swept import Box, Capsule, RoundedPolytope, Sphere, Swept

__all__ = [
    "Affine",
    "Array",
    "Box",
    "Cap",
    "Capsule",
    "Cone",
    "Cylinder",
    "Dome",
    "Egg",
    "Ellipsoid",
    "Flat",
    "Gore",
    "HalfSpace",
    "Lens",
    "Placed",
    "Point",
    "Polytope",
    "Region",
    "RingHull",
    "RoundedPolytope",
    "Segment",
    "Shape",
    "SharpBox",
    "Sphere",
    "Spindle",
    "Superellipsoid",
    "Swept",
    "Vertices",
    "directions",
    "dot",
    "extended",
    "lengths",
    "unit",
]
