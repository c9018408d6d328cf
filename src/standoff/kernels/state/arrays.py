"""One frame's arrays: its motion, the tracker's state, options and answer, and checks of its poses.

Everything in the state is in A's frame; the answer is in world axes. Poses come as 12 numbers
(R row-major, p), twists as 6 (v, omega), both in world.
"""

from math import inf

from standoff.kernels.algebra.rigid import read_vector
from standoff.kernels.algebra.vectors import cross, dot
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.pair.events import EVENT_COLUMNS, MAX_EVENTS, N_COUNTS
from standoff.kernels.pair.polytope_layout import N_POLYTOPE
from standoff.kernels.tolerances import FARTHEST, PLANE_TILT, ROTATION

# State.
# What is given of a frame: both poses, both twists.
POSE_A, POSE_B, TWIST_A, TWIST_B = 0, 12, 24, 30
N_MOTION = 36

# The state.
MODE = 0  # feature_a, chart_a, feature_b, chart_b
Q = 4  # u, v, r, s
RATE = 8  # feedforward w_ff of this frame, or the secant's
LAST_RATE = 12  # that of the frame before
LAST_STEP = 16  # time from the frame before to this one
HISTORY = 17  # how many of RATE, LAST_RATE are valid
POSE = 18  # R (9, row-major), p (3)
TWIST = 30  # v, w
HAS_TWIST = 36  # 1 where RATE is a feedforward, 0 where it is a secant
TIME = 37
LOST = 38  # 1 where the last frame had no certified witness points: start globally
ERRORS = 39  # projection errors, integrated beside the parameters (Fig. 3 of the paper)
INTEGRAL = 43  # time integral of the projection errors (PI feedback)
GAIN = 47  # K of the last stage, 1/s
LAST_NORMAL = 48  # unit, from A to B
LAST_DISTANCE = 51  # of the cores, signed
INSIDE = 52  # 1 where the last frame was solved in contact: this one begins there
LAST_BOUND = 53  # lower bound of the cores' signed distance
CUT = 54  # how many frames in a row ran out of evaluations, this one included
SKIPPED = 55  # time since the frame of this state, s: of frames in which a bound was enough
N_STATE = 56

# Options.
LAW_PC, LAW_PAPER, LAW_CARRIED = range(3)  # the last: integrated with the bodies
PREDICT_NONE, PREDICT_SECANT, PREDICT_FEEDFORWARD, PREDICT_FEEDFORWARD_2 = range(4)
O_LAW, O_PREDICTOR, O_INTEGRATOR, O_GAIN, O_TOLERANCE = range(5)
# The rest is for the paper's law: its feedback and the variants that the paper prints.
O_FEEDBACK, O_REALISATION, O_SATURATION, O_SWITCHING, O_SOLVE = range(5, 10)
O_DEPTH = 10  # which depth is followed in penetration
O_DEADLINE = 11  # most second-order evaluations a frame
O_RESET = 12  # of the Voronoi tests: where an edge is entered
O_RESTARTS = 13  # 0: no global start in a frame, whatever the certificate says
O_FAR_SIDE = 14  # of the Voronoi tests: what a face does with a point behind it
O_WITHIN = 15  # beyond this distance a proven bound is enough (length)
O_DATA = 16  # what the feedback needs
O_SMOOTH = O_DATA + 16  # address of the frame that is tried first (entries.smooth); 0: none
O_FRAME = O_SMOOTH + 1  # address of the law's own frame (entries.laws, paper_laws); 0: none
N_OPTIONS = O_FRAME + 1
FEEDBACK_LINEAR, FEEDBACK_MATRIX, FEEDBACK_PI, FEEDBACK_POWER, FEEDBACK_MOTION = range(5)
EVALUATED, INTEGRATED = 0, 1
SATURATE_HOLD, SATURATE_ZERO = 0, 1
SWITCH_MULTIPLIERS, SWITCH_VORONOI, SWITCH_NONE = range(3)
SOLVE_RANKED, SOLVE_PLAIN, SOLVE_COVARIANT = range(3)
RESET_FOOT, RESET_NEAREST = 0, 1
FAR_SIDE_LEFT, FAR_SIDE_KEPT = 0, 1
DEPTH_GLOBAL, DEPTH_LOCAL = 0, 1

