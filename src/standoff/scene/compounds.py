"""From a ``[bodies.NAME]`` table to a body, or to a compound of several pieces."""

from __future__ import annotations

from standoff.bodies.body import Body
from standoff.motion import Pose
from standoff.scene.placements import POSE_KEYS, read_pose
from standoff.scene.reader import Table
from standoff.scene.shapes import SHAPES, read_body
from standoff.world import Compound, compound

COMPOUND = "compound"
"""The ``shape`` of a body of several pieces."""


def read_solid(table: Table) -> Body | Compound:
    """Return what a ``[bodies.NAME]`` table describes.

    Parameters
    ----------
    table : Table
        Of one convex shape, or with ``shape = "compound"`` and a table ``pieces``.

    Raises
    ------
    SceneError
        As of `read_body`; a compound without pieces, or planar pieces among spatial ones.
    """
    if table.choice("shape", [*SHAPES, COMPOUND]) != COMPOUND:
        return read_body(table)
    table.expect("shape", "pieces")
    pieces = table.table("pieces", example=f"[{table.path}.pieces.handle]")
    if not pieces.names():
        raise pieces.error(f"no pieces; add a table such as [{pieces.path}.handle]")
    made = {name: _piece(pieces.table(name)) for name in pieces.names()}
    return pieces.build(lambda: compound(made))


def _piece(table: Table) -> tuple[Body, Pose]:
    """A shape with the keys of a pose beside its own: of the piece in the compound's frame."""
    if "shape" in table and table.text("shape") == COMPOUND:
        raise table.error(
            "a piece is one convex shape; write the pieces of this one beside the others", "shape"
        )
    return read_body(table, POSE_KEYS), read_pose(table.only(POSE_KEYS))
