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
from typing import BinaryIO

import numpy as np

from standoff.bodies import Apex, Body, Boundary, Edge, Face
from standoff.bodies.assembly import joined_parts
from standoff.bodies.body import proven_again
from standoff.bodies.boundary import made_boundary
from standoff.bodies.report import BoundaryReport
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.kernels.body import layout as L
from standoff.solids.stored_parts import (
    Facts,
    made_curve,
    made_pcurve,
    made_surface,
    stored_curve,
    stored_pcurve,
    stored_surface,
)
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
