"""Cold rows of two ellipsoids on a GPU."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError
from standoff.gpu.compiler import check_there
from standoff.gpu.device_arrays import empty, pair_and_options, sent
from standoff.gpu.threads import COLD, start_threads
from standoff.kernels.lanes.rows import whole_ellipsoid
from standoff.kernels.state import arrays as K
from standoff.motion import PosesLike
from standoff.tracking.inputs import check_pair
from standoff.tracking.many_distances import Distances, answered_rows, cold_rows
from standoff.tracking.reached import AddressTable

Array = NDArray[np.float64]


def distances(a: Body, b: Body, poses_a: PosesLike, poses_b: PosesLike) -> Distances:
    """``so.distances`` of two ellipsoids, on a GPU.

    Each row is answered by a thread, by the functions that answer it on the processor, and its
    bounds hold all the same; numbers differ by roundings. Rows that these do not prove, as those of
    bodies that touch, are answered by the processor, as in ``so.distances``.

    Parameters
    ----------
    a, b : Body
        Whole ellipsoids, rounded or not (``so.shapes.ellipsoid``, ``sphere``).
    poses_a, poses_b : array_like, shape (n, 4, 4) or (n, 12), and others, or one pose for all rows
        World poses, as ``so.distances`` takes them.

    Returns
    -------
    Distances
        Arrays of n rows. A row with invalid poses says so; the others are not affected.

    Warns
    -----
    RefusedRowsWarning
        More than half of the rows have invalid poses.

    Raises
    ------
    TypeError
        Not a body.
    ValueError
        A body that is no ellipsoid; poses that ``so.distances`` would not take; no GPU.
    """
    check_pair(a, b)
    for name, body in (("a", a), ("b", b)):
        if not whole_ellipsoid(body.ints):
            raise StandoffError(
                f"{name} = {shown(body)} is not a whole ellipsoid: on a GPU there are cold rows of "
                "two ellipsoids alone; ask so.distances.",
                name,
                body,
            )
    check_there()
    found = answered_rows(a, b, poses_a, poses_b, cold=answer_on_gpu)
    if found.errors:
        found.errors.warn(stacklevel=2)
    return found


def answer_on_gpu(
    table: AddressTable, poses: tuple[Array, Array], rows: Array, workers: int = 1
) -> None:
    """Answer every row (n, N_OUT) by itself, in place; those that are not proven by a thread, on
    the processor."""
    pair, options = pair_and_options(table.arrays)
    outs, done = empty(rows.shape), empty((len(rows),), np.int64)
    start_threads(COLD, len(rows), (pair, options, sent(poses[0]), sent(poses[1]), outs, done))
    rows[:] = outs.copy_to_host()
    left = np.flatnonzero(done.copy_to_host() == 0)
    if len(left):
        there = tuple(x if len(x) == 1 else np.ascontiguousarray(x[left]) for x in poses)
        again = np.full((len(left), K.N_OUT), np.nan)
        cold_rows(table, (there[0], there[1]), again, workers)
        rows[left] = again
