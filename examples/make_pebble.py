"""Write `pebble.json` and `pebble_motion.parquet`: the pebble of `pebble.toml`, and how it rolls.

The pebble begins as a cube whose six faces bulge: patches of degree (2, 2) that share their corners
and the control points along their sides, with blunt edges between them. A perspective map, which
keeps convex what is convex, makes it longer, flatter and thinner at one end; it also makes the
patches rational. It rolls along x, a little unsteadily, as pose samples of 100 a second:

    python examples/make_pebble.py
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.parquet as pq
from scipy.spatial.transform import Rotation

Array = npt.NDArray[np.float64]

SIDE = 1.4  # half edges from the centre, along both axes: control points amid the cube's edges
FACE = 2.2  # the same amid the faces; SIDE / (2 - SIDE) and more would dent the corners
AXES = (0.0115, 0.0085, 0.0060)  # m, scale of the half edges along x, y, z
TAPER = (0.16, -0.05, 0.08)  # of the perspective, over the half edges
SPEED = 0.06  # m/s, of the rolling
RADIUS = 0.013  # m, that it rolls by
DURATION = 4.0  # s
RATE = 100.0  # samples per second


def bulged_cube() -> Array:
    """Return control points of six patches, (6, 3, 3, 3), half edge 1, normals outward."""
    level = np.array([-1.0, 0.0, 1.0])
    patches = []
    for axis in range(3):
        for sign in (1.0, -1.0):
            net = np.empty((3, 3, 3))
            for i, a in enumerate(level):
                for j, b in enumerate(level):
                    middles = int(a == 0.0) + int(b == 0.0)
                    # A corner stays, the middle of a side moves out by both faces, that of a face
                    # by its own.
                    out = (1.0, SIDE, FACE)[middles]
                    across = SIDE if middles == 1 else 1.0
                    point = np.zeros(3)
                    point[axis] = out * sign
                    point[(axis + 1) % 3] = across * a
                    point[(axis + 2) % 3] = across * b * sign
                    net[i, j] = point
            patches.append(net)
    return np.array(patches)


def pebble() -> dict[str, object]:
    """Return the file's content: the bulged cube seen in perspective, in metres."""
    patches = []
    for net in bulged_cube():
        weights = 1.0 + net @ np.array(TAPER)
        points = net * np.array(AXES) / weights[..., None]
        patches.append(
            {
                "kind": "bezier",
                "control_points": points.tolist(),
                "weights": weights.tolist(),
            }
        )
    return {"format": "standoff-patches", "version": 1, "title": "Pebble, m", "patches": patches}


def motion() -> dict[str, Array]:
    """Return the columns of the pose samples: s, m, and quaternions."""
    time = np.arange(int(DURATION * RATE) + 1) / RATE
    rolled = SPEED * time / RADIUS
    sway = 0.25 * np.sin(2.0 * np.pi * 0.9 * time)
    turn = Rotation.from_euler("YXZ", np.stack([rolled, sway, 0.4 * sway], axis=1)).as_quat()
    # Its centre rises and falls as it rolls over its longer and its shorter side.
    height = 0.0017 * np.cos(2.0 * rolled)
    position = [SPEED * (time - 0.5 * DURATION), 0.002 * np.sin(1.3 * time), height]
    names = ("time", "x", "y", "z", "qx", "qy", "qz", "qw")
    return dict(zip(names, [time, *position, *turn.T], strict=True))


def main(folder: Path) -> None:
    """Write both files."""
    text = json.dumps(pebble(), indent=1)
    (folder / "pebble.json").write_text(text + "\n", encoding="utf-8")
    pq.write_table(pa.table(motion()), folder / "pebble_motion.parquet")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
