"""A rigid body: its state read, its rates, and a step of it on the group of motions.

A stage turns the body by the exponential of a rotation vector f, and f's own rate is J_r(f)⁻¹ w, so
a Runge-Kutta method keeps its order and a rotation stays one (Munthe-Kaas, Appl. Numer. Math. 29,
1999).
"""

from standoff.kernels.algebra.rigid import (
    exp_rotation,
    read_rotation,
    read_vector,
    right_jacobian_inverse,
)
from standoff.kernels.algebra.vectors import (
    add,
    axpy,
    compose,
    compose_back,
    cross,
    dot,
    rotate,
    rotate_back,
    scale,
    sub,
)
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.dynamics.arrays import (
    B_CENTRE,
    B_INVERSE,
    B_MASS,
    FREE,
    GRAVITY,
    N_BODY,
    N_LOAD,
    R_PUSH,
    R_SPEED,
    R_TORQUE,
    R_TURN,
    X_CENTRE,
    X_ROTATION,
    X_SPIN,
    X_VELOCITY,
    body_numbers,
    kind_of,
)


@kernel
def put(values, to, o):
    for k in range(len(values)):
        to[o + k] = values[k]


@kernel
def spin_in_body(system, body, R, momentum):
    """The angular velocity in the body's axes that an angular momentum (world) is."""
    inverse = read_rotation(system.numbers, body_numbers(body) + B_INVERSE)
    return rotate(inverse, rotate_back(R, momentum))


@kernel
def pose_and_twist(system, body, rows, o):
    """(R, p, v, w): pose of the body's frame and the twist of its origin, world, of its row."""
    R, x = read_rotation(rows, o + X_ROTATION), read_vector(rows, o + X_CENTRE)
    v, w = read_vector(rows, o + X_VELOCITY), read_vector(rows, o + X_SPIN)
    if kind_of(system, body) == FREE:
        w = rotate(R, spin_in_body(system, body, R, w))
    arm = rotate(R, read_vector(system.numbers, body_numbers(body) + B_CENTRE))
    return R, sub(x, arm), sub(v, cross(w, arm)), w


@kernel
def orthonormal(R):
    """R with its rows brought back to unit length and right angles: R (3 - RᵀR)/2, the last step of
    Newton's method for the nearest rotation. It moves R by its roundoff alone.
    """
    G = compose_back(R, R)
    half = (
        1.5 - 0.5 * G[0],
        -0.5 * G[1],
        -0.5 * G[2],
        -0.5 * G[3],
        1.5 - 0.5 * G[4],
        -0.5 * G[5],
        -0.5 * G[6],
        -0.5 * G[7],
        1.5 - 0.5 * G[8],
    )
    return compose(R, half)


@kernel
def stand(rows, o, to, q):
    """A body that does not move by itself."""
    for k in range(N_BODY):
        to[q + k] = rows[o + k]


@kernel
def along_rates(rows, o, s, rates, r, to, q):
    """A body's row a time s farther along its rates."""
    R = read_rotation(rows, o + X_ROTATION)
    turned = compose(R, exp_rotation(scale(s, read_vector(rates, r + R_TURN))))
    put(turned, to, q + X_ROTATION)
    for part, rate in ((X_CENTRE, R_SPEED), (X_VELOCITY, R_PUSH), (X_SPIN, R_TORQUE)):
        put(axpy(s, read_vector(rates, r + rate), read_vector(rows, o + part)), to, q + part)


@kernel
def write_rates(system, body, rows, o, turned, loads, rates, r):
    """Rates of a free body at a stage that its start was turned to by the rotation vector `turned`
    (body axes).
    """
    if kind_of(system, body) != FREE:
        for k in range(R_TORQUE + 3):
            rates[r + k] = 0.0
        return
    R = read_rotation(rows, o + X_ROTATION)
    w = spin_in_body(system, body, R, read_vector(rows, o + X_SPIN))
    put(right_jacobian_inverse(turned, w), rates, r + R_TURN)
    put(read_vector(rows, o + X_VELOCITY), rates, r + R_SPEED)
    force = read_vector(loads, N_LOAD * body)
    mass = system.numbers[body_numbers(body) + B_MASS]
    gravity = read_vector(system.numbers, GRAVITY)
    put(axpy(1.0 / mass, force, gravity), rates, r + R_PUSH)
    put(read_vector(loads, N_LOAD * body + 3), rates, r + R_TORQUE)


@kernel
def step_semi_implicit(system, body, rows, o, h, rates, r, to):
    """Momentum first, by the loads at the start; then the pose by the new momentum, the turn by its
    middle: without loads that is the midpoint rule.
    """
    R = read_rotation(rows, o + X_ROTATION)
    v = axpy(h, read_vector(rates, r + R_PUSH), read_vector(rows, o + X_VELOCITY))
    momentum = axpy(h, read_vector(rates, r + R_TORQUE), read_vector(rows, o + X_SPIN))
    halfway = scale(0.5 * h, spin_in_body(system, body, R, momentum))
    w = spin_in_body(system, body, compose(R, exp_rotation(halfway)), momentum)
    put(compose(R, exp_rotation(scale(h, w))), to, o + X_ROTATION)
    put(axpy(h, v, read_vector(rows, o + X_CENTRE)), to, o + X_CENTRE)
    put(v, to, o + X_VELOCITY)
    put(momentum, to, o + X_SPIN)


@kernel
def load(system, body, rows, o, point, force, loads):
    """Add a force (world) at a point (world) to a body's loads."""
    arm = sub(point, read_vector(rows, o + X_CENTRE))
    put(add(read_vector(loads, N_LOAD * body), force), loads, N_LOAD * body)
    turning = add(read_vector(loads, N_LOAD * body + 3), cross(arm, force))
    put(turning, loads, N_LOAD * body + 3)


@kernel
def power(body, rows, o, loads):
    """What the loads of a body that moves by itself give it a second."""
    force, torque = read_vector(loads, N_LOAD * body), read_vector(loads, N_LOAD * body + 3)
    return dot(force, read_vector(rows, o + X_VELOCITY)) + dot(
        torque, read_vector(rows, o + X_SPIN)
    )


@kernel
def kinetic(system, body, rows, o):
    """Kinetic energy of a free body."""
    R, v = read_rotation(rows, o + X_ROTATION), read_vector(rows, o + X_VELOCITY)
    momentum = read_vector(rows, o + X_SPIN)
    w = rotate(R, spin_in_body(system, body, R, momentum))
    mass = system.numbers[body_numbers(body) + B_MASS]
    return 0.5 * mass * dot(v, v) + 0.5 * dot(w, momentum)


@kernel
def potential(system, body, rows, o):
    """Energy of a free body in the field of gravity, from the world's origin."""
    gravity = read_vector(system.numbers, GRAVITY)
    return -system.numbers[body_numbers(body) + B_MASS] * dot(
        gravity, read_vector(rows, o + X_CENTRE)
    )
