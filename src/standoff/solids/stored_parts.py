"""Surfaces, curves and trimming curves as plain data, and made again from it.

What is made passes the checks of its class. Numbers are kept to the last bit, but for weighted
control points of curves that only have them multiplied: these are within a rounding.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError
from standoff.geometry import (
    Cone,
    ConicArc,
    Cylinder,
    Extrusion,
    Line,
    NurbsCurve,
    NurbsPcurve,
    NurbsSurface,
    Plane,
    RationalBezier,
    Revolution,
    Sphere,
    SuperellipsoidPole,
    SuperellipsoidSide,
    Torus,
)
from standoff.geometry.curves import Curve
from standoff.geometry.pcurves import Pcurve
from standoff.geometry.surface_curves import SurfaceCurve
from standoff.geometry.surfaces import Surface

Facts = dict[str, Any]

BY_MAP = {kind.__name__: kind for kind in (Plane, Sphere, Cylinder, Cone)}
BY_EXPONENTS = {kind.__name__: kind for kind in (SuperellipsoidPole, SuperellipsoidSide)}


def stored_surface(surface: Surface) -> Facts:
    """Return a surface as plain data.

    Raises StandoffError: a surface made of a formula, or of a kind of the user's own.
    """
    name = type(surface).__name__
    placed = {"linear": surface.linear.tolist(), "shift": surface.shift.tolist()}
    # JSON has no infinity: null where the surface does not end
    domain = [x if np.isfinite(x) else None for x in surface.domain]
    placed |= {"kind": name, "domain": domain}
    if name in BY_MAP:
        return placed
    if isinstance(surface, SuperellipsoidPole):
        return placed | {"e1": surface.e1, "e2": surface.e2}
    if isinstance(surface, Torus):
        return placed | {"major": surface.major, "minor": surface.minor}
    if isinstance(surface, Revolution):
        return placed | {"profile": stored_curve(surface.profile)}
    if isinstance(surface, Extrusion):
        along = {"direction": surface.direction.tolist()}
        return placed | along | {"profile": stored_curve(surface.profile)}
    if isinstance(surface, NurbsSurface):
        return {
            "kind": "NurbsSurface",
            "control_points": surface.control_points.tolist(),
            "weights": surface.weights.tolist(),
            "knots_u": surface.vector_u.knots.tolist(),
            "knots_v": surface.vector_v.knots.tolist(),
            "domain": list(surface.domain),
        }
    raise _no_kind(name)


def made_surface(facts: Facts) -> Surface:
    """Make a surface again.

    Raises StandoffError: an unknown kind, or numbers that its class refuses.
    """
    kind = facts["kind"]
    if kind == "NurbsSurface":
        arrays = [facts[key] for key in ("control_points", "knots_u", "knots_v", "weights")]
        return NurbsSurface(*arrays).restricted(*facts["domain"])
    linear, shift = facts["linear"], facts["shift"]
    without_end = (-np.inf, np.inf, -np.inf, np.inf)
    u0, u1, v0, v1 = (
        end if x is None else x for x, end in zip(facts["domain"], without_end, strict=True)
    )
    domain = u0, u1, v0, v1
    if kind in BY_MAP:
        return BY_MAP[kind](linear, shift, domain)
    if kind in BY_EXPONENTS:
        return BY_EXPONENTS[kind](linear, shift, domain, facts["e1"], facts["e2"])
    made: Torus | Revolution | Extrusion
    if kind == "Torus":
        made = Torus(facts["major"], facts["minor"], *domain)
    elif kind == "Revolution":
        made = Revolution(made_curve(facts["profile"]), *domain[:2]).restricted(*domain)
    elif kind == "Extrusion":
        profile = made_curve(facts["profile"])
        made = Extrusion(profile, facts["direction"], *domain[2:]).restricted(*domain)
    else:
        raise _unknown(kind)
    return made.transformed(linear, shift)


def stored_curve(curve: Curve) -> Facts:
    """Return a curve as plain data; raises as `stored_surface` does."""
    if isinstance(curve, Line | ConicArc):
        basis = curve.basis().tolist()
        return {"kind": type(curve).__name__, "basis": basis, "range": [curve.first, curve.last]}
    if isinstance(curve, RationalBezier):
        return {"kind": "RationalBezier", "points": curve.data[1:].reshape(-1, 4).tolist()}
    if isinstance(curve, NurbsCurve):
        return {
            "kind": "NurbsCurve",
            "control_points": curve.control_points.tolist(),
            "weights": curve.weights.tolist(),
            "knots": curve.knots.tolist(),
        }
    if isinstance(curve, SurfaceCurve):
        charts = [(curve.surface, curve.pcurve), *curve.others]
        return {
            "kind": "SurfaceCurve",
            "charts": [[stored_surface(s), stored_pcurve(p)] for s, p in charts],
            "range": [curve.first, curve.last],
        }
    raise _no_kind(type(curve).__name__)


def made_curve(facts: Facts) -> Curve:
    """Make a curve again; raises as `made_surface` does."""
    kind = facts["kind"]
    if kind == "Line":
        along, _, start = np.transpose(facts["basis"])
        # the map itself is kept: an end less a start may have lost a digit
        line = Line(np.zeros(3), along)
        return line.transformed(np.eye(3), start)
    if kind == "ConicArc":
        a, b, centre = np.transpose(facts["basis"])
        return ConicArc(centre, a, b, *facts["range"])
    if kind == "RationalBezier":
        rows = np.array(facts["points"], dtype=np.float64)
        return RationalBezier(rows[:, :3] / rows[:, 3:], rows[:, 3])
    if kind == "NurbsCurve":
        return NurbsCurve(facts["control_points"], facts["knots"], facts["weights"])
    if kind == "SurfaceCurve":
        charts = [(made_surface(s), made_pcurve(p)) for s, p in facts["charts"]]
        first, last = facts["range"]
        (surface, pcurve), *others = charts
        return SurfaceCurve(surface, pcurve, first, last, others)
    raise _unknown(kind)


def stored_pcurve(pcurve: Pcurve) -> Facts:
    """Return a trimming curve as plain data."""
    if isinstance(pcurve, NurbsPcurve):
        knots = pcurve.knots.tolist()
        return {"kind": "NurbsPcurve", "points": pcurve.matrix.tolist(), "knots": knots}
    return {"kind": "Pcurve", "number": pcurve.kind, "matrix": pcurve.matrix.tolist()}


def made_pcurve(facts: Facts) -> Pcurve:
    """Make a trimming curve again; raises as `made_surface` does."""
    if facts["kind"] == "Pcurve":
        return Pcurve(facts["number"], facts["matrix"])
    if facts["kind"] == "NurbsPcurve":
        rows = np.array(facts["points"], dtype=np.float64)
        return NurbsPcurve(rows[:, :2] / rows[:, 2:], facts["knots"], rows[:, 2])
    raise _unknown(facts["kind"])


def _no_kind(name: str) -> StandoffError:
    return StandoffError(
        f"A {name} can't be kept in a file: its machine code lives in this process. Make it of "
        "NURBS, revolved or extruded surfaces whose curves are not formulas."
    )


def _unknown(kind: object) -> StandoffError:
    return StandoffError(f"Unknown kind {shown(kind)}: the file is of another version or damaged.")
