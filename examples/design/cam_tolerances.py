"""Tolerances of a cam and its roller: the lash of a million parts at every angle of the cam.

The roller keeps its nominal motion, which leaves the same lash at each angle. Each dimension of a
part has a deviation of its own; to first order the lash changes by derivative times deviation, and
the derivatives at all angles come from one call. Some parts are made and their lash is computed
anew, to see how good the first order is. Run it as `python cam_tolerances.py 1000000`.
"""

import sys
import time

import numpy as np

import standoff as so
from standoff.geometry import ConicArc, Line

LASH = 0.25
"""Gap between cam and roller at nominal dimensions [mm]."""
ALLOWED = 0.1
"""A part is good if its lash is nowhere less [mm]."""
CAM = {"base": 15.0, "nose": 6.0, "reach": 16.0, "phase": 0.1}
"""Radii of base circle and nose, distance of the nose's centre from the shaft's [mm]; angle of the
nose from its key [rad]."""
ROLLER = {"radius": 8.0}
DEVIATION = {"base": 0.02, "nose": 0.03, "reach": 0.03, "phase": 0.002, "radius": 0.01}
"""Standard deviations of the dimensions [mm, rad]."""
AT_ONCE = 20_000
"""Parts whose numbers are in memory together."""


def cam(base, nose, reach, phase):
    """Two arcs and their common tangents, the nose at `phase` from the y axis."""
    tilt = np.arcsin((base - nose) / reach)
    turn = np.array([[np.cos(phase), -np.sin(phase)], [np.sin(phase), np.cos(phase)]])
    top, x, y = turn @ [0.0, reach], turn[:, 0], turn[:, 1]
    right, left = (turn @ [way * np.cos(tilt), np.sin(tilt)] for way in (1.0, -1.0))
    return so.shapes.planar_loop(
        [
            ConicArc((0, 0), base * x, base * y, np.pi - tilt, 2.0 * np.pi + tilt),
            Line(base * right, top + nose * right),
            ConicArc(top, nose * x, nose * y, tilt, np.pi - tilt),
            Line(top + nose * left, base * left),
        ]
    )


def roller(radius):
    return so.shapes.planar_loop([ConicArc((0, 0), (radius, 0), (0, radius))])


def turned(count):
    """Poses of the cam over a turn of the shaft."""
    angles = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    poses = np.tile(np.eye(4), (count, 1, 1))
    poses[:, 0, 0] = poses[:, 1, 1] = np.cos(angles)
    poses[:, 1, 0] = np.sin(angles)
    poses[:, 0, 1] = -poses[:, 1, 0]
    return angles, poses


def follower(shape, wheel, poses):
    """Poses of the roller, on the y axis, that leave the nominal lash: Newton's method."""
    placed = np.tile(np.eye(4), (len(poses), 1, 1))
    placed[:, 1, 3] = CAM["reach"] + CAM["nose"] + ROLLER["radius"] + 2.0 * LASH
    for _ in range(50):
        found = so.distances(shape, wheel, poses, placed, warm=True)
        off = found.distance - LASH
        if np.abs(off).max() <= 1e-12:
            return placed
        placed[:, 1, 3] -= off / found.normal[:, 1]
    raise RuntimeError("The follower's motion was not found.")


def first_order(count):
    """(poses, (names, lash, rates)): the nominal lash (m,) at each angle, and its derivatives
    (dimensions, m)."""
    shape, wheel = so.Design(cam, **CAM), so.Design(roller, **ROLLER)
    _, poses = turned(count)
    placed = follower(shape.body, wheel.body, poses)
    nominal = so.distances(shape.body, wheel.body, poses, placed)
    by = so.shape_gradient(nominal, a=shape, b=wheel)
    rates = {**by.a, **by.b}
    return (poses, placed), (list(rates), nominal.distance, np.array(list(rates.values())))


def deviations(rng, names, count):
    """(n, dimensions) of n parts."""
    return rng.normal(0.0, [DEVIATION[name] for name in names], (count, len(names)))


def least_lashes(lash, rates, off):
    """(n,) the least lash of each part over the turn, to first order."""
    return (lash + off @ rates).min(axis=1)


def made(names, off, poses):
    """(m,) lash of one part, which is made."""
    given = {name: (CAM | ROLLER)[name] + x for name, x in zip(names, off.tolist(), strict=True)}
    wheel = roller(given.pop("radius"))
    return so.distances(cam(**given), wheel, *poses).distance


def analysed(parts, angles=360, remade=100, seed=7):
    """What `main` prints, as a dictionary."""
    rng = np.random.default_rng(seed)
    start = time.perf_counter()
    poses, (names, lash, rates) = first_order(angles)
    derived = time.perf_counter()
    least = []
    for first in range(0, parts, AT_ONCE):
        off = deviations(rng, names, min(AT_ONCE, parts - first))
        least.append(least_lashes(lash, rates, off))
    done = time.perf_counter()
    sample = deviations(rng, names, remade)
    exact = np.array([made(names, off, poses) for off in sample])
    linear = lash + sample @ rates
    sizes = np.array([DEVIATION[name] for name in names])
    return {
        "names": names,
        "rates": rates,
        "spread": np.sqrt(((rates.T * sizes) ** 2).sum(axis=1)),
        "least": np.concatenate(least),
        "exact": exact,
        "linear": linear,
        "seconds": (derived - start, done - derived, time.perf_counter() - done),
    }


def main(parts=100_000, angles=360, remade=100):
    found = analysed(parts, angles, remade)
    for name, rate in zip(found["names"], found["rates"], strict=True):
        print(f"lash by {name}: {rate.min():+.3f} to {rate.max():+.3f}")
    spread, least = found["spread"], found["least"]
    print(f"deviation of the lash: {spread.min():.4f} mm to {spread.max():.4f} mm over the turn")
    bad = np.count_nonzero(least < ALLOWED)
    print(
        f"{parts} parts: least lash {least.mean():.4f} ± {least.std():.4f} mm, of {bad} too small"
    )
    off = np.abs(found["exact"] - found["linear"])
    print(f"{remade} parts made: lash off the first order by {1e3 * off.max():.2f} um at most")
    told = "derivatives {:.2f} s, parts {:.2f} s, parts made {:.2f} s"
    print(told.format(*found["seconds"]))


if __name__ == "__main__":
    main(*(int(x) for x in sys.argv[1:]))
