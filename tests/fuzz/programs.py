"""Geometry written as data: a table with ``make`` is a call, its other keys the arguments.

``{"make": "shapes.box", "size": [1.0, 2.0, NaN]}``; arguments may be such tables themselves.
So an input that once failed is a small file that anyone can read.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import standoff as so
from standoff import geometry as g
from standoff import motion as m


class BadProgram(Exception):
    """No call of the library: a mutation that destroyed the table itself."""


def _face(charts: Any, loop: Any = (), apexes: Any = ()) -> Any:
    entries = tuple(map(_tuple, loop)) if isinstance(loop, list) else loop
    return so.bodies.Face(_tuple(charts), entries, _tuple(apexes))


def _tuple(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def _transformed(body: Any, affine: Any) -> Any:
    return body.transformed(affine)


def _restricted(surface: Any, u0: Any, u1: Any, v0: Any, v1: Any) -> Any:
    return surface.restricted(u0, u1, v0, v1)


CALLS: dict[str, Callable[..., Any]] = {
    **{f"shapes.{name}": getattr(so.shapes, name) for name in so.shapes.__all__},
    **{
        kind.__name__: kind
        for kind in (
            *(g.Line, g.ConicArc, g.RationalBezier, g.NurbsCurve, g.FormulaCurve),
            *(g.Plane, g.Sphere, g.Cylinder, g.Cone, g.Torus, g.NurbsSurface, g.BezierPatch),
            *(g.Revolution, g.Extrusion, g.SuperellipsoidPole, g.FormulaSurface),
            *(g.SurfaceCurve, g.NurbsPcurve, g.pcurve_of),
            *(m.Pose, m.Twist, m.Fixed, m.ConstantTwist, m.Screw, m.Helix, m.Spiral),
            *(m.Offset, m.Carried, m.PoseSamples, so.bodies.Edge, so.bodies.Apex),
        )
    },
    "Plane.through": g.Plane.through,
    "Pose.from_wxyz": m.Pose.from_wxyz,
    "Pose.from_xyzw": m.Pose.from_xyzw,
    "Pose.exp": m.Pose.exp,
    "ellipsoid_patches": g.ellipsoid_patches,
    "ellipsoid_octants": g.ellipsoid_octants,
    "Face": _face,
    "Body.from_brep": so.Body.from_brep,
    "Body.from_patches": so.Body.from_patches,
    "transformed": _transformed,
    "restricted": _restricted,
}
"""Every constructor that a program may call."""


def make(tree: Any) -> Any:
    """Return what a program makes.

    Raises
    ------
    BadProgram
        An unknown name, or a call without what Python itself wants: `TypeError` of the call, not
        of the library.
    """
    if isinstance(tree, list):
        return [make(item) for item in tree]
    if not isinstance(tree, dict):
        return tree
    if "make" not in tree:
        return {key: make(value) for key, value in tree.items()}
    name = tree["make"]
    if not isinstance(name, str) or name not in CALLS:
        raise BadProgram(f"no call {name!r}")
    arguments = {key: make(value) for key, value in tree.items() if key != "make"}
    if name == "transformed" and not isinstance(arguments.get("body"), so.Body):
        raise BadProgram("nothing to transform")
    if name == "restricted" and not isinstance(arguments.get("surface"), g.Surface):
        raise BadProgram("nothing to restrict")
    try:
        return CALLS[name](**arguments)
    except TypeError as error:
        if "argument" in str(error) and error.__traceback__ and not error.__traceback__.tb_next:
            raise BadProgram(str(error)) from error
        raise
