"""Bodies of a simulated system: free ones with mass, fixed ones, and ones driven along a path."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from standoff.bodies.body import Body
from standoff.checks.numbers import magnitude
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.motion import Pose, PoseLike, Twist, TwistLike
from standoff.motion.pose_function import path_of
from standoff.read_only import KeepsReadOnly
from standoff.simulation.mass_properties import MassProperties, mass_properties
from standoff.solids.spatial.solid_model import SolidModel
from standoff.tracking.inputs import check_body
from standoff.wording import printable

FREE, FIXED, DRIVEN = "free", "fixed", "driven"


@dataclass(frozen=True, eq=False)
class RigidBody(KeepsReadOnly):
    """A body of a system. Make one with `RigidBody.free`, `.fixed` or `.driven`.

    Attributes
    ----------
    body : Body or Solid
    kind : str
        "free", "fixed" or "driven".
    mass_properties : MassProperties or None
        None for one that does not move freely.
    pose : Pose
        Of the body's frame in the world, where the system starts.
    twist : Twist
        Of the body's origin, where the system starts, world axes.
    path : path or None
        Of one that is driven.
    """

    body: Body | SolidModel
    kind: str
    mass_properties: MassProperties | None
    pose: Pose
    twist: Twist
    path: Any = None

    @staticmethod
    def free(
        body: Body | SolidModel,
        *,
        density: float | None = None,
        mass: float | None = None,
        inertia: Any = None,
        centre: Any = None,
        pose: PoseLike | None = None,
        twist: TwistLike | None = None,
    ) -> RigidBody:
        """Return a body that is moved by the forces on it.

        Raises StandoffTypeError: no body. Raises StandoffError: a body without bounds; both or none
        of density and mass; a mass that is not positive; a body without volume and no inertia; an
        inertia that no body can have.

        Parameters
        ----------
        body : Body or Solid
        density : float, optional
            Of a solid body [mass/length³]; or give its mass.
        mass : float, optional
            [mass]. Alone it is spread evenly over the body's volume.
        inertia : (3, 3) array_like, optional
            About the centre of mass, in the body's axes [mass length²], together with the mass.
        centre : (3,) array_like, optional
            Centre of mass, body frame [length], together with the inertia; the origin if not given.
        pose : Pose or what ``Pose.of`` reads, optional
            At the start; the identity if not given.
        twist : Twist or what ``Twist.of`` reads, optional
            At the start; at rest if not given.
        """
        check_spatial(body)
        if not body.bounded:
            raise StandoffError(
                f"{body!r} is unbounded and cannot move freely: fix it, or drive it.", "body", body
            )
        if (density is None) == (mass is None):
            raise StandoffError(
                f"density = {shown(density)} and mass = {shown(mass)}: give one of them.",
                "mass",
                mass,
            )
        if inertia is not None:
            if mass is None:
                raise StandoffError(
                    "An inertia goes with a mass, not with a density: give mass=...",
                    "inertia",
                    inertia,
                )
            middle = np.zeros(3) if centre is None else centre
            found = MassProperties.of(mass=mass, centre=middle, inertia=inertia)
        elif centre is not None:
            raise StandoffError(
                "A centre of mass goes with an inertia: give both, or neither.", "centre", centre
            )
        else:
            found = _even(body, density, mass)
        at = Pose.identity() if pose is None else Pose.of(pose)
        moving = Twist.zero() if twist is None else Twist.of(twist).in_world(at)
        return RigidBody(body, FREE, found, at, moving)

    @staticmethod
    def fixed(body: Body | SolidModel, pose: PoseLike | None = None) -> RigidBody:
        """Return a body that never moves.

        Raises StandoffTypeError: no body. Raises StandoffError: a planar body; no pose.

        Parameters
        ----------
        body : Body or Solid
            Of any kind but planar; a half-space is allowed.
        pose : Pose or what ``Pose.of`` reads, optional
            The identity if not given.
        """
        check_spatial(body)
        at = Pose.identity() if pose is None else Pose.of(pose)
        return RigidBody(body, FIXED, None, at, Twist.zero())

    @staticmethod
    def driven(body: Body | SolidModel, path: Any) -> RigidBody:
        """Return a body that follows a path whatever it meets.

        Raises StandoffTypeError: no body; no path. Raises StandoffError: a planar body.

        Parameters
        ----------
        body : Body or Solid
        path : path
            Of ``standoff.motion``, or anything with ``pose(t)`` and ``twist(t)``.
        """
        check_spatial(body)
        try:
            found = path_of(path, 0.0, np.inf)
        except TypeError as error:
            raise StandoffTypeError(
                f"path is {shown(path)}: give a path of standoff.motion, or an object with pose(t) "
                "and twist(t).",
                "path",
                path,
            ) from error
        at = Pose.of(found.pose(0.0))
        return RigidBody(body, DRIVEN, None, at, Twist.of(found.twist(0.0)).in_world(at), found)

    def __repr__(self) -> str:
        mass = "" if self.mass_properties is None else f", mass {self.mass_properties.mass:g}"
        return f"<RigidBody {printable(self.body.name)}: {self.kind}{mass}>"


def check_spatial(body: Body | SolidModel) -> None:
    """Raise TypeError where something given is neither a body nor a solid in space, ValueError
    where it is a planar body."""
    if isinstance(body, SolidModel):
        return
    check_body(body)
    if body.dimension == 2:
        raise StandoffError(f"{body!r} is planar: systems are spatial; extrude it.", "body", body)


def _even(body: Body | SolidModel, density: float | None, mass: float | None) -> MassProperties:
    """Mass properties of a solid of uniform density, which a mass alone determines too."""
    if density is not None:
        return mass_properties(body, density)
    wanted = magnitude(mass, "mass")
    unit = mass_properties(body, 1.0)
    scale = wanted / unit.mass
    return MassProperties(
        wanted,
        unit.centre,
        scale * unit.inertia,
        unit.volume,
        unit.error._replace(
            mass=0.0, inertia=scale * unit.error.inertia + unit.error.mass / unit.mass
        ),
    )
