"""Planar solids from DXF drawings, by ezdxf."""

from __future__ import annotations

import math
from collections.abc import Iterator
from io import StringIO
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from standoff.checks.numbers import positive
from standoff.checks.units import METRES, known_unit
from standoff.errors import BodyError, StandoffError, not_installed
from standoff.geometry.curves import ConicArc, Curve, Line
from standoff.geometry.nurbs_curves import NurbsCurve
from standoff.solids.planar.drawing import Drawing
from standoff.solids.planar.dxf_markers import with_markers
from standoff.solids.planar.loops import ends_of, size_of
from standoff.solids.planar.solid import solids_of
from standoff.solids.planar.tolerances import JOINED, JOINED_IN_DRAWING
from standoff.typing import Array
from standoff.wording import counted

NO_GEOMETRY = frozenset(
    {"ATTDEF", "ATTRIB", "DIMENSION", "HATCH", "LEADER", "MTEXT", "MULTILEADER", "POINT", "TEXT"}
    | {"VIEWPORT", "IMAGE", "WIPEOUT", "TABLE", "TOLERANCE", "XLINE", "RAY"}
)
"""Kinds of entities that say something about a drawing, and bound nothing."""

SURVEY_FOOT = 1200.0 / 3937.0
INSERT_UNITS = {
    1: ("inch", 0.0254),
    2: ("foot", 0.3048),
    3: ("mile", 1609.344),
    4: ("mm", 0.001),
    5: ("cm", 0.01),
    6: ("m", 1.0),
    7: ("km", 1e3),
    8: ("microinch", 0.0254 / 1e6),
    9: ("mil", 0.0254 / 1e3),
    10: ("yard", 0.9144),
    11: ("angstrom", 1.0 / 1e10),
    12: ("nm", 1.0 / 1e9),
    13: ("micron", 1.0 / 1e6),
    14: ("dm", 0.1),
    15: ("dam", 10.0),
    16: ("hm", 100.0),
    17: ("Gm", 1e9),
    18: ("astronomical unit", 149597870700.0),
    19: ("light year", 9460730472580800.0),
    20: ("parsec", 648e3 / math.pi * 149597870700.0),
    21: ("US survey foot", SURVEY_FOOT),
    22: ("US survey inch", SURVEY_FOOT / 12.0),
    23: ("US survey yard", 3.0 * SURVEY_FOOT),
    24: ("US survey mile", 5280.0 * SURVEY_FOOT),
}
"""Units of length by the numbers of $INSUNITS, 0 being none, with their metres."""


def read_dxf(
    path: str | PathLike[str],
    *,
    unit: str | None = None,
    layer: str | None = None,
    scale: float | None = None,
    join: float | None = None,
) -> Drawing:
    """The solids that the closed curves of a DXF drawing bound.

    Lines, arcs, circles, ellipses, splines and polylines (with bulges) of the model space, those
    of inserted blocks too. They are exact. Curves that meet end to end make a loop, in whatever
    order they are given; loops inside others are holes. Texts, dimensions and hatches are left out.

    Raises ImportError: ezdxf is not installed: it comes with the extra `dxf`. Raises
    FileNotFoundError: there is no such file. Raises StandoffError: a file that is no DXF, or cut
    off; an unknown unit. Raises BodyError: nothing that bounds an area, curves that are open,
    doubled, cross each other, or out of z = 0. The text has the place.

    Parameters
    ----------
    path : path
    unit : "mm", "cm", "m" or "inch", optional
        Of the lengths that are returned: the file's, by its $INSUNITS, are converted, which the
        report tells. The file's own by default; those of a file that tells none stay as they are.
    layer : str, optional
        Take the entities of this layer alone.
    scale : float, optional
        Length of one unit of the drawing in `unit`, in place of what the file tells: for a file
        that tells none, or a wrong one.
    join : float, optional
        By how much ends that meet may miss each other, length; 1e-5 of the drawing's size by
        default. What they miss is told, and is the solids' `slack`.

    Returns
    -------
    Drawing
        A sequence of PlanarSolid, in the order of the drawing, with the unit and a report.
    """
    wanted = None if unit is None else known_unit(unit)
    factor = None if scale is None else positive(scale, "scale")
    limit = None if join is None else positive(join, "join")
    file = Path(path)
    document, added = _document(file)
    if factor is None:
        file_unit, factor = _file_unit(document, wanted)
        own = wanted if file_unit and wanted else file_unit
    else:
        file_unit, own = "", wanted or ""
    curves = [
        curve.transformed(factor * np.eye(3), np.zeros(3)) if factor != 1.0 else curve
        for entity in _entities(document, layer)
        for curve in _curves(entity)
    ]
    if not curves:
        where = f" on the layer {layer!r}" if layer is not None else ""
        raise BodyError(f"{file.name} has no lines or curves{where}.", "path", path)
    size = size_of(curves)
    limit = JOINED_IN_DRAWING * size if limit is None else limit
    chains = chained(curves, (min(JOINED * size, limit), limit))
    notes = [f"added to the file: {added}"] if added else []
    if chains.joined:
        notes.append(
            f"joined: {counted(chains.joined, 'pair')} of ends, which miss each other by up to "
            f"{chains.gap:.3g}{own and ' ' + own}, at {chains.place}; up to {limit:.3g} is joined"
        )
    solids = solids_of(chains.loops, name=file.stem, join=limit)
    return Drawing(solids, own, file_unit, file.name, tuple(notes))


