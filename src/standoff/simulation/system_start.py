"""How a system begins: bodies at their own poses and twists, and certified witness points."""

from __future__ import annotations

import numpy as np

from standoff.errors import StandoffError
from standoff.kernels.dynamics import arrays as K
from standoff.kernels.state import arrays as T
from standoff.simulation.coupler_state import packed_state
from standoff.simulation.packed_system import body_start, driven_row
from standoff.simulation.rigid_body import DRIVEN
from standoff.simulation.state_room import kept_numbers
from standoff.simulation.system import System
from standoff.simulation.system_state import SystemState
from standoff.simulation.tolerances import TOUCHING_START
from standoff.solids.answer import SolidProximity
from standoff.solids.spatial.distance import spatial_distance
from standoff.tracking.law_options import Law
from standoff.tracking.tracker import Tracker
from standoff.typing import Array


def started(
    system: System, laws: tuple[Law, ...], dt: float, time: float, allow_overlap: bool
) -> SystemState:
    """The state at a time on the clock of the driven bodies' paths.

    Raises StandoffError: bodies overlap, by a depth that the message gives, and that is not
    allowed.
    """
    header = np.zeros(K.STATE_HEADER)
    header[K.S_TIME] = time
    rows = [
        driven_row(body, time) if body.kind == DRIVEN else body_start(body)
        for body in system.bodies
    ]
    still = SystemState(system, np.concatenate([header, *rows]))
    pairs = []
    for number, law in enumerate(laws):
        pairs.append(_start_of(still, number, law, dt))
        if not allow_overlap:
            _check_apart(system, system.pairs[number], float(pairs[-1][T.N_STATE + T.DISTANCE]))
    coupler = system.coupler
    ends = [] if coupler is None else [packed_state(coupler.start(), coupler.past)]
    kept = np.zeros(kept_numbers(system, laws))
    data = np.concatenate([still.data, *pairs, *ends, kept])
    if pairs:
        depths = [-row[T.N_STATE + T.DISTANCE] for row in pairs]
        data[K.S_DEEPEST] = max(0.0, *depths)
    data.flags.writeable = False
    return SystemState(system, data)


def _start_of(still: SystemState, number: int, law: Law, dt: float) -> Array:
    """A pair's row: its state, and its answer."""
    a, b = still.system.pairs[number]
    models = still.system.pair_models(number)
    if models:
        told = spatial_distance(*models, still.pose(a), still.pose(b))
        return np.concatenate([np.zeros(T.N_STATE), _row_of(told), np.zeros(2)])
    tracker = Tracker(*still.system.convex_pair(number), dt, law)
    found = tracker.start(still.pose(a), still.pose(b), still.twist(a), still.twist(b))
    return np.concatenate([found.data, found.proximity.row, np.zeros(2)])


def _row_of(told: SolidProximity) -> Array:
    """The answer of two solids, as a row of those of convex pairs."""
    row = np.zeros(T.N_OUT)
    row[T.DISTANCE] = told.distance
    row[T.LOWER_BOUND], row[T.UPPER_BOUND] = told.lower_bound, told.upper_bound
    row[T.POINT_A : T.POINT_A + 3], row[T.POINT_B : T.POINT_B + 3] = told.point_a, told.point_b
    row[T.NORMAL : T.NORMAL + 3], row[T.STATUS] = told.normal, told.status.value
    return row


def _check_apart(system: System, pair: tuple[int, int], distance: float) -> None:
    a, b = pair
    first, second = system.bodies[a].body, system.bodies[b].body
    if distance < -TOUCHING_START * min(first.size, second.size):
        raise StandoffError(
            f"Bodies {a} ({first.name}) and {b} ({second.name}) overlap at the start, by "
            f"{-distance:.6g}: move them apart, or set allow_overlap, and they will push "
            "each other apart.",
            "allow_overlap",
            False,
        )
