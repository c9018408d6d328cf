"""Cold rows of two bodies on a GPU."""

from __future__ import annotations

import numpy as np

from standoff.bodies.body import Body
from standoff.errors import StandoffError
from standoff.gpu.compiler import check_there
from standoff.gpu.device_arrays import empty, pair_and_options, sent
from standoff.gpu.kinds import THERE_ARE, kind_of
from standoff.gpu.threads import ELLIPSOIDS, start_threads
from standoff.kernels.lanes.rows import whole_ellipsoid
from standoff.kernels.state import arrays as K
from standoff.motion import PosesLike
from standoff.tracking.distance_arrays import Distances
from standoff.tracking.inputs import check_pair
from standoff.tracking.many_distances import answered_rows, cold_rows
from standoff.tracking.reached import AddressTables
from standoff.typing import Array
from standoff.wording import short_name


class DistancesOfThreads(Distances):
    """`Distances`, and how many of them are a GPU's.

    Attributes
    ----------
    by_threads : int
        Number of rows that were answered on the GPU; the others were on the processor.
    """

    __slots__ = ("by_threads",)

    def __init__(self, found: Distances, by_threads: int) -> None:
        super().__init__(found._of, found.rows, found.poses, found.repaired, found.errors)
        self.by_threads = by_threads


def distances(a: Body, b: Body, poses_a: PosesLike, poses_b: PosesLike) -> DistancesOfThreads:
    """``so.distances`` of two bodies of faces of one kind, on a GPU.

    Each row is answered by a thread, by the kernels' own functions, and its bounds hold all the
    same; numbers differ by roundings. Rows that a thread does not prove, as those of bodies that
    touch and of witness points on edges, are answered by the processor.

    Raises TypeError, ValueError as ``so.distances``; bodies with other faces; no GPU.

    Parameters
    ----------
    a, b : Body
        Of patches of spheres (ellipsoids, lenses), or of NURBS of one degree from 2 to 5; rounded
        or not.
    poses_a, poses_b : array_like
        As ``so.distances`` takes them.

    Returns
    -------
    DistancesOfThreads
        `Distances`, with the number of rows answered on the GPU.

    Warns
    -----
    RefusedRowsWarning
        As ``so.distances``.
    """
    check_pair(a, b)
    answering = ColdKernel(kernel_of(a, b))
    check_there()
    found = answered_rows(a, b, poses_a, poses_b, cold=answering)
    if found.errors:
        found.errors.warn(stacklevel=2)
    return DistancesOfThreads(found, answering.by_threads)


def kernel_of(a: Body, b: Body) -> str:
    """The name of the kernel that answers cold rows of two bodies.

    Raises ValueError: there is none.
    """
    if whole_ellipsoid(a.ints) and whole_ellipsoid(b.ints):
        return ELLIPSOIDS
    kind = kind_of(a, b)
    if kind is None:
        names = " and ".join(short_name(body.name) for body in (a, b))
        raise StandoffError(
            f"a, b = {names}: on a GPU there are cold rows of two bodies of {THERE_ARE}; ask "
            "so.distances.",
            "a",
            a,
        )
    return f"cold_{kind}"


class ColdKernel:
    """What answers cold rows by a kernel, as `many_distances.cold_rows` does.

    Attributes
    ----------
    by_threads : int
        Number of rows of the last call that threads have proven.
    """

    def __init__(self, kernel: str) -> None:
        self.kernel, self.by_threads = kernel, 0

    def __call__(
        self, tables: AddressTables, poses: tuple[Array, Array], rows: Array, workers: int = 1
    ) -> None:
        """Answer every row (n, N_OUT) by itself, in place; those that are not proven by a thread,
        on the processor."""
        pair, options = pair_and_options(tables.tables[0].arrays)
        outs, done = empty(rows.shape), empty((len(rows),), np.int64)
        arguments = pair, options, sent(poses[0]), sent(poses[1]), outs, done
        start_threads(self.kernel, len(rows), arguments)
        rows[:] = outs.copy_to_host()
        left = np.flatnonzero(done.copy_to_host() == 0)
        self.by_threads = len(rows) - len(left)
        if len(left):
            there = tuple(x if len(x) == 1 else np.ascontiguousarray(x[left]) for x in poses)
            again = np.full((len(left), K.N_OUT), np.nan)
            cold_rows(tables, (there[0], there[1]), again, workers)
            rows[left] = again
