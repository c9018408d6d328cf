"""A law packed into the numbers that the kernels read: nothing else outside them knows the order.

An option named ``depth`` goes into the slot ``O_DEPTH``, a choice as its place among its names.
"""

from __future__ import annotations

import functools
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.pair.events import NO_LIMIT
from standoff.kernels.state import arrays as K
from standoff.tracking.law_options import Law, OfFeedback, options_of
from standoff.tracking.laws import DEFAULT_LAW, PaperLaw

NUMBERS = {"deadline": NO_LIMIT, "within": inf}
"""What stands for an option that is not given."""

GAINS = ("gain", "feedback")
"""Packed together: a gain is the linear feedback's."""


def pack_options(law: Law) -> NDArray[np.float64]:
    """Return the kernels' array of options, read-only, of a resolved law."""
    options = np.zeros(K.N_OPTIONS)
    options[K.O_LAW] = K.LAW_PAPER if isinstance(law, PaperLaw) else K.LAW_PC
    for name, each in options_of(law).items():
        value = getattr(law, name)
        if name == "feedforward":
            # to the kernels, a law without feedforward has no predictor
            options[K.O_PREDICTOR] = K.PREDICT_FEEDFORWARD_2 if value else K.PREDICT_NONE
        elif name not in GAINS and not isinstance(each.kind, OfFeedback):
            slot = getattr(K, f"O_{name.upper()}")
            options[slot] = NUMBERS[name] if value is None else each.kind.number(value)
    if isinstance(law, PaperLaw):
        from standoff.tracking.feedback import Linear

        loop = Linear(law.gain or np.nan) if law.feedback is None else law.feedback
        _pack_feedback(loop, options)
    options.flags.writeable = False
    return options


def with_frames(options: NDArray[np.float64], smooth: int = 0, own: int = 0) -> NDArray[np.float64]:
    """The options with the addresses of the frame that is tried first and of the law's own frame;
    0 for none."""
    given = options.copy()
    given[K.O_SMOOTH], given[K.O_FRAME] = smooth, own
    given.flags.writeable = False
    return given


def carried(options: NDArray[np.float64], own: int) -> NDArray[np.float64]:
    """Those of the paper's law, of which the bodies' own method integrates the parameters; with the
    address of that law's frame."""
    given = with_frames(options, own=own).copy()
    given[K.O_LAW] = K.LAW_CARRIED
    given.flags.writeable = False
    return given


def _pack_feedback(feedback: Any, options: NDArray[np.float64]) -> None:
    options[K.O_FEEDBACK], options[K.O_GAIN], data = feedback.packed()
    options[K.O_DATA : K.O_DATA + len(data)] = data


def resolved_options(law: Law, dt: float) -> tuple[Law, NDArray[np.float64]]:
    """A law with what it leaves open settled for a frame time, s, and its options."""
    if law is DEFAULT_LAW:
        return _usual_options(dt)  # every cold query asks for them
    resolved = law.resolved(dt)
    return resolved, pack_options(resolved)


@functools.lru_cache(maxsize=16)
def _usual_options(dt: float) -> tuple[Law, NDArray[np.float64]]:
    resolved = DEFAULT_LAW.resolved(dt)
    return resolved, pack_options(resolved)
