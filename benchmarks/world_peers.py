"""What others take for the same frames: MuJoCo, Coal, python-fcl's manager, ipctk's LBVH.

Each has `frame`, and `pairs`: how many pairs it named in the last one.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.world_scenes import Scene, boxes_of

WITHIN = 0.2
FLOOR = [2000.0, 2000.0, 0.2], np.array([0.0, 0.0, -0.1])


class MuJoCo:
    """The same bodies as geoms of free bodies, with the horizon as their margin."""

    def __init__(self, given: Scene) -> None:
        import mujoco

        self.mujoco = mujoco
        spec = mujoco.MjSpec()
        spec.option.gravity = [0.0, 0.0, 0.0]
        kinds = mujoco.mjtGeom
        margin = {"margin": WITHIN, "gap": WITHIN}
        kind = kinds.mjGEOM_BOX if given.boxes else kinds.mjGEOM_ELLIPSOID
        for k, axes in enumerate(given.axes):
            body = spec.worldbody.add_body(name=f"b{k}", mocap=False)
            body.add_freejoint()
            body.add_geom(type=kind, size=list(axes), **margin)
        if given.floor:
            half = [side / 2.0 for side in FLOOR[0]]
            spec.worldbody.add_geom(type=kinds.mjGEOM_BOX, size=half, pos=FLOOR[1], **margin)
        spec.memory = 1 << 30
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        turns = Rotation.from_matrix(given.path[..., :3, :3].reshape(-1, 3, 3))
        quats = turns.as_quat(scalar_first=True).reshape(*given.path.shape[:2], 4)
        self.q = np.concatenate([given.path[..., :3, 3], quats], axis=-1)
        self.q = self.q.reshape(len(given.path), -1)
        self.pairs = 0

    def frame(self, k: int) -> float:
        mujoco, model, data = self.mujoco, self.model, self.data
        data.qpos[:] = self.q[k]
        mujoco.mj_kinematics(model, data)
        mujoco.mj_collision(model, data)
        return float(data.ncon)

    def with_distances(self, k: int) -> float:
        """And the distance of each pair of geoms that it found."""
        self.frame(k)
        mujoco, model, data = self.mujoco, self.model, self.data
        fromto = np.zeros(6)
        found = {tuple(pair) for pair in np.sort(data.contact.geom, axis=1).tolist()}
        self.pairs = len(found)
        least = WITHIN
        for a, b in found:
            least = min(least, mujoco.mj_geomDistance(model, data, a, b, WITHIN, fromto))
        return least


class Coal:
    """Its boxes, and its distance for every pair of them that is within the horizon."""

    def __init__(self, given: Scene) -> None:
        import coal

        self.coal, self.path = coal, given.path
        made = [
            coal.Box(*(2.0 * np.array(axes))) if given.boxes else coal.Ellipsoid(*axes)
            for axes in given.axes
        ]
        self.objects = [coal.CollisionObject(shape) for shape in made]
        if given.floor:
            self.objects.append(coal.CollisionObject(coal.Box(*FLOOR[0])))
            self.objects[-1].setTransform(coal.Transform3s(np.eye(3), FLOOR[1]))
            self.objects[-1].computeAABB()
        self.pairs = 0

    def frame(self, k: int) -> float:
        """All pairs whose boxes are near, by Python's sweep over its boxes: coal 3.0.3 hands no
        broad phase to Python that takes a callback of a distance."""
        coal = self.coal
        for body, pose in zip(self.objects, self.path[k], strict=False):
            body.setTransform(coal.Transform3s(pose[:3, :3], pose[:3, 3]))
            body.computeAABB()
        boxes = [body.getAABB() for body in self.objects]
        low = np.array([box.min_ for box in boxes])
        high = np.array([box.max_ for box in boxes]) + WITHIN
        order = np.argsort(low[:, 0])
        least, self.pairs = WITHIN, 0
        active: list[int] = []
        request, result = coal.DistanceRequest(), coal.DistanceResult()
        for i in order.tolist():
            active = [j for j in active if high[j, 0] >= low[i, 0]]
            for j in active:
                if (low[i] <= high[j]).all() and (low[j] <= high[i]).all():
                    result.clear()
                    self.pairs += 1
                    a, b = self.objects[i], self.objects[j]
                    least = min(least, coal.distance(a, b, request, result))
            active.append(i)
        return least


class PythonFcl:
    """Its manager of a dynamic tree of boxes, moved from Python; pairs come by a callback.

    It has no margin: bodies are grown by half the horizon, so that the pairs are those of boxes
    within it.
    """

    def __init__(self, given: Scene) -> None:
        import fcl

        self.fcl, self.path = fcl, given.path
        grown = np.array(given.axes) + WITHIN / 2.0
        made = [fcl.Box(*(2.0 * axes)) if given.boxes else fcl.Ellipsoid(*axes) for axes in grown]
        self.objects = [fcl.CollisionObject(shape, fcl.Transform()) for shape in made]
        if given.floor:
            sides = np.array(FLOOR[0]) + WITHIN
            place = fcl.Transform(np.eye(3), FLOOR[1])
            self.objects.append(fcl.CollisionObject(fcl.Box(*sides), place))
        self.manager = fcl.DynamicAABBTreeCollisionManager()
        self.frame_of(0)
        self.manager.registerObjects(self.objects)
        self.manager.setup()
        self.pairs = 0

    def frame_of(self, k: int) -> None:
        for body, pose in zip(self.objects, self.path[k], strict=False):
            body.setTransform(self.fcl.Transform(pose[:3, :3], pose[:3, 3]))

    def frame(self, k: int) -> float:
        self.frame_of(k)
        self.manager.update()
        found: list[Any] = []

        def note(a: Any, b: Any, data: Any) -> bool:
            found.append((a, b))
            return False

        self.manager.collide(None, note)
        self.pairs = len(found)
        return float(self.pairs)


class Lbvh:
    """ipctk's tree, made anew in every frame over boxes that are given: each as an edge between
    its corners."""

    def __init__(self, given: Scene) -> None:
        import ipctk

        self.tree, self.given = ipctk.LBVH(), given
        n = len(given.axes) + given.floor
        self.edges = np.asfortranarray(np.arange(2 * n, dtype=np.int32).reshape(n, 2))
        self.faces = np.asfortranarray(np.empty((0, 3), dtype=np.int32))
        self.pairs = 0

    def frame(self, k: int) -> float:
        low, high = boxes_of(self.given, k)
        corners = np.empty((2 * len(low), 3))
        corners[::2], corners[1::2] = low, high
        self.tree.build(np.asfortranarray(corners), self.edges, self.faces, WITHIN / 2.0)
        self.pairs = len(self.tree.detect_edge_edge_candidates())
        return float(self.pairs)
