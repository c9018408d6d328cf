"""A body as a function of named parameters."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property, partial
from typing import Any, Protocol

import numpy as np
from scipy.spatial import cKDTree

from standoff.bodies.boundary import Boundary
from standoff.bodies.features import Feature, charts_of
from standoff.checks.arrays import finite
from standoff.checks.names import choice
from standoff.checks.real_numbers import shown
from standoff.design.points import Group, group_of, points_of
from standoff.design.tolerances import DESIGN_STEP, NO_SCALE, ROUGH, UNBOUNDED_SIZE
from standoff.errors import StandoffError, StandoffTypeError
from standoff.kernels.body import layout as L
from standoff.solids.planar.solid import PlanarSolid
from standoff.solids.spatial.solid_model import SolidModel
from standoff.typing import Array, Ints

NODES = (-2, -1, 1, 2)
WEIGHTS = (1.0 / 12.0, -8.0 / 12.0, 8.0 / 12.0, -1.0 / 12.0)
"""Of the central difference of fourth order, in steps."""
Made = Boundary | SolidModel | PlanarSolid
"""What has a boundary: a `Body`, a ``so.Solid`` or a ``so.PlanarSolid``."""


class Maker(Protocol):
    """A function of named parameters that returns a body."""

    def __call__(self, **parameters: Any) -> Made: ...


class Design:
    """A body as a function of named parameters: its shape can be differentiated by them.

    Raises TypeError: `make` is not a function, or returned no body. Raises ValueError: no
    parameter; a parameter that is not of finite numbers.

    Parameters
    ----------
    make : callable
        Takes the parameters by name and returns a body: a function of ``so.shapes``, or your own,
        of anything that makes a `Body`, a ``so.Solid`` or a ``so.PlanarSolid``. Bodies of nearly
        equal parameters must have the same features in the same order.
    **parameters : float or array_like
        Each a number or an array of numbers: radii, semi-axes, exponents, control points, the
        numbers of a formula, placements.

    Attributes
    ----------
    parameters : dict of str to float or array
    body : Body, Solid or PlanarSolid
        Made at first use.

    Examples
    --------
    >>> lens = so.Design(so.shapes.lens, radius=1.0, offset=0.45)
    >>> answer = so.distance(lens.body, so.shapes.sphere(0.1), np.eye(4), pose)
    >>> so.shape_gradient(answer, a=lens).a["radius"]
    """

    def __init__(self, make: Callable[..., Made], /, **parameters: Any) -> None:
        if not callable(make):
            raise StandoffTypeError(
                f"make is {shown(make)}: give a function that returns a body.", "make", make
            )
        if not parameters:
            raise StandoffError("A design has no parameter: give at least one, by name.")
        self.make = make
        self._numbers: dict[int, Ints | None] = {}
        self.parameters = {name: _numbers(value, name) for name, value in parameters.items()}

    @cached_property
    def body(self) -> Made:
        return self._made(self.parameters)

    def changed(self, **parameters: Any) -> Design:
        """The same design with other values of some parameters.

        Raises ValueError: a name that is none of the parameters.
        """
        unknown = parameters.keys() - self.parameters.keys()
        if unknown:
            raise StandoffError(
                f"{sorted(unknown)[0]!r} is no parameter of this design; it has "
                f"{', '.join(self.parameters)}."
            )
        return Design(self.make, **(self.parameters | parameters))

    def only(self, *names: str) -> Design:
        """The same design, of which only some parameters are still parameters: the others keep
        their values, and no time is spent on their derivatives.

        Raises ValueError: no name, or one that is none of the parameters.
        """
        for name in names:
            choice(name, "names", self.parameters)
        held = {key: value for key, value in self.parameters.items() if key not in names}
        return Design(partial(self.make, **held), **{key: self.parameters[key] for key in names})

    def rates(
        self, feature: Feature, parameters: tuple[float, ...], normal: Array
    ) -> dict[str, float | Array]:
        """How fast the boundary moves along a normal, by each parameter, at a place of it.

        Raises ValueError: a parameter's neighbours make no body, or one with other features.

        Parameters
        ----------
        feature, parameters
            The place, as answers name it.
        normal : (3,) array
            Unit vector, body frame, outward at the place.

        Returns
        -------
        dict of str to float or array
            Length per unit of the parameter, in the parameter's shape.
        """
        group = group_of(boundary_of(self.body), feature, parameters)
        found = self.rates_of([group], np.array([finite(normal, "normal", (3,))]))
        return {name: rate[0] if rate.ndim > 1 else float(rate[0]) for name, rate in found.items()}

    def rates_of(self, groups: Sequence[Group], normals: Array) -> dict[str, Array]:
        """`rates` at many places.

        Parameters
        ----------
        groups : sequence of Group
            The places, by their rows.
        normals : (n, 3) array
            Unit vectors of all rows, body frame.

        Returns
        -------
        dict of str to array
            Of n rows, each in the parameter's shape; nan in rows of no group.
        """
        return {name: self._rate(name, groups, normals) for name in self.parameters}

    def _rate(self, name: str, groups: Sequence[Group], normals: Array) -> Array:
        value = self.parameters[name]
        rates = np.full((np.size(value), len(normals)), np.nan)
        steps = self._steps(value)
        for k, (bodies, step) in enumerate(zip(self._neighbours[name], steps, strict=True)):
            for group in groups:
                along = normals[group.rows]
                heights = [
                    heights_of(body, self._there(name, body, group), along) for body in bodies
                ]
                rates[k, group.rows] = self._sloped(name, np.array(heights), float(step))
        return rates.T.reshape(len(normals), *np.shape(value))

    def _there(self, name: str, body: Made, group: Group) -> Group:
        """The same places on a neighbour, whose planes and lines may have other numbers."""
        given, own = boundary_of(body), boundary_of(self.body)
        if isinstance(given, PlanarSolid) or isinstance(own, PlanarSolid):
            return group
        if id(body) not in self._numbers:
            self._numbers[id(body)] = numbers_in(given, own)
        numbers = self._numbers[id(body)]
        if numbers is None or numbers[group.feature] == group.feature:
            return group
        number = int(numbers[group.feature])
        if number < 0:
            raise StandoffError(
                f"No derivative by {name}: of a neighbour no feature is that of the answer."
            )
        chart = charts_of(given, number)[0] if group.chart >= 0 else -1
        return group._replace(feature=number, chart=chart)

    def _sloped(self, name: str, heights: Array, step: float) -> Array:
        """(m,) slopes, from the heights (NODES, m) of a component's neighbours."""
        rates: Array = np.array(WEIGHTS) @ heights / step
        coarse = 0.5 * (heights[2] - heights[1]) / step
        rough = np.abs(rates - coarse) > ROUGH * (np.abs(rates) + self._size * DESIGN_STEP / step)
        if rough.any():
            raise StandoffError(
                f"The boundary does not move smoothly with {name}: differences of second and of "
                f"fourth order are {coarse[rough][0]:.6g} and {rates[rough][0]:.6g}."
            )
        return rates

    def _steps(self, value: float | Array) -> Array:
        """(components,) of the differences."""
        scale = np.abs(np.ravel(value))
        return DESIGN_STEP * np.where(scale > NO_SCALE * self._size, scale, self._size)

    @property
    def _size(self) -> float:
        return self.body.size if np.isfinite(self.body.size) else UNBOUNDED_SIZE

    @cached_property
    def _neighbours(self) -> Mapping[str, list[list[Made]]]:
        """Of each parameter, of each of its components, the bodies at the NODES."""
        return {name: self._beside(name) for name in self.parameters}

    def _beside(self, name: str) -> list[list[Made]]:
        value = np.asarray(self.parameters[name], dtype=float)
        found = []
        for k, step in enumerate(self._steps(value).tolist()):
            row = []
            for node in NODES:
                moved = value.copy().reshape(-1)
                moved[k] += node * step
                given = float(moved[0]) if value.ndim == 0 else moved.reshape(value.shape)
                row.append(self._alike(name, given))
            found.append(row)
        return found

    def _alike(self, name: str, value: Any) -> Made:
        """The body of a neighbouring parameter, with the features of this one's."""
        try:
            body = self._made(self.parameters | {name: value})
        except ValueError as error:
            raise StandoffError(
                f"No derivative by {name}: {name} = {shown(value)} beside "
                f"{shown(self.parameters[name])} makes no body: {error}",
                name,
                value,
            ) from error
        if counts_of(body) != counts_of(self.body):
            raise StandoffError(
                f"No derivative by {name}: with {name} = {shown(value)} the body has other "
                f"features than with {shown(self.parameters[name])}.",
                name,
                value,
            )
        return body

    def _made(self, parameters: Mapping[str, Any]) -> Made:
        body = self.make(**parameters)
        if not isinstance(body, Made):
            raise StandoffTypeError(
                f"make returned {shown(body)}: it must return a Body, a Solid or a PlanarSolid.",
                "make",
                body,
            )
        return body

    def __repr__(self) -> str:
        name = getattr(self.make, "__name__", repr(self.make))
        told = ", ".join(f"{key}={shown(value)}" for key, value in self.parameters.items())
        return f"Design({name}, {told})"


