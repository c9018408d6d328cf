"""Support functions of shapes in 50 digits, written from their definitions: the oracle of
`test_shape_gradient`. Each takes a unit vector of mpf numbers and the parameters by name."""

from itertools import combinations

from mpmath import mp, mpf


def dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def length(a):
    return mp.sqrt(dot(a, a))


def ellipsoid(n, semi_axes):
    return length([a * x for a, x in zip(semi_axes, n, strict=True)])


def sphere(n, radius):
    return radius


def capsule(n, radius, length):
    return radius + length / 2 * abs(n[2])


def cylinder(n, radius, height):
    return radius * mp.hypot(n[0], n[1]) + height / 2 * abs(n[2])


def cone(n, radius, height):
    return max(height / 2 * n[2], radius * mp.hypot(n[0], n[1]) - height / 2 * n[2])


def box(n, size, rounding):
    return sum((s / 2 - rounding) * abs(x) for s, x in zip(size, n, strict=True)) + rounding


def polytope(n, vertices):
    return max(dot(n, v) for v in vertices)


def cap(n, radius, offset):
    if n[2] * radius >= offset:
        return radius
    rim = mp.sqrt(radius**2 - offset**2)
    return offset * n[2] + rim * mp.hypot(n[0], n[1])


def lens(n, radius, offset):
    """Of three balls: the first of faces, edges and vertices whose farthest point is in all."""
    angles = [mp.pi, 5 * mp.pi / 3, mp.pi / 3]
    centres = [[offset * mp.cos(t), offset * mp.sin(t), mpf(0)] for t in angles]

    def inside(x):
        return all(
            length([p - q for p, q in zip(x, c, strict=True)]) < radius * (1 + mpf(10) ** -30)
            for c in centres
        )

    for c in centres:
        x = [q + radius * k for q, k in zip(c, n, strict=True)]
        if inside(x):
            return dot(n, x)
    for c, d in combinations(centres, 2):
        u = [q - p for p, q in zip(c, d, strict=True)]
        across = [x / length(u) for x in u]
        circle = mp.sqrt(radius**2 - dot(u, u) / 4)
        flat = [x - dot(n, across) * y for x, y in zip(n, across, strict=True)]
        x = [(p + q) / 2 + circle * k / length(flat) for p, q, k in zip(c, d, flat, strict=True)]
        if inside(x):
            return dot(n, x)
    return abs(n[2]) * mp.sqrt(radius**2 - offset**2)


def spindle(n, radius, length):
    """An arc turned about its chord, the axis."""
    round_ = (length**2 / 4 + radius**2) / (2 * radius)
    rho = mp.hypot(n[0], n[1])
    if abs(n[2]) * round_ < length / 2:
        return round_ - (round_ - radius) * rho
    return length / 2 * abs(n[2])


def superellipsoid(n, semi_axes, exponents):
    """The dual norm: of an exponent 2/e it is 2/(2 - e)."""
    e1, e2 = exponents
    q1, q2 = 2 / (2 - e1), 2 / (2 - e2)
    a, b, c = (abs(s * x) for s, x in zip(semi_axes, n, strict=True))
    return ((a**q2 + b**q2) ** (q1 / q2) + c**q1) ** (1 / q1)
