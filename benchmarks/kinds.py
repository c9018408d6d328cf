"""Time of a step and of a call by kind of surface and degree of NURBS, with the accuracy beside.

Run with ``python -m benchmarks.kinds``. Every pair is one body twice, in the motion of
``benchmarks.speed``: 1 ms frames, contenders in turn, medians. The unit of comparison is the step
of the same pair as quadrics, in the same run. Ellipsoids as NURBS are checked against the quadric;
the others by the gap of their own certificate.
"""

from __future__ import annotations

import platform
from collections.abc import Callable
from importlib.metadata import version

import numpy as np

import standoff as so
from benchmarks.nurbs_ellipsoids import Axes, elevated
from benchmarks.speed import (
    FRAMES,
    RUNS,
    SEMI_AXES,
    Contender,
    Frames,
    cold_queries,
    compiled_loop,
    make_frames,
    python_steps,
    starts,
    timed,
)
from standoff.geometry import FormulaSurface
from standoff.geometry.ellipsoid_patches import ellipsoid_octants

QUADRIC = "quadric, gnomonic charts"
WHOLE_SIDE = (-1.0, 1.0, -1.0, 1.0)
"""The part of a gnomonic chart that is a side of the cube around the ball."""


def octants(axes: Axes) -> so.Body:
    return so.Body.from_patches(ellipsoid_octants(*axes))


def formula(axes: Axes) -> so.Body:
    """The same ellipsoid from formulas: six gnomonic patches."""
    unit = ("u/sqrt(1 + u**2 + v**2)", "v/sqrt(1 + u**2 + v**2)", "1/sqrt(1 + u**2 + v**2)")
    patches = []
    for chart in so.shapes.sphere_atlas(np.diag(axes), np.zeros(3)):
        rows = [
            " + ".join(f"{c}*{x}" for c, x in zip(row, unit, strict=True) if c)
            for row in chart.linear
        ]
        patches.append(FormulaSurface(*rows, WHOLE_SIDE))
    return so.Body.from_patches(patches)


def restricted_charts(axes: Axes) -> so.Body:
    """The quadric cut into six patches with smooth seams: what trimming and seams alone cost."""
    charts = so.shapes.sphere_atlas(np.diag(axes), np.zeros(3))
    return so.Body.from_patches([chart.restricted(*WHOLE_SIDE) for chart in charts])


KINDS: dict[str, Callable[[Axes], so.Body]] = {
    QUADRIC: lambda axes: so.shapes.ellipsoid(*axes),
    "quadric, six sewn patches": restricted_charts,
    **{f"NURBS of degree {degree}": elevated(degree) for degree in range(2, 10)},
    "formula": formula,
    "superellipsoid, 0.5 and 0.8": lambda axes: so.shapes.superellipsoid(*axes, 0.5, 0.8),
    "superellipsoid, 1.5 and 0.8": lambda axes: so.shapes.superellipsoid(*axes, 1.5, 0.8),
    "spindle": lambda axes: so.shapes.spindle(min(axes), 2.0 * max(axes)),
    "gore": lambda axes: so.shapes.gore(min(axes), 2.0 * max(axes)),
    "lens": lambda axes: so.shapes.lens(axes[0], 0.4 * axes[0]),
}
EXACT = (QUADRIC, "quadric, six sewn patches", "formula")


def contenders(frames: Frames, a: so.Body, b: so.Body) -> list[Contender]:
    step = python_steps(frames, "step", frames.matrices, frames.pairs, a, b)
    return [compiled_loop(frames, a, b), step, cold_queries(frames, a, b)]


def errors(frames: Frames, name: str, loop: Contender, a: so.Body, b: so.Body) -> str:
    """The greatest witness error, or gap of the certificate, over one frame in ten."""
    axes_a, axes_b = SEMI_AXES
    exact = so.shapes.ellipsoid(*axes_a), so.shapes.ellipsoid(*axes_b)
    known = name in EXACT or name.startswith("NURBS")
    worst = 0.0
    for k in range(1, FRAMES + 1, 10):
        if known:
            truth = so.distance(*exact, *frames.poses[k])
            for found, point in zip(loop.witnesses(k), (truth.point_a, truth.point_b), strict=True):
                worst = max(worst, float(np.linalg.norm(found - point)))
        else:
            answer = so.distance(a, b, *frames.poses[k])
            worst = max(worst, answer.distance - answer.lower_bound)
    return f"{worst:.1e} {'witness' if known else 'certificate'}"


def race(runs: int = RUNS) -> None:
    """Time every kind in turn and print a table."""
    frames = make_frames()
    axes_a, axes_b = SEMI_AXES
    rows = {}
    for name, make in KINDS.items():
        a, b = make(axes_a), make(axes_b)
        chosen = contenders(frames, a, b)
        for c in chosen:
            c.run()
        rows[name] = chosen, errors(frames, name, chosen[0], a, b)
    times = {name: np.zeros((runs, 3)) for name in rows}
    for run in range(runs):
        for name, (chosen, _) in rows.items():
            times[name][run] = [timed(c) for c in chosen]
    unit = np.median(times[QUADRIC][:, 0])
    print(f"{'µs, median of ' + str(runs):30s}{'compiled':>10s}{'ratio':>7s}{'step':>8s}", end="")
    print(f"{'cold':>8s}   greatest error (length)")
    for name, (_, error) in rows.items():
        loop, step, cold = np.median(times[name], axis=0)
        print(f"{name:30s}{loop:10.2f}{loop / unit:7.1f}{step:8.1f}{cold:8.1f}   {error}")


def main() -> None:
    versions = ", ".join(f"{name} {version(name)}" for name in ("numpy", "numba"))
    print(f"{platform.machine()}, Python {platform.python_version()}, {versions}")
    race()
    print()
    starts()


if __name__ == "__main__":
    main()