def _numbers(value: Any, name: str) -> float | Array:
    array = finite(value, name, None)
    if not array.size:
        raise StandoffError(f"{name} is empty: give a number, or an array of them.", name, value)
    return float(array) if array.ndim == 0 else array


def boundary_of(body: Made) -> Boundary | PlanarSolid:
    """What has the features that answers name."""
    return body.given if isinstance(body, SolidModel) else body


def counts_of(body: Made) -> tuple[int, ...]:
    """Numbers of features, by which bodies of one design are compared."""
    given = boundary_of(body)
    if isinstance(given, PlanarSolid):
        return tuple(len(loop.curves) for loop in given.loops)
    charts = sum(len(face.charts) for face in given.face_parts)
    return (given.n_faces, given.n_edges, given.n_vertices, charts)


def radius_of(body: Made) -> float:
    """Of the ball that is swept over the core that answers name, length."""
    given = boundary_of(body)
    return 0.0 if isinstance(given, PlanarSolid) else given.radius


def heights_of(body: Made, group: Group, normals: Array) -> Array:
    """The heights (m,) of a group's places along outward unit vectors (m, 3), both in the body's
    frame, with the body's rounding."""
    points = points_of(boundary_of(body), group)
    heights: Array = np.einsum("ij,ij->i", points, normals) + radius_of(body)
    return heights


