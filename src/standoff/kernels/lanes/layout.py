"""How a block of rows lies in memory: one array a number, so that a vector holds neighbours."""

from standoff.kernels.compiler.decorators import small
from standoff.kernels.values import Pose

ROWS = 32  # of a block, a multiple of any vector's length: no row is left over
N_VECTOR, N_POSE = 3 * ROWS, 12 * ROWS  # of a vector's and a pose's lanes


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
def twelve_of(block, row):
    """The first twelve numbers of a row."""
    return (
        block[lane(0, row)], block[lane(1, row)], block[lane(2, row)], block[lane(3, row)],
        block[lane(4, row)], block[lane(5, row)], block[lane(6, row)], block[lane(7, row)],
        block[lane(8, row)], block[lane(9, row)], block[lane(10, row)], block[lane(11, row)],
    )  # fmt: skip


@small
def pose_of(block, row):
    m = twelve_of(block, row)
    return Pose((m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8]), (m[9], m[10], m[11]))


@small
def put_pose(pose, block, row):
    for i in range(9):
        block[lane(i, row)] = pose.R[i]
    put_vector(pose.p, block, 9, row)
