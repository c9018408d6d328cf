"""A bolt and its nut: profiles swept along a helix, by formulas, closed by a ramp at each end."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from standoff.geometry import FormulaSurface
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
    return _threaded(thread, thread.profile(), bore, turns, name)


def nut(thread: Thread, turns: int, outside: float, play: float, name: str = "nut") -> Solid:
    """Turns of a nut, two or more, round outside, as far from the bolt's profile as the play."""
    return _threaded(thread, thread.profile(play), outside, turns, name)


def faceted_bolt(
    thread: Thread, turns: int, bore: float, chords: int, name: str = "bolt"
) -> Solid:
    """What `bolt` is, of plane faces with so many chords to a turn, whose corners lie on it."""
    return _faceted(thread, thread.profile(), bore, (turns, chords), name)


def faceted_nut(
    thread: Thread, turns: int, outside: float, play: float, chords: int, name: str = "nut"
) -> Solid:
    """What `nut` is, of plane faces with so many chords to a turn, whose corners lie on it."""
    return _faceted(thread, thread.profile(play), outside, (turns, chords), name)


def chords_within(radius: float, tolerance: float) -> int:
    """The fewest chords of a turn that are within a length of their arcs."""
    return int(np.ceil(np.pi / np.arccos(1.0 - tolerance / radius)))


def _faceted(
    thread: Thread, profile: list[Corner], other: float, count: tuple[int, int], name: str
) -> Solid:
    """What `_threaded` makes, its strips cut into chords: plane quadrilaterals where the radius is
    the same all along, and two triangles elsewhere."""
    (turns, chords), far = count, len(profile) - 1
    end = turns * chords
    # the last line of the profile is the first one of the next turn; `far` is on the other cylinder
    lines = [*profile[:-1], (other, profile[0][1])]
    numbers: dict[tuple[int, int], int] = {}
    points = []

    def at(line: int, step: int) -> int:
        if (line, step) not in numbers:
            numbers[line, step] = len(points)
            (radius, height), angle = lines[line], TURN * step / chords
            climb = height + thread.climb(angle)
            points.append((radius * np.cos(angle), radius * np.sin(angle), climb))
        return numbers[line, step]

    def top(line: int, step: int) -> int:
        return at(line, step) if line < far else at(0, step + chords)

    loops = [
        loop
        for k in range(far)
        for i in range(end)
        for loop in _chord(
            (at(k, i), at(k, i + 1), top(k + 1, i + 1), top(k + 1, i)),
            profile[k][0] == profile[k + 1][0],
        )
    ]
    loops += [
        (at(far, i), at(far, i + 1), at(far, i + 1 + chords), at(far, i + chords))
        for i in range(end)
    ]
    for first in (0, end):
        for i in range(first, first + chords):
            loops += _chord((at(0, i), at(0, i + 1), at(far, i + 1), at(far, i)), plane=False)
        rows = [at(k, first) for k in range(far)]
        loops.append((*rows, at(0, first + chords), at(far, first + chords), at(far, first)))
    return polyhedron(np.array(points), loops, name)


def _chord(corners: tuple[int, int, int, int], plane: bool) -> list[tuple[int, ...]]:
    """A chord of a strip, as loops of vertices."""
    a, b, c, d = corners
    return [corners] if plane else [(a, b, c), (a, c, d)]


def _threaded(thread: Thread, profile: list[Corner], other: float, turns: int, name: str) -> Solid:
    """What is between a profile, swept along the helix, and a cylinder of another radius."""
    rise = thread.pitch / TURN
    back = [(other, z) for _, z in profile]
    strips = [_strip(p, q, rise) for side in (profile, back) for p, q in pairwise(side)]
    patches = [
        strip.transformed(np.eye(3), thread.pitch * k * Z) for k in range(turns) for strip in strips
    ]
    for corner, far, k in ((profile[0], back[0], 0), (profile[-1], back[-1], turns - 1)):
        ramp = _strip(corner, far, rise)
        patches.append(ramp.transformed(np.eye(3), thread.pitch * k * Z))
    for k in range(len(profile) - 1):
        step = _quad(profile[k], profile[k + 1], back[k + 1], back[k])
        patches += [step.transformed(np.eye(3), thread.pitch * i * Z) for i in (0, turns)]
    return Solid.from_patches(patches, name=name)


def _strip(p: Corner, q: Corner, rise: float) -> FormulaSurface:
    """A segment of the profile, swept by a turn along the helix."""
    r, z = f"({p[0]!r} + {q[0] - p[0]!r}*u)", f"({p[1]!r} + {q[1] - p[1]!r}*u)"
    return FormulaSurface(f"{r}*cos(v)", f"{r}*sin(v)", f"{z} + {rise!r}*v", (0.0, 1.0, 0.0, TURN))


def _quad(p: Corner, q: Corner, s: Corner, t: Corner) -> FormulaSurface:
    """A plane piece of the half-plane at angle 0, with corners in turn."""
    coefficients = [(p[k], q[k] - p[k], t[k] - p[k], p[k] - q[k] + s[k] - t[k]) for k in (0, 1)]
    x, z = (f"{a!r} + {b!r}*u + {c!r}*v + {d!r}*u*v" for a, b, c, d in coefficients)
    return FormulaSurface(x, "0", z, (0.0, 1.0, 0.0, 1.0))
