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
from standoff.cli.terminal import tell
from standoff.kernels.solids.contact_places import MOST_ROWS
from standoff.solids import Solid
from standoff_studies.machines.ripple import Push, one_after_the_other, pushed_along
from standoff_studies.machines.threads import (
    THREAD,
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
"""Of the nut from the bolt's axis, metres: on it a whole nut's flank is as deep all along, at more
spots than there is room for."""
NUT, TURNED = np.radians(43.4), np.radians(21.7)
"""Angle of the nut's part; and how far it turns, radians: two chords and one of the coarsest mesh.
The bolt's part has as much as the turn to spare at both ends."""
RUNS, TICKS = 8, 100
"""How often the turn begins anew, and the ticks of each: pairs of pieces that have come near are
kept until they are twice as many as at first, for which there is no room."""
TOLERANCES = (1e-2, 1e-3, 1e-4)
AT_REST = so.Pose.identity(), so.Twist.zero()


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


def turned(a: Solid, b: Solid, depth: float = OVERLAP, runs: int = RUNS) -> Push:
    """What pushes the nut up while it turns on the bolt; times are angles, radians, and forces in
    that of a spring that is as deep as the overlap. `depth`: the greatest that is to be expected,
    metres."""
    law = sim.HuntCrossley(stiffness=1e6, depth=depth)
    span = TURNED / runs
    found = []
    for k in range(runs):
        push = pushed_along(a, AT_REST, b, _helix(TURNED + span * k), law, (span / TICKS, TICKS))
        found.append(push._replace(times=push.times + span * k))
    push = one_after_the_other(found)
    return push._replace(force=push.force / law.force(OVERLAP))


def chord_reach(part: float) -> float:
    """How far a chord of a mesh is from its helix along the flank's normal, at most, metres."""
    return part * 2.0 * THREAD.radius * THREAD.slope / _steep()


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
    found = {
        f"mesh to {part:g} of the size": turned(*meshed_parts(part), OVERLAP + chord_reach(part))
        for part in TOLERANCES
    }
    return found | {"exact": turned(*exact_parts())}


def _helix(angle: float) -> so.motion.ConstantTwist:
    """Of the nut from an angle on, a radian a second."""
    down = PLAY * np.hypot(1.0, THREAD.slope) + OVERLAP * _steep()
    place = [OFF, 0.0, THREAD.climb(angle) - down]
    start = so.Pose(so.Pose.exp([0.0, 0.0, angle]).rotation, place)
    return so.motion.ConstantTwist(start, so.Twist([0, 0, THREAD.climb(1.0)], [0, 0, 1.0]))


def _steep() -> float:
    """How much longer a way along the axis is than along the flank's normal, at the crest."""
    rise = THREAD.climb(1.0) / THREAD.radius
    return float(np.sqrt(1.0 + THREAD.slope**2 + rise**2))


def _chords(part: float, angle: float) -> int:
    return chords_within(THREAD.radius, angle, part * 2.0 * THREAD.radius)


def main() -> None:
    for name, push in (pushes() | {"exact, a whole nut": turned(*whole())}).items():
        tell(described(name, push))


if __name__ == "__main__":
    main()
