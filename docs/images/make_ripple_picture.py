"""The picture of the force between two gears, exact beside meshes:
``python docs/images/make_ripple_picture.py``.

Both gears turn as they should, and overlap along their line of action by as much at each angle. So
the force of involutes is the same all the time for each pair of teeth that is in mesh, and so is
its direction. The meshes have their corners on the same involutes, and are as far from them as
their tolerance, a part of the smaller gear's size. All are Standoff's solids.
"""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np

import standoff as so
from standoff import simulation as sim
from standoff.geometry import Curve, Line
from standoff_studies.machines.prisms import extruded
from standoff_studies.machines.ripple import pushed_along

HERE = Path(__file__).parent
GEARS = HERE.parents[1] / "examples" / "planar" / "gears.py"
TEETH, MODULE, THINNING = (20, 30), 1e-3, 2e-3
UPWARDS = 70.0
"""Degrees from the x-axis, of the line of action: a right angle less the pressure angle."""
CORNERS = 2
"""Springs of a line of contact: one at each of its ends."""
OVERLAP = 1e-5
"""Along the line of action, metres."""
TOLERANCES = (1e-2, 1e-3, 1e-4)
PITCHES, FRAMES = 2.0, 600
ROUND = 2.6
"""Pitches on both sides of where they mesh, of whose teeth a gear is made."""


class Ripple(NamedTuple):
    """Over the turn in pitches: the force, in that of one pair of teeth; and how far the normal of
    the deepest place, and the force, are off the line of action, degrees, nan without contact."""

    turn: np.ndarray
    force: np.ndarray
    normal: np.ndarray
    aside: np.ndarray


def sector(gear: so.PlanarSolid, teeth: int) -> so.PlanarSolid:
    """The teeth about the x-axis alone."""
    curves = gear.loops[0].curves
    middles = np.array([c.point(0.5 * (c.first + c.last))[:2] for c in curves])
    near = np.abs(np.arctan2(middles[:, 1], middles[:, 0])) < ROUND * 2.0 * np.pi / teeth
    first = next(k for k in range(len(curves)) if near[k] and not near[k - 1])
    own = [curves[(first + k) % len(curves)] for k in range(np.count_nonzero(near))]
    ends = [_outer_end(own[0], own[1]), _outer_end(own[-1], own[-2])]
    return so.PlanarSolid.from_loops([*own, Line(ends[1], (0, 0)), Line((0, 0), ends[0])])


def _outer_end(curve: Curve, other: Curve) -> np.ndarray:
    """The end of a curve that it does not share with another one."""
    ends, taken = (np.array([c.point(c.first)[:2], c.point(c.last)[:2]]) for c in (curve, other))
    away = np.linalg.norm(ends[:, None] - taken[None], axis=2).min(axis=1)
    return ends[away.argmax()]


def faceted(gear: so.PlanarSolid, tolerance: float) -> so.PlanarSolid:
    """A polygon with corners on the curves, and no farther from them than a length."""
    corners = []
    loop = gear.loops[0]
    for curve, back in zip(loop.curves, loop.backward, strict=True):
        found = _chords(curve, tolerance)
        corners += (found[::-1] if back else found)[:-1]
    return so.PlanarSolid.from_loops(
        [Line(p, q) for p, q in zip(corners, corners[1:] + corners[:1], strict=True)]
    )


def _chords(curve: Curve, tolerance: float) -> list[np.ndarray]:
    """Points along a curve, as few as the tolerance allows."""
    for n in range(1, 200):
        at = np.linspace(curve.first, curve.last, n + 1)
        points = np.array([curve.point(t)[:2] for t in at])
        chords = 0.5 * (points[1:] + points[:-1])
        middles = np.array([curve.point(t)[:2] for t in 0.5 * (at[1:] + at[:-1])])
        if np.linalg.norm(middles - chords, axis=1).max() <= tolerance:
            break
    return list(points)


def turned_through(a: so.PlanarSolid, b: so.PlanarSolid, bases: tuple[float, float]) -> Ripple:
    """What pushes gear B while both turn through some pitches."""
    drawn = runpy.run_path(str(GEARS))
    pitch = 2.0 * np.pi / TEETH[0]
    begin, ratio = -0.5 * PITCHES * pitch, TEETH[0] / TEETH[1]
    pose_a, pose_b = drawn["in_mesh"](begin, *TEETH, 0.5 * MODULE * sum(TEETH))
    lag = (THINNING * sum(bases) + OVERLAP) / bases[1]
    pose_b = pose_b @ so.Pose(drawn["turn"](lag), (0, 0, 0))
    start = pose_a, so.Twist([0, 0, 0], [0, 0, 1.0])
    path = so.motion.ConstantTwist(pose_b, so.Twist([0, 0, 0], [0, 0, -ratio]))
    law = sim.HuntCrossley(stiffness=1e6, depth=OVERLAP)
    solids = extruded(a, -1e-3, 6e-3), extruded(b, 0.0, 5e-3)
    ticks = PITCHES * pitch / FRAMES, FRAMES
    push = pushed_along(solids[0], start, solids[1], path, law, ticks)
    pressed, force = push.distance < 0.0, push.force
    ways = push.normal, force
    off = [
        np.where(pressed, np.degrees(np.arctan2(w[:, 1], w[:, 0])) - UPWARDS, np.nan) for w in ways
    ]
    whole = np.linalg.norm(force, axis=1) / (CORNERS * law.force(OVERLAP))
    return Ripple(push.times / pitch, whole, *off)


def drawn_as(found: dict[str, Ripple]) -> None:
    fig, (top, low) = plt.subplots(2, 1, figsize=(8.0, 5.4), sharex=True, constrained_layout=True)
    for name, ripple in found.items():
        look = {"color": "black", "lw": 1.8} if name == "exact" else {"lw": 0.9}
        top.plot(ripple.turn, ripple.force, label=name, **look)
        low.plot(ripple.turn, ripple.normal, **look)
    top.set_ylabel("force, of that of a pair of teeth")
    low.set_ylabel("normal of the deepest place\noff the line of action (degrees)")
    low.set_xlabel("turn (pitches)")
    top.set_ylim(0.0, 2.6)
    top.legend(loc="upper center", ncols=2, frameon=False)
    for each in (top, low):
        each.set_xlim(0.0, PITCHES)
        each.spines[["top", "right"]].set_visible(False)
    fig.savefig(HERE / "ripple.png", dpi=110)


def main() -> None:
    drawn = runpy.run_path(str(GEARS))
    made = [drawn["involute_gear"](teeth, MODULE, thinning=THINNING) for teeth in TEETH]
    gears = [sector(gear, teeth) for (gear, _), teeth in zip(made, TEETH, strict=True)]
    bases = made[0][1], made[1][1]
    size = MODULE * (TEETH[0] + 2)
    found = {}
    for part in TOLERANCES:
        meshes = [faceted(gear, part * size) for gear in gears]
        found[f"mesh to {part:g} of the size"] = turned_through(*meshes, bases)
    found["exact"] = turned_through(*gears, bases)
    for name, (_, force, normal, aside) in found.items():
        print(
            f"{name}: force {force.mean():.2f}, from {force.min():.2f} to {force.max():.2f}, its "
            f"direction {np.ptp(aside[~np.isnan(aside)]):.2g} degrees; normals "
            f"{np.ptp(normal[~np.isnan(normal)]):.2g} degrees"
        )
    drawn_as(found)


if __name__ == "__main__":
    main()
