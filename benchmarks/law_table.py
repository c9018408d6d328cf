"""Accuracy of the laws: two ellipsoids in smooth motion, witness errors against cold queries.

Run with ``python -m benchmarks.law_table``. It prints the greatest witness error of each law at
1, 10 and 33 ms, with the second-order evaluations a frame took, then the orders of convergence.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import standoff as so
from standoff.kernels.paper import integrators
from standoff_studies.paper.law_accuracy import (
    DURATION,
    LAWS,
    LONG,
    SETTLED,
    STEPS,
    Followed,
    even,
    measure,
)

Array = NDArray[np.float64]


def order(
    followed: Followed, coarse: float, halvings: int, gain: float | None = None
) -> tuple[Array, Array]:
    """Return the errors at ``coarse`` and its halvings, and the observed orders between them.

    ``gain`` holds the paper's K; without it K h stays 1.
    """
    errors = []
    for k in range(halvings + 1):
        # Frames compared with cold queries fall on the same times at every step.
        chosen = followed if gain is None else followed.of_gain(gain)
        count = round((DURATION - SETTLED) / coarse)
        errors.append(measure(even(coarse / 2**k), chosen, checks=count).error)
    found = np.array(errors)
    return found, np.log2(found[:-1] / found[1:])


STAGES_OF = dict(zip(integrators.NAMES, integrators.STAGES.tolist(), strict=True))
"""Stages of every integrator; each has the order of as many."""


def fixed_gain(integrator: str) -> str:
    """What an integrator's order at a fixed gain is called."""
    return f"{integrator}, K fixed"


ORDERS: dict[str, tuple[Followed, float, int, float | None]] = {
    "Euler, K h = 1": (LAWS["Euler, K h = 1"], 8e-3, 3, None),
    "Heun, K h = 1": (LAWS["Heun, K h = 1 (paper)"], 8e-3, 3, None),
    "RK4, K h = 1": (LAWS["RK4, K h = 1"], 8e-3, 3, None),
    **{
        fixed_gain(name): (
            Followed(so.PaperLaw(integrator=name)),
            *((8e-3, 3, 100.0) if stages < 3 else (25e-3, 3, 20.0)),
        )
        for name, stages in STAGES_OF.items()
    },
    "PC": (LAWS["PC"], 16e-3, 3, None),
    "PC2": (LAWS["PC2"], 32e-3, 2, None),
}
"""Name of each order: law, coarsest step, halvings, gain."""


def main() -> None:
    print(f"Max witness error, {SETTLED} to {DURATION} s, no change of chart (evaluations a frame)")
    print(f"{'law':24s}" + "".join(f"{1e3 * h:>17.0f} ms" for h in STEPS))
    for duration in (DURATION, LONG):
        if duration == LONG:
            print(f"The same, {SETTLED} to {LONG:.2f} s, with changes of chart")
        for name, followed in LAWS.items():
            found = [measure(even(h, duration), followed) for h in STEPS]
            cells = "".join(f"{x.error:>13.1e} ({x.evaluations:.2f})" for x in found)
            print(f"{name:24s}{cells}")
    wrong = measure(even(1e-3), LAWS["PC"], twist_error=0.2)
    print(f"PC, 1 ms, twists 20 % too long: {wrong.error:.1e}")
    print("Observed orders under halving the step")
    for name, (followed, coarse, halvings, gain) in ORDERS.items():
        errors, orders = order(followed, coarse, halvings, gain)
        row = "  ".join(f"{x:.1e}" for x in errors)
        print(f"{name:24s}{row}   orders " + "  ".join(f"{x:.2f}" for x in orders))


if __name__ == "__main__":
    main()
