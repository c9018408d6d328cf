"""The pairs of points that a patch may be made of, each once."""

from math import cos, inf, pi, sin

from standoff.kernels.compiler.decorators import kernel, reals_on_stack

# Of a pair: where it is across the normal, how much wider its gap is, and both points in A's frame.
X, Y, WIDER, POINT_A, POINT_B, PLACE_REALS = 0, 1, 2, 3, 6, 9
# One more than these, for the witness points themselves.
MOST_PLACES = 256
ALL_PLACES = PLACE_REALS * (MOST_PLACES + 1)
# Where there are more, those that reach farthest in so many directions are gone on with.
WAYS = 64


@kernel
def copy_place(places, k, to):
    for j in range(PLACE_REALS):
        places[PLACE_REALS * to + j] = places[PLACE_REALS * k + j]


@kernel
def thinned(places, n):
    """Keep the places that reach farthest all round; how many."""
    kept = reals_on_stack(MOST_PLACES)
    for k in range(n):
        kept[k] = 0.0
    for i in range(WAYS):
        cx, cy = cos(2.0 * pi * i / WAYS), sin(2.0 * pi * i / WAYS)
        most, at = -inf, 0
        for k in range(n):
            o = PLACE_REALS * k
            reach = cx * places[o + X] + cy * places[o + Y]
            if reach > most:
                most, at = reach, k
        kept[at] = 1.0
    count = 0
    for k in range(n):
        if kept[k] != 0.0:
            copy_place(places, k, count)
            count += 1
    return count


@kernel
def put_place(places, n, spot, x, y, near):
    """Put a pair, `spot` its (across e, across f, how much wider); how many there are then. Of
    those at one spot the nearest stays: under it the others are hidden; of those that are as near
    the first, as a crossing at an edge's end is a vertex."""
    for k in range(n):
        o = PLACE_REALS * k
        if abs(places[o + X] - spot[0]) + abs(places[o + Y] - spot[1]) <= near:
            if places[o + WIDER] <= spot[2] + near:
                return n
            write_place(places, k, spot, x, y)
            return n
    if n == MOST_PLACES:
        n = thinned(places, n)
    write_place(places, n, spot, x, y)
    return n + 1


@kernel
def write_place(places, k, spot, x, y):
    o = PLACE_REALS * k
    for j in range(3):
        places[o + j], places[o + POINT_A + j], places[o + POINT_B + j] = spot[j], x[j], y[j]
