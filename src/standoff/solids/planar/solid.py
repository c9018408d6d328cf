"""Planar solids: outer and inner loops of curves in z = 0, convex or not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.bodies.features import Feature
from standoff.checks.arrays import finite
from standoff.checks.numbers import positive
from standoff.checks.real_numbers import shape_of, shown
from standoff.errors import BodyError, StandoffTypeError
from standoff.geometry.curves import ConicArc, Curve, Line
from standoff.kernels.solids import planar_layout as P
from standoff.kernels.solids.planar_tolerances import END_OF_PIECE
from standoff.motion import PoseLike
from standoff.read_only import KeepsReadOnly
from standoff.solids.answer import SolidProximity
from standoff.solids.asked import QueryOptions
from standoff.solids.planar.area import area_of
from standoff.solids.planar.leaves import form_of
from standoff.solids.planar.loops import Loop, read_loop
from standoff.solids.planar.nesting import check_simple, nested, oriented, turned
from standoff.solids.planar.outline import PlanarOutline, packed_outline
from standoff.solids.planar.query import planar_distance
from standoff.solids.planar.tolerances import NO_CORNER, PROVEN_TO, SMOOTH_TURN
from standoff.solids.plotted import Plotted, checked_answer
from standoff.typing import Array

if TYPE_CHECKING:
    from matplotlib.figure import Figure

VertexKind = Literal["convex", "reflex", "smooth"]


@dataclass(frozen=True, eq=False, repr=False)
class PlanarSolid(KeepsReadOnly, Plotted):
    """A planar solid in z = 0: what lies between loops of curves. Immutable.

    Make one with `from_loops`, `from_body` or ``so.solids.read_dxf``.

    Attributes
    ----------
    name : str
    loops : tuple of Loop
        The curves in the direction in which the solid lies on their left: the outer loop
        counterclockwise, inner ones clockwise. Edges are numbered through all loops in this
        order; vertex k is where edge k begins.
    area : float
        By Green's theorem, length².
    area_error : float
        Proven bound of its error, length².
    slack : float
        How far the boundary may be from what it stands for: ends that miss each other, and knots
        that were removed from splines; length.
    kinds : tuple of "convex", "reflex" or "smooth"
        Of the vertices: a corner that points outward, one that points inward, or none.
    outline : PlanarOutline
        What the compiled loops read.
    """

    name: str
    loops: tuple[Loop, ...]
    area: float
    area_error: float
    slack: float
    kinds: tuple[VertexKind, ...]
    outline: PlanarOutline = field(repr=False)

    @classmethod
    def from_loops(
        cls,
        outer: Sequence[Any],
        inner: Sequence[Sequence[Curve]] = (),
        *,
        name: str = "solid",
        join: float | None = None,
    ) -> PlanarSolid:
        """A solid from its loops.

        Raises BodyError: a loop that is open, meets itself or another, has a curve of no length or
        out of z = 0; a hole outside, or in another hole. The text has the place. Raises TypeError:
        something that is not a curve.

        Parameters
        ----------
        outer : sequence of Curve, or of such sequences
            The outer loop, in either direction, each curve in either direction; lengths. Or all
            loops in one list: which one is the outer is then found.
        inner : sequence of sequences of Curve, optional
            Holes.
        name : str, optional
        join : float, optional
            By how much ends that meet may miss each other, length; 1e-9 of the loop's size by
            default. What they miss is the solid's `slack`.

        Returns
        -------
        PlanarSolid
        """
        given = tuple(outer)
        limit = None if join is None else positive(join, "join")
        if given and not any(isinstance(each, Curve) for each in given):
            given += tuple(inner)
            found = solids_of(given, name=name, join=limit)
            if len(found) != 1:
                raise BodyError(
                    f"{len(given)} loops make {len(found)} separate solids: make one of each, "
                    "with PlanarSolid.from_loops(outer, inner).",
                    "outer",
                    outer,
                )
            return found[0]
        first = read_loop(given, "the outer loop", limit)
        holes = [read_loop(each, f"inner loop {k}", limit) for k, each in enumerate(inner)]
        return cls._made(oriented(first, holes), name)

    @classmethod
    def from_body(cls, body: Body, *, name: str = "") -> PlanarSolid:
        """A planar convex `Body` as a solid.

        Raises BodyError: a spatial body, one without area, or rounded edges of other kinds. Raises
        TypeError: not a body.

        Parameters
        ----------
        body : Body
            Planar, with edges; its rounding is kept where its edges are lines and arcs of circles.
        name : str, optional
            The body's own, if not given.

        Returns
        -------
        PlanarSolid
        """
        if not isinstance(body, Body):
            raise StandoffTypeError(f"{shown(body)} is no Body: give a planar one.", "body", body)
        return cls.from_loops(loops_of_body(body), name=name or body.name)

    @classmethod
    def of(cls, given: Any, name: str = "solid") -> PlanarSolid:
        """A planar solid as it is, or a planar `Body` as one.

        Raises TypeError: something else. Raises BodyError as `from_body`.

        Parameters
        ----------
        given : PlanarSolid or Body
        name : str, optional
            Of the argument, for the error.

        Returns
        -------
        PlanarSolid
        """
        if isinstance(given, PlanarSolid):
            return given
        if isinstance(given, Body):
            return cls.from_body(given)
        raise StandoffTypeError(
            f"{name} is {shown(given)}: give a PlanarSolid or a planar Body.", name, given
        )

    @classmethod
    def _made(cls, loops: tuple[Loop, ...], name: str) -> PlanarSolid:
        outline = packed_outline(loops)
        check_simple(outline, loops)
        area, error = area_of(loops)
        moved = max(curve.moved for loop in loops for curve in loop.curves)
        slack = max(loop.gap for loop in loops) + moved
        kinds = tuple(kind for loop in loops for kind in kinds_of(loop))
        return cls(name, loops, area, error, slack, kinds, outline)

    @property
    def dimension(self) -> int:
        """2."""
        return 2

    @property
    def bounded(self) -> bool:
        """True."""
        return True

    @property
    def size(self) -> float:
        """Diagonal of the box around it, length."""
        return self.outline.size

    @property
    def n_edges(self) -> int:
        """Number of curves of all loops."""
        return sum(len(loop.curves) for loop in self.loops)

    @property
    def edges(self) -> tuple[Curve, ...]:
        """The curves of all loops, by their numbers."""
        return tuple(curve for loop in self.loops for curve in loop.curves)

    def cold_query(
        self, a: Any, b: Any, pose_a: PoseLike, pose_b: PoseLike, within: float | None
    ) -> SolidProximity:
        """The distance of two planar solids, or of one and a planar `Body`; see
        ``so.solids.distance``.

        Parameters
        ----------
        a, b : PlanarSolid or Body
            One of them this one.
        pose_a, pose_b : Pose or what ``Pose.of`` reads
        within : float or None
            Horizon, length.

        Returns
        -------
        SolidProximity
        """
        first, second = PlanarSolid.of(a, "a"), PlanarSolid.of(b, "b")
        return planar_distance(first, second, pose_a, pose_b, QueryOptions(within))

    def _figure(self, unit: str) -> Figure:
        from standoff.solids.drawing.planar_picture import solid_figure

        return solid_figure(self, self.name, unit)

    def pictured(
        self, a: Any, b: Any, answer: Any, view: tuple[float, float] | None, unit: str
    ) -> Figure:
        """The picture that ``so.plot`` makes of two solids, of which this is one; see `Plotted`."""
        from standoff.solids.drawing.planar_picture import pair_figure

        del view  # it is their plane
        first, second = PlanarSolid.of(a, "a"), PlanarSolid.of(b, "b")
        names = first.name, second.name
        return pair_figure((first, second), names, checked_answer(answer), unit)

    def signed_distance(
        self, points: Any, *, gradients: bool = False
    ) -> Array | tuple[Array, Array]:
        """Signed distances of points from the boundary, negative inside.

        Each is proven to 1e-10 of the size: no boundary point is nearer by more.

        Raises ValueError: a wrong shape, numbers that are not finite, points out of z = 0.

        Parameters
        ----------
        points : (n, 2) or (n, 3) array_like
            In the solid's frame, length; z = 0.
        gradients : bool, optional
            Return the gradients too.

        Returns
        -------
        (n,) array, or a pair of (n,) and (n, 2) arrays
            Lengths; and unit vectors away from the solid's inside: at points that have several
            nearest boundary points that of one of them, and NaN on the boundary.
        """
        at = _points(points)
        distances, inside, feet = self.outline.foot(at, PROVEN_TO * self.size)
        sign = np.where(inside == 1, -1.0, 1.0)
        if not gradients:
            return sign * distances
        with np.errstate(invalid="ignore", divide="ignore"):
            away = sign[:, None] * (at - feet[:, 1:3]) / distances[:, None]
        away[distances == 0.0] = np.nan
        return sign * distances, away

    def contains(self, points: Any) -> NDArray[np.bool_]:
        """Are points inside, or on the boundary?

        Raises ValueError as for `signed_distance`.

        Parameters
        ----------
        points : (n, 2) or (n, 3) array_like
            In the solid's frame, length; z = 0.

        Returns
        -------
        (n,) array of bool
            On the boundary to within 1e-14 of the size counts as inside.
        """
        at = _points(points)
        distances, inside, _ = self.outline.foot(at, PROVEN_TO * self.size)
        found: NDArray[np.bool_] = (inside == 1) | (distances <= self.outline.leaf_real(0, P.PAD))
        return found

    def feature_at(self, leaf: int, t: float) -> tuple[Feature, tuple[float, ...]]:
        """The edge or vertex of a point of the boundary, and its parameter.

        Parameters
        ----------
        leaf : int
            Of the outline.
        t : float
            Parameter of its curve.

        Returns
        -------
        feature : Feature
        parameters : tuple of float
            The curve's parameter; empty for a vertex.
        """
        outline = self.outline
        for end, owner in ((P.FROM, leaf), (P.UNTIL, outline.leaf_int(leaf, P.AFTER))):
            vertex = outline.leaf_int(owner, P.VERTEX)
            length = abs(outline.leaf_real(leaf, P.UNTIL) - outline.leaf_real(leaf, P.FROM))
            near = abs(t - outline.leaf_real(leaf, end)) <= END_OF_PIECE * length
            if near and vertex >= 0 and self.kinds[vertex] != "smooth":
                return Feature("vertex", vertex), ()
        return Feature("edge", outline.leaf_int(leaf, P.CURVE)), (t,)

    def __repr__(self) -> str:
        inner = len(self.loops) - 1
        holes = f", {inner} inner loop{'s' if inner > 1 else ''}" if inner else ""
        return f"PlanarSolid({self.name!r}, {self.n_edges} edges{holes}, area={self.area:.6g})"


def solids_of(
    loops: Sequence[Any], *, name: str = "solid", join: float | None = None
) -> tuple[PlanarSolid, ...]:
    """The separate solids that loops make, those inside others being holes.

    Raises BodyError: see `PlanarSolid.from_loops`.

    Parameters
    ----------
    loops : sequence of sequences of Curve
    name : str, optional
        Of the first; the others have a number after it.
    join : float, optional
        See `PlanarSolid.from_loops`.

    Returns
    -------
    tuple of PlanarSolid
    """
    read = [read_loop(each, f"loop {k}", join) for k, each in enumerate(loops)]
    found = enumerate(nested(read))
    return tuple(PlanarSolid._made(each, f"{name} {k + 1}" if k else name) for k, each in found)


def kinds_of(loop: Loop) -> list[VertexKind]:
    """What the boundary does where each curve of a loop begins."""
    kinds: list[VertexKind] = []
    runs = list(zip(loop.curves, loop.backward, strict=True))
    last = [_tangent(curve, not backward, backward) for curve, backward in runs]
    first = [_tangent(curve, backward, backward) for curve, backward in runs]
    for k, out in enumerate(first):
        into = last[k - 1]
        turn = np.arctan2(into[0] * out[1] - into[1] * out[0], into @ out)
        smooth = abs(turn) <= SMOOTH_TURN
        kinds.append("smooth" if smooth else "convex" if turn > 0.0 else "reflex")
    return kinds


def _tangent(curve: Curve, at_last: bool, backward: bool) -> Array:
    """The unit tangent at one end of a curve in the direction of its loop."""
    rate = curve.jet(curve.last if at_last else curve.first)[1][:2]
    tangent: Array = rate / np.linalg.norm(rate)
    return -tangent if backward else tangent


def _points(points: Any) -> Array:
    columns = 3 if (shape_of(points) or ())[1:] == (3,) else 2
    at = finite(points, "points", (-1, columns))
    if columns == 3:
        if at[:, 2].any():
            raise BodyError(
                "Points of a planar solid have z = 0: give them in its plane.", "points", points
            )
        at = at[:, :2]
    return np.ascontiguousarray(at)


# The loop of a planar convex body, with its rounding.


def loops_of_body(body: Body) -> list[Curve]:
    """The curves of a planar body's boundary, in order.

    Raises BodyError: a body without area in the plane, or rounded edges that are neither lines nor
    arcs.
    """
    r = body.radius
    if not body.edge_parts and len(body.vertex_points) == 1 and r > 0.0:
        return [ConicArc(body.vertex_points[0], (r, 0.0, 0.0), (0.0, r, 0.0))]
    if len(body.edge_parts) == 1 and r > 0.0 and body.dimension == 3 and body.flat:
        p, q = np.asarray(body.vertex_points)
        return _stadium(p, q, r)
    if body.dimension != 2 or not body.edge_parts:
        raise BodyError(
            f"{body!r} has no area in the plane: give a planar body (so.shapes.planar_loop), a "
            "point or a segment in it with a radius, or a PlanarSolid, whose signed_distance tells "
            "how far points are.",
            "body",
            body,
        )
    curves = [edge.curve for edge in body.edge_parts]
    if r == 0.0:
        return curves
    loop = turned(read_loop(curves, f"the loop of {body.name}"), True)
    return _grown(loop, r, body)


def _stadium(p: np.ndarray, q: np.ndarray, r: float) -> list[Curve]:
    """All around a segment, counterclockwise."""
    along = (q - p) * (r / float(np.linalg.norm(q - p)))
    left = np.array([-along[1], along[0], 0.0])
    return [
        Line(p - left, q - left),
        ConicArc(q, -left, along, 0.0, np.pi),
        Line(q + left, p + left),
        ConicArc(p, left, -along, 0.0, np.pi),
    ]


def _grown(loop: Loop, r: float, body: Body) -> list[Curve]:
    """The loop at a distance r outside, with arcs round its corners."""
    grown: list[Curve] = []
    n = len(loop.curves)
    for k in range(n):
        curve, backward = loop.curves[k], loop.backward[k]
        grown.append(_moved_out(curve, backward, r, body))
        if n == 1:
            break
        corner = curve.point(curve.first if backward else curve.last)
        into, out = _normal(loop, k, True), _normal(loop, (k + 1) % n, False)
        first = float(np.arctan2(into[1], into[0]))
        turn = float(np.arctan2(into[0] * out[1] - into[1] * out[0], into @ out))
        if turn * r > NO_CORNER * body.size:
            axes = (r, 0.0, 0.0), (0.0, r, 0.0)
            grown.append(ConicArc(corner, *axes, first, first + turn))
    return grown


def _normal(loop: Loop, k: int, at_end: bool) -> np.ndarray:
    curve, backward = loop.curves[k], loop.backward[k]
    rate = curve.jet(curve.last if at_end != backward else curve.first)[1][:2]
    tangent = (-rate if backward else rate) / np.linalg.norm(rate)
    return np.array([tangent[1], -tangent[0]])


def _moved_out(curve: Curve, backward: bool, r: float, body: Body) -> Curve:
    form = form_of(curve)
    if form == P.LINE:
        p, q = curve.point(curve.first), curve.point(curve.last)
        rate = (p - q if backward else q - p)[:2]
        out = np.array([rate[1], -rate[0], 0.0]) * (r / float(np.linalg.norm(rate)))
        return Line(p + out, q + out)
    if form == P.ARC:
        a, b, centre = curve.basis().T
        factor = 1.0 + r / float(np.linalg.norm(a))
        return ConicArc(centre, a * factor, b * factor, curve.first, curve.last)
    raise BodyError(
        f"{body!r} is rounded by {r:g}, and has an edge that is neither a line nor an arc of a "
        "circle: its boundary is none of the curves that a PlanarSolid can be made of.",
        "body",
        body,
    )
