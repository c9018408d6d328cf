"""Planar solids from DXF drawings, by ezdxf."""

from __future__ import annotations

import math
from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from standoff.checks.numbers import positive
from standoff.errors import BodyError, StandoffError, not_installed
from standoff.geometry.curves import ConicArc, Curve, Line
from standoff.geometry.nurbs_curves import NurbsCurve
from standoff.solids.planar.loops import ends_of, size_of
from standoff.solids.planar.solid import PlanarSolid, solids_of
from standoff.solids.planar.tolerances import JOINED

Array = NDArray[np.float64]
NO_GEOMETRY = frozenset(
    {"ATTDEF", "ATTRIB", "DIMENSION", "HATCH", "LEADER", "MTEXT", "MULTILEADER", "POINT", "TEXT"}
    | {"VIEWPORT", "IMAGE", "WIPEOUT", "TABLE", "TOLERANCE", "XLINE", "RAY"}
)
"""Kinds of entities that say something about a drawing, and bound nothing."""


def read_dxf(
    path: str | PathLike[str],
    *,
    layer: str | None = None,
    scale: float = 1.0,
    join: float | None = None,
) -> tuple[PlanarSolid, ...]:
    """The solids that the closed curves of a DXF drawing bound.

    Lines, arcs, circles, ellipses, splines and polylines (with bulges) of the model space, those
    of inserted blocks too. They are exact. Curves that meet end to end make a loop, in whatever
    order they are given; loops inside others are holes. Texts, dimensions and hatches are left out.

    Parameters
    ----------
    path : path
    layer : str, optional
        Take the entities of this layer alone.
    scale : float, optional
        Length of one unit of the drawing; for instance 1e-3 for a drawing in mm.
    join : float, optional
        By how much ends that meet may miss each other, length; 1e-9 of the drawing's size by
        default. What they miss is the solids' `slack`.

    Returns
    -------
    tuple of PlanarSolid
        In the order of the drawing; their names are the file's, with a number from the second on.

    Raises
    ------
    ImportError
        ezdxf is not installed: it comes with the extra `dxf`.
    FileNotFoundError
        There is no such file.
    StandoffError
        A file that is no DXF, or cut off.
    BodyError
        Nothing that bounds an area, curves that are open, doubled, cross each other, or out of
        z = 0. The text has the place.
    """
    unit = positive(scale, "scale")
    limit = None if join is None else positive(join, "join")
    file = Path(path)
    curves = [
        curve.transformed(unit * np.eye(3), np.zeros(3)) if unit != 1.0 else curve
        for entity in _entities(_document(file), layer)
        for curve in _curves(entity)
    ]
    if not curves:
        where = f" on the layer {layer!r}" if layer is not None else ""
        raise BodyError(f"{file.name} has no lines or curves{where}.", "path", path)
    loops = chained(curves, JOINED * size_of(curves) if limit is None else limit)
    return solids_of(loops, name=file.stem, join=limit)


def _document(file: Path) -> Any:
    try:
        from ezdxf.filemanagement import readfile
        from ezdxf.lldxf.const import DXFError
    except ImportError as error:
        raise ImportError(not_installed("ezdxf", "dxf")) from error
    if not file.exists():
        raise FileNotFoundError(f"There is no file {file}.")
    try:
        return readfile(file)
    except (OSError, UnicodeDecodeError, DXFError, ValueError, IndexError) as error:
        raise StandoffError(
            f"{file.name} is no DXF drawing, or it is cut off: {error}", "path", file
        ) from error


def _entities(document: Any, layer: str | None) -> Iterator[Any]:
    for entity in document.modelspace():
        for part in _exploded(entity):
            if layer is None or part.dxf.layer == layer:
                yield part


def _exploded(entity: Any) -> Iterator[Any]:
    """An entity, or those of the block that it inserts."""
    if entity.dxftype() != "INSERT":
        yield entity
        return
    for part in entity.virtual_entities():
        yield from _exploded(part)


def _curves(entity: Any) -> list[Curve]:
    """The curves of an entity, in the drawing's units."""
    kind = entity.dxftype()
    if kind in NO_GEOMETRY:
        return []
    readers = {
        "LINE": _line,
        "ARC": _arc,
        "CIRCLE": _arc,
        "ELLIPSE": _ellipse,
        "SPLINE": _spline,
        "LWPOLYLINE": _polyline,
        "POLYLINE": _polyline,
    }
    if kind not in readers:
        raise BodyError(
            f"{_named(entity)} is of a kind that bounds no planar solid: move it to another layer, "
            "and give `layer`."
        )
    try:
        return readers[kind](entity)
    except StandoffError as error:
        raise BodyError(f"{_named(entity)}: {error}") from error


