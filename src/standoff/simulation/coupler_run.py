"""What a coupler did in the course of a run of its system."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.dynamics import coupler_arrays as K
from standoff.simulation.coupler_state import CouplerCounts
from standoff.simulation.passivity_observer import PortEnergy
from standoff.typing import Array


class CouplerRun(NamedTuple):
    """A coupler at each record of a run, n of them. Vectors are along the world's axes.

    Attributes
    ----------
    engaged : (n,) array of bool
    fault : (n,) array of int
        Numbers of `Fault`: why it let go, 0 while it is engaged.
    handle_positions : (n, 3) array
        Where the handle was read last [m]; nan where nothing is known of it.
    handle_rotations : (n, 3, 3) array
    on_device, on_tool : (n, 6) arrays
        Wrenches, force first, held on the handle and on the tool in the tick before [N, N m].
    energy : PortEnergy
        Its fields are (n,) arrays: the work at both ports, by the ticks before.
    stored : (n,) array
        In the coupler's springs, the tool where it is now [J].
    damped : (n,) array
        Lost in its damper [J].
    counts : CouplerCounts
        Of the last record.
    """

    engaged: NDArray[np.bool_]
    fault: NDArray[np.int64]
    handle_positions: Array
    handle_rotations: Array
    on_device: Array
    on_tool: Array
    energy: Any
    stored: Array
    damped: Array
    counts: CouplerCounts


def coupler_run(rows: Array, stored: Array) -> CouplerRun:
    """Return the record of the coupler's part of some rows of states, (n, m).

    Parameters
    ----------
    rows : (n, m) array
    stored : (n,) array
        Energy in its springs.
    """
    handle = rows[:, K.C_HANDLE : K.C_TOOL].copy()
    handle[rows[:, K.C_SEEN] == 0.0] = np.nan
    into = rows[:, K.C_DEVICE : K.C_DAMPED].T
    return CouplerRun(
        engaged=rows[:, K.C_ENGAGED] > 0.0,
        fault=rows[:, K.C_FAULT].astype(int),
        handle_positions=handle[:, 9:12],
        handle_rotations=handle[:, :9].reshape(-1, 3, 3),
        on_device=rows[:, K.C_ON_DEVICE : K.C_ON_TOOL],
        on_tool=rows[:, K.C_ON_TOOL : K.C_HELD],
        energy=PortEnergy(*into),
        stored=stored,
        damped=rows[:, K.C_DAMPED],
        counts=CouplerCounts(*map(int, rows[-1, K.C_COUNTS : K.C_HANDLE])),
    )
