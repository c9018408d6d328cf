"""From ``body = "part.step"`` in a ``[bodies.NAME]`` table to a body or a solid."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from standoff.bodies.body import Body
from standoff.motion import Pose
from standoff.scene.files import existing_file
from standoff.scene.reader import Array, Table, unknown_name
from standoff.wording import printable
from standoff.world.shapes import Shape, as_shape

KEYS = ("body", "part", "heal")
"""Of a body that is read from a file."""

UNITS = {"mm": "mm", "cm": "cm", "m": "m", "in": "inch", "inch": "inch"}
"""Labels of lengths to which those of a file can be converted, with the reader's name."""

KEPT = ".json"
"""Ending of the files of ``so.solids.save_boundary``."""

FILES = 8
"""Number of CAD files kept at hand: reading one takes seconds, and each body names one part."""


class FromFile(NamedTuple):
    """A part of a file.

    Attributes
    ----------
    name : str
    shape : Body or Solid
    pose : Pose
        Of its frame in the file's.
    """

    name: str
    shape: Shape
    pose: Pose

    @property
    def stays(self) -> bool:
        """Is its frame the file's?"""
        pose = self.pose
        return bool(np.array_equal(pose.rotation, np.eye(3)) and not pose.translation.any())


def read_file_body(table: Table, unit: str, beside: Sequence[str] = ()) -> FromFile:
    """Return the part that a table with ``body`` names.

    Parameters
    ----------
    table : Table
        With ``body``, and optionally ``part`` and ``heal``.
    unit : str
        The scene's label of lengths.
    beside : sequence of str
        Keys of the table that are none of these.

    Raises
    ------
    SceneError
        A missing file, one of another kind or that is refused, a unit that no file has, several
        parts and none named, an unknown part, a package that is not installed.
    """
    table.expect(*KEYS, *beside)
    path = existing_file(table, "body", 'body = "part.step"')
    heal = table.true_or_false("heal") if "heal" in table else False
    ending = path.suffix.lower()
    if ending == KEPT:
        for key in ("part", "heal"):
            if key in table:
                raise table.error("is for CAD files: a file of Standoff's own has one part", key)
        return table.build(lambda: _kept(path), "body")
    from standoff.cad.files import ENDINGS

    if ending not in ENDINGS:
        known = ", ".join((*ENDINGS, KEPT))
        raise table.error(
            f"'{path.name}' is no file of a part: its name must end in {known}", "body"
        )
    if unit not in UNITS and ENDINGS[ending] != "brep":
        raise table.error(
            f"lengths of a CAD file can't be converted to '{unit}': write length_unit = "
            f'"mm", or one of {", ".join(UNITS)}, at the top of the scene',
            "body",
        )
    written = path.stat()
    version = written.st_mtime_ns, written.st_size
    parts = table.build(lambda: _parts(path, version, UNITS.get(unit, "mm"), heal), "body")
    return _chosen(table, parts)


def _kept(path: Path) -> FromFile:
    """A file of ``so.solids.save_boundary``."""
    from standoff.solids.boundary_file import open_boundary

    return _from_file(path.stem, open_boundary(path), np.eye(4))


def _from_file(name: str, given: Any, pose: Array) -> FromFile:
    shape = as_shape(given)
    assert shape is not None  # a reader gives boundaries and bodies
    if isinstance(shape, Body) and not np.array_equal(pose, np.eye(4)):
        return FromFile(name, shape.transformed(pose), Pose.identity())
    return FromFile(name, shape, Pose.of(pose))


class _Parts(NamedTuple):
    """Those of a CAD file, by name, and why others were refused, each with its name first."""

    found: Mapping[str, FromFile]
    refusals: tuple[str, ...]


@lru_cache(maxsize=FILES)
def _parts(path: Path, version: tuple[int, int], unit: str, heal: bool) -> _Parts:
    """The parts of a CAD file; `version` is when it was written, and its length."""
    del version
    from standoff.cad.reading import read_cad

    read = read_cad(path, unit=unit, heal=heal, keep="readable")
    found = {name: _from_file(name, part.body, part.pose) for name, part in read.by_name.items()}
    return _Parts(found, read.refusals)


def _chosen(table: Table, parts: _Parts) -> FromFile:
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
