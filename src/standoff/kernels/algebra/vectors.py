"""3-vectors as tuples and rotations as row-major 9-tuples: the basics of the kernels."""

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.compiler.decorators import small


@small
def add(a, b):
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@small
def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@small
def scale(s, a):
    return (s * a[0], s * a[1], s * a[2])


@small
def axpy(s, a, b):
    """s a + b."""
    return (s * a[0] + b[0], s * a[1] + b[1], s * a[2] + b[2])


@small
def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@small
def cross(a, b):
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


@small
def active(f):
    """1 where the parameter of tangent column f exists (the column is not zero), else 0."""
    return 1.0 if f[0] != 0.0 or f[1] != 0.0 or f[2] != 0.0 else 0.0


@small
def norm(a):
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


@small
def taxicab(a):
    """|a_0| + |a_1| + |a_2|: at least the length."""
    return abs(a[0]) + abs(a[1]) + abs(a[2])


@small
def unit(a):
    """a / |a|; the zero vector stays zero, so callers test `norm` where it matters."""
    length = norm(a)
    if length == 0.0:
        return (0.0, 0.0, 0.0)
    return (a[0] / length, a[1] / length, a[2] / length)


@small
def rotate(R, a):
    """R a, with R a row-major 9-tuple."""
    return (
        R[0] * a[0] + R[1] * a[1] + R[2] * a[2],
        R[3] * a[0] + R[4] * a[1] + R[5] * a[2],
        R[6] * a[0] + R[7] * a[1] + R[8] * a[2],
    )


@small
def rotate_back(R, a):
    """Rᵀ a."""
    return (
        R[0] * a[0] + R[3] * a[1] + R[6] * a[2],
        R[1] * a[0] + R[4] * a[1] + R[7] * a[2],
        R[2] * a[0] + R[5] * a[1] + R[8] * a[2],
    )


@small
def compose_back(P, Q):
    """Pᵀ Q as a row-major 9-tuple."""
    return (
        P[0] * Q[0] + P[3] * Q[3] + P[6] * Q[6],
        P[0] * Q[1] + P[3] * Q[4] + P[6] * Q[7],
        P[0] * Q[2] + P[3] * Q[5] + P[6] * Q[8],
        P[1] * Q[0] + P[4] * Q[3] + P[7] * Q[6],
        P[1] * Q[1] + P[4] * Q[4] + P[7] * Q[7],
        P[1] * Q[2] + P[4] * Q[5] + P[7] * Q[8],
        P[2] * Q[0] + P[5] * Q[3] + P[8] * Q[6],
        P[2] * Q[1] + P[5] * Q[4] + P[8] * Q[7],
        P[2] * Q[2] + P[5] * Q[5] + P[8] * Q[8],
    )


@small
def compose(P, Q):
    """P Q as a row-major 9-tuple."""
    return (
        P[0] * Q[0] + P[1] * Q[3] + P[2] * Q[6],
        P[0] * Q[1] + P[1] * Q[4] + P[2] * Q[7],
        P[0] * Q[2] + P[1] * Q[5] + P[2] * Q[8],
        P[3] * Q[0] + P[4] * Q[3] + P[5] * Q[6],
        P[3] * Q[1] + P[4] * Q[4] + P[5] * Q[7],
        P[3] * Q[2] + P[4] * Q[5] + P[5] * Q[8],
        P[6] * Q[0] + P[7] * Q[3] + P[8] * Q[6],
        P[6] * Q[1] + P[7] * Q[4] + P[8] * Q[7],
        P[6] * Q[2] + P[7] * Q[5] + P[8] * Q[8],
    )
