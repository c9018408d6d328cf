"""Arms of hinges with capsules and spheres, among fixed capsules, spheres and boxes."""

from __future__ import annotations

from typing import Any

import numpy as np

import standoff as so
from robots.trees import TreeRobot, drawn_pose, robot_of


def arm(
    rng: np.random.Generator, joints: int = 7, obstacles: int = 20, boxes: bool = False
) -> TreeRobot:
    """An arm about as long as 1, its links ignoring their neighbours."""
    length = 1.0 / joints
    places = [np.eye(4) for _ in range(joints)]
    for place in places[1:]:
        place[2, 3] = length
    axes = [np.eye(3)[2] if k % 2 == 0 else np.eye(3)[1] for k in range(joints)]
    middle = np.eye(4)
    middle[2, 3] = 0.5 * length
    link = so.shapes.capsule(radius=0.03, length=length)
    geoms: list[Any] = [(k, link, middle) for k in range(joints)]
    tip = np.eye(4)
    tip[2, 3] = length
    geoms.append((joints - 1, so.shapes.sphere(0.05), tip))
    fixed = {}
    for k in range(obstacles):
        pose = drawn_pose(rng, 0.0)
        away = rng.normal(size=3)
        pose[:3, 3] = rng.uniform(0.45, 1.1) * away / np.linalg.norm(away)
        kind = k % (3 if boxes else 2)
        body = (
            so.shapes.sphere(rng.uniform(0.03, 0.1)),
            so.shapes.capsule(radius=rng.uniform(0.02, 0.05), length=rng.uniform(0.05, 0.3)),
            so.shapes.box(rng.uniform(0.05, 0.2, 3)),
        )[kind]
        fixed[f"f{k}"] = (body, pose)
    ignore = [(f"g{k}", f"g{k + 1}") for k in range(joints)] + [
        (f"g{k}", f"g{k + 2}") for k in range(joints - 1)
    ]
    return robot_of(
        [1] * joints,
        list(range(-1, joints - 1)),
        places,
        axes,
        geoms,
        fixed=fixed,
        limit=2.9,
        ignore=ignore,
    )