# Which feature of a neighbouring body is which of a design's own.
#
# The order of a polytope's edges depends on its numbers, down to the roundoff. Planes and lines may
# be renumbered and described anew: any of their points rises with them. All else must stay as it
# is.

CLEARLY = 2.0
"""Times the least distance: what another feature must be nearer by to be meant."""


def numbers_in(other: Boundary, own: Boundary) -> Ints | None:
    """The packed number in `other` of each feature of `own`, of the same counts; -1: none is it."""
    found, first = np.full(own.n_faces + own.n_edges + own.n_vertices, -1), 0
    for there, here in zip(_marks(other), _marks(own), strict=True):
        if not len(here):
            continue
        nearest, numbers = cKDTree(there).query(here)
        kept = np.linalg.norm(there - here, axis=1) <= CLEARLY * nearest
        numbers = np.where(kept, np.arange(len(here)), numbers)
        straight = np.array([_straight(other, first + int(k)) for k in numbers])
        alone = np.bincount(numbers, minlength=len(here))[numbers] == 1
        found[first : first + len(here)] = np.where(alone & (kept | straight), first + numbers, -1)
        first += len(here)
    return None if (found == np.arange(len(found))).all() else found


def _marks(body: Boundary) -> tuple[Array, Array, Array]:
    """A point for each face (the mean of its edges'), each edge (its middle), and each vertex."""
    edges = np.zeros((body.n_edges, 3))
    for k in range(body.n_edges):
        number = body.n_faces + k
        at = int(body.ints[L.edge_record(body.ints, number) + L.EDGE_REALS])
        middle = 0.5 * (body.reals[at + L.EDGE_T0] + body.reals[at + L.EDGE_T1])
        place = Group(number, -1, np.zeros(1, dtype=np.int64), np.array([[middle, 0.0]]))
        edges[k] = points_of(body, place)[0]
    faces = np.zeros((body.n_faces, 3))
    for k, face in enumerate(body.face_parts):
        around = [number for number, _ in face.loop]
        if around:
            faces[k] = edges[around].mean(axis=0)
    return faces, edges, np.reshape(body.vertex_points, (-1, 3))


def _straight(body: Boundary, number: int) -> bool:
    """Is a feature a plane, a line or a point?"""
    ints = body.ints
    if number < body.n_faces:
        first = int(ints[int(ints[L.FACES]) + L.FACE_STRIDE * number])
        return bool(ints[L.chart_record(ints, first) + L.CHART_KIND] == L.PLANE)
    if number < body.n_faces + body.n_edges:
        return bool(ints[L.edge_record(ints, number) + L.EDGE_KIND] == L.LINE)
    return True
