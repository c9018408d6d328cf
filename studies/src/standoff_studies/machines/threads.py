"""A bolt and its nut: profiles swept along a helix, by formulas, closed by a ramp at each end."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from standoff.geometry import FormulaSurface
from standoff.motion import Pose
from standoff.solids import Solid
from standoff_studies.machines.polyhedra import polyhedron

Corner = tuple[float, float]
TURN = 2.0 * np.pi
Z = np.array([0.0, 0.0, 1.0])


class Thread(NamedTuple):
    """A trapezoidal thread, right-handed, about the axis z. Lengths.

    Attributes
    ----------
    radius : float
        Of the bolt's crest.
    pitch : float
        Axial, from turn to turn.
    height : float
        Radial, of the bolt's ridge.
    crest : float
        Axial, of the bolt's ridge at its crest.
    slope : float
        Axial over radial, of a flank.
    """

    radius: float
    pitch: float
    height: float
    crest: float
    slope: float

    def profile(self, apart: float = 0.0) -> list[Corner]:
        """(radius, height) of a turn upwards, all of it moved off the bolt by a length along the
        normal of its profile."""
        lean = float(np.hypot(1.0, self.slope))
        wide = 0.5 * self.crest + apart * (lean - self.slope)
        foot = wide + self.slope * self.height
        low, high = self.radius - self.height + apart, self.radius + apart
        half = 0.5 * self.pitch
        return [(low, -half), (low, -foot), (high, -wide), (high, wide), (low, foot), (low, half)]

    def climb(self, turned: float) -> float:
        """How far a nut goes along the axis as it turns by an angle, radians."""
        return self.pitch * turned / TURN


THREAD = Thread(radius=0.01, pitch=0.003, height=0.0015, crest=0.0006, slope=0.5)
"""Of 20 mm, as the machines have it; metres."""


def bolt(thread: Thread, turns: int, bore: float, name: str = "bolt") -> Solid:
    """Turns of a bolt, two or more, from half a pitch below z = 0, with a round hole along it."""
    return _threaded(thread, thread.profile(), bore, (turns, TURN), name)


def nut(thread: Thread, turns: int, outside: float, play: float, name: str = "nut") -> Solid:
    """Turns of a nut, two or more, round outside, as far from the bolt's profile as the play."""
    return _threaded(thread, thread.profile(play), outside, (turns, TURN), name)


def segment(
    thread: Thread, angle: float, other: float, apart: float, name: str = "segment"
) -> Solid:
    """One turn of the profile, moved off the bolt by a length, through an angle below a whole turn:
    of a bolt where the radius of the other wall is the less, else of a nut."""
    return _threaded(thread, thread.profile(apart), other, (1, angle), name)


def faceted_segment(
    thread: Thread, sweep: tuple[float, int], other: float, apart: float, name: str = "segment"
) -> Solid:
    """`segment` of plane faces whose corners lie on it; its angle, and of how many chords."""
    (angle, chords), profile = sweep, thread.profile(apart)
    ring = [*profile, (other, profile[-1][1]), (other, profile[0][1])]
    n, loops = len(ring), []
    for k in range(n):
        after = (k + 1) % n
        plane = ring[k][0] == ring[after][0]
        for at in range(0, n * chords, n):
            a, b, c, d = at + k, at + n + k, at + n + after, at + after
            loops += [[a, b, c, d]] if plane else [[a, b, c], [a, c, d]]
    loops += [[at + k for k in range(n)] for at in (0, n * chords)]
    points = [
        (radius * np.cos(turned), radius * np.sin(turned), height + thread.climb(turned))
        for turned in np.linspace(0.0, angle, chords + 1)
        for radius, height in ring
    ]
    return polyhedron(np.array(points), loops, name)


def chords_within(radius: float, angle: float, tolerance: float) -> int:
    """The fewest chords of an arc that are within a length of it."""
    return int(np.ceil(0.5 * angle / np.arccos(1.0 - tolerance / radius)))


def _threaded(
    thread: Thread, profile: list[Corner], other: float, sweeps: tuple[int, float], name: str
) -> Solid:
    """What is between a profile, swept along the helix, and a cylinder of another radius;
    `sweeps`: how many there are, and the angle of each, a turn where there are several."""
    (turns, angle), rise = sweeps, thread.pitch / TURN
    back = [(other, z) for _, z in profile]
    strips = [_strip(p, q, rise, angle) for side in (profile, back) for p, q in pairwise(side)]
    patches = [
        strip.transformed(np.eye(3), thread.pitch * k * Z) for k in range(turns) for strip in strips
    ]
    for corner, far, k in ((profile[0], back[0], 0), (profile[-1], back[-1], turns - 1)):
        ramp = _strip(corner, far, rise, angle)
        patches.append(ramp.transformed(np.eye(3), thread.pitch * k * Z))
    end = Pose.exp([0.0, 0.0, turns * angle]).rotation
    for k in range(len(profile) - 1):
        step = _quad(profile[k], profile[k + 1], back[k + 1], back[k])
        patches += [step, step.transformed(end, thread.climb(turns * angle) * Z)]
    return Solid.from_patches(patches, name=name)


def _strip(p: Corner, q: Corner, rise: float, angle: float) -> FormulaSurface:
    """A segment of the profile, swept through an angle along the helix."""
    r, z = f"({p[0]!r} + {q[0] - p[0]!r}*u)", f"({p[1]!r} + {q[1] - p[1]!r}*u)"
    domain = (0.0, 1.0, 0.0, angle)
    return FormulaSurface(f"{r}*cos(v)", f"{r}*sin(v)", f"{z} + {rise!r}*v", domain)


def _quad(p: Corner, q: Corner, s: Corner, t: Corner) -> FormulaSurface:
    """A plane piece of the half-plane at angle 0, with corners in turn."""
    coefficients = [(p[k], q[k] - p[k], t[k] - p[k], p[k] - q[k] + s[k] - t[k]) for k in (0, 1)]
    x, z = (f"{a!r} + {b!r}*u + {c!r}*v + {d!r}*u*v" for a, b, c, d in coefficients)
    return FormulaSurface(x, "0", z, (0.0, 1.0, 0.0, 1.0))
