"""A system in the user's own coordinates: M(θ) θ'' = F − C(θ, θ') − N(θ, θ'), with contact."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from standoff.bodies.body import Body
from standoff.checks.arrays import finite
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.motion import Pose, PoseLike
from standoff.read_only import KeepsReadOnly
from standoff.simulation.contact import HuntCrossley
from standoff.simulation.system import System
from standoff.simulation.tolerances import SINGULAR_INERTIA, SYMMETRIC_INERTIA
from standoff.typing import Array


@dataclass(frozen=True, kw_only=True, eq=False)
class GeneralisedSystem(KeepsReadOnly):
    """Bodies that are placed by coordinates θ, with the equations of motion that you give.

    Raises StandoffTypeError: something that is not a body, a contact or a function. Raises
    StandoffError: a pair that does not exist, is given twice, or cannot be one.

    Parameters
    ----------
    bodies : sequence of Body
    place : callable
        θ (n,) to the bodies' poses in the world, one each.
    jacobian : callable
        θ to the bodies' Jacobians, one (6, n) array each: the twist of a body's origin, (v, ω) in
        world axes, is J θ'.
    mass : callable
        θ to M (n, n), symmetric and positive definite.
    coriolis : callable
        (θ, θ') to C(θ, θ'), (n,).
    field : callable
        (θ, θ') to N(θ, θ'), (n,): gravity, springs, friction in joints.
    contact : HuntCrossley or sequence of it
        Of all pairs, or one for each pair, in their order.
    pairs : sequence of (int, int)
        Numbers of the bodies that are tracked and may touch.
    drive : callable, optional
        (t, θ, θ') to the generalised forces F, (n,); none if not given.
    """

    bodies: Sequence[Body]
    place: Callable[[Array], Sequence[PoseLike]]
    jacobian: Callable[[Array], Sequence[Any]]
    mass: Callable[[Array], Any]
    coriolis: Callable[[Array, Array], Any]
    field: Callable[[Array, Array], Any]
    contact: HuntCrossley | Sequence[HuntCrossley]
    pairs: Sequence[tuple[int, int]] = ((0, 1),)
    drive: Callable[[float, Array, Array], Any] | None = None

    def __post_init__(self) -> None:
        for name in ("place", "jacobian", "mass", "coriolis", "field"):
            _check_function(getattr(self, name), name)
        if self.drive is not None:
            _check_function(self.drive, "drive")
        object.__setattr__(
            self, "pairs", System.placed(self.bodies, self.contact, self.pairs).pairs
        )
        object.__setattr__(self, "bodies", tuple(self.bodies))

    def poses(self, theta: Array) -> list[Pose]:
        """Return the bodies' poses at coordinates."""
        found = [Pose.of(pose) for pose in self.place(theta)]
        if len(found) != len(self.bodies):
            raise StandoffError(
                f"place returned {len(found)} poses for {len(self.bodies)} bodies: give one each.",
                "place",
            )
        return found

    def jacobians(self, theta: Array) -> list[Array]:
        """Return the bodies' Jacobians, (6, n) each, at coordinates."""
        found = [finite(J, "jacobian", (6, len(theta))) for J in self.jacobian(theta)]
        if len(found) != len(self.bodies):
            raise StandoffError(
                f"jacobian returned {len(found)} arrays for {len(self.bodies)} bodies: give one "
                "each.",
                "jacobian",
            )
        return found

    def acceleration(
        self, t: float, theta: Array, rate: Array, wrenches: Sequence[Array] | None = None
    ) -> Array:
        """Return θ'' = M⁻¹ (F − C − N + Σ Jᵀ w), including the wrenches w on the bodies.

        Raises StandoffError: M that is singular, not symmetric, or not positive definite, with θ;
        wrong shapes.

        Parameters
        ----------
        t : float
        theta, rate : (n,) arrays
            Coordinates and their rates.
        wrenches : sequence of (6,) arrays, optional
            On each body, such as its contacts': force and torque about its origin, world axes.
        """
        n = len(theta)
        forces = -finite(self.coriolis(theta, rate), "coriolis", (n,))
        forces = forces - finite(self.field(theta, rate), "field", (n,))
        if self.drive is not None:
            forces = forces + finite(self.drive(t, theta, rate), "drive", (n,))
        if wrenches is not None and np.any(wrenches):
            for J, wrench in zip(self.jacobians(theta), wrenches, strict=True):
                forces = forces + J.T @ wrench
        matrix = checked_inertia_matrix(finite(self.mass(theta), "mass", (n, n)), theta)
        return np.asarray(np.linalg.solve(matrix, forces))


def checked_inertia_matrix(matrix: Array, theta: Array) -> Array:
    """M(θ), symmetric and positive definite; else StandoffError, with θ."""
    largest = float(np.abs(matrix).max())
    at = f"M(theta) at theta = {np.array2string(theta, precision=6)}"
    if float(np.abs(matrix - matrix.T).max()) > SYMMETRIC_INERTIA * largest:
        raise StandoffError(f"{at} is not symmetric:\n{matrix}", "mass", matrix)
    values = np.linalg.eigvalsh(matrix)
    if not values[0] > SINGULAR_INERTIA * max(largest, float(values[-1])):
        raise StandoffError(
            f"{at} is singular or not positive definite: its eigenvalues go from "
            f"{values[0]:.3g} to {values[-1]:.3g}. Choose coordinates that are regular there, and "
            "give every body that moves its mass.",
            "mass",
            matrix,
        )
    return matrix


def _check_function(given: Any, name: str) -> None:
    if not callable(given):
        raise StandoffTypeError(f"{name} is {shown(given)}: give a function.", name, given)
