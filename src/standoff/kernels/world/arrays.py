"""What stands where in the flat arrays of a world.

A world is a list of bodies, each of one or more convex *pieces* with fixed placements. The pieces
of one body have consecutive numbers.
"""

# What is known of a piece, once for all: reals.
F_ROTATION = 0  # placement in the body's frame: R (9, row-major), p (3)
F_SHIFT = 9
F_PLACED = 12  # 0 where the placement is the identity; else PLACED, or LEVEL in a planar world
F_CENTRE = 13  # of the box around the core, piece's frame
F_HALF = 16  # half its sides; 0 for a half-space
F_RADIUS = 19  # swept radius and slack, length
F_REACH = 20  # of the ball about the centre that holds the core
F_PLANE = 21  # 1 for a half-space
F_NORMAL = 22  # its outward normal, piece's frame
F_OFFSET = 25  # along it
F_PLANAR = 26  # 1 for a planar body: it overlaps another in the plane alone
N_FACT = 27

PLACED, LEVEL = 1.0, 2.0

# Where a piece is in one frame: reals.
P_ROTATION = 0  # world pose: R (9, row-major), p (3)
P_SHIFT = 9
P_CENTRE = 12  # world, of the box; of a half-space its normal
P_LOW = 15  # the box around the piece, axes of the world, its radius and roundoff included
P_HIGH = 18  # (infinite for a half-space)
P_PAD = 21  # what roundoff may have done to it, length
P_OFFSET = 22  # of a half-space, along its normal
P_TRAVEL = 23  # no point of the piece has gone farther since the start: a length that only grows
N_PLACED = 24

# What is known of a pair of pieces: reals ...
C_BOUND = 0  # certified lower bound of the signed distance when it was last looked at
C_UPPER = 1  # upper bound then; inf where only boxes were asked
C_TRAVEL = 2  # the two pieces' travel then
C_HORIZON = 3  # beyond it a bound is enough
C_TIME = 4  # at which the kept answer held last, s
N_KNOWN = 5
# ... and integers.
I_KEY = 0  # sorted by it: the pair of bodies, then the pair of pieces
I_A = 1  # pieces
I_B = 2
I_ROW = 3  # among the rows that are kept: -1 for none
I_FRAME = 4  # the last frame in which the answer in that row held
I_STATUS = 5  # of the answer in that row
I_INSIDE = 6  # 1 where it was solved in contact: the next frame may keep a polytope
N_INTS = 7

# What becomes of a pair in a frame.
FAR, RESTING, MOVED, NEW = range(4)


# What is written of a pair that is found.
E_KEY, E_A, E_B = range(3)
N_EMIT = 3
