"""Derivatives of one answer or of many, and normals of equal depth."""

from math import inf

from standoff.kernels.algebra.rigid import read_rotation, read_vector, relative_pose
from standoff.kernels.algebra.vectors import rotate_back
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import pair_span
from standoff.kernels.compiler.decorators import (
    ahead,
    entry,
    kernel,
    pointer,
    reals_on_stack,
    stack_counts,
    stack_log,
)
from standoff.kernels.compiler.entry import (
    INT,
    PAIR,
    READ,
    READ_BLOCKS,
    READ_ROWS,
    REAL,
    ROWS,
    VECTOR,
    WRITE,
    WRITE_INTS,
)
from standoff.kernels.depth.rivals import N_STARTS, NOT_ALONE, NOT_KNOWN, alone, equally_deep
from standoff.kernels.entries.blocks import copy_pose, where_kept
from standoff.kernels.entries.frames import clear_counts
from standoff.kernels.entries.pointers import pair_pointers
from standoff.kernels.pair.derivatives import (
    EQUALLY_DEEP,
    NO_DISTANCE,
    SINGULAR_BESIDE,
    differentiate,
)
from standoff.kernels.pair.events import KEEPING, LIMIT, NO_LIMIT
from standoff.kernels.pair.polytope_layout import N_POLYTOPE, N_VERTICES
from standoff.kernels.state.arrays import (
    BLOCK_MOTION,
    DISTANCE,
    N_OUT,
    NORMAL,
    OUT_MODE,
    OUT_Q,
    POSE_A,
    POSE_B,
)
from standoff.kernels.tolerances import TOUCHING_CORES
from standoff.kernels.values import Depth, Place, Work

N_NORMALS = 1 + N_STARTS
N_NUMBERS = 3 * N_NORMALS


@kernel
def place_of(answer):
    """The features and parameters that an answer names."""
    return Place(
        int(answer[OUT_MODE]),
        int(answer[OUT_MODE + 1]),
        int(answer[OUT_MODE + 2]),
        int(answer[OUT_MODE + 3]),
        answer[OUT_Q],
        answer[OUT_Q + 1],
        answer[OUT_Q + 2],
        answer[OUT_Q + 3],
    )


@kernel
def without_limit(work):
    """Work that begins, and ends when it is done; with the polytope in it, if there is one."""
    clear_counts(work)
    work.counts[LIMIT] = NO_LIMIT
    work.counts[KEEPING] = 1 if work.last_polytope[N_VERTICES] > 0.0 else 0
    return work


@kernel
def has_rivals(pair, pose, n, d, place, kept):
    """Are overlapping cores as deep in each other along another normal? `kept` is the polytope of
    the frame that found n, if it kept one.

    Not in a half-space: its plane's normal is the only one along which it can be left.
    """
    if pair.ints_a[L.UNBOUNDED] or pair.ints_b[L.UNBOUNDED]:
        return False
    work = without_limit(Work(stack_counts(), stack_log(), kept, kept))
    known = alone(pair, pose, Depth(True, d, n, place), work)
    if known != NOT_KNOWN:
        return known == NOT_ALONE
    normals = reals_on_stack(N_NUMBERS)
    return equally_deep(pair, pose, n, d, normals, without_limit(work)) > 1


@kernel
def derive_at(pair, pose_a, pose_b, answer, kept, everything, to):
    """Derivatives of an answer at poses (12 numbers) into `to`; what came of it. `kept` is the
    polytope of its frame, if it kept one."""
    d = answer[DISTANCE] + pair.reals_a[L.RADIUS] + pair.reals_b[L.RADIUS]
    if not abs(d) < inf:
        return NO_DISTANCE
    Ra, pose = read_rotation(pose_a, 0), relative_pose(pose_a, pose_b)
    n = read_vector(answer, NORMAL)
    kind = differentiate(pair, Ra, pose, place_of(answer), n, d, everything, to)
    if kind > SINGULAR_BESIDE or d > TOUCHING_CORES * pair_span(pair, pose.p, abs(d)):
        return kind  # nothing is left, or the normal is the only one
    shared = has_rivals(pair, pose, rotate_back(Ra, n), d, place_of(answer), kept)
    return EQUALLY_DEEP if shared else kind


@entry(PAIR, READ, WRITE, work="derivatives")
def derive(pair, block, to):
    """Derivatives of the answer in a block, at the poses in it, into N_DERIVATIVES numbers, or into
    12 for the gradient alone."""
    at = pointer(block, 0)
    motion = ahead(at, BLOCK_MOTION)
    pose_a, pose_b = ahead(motion, POSE_A), ahead(motion, POSE_B)
    first = where_kept(at, len(block))
    none = reals_on_stack(N_POLYTOPE)
    none[N_VERTICES] = 0.0
    kept = ahead(at, first) if first > 0 else none
    return derive_at(pair_pointers(pair), pose_a, pose_b, at, kept, len(to) > 12, pointer(to, 0))


@entry(
    PAIR,
    READ_BLOCKS,
    READ_BLOCKS,
    INT,
    INT,
    READ_ROWS,
    ROWS,
    WRITE_INTS,
    work="derivatives",
)
def derive_many(pair, poses_a, poses_b, first, end, answers, outs, kinds):
    """`derive` of rows `first` to `end` - 1 of answers (n, N_OUT) at poses (n, 4, 4), or (1, 4, 4)
    for all; row k into outs (n, N_DERIVATIVES), or (n, 12) for the gradients alone."""
    pointers = pair_pointers(pair)
    at_a, at_b = poses_a.reshape(poses_a.size), poses_b.reshape(poses_b.size)
    rows, to = answers.reshape(answers.size), outs.reshape(outs.size)
    way_a, way_b, row, out = pointer(at_a, 0), pointer(at_b, 0), pointer(rows, 0), pointer(to, 0)
    one_a, one_b = len(poses_a) == 1, len(poses_b) == 1
    width, none = outs.shape[1], reals_on_stack(N_POLYTOPE)
    none[N_VERTICES] = 0.0
    flat_a, flat_b = reals_on_stack(12), reals_on_stack(12)
    for k in range(first, end):
        copy_pose(ahead(way_a, 0 if one_a else 16 * k), flat_a)
        copy_pose(ahead(way_b, 0 if one_b else 16 * k), flat_b)
        answer, numbers = ahead(row, N_OUT * k), ahead(out, width * k)
        kinds[k] = derive_at(pointers, flat_a, flat_b, answer, none, width > 12, numbers)


@entry(PAIR, WRITE, VECTOR, REAL, ROWS, work="derivatives")
def equal_depths(pair, motion, n, d, normals):
    """How many normals serve cores that overlap by -d along n, and they, as rows of `normals`
    (N_NORMALS, 3): n first; all in world axes but n and they, which are in A's frame."""
    given, to = pointer(motion, 0), normals.reshape(normals.size)
    pose = relative_pose(ahead(given, POSE_A), ahead(given, POSE_B))
    none = reals_on_stack(N_POLYTOPE)
    none[N_VERTICES] = 0.0
    work = without_limit(Work(stack_counts(), stack_log(), none, none))
    return equally_deep(pair_pointers(pair), pose, n, d, pointer(to, 0), work)
