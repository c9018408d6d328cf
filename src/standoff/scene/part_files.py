"""The parts of a file of any kind that has some: CAD, DXF drawings, meshes."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from standoff.bodies.body import Body
from standoff.cad.files import ENDINGS as CAD
from standoff.checks.units import conversion
from standoff.errors import BodyError
from standoff.motion import Pose
from standoff.typing import Array
from standoff.world import Compound, compound
from standoff.world.shapes import Shape, as_shape

if TYPE_CHECKING:
    from standoff.bodies.meshes.files import InsteadOf

DRAWINGS = (".dxf",)
MESHES = (".stl", ".obj", ".ply", ".3mf")
ENDINGS = (*CAD, *DRAWINGS, *MESHES)
"""Of the files of parts; the library's own boundaries are one part each, and need no such words."""

WITHOUT_UNIT = tuple(ending for ending in ENDINGS if CAD.get(ending) == "brep") + MESHES[:3]
"""Kinds of files that tell no unit: their lengths stay as they are."""

FILES = 8
"""Number of files kept at hand: reading one may take seconds, and each body names one part."""

INSTEAD = {
    "Give hull=True": "Give hull = true",
    "take so.bodies.decomposition for convex pieces": "pieces = true for convex pieces",
    "give its vertices to so.Body.from_points for their hull": "take the hull of its vertices by "
    "so.Body.from_points",
    "give `join`": "read it by so.solids.read_dxf, whose `join` may be given",
}
"""What the library's messages say to do, as a body's table says it."""


class FromFile(NamedTuple):
    """A part of a file.

    Attributes
    ----------
    name : str
    shape : Body, Solid, PlanarSolid or Compound
    pose : Pose
        Of its frame in the file's.
    """

    name: str
    shape: Shape | Compound
    pose: Pose

    @property
    def stays(self) -> bool:
        """Is its frame the file's?"""
        pose = self.pose
        return bool(np.array_equal(pose.rotation, np.eye(3)) and not pose.translation.any())


class FileParts(NamedTuple):
    """Those of a file, by name, and what was found.

    Attributes
    ----------
    found : mapping of str to FromFile
    refusals : tuple of str
        Why others were refused, each with its name first.
    unit : str
        Of their lengths; empty where the file tells none.
    notes : tuple of str
    """

    found: Mapping[str, FromFile]
    refusals: tuple[str, ...]
    unit: str
    notes: tuple[str, ...]


def from_file(name: str, given: Any, pose: Array) -> FromFile:
    """A part from what a reader gives; a body that is placed is moved there."""
    shape = as_shape(given)
    assert shape is not None  # a reader gives boundaries and bodies
    if isinstance(shape, Body) and not np.array_equal(pose, np.eye(4)):
        return FromFile(name, shape.transformed(pose), Pose.identity())
    return FromFile(name, shape, Pose.of(pose))


def file_parts(
    path: Path,
    unit: str = "mm",
    *,
    heal: bool = False,
    tolerance: float | None = None,
    instead: InsteadOf = "",
) -> FileParts:
    """The parts of a file, by its ending.

    Raises ImportError, OSError, StandoffError as the readers of its kind; `BodyError` with what to
    do in the words of a scene.

    Parameters
    ----------
    path : Path
        Ends in one of `ENDINGS`.
    unit : "mm", "cm", "m" or "inch"
        To which lengths are converted where the file tells theirs.
    heal : bool, optional
    tolerance : float, optional
        Of CAD files.
    instead : "", "hull" or "pieces", optional
        What stands for meshes.
    """
    written = path.stat()
    try:
        version = written.st_mtime_ns, written.st_size
        return _read(path, version, unit, (heal, tolerance), instead)
    except BodyError as error:
        message = str(error)
        for argument, key in INSTEAD.items():
            message = message.replace(argument, key)
        raise BodyError(message, "path", path) from error


@lru_cache(maxsize=FILES)
def _read(
    path: Path,
    version: tuple[int, int],
    unit: str,
    cad: tuple[bool, float | None],
    instead: InsteadOf,
) -> FileParts:
    """`version` is when the file was written, and its length."""
    del version
    ending = path.suffix.lower()
    if ending in DRAWINGS:
        from standoff.solids.planar.dxf import read_dxf

        drawing = read_dxf(path, unit=unit)
        solids = {solid.name: FromFile(solid.name, solid, Pose.identity()) for solid in drawing}
        return _told(solids, drawing.unit, drawing.file_unit, drawing.notes)
    if ending in MESHES:
        from standoff.bodies.meshes.files import read_meshes

        meshes = read_meshes(path, unit, instead)
        bodies = {name: _of_pieces(name, pieces) for name, pieces in meshes.bodies.items()}
        return _told(bodies, unit if meshes.file_unit else "", meshes.file_unit, meshes.notes)
    from standoff.cad.reading import read_cad

    heal, tolerance = cad
    read = read_cad(path, unit=unit, heal=heal, tolerance=tolerance, keep="readable")
    parts = {name: from_file(name, part.body, part.pose) for name, part in read.by_name.items()}
    return _told(parts, read.unit, read.file_unit, ())._replace(refusals=read.refusals)


def _told(
    found: Mapping[str, FromFile], unit: str, file_unit: str, notes: tuple[str, ...]
) -> FileParts:
    converted = conversion(unit, file_unit)
    told = (f"lengths were {converted}",) if converted else ()
    return FileParts(found, (), unit, (*told, *notes))


def _of_pieces(name: str, pieces: Mapping[str, Body]) -> FromFile:
    whole = pieces[""] if "" in pieces else compound(pieces)
    return FromFile(name, whole, Pose.identity())
