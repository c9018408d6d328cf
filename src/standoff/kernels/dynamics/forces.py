"""What a pair's contact does to its bodies: every spot's force, from the witness points or from the
corners of a flat contact.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from standoff.kernels.algebra.rigid import read_rotation, read_vector
from standoff.kernels.algebra.vectors import add, axpy, cross, dot, rotate, scale, sub
from standoff.kernels.body.layout import RADIUS
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.dynamics.arrays import (
    N_BODY,
    N_TOUCH,
    P_DAMPING,
    P_FRICTION,
    P_SLIP,
    P_STIFFNESS,
    T_DEPTH,
    T_FORCE,
    T_SPOTS,
    T_STORED,
    bodies_of,
    pair_numbers,
)
from standoff.kernels.dynamics.contact_force import Material, spot_push
from standoff.kernels.dynamics.flat_contact import flat_spots, height, share
from standoff.kernels.dynamics.rigid_body import load, put
from standoff.kernels.pair.descent import pair_jets
from standoff.kernels.state.arrays import POSE_A, TWIST_A, TWIST_B
from standoff.kernels.values import Vector


class Witness(NamedTuple):
    """Witness points of a pair, their normal, and what the pair is seen by."""

    place: Any
    pose: Any  # B's, in A's frame
    normal: Vector  # A's frame


class Spot(NamedTuple):
    """Where a force acts, and its part of the spring; world."""

    point: Vector
    depth: float
    share: float


@kernel
def material_of(system, pair):
    o = pair_numbers(system, pair)
    x = system.numbers
    return Material(x[o + P_STIFFNESS], x[o + P_DAMPING], x[o + P_FRICTION], x[o + P_SLIP])


@kernel
def velocity_between(motion, x):
    """Velocity of B's point at x less that of A's, world."""
    total = (0.0, 0.0, 0.0)
    for sign, pose, twist in ((-1.0, POSE_A, TWIST_A), (1.0, POSE_A + 12, TWIST_B)):
        arm = sub(x, read_vector(motion, pose + 9))
        at = add(read_vector(motion, twist), cross(read_vector(motion, twist + 3), arm))
        total = axpy(sign, at, total)
    return total


@kernel
def press(system, pair, rows, first, motion, n, spot, scratch):
    """Put the force of one spot on both bodies; the power that it loses. n is in world axes."""
    done = spot_push(
        material_of(system, pair), spot.share, spot.depth, n, velocity_between(motion, spot.point)
    )
    a, b = bodies_of(system, pair)
    load(system, b, rows, first + N_BODY * b, spot.point, done.force, scratch.loads)
    opposite = scale(-1.0, done.force)
    load(system, a, rows, first + N_BODY * a, spot.point, opposite, scratch.loads)
    o = N_TOUCH * pair
    touch = scratch.touch
    put(add(read_vector(touch, o + T_FORCE), done.force), touch, o + T_FORCE)
    touch[o + T_STORED] += done.stored
    touch[o + T_DEPTH] = max(touch[o + T_DEPTH], spot.depth)
    touch[o + T_SPOTS] += 1.0
    return done.lost


@kernel
def clear_touch(scratch, pair):
    for k in range(N_TOUCH):
        scratch.touch[N_TOUCH * pair + k] = 0.0


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
def touch_pair(system, packed, pair, witness, rows, first, motion, scratch):
    """Put a pair's contact on its bodies' loads; the power that it loses.

    `rows[first]` are the bodies, whose twists stand in `motion` too.
    """
    clear_touch(scratch, pair)
    jet_a, jet_b = pair_jets(packed, witness.pose, witness.place)
    n = witness.normal
    radii = (packed.reals_a[RADIUS], packed.reals_b[RADIUS])
    depth = radii[0] + radii[1] - dot(n, sub(jet_b[0], jet_a[0]))
    if not depth > 0.0:
        return 0.0
    R, origin = read_rotation(motion, POSE_A), read_vector(motion, POSE_A + 9)
    world_n = rotate(R, n)
    heights = (dot(n, jet_a[0]), -dot(n, jet_b[0]))
    shared = flat_spots(system, pair, witness.pose, n, heights, scratch.spots)
    even = shared.even if shared.count >= 2 else 0.0
    lost = 0.0
    for k in range(shared.count if even > 0.0 else 0):
        found = flat_spot(shared, scratch.spots, k, radii)
        if found.depth > 0.0:
            at = add(rotate(R, found.point), origin)
            spot = Spot(at, found.depth, even * found.share)
            lost += press(system, pair, rows, first, motion, world_n, spot, scratch)
    if even < 1.0:
        # the middle of the overlap, between the swept surfaces
        low, high = axpy(radii[0], n, jet_a[0]), axpy(-radii[1], n, jet_b[0])
        at = add(rotate(R, scale(0.5, add(low, high))), origin)
        spot = Spot(at, depth, 1.0 - even)
        lost += press(system, pair, rows, first, motion, world_n, spot, scratch)
    return lost
