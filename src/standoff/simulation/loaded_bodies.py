"""Bodies where a method puts them: their pairs tracked there, and what the contacts do to them."""

from __future__ import annotations

import numpy as np

from standoff.bodies.features import feature_of
from standoff.errors import StandoffError
from standoff.kernels.dynamics import arrays as K
from standoff.kernels.entries import simulation as entries
from standoff.kernels.state import arrays as T
from standoff.simulation.packed_system import pack_system
from standoff.simulation.pair_laws import laws_beside, packed_laws
from standoff.simulation.system import System
from standoff.simulation.system_start import started
from standoff.simulation.system_state import distances
from standoff.tracking.laws import PredictorCorrector
from standoff.tracking.rows import AnswerRows
from standoff.typing import Array

Features = list[tuple[str, str]]

POWERS = (K.S_LOST, K.S_GIVEN, K.S_SHARED)
"""The energies of a state whose rates stand behind the loads of all bodies."""

LAW = PredictorCorrector(predictor="none", depth="local")
"""Evaluations of an adaptive method are at any times, in any order: nothing is predicted."""


class LoadedBodies:
    """A system's state, changed in place: rows of bodies are written into it, and its trackers
    follow.

    Parameters
    ----------
    system : System
        Its bodies stand at their own poses and twists.
    dt : float
        The longest step that will be made [s].
    allow_overlap : bool
        Accept bodies that overlap.

    Attributes
    ----------
    data : ndarray
        The state, as an operator's. The bodies' rows are at ``arrays.body_row``.
    loads : ndarray
        What the contacts do to each body, N_LOAD numbers: force and torque, the torque about the
        centre of mass of a free body, and about the origin of another; and behind all of them the
        powers (POWERS).
    account : ndarray
        Energies and contacts.
    """

    def __init__(self, system: System, dt: float, allow_overlap: bool) -> None:
        self.system = system
        laws = laws_beside(system, LAW)
        self.data = started(system, laws, dt, 0.0, allow_overlap).data.copy()
        self.loads = np.zeros(K.N_LOAD * len(system.bodies) + len(POWERS))
        self.account = np.zeros(entries.ACCOUNT_HEADER + K.N_TOUCH * len(system.pairs))
        self._packed = pack_system(system, dt, 0, False, packed_laws(system, laws, dt, False))

    def load(self, t: float) -> Array:
        """Track the pairs where the bodies are now, and return the loads.

        Raises StandoffError: a pose or twist that is not finite.
        """
        self.data[K.S_TIME] = t
        why = entries.load_system(self._packed, self.data, self.loads, self.account)
        if why != T.FINE:
            raise StandoffError(
                f"At {t:g} s a body's motion was no longer finite: take a smaller tolerance or a "
                "shorter max_step."
            )
        return self.loads

    def on_body(self, number: int) -> Array:
        """Force and torque on a body, as last loaded."""
        return self.loads[K.N_LOAD * number : K.N_LOAD * (number + 1)]

    def distances(self) -> list[float]:
        """Signed distances of the pairs, as last loaded."""
        found: list[float] = distances(self.system, self.data[None])[0].tolist()
        return found

    def features(self) -> Features:
        """Active features of the pairs, as last loaded."""
        at = K.STATE_HEADER + K.N_BODY * len(self.system.bodies)
        found = []
        for number in range(len(self.system.pairs)):
            row = self.data[at + K.N_PAIR * number + T.N_STATE :]
            mode = AnswerRows(row[: T.N_OUT]).mode
            a, b = self.system.convex_pair(number)
            found.append((str(feature_of(a, int(mode[0]))), str(feature_of(b, int(mode[2])))))
        return found
