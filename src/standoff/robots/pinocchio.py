"""Robots of Pinocchio models: their joints, geometries and pairs, and Pinocchio's kinematics."""

from __future__ import annotations

import threading
from collections.abc import Callable, Collection, Mapping, Sequence
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np

from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError, of_extra
from standoff.robots.configurations import Configurations
from standoff.robots.frames import jacobians_of
from standoff.robots.joints import Joints
from standoff.robots.kinematics import GeometryMotion
from standoff.robots.loaded import Loaded, loaded
from standoff.robots.mimics import MimicModel
from standoff.robots.pinocchio_joints import JointMotions, read_joints
from standoff.robots.pinocchio_shapes import GeometryShape, read_shape
from standoff.robots.report import NO_SUCH_PAIR
from standoff.robots.shapes import Meshes, Source, made_geoms
from standoff.typing import Array, Ints

with of_extra("Pinocchio", "pinocchio"):
    import coal  # noqa: F401 - its classes are those of the geometries
    import pinocchio as pin

NEUTRAL = "pinocchio.neutral(model)"


class PinocchioKinematics:
    """Pinocchio's kinematics of a robot's moving geometries; see `Kinematics`.

    Attributes
    ----------
    model : pinocchio.Model
    """

    def __init__(
        self,
        model: Any,
        joints: Joints,
        carriers: Ints,
        placements: Array,
        follows: MimicModel | None = None,
    ) -> None:
        """`carriers`: the model's joint of each moving geometry; `placements` in its frame.
        `follows`: numbers of the model's q that are none of the robot's."""
        self.model, self._follows = model, follows
        self.nq = int(model.nq) if follows is None else len(follows.own_q)
        self.nv = int(model.nv) if follows is None else len(follows.own_v)
        self._joints, self._carriers, self._placements = joints, carriers, placements
        self.check = Configurations(joints, self.nq, NEUTRAL)
        self._data, self._lock = model.createData(), threading.Lock()
        self._used, self._of = np.unique(carriers, return_inverse=True)
        self.fold, columns = _folded(model, follows)
        self.support = np.zeros((len(carriers), int(model.nvExtended)))
        for row, carrier in zip(self.support, carriers, strict=True):
            for joint in list(model.supports[int(carrier)])[1:]:  # 0 is the universe
                row[columns[joint]] = 1.0

    def __reduce__(self) -> Any:
        if self.model.nvExtended != self.model.nv:
            # Pinocchio 4.1 loses numbers of such joints when it stores them, and then crashes
            raise StandoffError(
                f"The model {self.model.name!r} has joints that mimic others, which Pinocchio does "
                "not store: load the robot again from its file."
            )
        own = self._joints, self._carriers, self._placements, self._follows
        return PinocchioKinematics, (self.model, *own)

    def _whole(self, q: Array) -> Array:
        """The model's configuration."""
        return np.asarray(q) if self._follows is None else self._follows.whole(np.asarray(q))

    def _placed(self) -> Array:
        places = self._data.oMi
        used = np.array([places[j].homogeneous for j in self._used.tolist()]).reshape(-1, 4, 4)
        return np.asarray(used[self._of] @ self._placements)

    def poses(self, q: Array) -> Array:
        with self._lock:
            pin.forwardKinematics(self.model, self._data, self._whole(q))
            return self._placed()

    def motion(self, q: Array) -> GeometryMotion:
        with self._lock:
            # its columns are about the world's origin, linear first
            screws = np.array(pin.computeJointJacobians(self.model, self._data, self._whole(q)))
            # of one joint it is a vector
            return GeometryMotion(self._placed(), screws.reshape(6, -1))

    def jacobians(self, q: Array) -> Array:
        return jacobians_of(self.motion(q), self.support, self.fold)

    def integrate(self, q: Array, v: Array) -> Array:
        velocity = np.asarray(v) if self._follows is None else self._follows.fold @ np.asarray(v)
        after = np.asarray(pin.integrate(self.model, self._whole(q), velocity))
        return after if self._follows is None else after[self._follows.own_q]

    def difference(self, q0: Array, q1: Array) -> Array:
        way = np.asarray(pin.difference(self.model, self._whole(q0), self._whole(q1)))
        return way if self._follows is None else way[self._follows.own_v]

    def neutral(self) -> Array:
        found = np.asarray(pin.neutral(self.model))
        return found if self._follows is None else found[self._follows.own_q]


