"""Mass, centre and inertia of a body of constant density, from its own boundary, with a bound."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from standoff.bodies.body import Body
from standoff.bodies.boundary import Boundary
from standoff.bodies.moments.boundary import Moments, moments_of
from standoff.checks.numbers import magnitude
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.geometry.validation import matrix3, vector3
from standoff.read_only import KeepsReadOnly
from standoff.simulation.tolerances import INERTIA_ROUNDOFF, LEAST_MOMENT, MOMENTS_END
from standoff.solids.spatial.solid_model import SolidModel
from standoff.typing import Array

# A volume below so many times its own bound is none: no digit of the centre is left.
LEAST_VOLUME = 4.0
GIVE_THEM = "give mass, centre and inertia yourself (so.simulation.MassProperties.of)"


class MassErrors(NamedTuple):
    """Bounds on the errors of mass properties: zero if they were given.

    Attributes
    ----------
    mass : float
        In the mass's unit.
    centre : float
        Distance, length.
    inertia : float
        Spectral norm of the difference, so of any moment and any entry, mass times length squared.
    volume : float
        Length cubed.
    """

    mass: float = 0.0
    centre: float = 0.0
    inertia: float = 0.0
    volume: float = 0.0


EXACT = MassErrors()


@dataclass(frozen=True, eq=False)
class MassProperties(KeepsReadOnly):
    """Mass, centre of mass and inertia of a rigid body.

    Raises StandoffError: a wrong shape, a number that is not finite, a mass that is not positive,
    an inertia that no body can have.

    Parameters
    ----------
    mass : float
        Positive, kg if lengths are metres and the density is kg/m³.
    centre : (3,) array_like
        Centre of mass, body frame, length.
    inertia : (3, 3) array_like
        About the centre, in the body's axes, mass times length squared: symmetric, positive
        definite, no principal moment above the sum of the others. With r the way from the centre
        it is ∫ (|r|² 1 - r rᵀ) dm.
    volume : float or None
        Length cubed; None where the properties were given.
    error : MassErrors
        Bounds on their errors.
    """

    mass: float
    centre: Array
    inertia: Array
    volume: float | None = None
    error: MassErrors = EXACT

    def __post_init__(self) -> None:
        object.__setattr__(self, "mass", magnitude(self.mass, "mass"))
        object.__setattr__(self, "centre", vector3(self.centre, "centre"))
        object.__setattr__(self, "inertia", checked_inertia(self.inertia))
        if self.volume is not None:
            object.__setattr__(self, "volume", magnitude(self.volume, "volume"))

    @staticmethod
    def of(*, mass: float, centre: Any, inertia: Any) -> MassProperties:
        """Mass properties that are known: for a body that is not solid, or whose density is not
        uniform.

        Raises StandoffError as the class.

        Parameters
        ----------
        mass : float
            Positive.
        centre : (3,) array_like
            Centre of mass, body frame, length.
        inertia : (3, 3) array_like
            About the centre, in the body's axes, mass times length squared.

        Returns
        -------
        MassProperties
            Without a volume, its error bounds zero.
        """
        return MassProperties(mass, centre, inertia)

    @property
    def principal_moments(self) -> Array:
        """(3,): the eigenvalues of the inertia, ascending, mass times length squared."""
        return np.asarray(np.linalg.eigvalsh(self.inertia))


def checked_inertia(value: Any) -> Array:
    """An inertia as a read-only symmetric (3, 3) array; StandoffError where no body has it."""
    inertia = matrix3(value, "inertia")
    largest = float(np.abs(inertia).max())
    apart = float(np.abs(inertia - inertia.T).max())
    if apart > INERTIA_ROUNDOFF * largest:
        raise StandoffError(
            f"inertia is not symmetric: entries across its diagonal differ by {apart:.3g}, in\n"
            f"{inertia}\nGive a symmetric matrix; products of inertia enter with a minus sign.",
            "inertia",
            value,
        )
    inertia = 0.5 * (inertia + inertia.T)
    small, middle, large = (float(x) for x in np.linalg.eigvalsh(inertia))
    if small <= LEAST_MOMENT * large:
        raise StandoffError(
            f"inertia is not positive definite: its least principal moment is {small:.3g}, and "
            f"its largest {large:.3g}. A body of any width has three positive ones; give a thin "
            "rod or a point mass its real width.",
            "inertia",
            value,
        )
    over = large - small - middle
    if over > INERTIA_ROUNDOFF * large:
        raise StandoffError(
            f"inertia violates the triangle inequality by {over:.6g}: its principal moments are "
            f"{small:.6g}, {middle:.6g} and {large:.6g}, and no body has one above the sum of the "
            "others. Was it taken about the centre of mass, in one unit?",
            "inertia",
            value,
        )
    inertia.flags.writeable = False
    return inertia


def mass_properties(
    body: Body | SolidModel, density: float = 1.0, *, tolerance: float = MOMENTS_END
) -> MassProperties:
    """Mass, centre of mass and inertia of a body, or a solid, of constant density.

    Integrals over the body's exact boundary by the divergence theorem, its swept radius included,
    with bounds of their errors: no mesh.

    Raises StandoffTypeError: not a body. Raises StandoffError: a body without volume or without
    bounds; a density or tolerance that is not positive.

    Parameters
    ----------
    body : Body or Solid
        Bounded, spatial, with volume.
    density : float
        Mass over length cubed, positive.
    tolerance : float
        Where the refinement of the integrals ends, over the volume, positive. Whatever was reached
        is in `error`; but a volume that cannot be distinguished from zero is refined further.

    Returns
    -------
    MassProperties
    """
    if not isinstance(body, Body | SolidModel):
        raise StandoffTypeError(f"body is {shown(body)}: give a Body or a Solid.", "body", body)
    rho = magnitude(density, "density")
    boundary: Boundary = body if isinstance(body, Body) else body.boundary
    if isinstance(body, Body):
        _check_solid(body)
    end = magnitude(tolerance, "tolerance")
    found = moments_of(boundary, end)
    if end > MOMENTS_END and not _has_volume(found):
        found = moments_of(boundary, MOMENTS_END)
    if not _has_volume(found):
        raise StandoffError(
            f"{body!r} has no volume: {found.volume:.3g}, known to {found.volume_error:.3g}. Round "
            f"it (rounding=...), or {GIVE_THEM}.",
            "body",
            body,
        )
    return _properties(found, rho)


def _has_volume(found: Moments) -> bool:
    return found.volume > LEAST_VOLUME * found.volume_error


def _check_solid(body: Body) -> None:
    if not body.bounded:
        raise StandoffError(
            f"{body!r} is unbounded and has no mass: fix it in the world, or {GIVE_THEM}.",
            "body",
            body,
        )
    if body.dimension == 2:
        raise StandoffError(
            f"{body!r} is planar and has no volume: extrude it, or {GIVE_THEM}.", "body", body
        )
    if not body.face_parts and body.radius == 0.0:
        raise StandoffError(
            f"{body!r} has no volume: round it (rounding=...), or {GIVE_THEM}.", "body", body
        )


def _properties(m: Moments, density: float) -> MassProperties:
    away = m.first / m.volume
    central = m.second - m.volume * np.outer(away, away)
    # the errors of each, entry by entry
    reach = np.abs(away)
    centre = (m.first_error + reach * m.volume_error) / (m.volume - m.volume_error)
    volume = m.volume + m.volume_error
    second = (
        m.second_error
        + m.volume_error * np.outer(reach, reach)
        + volume * (np.outer(reach, centre) + np.outer(centre, reach) + np.outer(centre, centre))
    )
    inertia = second + np.diag(np.trace(second) - 2.0 * np.diag(second))
    return MassProperties(
        density * m.volume,
        m.about + away,
        density * (np.trace(central) * np.eye(3) - central),
        m.volume,
        MassErrors(
            density * m.volume_error,
            float(np.linalg.norm(centre)),
            density * float(np.linalg.norm(inertia, 2)),
            m.volume_error,
        ),
    )
