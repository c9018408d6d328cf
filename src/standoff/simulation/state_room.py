"""What a state keeps beside its row: places of contact of solids, and proofs of depths."""

from __future__ import annotations

from standoff.kernels.pair.polytope_layout import N_POLYTOPE
from standoff.simulation.pair_laws import keeps_polytopes
from standoff.simulation.system import System
from standoff.tracking.law_options import Law


def kept_numbers(system: System, laws: tuple[Law, ...]) -> int:
    """How many numbers stand behind a state's row."""
    polytopes = N_POLYTOPE * len(system.pairs) if keeps_polytopes(laws) else 0
    return system.kept_starts()[-1] + polytopes
