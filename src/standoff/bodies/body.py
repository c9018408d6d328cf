"""A convex body: immutable, checked once, packed once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from standoff.bodies.assembly import assemble, joined_parts
from standoff.bodies.boundary import Boundary
from standoff.bodies.charts import edge_points, loop_pcurve
from standoff.bodies.convexity import FaceProofs
from standoff.bodies.finishing import PackedBoundary, finish
from standoff.bodies.made_parts import MadeParts
from standoff.bodies.report import BodyReport
from standoff.bodies.tolerances import MAX_SPREAD, SIMILARITY_TOLERANCE, SINGULAR_MAP
from standoff.bodies.topology import Edge, Face
from standoff.checks.arrays import finite
from standoff.checks.numbers import magnitude_or_zero
from standoff.checks.real_numbers import shape_of
from standoff.errors import StandoffError
from standoff.geometry.surfaces import Surface
from standoff.geometry.validation import matrix3, vector3
from standoff.typing import Array

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from standoff.geometry.pcurves import Pcurve


@dataclass(frozen=True, eq=False, repr=False)
class Body(Boundary):
    """A convex body in its own frame: a boundary that is proven convex. Make one with
    ``so.shapes``, ``Body.from_patches`` or ``Body.from_brep``.

    Unlike other boundaries it may be rounded, planar, a half-space, a segment or a point. Its
    attributes are those of `Boundary`, of which these say more:

    Attributes
    ----------
    radius : float
        Of the ball swept over the core, length: a sphere's own radius, another shape's rounding.
    dimension : int
        2 for a planar body (a closed loop of curves in z = 0), 3 for a spatial one.
    size : float
        Diagonal of the box around the body with its radius, length; inf for a half-space.
    report : BodyReport
    """

    report: BodyReport

    @staticmethod
    def from_brep(  # type: ignore[override]  # it takes what a convex body needs
        vertices: Any = (),
        edges: Sequence[Edge] = (),
        faces: Sequence[Face] = (),
        *,
        rounding: float = 0.0,
        dimension: int = 3,
        name: str = "body",
        tolerance: float | None = None,
        convexity_tolerance: float | None = None,
    ) -> Body:
        """A body from its boundary: vertices, edges and faces.

        Raises BodyError: open edges, edges used too often, parts that do not meet, a boundary that
        is not convex. Raises TypeError: edges or faces that are not a list. Raises ValueError: NaN,
        infinite, negative or wrongly shaped numbers.

        Parameters
        ----------
        vertices : (n, 3) array_like
            Points, body frame.
        edges : sequence of Edge
            Curves with their vertices; in a spatial body with faces each bounds two faces.
        faces : sequence of Face
            Surfaces with loops, counterclockwise seen from outside; a loop given the other way
            round is turned and reported in ``body.check().notes``.
        rounding : float
            Radius of a ball swept over the body, length: it grows by this much on all sides.
        dimension : int
            2 for a closed planar loop of edges in z = 0.
        tolerance : float, optional
            How far curves may be from their vertices and surfaces, length; 1e-9 of the size by
            default. The distance found goes into the certificate's slack.
        convexity_tolerance : float, optional
            Greatest convexity defect, length; 1e-6 of the size by default (``BodyReport``).
        """
        radius = magnitude_or_zero(rounding, "rounding")
        if convexity_tolerance is not None:
            convexity_tolerance = magnitude_or_zero(convexity_tolerance, "convexity_tolerance")
        joined = joined_parts(vertices, edges, faces, tolerance, dimension)
        return made_body(name, radius, finish(joined, radius, convexity_tolerance))

    @staticmethod
    def from_patches(
        patches: Sequence[Surface],
        *,
        tolerance: float | None = None,
        convexity_tolerance: float | None = None,
        rounding: float = 0.0,
        name: str = "body",
    ) -> Body:
        """A body from surface patches that close a convex shell: their sides are sewn together.

        Sides are matched by geometry, whatever their parameters; a side may have collapsed to a
        point, and may be shared by several smaller ones (T-junctions). Patches may face either
        way. What is split, turned and found smooth is in ``body.check()``.

        Raises BodyError: sides that match none or several, more than one shell, patches that meet
        only in a point, no volume, a boundary that is not convex; the message names the place, and
        for an open shell the gaps and, if there is one, a ``tolerance`` that would close them.
        Raises ValueError: NaN, infinite or negative numbers.

        Parameters
        ----------
        patches : sequence of Surface
            Each with a finite domain: NURBS, Bezier, revolved, extruded and formula surfaces
            have one, ``surface.restricted(u0, u1, v0, v1)`` gives one to any other.
        tolerance : float, optional
            How far joined sides may be apart, length in the patches' unit; 1e-9 of the size (the
            diagonal of their box) by default: 7e-8 mm for a cube of 40 mm. That is ample for
            patches of one formula. It is small because an accepted gap goes into the slack, which
            lowers every lower bound. Raise it for patches whose sides were computed one by one,
            like those of a CAD kernel: to its own tolerance, often 1e-7 of its unit. Only the
            greatest distance found counts, not the tolerance; corners within it become one.
        convexity_tolerance : float, optional
            Greatest convexity defect, length; 1e-6 of the size by default. The bound proven for
            the patches and sampled for the edges goes into the certificate's slack too.
        rounding : float
            Radius of a ball swept over the body, length: it grows by this much on all sides.
        """
        from standoff.bodies.sewing import sew

        radius = magnitude_or_zero(rounding, "rounding")
        if convexity_tolerance is not None:
            convexity_tolerance = magnitude_or_zero(convexity_tolerance, "convexity_tolerance")
        sewn = sew(patches, tolerance)
        reach = MAX_SPREAD * sewn.tolerance
        joined = assemble(
            sewn.vertices, sewn.edges, sewn.faces, 3, sewn.size, reach, sewn.senses, trusted=True
        )
        joined = replace(
            joined,
            notes=[*sewn.notes, *joined.notes],
            residual=max(joined.residual, sewn.residual),
            tolerance=sewn.tolerance,
        )
        known = FaceProofs(sewn.labels, sewn.proofs)
        return made_body(name, radius, finish(joined, radius, convexity_tolerance, known))

    @staticmethod
    def from_points(
        points: Any,
        *,
        tolerance: float | None = None,
        rounding: float = 0.0,
        name: str = "hull",
    ) -> Body:
        """The convex hull of points, spatial or planar.

        Facets of one plane are one face. Faces, edges and vertices are numbered the same for the
        same points: vertices in the points' order, faces by Qhull's order of facets, edges as the
        faces' outlines come to them.

        Raises BodyError: the points span no volume (no area), are too thin for their extent, or
        extend over less than 1e-50. Raises ValueError: a wrong shape, a number that is not finite
        or beyond 1e50, a tolerance that is not positive, a negative rounding.

        Parameters
        ----------
        points : (n, 3) or (n, 2) array_like
            At least four that are not in one plane, length; of a planar body, at least three that
            are not in one line. Those inside the hull, and all but one of equal ones, are left
            out. They may lie far from the origin: the hull is then taken about their middle,
            which ``body.check().notes`` tells.
        tolerance : float, optional
            Points within this distance of the hull of the others may be left out, length: facets
            that are nearly in one plane become few. The body then lies within the hull; how far
            points are above its faces goes into the slack, by which lower bounds are less, so that
            they are bounds for the hull of all points. ``body.check()`` tells both.
        rounding : float
            Radius of a ball (planar: a disc) swept over it, length, zero or above: the body grows
            by it all round.
        name : str

        Returns
        -------
        Body
        """
        from standoff.bodies.hulls.from_points import hull_of

        return made_body(name, *hull_of(points, tolerance, rounding))

    @staticmethod
    def from_mesh(
        mesh: Any,
        *,
        hull: bool = False,
        tolerance: float | None = None,
        rounding: float = 0.0,
        name: str = "mesh",
    ) -> Body:
        """A body of a closed convex mesh of triangles, or the hull of one that is not convex.

        Triangles of one plane are one face. What a hull adds to a mesh that is not convex is
        measured, and told in ``body.check().notes``; for convex pieces of it there is
        ``so.bodies.decomposition``.

        Parameters
        ----------
        mesh : trimesh.Trimesh, path, or (vertices, triangles)
            Closed, length. A file is read by trimesh, which the extra `meshes` installs. Equal
            points are made one; a mesh that faces inward is turned, which the notes tell.
        hull : bool
            Take the hull where the mesh is not convex.
        tolerance : float, optional
            As for ``from_points``; a mesh whose edges are concave by no more counts as convex, by
            default 1e-6 of the size.
        rounding : float
            Radius of a ball swept over it, length, zero or above.
        name : str

        Returns
        -------
        Body

        Raises
        ------
        BodyError
            Holes, more than two triangles at an edge, triangles that face different ways, no
            volume; or a mesh that is not convex, without ``hull=True``. The message names the
            place.
        ModuleNotFoundError
            A path is given, and trimesh is not installed; the message names the extra.
        OSError
            The file cannot be read.
        TypeError
            No mesh.
        ValueError
            NaN, infinite or wrongly shaped numbers, or corners that do not exist.
        """
        from standoff.bodies.meshes.bodies import mesh_body

        return made_body(name, *mesh_body(mesh, hull, tolerance, rounding))

    def transformed(self, affine: Any) -> Body:
        """The exact image under an affine map: a (3, 3), a (4, 4), or a ((3, 3), (3,)) pair.

        Raises ValueError: singular map; or a map that is not a similarity on a body with a swept
        radius.
        """
        linear, shift, stretch, flip = affine_map(affine, self.radius, self.dimension)
        radius = self.radius * stretch
        above = stretch * self.report.convexity_defect
        # what was left out of a hull stays in the slack of its mirror image too
        if isinstance(self.face_parts, MadeParts) and (flip > 0 or self.report.slack > 0.0):
            from standoff.bodies.hulls.build import image_of

            image = image_of(self.face_parts.source, linear, shift, radius, above)
            return made_body(self.name, radius, image)
        edges = [replace(e, curve=e.curve.transformed(linear, shift)) for e in self.edge_parts]
        faces = [
            Face(
                tuple(s.transformed(linear, shift) for s in f.charts),
                tuple((j, flip * s) for j, s in f.loop),
                f.apexes,
                _kept_pcurves(f, self.edge_parts),
            )
            for f in self.face_parts
        ]
        return Body.from_brep(
            self.vertex_points @ linear.T + shift,
            edges,
            faces,
            rounding=radius,
            dimension=self.dimension,
            name=self.name,
            tolerance=self._stretched(MAX_SPREAD * self.report.sewing_tolerance, stretch),
            convexity_tolerance=self._stretched(self.report.convexity_tolerance, stretch),
        )

    def _stretched(self, tolerance: float, stretch: float) -> float | None:
        """A tolerance for the image; None, the default, where this body has no finite size."""
        return tolerance * stretch if np.isfinite(self.size) and tolerance else None

    def check(self) -> BodyReport:
        """What construction found and turned."""
        return self.report

    def plot(self, path: str | Path | None = None, *, unit: str = "") -> Figure:
        """Draw the body from two opposite sides, or in its plane: its features and their names.

        Faces, edges, vertices, smooth seams and outward normals, in equal scales.

        Raises ModuleNotFoundError if matplotlib is not installed; the message names the extra.
        Raises TypeError if `path` is neither a string nor a Path. Raises ValueError if it is empty
        or has a different file extension. Raises OSError if the file cannot be written.

        Parameters
        ----------
        path : str or path, optional
            Also write the picture there, whole or not at all: .png, .svg or .pdf.
        unit : str
            Label of lengths.

        Returns
        -------
        matplotlib.figure.Figure
        """
        from standoff.bodies.drawing.body_picture import draw_body
        from standoff.bodies.drawing.files import drawn

        figure: Figure = drawn(path, lambda: draw_body(self, self.report, self.name, str(unit)))
        return figure

    @property
    def flat(self) -> bool:
        """May it be paired with a planar body: does it lie in z = 0 and have no faces?"""
        if self.face_parts:
            return False
        spots = [self.vertex_points] + [edge_points(e) for e in self.edge_parts]
        return bool(np.abs(np.concatenate(spots)[:, 2]).max() == 0.0)


def proven_again(
    parts: tuple[Any, Sequence[Edge], Sequence[Face]],
    name: str,
    radius: float,
    tolerance: float,
    residual: float,
) -> Body:
    """A spatial body of vertices, edges and faces that are known to miss each other by up to a
    residual, length; raises as `Body.from_brep` does."""
    joined = joined_parts(*parts, tolerance)
    joined = replace(joined, residual=max(joined.residual, residual))
    return made_body(name, radius, finish(joined, radius, None))


def made_body(name: str, radius: float, packed: PackedBoundary) -> Body:
    """A body of a boundary that is finished."""
    parts, report = packed.parts, packed.report
    return Body(
        name,
        parts.vertices,
        parts.edges if isinstance(parts.edges, MadeParts) else tuple(parts.edges),
        parts.faces if isinstance(parts.faces, MadeParts) else tuple(parts.faces),
        radius,
        parts.dimension,
        packed.ints,
        packed.reals,
        report.size,
        report,
    )


def _kept_pcurves(face: Face, edges: Sequence[Edge]) -> tuple[Pcurve | None, ...]:
    """A face's trimming curves, for its image: maps in space leave (u, v) as they are.

    Finding them again from the image's inverse would lose the digits that the condition of a
    flattening map costs.
    """
    if len(face.charts) > 1:
        return face.pcurves
    surface = face.charts[0]
    return tuple(loop_pcurve(face, k, edges, surface) for k in range(len(face.loop)))


# Affine maps of bodies: read, checked, and what they do to a swept radius.


class AffineMap(NamedTuple):
    """x -> linear x + shift.

    Attributes
    ----------
    linear : (3, 3) array
    shift : (3,) array
    stretch : float
        The greatest factor by which it makes a length longer.
    flip : int
        -1 for a mirror, else 1.
    """

    linear: Array
    shift: Array
    stretch: float
    flip: int


def affine_map(given: Any, radius: float, dimension: int) -> AffineMap:
    """An affine map for a body with a swept radius (length) and a dimension.

    Raises StandoffError: no map, a singular one, one that is no similarity for a radius, or that
    takes a planar body out of its plane.
    """
    try:
        linear, shift = _read(given)
    except StandoffError as error:
        raise StandoffError(str(error), "affine", given) from error
    stretch = np.linalg.svd(linear, compute_uv=False)
    if stretch[2] <= SINGULAR_MAP * stretch[0]:
        raise StandoffError(
            f"The affine map is singular (singular values {stretch}).", "affine", given
        )
    if radius > 0.0 and stretch[0] - stretch[2] > SIMILARITY_TOLERANCE * stretch[0]:
        raise StandoffError(
            f"A body with radius {radius} would not keep a round skin under this map "
            f"(singular values {stretch}): use so.shapes.ellipsoid or a body of patches.",
            "affine",
            given,
        )
    if dimension == 2 and (np.abs(linear[2, :2]).max() > 0.0 or shift[2] != 0.0):
        raise StandoffError("The map takes a planar body out of z = 0.", "affine", given)
    return AffineMap(linear, shift, float(stretch[0]), 1 if np.linalg.det(linear) > 0.0 else -1)


def _read(value: Any) -> tuple[Array, Array]:
    if isinstance(value, tuple) and len(value) == 2:
        return matrix3(value[0], "affine map"), vector3(value[1], "affine shift")
    if shape_of(value) == (4, 4):
        array = finite(value, "affine map", (4, 4))
        if not np.array_equal(array[3], [0.0, 0.0, 0.0, 1.0]):
            raise StandoffError(
                f"The affine map's last row is {array[3]}; it must be 0 0 0 1.", "affine", value
            )
        return array[:3, :3], array[:3, 3]
    return matrix3(value, "affine map"), np.zeros(3)
