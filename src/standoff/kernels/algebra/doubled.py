"""Numbers of twice the digits: sums of two, of which the second is below half a rounding of the
first.

Differences of numbers are exact in them; products and sums of them are good to some 2^-100. They
must not be contracted: a rounding that is left out is not there to be measured.
"""

from standoff.kernels.compiler.decorators import uncontracted

# Times a number, this leaves its upper half: 2^27 + 1, of 53 bits.
HALVING = 134217729.0


@uncontracted
def difference_of(a, b):
    """a - b, exactly."""
    high = a - b
    back = high - a
    return high, (a - (high - back)) - (b + back)


@uncontracted
def product_of(a, b):
    """a b, exactly."""
    high = a * b
    t, s = HALVING * a, HALVING * b
    a_high, b_high = t - (t - a), s - (s - b)
    a_low, b_low = a - a_high, b - b_high
    low = ((a_high * b_high - high) + a_high * b_low + a_low * b_high) + a_low * b_low
    return high, low


@uncontracted
def renewed(high, low):
    """The same sum, its second part below half a rounding of the first; |high| >= |low|."""
    total = high + low
    return total, low - (total - high)


@uncontracted
def minus(x, y):
    """x - y."""
    high, low = difference_of(x[0], y[0])
    rest, lowest = difference_of(x[1], y[1])
    high, low = renewed(high, low + rest)
    return renewed(high, low + lowest)


@uncontracted
def times(x, y):
    """x y."""
    high, low = product_of(x[0], y[0])
    return renewed(high, low + (x[0] * y[1] + x[1] * y[0]))


@uncontracted
def step_between(a, b):
    """b - a of two points, exactly."""
    return (
        difference_of(b[0], a[0]),
        difference_of(b[1], a[1]),
        difference_of(b[2], a[2]),
    )


@uncontracted
def doubled_cross(u, v):
    """u x v."""
    return (
        minus(times(u[1], v[2]), times(u[2], v[1])),
        minus(times(u[2], v[0]), times(u[0], v[2])),
        minus(times(u[0], v[1]), times(u[1], v[0])),
    )


@uncontracted
def doubled_dot(u, v):
    """u.v, rounded once."""
    x, y, z = times(u[0], v[0]), times(u[1], v[1]), times(u[2], v[2])
    total = minus(minus(x, (-y[0], -y[1])), (-z[0], -z[1]))
    return total[0] + total[1]


@uncontracted
def doubled(a):
    """A point as it is."""
    return (a[0], 0.0), (a[1], 0.0), (a[2], 0.0)


@uncontracted
def nearest_of_each(u):
    """A vector, rounded."""
    return u[0][0], u[1][0], u[2][0]
