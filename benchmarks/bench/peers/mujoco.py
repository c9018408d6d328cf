"""MuJoCo 4: ``mj_geomDistance``, the poses written into the data's arrays."""

from __future__ import annotations

from typing import Any

import numpy as np

from benchmarks.bench.contender import Array, Contender, Found, asked
from benchmarks.bench.motion import Frames, Pair
from standoff_studies.accuracy.peers.answer import require
from standoff_studies.accuracy.peers.mujoco_peer import FARTHEST, mujoco_model


def contenders(pair: Pair, frames: Frames) -> list[Contender]:
    """MuJoCo's, if it has the pair."""
    found = []
    for tight in (False, True):
        model = mujoco_model(pair.a, pair.b, tight)
        if model is not None:
            setting = "tight" if tight else "default"
            found.append(_contender(f"MuJoCo, {setting}", frames, model))
    return found


def _contender(name: str, frames: Frames, model: Any) -> Contender:
    mujoco = require("mujoco")
    data, segment = mujoco.MjData(model), np.zeros(6)
    turns, places = data.geom_xmat.reshape(2, 3, 3), data.geom_xpos
    query = mujoco.mj_geomDistance

    def ask(pose_a: Array, pose_b: Array) -> float:
        turns[0], places[0] = pose_a[:3, :3], pose_a[:3, 3]
        turns[1], places[1] = pose_b[:3, :3], pose_b[:3, 3]
        return query(model, data, 0, 1, FARTHEST, segment)

    def read(distance: float) -> Found:
        return Found(distance, segment[:3].copy(), segment[3:].copy())

    return asked(name, frames.pairs, ask, read)
