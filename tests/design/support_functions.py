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


def point(n, rounding):
    return rounding


def segment(n, start, end):
    return max(dot(n, start), dot(n, end))


polygon = polytope


def rounded_polytope(n, vertices, rounding):
    """Of a tetrahedron: its faces moved inward by the rounding meet in the core's vertices."""
    centre = [sum(v[k] for v in vertices) / 4 for k in range(3)]
    planes = []
    for k in range(4):
        p, q, r = vertices[:k] + vertices[k + 1 :]
        normal = cross([y - x for x, y in zip(p, q, strict=True)], sub(r, p))
        normal = [x / length(normal) * mp.sign(dot(normal, sub(p, centre))) for x in normal]
        planes.append((normal, dot(normal, p) - rounding))
    core = [
        mp.lu_solve(mp.matrix([m for m, _ in three]), mp.matrix([d for _, d in three]))
        for three in combinations(planes, 3)
    ]
    return max(dot(n, list(v)) for v in core) + rounding


def sub(a, b):
    return [x - y for x, y in zip(a, b, strict=True)]


def cross(a, b):
    return [a[k - 2] * b[k - 1] - a[k - 1] * b[k - 2] for k in range(3)]


def greatest(height, low, high):
    """Of a smooth function of one variable with one maximum inside, which Newton finds."""
    grid = [low + (high - low) * mpf(k) / 64 for k in range(65)]
    best = max(grid, key=height)
    at = mp.findroot(lambda t: mp.diff(height, t), best) if low < best < high else best
    return height(at)


def egg(n, radius, length, taper):
    wide, rho = radius * mp.sqrt(1 - taper**2), mp.hypot(n[0], n[1])

    def height(t):
        s = mp.sin(t)
        return rho * wide * mp.cos(t) / (1 + taper * s) + n[2] * length / 2 * s

    return greatest(height, -mp.pi / 2, mp.pi / 2)


def gore(n, radius, height):
    """Arcs from pole to pole in four half-planes."""
    round_ = (height**2 / 4 + radius**2) / (2 * radius)
    found = height / 2 * abs(n[2])
    for out in (n[0], n[1], -n[0], -n[1]):
        size = mp.hypot(out, n[2])
        if out / size * round_ > round_ - radius:
            found = max(found, round_ * size - (round_ - radius) * out)
    return found


def wheel(n, major, minor, tall):
    """The hull of an ellipse turned about an axis beside it."""
    rho = mp.hypot(n[0], n[1])
    return major * rho + mp.hypot(minor * rho, tall * n[2])


def arch(n, control, weight, depth):
    """A rational parabola in the plane y = 0 and its chord, swept along y."""

    def height(t):
        weights = [(1 - t) ** 2, 2 * t * (1 - t) * weight, t**2]
        heights = [n[0] * x + n[2] * z for x, z in control]
        return dot(weights, heights) / sum(weights)

    return greatest(height, mpf(0), mpf(1)) + depth / 2 * abs(n[1])


def dome(n, height):
    """z = height (1 - x² - y²) / 2 and the disc below it."""
    rho = mp.hypot(n[0], n[1])
    if rho >= height * n[2]:
        return rho
    out = rho / (height * n[2])
    return rho * out + n[2] * height * (1 - out**2) / 2
