"""How a block of rows lies in memory: one array a number, so that a vector holds neighbours."""

from standoff.kernels.body import layout as L
from standoff.kernels.compiler.decorators import small
from standoff.kernels.values import Pair, Pose

ROWS = 32  # of a block, a multiple of any vector's length: no row is left over
N_VECTOR, N_POSE = 3 * ROWS, 12 * ROWS  # of a vector's and a pose's lanes

BOUNDED = (0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0)
"""The header of a bounded body's ints, as far as the certificate reads it: `L.UNBOUNDED` is 0."""


@small
def lane(k, row):
    """Where the k-th number of a row stands."""
    return ROWS * k + row


@small
def strided(k, width, row):
    """`lane` of `width` rows side by side."""
    return width * k + row


@small
def put_strided(x, block, k, width, row):
    """`put_vector` of `width` rows side by side."""
    for i in range(3):
        block[strided(k + i, width, row)] = x[i]


@small
def vector_of(block, k, row):
    """Three numbers of a row, the k-th and those behind it."""
    return block[lane(k, row)], block[lane(k + 1, row)], block[lane(k + 2, row)]


@small
def put_vector(x, block, k, row):
    for i in range(3):
        block[lane(k + i, row)] = x[i]


@small
def six_of(block, k, row):
    """Six numbers of a row, the k-th and those behind it."""
    x, y, z = vector_of(block, k, row)
    u, v, w = vector_of(block, k + 3, row)
    return x, y, z, u, v, w


@small
def nine_of(block, k, row):
    """Nine numbers of a row, the k-th and those behind it."""
    x, y, z, u, v, w = six_of(block, k, row)
    r, s, t = vector_of(block, k + 6, row)
    return x, y, z, u, v, w, r, s, t


@small
def twelve_at(block, k, row):
    """Twelve numbers of a row, the k-th and those behind it."""
    a, b, c, d, e, f = six_of(block, k, row)
    g, h, i, j, m, n = six_of(block, k + 6, row)
    return a, b, c, d, e, f, g, h, i, j, m, n


@small
def twelve_of(block, row):
    """The first twelve numbers of a row."""
    return twelve_at(block, 0, row)


@small
def put_header(reals, block, k, row):
    """Put the header of a body's reals into lanes, from the k-th on."""
    for i in range(L.REAL_HEADER):
        block[lane(k + i, row)] = reals[i]


@small
def header_at(block, k, row):
    """The header of a row's body, which lies from the k-th lane on."""
    a, b, c, d, e, f, g, h, i = nine_of(block, k, row)
    return a, b, c, d, e, f, g, h, i, block[lane(k + 9, row)]


@small
def bounded_pair(a, b, k, row):
    """Both bodies of a row, of which no more than the headers is known: from the k-th lane on."""
    return Pair(BOUNDED, header_at(a, k, row), BOUNDED, header_at(b, k, row))


@small
def pose_of(block, row):
    m = twelve_of(block, row)
    return Pose((m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8]), (m[9], m[10], m[11]))


@small
def put_pose(pose, block, row):
    for i in range(9):
        block[lane(i, row)] = pose.R[i]
    put_vector(pose.p, block, 9, row)
