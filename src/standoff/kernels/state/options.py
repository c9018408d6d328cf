"""The options of a tracker as kernels read them, by name."""

from __future__ import annotations

from typing import Any, NamedTuple

from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.state.arrays import (
    LAW_CARRIED,
    LAW_PC,
    O_DATA,
    O_DEADLINE,
    O_DEPTH,
    O_FAR_SIDE,
    O_FEEDBACK,
    O_FRAME,
    O_GAIN,
    O_INTEGRATOR,
    O_LAW,
    O_PREDICTOR,
    O_REALISATION,
    O_RESET,
    O_RESTARTS,
    O_SATURATION,
    O_SMOOTH,
    O_SOLVE,
    O_SWITCHING,
    O_TOLERANCE,
    O_WITHIN,
)


class Options(NamedTuple):
    """One law's options; the names of choices stand in ``arrays``."""

    paper: bool  # the paper's law, else the predictor-corrector
    carried: bool  # the paper's, whose parameters the bodies' own method integrates
    predictor: int
    integrator: int
    gain: float  # K, 1/s
    tolerance: float  # of the gap, in spans
    feedback: int
    realisation: int
    saturation: int
    switching: int
    solve: int
    reset: int
    far_side: int
    restarts: bool
    within: float  # beyond it a bound is enough, length; inf: never
    depth: int
    deadline: int  # most evaluations a frame
    smooth: int  # address of the frame that is tried first, 0 for none
    frame: int  # address of the law's frame; 0 for none, which is enough for a start
    numbers: Any  # pointer to all of them, see `feedback_number`


@kernel
def read_options(numbers):
    return Options(
        numbers[O_LAW] != LAW_PC,
        numbers[O_LAW] == LAW_CARRIED,
        int(numbers[O_PREDICTOR]),
        int(numbers[O_INTEGRATOR]),
        numbers[O_GAIN],
        numbers[O_TOLERANCE],
        int(numbers[O_FEEDBACK]),
        int(numbers[O_REALISATION]),
        int(numbers[O_SATURATION]),
        int(numbers[O_SWITCHING]),
        int(numbers[O_SOLVE]),
        int(numbers[O_RESET]),
        int(numbers[O_FAR_SIDE]),
        numbers[O_RESTARTS] != 0.0,
        numbers[O_WITHIN],
        int(numbers[O_DEPTH]),
        int(numbers[O_DEADLINE]),
        int(numbers[O_SMOOTH]),
        int(numbers[O_FRAME]),
        numbers,
    )


@kernel
def feedback_number(options, k):
    """Number k of those that the feedback needs."""
    return options.numbers[O_DATA + k]