def _folded(model: Any, follows: MimicModel | None) -> tuple[Array | None, dict[int, slice]]:
    """How v moves the columns of Pinocchio's Jacobian, and each joint's columns in it.

    Joints that mimic another have columns of their own, scaled, and none of v.
    """
    columns = {
        j: slice(model.idx_vExtendeds[j], model.idx_vExtendeds[j] + model.nvExtendeds[j])
        for j in range(1, model.njoints)
    }
    if model.nvExtended == model.nv:
        return None if follows is None else follows.fold, columns
    fold = np.zeros((model.nvExtended, model.nv))
    for j, own in columns.items():
        at = model.idx_vs[j]
        fold[own, at : at + own.stop - own.start] = np.eye(own.stop - own.start)
    return fold, columns


def load(model: Any, geometry_model: Any, meshes: Meshes, skip: Sequence[str]) -> Loaded:
    """See ``Robot.from_pinocchio``."""
    if not isinstance(model, pin.Model):
        raise StandoffTypeError(f"model = {shown(model)}: give a pinocchio.Model.", "model", model)
    if not isinstance(geometry_model, pin.GeometryModel):
        raise StandoffTypeError(
            f"geometry_model = {shown(geometry_model)}: give a pinocchio.GeometryModel, such as "
            "that of pinocchio.buildGeomFromUrdf(model, path, pinocchio.GeometryType.COLLISION).",
            "geometry_model",
            geometry_model,
        )
    what = f"the Pinocchio model {model.name!r}"
    if geometry_model.ngeoms and not len(geometry_model.collisionPairs):
        raise StandoffError(
            "geometry_model has no collision pairs, so that nothing would be watched: call "
            "geometry_model.addAllCollisionPairs(), and pinocchio.removeCollisionPairs(model, "
            "geometry_model, srdf) for those that may touch.",
            "geometry_model",
            geometry_model,
        )
    watched = {frozenset((int(p.first), int(p.second))) for p in geometry_model.collisionPairs}
    model = model.copy()  # what is changed in it later is not the robot's
    reading = Reading(what, None, {}, None, ())
    return assembled(model, geometry_model, (meshes, skip), reading, watched)


class Reading(NamedTuple):
    """How a model was read.

    Attributes
    ----------
    what : str
        The model, for messages.
    follows : MimicModel or None
    shapes : mapping of str to Shape
        What geometries are that only stand for others, by name.
    left_out : callable or None
        From the names of two links to why their pairs are not watched; None where they are.
    notes : tuple of str
    """

    what: str
    follows: MimicModel | None
    shapes: Mapping[str, GeometryShape]
    left_out: Callable[[str, str], str | None] | None
    notes: tuple[str, ...]


def assembled(
    model: Any,
    geometry_model: Any,
    choices: tuple[Meshes, Sequence[str]],
    reading: Reading,
    watched: Collection[frozenset[int]] | None = None,
) -> Loaded:
    """A robot's data from a model and its geometries; ``watched`` are numbers of pairs of these,
    where links do not say which are left out."""
    rows = read_joints(model, reading.what, reading.follows)
    objects = geometry_model.geometryObjects
    sources = [_source(model, rows, x, reading.shapes) for x in objects]
    made = made_geoms(sources, *choices, reading.what)
    joints, moving = rows.joints, made.geoms.moving
    kept = list(made.numbers)
    carriers = np.array([objects[kept[n]].parentJoint for n in moving], dtype=np.int64)
    kinematics = PinocchioKinematics(
        model, joints, carriers, made.geoms.placements[moving], reading.follows
    )
    reasons = {}
    for i, j in combinations(range(len(kept)), 2):
        if reading.left_out is not None:
            reasons[i, j] = reading.left_out(made.geoms.links[i], made.geoms.links[j])
        elif frozenset((kept[i], kept[j])) not in (watched or ()):
            reasons[i, j] = NO_SUCH_PAIR
    left_out = {pair: reason for pair, reason in reasons.items() if reason is not None}
    notes = (*rows.notes, *reading.notes)
    return loaded(reading.what, kinematics, joints, made, left_out, notes)


def _source(
    model: Any, rows: JointMotions, given: Any, shapes: Mapping[str, GeometryShape]
) -> Source:
    """One geometry of a Pinocchio model."""
    shape = shapes[given.name] if given.name in shapes else read_shape(given.geometry)
    carrier = int(given.parentJoint)
    return Source(
        given.name,
        _link(model, given),
        shape.kind,
        int(rows.of_joints[carrier]),
        np.array(given.placement.homogeneous),
        not given.disableCollision,
        shape.size,
        shape.mesh,
    )


def _link(model: Any, given: Any) -> str:
    """The body that carries a geometry: its frame, or its joint where it has none."""
    number = int(given.parentFrame)
    if 0 < number < model.nframes:
        return str(model.frames[number].name)
    return str(model.names[int(given.parentJoint)])


__all__ = ["PinocchioKinematics", "Reading", "assembled", "load"]
