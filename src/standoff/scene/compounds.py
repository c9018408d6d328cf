"""From a ``[bodies.NAME]`` table to a body or a solid, or to a compound of several pieces."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from standoff.cad.files import ENDINGS as CAD
from standoff.motion import Pose
from standoff.scene.files import existing_file
from standoff.scene.part_files import (
    ENDINGS,
    MESHES,
    WITHOUT_UNIT,
    FileParts,
    FromFile,
    file_parts,
    from_file,
)
from standoff.scene.placements import POSE_KEYS, read_pose
from standoff.scene.reader import SceneTable, unknown_name
from standoff.scene.shapes import SHAPES, read_body
from standoff.wording import printable
from standoff.world import Compound, compound
from standoff.world.shapes import Shape

if TYPE_CHECKING:
    from standoff.bodies.meshes.files import InsteadOf

COMPOUND = "compound"
"""The ``shape`` of a body of several pieces."""


def read_solid(table: SceneTable, unit: str) -> Shape | Compound:
    """Return what a ``[bodies.NAME]`` table describes.

    Raises SceneError as of `read_body` and `read_file_body`; a compound without pieces, or planar
    pieces among spatial ones.

    Parameters
    ----------
    table : SceneTable
        Of one convex shape, or of a part of a file, with ``body``, or with ``shape = "compound"``
        and a table ``pieces``.
    unit : str
        The scene's label of lengths, to which those of CAD files are converted.
    """
    if "body" in table:
        part = read_file_body(table, unit)
        if part.stays:
            return part.shape
        return compound({part.name: (part.shape, part.pose)})
    if table.choice("shape", [*SHAPES, COMPOUND]) != COMPOUND:
        return read_body(table)
    table.expect("shape", "pieces")
    pieces = table.table("pieces", example=f"[{table.path}.pieces.handle]")
    if not pieces.names():
        raise pieces.error(f"no pieces; add a table such as [{pieces.path}.handle]")
    made = {name: _piece(pieces.table(name), unit) for name in pieces.names()}
    return pieces.build(lambda: compound(made))


def _piece(table: SceneTable, unit: str) -> tuple[Shape, Pose]:
    """A shape with the keys of a pose beside its own: of the piece in the compound's frame."""
    if "body" in table:
        part = read_file_body(table, unit, POSE_KEYS)
        if isinstance(part.shape, Compound):
            raise table.error(
                "the convex pieces of a mesh are a compound, and a piece is one shape: let the "
                "mesh be a body of its own, or give hull = true",
                "pieces",
            )
        return part.shape, read_pose(table.only(POSE_KEYS)) @ part.pose
    if "shape" in table and table.text("shape") == COMPOUND:
        raise table.error(
            "a piece is one convex shape; write the pieces of this one beside the others", "shape"
        )
    return read_body(table, POSE_KEYS), read_pose(table.only(POSE_KEYS))


# From ``body = "part.step"`` in a ``[bodies.NAME]`` table to a body or a solid.

OF_KINDS = ("heal", "hull", "pieces")
"""How files of some kinds are read."""

KEYS = ("body", "part", "tolerance", *OF_KINDS)
"""Of a body that is read from a file."""

UNITS = {"mm": "mm", "cm": "cm", "m": "m", "in": "inch", "inch": "inch"}
"""Labels of lengths to which those of a file can be converted, with the reader's name."""

KEPT = ".json"
"""Ending of the files of ``so.solids.save_boundary``."""


def read_file_body(table: SceneTable, unit: str, beside: Sequence[str] = ()) -> FromFile:
    """Return the part that a table with ``body`` names.

    Raises SceneError: a missing file, one of another kind or that is refused, a unit that no file
    has, several parts and none named, an unknown part, a package that is not installed.

    Parameters
    ----------
    table : SceneTable
        With ``body``, and optionally ``part``, ``heal``, ``tolerance``, ``hull`` and ``pieces``.
    unit : str
        The scene's label of lengths.
    beside : sequence of str
        Keys of the table that are none of these.
    """
    table.expect(*KEYS, *beside)
    path = existing_file(table, "body", 'body = "part.step"')
    heal, hull, pieces = (key in table and table.true_or_false(key) for key in OF_KINDS)
    tolerance = table.positive("tolerance") if "tolerance" in table else None
    if hull and pieces:
        raise table.error("give 'hull' or 'pieces', not both", "pieces")
    instead: InsteadOf = "hull" if hull else "pieces" if pieces else ""
    ending = path.suffix.lower()
    if ending == KEPT:
        for key in ("part", "tolerance", *OF_KINDS):
            if key in table:
                raise table.error("is for other files: one of Standoff's own has one part", key)
        return table.build(lambda: _kept(path), "body")
    if ending not in ENDINGS:
        known = ", ".join((*ENDINGS, KEPT))
        raise table.error(
            f"'{path.name}' is no file of a part: its name must end in {known}", "body"
        )
    for key in ("hull", "pieces"):
        if key in table and ending not in MESHES:
            raise table.error("is for files of meshes", key)
    for key in ("heal", "tolerance"):
        if key in table and ending not in CAD:
            raise table.error("is for CAD files", key)
    if unit not in UNITS and ending not in WITHOUT_UNIT:
        raise table.error(
            f"lengths of a file of parts can't be converted to '{unit}': write length_unit = "
            f'"mm", or one of {", ".join(UNITS)}, at the top of the scene',
            "body",
        )
    lengths = UNITS.get(unit, "mm")

    def parts() -> FileParts:
        return file_parts(path, lengths, heal=heal, tolerance=tolerance, instead=instead)

    return _chosen(table, table.build(parts, "body"))


def _kept(path: Path) -> FromFile:
    """A file of ``so.solids.save_boundary``."""
    from standoff.solids.boundary_file import open_boundary

    return from_file(path.stem, open_boundary(path), np.eye(4))


def _chosen(table: SceneTable, parts: FileParts) -> FromFile:
    """The part that is named, or the only one."""
    found = parts.found
    if "part" in table:
        name = table.text("part")
        for refusal in parts.refusals:
            if name not in found and refusal.startswith(f"{name}: "):
                raise table.error(f"the part is refused: {refusal}", "part")
        if name not in found:
            raise table.error(unknown_name(name, found, "part"), "part")
        return found[name]
    if parts.refusals:
        told = "; ".join(parts.refusals)
        raise table.error(f"parts are refused, and none is named by part = ...: {told}", "body")
    if len(found) > 1:
        names = ", ".join(f"'{printable(name)}'" for name in found)
        raise table.error(
            f'the file has {len(found)} parts: add part = "NAME", one of {names}', "body"
        )
    return next(iter(found.values()))
