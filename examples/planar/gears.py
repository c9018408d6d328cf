"""A pair of involute gears in mesh, and their proven flank clearance over a turn of ten teeth.

python examples/planar/gears.py
"""

import numpy as np

import standoff as so
from standoff.geometry import ConicArc, FormulaCurve, Line

PRESSURE_ANGLE = np.radians(20.0)
# Of the flank's start: the involute's tangent vanishes on the base circle itself.
FIRST_ROLL = 0.02


def involute_gear(teeth, module, pressure_angle=PRESSURE_ANGLE, thinning=0.0, rounding=0.0):
    """An external spur gear of the standard proportions, a tooth along x.

    The addendum is one module, the dedendum 1.25. `thinning` (radians) is taken from each side of
    each tooth; `rounding` is the radius of the corners of its tip.
    """
    pitch = 0.5 * module * teeth
    base = pitch * np.cos(pressure_angle)
    tip, root = pitch + module, pitch - 1.25 * module
    first = max(FIRST_ROLL, np.sqrt(max((root / base) ** 2 - 1.0, 0.0)))
    # a curve parallel to an involute is an involute of the same circle: the rounding's centre is on
    # one, at its own radius inside the tip
    last = (np.sqrt((tip - rounding) ** 2 - base**2) + rounding) / base
    beyond = base * last - rounding
    side = last - np.arctan(beyond / base)  # angle of that centre from the involute's start
    half = 0.5 * np.pi / teeth + np.tan(pressure_angle) - pressure_angle - thinning
    x, y = "r*(cos(t) + t*sin(t))", "r*(sin(t) - t*cos(t))"
    left = FormulaCurve(x, f"-{y}", "0", first, last, {"r": base})
    right = FormulaCurve(x, y, "0", first, last, {"r": base})
    at_tip, at_foot = half - side, half - (first - np.arctan(first))
    foot = base * np.hypot(1.0, first)
    curves = []
    for k in range(teeth):
        middle = 2.0 * np.pi * k / teeth
        corners = [
            circular(rounding, first, last, polar(tip - rounding, at))
            for at, first, last in (
                (middle - at_tip, middle - half + last - 0.5 * np.pi, middle - at_tip),
                (middle + at_tip, middle + at_tip, middle + half - last + 0.5 * np.pi),
            )
            if rounding
        ]
        curves += [
            right.transformed(turn(middle - half), np.zeros(3)),
            *corners[:1],
            circular(tip, middle - at_tip, middle + at_tip),
            *corners[1:],
            left.transformed(turn(middle + half), np.zeros(3)),
        ]
        low, high = middle + at_foot, middle + 2.0 * np.pi / teeth - at_foot
        if foot > root:
            curves.append(Line(polar(foot, low), polar(root, low)))
        curves.append(circular(root, low, high))
        if foot > root:
            curves.append(Line(polar(root, high), polar(foot, high)))
    return so.PlanarSolid.from_loops(curves, name=f"gear of {teeth} teeth"), base


def polar(r, angle):
    return r * np.array([np.cos(angle), np.sin(angle)])


def circular(r, first, last, centre=(0, 0)):
    return ConicArc(centre, (r, 0), (0, r), first, last)


def turn(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def in_mesh(angle, teeth_a, teeth_b, centres):
    """Poses at which A has turned by `angle`, B's tooth gap opposite to A's tooth at 0."""
    other = np.pi - np.pi / teeth_b - angle * teeth_a / teeth_b
    return so.Pose(turn(angle), (0, 0, 0)), so.Pose(turn(other), (centres, 0, 0))


def main():
    thinning = 1e-3
    a, base_a = involute_gear(20, 1.0, thinning=thinning)
    b, base_b = involute_gear(31, 1.0, thinning=thinning)
    # On the line of action, which touches both base circles, flanks are apart by what they were
    # thinned by on both base circles, at every angle.
    expected = thinning * (base_a + base_b)
    worst = 0.0
    for angle in np.linspace(0.0, 10 * 2 * np.pi / 20, 41):
        answer = so.distance(a, b, *in_mesh(angle, 20, 31, 25.5))
        assert answer.certified
        worst = max(worst, abs(answer.distance - expected))
    print(f"flank clearance {expected:.6g}, found at 41 angles to within {worst:.1e}")
    print(answer, f"with {len(answer.minima)} pairs of flanks at the same distance")


if __name__ == "__main__":
    main()
