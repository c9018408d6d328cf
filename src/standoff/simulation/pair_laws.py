"""The law by which each pair of a system is tracked, resolved and packed."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError
from standoff.kernels.entries import paper_laws
from standoff.kernels.state.arrays import N_OPTIONS
from standoff.simulation.system import System
from standoff.tracking.law_options import Law
from standoff.tracking.laws import PaperLaw, PredictorCorrector, checked_law
from standoff.tracking.options import carried, pack_options
from standoff.tracking.reached import reach
from standoff.tracking.specialised import address_of
from standoff.typing import Array

Laws = Law | Mapping[tuple[int, int], Law] | None
"""Of a system's pairs: one for all, or one for each of some pairs of body numbers."""

BESIDE = PredictorCorrector(depth="local")
"""Of pairs that are given none: contact forces follow the depth that the bodies have reached."""


def laws_beside(system: System, given: Laws) -> tuple[Law, ...]:
    """The law of each pair whose tracker stands beside the operator.

    Raises StandoffTypeError: not a law. Raises StandoffError: a law for a pair that the system does
    not have.
    """
    if not isinstance(given, Mapping):
        return (BESIDE if given is None else checked_law(given),) * len(system.pairs)
    known = {tuple(pair): number for number, pair in enumerate(system.pairs)}
    laws: list[Law] = [BESIDE] * len(system.pairs)
    for pair, law in given.items():
        number = known.get(tuple(pair), known.get(tuple(pair)[::-1]))
        if number is None:
            raise StandoffError(
                f"law has an entry for {shown(pair)}, which is not a pair of the system: its "
                f"pairs are {', '.join(map(str, known))}.",
                "law",
                pair,
            )
        if system.of_solids[number]:
            raise StandoffError(
                f"law has an entry for {shown(pair)}, a pair with a Solid: its places of contact "
                "are found without a law; leave it out.",
                "law",
                pair,
            )
        laws[number] = checked_law(law)
    return tuple(laws)


def law_inside(method: str, gain: float | None) -> PaperLaw:
    """The paper's law as part of the operator: integrated by the operator's own method."""
    integrator = "euler" if method == "semi-implicit" else method
    return PaperLaw(integrator=integrator, gain=gain, depth="local")


def packed_laws(system: System, laws: tuple[Law, ...], dt: float, inside: bool) -> Array:
    """All pairs' options, one after the other, with the addresses of their frames."""
    rows = [np.zeros(0)]
    for number, law in enumerate(laws):
        if system.of_solids[number]:
            rows.append(np.zeros(N_OPTIONS))
        elif inside:
            rows.append(carried(pack_options(law.resolved(dt)), address_of(paper_laws.carried)))
        else:
            rows.append(reach(*system.convex_pair(number), law, dt, None).options)
    return np.concatenate(rows)


def keeps_polytopes(laws: tuple[Law, ...]) -> bool:
    """Does a pair prove the least depth, so that its proof is kept from tick to tick?"""
    return any(law.depth == "global" for law in laws)