def _file_unit(document: Any, wanted: str | None) -> tuple[str, float]:
    """The unit that a drawing tells, "" for none, and its length in the one that is wanted."""
    name, metres = INSERT_UNITS.get(int(document.header.get("$INSUNITS", 0)), ("", 1.0))
    return name, metres / METRES[wanted] if name and wanted else 1.0


def _document(file: Path) -> tuple[Any, str]:
    """The drawing, and what was added to its text."""
    try:
        from ezdxf.filemanagement import dxf_file_info, read, readfile
        from ezdxf.lldxf.const import DXFError, DXFStructureError
    except ImportError as error:
        raise ImportError(not_installed("ezdxf", "dxf")) from error
    if not file.exists():
        raise FileNotFoundError(f"There is no file {file}.")
    try:
        try:
            return readfile(file), ""
        except DXFStructureError as error:
            if "subclass" not in str(error):
                raise
            encoding = dxf_file_info(str(file)).encoding
            text = file.read_text(encoding=encoding, errors="surrogateescape")
            mended, added = with_markers(text)
            return read(StringIO(mended)), added
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


# Curves in any order made into loops: which end meets which.


class Chains(NamedTuple):
    """Loops of curves, and what was joined that did not quite meet.

    Attributes
    ----------
    loops : list of lists of Curve
    joined : int
        Number of pairs of ends that miss each other by more than the first limit.
    gap : float
        The most by which any two miss each other, length.
    place : (2,) array
        Where that is.
    """

    loops: list[list[Curve]]
    joined: int
    gap: float
    place: Array


def chained(curves: list[Curve], limits: tuple[float, float]) -> Chains:
    """Loops of curves that meet end to end, in any order.

    Ends within the first limit meet. Of those that are left, which would make the outline open,
    ends within the second meet: so details that are smaller than this stay what they are.

    Raises BodyError: an end at which no other curve ends, or more than one, with the place.

    Parameters
    ----------
    curves : list of Curve
    limits : (float, float)
        By how much ends may miss each other, lengths.
    """
    ends = np.array([end for curve in curves for end in ends_of(curve)])
    partners = _partners(ends, limits)
    loops: list[list[Curve]] = []
    left = set(range(len(curves)))
    while left:
        at = first = min(left)
        end, loop = 1, []
        while at in left:
            left.discard(at)
            loop.append(curves[at])
            at, other = divmod(int(partners[2 * at + end]), 2)
            end = 1 - other
        assert at == first
        loops.append(loop)
    gaps = np.linalg.norm(ends - ends[partners], axis=1)
    worst = int(gaps.argmax())
    joined = int((gaps > limits[0]).sum()) // 2
    return Chains(loops, joined, float(gaps[worst]), ends[worst])


def _partners(ends: Array, limits: tuple[float, float]) -> NDArray[np.int64]:
    """For each end 2 k (first) or 2 k + 1 (last) of curve k the end that it meets."""
    partners = np.full(len(ends), -1)
    # a curve whose own ends meet is a loop, whatever else ends there
    own = np.linalg.norm(ends[::2] - ends[1::2], axis=1) <= limits[0]
    closed = 2 * np.flatnonzero(own)
    partners[closed], partners[closed + 1] = closed + 1, closed
    for limit in limits:
        left = np.flatnonzero(partners < 0)
        if not len(left):
            break
        near = cKDTree(ends[left]).query_ball_point(ends[left], limit)
        for k, found in zip(left, near, strict=True):
            if len(found) > 2:
                raise BodyError(
                    f"{len(found)} curves end at {ends[k]}, where two are to meet: remove doubled "
                    "lines and branches there."
                )
            if len(found) == 2:
                partners[k] = left[found[0]] if left[found[0]] != k else left[found[1]]
    _refuse_open(ends, np.flatnonzero(partners < 0), limits[1])
    return partners


def _refuse_open(ends: Array, left: NDArray[np.int64], limit: float) -> None:
    """Raise BodyError if ends are left, with the one that is farthest from all others."""
    if not len(left):
        return
    away = cKDTree(ends).query(ends[left], 2)[0][:, 1]
    worst = int(away.argmax())
    several = f", the farthest of {counted(len(left), 'open end')}" if len(left) > 1 else ""
    raise BodyError(
        f"A curve ends at {ends[left[worst]]}, and no other one begins there (the nearest end is "
        f"{away[worst]:.6g} away{several}; up to {limit:.3g} is joined): close the outline, or "
        "give `join`."
    )
