"""What the springs of a flat contact hold more, a second, by no work.

Between level and tilted a contact's corners give way to its witness points, and where a face slides
off another one their corners take other parts of the springs. No force does that. So the springs of
the corners are looked at half a tick before and after, or less, where the motion has B then: what
they hold more, less what is done on each corner as it is pressed, is given by sharing.
"""

from typing import Any, NamedTuple

from standoff.kernels.algebra.rigid import exp_rotation
from standoff.kernels.algebra.vectors import (
    add,
    axpy,
    compose,
    cross,
    dot,
    norm,
    rotate,
    scale,
    sub,
)
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.dynamics.contact_force import spring_of, stored_in
from standoff.kernels.dynamics.flat_contact import flat_spots, height, share
from standoff.kernels.tolerances import SHARED_TURN
from standoff.kernels.values import Motion, Pose, Vector


class Spot(NamedTuple):
    """Where a force acts, and its part of the spring."""

    point: Vector
    depth: float
    share: float


class Flats(NamedTuple):
    """Two flat parts on each other, A's frame: how B moves, their normal, and witness points."""

    motion: Motion
    n: Vector
    a: Vector
    b: Vector
    radii: Any


@kernel
def flat_spot(shared, points, k, radii):
    """Corner k of a flat contact: its point in A's frame, and its depth."""
    frame = shared.frame
    x, y = points[shared.at + 2 * k], points[shared.at + 2 * k + 1]
    low = height(shared.a, frame, x, y) + radii[0]
    high = height(shared.b, frame, x, y) - radii[1]
    point = axpy(x, frame.e, axpy(y, frame.f, scale(0.5 * (low + high), frame.n)))
    return Spot(point, low - high, share(points, shared.at, shared.count, k))


@kernel
def even_of(shared):
    """How level a flat contact is, 0 where it is none."""
    return shared.even if shared.count >= 2 else 0.0


@kernel
def held_and_pressed(stiffness, shared, flats, points):
    """What the corners' springs hold, each by its own share, and what is done on them a second."""
    held, pressed = 0.0, 0.0
    moving = flats.motion
    for k in range(shared.count):
        spot = flat_spot(shared, points, k, flats.radii)
        if spot.depth > 0.0:
            spring = spring_of(stiffness, spot.share, spot.depth)
            at = add(moving.v, cross(moving.w, sub(spot.point, moving.pose.p)))
            held += stored_in(spring, spot.depth)
            pressed -= spring * dot(flats.n, at)
    return held, pressed


@kernel
def flats_at(system, pair, flats, with_b, s, points):
    """The flat contact a time s later; the normal stays with A, or goes with B."""
    v, w = flats.motion.v, flats.motion.w
    pose, turn = flats.motion.pose, exp_rotation(scale(s, w))
    moved = Pose(compose(turn, pose.R), axpy(s, v, pose.p))
    b = add(moved.p, rotate(turn, sub(flats.b, pose.p)))
    n = rotate(turn, flats.n) if with_b else flats.n
    heights = (dot(n, flats.a), -dot(n, b))
    later = Flats(Motion(moved, v, w), n, flats.a, b, flats.radii)
    return flat_spots(system, pair, moved, n, heights, points), later


@kernel
def shared_a_second(system, pair, stiffness, shared, flats, h, points):
    """What sharing gives, power; `points` are those of the contact now, and are written over."""
    turning = norm(flats.motion.w) * h
    if turning > SHARED_TURN:
        h *= SHARED_TURN / turning
    held, pressed = held_and_pressed(stiffness, shared, flats, points)
    depth = flats.radii[0] + flats.radii[1] - dot(flats.n, sub(flats.b, flats.a))
    whole = stored_in(spring_of(stiffness, 1.0, depth), depth)
    # the normal goes with the part that is level with it
    with_b = shared.b.tilt < shared.a.tilt
    even, corners = 0.0, 0.0
    for sign in (-1.0, 1.0):
        then, later = flats_at(system, pair, flats, with_b, 0.5 * h * sign, points)
        even += sign * even_of(then)
        if then.count >= 2:
            corners += sign * held_and_pressed(stiffness, then, later, points)[0]
    return (even * (held - whole) + shared.even * (corners - h * pressed)) / h
