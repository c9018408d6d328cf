"""Pictures of solids in the plane and in space, and into files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from standoff.bodies.drawing.files import checked_file, write_picture
from standoff.errors import StandoffError
from standoff.solids.answer import SolidProximity

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def is_planar(given: Any) -> bool:
    """Is it a planar solid or a planar body?"""
    return getattr(given, "dimension", 3) == 2


def picture_of(solid: Any, path: str | Path | None, unit: str) -> Figure:
    """A solid, also written to a file; raises as ``Body.plot`` does."""
    target = None if path is None else checked_file(path)
    if is_planar(solid):
        from standoff.solids.drawing.planar_picture import solid_figure as planar_figure

        figure = planar_figure(solid, solid.name, unit)
    else:
        from standoff.solids.drawing.spatial_picture import solid_figure

        figure = solid_figure(solid.boundary, solid.name, unit)
    if target is not None:
        write_picture(figure, target)
    return figure


def picture_of_pair(
    a: Any, b: Any, answer: SolidProximity, view: tuple[float, float] | None, unit: str
) -> Figure:
    """Two solids with an answer about them.

    Raises
    ------
    TypeError
        Something that is no solid.
    ValueError
        A planar solid with a spatial one.
    """
    if is_planar(a) != is_planar(b):
        raise StandoffError(
            f"{a!r} and {b!r}: one is planar, one in space; give them as they were asked."
        )
    if is_planar(a):
        from standoff.solids.drawing.planar_picture import pair_figure as planar_figure
        from standoff.solids.planar.solid import PlanarSolid

        flat = PlanarSolid.of(a, "a"), PlanarSolid.of(b, "b")
        return planar_figure(flat, (flat[0].name, flat[1].name), answer, unit)
    from standoff.solids.drawing.spatial_picture import pair_figure
    from standoff.solids.spatial.solid_model import as_model

    models = as_model(a), as_model(b)
    names = models[0].name, models[1].name
    return pair_figure((models[0].boundary, models[1].boundary), names, answer, view, unit)
