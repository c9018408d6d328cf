"""From a ``[bodies.NAME]`` table to a body or a solid, or to a compound of several pieces."""

from __future__ import annotations

from standoff.motion import Pose
from standoff.scene.body_files import read_file_body
from standoff.scene.placements import POSE_KEYS, read_pose
from standoff.scene.reader import Table
from standoff.scene.shapes import SHAPES, read_body
from standoff.world import Compound, compound
from standoff.world.shapes import Shape

COMPOUND = "compound"
"""The ``shape`` of a body of several pieces."""


def read_solid(table: Table, unit: str) -> Shape | Compound:
    """Return what a ``[bodies.NAME]`` table describes.

    Raises SceneError as of `read_body` and `read_file_body`; a compound without pieces, or planar
    pieces among spatial ones.

    Parameters
    ----------
    table : Table
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


def _piece(table: Table, unit: str) -> tuple[Shape, Pose]:
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
