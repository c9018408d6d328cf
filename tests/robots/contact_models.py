"""Small models for the tests of what controls a robot."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

# two ellipsoids on slides and turns: they touch, come apart and overlap as q says (mink passes by
# pairs of the world and its children: hence the carrier)
TWO = """
<mujoco><worldbody>
<body name="still"><geom name="a" type="ellipsoid" size="0.3 0.2 0.25" euler="20 30 10"/></body>
<body name="carrier"><joint name="x" type="slide" axis="1 0 0"/>
<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
<body name="moving" pos="0 0 1">
<joint name="y" type="slide" axis="0 1 0"/>
<joint name="z" type="slide" axis="0 0 1"/><joint name="turn" type="hinge" axis="1 1 0"/>
<geom name="b" type="ellipsoid" size="0.15 0.2 0.1"/></body></body>
</worldbody></mujoco>"""

# an arm of three hinges and a slide among a floor, a post and a ball
ARM = """
<mujoco><worldbody>
<geom name="floor" type="plane" size="1 1 1"/>
<geom name="post" type="capsule" size="0.05 0.4" pos="0.35 0.3 0.4"/>
<geom name="ball" type="sphere" size="0.12" pos="-0.3 0.35 0.6"/>
<body name="l1" pos="0 0 0.2"><joint name="j1" axis="0 0 1" range="-170 170"/>
<geom name="g1" type="capsule" size="0.05 0.1"/>
<body name="l2" pos="0 0 0.2"><joint name="j2" axis="0 1 0" range="-120 120"/>
<geom name="g2" type="capsule" size="0.04 0.15" pos="0 0 0.15"/>
<body name="l3" pos="0 0 0.35"><joint name="j3" axis="1 0 0" range="-120 120"/>
<geom name="g3" type="ellipsoid" size="0.05 0.06 0.15" pos="0 0 0.15"/>
<body name="l4" pos="0 0 0.35"><joint name="j4" type="slide" axis="0 0 1" range="-0.05 0.1"/>
<geom name="g4" type="ellipsoid" size="0.05 0.03 0.08" pos="0 0.02 0.05"/>
<site name="tip" pos="0 0 0.13"/>
</body></body></body></body>
</worldbody></mujoco>"""


def model(text: str) -> Any:
    return mujoco.MjModel.from_xml_string(text)


def touching(distance: Any, q: np.ndarray, way: np.ndarray) -> np.ndarray:
    """On the line q + t way, where the distance is zero to roundoff: by bisection."""
    low, high = 0.0, 1.0
    assert distance(q) > 0.0 > distance(q + way)
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if distance(q + middle * way) > 0.0 else (low, middle)
    return q + low * way


def differences(values: Any, kinematics: Any, q: np.ndarray, step: float = 1e-5) -> np.ndarray:
    """(..., nv) central differences, of the fourth order, along unit velocities."""
    columns = []
    for unit in np.eye(kinematics.nv):
        at = [values(kinematics.integrate(q, s * step * unit)) for s in (-2.0, -1.0, 1.0, 2.0)]
        columns.append((at[0] - 8.0 * at[1] + 8.0 * at[2] - at[3]) / (12.0 * step))
    return np.stack(columns, axis=-1)