def _named(entity: Any) -> str:
    return f"The {entity.dxftype()} #{entity.dxf.handle} on the layer {entity.dxf.layer!r}"


def _flat(point: Any) -> Array:
    at = np.array([float(x) for x in point])
    if len(at) == 3 and at[2] != 0.0:
        raise StandoffError(f"it leaves the plane z = 0, at {at}.")
    return at[:2]


def _line(entity: Any) -> list[Curve]:
    p, q = _flat(entity.dxf.start), _flat(entity.dxf.end)
    if np.array_equal(p, q):
        raise StandoffError(f"it has no length, at {p}: remove it.")
    return [Line(p, q)]


def _arc(entity: Any) -> list[Curve]:
    system = entity.ocs()
    centre = _flat(system.to_wcs(entity.dxf.center))
    r = float(entity.dxf.radius)
    if not r > 0.0:
        raise StandoffError(f"its radius is {r:g}, at {centre}: remove it.")
    first, turn = 0.0, 2.0 * math.pi
    if entity.dxftype() == "ARC":
        first = math.radians(float(entity.dxf.start_angle))
        last = math.radians(float(entity.dxf.end_angle))
        turn = (last - first) % (2.0 * math.pi) or turn
    a, b = (_flat(system.to_wcs(axis)) * r for axis in ((1, 0, 0), (0, 1, 0)))
    return [ConicArc(centre, a, b, first, first + turn)]


def _ellipse(entity: Any) -> list[Curve]:
    first, last = float(entity.dxf.start_param), float(entity.dxf.end_param)
    turn = (last - first) % (2.0 * math.pi) or 2.0 * math.pi
    centre, a, b = (_flat(v) for v in (entity.dxf.center, entity.dxf.major_axis, entity.minor_axis))
    return [ConicArc(centre, a, b, first, first + turn)]


def _spline(entity: Any) -> list[Curve]:
    points = [_flat(point) for point in entity.control_points]
    if not points:
        raise StandoffError(
            "it is given by fit points alone, which each program joins in its own way: let yours "
            "write its control points."
        )
    weights = list(entity.weights) or None
    return [NurbsCurve(points, np.array(entity.knots, dtype=np.float64), weights)]


def _polyline(entity: Any) -> list[Curve]:
    if entity.dxftype() == "POLYLINE" and not entity.is_2d_polyline:
        raise StandoffError("it is a polyline in space or a mesh, not one in the plane.")
    parts = [_curves(part) for part in entity.virtual_entities() if _has_length(part)]
    return [curve for part in parts for curve in part]


def _has_length(part: Any) -> bool:
    """Not a step of a polyline between equal points, which programs write to close it."""
    return bool(part.dxftype() != "LINE" or part.dxf.start != part.dxf.end)


def chained(curves: list[Curve], tolerance: float) -> list[list[Curve]]:
    """Loops of curves that meet end to end, in any order.

    Parameters
    ----------
    curves : list of Curve
    tolerance : float
        By how much ends may miss each other, length.

    Returns
    -------
    list of lists of Curve

    Raises
    ------
    BodyError
        An end at which no other curve ends, or more than one, with the place.
    """
    loops: list[list[Curve]] = []
    open_curves: list[Curve] = []
    for curve in curves:
        p, q = ends_of(curve)
        (loops.append([curve]) if np.linalg.norm(p - q) <= tolerance else open_curves.append(curve))
    partners = _partners(open_curves, tolerance)
    left = set(range(len(open_curves)))
    while left:
        at = first = min(left)
        end, loop = 1, []
        while at in left:
            left.discard(at)
            loop.append(open_curves[at])
            at, other = divmod(partners[2 * at + end], 2)
            end = 1 - other
        assert at == first
        loops.append(loop)
    return loops


def _partners(curves: list[Curve], tolerance: float) -> dict[int, int]:
    """For each end 2 k (first) or 2 k + 1 (last) of curve k the end that it meets."""
    if not curves:
        return {}
    ends = np.array([end for curve in curves for end in ends_of(curve)])
    tree = cKDTree(ends)
    partners: dict[int, int] = {}
    for k, near in enumerate(tree.query_ball_point(ends, tolerance)):
        others = [j for j in near if j != k]
        if not others:
            gap = float(tree.query(ends[k], 2)[0][1])
            raise BodyError(
                f"A curve ends at {ends[k]}, and no other one begins there (the nearest end is "
                f"{gap:.6g} away): close the outline, or give `join`."
            )
        if len(others) > 1:
            raise BodyError(
                f"{len(near)} curves end at {ends[k]}, where two are to meet: remove doubled "
                "lines and branches there."
            )
        partners[k] = others[0]
    return partners
