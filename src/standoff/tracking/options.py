"""The tracker's options: checked together, and packed into the numbers the kernels read."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.kernels import frame as K
from standoff.kernels.events import NO_LIMIT
from standoff.tracking.choices import (
    DEPTHS,
    INTEGRATORS,
    LAWS,
    PREDICTORS,
    REALISATIONS,
    SATURATIONS,
    SOLVES,
    SWITCHINGS,
    choice,
    positive_number,
    whole_number,
)
from standoff.tracking.feedback import Feedback, check_stable, feedback_of


@dataclass(frozen=True)
class Variants:
    """How the paper's law is run; `so.Tracker` describes them.

    Attributes
    ----------
    realisation : "evaluated" or "integrated"
    saturation : "hold" or "zero"
    switching : "multipliers", "voronoi" or "none"
    solve : "ranked" or "plain"
    """

    realisation: str = "evaluated"
    saturation: str = "hold"
    switching: str = "multipliers"
    solve: str = "ranked"

    @classmethod
    def of(cls, realisation: str, saturation: str | None, switching: str, solve: str) -> Variants:
        """Return the variants, checked; without a saturation the one that goes with the switching.

        Raises
        ------
        ValueError
            Unknown names, or a saturation that the switching cannot work with.
        """
        choice(switching, "switching", SWITCHINGS)
        if saturation is None:
            saturation = "hold" if switching == "multipliers" else "zero"
        choice(saturation, "saturation", SATURATIONS)
        if saturation == "zero" and switching == "multipliers":
            raise ValueError(
                "saturation='zero' keeps a witness point on its face at the boundary, where "
                "switching='multipliers' never looks: take switching='voronoi' or 'none'."
            )
        if saturation == "hold" and switching == "none":
            raise ValueError(
                "saturation='hold' enters the edge it meets, which switching='none' never leaves: "
                "take saturation='zero'."
            )
        choice(realisation, "realisation", REALISATIONS)
        choice(solve, "solve", SOLVES)
        return cls(realisation, saturation, switching, solve)


def pack_options(
    law: str,
    predictor: str,
    integrator: str,
    gain: float | None,
    dt: float,
    tolerance: float,
    feedback: Any = None,
    variants: Variants | None = None,
    depth: str = "global",
    deadline: int | None = None,
) -> tuple[NDArray[np.float64], Feedback]:
    """The array of options the kernels read, and the feedback. Default gain: K dt = 1."""
    dt = positive_number(dt, "dt")
    variants = variants or Variants()
    options = np.zeros(K.N_OPTIONS)
    options[K.O_LAW] = choice(law, "law", LAWS)
    options[K.O_PREDICTOR] = choice(predictor, "predictor", PREDICTORS)
    options[K.O_INTEGRATOR] = choice(integrator, "integrator", INTEGRATORS)
    options[K.O_TOLERANCE] = positive_number(tolerance, "tolerance", allow_infinite=True)
    chosen = feedback_of(feedback, gain, dt).resolved(integrator, dt)
    if law == "paper":
        check_stable(chosen, integrator, dt)
    elif feedback is not None or variants != Variants():
        raise ValueError(
            f"feedback = {feedback}, {variants}: these are of the paper's law; give law='paper'."
        )
    kind, options[K.O_GAIN], data = chosen.packed()
    options[K.O_FEEDBACK] = kind
    options[K.O_DATA : K.O_DATA + len(data)] = data
    options[K.O_REALISATION] = REALISATIONS[variants.realisation]
    options[K.O_SATURATION] = SATURATIONS[variants.saturation]
    options[K.O_SWITCHING] = SWITCHINGS[variants.switching]
    options[K.O_SOLVE] = SOLVES[variants.solve]
    options[K.O_DEPTH] = choice(depth, "depth", DEPTHS)
    options[K.O_DEADLINE] = NO_LIMIT if deadline is None else whole_number(deadline, "deadline")
    options.flags.writeable = False
    return options, chosen
