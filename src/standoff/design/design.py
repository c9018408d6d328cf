"""A body as a function of named parameters."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.boundary import Boundary
from standoff.bodies.features import Feature
from standoff.checks.real_numbers import shown
from standoff.design.points import point_at
from standoff.design.tolerances import NODES, ROUGH, STEP, WEIGHTS
from standoff.errors import StandoffError, StandoffTypeError
from standoff.solids.planar.solid import PlanarSolid

Array = NDArray[np.float64]
Made = Boundary | PlanarSolid
"""What has a boundary: a `Body`, a ``so.Solid`` or a ``so.PlanarSolid``."""


class Maker(Protocol):
    """A function of named parameters that returns a body."""

    def __call__(self, **parameters: Any) -> Made: ...


class Design:
    """A body as a function of named parameters: its shape can be differentiated by them.

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

    Raises
    ------
    TypeError
        `make` is not a function, or returned no body.
    ValueError
        No parameter; a parameter that is not of finite numbers.

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
        self.parameters = {name: _numbers(value, name) for name, value in parameters.items()}

    @cached_property
    def body(self) -> Made:
        return self._made(self.parameters)

    def changed(self, **parameters: Any) -> Design:
        """The same design with other values of some parameters.

        Raises
        ------
        ValueError
            A name that is none of the parameters.
        """
        unknown = parameters.keys() - self.parameters.keys()
        if unknown:
            raise StandoffError(
                f"{sorted(unknown)[0]!r} is no parameter of this design; it has "
                f"{', '.join(self.parameters)}."
            )
        return Design(self.make, **(self.parameters | parameters))

    def rates(
        self, feature: Feature, parameters: tuple[float, ...], normal: Array
    ) -> dict[str, float | Array]:
        """How fast the boundary moves along a normal, by each parameter, at a place of it.

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

        Raises
        ------
        ValueError
            A parameter's neighbours make no body, or one with other features.
        """
        heights = {
            name: np.array(
                [
                    [height_of(body, feature, parameters, normal) for body in bodies]
                    for bodies in of_one
                ]
            )
            for name, of_one in self._neighbours.items()
        }
        return {name: self._rate(name, rows) for name, rows in heights.items()}

    def _rate(self, name: str, heights: Array) -> float | Array:
        """From the heights (components, NODES) of the neighbours."""
        value = self.parameters[name]
        steps = self._steps(value)
        rates = heights @ np.array(WEIGHTS) / steps
        coarse = 0.5 * (heights[:, 2] - heights[:, 1]) / steps
        rough = np.abs(rates - coarse) > ROUGH * (np.abs(rates) + self.body.size * STEP / steps)
        if rough.any():
            raise StandoffError(
                f"The boundary does not move smoothly with {name}: differences of second and of "
                f"fourth order are {coarse[rough][0]:.6g} and {rates[rough][0]:.6g}."
            )
        return float(rates[0]) if np.ndim(value) == 0 else rates.reshape(np.shape(value))

    def _steps(self, value: float | Array) -> Array:
        """(components,) of the differences."""
        size = np.abs(np.ravel(value))
        return STEP * np.where(size > 0.0, size, self.body.size)

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
        if not isinstance(body, Boundary | PlanarSolid):
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
    try:
        array = np.array(value, dtype=float)
    except (TypeError, ValueError):
        array = np.array(np.nan)
    if array.size == 0 or not np.isfinite(array).all():
        raise StandoffError(
            f"{name} = {shown(value)}: give a finite number, or an array of them.", name, value
        )
    if array.ndim == 0:
        return float(array)
    array.flags.writeable = False
    return array


def counts_of(body: Made) -> tuple[int, ...]:
    """Numbers of features, by which bodies of one design are compared."""
    if isinstance(body, PlanarSolid):
        return tuple(len(loop.curves) for loop in body.loops)
    charts = sum(len(face.charts) for face in body.face_parts)
    return (body.n_faces, body.n_edges, body.n_vertices, charts)


def height_of(body: Made, feature: Feature, parameters: tuple[float, ...], normal: Array) -> float:
    """The height of a place along a unit vector, both in the body's frame, with its rounding."""
    radius = 0.0 if isinstance(body, PlanarSolid) else body.radius
    return float(point_at(body, feature, parameters) @ normal) + radius
