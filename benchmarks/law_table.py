"""Accuracy of the laws: two ellipsoids in smooth motion, witness errors against cold queries.

Run with ``python -m benchmarks.law_table``. It prints the greatest witness error of each law at
1, 10 and 33 ms, with the second-order evaluations a frame took, then the orders of convergence.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import standoff as so

Array = NDArray[np.float64]
Placement = tuple[so.Pose, so.Twist]
Motion = Callable[[float], tuple[Placement, Placement]]

A = so.shapes.ellipsoid(0.52, 1.04, 0.89)
B = so.shapes.ellipsoid(0.76, 0.52, 0.95)
SPIN_A = np.array([0.2, 0.3, 1.5])
"""Angular velocity of A, rad/s."""
SPIN_B = np.array([-0.8, -0.3, 0.6])
"""Angular velocity of B, rad/s."""
ORBIT = 2.3
"""Radius of the circle on which B's centre moves, at 1 rad/s; it also rises and falls."""

SETTLED = 0.3
"""Time, s, after which errors count: the paper's law has then reached its steady lag."""
DURATION = 1.3
"""End of the motion, s. No witness point changes its chart before."""
LONG = 2 * np.pi
"""End of the long motion, s: whole turns, with changes of chart."""
CHECKS = 40
"""About how many frames are compared with cold queries."""

STEPS = (1e-3, 1e-2, 33e-3)
"""Frame times of the table, s."""

ONCE: dict[str, Any] = {"tolerance": np.inf}
"""One correction a frame, whatever the gap."""
LAWS: dict[str, dict[str, Any]] = {
    "Heun, K h = 1 (paper)": {"law": "paper"},
    "Heun, no feedforward": {"law": "paper", "predictor": "none"},
    "Euler, K h = 1": {"law": "paper", "integrator": "euler"},
    "RK4, K h = 1": {"law": "paper", "integrator": "rk4"},
    "one warm Newton step": {"predictor": "none", **ONCE},
    "secant, no twists": {"predictor": "secant", **ONCE},
    "PC": {"predictor": "feedforward", **ONCE},
    "PC2": {"predictor": "feedforward-2", **ONCE},
}
"""Name of each law: the tracker's options."""


@dataclass(frozen=True)
class Accuracy:
    """Greatest witness error (length) of a run, and its second-order evaluations a frame."""

    error: float
    evaluations: float
    chart_changes: int


def two_ellipsoids(t: float) -> tuple[Placement, Placement]:
    """Return pose and twist of A, which spins, and of B, which spins and circles A."""
    centre = ORBIT * np.array([np.cos(t), np.sin(t), 0.2 * np.sin(2 * t)])
    velocity = ORBIT * np.array([-np.sin(t), np.cos(t), 0.4 * np.cos(2 * t)])
    turn_a = Rotation.from_rotvec(SPIN_A * t).as_matrix()
    turn_b = Rotation.from_rotvec(SPIN_B * t).as_matrix()
    return (
        (so.Pose(turn_a), so.Twist(np.zeros(3), SPIN_A)),
        (so.Pose(turn_b, centre), so.Twist(velocity, SPIN_B)),
    )


def witness_error(answer: so.Proximity, truth: so.Proximity) -> float:
    """Return the greater error of the two witness points (length)."""
    return max(
        float(np.linalg.norm(answer.point_a - truth.point_a)),
        float(np.linalg.norm(answer.point_b - truth.point_b)),
    )


def measure(
    times: Array,
    options: dict[str, Any],
    motion: Motion = two_ellipsoids,
    twist_error: float = 0.0,
    settled: float = SETTLED,
    checks: int = CHECKS,
) -> Accuracy:
    """Track the two ellipsoids over the frames at ``times`` and compare with cold queries.

    Parameters
    ----------
    times
        Times (n,) of the frames, s; the first is that of the start.
    options
        Of the tracker; ``dt`` is that of each frame.
    twist_error
        The twists handed to the tracker are too long by this factor.
    """
    steps = np.diff(times)
    tracker = so.Tracker(A, B, dt=float(steps.max()), **options)
    blind = options.get("predictor") == "secant"

    def twists(placements: tuple[Placement, Placement]) -> tuple[so.Twist | None, ...]:
        if blind:
            return None, None
        factor = 1.0 + twist_error
        return tuple(so.Twist(factor * x.v, factor * x.omega) for _, x in placements)

    placements = motion(float(times[0]))
    state = tracker.start(placements[0][0], placements[1][0], *twists(placements))
    every = max(1, int((times > settled).sum()) // checks)
    worst, evaluations, changes = 0.0, 0, 0
    for k, (t, h) in enumerate(zip(times[1:], steps, strict=True), start=1):
        placements = motion(float(t))
        pose_a, pose_b = placements[0][0], placements[1][0]
        state, answer = tracker.step(state, pose_a, pose_b, *twists(placements), dt=float(h))
        evaluations += answer.counts.evaluations
        changes += answer.counts.chart_changes
        if t > settled and k % every == 0:
            worst = max(worst, witness_error(answer, so.distance(A, B, pose_a, pose_b)))
    return Accuracy(worst, evaluations / len(steps), changes)


def even(step: float, duration: float = DURATION) -> Array:
    """Return the times of frames ``step`` apart, from 0."""
    return step * np.arange(round(duration / step) + 1)


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
