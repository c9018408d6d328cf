"""Files of finished boundaries, which need no package of CAD to be read.

JSON: its parts, and a checksum of them. Reading makes the boundary anew, with all its checks.
"""

from __future__ import annotations

import hashlib
import json
import os
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from standoff.bodies import Apex, Body, Boundary, Edge, Face
from standoff.bodies.assembly import joined_parts
from standoff.bodies.body import proven_again
from standoff.bodies.boundary import made_boundary
from standoff.bodies.report import BoundaryReport
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
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
from standoff.kernels.body import layout as L
from standoff.whole_files import file_name, write_whole

FORMAT, VERSION = "standoff boundary", 2
# Its files lack what parts were proven to miss each other by; of a boundary that is at most what
# they were allowed to, which its slack is then.
WITHOUT_RESIDUAL = 1


def save_boundary(path: str | os.PathLike[str], boundary: Boundary | Body) -> None:
    """Write a boundary, or a convex body, to a file; whole or not at all.

    Raises StandoffTypeError: neither a boundary nor a body. Raises StandoffError: a planar body,
    one without faces, or a part that is made of a formula. Raises OSError if the file cannot be
    written.

    Parameters
    ----------
    path : str or path
        New, or replaced.
    boundary : Boundary or Body
        Spatial, with faces. Lengths are written as they are.
    """
    target = file_name(path)
    if not isinstance(boundary, Boundary | Body):
        raise StandoffTypeError(
            f"boundary is {shown(boundary)}: give a Boundary or a Body.", "boundary", boundary
        )
    if boundary.dimension != 3 or not boundary.n_faces:
        raise StandoffError(f"{boundary!r} has no closed surface to be kept.", "boundary", boundary)
    facts = _facts(boundary)
    text = json.dumps(facts | {"sha256": _checksum(facts)}, allow_nan=False)
    write_whole({target: partial(_put, text.encode("utf-8"))})


def _checksum(facts: Facts) -> str:
    """Of all but itself: numbers are written so that they are read as the same."""
    rest = {key: value for key, value in facts.items() if key != "sha256"}
    return hashlib.sha256(json.dumps(rest, sort_keys=True).encode("utf-8")).hexdigest()


def _put(content: bytes, file: BinaryIO) -> None:
    file.write(content)


def _facts(boundary: Boundary | Body) -> Facts:
    return {
        "format": FORMAT,
        "version": VERSION,
        "name": boundary.name,
        "convex": isinstance(boundary, Body),
        "radius": boundary.radius,
        "sewing_tolerance": boundary.report.sewing_tolerance,
        "sewing_residual": boundary.report.sewing_residual,
        "vertices": boundary.vertex_points.tolist(),
        "edges": [_edge_facts(edge) for edge in boundary.edge_parts],
        "faces": [_face_facts(boundary, k) for k in range(boundary.n_faces)],
    }


def _edge_facts(edge: Edge) -> Facts:
    return {
        "curve": stored_curve(edge.curve),
        "vertices": [edge.first, edge.last],
        "smooth": edge.smooth,
        "creased": edge.creased,
    }


def _face_facts(boundary: Boundary | Body, number: int) -> Facts:
    face = boundary.face_parts[number]
    row = int(boundary.ints[L.FACES]) + L.FACE_STRIDE * number
    chart = int(boundary.ints[L.CHARTS]) + L.CHART_STRIDE * int(boundary.ints[row])
    outward = boundary.reals[int(boundary.ints[chart + L.CHART_REALS]) + L.OUTWARD]
    if number in _of_cavities(boundary):
        outward = -outward  # as a shell by itself
    return {
        "charts": [stored_surface(surface) for surface in face.charts],
        "loop": [list(entry) for entry in face.loop],
        "apexes": [[a.vertex, a.level, a.lo, a.hi, a.side] for a in face.apexes],
        "pcurves": [p if p is None else stored_pcurve(p) for p in face.pcurves],
        "sense": 1 if outward > 0.0 else -1,
    }


def _of_cavities(boundary: Boundary | Body) -> set[int]:
    """The faces of shells inside the outer one."""
    report = boundary.report
    if not isinstance(report, BoundaryReport):
        return set()
    return {face for k in report.cavities for face in report.shells[k]}


def open_boundary(path: str | os.PathLike[str]) -> Boundary | Body:
    """Read a boundary, or a convex body, that `save_boundary` wrote.

    It is made anew from its parts, with all checks and proofs of its making. What they were proven
    to miss each other by is kept; a file of version 1 lacks it, and a boundary's slack then is the
    tolerance within which its parts were joined.

    Raises StandoffError: not such a file, one of another version, a damaged one, or parts that no
    longer close. Raises OSError if the file cannot be read.

    Parameters
    ----------
    path : str or path

    Returns
    -------
    Boundary or Body
    """
    file = Path(path)
    try:
        facts = json.loads(file.read_text("utf-8"))
    except ValueError as error:
        raise StandoffError(f"{file}: not a boundary's file, or damaged: {error}") from error
    if not isinstance(facts, dict) or facts.get("format") != FORMAT:
        raise StandoffError(f"{file}: not a boundary's file.")
    if facts.get("version") not in (VERSION, WITHOUT_RESIDUAL):
        found = shown(facts.get("version"))
        raise StandoffError(
            f"{file}: version {found}; this Standoff reads versions 1 to {VERSION}."
        )
    if facts.get("sha256") != _checksum(facts):
        raise StandoffError(f"{file}: damaged, or changed by hand: its checksum is another one.")
    try:
        return _made(facts)
    except StandoffError as error:
        raise StandoffError(f"{file}: {error}") from error
    except (LookupError, TypeError, ValueError) as error:
        raise StandoffError(f"{file}: damaged, {type(error).__name__}: {error}") from error


def _made(facts: Facts) -> Boundary | Body:
    vertices = np.array(facts["vertices"], dtype=np.float64).reshape(-1, 3)
    edges = [
        Edge(made_curve(one["curve"]), first, last, one["smooth"], one["creased"])
        for one in facts["edges"]
        for first, last in [one["vertices"]]
    ]
    faces = [_made_face(one) for one in facts["faces"]]
    name, tolerance = str(facts["name"]), float(facts["sewing_tolerance"])
    old = facts["version"] == WITHOUT_RESIDUAL
    if facts["convex"]:
        residual = 0.0 if old else float(facts["sewing_residual"])
        radius = float(facts["radius"])
        return proven_again((vertices, edges, faces), name, radius, tolerance, residual)
    senses = [one["sense"] for one in facts["faces"]]
    joined = joined_parts(vertices, edges, faces, tolerance, closed=True, senses=senses)
    residual = max(joined.residual, tolerance if old else float(facts["sewing_residual"]))
    # what was finished once has no two solids: a shell inside the outer one is a cavity
    claims = [0] * len(joined.shells)
    return made_boundary(name, replace(joined, residual=residual, claims=claims))


def _made_face(facts: Facts) -> Face:
    return Face(
        tuple(made_surface(one) for one in facts["charts"]),
        tuple((int(edge), int(sense)) for edge, sense in facts["loop"]),
        tuple(Apex(*one) for one in facts["apexes"]),
        tuple(p if p is None else made_pcurve(p) for p in facts["pcurves"]),
    )


# Surfaces, curves and trimming curves as plain data, and made again from it.
#
# What is made passes the checks of its class. Numbers are kept to the last bit, but for weighted
# control points of curves that only have them multiplied: these are within a rounding.

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
