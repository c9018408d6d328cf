"""What one frame makes of the last one, before it is written as an answer and a state."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.pair.descent import pair_jets
from standoff.kernels.pair.system import projection_errors
from standoff.kernels.state.state import Four, Integrated
from standoff.kernels.values import NO_RATES, Found

# What is to be done next in a frame.
ANSWERED, TRY_CONTACT, TRY_RESTART = np.int64(0), np.int64(1), np.int64(2)


class Shown(NamedTuple):
    """What a frame's answer shows."""

    found: Found
    jets: Any  # both, of the place found, in A's frame
    inside: bool  # solved in contact
    fresh: bool  # are the rates the feedforward at these very points?
    rates: Four  # 1/s


class Tracked(NamedTuple):
    """The witness points of a frame, and what the paper's law goes on with."""

    shown: Shown
    integrated: Integrated


@kernel
def without_rates(pair, pose, found, inside, integrated):
    """What a frame makes of witness points found without the law."""
    jets = pair_jets(pair, pose, found.place)
    return Tracked(Shown(found, jets, inside, False, NO_RATES), integrated)


@kernel
def errors_at(pair, pose, place):
    """The projection errors of Eqs. (1)-(4)."""
    jet_a, jet_b = pair_jets(pair, pose, place)
    return projection_errors(jet_a, jet_b)


@kernel
def begun(pair, pose, place, gain):
    """What the paper's law integrates, at its beginning."""
    return Integrated(errors_at(pair, pose, place), NO_RATES, gain)
