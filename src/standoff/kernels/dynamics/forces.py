"""What a pair's contact does to its bodies: every spot's force, from the witness points or from the
corners of a flat contact.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from standoff.kernels.algebra.rigid import (
    read_rotation,
    read_vector,
    relative_pose,
    relative_twist,
)
from standoff.kernels.algebra.vectors import add, axpy, cross, dot, norm, rotate, scale, sub
from standoff.kernels.body.layout import RADIUS
from standoff.kernels.compiler.decorators import ahead, kernel
from standoff.kernels.dynamics.arrays import (
    B_FLATS,
    N_BODY,
    N_TOLD,
    N_TOUCH,
    P_DAMPING,
    P_FRICTION,
    P_SLIP,
    P_STIFFNESS,
    STEP,
    T_DEPTH,
    T_FORCE,
    T_SPOTS,
    T_STORED,
    TOLD,
    TOLD_HEADER,
    TOLD_ROOM,
    U_DEPTH,
    U_FORCE,
    U_NORMAL,
    U_PAIR,
    U_POINT,
    U_SHARE,
    bodies_of,
    body_ints,
    pair_numbers,
    shared_row,
)
from standoff.kernels.dynamics.contact_force import Material, spot_push
from standoff.kernels.dynamics.eased_friction import book_grip, part_between
from standoff.kernels.dynamics.flat_contact import flat_spots
from standoff.kernels.dynamics.flat_parts import (
    F_KIND,
    F_TIP_REALS,
    F_TIPS,
    FLAT_HEADER,
    HALFSPACE,
    POLYTOPE,
)
from standoff.kernels.dynamics.flat_sharing import (
    Flats,
    Spot,
    even_of,
    flat_spot,
    shared_a_second,
)
from standoff.kernels.dynamics.rigid_body import load, put
from standoff.kernels.pair.descent import pair_jets
from standoff.kernels.state.arrays import POSE_A, POSE_B, TWIST_A, TWIST_B
from standoff.kernels.values import Motion, Pose, Vector


class Witness(NamedTuple):
    """Witness points of a pair, their normal, and what the pair is seen by."""

    place: Any
    pose: Any  # B's, in A's frame
    normal: Vector  # A's frame


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
def moving_pair(motion):
    """B's motion seen from A, of a row of numbers."""
    a, b = ahead(motion, POSE_A), ahead(motion, POSE_B)
    v, w = relative_twist(a, b, ahead(motion, TWIST_A), ahead(motion, TWIST_B))
    return Motion(relative_pose(a, b), v, w)


@kernel
def press(system, pair, rows, first, motion, n, spot, scratch):
    """Add the force of one spot to both bodies; returns the power that it loses. n is in world
    axes."""
    a, b = bodies_of(system, pair)
    velocity = velocity_between(motion, spot.point)
    part = part_between(system, scratch.loads, a, b)
    done = spot_push(material_of(system, pair), spot.share, spot.depth, n, velocity, part)
    load(system, b, rows, first + N_BODY * b, spot.point, done.force, scratch.loads)
    opposite = scale(-1.0, done.force)
    load(system, a, rows, first + N_BODY * a, spot.point, opposite, scratch.loads)
    o = N_TOUCH * pair
    touch = scratch.touch
    put(add(read_vector(touch, o + T_FORCE), done.force), touch, o + T_FORCE)
    touch[o + T_STORED] += done.stored
    touch[o + T_DEPTH] = max(touch[o + T_DEPTH], spot.depth)
    touch[o + T_SPOTS] += 1.0
    tell_spot(scratch.told, pair, n, spot, done.force)
    if done.grip > 0.0:
        book_grip(system, pair, rows, first, spot.point, n, done.grip, scratch.loads)
    return done.lost


@kernel
def tell_spot(told, pair, n, spot, force):
    """Write what a spot pushes behind what others do, where there is room."""
    count = told[TOLD]
    told[TOLD] = count + 1.0
    if count >= told[TOLD_ROOM]:
        return
    at = TOLD_HEADER + N_TOLD * int(count)
    told[at + U_PAIR], told[at + U_DEPTH], told[at + U_SHARE] = pair, spot.depth, spot.share
    put(spot.point, told, at + U_POINT)
    put(n, told, at + U_NORMAL)
    put(force, told, at + U_FORCE)


@kernel
def clear_touch(scratch, pair):
    for k in range(N_TOUCH):
        scratch.touch[N_TOUCH * pair + k] = 0.0