# Output.
DISTANCE, LOWER_BOUND = 0, 1
POINT_A, POINT_B, NORMAL = 2, 5, 8
OUT_MODE, OUT_Q = 11, 15
OUT_RATE, VELOCITY_A, VELOCITY_B, RESIDUAL, STATUS = 19, 20, 23, 26, 27
UPPER_BOUND = 28
OUT_COUNTS = 29
N_OUT = OUT_COUNTS + N_COUNTS

# One block of memory holds a frame: its answer, the state after it, what was given (the motion,
# the time since the frame before, 1 where twists are given), where its polytope begins (0: it has
# none), what came of a frame in place, the switches, and the polytope.
BLOCK_STATE = N_OUT
BLOCK_MOTION = BLOCK_STATE + N_STATE
BLOCK_TIME_STEP = BLOCK_MOTION + N_MOTION
BLOCK_HAS_TWIST = BLOCK_TIME_STEP + 1
BLOCK_POLYTOPE = BLOCK_HAS_TWIST + 1
BLOCK_DONE = BLOCK_POLYTOPE + 1
BLOCK_EVENTS = BLOCK_DONE + 1
KEPT_EVENTS = 4  # of a frame that is a value: one with more is made anew in a longer block
N_BLOCK = BLOCK_EVENTS + EVENT_COLUMNS * KEPT_EVENTS
N_KEEPING_BLOCK = N_BLOCK + N_POLYTOPE  # of a frame that may keep one
FIRST_POLYTOPE = BLOCK_EVENTS + EVENT_COLUMNS * MAX_EVENTS
N_LONG_BLOCK = FIRST_POLYTOPE + N_POLYTOPE

# Status numbers, those of standoff.tracking.Status.
CONVERGED, TRACKING, OVERLAPPING, NOT_CERTIFIED, LOCAL, GLOBAL, DEADLINE = range(7)
NOT_RESTARTED, FAR = 7, 8

# How a start begins.
START_ANYWHERE, START_DESCEND, START_HERE = range(3)

# What a step refuses, with nothing changed.
FINE, BAD_POSE_A, BAD_POSE_B, BAD_TWIST = range(4)
# Of `start_apart`: the bodies may touch, ask `start`. Nothing is changed either.
NOT_KNOWN_APART = 4
# In place of a twist's six numbers: none was given.
NOT_GIVEN = -1.5e308
# Of a step whose arrays are not as they must be, or whose switches the block does not hold.
BAD_ARRAYS, MORE_EVENTS = 5, 6
# A pose that takes a planar body out of z = 0.
OUT_OF_PLANE = 7


@kernel
def is_pose(T):
    """A pose: rotation orthonormal to ROTATION and not mirrored, position below FARTHEST."""
    for i in range(3):
        for j in range(i, 3):
            total = 0.0
            for k in range(3):
                total += T[3 * i + k] * T[3 * j + k]
            if not abs(total - (1.0 if i == j else 0.0)) <= ROTATION:
                return False
    third = cross(read_vector(T, 0), read_vector(T, 3))
    far = abs(T[9]) + abs(T[10]) + abs(T[11])
    return dot(third, read_vector(T, 6)) > 0.0 and far < FARTHEST


@kernel
def in_plane(T):
    """Does a pose keep a planar body in z = 0?"""
    tilt = max(max(abs(T[2]), abs(T[5])), max(abs(T[6]), abs(T[7])))
    return tilt <= PLANE_TILT and T[11] == 0.0 and T[8] >= 0.0


@kernel
def refusal(planar, Ta, Tb, xi_a, xi_b):
    """FINE, or which of the poses and twists is refused."""
    if not is_pose(Ta):
        return BAD_POSE_A
    if not is_pose(Tb):
        return BAD_POSE_B
    if planar and not (in_plane(Ta) and in_plane(Tb)):
        return OUT_OF_PLANE
    total = 0.0
    for k in range(6):
        total += abs(xi_a[k]) + abs(xi_b[k])
    return FINE if total < inf else BAD_TWIST
