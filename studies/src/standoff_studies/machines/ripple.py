"""What two bodies push each other with as both move on as they are told."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import standoff as so
from standoff import simulation as sim
from standoff.kernels.solids import contact_places as P
from standoff.kernels.solids import front_rows as R
from standoff.motion.paths import Path
from standoff.simulation.system_state import SystemState, state_length
from standoff.solids import Solid

Array = NDArray[np.float64]
IMMOVABLE = 1e9
"""Mass and inertia, kg and kg m², of a body that goes on as it began whatever pushes it."""


class Push(NamedTuple):
    """Of each tick, n, in world axes.

    Attributes
    ----------
    times : (n,) array
    force : (n, 3) array
        On B.
    distance : (n,) array
        Of the deepest place, less than zero in overlap.
    normal : (n, 3) array
        Of the deepest place, from A to B.
    spots : (n,) array of int
        That push.
    rows : int
        Pairs of pieces that are kept in the end; the most of several runs.
    uncertified, jumps : int
        As `SystemRun` counts them.
    """

    times: Array
    force: Array
    distance: Array
    normal: Array
    spots: NDArray[Any]
    rows: int
    uncertified: int
    jumps: int


def pushed_along(
    a: Solid,
    start: tuple[so.Pose, so.Twist],
    b: Solid,
    path: Path,
    law: sim.HuntCrossley,
    ticks: tuple[float, int],
) -> Push:
    """A goes on from its pose with its twist, and B along its path, from an overlap as it is; ticks
    are told as their length and how many."""
    dt, count = ticks
    pose, twist = start
    inertia = IMMOVABLE * np.eye(3)
    bodies = [
        sim.RigidBody.free(a, mass=IMMOVABLE, inertia=inertia, pose=pose, twist=twist),
        sim.RigidBody.driven(b, path),
    ]
    operator = sim.Operator(sim.System(bodies, law, gravity=[0, 0, 0]), dt)
    run = operator.run(operator.start(allow_overlap=True), count)
    return Push(
        run.times[1:],
        run.forces[1:, 0],
        run.distances[1:, 0],
        run.witness_points[2][1:, 0],
        run.spots[1:, 0],
        _rows_of(operator.system, run.final),
        run.uncertified,
        run.jumps,
    )


def one_after_the_other(pushes: Sequence[Push]) -> Push:
    """What several runs tell, as one."""
    arrays = ([np.asarray(p[k]) for p in pushes] for k in range(5))
    times, force, distance, normal, spots = (np.concatenate(each) for each in arrays)
    rows = max(p.rows for p in pushes)
    counts = (sum(p.uncertified for p in pushes), sum(p.jumps for p in pushes))
    return Push(times, force, distance, normal, spots, rows, *counts)


def _rows_of(system: sim.System, state: SystemState) -> int:
    kept = state.data[state_length(system) + system.kept_starts()[0] :]
    return int(kept[P.F_STORE + R.N_ROWS])
