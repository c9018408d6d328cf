"""A cam that bends inward, and how high it lifts its roller: found by the gradient of a proven gap.

python examples/planar/cam.py
"""

import numpy as np

import standoff as so
from standoff.geometry import ConicArc, FormulaCurve

ROLLER = 0.3
GAP = 1e-3


def cam():
    """Two noses, and hollows between them."""
    radius = "(1 + 0.35*cos(2*t) + 0.1*cos(t))"
    return so.PlanarSolid.from_loops(
        [FormulaCurve(f"{radius}*cos(t)", f"{radius}*sin(t)", "0", 0.0, 2.0 * np.pi)], name="cam"
    )


def roller():
    return so.PlanarSolid.from_loops([ConicArc((0, 0), (ROLLER, 0), (0, ROLLER))], name="roller")


def turned(angle):
    c, s = np.cos(angle), np.sin(angle)
    return so.Pose([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]], (0.0, 0.0, 0.0))


def lift(solid, follower, angle):
    """(height at which the roller's gap is GAP, the answer there), by Newton from above."""
    height = 3.0
    for _ in range(30):
        at = so.Pose(np.eye(3), (0.0, height, 0.0))
        answer = so.distance(solid, follower, turned(angle), at)
        excess = answer.distance - GAP
        if abs(excess) <= 1e-9:
            return height, answer
        # the gap grows by the normal's part along the follower's way
        height -= excess / max(answer.gradient_rows[7], 0.2)
    raise RuntimeError("The roller's height was not found.")


def main():
    solid, follower = cam(), roller()
    print("angle [deg]   height   pairs   side [deg]")
    for degrees in range(0, 360, 30):
        height, answer = lift(solid, follower, np.radians(degrees))
        side = np.degrees(np.arctan2(answer.normal[0], answer.normal[1]))
        print(f"{degrees:11d} {height:8.5f} {len(answer.minima):7d} {side:11.2f}")


if __name__ == "__main__":
    main()
