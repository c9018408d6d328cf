"""From ``body = "part.step"`` in a ``[bodies.NAME]`` table to a body or a solid."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from standoff.cad.files import ENDINGS as CAD
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
from standoff.scene.reader import Table, unknown_name
from standoff.wording import printable

if TYPE_CHECKING:
    from standoff.bodies.meshes.files import InsteadOf

OF_KINDS = ("heal", "hull", "pieces")
"""How files of some kinds are read."""

KEYS = ("body", "part", "tolerance", *OF_KINDS)
"""Of a body that is read from a file."""

UNITS = {"mm": "mm", "cm": "cm", "m": "m", "in": "inch", "inch": "inch"}
"""Labels of lengths to which those of a file can be converted, with the reader's name."""

KEPT = ".json"
"""Ending of the files of ``so.solids.save_boundary``."""


def read_file_body(table: Table, unit: str, beside: Sequence[str] = ()) -> FromFile:
    """Return the part that a table with ``body`` names.

    Raises SceneError: a missing file, one of another kind or that is refused, a unit that no file
    has, several parts and none named, an unknown part, a package that is not installed.

    Parameters
    ----------
    table : Table
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


def _chosen(table: Table, parts: FileParts) -> FromFile:
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
