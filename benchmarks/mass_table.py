"""Mass, centre and inertia of bodies that are known by formulas: errors, bounds, times.

    python -m benchmarks.mass_table

Errors are the greatest of those of volume, centre and inertia, each over its bound's size: the
volume, the size, the greatest moment. Times are the best of three, in milliseconds.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np

from standoff.bodies.moments.boundary import moments_of
from standoff.simulation import MassProperties, mass_properties
from standoff.simulation.tolerances import MOMENTS_END

CASES = Path(__file__).parents[1] / "tests" / "simulation"
REPEATS = 3
LEFT_OUT = ("tiny sphere", "huge box")
SUPERELLIPSOIDS = ((1.0, 1.0), (0.5, 0.5), (0.3, 0.8), (1.5, 0.6))


def relative(found: MassProperties, size: float) -> list[float]:
    """The bounds of volume, centre and inertia, relative."""
    e = found.error
    return [e.mass / found.mass, e.centre / size, e.inertia / found.principal_moments[2]]


def main() -> None:
    sys.path.insert(0, str(CASES))
    from mass_cases import CASES as known  # type: ignore[import-not-found]

    import solids  # type: ignore[import-not-found]
    import standoff as so

    cases = {name: case for name, case in known.items() if name not in LEFT_OUT}
    for powers in SUPERELLIPSOIDS:
        cases[f"superellipsoid {powers[0]:g}, {powers[1]:g}"] = (
            lambda powers=powers: so.shapes.superellipsoid(1.0, 2.0, 1.5, *powers),
            lambda powers=powers: solids.superellipsoid(1.0, 2.0, 1.5, *powers),
        )
    print("| body | error | bound | points | ms |")
    print("|---|---|---|---|---|")
    for name, (make, formula) in cases.items():
        body, true = make(), formula()
        times = []
        for _ in range(REPEATS):
            start = time.perf_counter()
            found = mass_properties(body)
            times.append(time.perf_counter() - start)
        errors = [
            abs(found.mass / true.volume - 1.0),
            float(np.linalg.norm(found.centre - true.centre)) / body.size,
            float(np.linalg.norm(found.inertia - true.inertia, 2)) / found.principal_moments[2],
        ]
        nodes = moments_of(body, MOMENTS_END).nodes
        print(
            f"| {name} | {max(errors):.0e} | {max(relative(found, body.size)):.0e} "
            f"| {nodes} | {1e3 * min(times):.0f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
