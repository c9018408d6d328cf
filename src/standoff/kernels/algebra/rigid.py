"""Relative rigid motion: the pair is seen from A's frame, where A is at rest."""

from math import atan2, cos, sin

from standoff.kernels.algebra.roots import sqrt
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
from standoff.kernels.tolerances import SMALL_ANGLE
from standoff.kernels.values import Motion, Pose


@kernel
def read_rotation(T, o):
    """Row-major 9-tuple at T[o]; a pose is stored as 12 numbers (R row-major, p)."""
    return (
        T[o],
        T[o + 1],
        T[o + 2],
        T[o + 3],
        T[o + 4],
        T[o + 5],
        T[o + 6],
        T[o + 7],
        T[o + 8],
    )


@kernel
def read_vector(T, o):
    return (T[o], T[o + 1], T[o + 2])


@kernel
def relative_pose(Ta, Tb):
    """B's pose in A's frame."""
    Ra = read_rotation(Ta, 0)
    shift = sub(read_vector(Tb, 9), read_vector(Ta, 9))
    return Pose(compose_back(Ra, read_rotation(Tb, 0)), rotate_back(Ra, shift))


@kernel
def relative_twist(Ta, Tb, xi_a, xi_b):
    """(v, w) of B's origin in A's frame, relative to A; twists (v, w) in world, 6 numbers each."""
    Ra = read_rotation(Ta, 0)
    arm = sub(read_vector(Tb, 9), read_vector(Ta, 9))
    wa = read_vector(xi_a, 3)
    carried = add(read_vector(xi_a, 0), cross(wa, arm))
    v = sub(read_vector(xi_b, 0), carried)
    return rotate_back(Ra, v), rotate_back(Ra, sub(read_vector(xi_b, 3), wa))


@kernel
def exp_rotation(f):
    """Rotation matrix of the rotation vector f."""
    t2 = dot(f, f)
    t = sqrt(t2)
    if t < SMALL_ANGLE:
        a, b = 1.0 - t2 / 6.0, 0.5 - t2 / 24.0
    else:
        a, b = sin(t) / t, (1.0 - cos(t)) / t2
    x, y, z = f
    return (
        1.0 - b * (y * y + z * z),
        b * x * y - a * z,
        b * x * z + a * y,
        b * x * y + a * z,
        1.0 - b * (x * x + z * z),
        b * y * z - a * x,
        b * x * z - a * y,
        b * y * z + a * x,
        1.0 - b * (x * x + y * y),
    )


@kernel
def scaled_quaternion(R):
    """A multiple of the quaternion (w, x, y, z) of R, by its greatest component."""
    t = R[0] + R[4] + R[8]
    if t > 0.0:
        return (1.0 + t, R[7] - R[5], R[2] - R[6], R[3] - R[1])
    if R[0] >= R[4] and R[0] >= R[8]:
        return (R[7] - R[5], 1.0 + R[0] - R[4] - R[8], R[1] + R[3], R[2] + R[6])
    if R[4] >= R[8]:
        return (R[2] - R[6], R[1] + R[3], 1.0 + R[4] - R[0] - R[8], R[5] + R[7])
    return (R[3] - R[1], R[2] + R[6], R[5] + R[7], 1.0 + R[8] - R[0] - R[4])


@kernel
def unit_quaternion(R):
    """The quaternion (w, x, y, z) of R."""
    w, x, y, z = scaled_quaternion(R)
    s = 1.0 / sqrt(w * w + x * x + y * y + z * z)
    return (s * w, s * x, s * y, s * z)


@kernel
def log_rotation(R):
    """Rotation vector of R, through its quaternion: sound at every angle up to pi."""
    w, x, y, z = scaled_quaternion(R)
    s = sqrt(x * x + y * y + z * z)
    if w < 0.0:
        w, x, y, z = -w, -x, -y, -z
    if s == 0.0:
        return (0.0, 0.0, 0.0)
    angle = 2.0 * atan2(s, w)
    return (angle * x / s, angle * y / s, angle * z / s)


@kernel
def right_jacobian(f, w):
    """J_r(f) w: the body rate of exp(f) when f changes at the rate w."""
    t2 = dot(f, f)
    t = sqrt(t2)
    if t < SMALL_ANGLE:
        a, b = 0.5 - t2 / 24.0, 1.0 / 6.0 - t2 / 120.0
    else:
        a, b = (1.0 - cos(t)) / t2, (t - sin(t)) / (t2 * t)
    c = cross(f, w)
    return axpy(b, cross(f, c), axpy(-a, c, w))


@kernel
def right_jacobian_inverse(f, w):
    """J_r(f)⁻¹ w: the rate of f when exp(f) turns at the body rate w."""
    t2 = dot(f, f)
    t = sqrt(t2)
    b = 1.0 / 12.0 + t2 / 720.0
    if t >= SMALL_ANGLE:
        b = 1.0 / t2 - (1.0 + cos(t)) / (2.0 * t * sin(t))
    c = cross(f, w)
    return axpy(b, cross(f, c), axpy(0.5, c, w))


@kernel
def within_frame(c, before, after, h):
    """The motion at the part c of a frame: cubic Hermite in p and in the rotation vector.

    before and after are those at its ends. The error of the pose is O(h⁴), enough for RK4.
    """
    (R0, p0), v0, w0 = before
    (R1, p1), v1, w1 = after
    # weights of the step, of the first and of the last rate; then those of their derivatives
    a, b0, b1 = c * c * (3.0 - 2.0 * c), c * (1.0 - c) * (1.0 - c) * h, c * c * (c - 1.0) * h
    da, d0, d1 = 6.0 * c * (1.0 - c) / h, (1.0 - c) * (1.0 - 3.0 * c), c * (3.0 * c - 2.0)
    dp = sub(p1, p0)
    p = add(p0, axpy(a, dp, axpy(b0, v0, scale(b1, v1))))
    v = axpy(da, dp, axpy(d0, v0, scale(d1, v1)))
    f1 = log_rotation(compose_back(R0, R1))
    r0 = rotate_back(R0, w0)
    r1 = right_jacobian_inverse(f1, rotate_back(R1, w1))
    f = axpy(a, f1, axpy(b0, r0, scale(b1, r1)))
    rate = axpy(da, f1, axpy(d0, r0, scale(d1, r1)))
    R = compose(R0, exp_rotation(f))
    return Motion(Pose(R, p), v, rotate(R, right_jacobian(f, rate)))


@kernel
def mean_motion(before, pose, h):
    """The motion at a pose, of the constant twist that leads to it in the time h."""
    f = log_rotation(compose_back(before.R, pose.R))
    v = scale(1.0 / h, sub(pose.p, before.p))
    return Motion(pose, v, rotate(before.R, scale(1.0 / h, f)))
