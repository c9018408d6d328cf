"""Draw coupler.svg: the stiffness at which a held handle becomes unstable, measured and predicted.

Run: python docs/images/draw_coupler.py [FOLDER]. Three to ten minutes: every point is a bisection
of closed-loop runs of the library's own coupler, device and arm.
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np
import scipy

from standoff import Pose, Twist
from standoff.motion import Fixed
from standoff.simulation import (
    HumanArm,
    Mechanism,
    Sampling,
    ScriptedHand,
    SimulatedDevice,
    VirtualCoupler,
    largest_stiffness,
)

PERIOD, MASS, DAMPING = 1e-3, 0.1, 1.0
SAMPLING = Sampling(period=PERIOD, device_damping=DAMPING)
HANDS = {
    "let go": (HumanArm.none(), "#444444"),
    "fingertip": (HumanArm.fingertip(), "#2a78b5"),
    "relaxed arm": (HumanArm.relaxed(), "#c46210"),
    "tensed arm": (HumanArm.tensed(), "#5b8c3a"),
}
HOME, AT_REST = Pose.identity(), Twist.zero()
TICKS, HALVINGS = 1500, 8


def spectral_radius(arm: HumanArm, stiffness: float, damping: float) -> float:
    """Of the sampled loop, built from the equations of motion alone."""
    mass, friction = MASS + arm.mass, DAMPING + arm.damping
    rates = np.array([[0.0, 1.0], [-arm.stiffness / mass, -friction / mass]])
    parts = (rates, np.array([[0.0], [1.0 / mass]]), np.eye(2), np.zeros((2, 1)))
    motion, by_force, *_ = scipy.signal.cont2discrete(parts, PERIOD)
    step = np.zeros((3, 3))
    law = np.array([-stiffness - damping / PERIOD, 0.0, damping / PERIOD])
    step[:2, :2] = motion
    step[:2] += by_force @ law[None]
    step[2, 0] = 1.0
    return float(np.abs(np.linalg.eigvals(step)).max())


def predicted(arm: HumanArm, damping: float) -> float:
    """The least stiffness at which the loop has an eigenvalue of modulus 1."""
    high = 500.0
    while spectral_radius(arm, high, damping) < 1.0:
        high *= 1.1
    return float(
        scipy.optimize.brentq(
            lambda k: spectral_radius(arm, k, damping) - 1.0, high / 1.1, high, rtol=1e-6
        )
    )


def grows(arm: HumanArm, stiffness: float, damping: float) -> bool:
    """Whether a small push at the handle grows in a run of the closed loop."""
    device = SimulatedDevice(
        Mechanism(mass=MASS, damping=DAMPING),
        ScriptedHand(path=Fixed(HOME), arm=arm),
        period=PERIOD,
        pose=Pose.exp([0.0, 0.0, 0.0], [1e-6, 0.0, 0.0]),
    )
    coupler = VirtualCoupler(
        stiffness=stiffness, damping=damping, max_force=1e9, max_age=1.0, engage_time=0.0
    )
    state, ways = coupler.engage(coupler.start()), np.zeros(TICKS)
    with device:
        for k in range(TICKS):
            state, on_device, _ = coupler.step(
                state, device.read(), HOME, AT_REST, PERIOD, now=device.time
            )
            device.write(on_device)
            ways[k] = abs(device.pose.translation[0])
    third = TICKS // 3
    return bool(ways[-third:].max() > ways[third : 2 * third].max())


def measured(arm: HumanArm, damping: float, near: float) -> float:
    """The least stiffness that grows, by halving, to 0.2 %."""
    low, high = 0.77 * near, 1.31 * near
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if grows(arm, middle, damping) else (middle, high)
    return 0.5 * (low + high)


def main(folder: Path) -> None:
    mpl.use("svg")
    import matplotlib.pyplot as plt

    plt.rcParams |= {"svg.hashsalt": "coupler", "font.size": 9.0, "svg.fonttype": "none"}
    figure, axes = plt.subplots(figsize=(6.4, 4.2), layout="constrained")
    dampings = np.linspace(0.0, 0.95, 96)
    passive = [max(largest_stiffness(b, DAMPING, SAMPLING), 1.0) for b in dampings]
    axes.fill_between(dampings, passive, 1.0, color="#d9d9d9", label="passive with every hand")
    for name, (arm, colour) in HANDS.items():
        axes.plot(dampings, [predicted(arm, b) for b in dampings], color=colour, lw=1.3)
        for b in (0.0, 0.3, 0.6, 0.9):
            limit = predicted(arm, b)
            found = measured(arm, b, limit)
            print(f"{name:12} B = {b:.1f}: predicted {limit:9.1f}, measured {found:9.1f} N/m")
            label = name if b == 0.0 else None
            axes.plot(b, found, "o", color=colour, ms=5.0, mfc="white", label=label)
    axes.set_yscale("log")
    axes.set_ylim(100.0, 1e5)
    axes.set_xlim(-0.02, 0.97)
    axes.set_xlabel("damping of the coupler B [N s/m]")
    axes.set_ylabel("stiffness of the coupler K [N/m]")
    axes.set_title(
        "Where the loop becomes unstable: lines predicted, circles measured\n"
        "device 0.1 kg, 1 N s/m, sampled at 1 kHz; tool held fast",
        fontsize=9.0,
    )
    axes.legend(loc="lower left", framealpha=1.0)
    axes.grid(alpha=0.3, which="both", lw=0.4)
    figure.savefig(folder / "coupler.svg", metadata={"Date": None})
    figure.savefig(folder / "coupler.png", dpi=110) if "--png" in sys.argv else None


if __name__ == "__main__":
    given = [word for word in sys.argv[1:] if not word.startswith("-")]
    main(Path(given[0]) if given else Path(__file__).parent)
