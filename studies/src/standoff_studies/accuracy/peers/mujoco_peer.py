"""MuJoCo 4: its own convex collision (``mj_geomDistance``)."""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.typing import Array
from standoff_studies.accuracy.peers.answer import (
    Peer,
    PeerAnswer,
    Pose,
    Query,
    by_points,
    require,
)
from standoff_studies.accuracy.solids import Solid

TOLERANCE = 1e-14
"""``opt.ccd_tolerance`` (length) of the tight query. Measured on exact ellipsoid pairs: 1e-10 to
1e-16 give the same errors."""
ITERATIONS = 1000
"""``opt.ccd_iterations`` of the tight query, so that the tolerance decides."""
FARTHEST = 1e6
"""Distance (length) up to which MuJoCo is asked for an answer at all."""


def _geometry(solid: Solid) -> tuple[str, Array] | None:
    """Return MuJoCo's type and size (3,): radii and half lengths; None where it has none."""
    lengths = solid.lengths
    match solid.kind.name:
        case "sphere":
            return "sphere", np.array([lengths[0], 0.0, 0.0])
        case "ellipsoid":
            return "ellipsoid", np.array(lengths)
        case "capsule" | "cylinder":
            return solid.kind.name, np.array([lengths[0], lengths[1] / 2, 0.0])
        case "box":
            return "box", np.array(lengths) / 2
        case "halfspace":
            return "plane", np.array([1.0, 1.0, 1.0])
    return None


def mujoco_model(a: Solid, b: Solid, tight: bool = False) -> Any:
    """Return MuJoCo's model of a pair, its geoms 0 and 1; None where it has no such pair."""
    mujoco = require("mujoco")
    pair = (_geometry(a), _geometry(b))
    if pair[0] is None or pair[1] is None:
        return None
    geoms = "".join(f'<geom type="{kind}" size="1 1 1"/>' for kind, _ in (pair[0], pair[1]))
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{geoms}</worldbody></mujoco>")
    # The text form may round; what is measured must be the same bodies.
    model.geom_size[:] = np.stack([pair[0][1], pair[1][1]])
    if tight:
        model.opt.ccd_tolerance = TOLERANCE
        model.opt.ccd_iterations = ITERATIONS
    return model


class MuJoCo(Peer):
    """MuJoCo at its defaults (1e-6), or at the tightest tolerance that pays."""

    package = "mujoco"

    def __init__(self, tight: bool = False) -> None:
        self.name = "MuJoCo, tight" if tight else "MuJoCo, default"
        self.tight = tight

    def query(self, a: Solid, b: Solid) -> Query | None:
        """It reports no normal: that is the direction between its points."""
        mujoco = require("mujoco")
        model = mujoco_model(a, b, self.tight)
        if model is None:
            return None
        data = mujoco.MjData(model)
        segment = np.zeros(6)

        def query(pose_a: Pose, pose_b: Pose) -> PeerAnswer:
            for index, (rotation, position) in enumerate((pose_a, pose_b)):
                data.geom_xmat[index] = np.asarray(rotation).ravel()
                data.geom_xpos[index] = position
            distance = mujoco.mj_geomDistance(model, data, 0, 1, FARTHEST, segment)
            return by_points(float(distance), segment[:3].copy(), segment[3:].copy())

        return query
