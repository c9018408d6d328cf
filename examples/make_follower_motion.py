"""Write `follower_motion.csv`: the lift that keeps a roller 0.2 mm off the cam of `cam.toml`.

The cam is a tangent cam: a base circle, a nose circle, and the two lines that touch both. The
roller follower moves along y above the cam's axis while the cam turns. With the roller's radius and
the clearance added, the follower's centre runs on a curve parallel to the cam, whose height over
the axis is known for each cam angle:

    python examples/make_follower_motion.py
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

BASE = 0.020  # m, radius of the base circle
NOSE = 0.008  # m, radius of the nose circle
CENTRES = 0.024  # m, from the cam's axis to the nose's centre; the lift is 0.012 m
ROLLER = 0.006  # m
CLEARANCE = 0.0002  # m
SPEED = 10.0 * math.pi  # rad/s, counterclockwise: 300 revolutions a minute
TURN = 0.2  # s, one revolution
STEPS = 800


def height(angle: float) -> float:
    """Return the height of the roller's centre over the cam's axis [m].

    `angle` [rad] is that from the follower's line to the nose; the cam is symmetric about it.
    """
    off = abs((angle + math.pi) % math.tau - math.pi)
    reach = ROLLER + CLEARANCE
    # The flank's normal is at this angle from the nose: the line touches both circles.
    normal = math.acos((BASE - NOSE) / CENTRES)
    # Where the parallel of the nose ends and that of the flank begins, seen from the axis.
    x = CENTRES + (NOSE + reach) * math.cos(normal)
    y = (NOSE + reach) * math.sin(normal)
    if off <= math.atan2(y, x):
        across = CENTRES * math.sin(off)
        return CENTRES * math.cos(off) + math.sqrt((NOSE + reach) ** 2 - across**2)
    if off <= normal:
        return (BASE + reach) / math.cos(normal - off)
    return BASE + reach


def main(target: Path) -> None:
    """Write the motion as a CSV table."""
    lines = [
        "# roller follower of cam.toml, written by make_follower_motion.py; s, m",
        "t,x,y,z,qx,qy,qz,qw",
    ]
    for k in range(STEPS + 1):
        time = TURN * k / STEPS
        # The nose points along x at time 0, the follower's line along y.
        lift = height(SPEED * time - 0.5 * math.pi)
        lines.append(f"{time:.6f},0,{lift:.12f},0,0,0,0,1")
    target.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    default = Path(__file__).with_name("follower_motion.csv")
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else default)
