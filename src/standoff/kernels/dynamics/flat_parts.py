"""The flat part of a body that faces a contact: a plane, an area, a segment, or nothing.

A body's flat faces, its vertices and its round rims are listed when the system is packed. What is
highest along the normal decides: a face that lies nearly square to it; else the two highest of
vertices and rims, if they are nearly level, which are the ends of an edge or of a ruling.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

from standoff.kernels.algebra.rigid import read_vector
from standoff.kernels.algebra.vectors import add, axpy, dot, norm, rotate, rotate_back, sub
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.dynamics.arrays import B_FLATS, body_ints
from standoff.kernels.tolerances import FLAT_TILT
from standoff.kernels.values import ORIGIN, Vector

NOTHING, SEGMENT, AREA, PLANE = range(4)
# Corners of one area; a rim is a polygon of RIM_CORNERS.
MAX_SPOTS = 32

# Of a body among the integers: how many flat faces, vertices and rims, where the numbers of the
# last two stand, and its kind; then for each face how many corners (0: a half-space) and where its
# numbers stand: outward normal, a point, corners in order.
F_FACES, F_TIPS, F_RIMS, F_TIP_REALS, F_RIM_REALS, F_KIND = range(6)
FLAT_HEADER = 6
# Kinds of bodies, of which a half-space and a body of flat faces meet vertex by vertex.
CURVED, POLYTOPE, HALFSPACE = range(3)
FLAT_FACE = 2
FACE_REALS = 6
# A rim's numbers: centre and two conjugate half axes of the ellipse.
RIM_REALS = 9


class Flat(NamedTuple):
    """A flat part, in A's frame."""

    kind: int
    count: int  # of its corners
    at: int  # where they stand in the scratch
    point: Vector  # on it
    along: Vector  # a plane's outward normal; from end to end of a segment
    tilt: float  # radians off the contact's normal


class Placed(NamedTuple):
    """A body of a system and its pose in A's frame."""

    body: int
    R: tuple[float, ...]
    p: Vector


class Tips(NamedTuple):
    """The two highest of a body's vertices and rims, body frame."""

    first: Vector
    height: float
    second: Vector
    lower: float


@kernel
def into_frame(placed, x):
    return add(rotate(placed.R, x), placed.p)


@kernel
def flattest_face(system, flats, m):
    """(number, cosine) of the flat face whose normal is nearest to m; (-1, -1) without any."""
    best, cosine = -1, -1.0
    for k in range(system.layout[flats + F_FACES]):
        o = system.layout[flats + FLAT_HEADER + FLAT_FACE * k + 1]
        c = dot(read_vector(system.numbers, o), m)
        if c > cosine:
            best, cosine = k, c
    return best, cosine


@kernel
def raised(tips, x, m):
    """The two highest tips, one more considered."""
    h = dot(x, m)
    if h > tips.height:
        return Tips(x, h, tips.first, tips.height)
    if h > tips.lower:
        return Tips(tips.first, tips.height, x, h)
    return tips


@kernel
def highest_tips(system, flats, m):
    """The two highest of the vertices and of the rims' highest points along m, body frame."""
    tips = Tips(ORIGIN, -1e300, ORIGIN, -1e300)
    o = system.layout[flats + F_TIP_REALS]
    for k in range(system.layout[flats + F_TIPS]):
        tips = raised(tips, read_vector(system.numbers, o + 3 * k), m)
    o = system.layout[flats + F_RIM_REALS]
    for k in range(system.layout[flats + F_RIMS]):
        i = o + RIM_REALS * k
        e, f = read_vector(system.numbers, i + 3), read_vector(system.numbers, i + 6)
        a, b = dot(e, m), dot(f, m)
        radius = sqrt(a * a + b * b)
        x = read_vector(system.numbers, i)
        if radius > 0.0:
            x = axpy(a / radius, e, axpy(b / radius, f, x))
        tips = raised(tips, x, m)
    return tips


@kernel
def put_corner(points, o, k, x):
    for i in range(3):
        points[o + 3 * k + i] = x[i]


@kernel
def flat_part(system, placed, direction, top, points, o):
    """The flat part of a body that is highest along a direction out of it (A's frame), its corners
    written to points[o]; `top` is the height of the witness point.
    """
    m = rotate_back(placed.R, direction)
    flats = system.layout[body_ints(placed.body) + B_FLATS]
    face, cosine = flattest_face(system, flats, m)
    # 1 - cos t is t²/2, as near as is needed
    if face >= 0 and 1.0 - cosine < 0.5 * FLAT_TILT * FLAT_TILT:
        row = flats + FLAT_HEADER + FLAT_FACE * face
        count, at = system.layout[row], system.layout[row + 1]
        normal = rotate(placed.R, read_vector(system.numbers, at))
        point = into_frame(placed, read_vector(system.numbers, at + 3))
        for k in range(count):
            corner = read_vector(system.numbers, at + FACE_REALS + 3 * k)
            put_corner(points, o, k, into_frame(placed, corner))
        tilt = norm(sub(normal, direction))
        return Flat(PLANE if count == 0 else AREA, count, o, point, normal, tilt)
    nothing = Flat(NOTHING, 0, o, ORIGIN, ORIGIN, 0.0)
    if system.layout[flats + F_TIPS] + system.layout[flats + F_RIMS] < 2:
        return nothing
    tips = highest_tips(system, flats, m)
    first, second = into_frame(placed, tips.first), into_frame(placed, tips.second)
    along = sub(second, first)
    length = norm(along)
    # roundoff lets the witness point stand a little below
    tilt = (max(top, dot(first, direction)) - dot(second, direction)) / length
    if not tilt < FLAT_TILT:
        return nothing
    put_corner(points, o, 0, first)
    put_corner(points, o, 1, second)
    return Flat(SEGMENT, 2, o, first, along, tilt)
