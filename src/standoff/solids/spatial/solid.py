"""A solid: a boundary that encloses a volume, and what may be asked of it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.boundary import Boundary
from standoff.bodies.topology import Edge, Face
from standoff.checks.arrays import finite
from standoff.geometry.surfaces import Surface
from standoff.motion import PoseLike
from standoff.solids.answer import SolidProximity
from standoff.solids.spatial.distance import spatial_distance
from standoff.solids.spatial.points import signed_distances
from standoff.solids.spatial.solid_model import SolidModel

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Solid(SolidModel):
    """A solid that need not be convex, in its own frame.

    It wraps a `Boundary`, or a `Body`, whose faces may bend either way and have holes, and whose
    inner shells are cavities.

    Parameters
    ----------
    boundary : Boundary or Body
        Spatial, bounded, with faces and without a radius.
    volume, area : float, optional
        Of the maker, length cubed and squared: compared with those of the boundary.
    relative : float, optional
        How far they may differ, as a part of them.

    Raises
    ------
    StandoffError
        A boundary of another kind, or a volume or an area that differs.
    """

    @staticmethod
    def from_brep(
        vertices: Any = (),
        edges: Sequence[Edge] = (),
        faces: Sequence[Face] = (),
        *,
        senses: Sequence[int | None] | None = None,
        tolerance: float | None = None,
        name: str = "solid",
    ) -> Solid:
        """A solid from its vertices, edges and faces, as ``Boundary.from_brep``.

        Returns
        -------
        Solid

        Raises
        ------
        BodyError
            As for ``Boundary.from_brep``.
        """
        made = Boundary.from_brep(
            vertices, edges, faces, senses=senses, tolerance=tolerance, name=name
        )
        return Solid(made)

    @staticmethod
    def from_patches(
        patches: Sequence[Surface], *, tolerance: float | None = None, name: str = "solid"
    ) -> Solid:
        """A solid from patches that close one or more shells, as ``Boundary.from_patches``.

        Returns
        -------
        Solid

        Raises
        ------
        BodyError
            As for ``Boundary.from_patches``.
        """
        return Solid(Boundary.from_patches(patches, tolerance=tolerance, name=name))

    def cold_query(
        self, a: Any, b: Any, pose_a: PoseLike, pose_b: PoseLike, within: float | None
    ) -> SolidProximity:
        """The distance of two solids, or of one and a `Body`; see ``so.solids.distance``.

        Parameters
        ----------
        a, b : Solid, Boundary or Body
            One of them this one.
        pose_a, pose_b : Pose or what ``Pose.of`` reads
        within : float or None
            Horizon, length.

        Returns
        -------
        SolidProximity
        """
        return spatial_distance(a, b, pose_a, pose_b, within=within)

    def plot(self, path: str | Path | None = None, *, unit: str = "") -> Figure:
        """Draw the solid from two opposite sides, its convex, reflex and smooth edges told apart.

        Parameters
        ----------
        path : str or path, optional
            Also write the picture there, whole or not at all: .png, .svg or .pdf.
        unit : str
            Label of lengths.

        Returns
        -------
        matplotlib.figure.Figure

        Raises
        ------
        ModuleNotFoundError
            If matplotlib is not installed; the message names the extra.
        TypeError
            If `path` is neither a string nor a Path.
        ValueError
            If it is empty or has a different file extension.
        OSError
            If the file cannot be written.
        """
        from standoff.solids.drawing.pictures import picture_of

        return picture_of(self, path, str(unit))

    def contains(self, points: Any) -> NDArray[np.bool_]:
        """Which points are inside the solid or on its boundary.

        Parameters
        ----------
        points : (n, 3) array_like
            Own frame, length.

        Returns
        -------
        (n,) array of bool

        Raises
        ------
        StandoffError
            A wrong shape, or a number that is not finite.
        """
        return np.asarray(signed_distances(self, finite(points, "points", (-1, 3))).distance <= 0.0)

    def signed_distance(self, points: Any) -> Any:
        """How far points are from the boundary, negative inside, with proven bounds.

        Parameters
        ----------
        points : (n, 3) array_like
            Own frame, length.

        Returns
        -------
        PointDistances
            Arrays: `distance` (n,), `lower_bound` and `upper_bound` (n,) of it, `gradient` (n, 3),
            `nearest` (n, 3), `converged` and `smooth` (n,).

        Raises
        ------
        StandoffError
            A wrong shape, or a number that is not finite.
        """
        return signed_distances(self, finite(points, "points", (-1, 3)))
