"""The force of one spot of contact: Hunt and Crossley's along the normal, Coulomb's across it."""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

from standoff.kernels.algebra.vectors import axpy, dot, scale
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.values import Vector


class Material(NamedTuple):
    """How two bodies push each other; units follow the length, mass and time in use."""

    stiffness: float  # k of F = k d^1.5, force/length^1.5
    damping: float  # c, time/length
    friction: float  # mu
    slip: float  # speed below which friction gives way, length/time


class Push(NamedTuple):
    """What a spot does."""

    force: Vector  # on B, world
    stored: float  # energy
    lost: float  # power, never below zero
    grip: float  # all of friction over the slip, force time/length


@kernel
def spring_of(stiffness, share, depth):
    """The force of a spot's part of a spring that is pressed so deep."""
    return share * stiffness * depth * sqrt(depth)


@kernel
def stored_in(spring, depth):
    """The energy in a spring whose force is `spring` at a depth: of all depths up to it."""
    return 0.4 * spring * depth


@kernel
def spot_push(material, share, depth, n, velocity, part):
    """F = share k d^1.5 (1 + 1.5 c d'), which never pulls, and friction against the slip.

    Hunt and Crossley, J. Appl. Mech. 42 (1975). n is the unit normal from A to B, velocity that of
    B's point less that of A's. Friction is mu F u / sqrt(u² + slip²), u the slip: Coulomb's law
    above the slip speed, viscous below it; a part of it is taken (``eased_friction``).
    """
    closing = -dot(n, velocity)
    spring = spring_of(material.stiffness, share, depth)
    normal = max(0.0, spring * (1.0 + 1.5 * material.damping * closing))
    slipping = axpy(closing, n, velocity)
    square = dot(slipping, slipping)
    # without friction there may be no slip speed either
    grip = 0.0
    if material.friction > 0.0:
        grip = material.friction * normal / sqrt(square + material.slip * material.slip)
    taken = part * grip
    force = axpy(-taken, slipping, scale(normal, n))
    lost = (normal - spring) * closing + taken * square
    return Push(force, stored_in(spring, depth), lost, grip)
