"""Accuracy of the laws: two ellipsoids in smooth motion, witness errors against cold queries.

Run with ``python -m benchmarks.law_table``. It prints the greatest witness error of each law at
1, 10 and 33 ms, with the second-order evaluations a frame took, then the orders of convergence.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.paper.law_accuracy import (
    DURATION,
    LAWS,
    LONG,
    SETTLED,
    STEPS,
    even,
    measure,
)

Array = NDArray[np.float64]


def order(
    options: dict[str, Any], coarse: float, halvings: int, gain: float | None = None
) -> tuple[Array, Array]:
    """Return the errors at ``coarse`` and its halvings, and the observed orders between them.

    ``gain`` holds the paper's K; without it K h stays 1.
    """
    errors = []
    for k in range(halvings + 1):
        # Frames compared with cold queries fall on the same times at every step.
        chosen = options if gain is None else {**options, "gain": gain}
        count = round((DURATION - SETTLED) / coarse)
        errors.append(measure(even(coarse / 2**k), chosen, checks=count).error)
    found = np.array(errors)
    return found, np.log2(found[:-1] / found[1:])


ORDERS: dict[str, tuple[dict[str, Any], float, int, float | None]] = {
    "Euler, K h = 1": (LAWS["Euler, K h = 1"], 8e-3, 3, None),
    "Euler, K = 100/s": (LAWS["Euler, K h = 1"], 8e-3, 3, 100.0),
    "Heun, K h = 1": (LAWS["Heun, K h = 1 (paper)"], 8e-3, 3, None),
    "Heun, K = 100/s": (LAWS["Heun, K h = 1 (paper)"], 8e-3, 3, 100.0),
    "midpoint, K = 100/s": ({"law": "paper", "integrator": "midpoint"}, 8e-3, 3, 100.0),
    "RK4, K h = 1": (LAWS["RK4, K h = 1"], 8e-3, 3, None),
    "RK4, K = 20/s": (LAWS["RK4, K h = 1"], 25e-3, 3, 20.0),
    "PC": (LAWS["PC"], 16e-3, 3, None),
    "PC2": (LAWS["PC2"], 32e-3, 2, None),
}
"""Name of each order: options, coarsest step, halvings, gain."""


def main() -> None:
    print(f"Max witness error, {SETTLED} to {DURATION} s, no change of chart (evaluations a frame)")
    print(f"{'law':24s}" + "".join(f"{1e3 * h:>17.0f} ms" for h in STEPS))
    for duration in (DURATION, LONG):
        if duration == LONG:
            print(f"The same, {SETTLED} to {LONG:.2f} s, with changes of chart")
        for name, options in LAWS.items():
            found = [measure(even(h, duration), options) for h in STEPS]
            cells = "".join(f"{x.error:>13.1e} ({x.evaluations:.2f})" for x in found)
            print(f"{name:24s}{cells}")
    wrong = measure(even(1e-3), LAWS["PC"], twist_error=0.2)
    print(f"PC, 1 ms, twists 20 % too long: {wrong.error:.1e}")
    print("Observed orders under halving the step")
    for name, (options, coarse, halvings, gain) in ORDERS.items():
        errors, orders = order(options, coarse, halvings, gain)
        row = "  ".join(f"{x:.1e}" for x in errors)
        print(f"{name:24s}{row}   orders " + "  ".join(f"{x:.2f}" for x in orders))


if __name__ == "__main__":
    main()
