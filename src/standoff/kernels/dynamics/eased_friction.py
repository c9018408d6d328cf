"""How strong friction may be in a tick: it stops a slip, and throws nothing back.

Below the slip speed friction is viscous, by ``grip`` of force a slip speed at each spot. All spots
of a body slow its slip by at most ``slowed``, the sum over them of grip times the inverse of the
mass that a push across the normal moves there; at spots between two bodies that move it counts
twice, as both may slip against each other. A step that holds its forces gives the slip energy where
``h slowed > 2``: under a load of other bodies, or in an impact. There a second pass takes a part of
the friction, so that the slip does not grow, and ends within a tick from ``h slowed = 4`` on.
Nearer the limit the part is more, and at the limit it is all, so that nothing jumps.
"""

from standoff.kernels.algebra.frames import frame_across
from standoff.kernels.algebra.rigid import read_rotation, read_vector
from standoff.kernels.algebra.vectors import cross, dot, rotate, rotate_back, sub
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.dynamics.arrays import (
    B_INVERSE,
    B_MASS,
    E_PART,
    E_SLOWED,
    FREE,
    N_BODY,
    STEP,
    X_CENTRE,
    X_ROTATION,
    bodies_of,
    body_numbers,
    eased_row,
    kind_of,
    n_bodies,
)

# h slowed from which on a slip that is held over a step grows, and where it ends within one.
GROWS, ENDS = 2.0, 1.0


@kernel
def begin_friction(system, loads):
    """All of it, as long as nothing is known of a tick."""
    for body in range(n_bodies(system)):
        o = eased_row(system, body)
        loads[o + E_SLOWED], loads[o + E_PART] = 0.0, 1.0


@kernel
def part_between(system, loads, a, b):
    """The part of friction that is taken between two bodies."""
    return min(loads[eased_row(system, a) + E_PART], loads[eased_row(system, b) + E_PART])


@kernel
def give_across(system, body, rows, o, point, n):
    """A bound on the inverse of the mass that a push across n at a point of a free body moves."""
    R = read_rotation(rows, o + X_ROTATION)
    arm = sub(point, read_vector(rows, o + X_CENTRE))
    inverse = read_rotation(system.numbers, body_numbers(body) + B_INVERSE)
    frame = frame_across(n)
    # one of both directions has at least 1/mass: the other has at most what is left
    total = 1.0 / system.numbers[body_numbers(body) + B_MASS]
    for across in (frame.e, frame.f):
        turn = rotate_back(R, cross(arm, across))
        total += dot(turn, rotate(inverse, turn))
    return total


@kernel
def book_grip(system, pair, rows, first, point, n, grip, loads):
    """Add what the friction of a spot slows both bodies by."""
    a, b = bodies_of(system, pair)
    free_a, free_b = kind_of(system, a) == FREE, kind_of(system, b) == FREE
    each = 2.0 * grip if free_a and free_b else grip
    for body, free in ((a, free_a), (b, free_b)):
        if free:
            give = give_across(system, body, rows, first + N_BODY * body, point, n)
            loads[eased_row(system, body) + E_SLOWED] += each * give


@kernel
def ease_friction(system, loads):
    """Choose the part of friction that each body bears; is it less than all of any?"""
    h, eased = system.numbers[STEP], False
    for body in range(n_bodies(system)):
        o = eased_row(system, body)
        slowed = h * loads[o + E_SLOWED]
        loads[o + E_PART] = 1.0
        if slowed > GROWS:
            loads[o + E_PART] = max(ENDS, GROWS * GROWS / slowed) / slowed
            eased = True
    return eased
