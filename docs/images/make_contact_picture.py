"""The picture of a peg that a hand moves about in its hole:
``python docs/images/make_contact_picture.py``.

The readings of the hand are those of ``benchmarks.solid_servo``, without a clock.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from benchmarks.solid_servo import ONE_WAY, coupled, hand

from standoff import simulation as sim
from standoff.devices import Trace

HERE = Path(__file__).parent
RATE, SECONDS = 1000.0, 6.0


def run() -> sim.SystemRun:
    """A run of so many seconds."""
    operator = coupled(RATE)
    readings = sim.DeviceReadings([None])
    rows = Trace(hand, 0.0, ONE_WAY, there_and_back=True).rows(operator.dt)
    readings.rows = rows[: round(SECONDS * RATE)]
    return operator.run(operator.start().engage(), len(readings.rows), device=readings)


def main() -> None:
    found = run()
    t, forces, spots = found.times, found.forces[:, 0], found.spots[:, 0]
    felt = found.coupler.on_device[:, :3]
    fig, axes = plt.subplots(3, 1, figsize=(7.5, 6.0), sharex=True, height_ratios=(3, 2, 1))
    top, middle, low = axes
    top.plot(t, np.linalg.norm(felt, axis=1), color="C0", lw=1.0, label="on the hand")
    top.plot(t, np.linalg.norm(forces, axis=1), color="C1", lw=0.8, label="of the wall, in sum")
    top.set_ylabel("force (N)")
    top.legend(loc="lower right", frameon=False)
    middle.plot(t, -1e6 * found.distances[:, 0], color="C2", lw=1.0)
    middle.set_ylabel("deepest place (µm)")
    low.step(t, spots, color="0.3", lw=0.8, where="post")
    low.set_ylabel("spots")
    low.set_xlabel("time (s)")
    for each in axes:
        each.set_xlim(0.0, SECONDS)
        each.spines[["top", "right"]].set_visible(False)
    fig.align_ylabels(axes)
    fig.tight_layout()
    fig.savefig(HERE / "contact.png", dpi=130)
    jump = np.linalg.norm(np.diff(forces, axis=0), axis=1)
    print(
        f"greatest change of the force in a tick {jump.max():.3f} N, median {np.median(jump):.4f}"
    )
    print(f"jumps {found.jumps}, uncertified {found.uncertified}")


if __name__ == "__main__":
    main()
