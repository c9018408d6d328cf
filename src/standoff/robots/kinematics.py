"""What a robot asks of the package that its model comes from."""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol

from standoff.typing import Array


class GeometryMotion(NamedTuple):
    """Where the moving geometries are, and how each degree of freedom moves them.

    Attributes
    ----------
    poses : (n_moving, 4, 4) array
        World poses of the moving geometries.
    screws : (6, ns) array
        (v, omega) of each degree of freedom: the velocity that it gives the point at the world's
        origin, and its angular velocity, world axes. There are nv, or more where joints mimic
        others.
    """

    poses: Array
    screws: Array


class Kinematics(Protocol):
    """Poses and Jacobians of a robot's moving geometries by its configuration.

    Attributes
    ----------
    nq, nv : int
        Numbers of a configuration, and of a velocity.
    support : (n_moving, ns) array
        1.0 where a degree of freedom moves a geometry, else 0.0.
    fold : (ns, nv) array or None
        The velocity of each screw by v; None where these are the same.
    """

    nq: int
    nv: int
    support: Array
    fold: Array | None

    def check(self, q: Any) -> Array:
        """A configuration (nq,), with quaternions of length 1.

        Raises StandoffError: another size, a number that is not finite, a quaternion that is none.
        """

    def poses(self, q: Array) -> Array:
        """(n_moving, 4, 4) world poses."""

    def motion(self, q: Array) -> GeometryMotion:
        """Poses and the screws of the joints."""

    def jacobians(self, q: Array) -> Array:
        """(n_moving, 6, nv): (v, omega) of each geometry's origin by v, world axes."""

    def integrate(self, q: Array, v: Array) -> Array:
        """The configuration after unit time with a velocity (nv,)."""

    def difference(self, q0: Array, q1: Array) -> Array:
        """The velocity (nv,) that leads from one to the other in unit time."""

    def neutral(self) -> Array:
        """(nq,) the model's own zero."""
