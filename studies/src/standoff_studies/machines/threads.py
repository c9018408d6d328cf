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


def bolt(thread: Thread, turns: int, bore: float, name: str = "bolt") -> Solid:
    """Turns of a bolt, two or more, from half a pitch below z = 0, with a round hole along it."""
    return _threaded(thread, thread.profile(), bore, (turns, TURN), name)


def nut(thread: Thread, turns: int, outside: float, play: float, name: str = "nut") -> Solid:
    """Turns of a nut, two or more, round outside, as far from the bolt's profile as the play."""
    return _threaded(thread, thread.profile(play), outside, (turns, TURN), name)


def segment(thread: Thread, angle: float, outside: float, play: float) -> Solid:
    """What a nut has about one turn of the bolt's ridge, from the angle 0 to one below a turn."""
    return _threaded(thread, thread.profile(play), outside, (1, angle), "segment")


def faceted_bolt(thread: Thread, turns: int, bore: float, chords: int) -> Solid:
    """`bolt` of plane faces whose corners lie on it, so many chords to a turn."""
    return _faceted(thread, thread.profile(), bore, (turns, chords), "bolt")


def faceted_nut(thread: Thread, turns: int, outside: float, play: float, chords: int) -> Solid:
    """`nut` of plane faces whose corners lie on it, so many chords to a turn."""
    return _faceted(thread, thread.profile(play), outside, (turns, chords), "nut")


def faceted_segment(thread: Thread, own: int, outside: float, play: float, chords: int) -> Solid:
    """`segment` of plane faces whose corners lie on it, with its own of so many chords to a
    turn."""
    profile = thread.profile(play)
    ring = [*profile, (outside, profile[-1][1]), (outside, profile[0][1])]
    swept = _Chords(thread, ring, chords)
    for k in range(len(ring)):
        swept.strip((k, 0), ((k + 1) % len(ring), 0), range(own))
    swept.loops += [[swept.at(k, i) for k in range(len(ring))] for i in (0, own)]
    return swept.solid("segment")


def chords_within(radius: float, tolerance: float) -> int:
    """The fewest chords of a turn that are within a length of their arcs."""
    return int(np.ceil(np.pi / np.arccos(1.0 - tolerance / radius)))


class _Chords:
    """Corners on lines that are swept along the helix, at even angles, and loops of them."""

    def __init__(self, thread: Thread, lines: list[Corner], chords: int) -> None:
        self._thread, self._lines, self._chords = thread, lines, chords
        self._numbers: dict[tuple[int, int], int] = {}
        self._points: list[tuple[float, float, float]] = []
        self.loops: list[list[int]] = []

    def at(self, line: int, step: int) -> int:
        """The number of a line's corner."""
        if (line, step) not in self._numbers:
            self._numbers[line, step] = len(self._points)
            (radius, height), angle = self._lines[line], TURN * step / self._chords
            climb = height + self._thread.climb(angle)
            self._points.append((radius * np.cos(angle), radius * np.sin(angle), climb))
        return self._numbers[line, step]

    def strip(self, low: tuple[int, int], high: tuple[int, int], steps: range) -> None:
        """Between two lines, each with how many steps it is ahead: plane quadrilaterals where both
        are as far from the axis, else two triangles to a chord."""
        plane = self._lines[low[0]][0] == self._lines[high[0]][0]
        for i in steps:
            a, b, c, d = (
                self.at(line, ahead + k)
                for (line, ahead), k in ((low, i), (low, i + 1), (high, i + 1), (high, i))
            )
            self.loops += [[a, b, c, d]] if plane else [[a, b, c], [a, c, d]]

    def solid(self, name: str) -> Solid:
        return polyhedron(np.array(self._points), self.loops, name)


def _faceted(
    thread: Thread, profile: list[Corner], other: float, count: tuple[int, int], name: str
) -> Solid:
    """What `_threaded` makes of whole turns, of plane faces; `count`: of turns, and of chords."""
    (turns, chords), far = count, len(profile) - 1
    swept = _Chords(thread, [*profile[:-1], (other, profile[0][1])], chords)
    end = turns * chords
    # the profile's last line is its first one, a turn ahead; `far` is on the other cylinder
    lines = [*((k, 0) for k in range(far)), (0, chords)]
    for low, high in pairwise(lines):
        swept.strip(low, high, range(end))
    swept.strip((far, 0), (far, chords), range(end))
    for first in (0, end):
        swept.strip((0, 0), (far, 0), range(first, first + chords))
        corners = [*lines, (far, chords), (far, 0)]
        swept.loops.append([swept.at(line, ahead + first) for line, ahead in corners])
    return swept.solid(name)


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
