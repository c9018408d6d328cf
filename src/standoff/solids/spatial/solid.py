"""A solid: a boundary that encloses a volume, and what may be asked of it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.boundary import Boundary
from standoff.bodies.topology import Edge, Face
from standoff.checks.arrays import finite
from standoff.errors import StandoffError
from standoff.geometry.surfaces import Surface
from standoff.motion import Pose, PoseLike
from standoff.solids.answer import SolidProximity
from standoff.solids.asked import QueryOptions
from standoff.solids.plotted import Plotted, checked_answer
from standoff.solids.spatial.distance import spatial_distance
from standoff.solids.spatial.models import as_model
from standoff.solids.spatial.pair import PlacedPair
from standoff.solids.spatial.points import signed_distances
from standoff.solids.spatial.self_intersections import SelfIntersections, self_intersections
from standoff.solids.spatial.solid_model import SolidModel, known_model

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Places that a message names.
MOST_NAMED = 3


def solid_of(boundary: Boundary) -> Solid:
    """The solid of a boundary that somebody has already, or a new one; raises as `Solid` does."""
    found = known_model(boundary)
    return found if isinstance(found, Solid) else Solid(boundary)


class Solid(SolidModel, Plotted):
    """A solid that need not be convex, in its own frame.

    It wraps a `Boundary`, or a `Body`, whose faces may bend either way and have holes, and whose
    inner shells are cavities. Of a `Body` with a radius it has the boundary that is swept.

    Raises StandoffError: a boundary of another kind, a volume or an area that differs, or a
    boundary that crosses itself; the error's `value` is then what `self_intersections` would be.

    Parameters
    ----------
    boundary : Boundary or Body
        Spatial and bounded, with faces or a radius.
    volume, area : float, optional
        Of the maker, length cubed and squared: compared with those of the boundary.
    relative : float, optional
        How far they may differ, as a part of them.

    Attributes
    ----------
    self_intersections : SelfIntersections
        Where faces meet away from the edges that join them, and how much of that is proven.
    """

    def __init__(
        self,
        boundary: Boundary,
        *,
        volume: float | None = None,
        area: float | None = None,
        relative: float = 1e-6,
    ) -> None:
        super().__init__(boundary, volume=volume, area=area, relative=relative)
        self.self_intersections: SelfIntersections = self_intersections(self)
        if self.self_intersections.crossings:
            told = "; ".join(self.self_intersections.lines()[:MOST_NAMED])
            raise StandoffError(
                f"{boundary!r} crosses itself: {told}. Move or trim one of the faces, or give a "
                "tolerance that the crossing is within.",
                "boundary",
                self.self_intersections,
            )
        self._register()

    def __setstate__(self, stored: Any) -> None:
        super().__setstate__(stored)
        self._register()

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

        Raises BodyError as for ``Boundary.from_brep``.

        Returns
        -------
        Solid
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

        Raises BodyError as for ``Boundary.from_patches``.

        Returns
        -------
        Solid
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
        return spatial_distance(a, b, pose_a, pose_b, QueryOptions(within=within))

    def tracked(self, a: Any, b: Any, *given: Any, **options: Any) -> Any:
        """The tracker that ``so.Tracker`` makes of two solids, or of one and a `Body`.

        Parameters
        ----------
        a, b : Solid, Boundary or Body
            One of them this one.
        given, options
            As those of `SolidTracker`.

        Returns
        -------
        SolidTracker
        """
        from standoff.solids.tracked.tracker import SolidTracker

        return SolidTracker(a, b, *given, **options)

    def _figure(self, unit: str) -> Figure:
        from standoff.solids.drawing.spatial_picture import solid_figure

        return solid_figure(self.boundary, self.name, unit)

    def pictured(
        self, a: Any, b: Any, answer: Any, view: tuple[float, float] | None, unit: str
    ) -> Figure:
        """The picture that ``so.plot`` makes of two solids, of which this is one; see `Plotted`."""
        from standoff.solids.drawing.spatial_picture import Pictured, pair_figure

        told = checked_answer(answer)
        poses = (Pose(row[:9].reshape(3, 3), row[9:]) for row in told.poses)
        pair = PlacedPair(as_model(a), as_model(b), *poses)
        features = told.feature_a, told.feature_b
        one, other = (
            Pictured(solid.boundary, solid.name, frame, solid.part_told(feature))
            for solid, frame, feature in zip((pair.a, pair.b), pair.frames, features, strict=True)
        )
        return pair_figure((one, other), told, view, unit)

    def contains(self, points: Any) -> NDArray[np.bool_]:
        """Which points are inside the solid or on its boundary.

        Raises StandoffError: a wrong shape, or a number that is not finite.

        Parameters
        ----------
        points : (n, 3) array_like
            Own frame, length.

        Returns
        -------
        (n,) array of bool
        """
        return np.asarray(signed_distances(self, finite(points, "points", (-1, 3))).distance <= 0.0)

    def signed_distance(self, points: Any) -> Any:
        """How far points are from the boundary, negative inside, with proven bounds.

        Raises StandoffError: a wrong shape, or a number that is not finite.

        Parameters
        ----------
        points : (n, 3) array_like
            Own frame, length.

        Returns
        -------
        PointDistances
            Arrays: `distance` (n,), `lower_bound` and `upper_bound` (n,) of it, `gradient` (n, 3),
            `nearest` (n, 3), `converged` and `smooth` (n,).
        """
        return signed_distances(self, finite(points, "points", (-1, 3)))
