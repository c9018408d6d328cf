"""What a thread does: one row, by the kernels' own functions."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any, NamedTuple

from numba import types

from standoff.gpu.compiler import SIMULATED, cuda, launched
from standoff.kernels.compiler.decorators import ahead, pointer, small
from standoff.kernels.entries import smooth
from standoff.kernels.entries.batch import Rows, start_ellipsoid, start_smooth
from standoff.kernels.state.arrays import BLOCK_MOTION, BLOCK_POLYTOPE, N_BLOCK
from standoff.kernels.state.options import read_options
from standoff.kernels.values import Pair

INTS, REALS = types.Array(types.int64, 1, "C"), types.Array(types.float64, 1, "C")
ROWS, POSES = types.Array(types.float64, 2, "C"), types.Array(types.float64, 3, "C")
PAIR = types.Tuple((INTS, REALS, INTS, REALS))

N_GIVEN = BLOCK_POLYTOPE - BLOCK_MOTION
"""Numbers that a frame is given: the motion, the time step, 1 where there are twists."""

PER_BLOCK = 128
"""Threads a block: with 255 registers each, two blocks fill a multiprocessor."""


@small
def bodies_of(pair):  # type: ignore[no-untyped-def]
    """What the kernels read from two bodies, from their arrays on the GPU."""
    return Pair(pointer(pair[0], 0), pointer(pair[1], 0), pointer(pair[2], 0), pointer(pair[3], 0))


@small
def rows_of(poses_a, poses_b, outs):  # type: ignore[no-untyped-def]
    """Where the rows' poses and answers are."""
    return Rows(
        pointer(poses_a, 0),
        pointer(poses_b, 0),
        0 if len(poses_a) == 1 else 16,
        0 if len(poses_b) == 1 else 16,
        pointer(outs, 0),
        0,  # `done` is the thread's to write
    )


def cold_ellipsoids(
    pair: Any, options: Any, poses_a: Any, poses_b: Any, outs: Any, done: Any
) -> None:
    """Row k of ``so.distances`` of two ellipsoids, as the lanes answer it: done[k] is 1 where they
    prove it. poses (n, 4, 4), or (1, 4, 4) for all rows; outs (n, N_OUT)."""
    k = cuda.grid(1)
    if k < len(outs):
        rows, law = rows_of(poses_a, poses_b, outs), read_options(pointer(options, 0))
        done[k] = 1 if start_ellipsoid(bodies_of(pair), law, rows, k) else 0


def _cold(look: Any) -> Callable[..., None]:
    def cold(pair: Any, options: Any, poses_a: Any, poses_b: Any, outs: Any, done: Any) -> None:
        k = cuda.grid(1)
        if k < len(outs):
            rows, law = rows_of(poses_a, poses_b, outs), read_options(pointer(options, 0))
            done[k] = 1 if start_smooth(look, look, bodies_of(pair), law, rows, k) else 0

    return cold


def _frames(look: Any) -> Callable[..., None]:
    def frames(pair: Any, options: Any, given: Any, blocks: Any, done: Any) -> None:
        k = cuda.grid(1)
        if k < len(blocks):
            block, new = pointer(blocks, N_BLOCK * k), pointer(given, N_GIVEN * k)
            motion = ahead(block, BLOCK_MOTION)
            for i in range(N_GIVEN):
                motion[i] = new[i]
            done[k] = smooth.smooth_in_block(
                look, look, bodies_of(pair), read_options(pointer(options, 0)), block
            )

    return frames


class Kernel(NamedTuple):
    """What a thread does, and for which types."""

    function: Callable[..., None]
    signature: tuple[Any, ...]


SEES = {
    "sphere": smooth.on_sphere,
    "nurbs_2": smooth.on_nurbs_2,
    "nurbs_3": smooth.on_nurbs_3,
    "nurbs_4": smooth.on_nurbs_4,
    "nurbs_5": smooth.on_nurbs_5,
}
"""What sees a chart, by the kind of both bodies' faces (``gpu.kinds``)."""

ELLIPSOIDS = "cold_ellipsoids"
COLD = (PAIR, REALS, POSES, POSES, ROWS, INTS)
FRAMES = (PAIR, REALS, ROWS, ROWS, INTS)
KERNELS = {
    ELLIPSOIDS: Kernel(cold_ellipsoids, COLD),
    **{f"cold_{kind}": Kernel(_cold(look), COLD) for kind, look in SEES.items()},
    **{f"frames_{kind}": Kernel(_frames(look), FRAMES) for kind, look in SEES.items()},
}
"""All that is compiled for a GPU, by name."""


@lru_cache(maxsize=len(KERNELS))
def _launched(name: str) -> Any:
    return launched(KERNELS[name].function)


def start_threads(name: str, n: int, arguments: tuple[Any, ...]) -> None:
    """Let n threads do it; the arrays are the GPU's. Returns before they are done."""
    per_block = 1 if SIMULATED else PER_BLOCK  # the simulator makes each a thread of Python
    _launched(name)[(n + per_block - 1) // per_block, per_block](*arguments)