@kernel
def kind_in(system, body):
    return system.layout[system.layout[body_ints(body) + B_FLATS] + F_KIND]


@kernel
def plane_of(system, pair):
    """0 or 1 where A or B is a half-space and the other body has flat faces alone; else -1."""
    a, b = bodies_of(system, pair)
    if kind_in(system, a) == HALFSPACE and kind_in(system, b) == POLYTOPE:
        return 0
    if kind_in(system, b) == HALFSPACE and kind_in(system, a) == POLYTOPE:
        return 1
    return -1


@kernel
def plane_and_corners(system, pair, side, pose):
    """(normal from A to B, the pose of the other body's corners in A's frame, where they stand, how
    many) of a half-space and a polytope.
    """
    numbers = bodies_of(system, pair)
    identity = Pose((1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0))
    plane = system.layout[body_ints(numbers[side]) + B_FLATS]
    outward = read_vector(system.numbers, system.layout[plane + FLAT_HEADER + 1])
    other = system.layout[body_ints(numbers[1 - side]) + B_FLATS]
    at, count = system.layout[other + F_TIP_REALS], system.layout[other + F_TIPS]
    if side == 0:
        return outward, pose, at, count
    return scale(-1.0, rotate(pose.R, outward)), identity, at, count


@kernel
def touch_corners(system, packed, pair, witness, rows, first, motion, scratch):
    """`touch_pair`, of a half-space and a body of flat faces: every corner below the plane has its
    own spring, so the force is the gradient of an energy, whatever the tilt.
    """
    side = plane_of(system, pair)
    n, placed, at, count = plane_and_corners(system, pair, side, witness.pose)
    jets = pair_jets(packed, witness.pose, witness.place)
    radii = (packed.reals_a[RADIUS], packed.reals_b[RADIUS])
    level = dot(n, jets[side][0])
    sign = 1.0 if side == 0 else -1.0
    R, origin = read_rotation(motion, POSE_A), read_vector(motion, POSE_A + 9)
    lost = 0.0
    for k in range(count):
        x = add(rotate(placed.R, read_vector(system.numbers, at + 3 * k)), placed.p)
        depth = radii[0] + radii[1] - sign * (dot(n, x) - level)
        if depth > 0.0:
            # the middle between the swept plane and the ball about the corner
            middle = axpy(sign * (0.5 * depth - radii[1 - side]), n, x)
            point = add(rotate(R, middle), origin)
            spot = Spot(point, depth, 1.0)
            lost += press(system, pair, rows, first, motion, rotate(R, n), spot, scratch)
    return lost


@kernel
def slides(system, pair, motion, n):
    """Is B's slip against A, at its origin, faster than what friction holds?"""
    velocity = velocity_between(motion, read_vector(motion, POSE_B + 9))
    slip = norm(axpy(-dot(n, velocity), n, velocity))
    return slip > system.numbers[pair_numbers(system, pair) + P_SLIP]


@kernel
def touch_pair(system, packed, pair, witness, rows, first, motion, scratch):
    """Add a pair's contact to its bodies' loads; returns the power that it loses.

    `rows[first]` are the bodies, whose twists stand in `motion` too.
    """
    clear_touch(scratch, pair)
    jet_a, jet_b = pair_jets(packed, witness.pose, witness.place)
    n = witness.normal
    radii = (packed.reals_a[RADIUS], packed.reals_b[RADIUS])
    depth = radii[0] + radii[1] - dot(n, sub(jet_b[0], jet_a[0]))
    if not depth > 0.0:
        return 0.0
    if plane_of(system, pair) >= 0:
        return touch_corners(system, packed, pair, witness, rows, first, motion, scratch)
    R, origin = read_rotation(motion, POSE_A), read_vector(motion, POSE_A + 9)
    world_n = rotate(R, n)
    heights = (dot(n, jet_a[0]), -dot(n, jet_b[0]))
    shared = flat_spots(system, pair, witness.pose, n, heights, scratch.spots)
    even = even_of(shared)
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
    if even > 0.0 and (even < 1.0 or (shared.cut and slides(system, pair, motion, world_n))):
        flats = Flats(moving_pair(motion), n, jet_a[0], jet_b[0], radii)
        k, h = material_of(system, pair).stiffness, system.numbers[STEP]
        given = shared_a_second(system, pair, k, shared, flats, h, scratch.spots)
        scratch.loads[shared_row(system)] += given
    return lost
