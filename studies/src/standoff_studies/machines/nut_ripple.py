"""How the force on a nut ripples as it turns on its bolt, exact beside meshes:
``python -m standoff_studies.machines.nut_ripple``.

The nut goes along its helix, and overlaps the bolt along the normal of the flank by as much at each
angle. So the force along the axis should be the same all the time. The meshes have their corners on
the same surfaces, and are as far from their crest as their tolerance, a part of the bolt's size.

A mesh of a whole nut has more pairs of pieces, and more springs, than there is room for. So a
part of the nut turns on a part of the bolt's turn; the exact nut is told as a whole as well.
"""

from __future__ import annotations

import numpy as np

import standoff as so
from standoff import simulation as sim
from standoff.kernels.solids.contact_places import MOST_ROWS
from standoff.solids import Solid
from standoff_studies.machines.ripple import Push, pushed_along
from standoff_studies.machines.threads import (
    THREAD,
    TURN,
    bolt,
    chords_within,
    faceted_segment,
    nut,
    segment,
)

BORE, OUTSIDE = 0.004, 0.015
"""Radii of the bolt's hole, and of the nut, metres."""
PLAY = 2.5e-4
"""Of the nut, all round, metres: wide enough that no crest of the coarsest mesh meets a root."""
OVERLAP = 1e-5
"""Along the normal of the flank, metres."""
OFF = 1e-7
"""Of the nut from the bolt's axis, metres: on the axis the whole line of contact is as deep, and
the exact nut's springs are at places of chance along it."""
NUT, TURNED = TURN / 8.0, TURN / 16.0
"""Angle of the nut's part; and how far it turns, radians. The bolt's part has as much of an angle
to spare at both ends."""
TICKS = 800
TOLERANCES = (1e-2, 1e-3, 1e-4)


def exact_parts() -> tuple[Solid, Solid]:
    """The part of the bolt and that of the nut."""
    spread = NUT + 3.0 * TURNED
    return (
        segment(THREAD, spread, BORE, 0.0, "bolt"),
        segment(THREAD, NUT, OUTSIDE, PLAY, "nut"),
    )


def meshed_parts(part: float) -> tuple[Solid, Solid]:
    """The same as meshes to a part of the bolt's size."""
    made = [
        faceted_segment(THREAD, (angle, _chords(part, angle)), other, apart, name)
        for angle, other, apart, name in (
            (NUT + 3.0 * TURNED, BORE, 0.0, "bolt"),
            (NUT, OUTSIDE, PLAY, "nut"),
        )
    ]
    return made[0], made[1]


def whole() -> tuple[Solid, Solid]:
    """Four turns of the bolt, and two of the nut."""
    return bolt(THREAD, 4, BORE), nut(THREAD, 2, OUTSIDE, PLAY)


def turned(a: Solid, b: Solid, ticks: int = TICKS) -> Push:
    """What pushes the nut up while it turns on the bolt; times are angles, radians, and forces in
    that of a spring that is as deep as the overlap."""
    rise = THREAD.climb(1.0)
    steep = np.sqrt(1.0 + THREAD.slope**2 + (rise / THREAD.radius) ** 2)
    down = PLAY * np.hypot(1.0, THREAD.slope) + OVERLAP * steep
    start = so.Pose(so.Pose.exp([0, 0, TURNED]).rotation, [OFF, 0, THREAD.climb(TURNED) - down])
    path = so.motion.ConstantTwist(start, so.Twist([0, 0, rise], [0, 0, 1.0]))
    law = sim.HuntCrossley(stiffness=1e6, depth=OVERLAP)
    fixed = so.Pose.identity(), so.Twist.zero()
    push = pushed_along(a, fixed, b, path, law, (TURNED / ticks, ticks))
    return push._replace(force=push.force / law.force(OVERLAP))


def ripple(force: np.ndarray) -> float:
    """From the least to the greatest, of the mean."""
    return float(np.ptp(force) / force.mean())


def described(name: str, push: Push) -> str:
    up, depth = push.force[:, 2], -1e6 * push.distance
    return (
        f"{name}: force {up.mean():.3g}, from {up.min():.4g} to {up.max():.4g}, ripple "
        f"{100.0 * ripple(up):.2g} %; deepest {depth.min():.2f} to {depth.max():.2f} um; "
        f"{push.spots.min()} to {push.spots.max()} spots; {push.rows} pairs of pieces of "
        f"{MOST_ROWS}; {push.uncertified} of {len(up)} ticks not certified, {push.jumps} jumps"
    )


def pushes() -> dict[str, Push]:
    """Of the meshes, then of the exact part, by name."""
    parts = {f"mesh to {part:g} of the size": meshed_parts(part) for part in TOLERANCES}
    parts["exact"] = exact_parts()
    return {name: turned(*pair) for name, pair in parts.items()}


def _chords(part: float, angle: float) -> int:
    return chords_within(THREAD.radius, angle, part * 2.0 * THREAD.radius)


def main() -> None:
    for name, push in (pushes() | {"exact, a whole nut": turned(*whole())}).items():
        print(described(name, push))


if __name__ == "__main__":
    main()
