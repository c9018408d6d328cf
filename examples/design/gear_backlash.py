"""A pair of gears with rounded tips, thinned by gradient until their backlash is as wanted.

Backlash is the sum of the gaps on both flanks, along the lines of action. The centre distance has a
tolerance, and the wanted backlash is for the least one. The teeth's thinning is found by Newton's
method on proven gaps and their derivatives by design. Run it as `python gear_backlash.py`; it needs
the extra `formulas`.
"""

import runpy
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

import standoff as so

GEARS = runpy.run_path(str(Path(__file__).parents[1] / "planar" / "gears.py"))
MODULE, ROUNDING = 1.0, 0.25
"""Module, and radius of the tips' corners [mm]."""
PLAY = 0.02
"""By how much the axes may be nearer to each other than they should [mm]."""
WANTED = 0.05
"""Least backlash along the line of action [mm]."""
TURN = 2e-4
"""By which B is turned out of the middle, so that one flank is the nearest [rad]."""
ENOUGH = 1e-10
"""At which Newton's method ends [mm]."""


class Pair(NamedTuple):
    """Two gears as designs, and the distance of their axes [mm]."""

    teeth: tuple[int, int]
    a: so.Design
    b: so.Design
    centres: float

    @classmethod
    def of(cls, teeth, thinning, centres):
        """`thinning` [rad] is taken from each side of each tooth."""
        made = {z: so.Design(gear(z), thinning=thinning, rounding=ROUNDING) for z in set(teeth)}
        return cls(teeth, *(made[z] for z in teeth), centres)

    def changed(self, **parameters):
        """The same with other parameters of both gears."""
        a = self.a.changed(**parameters)
        return self._replace(a=a, b=a if self.b is self.a else self.b.changed(**parameters))

    def answer(self, angle, turned):
        """The distance where A has turned by an angle, and B out of its middle by another."""
        a, b = GEARS["in_mesh"](angle, *self.teeth, self.centres)
        b = so.Pose(b.rotation @ GEARS["turn"](turned), b.translation)
        return so.distance(self.a.body, self.b.body, a, b)


def gear(teeth):
    def make(thinning, rounding):
        return GEARS["involute_gear"](teeth, MODULE, thinning=thinning, rounding=rounding)[0]

    return make


def base(teeth):
    """Radius of the circle of which the flanks are involutes [mm]."""
    return 0.5 * MODULE * teeth * np.cos(GEARS["PRESSURE_ANGLE"])


def positions(pair, count):
    """Angles of A over one tooth."""
    return np.linspace(0.0, 2.0 * np.pi / pair.teeth[0], count, endpoint=False)


def backlash(pair, angle):
    """(backlash [mm], its derivatives by the parameters of both gears and by the centre distance).

    A turn of B by TURN moves its flank by TURN times the base circle's radius along the line of
    action, and the gap on the other side grows as much: what is added does not change.
    """
    total = 2.0 * TURN * base(pair.teeth[1])
    rates = dict.fromkeys([*pair.a.parameters, "centres"], 0.0)
    for turned in (TURN, -TURN):
        answer = pair.answer(angle, turned)
        by = so.shape_gradient(answer, a=pair.a, b=pair.b)
        total += answer.distance
        for name in pair.a.parameters:
            rates[name] += by.a[name] + by.b[name]
        rates["centres"] += answer.normal[0]  # B moves along x
    return total, rates


def least(pair, count):
    """The least backlash of some positions of the mesh, and its derivatives."""
    return min((backlash(pair, angle) for angle in positions(pair, count)), key=lambda x: x[0])


def thinned(pair, count=5, wanted=WANTED):
    """(pair, steps): Newton's method on the thinning that leaves a wanted backlash."""
    steps = []
    for _ in range(10):
        found, rates = least(pair, count)
        thinning = pair.a.parameters["thinning"]
        steps.append((thinning, found, rates))
        if abs(found - wanted) <= ENOUGH:
            return pair, steps
        pair = pair.changed(thinning=thinning - (found - wanted) / rates["thinning"])
    raise RuntimeError("The thinning was not found.")


def measured(pair, angle):
    """Backlash by turning B between its stops, where it touches A [mm]."""
    stops = [
        brentq(lambda turned: pair.answer(angle, turned).distance, 0.0, way * 0.02, xtol=1e-13)
        for way in (1.0, -1.0)
    ]
    return (stops[0] - stops[1]) * base(pair.teeth[1])


def by_formula(pair):
    """Backlash of involutes [mm], which at other centres meet at another pressure angle."""
    sum_of_bases = sum(base(z) for z in pair.teeth)
    angle, nominal = np.arccos(sum_of_bases / pair.centres), GEARS["PRESSURE_ANGLE"]
    involutes = (np.tan(angle) - angle) - (np.tan(nominal) - nominal)
    return 2.0 * sum_of_bases * (involutes + pair.a.parameters["thinning"])


def main(teeth=(20, 31), count=5):
    nominal = 0.5 * MODULE * sum(teeth)
    pair, steps = thinned(Pair.of(teeth, 2e-3, nominal - PLAY), count)
    for thinning, found, _ in steps:
        print(f"thinning {1e3 * thinning:.6f} mrad, least backlash {found:.9f} mm")
    for name, rate in steps[-1][2].items():
        print(f"backlash by {name}: {rate:+.6f}")
    for centres in (nominal - PLAY, nominal, nominal + PLAY):
        there = pair._replace(centres=centres)
        turned = [measured(there, angle) for angle in positions(pair, count)]
        print(
            f"axes {centres:.2f} mm apart: backlash {by_formula(there):.9f} mm by formula, "
            f"{min(turned):.9f} to {max(turned):.9f} mm by turning B between its stops"
        )


if __name__ == "__main__":
    main()
