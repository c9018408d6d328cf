"""Write `hand_motion.tum`: a synthetic hand that carries a tool past the part of `demo.toml`.

Nobody's hand was recorded. The motion is made of what a hand-held motion shows: a slow sweep with
detours, drift, a tremor of 8 to 12 Hz, time stamps that are uneven, and frames that were lost.
All of it comes from one seed, so the same file is written every time:

    python examples/make_hand_motion.py
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

Array = npt.NDArray[np.float64]

SEED = 20240611
DURATION = 10.0  # s
RATE = 100.0  # frames per second, nominal
STAMP_JITTER = 4e-4  # s, standard deviation of a time stamp
LOST_FRAMES = 0.02  # share of the frames that are missing
DRIFT = (0.05, 0.35)  # Hz, band of the slow wandering
TREMOR = (8.0, 12.0)  # Hz, band of a hand's physiological tremor
WAVES = 24  # sinusoids a band: enough that the sum does not repeat within the motion


def time_stamps(rng: np.random.Generator) -> Array:
    """Return increasing, uneven times in seconds, from 0, shape (n,)."""
    nominal = np.arange(int(DURATION * RATE) + 1) / RATE
    kept = rng.random(nominal.size) >= LOST_FRAMES
    kept[[0, -1]] = True
    stamps = nominal[kept] + np.clip(rng.normal(0.0, STAMP_JITTER, kept.sum()), -2e-3, 2e-3)
    return np.round(stamps - stamps[0], 6)


def band_noise(
    rng: np.random.Generator, times: Array, band: tuple[float, float], rms: float
) -> Array:
    """Return smooth noise in three components within a frequency band, shape (n, 3)."""
    frequencies = rng.uniform(*band, (3, WAVES))
    phases = rng.uniform(0.0, 2.0 * np.pi, (3, WAVES))
    waves = np.sin(2.0 * np.pi * frequencies * times[:, None, None] + phases)
    return rms * np.sqrt(2.0 / WAVES) * waves.sum(axis=2)


def sweep(times: Array) -> tuple[Array, Rotation]:
    """Return the intended motion: around the part, over its tip, and back down the far side."""
    progress = times / DURATION
    azimuth = np.radians(-100.0 + 220.0 * progress + 60.0 * np.sin(2.0 * np.pi * 2.2 * progress))
    elevation = np.radians(5.0 + 78.0 * np.sin(np.pi * progress) ** 2)
    # The part is longer along z than across, so that the hand stays farther away over its tip.
    reach = 0.148 + 0.032 * np.sin(elevation) + 0.018 * np.cos(2.0 * np.pi * 3.0 * progress)
    outward = np.stack(
        [
            np.cos(elevation) * np.cos(azimuth),
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
        ],
        axis=1,
    )
    # The tool's long axis, x, points at the part, turned aside as a hand turns a probe.
    facing = Rotation.from_euler("ZY", np.stack([azimuth + np.pi, elevation], axis=1))
    turned = np.stack([0.4 * np.sin(5.0 * progress), 0.3 * np.cos(7.0 * progress)], axis=1)
    return reach[:, None] * outward, facing * Rotation.from_euler("ZY", turned)


def hand_motion() -> tuple[Array, Array, Array]:
    """Return times (n,) in s, positions (n, 3) in m and quaternions x y z w (n, 4)."""
    rng = np.random.default_rng(SEED)
    times = time_stamps(rng)
    position, orientation = sweep(times)
    position = position + band_noise(rng, times, DRIFT, 5e-3) + band_noise(rng, times, TREMOR, 3e-4)
    wobble = band_noise(rng, times, DRIFT, 0.05) + band_noise(rng, times, TREMOR, 4e-3)
    orientation = orientation * Rotation.from_rotvec(wobble)
    return times, position, orientation.as_quat()


def main(target: Path) -> None:
    """Write the motion as a TUM trajectory file."""
    times, positions, quaternions = hand_motion()
    lines = [
        "# synthetic hand motion, written by make_hand_motion.py; no recording",
        f"# seed {SEED}; sweep, drift, tremor of {TREMOR[0]:g} to {TREMOR[1]:g} Hz, lost frames",
        "# timestamp tx ty tz qx qy qz qw (s, m)",
    ]
    for time, position, quaternion in zip(times, positions, quaternions, strict=True):
        numbers = " ".join(f"{value:.6f}" for value in (*position, *quaternion))
        lines.append(f"{time:.6f} {numbers}")
    target.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).with_name("hand_motion.tum"))
