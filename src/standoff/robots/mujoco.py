"""Robots of MuJoCo models: their joints, geometries and pairs, and MuJoCo's kinematics."""

from __future__ import annotations

import copy
import os
import threading
from collections.abc import Callable, Sequence
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError, of_extra
from standoff.motion import Pose
from standoff.robots.configurations import Configurations
from standoff.robots.frames import frame, frames, from_wxyz, jacobians_of
from standoff.robots.geoms import Geoms
from standoff.robots.joints import JointKind, Joints
from standoff.robots.kinematics import GeometryMotion
from standoff.robots.loaded import Loaded, loaded
from standoff.robots.mujoco_pairs import pairs_left_out, watched_pairs
from standoff.robots.report import GIVEN, GeomReport
from standoff.robots.shapes import Meshes, Source, made_geoms
from standoff.typing import Array, Ints
from standoff.wording import counted

with of_extra("MuJoCo", "mujoco"):
    import mujoco


KINDS = {
    mujoco.mjtGeom.mjGEOM_PLANE: "plane",
    mujoco.mjtGeom.mjGEOM_HFIELD: "hfield",
    mujoco.mjtGeom.mjGEOM_SPHERE: "sphere",
    mujoco.mjtGeom.mjGEOM_CAPSULE: "capsule",
    mujoco.mjtGeom.mjGEOM_ELLIPSOID: "ellipsoid",
    mujoco.mjtGeom.mjGEOM_CYLINDER: "cylinder",
    mujoco.mjtGeom.mjGEOM_BOX: "box",
    mujoco.mjtGeom.mjGEOM_MESH: "mesh",
    mujoco.mjtGeom.mjGEOM_SDF: "sdf",
}
SIZES: dict[str, Callable[[Any], tuple[float, ...]]] = {
    "plane": lambda s: (0.0, 0.0, 1.0, 0.0),
    "sphere": lambda s: (s[0],),
    "capsule": lambda s: (s[0], 2.0 * s[1]),
    "ellipsoid": lambda s: (s[0], s[1], s[2]),
    "cylinder": lambda s: (s[0], 2.0 * s[1]),
    "box": lambda s: (2.0 * s[0], 2.0 * s[1], 2.0 * s[2]),
}
"""The sizes of a body, from MuJoCo's half lengths; planes have no end in its collisions either."""

JOINT_KINDS = {
    mujoco.mjtJoint.mjJNT_FREE: JointKind.FREE,
    mujoco.mjtJoint.mjJNT_BALL: JointKind.BALL,
    mujoco.mjtJoint.mjJNT_SLIDE: JointKind.SLIDE,
    mujoco.mjtJoint.mjJNT_HINGE: JointKind.HINGE,
}


class MujocoKinematics:
    """MuJoCo's kinematics of a robot's moving geometries; see `Kinematics`.

    Attributes
    ----------
    model : mujoco.MjModel
    """

    fold: Array | None = None

    def __init__(
        self, model: Any, joints: Joints, numbers: Ints, within_geoms: Array | None = None
    ) -> None:
        """`numbers`: of the moving geometries in the model; `within_geoms` (n, 4, 4): where the
        bodies stand in MuJoCo's frames of them, if they differ."""
        self.model, self.nq, self.nv = model, int(model.nq), int(model.nv)
        self._joints, self._numbers, self._within_geoms = joints, numbers, within_geoms
        self.check = Configurations(joints, self.nq, "model.qpos0")
        ancestors = _ancestors(model)
        of_dofs = ancestors[model.geom_bodyid[numbers]][:, model.dof_bodyid]
        self.support = np.asarray(of_dofs, dtype=float).reshape(len(numbers), self.nv)
        self._roots = np.asarray(model.body_rootid[model.dof_bodyid])
        self._data, self._lock = mujoco.MjData(model), threading.Lock()

    def __reduce__(self) -> Any:
        return MujocoKinematics, (self.model, self._joints, self._numbers, self._within_geoms)

    def _placed(self) -> Array:
        data, numbers = self._data, self._numbers
        found = frames(data.geom_xmat[numbers].reshape(-1, 3, 3), data.geom_xpos[numbers])
        return found if self._within_geoms is None else found @ self._within_geoms

    def poses(self, q: Array) -> Array:
        with self._lock:
            self._data.qpos[:] = q
            mujoco.mj_kinematics(self.model, self._data)
            return self._placed()

    def motion(self, q: Array) -> GeometryMotion:
        data = self._data
        with self._lock:
            data.qpos[:] = q
            mujoco.mj_kinematics(self.model, data)
            mujoco.mj_comPos(self.model, data)
            # MuJoCo's are about the centre of mass of each tree, angular first
            omega, v = data.cdof[:, :3], data.cdof[:, 3:]
            v = v + np.cross(data.subtree_com[self._roots], omega)
            return GeometryMotion(self._placed(), np.concatenate([v, omega], axis=1).T)

    def jacobians(self, q: Array) -> Array:
        return jacobians_of(self.motion(q), self.support, self.fold)

    def integrate(self, q: Array, v: Array) -> Array:
        after = np.array(q, dtype=float)
        mujoco.mj_integratePos(self.model, after, np.asarray(v, dtype=float), 1.0)
        return after

    def difference(self, q0: Array, q1: Array) -> Array:
        found = np.empty(self.nv)
        mujoco.mj_differentiatePos(self.model, found, 1.0, np.asarray(q0), np.asarray(q1))
        return found

    def neutral(self) -> Array:
        return np.array(self.model.qpos0)


def load(model: Any, meshes: Meshes, skip: Sequence[str]) -> Loaded:
    """See ``Robot.from_mujoco``."""
    model = _read(model)
    what = f"the MuJoCo model {model_name(model)!r}"
    if model.nflex:
        raise StandoffError(
            f"{what} has {model.nflex} flexible bodies (flex): a robot's bodies are rigid. Take "
            "them out of the model.",
            "model",
        )
    joints, of_bodies, body_frames = _joints(model)
    sources = [_source(model, k, of_bodies, body_frames) for k in range(model.ngeom)]
    made = made_geoms(sources, meshes, skip, what)
    within_geoms = np.array([_within_geom(sources[k], made.reports[k]) for k in made.numbers])
    geoms = _with_world_poses(model, made.geoms, list(made.numbers), within_geoms)
    kept, moving = np.array(list(made.numbers), dtype=np.int64), geoms.joints >= 0
    same = (within_geoms[moving] == np.eye(4)).all()
    kinematics = MujocoKinematics(
        model, joints, kept[moving], None if same else within_geoms[moving]
    )
    left_out = {
        (made.numbers[i], made.numbers[j]): reason
        for (i, j), reason in pairs_left_out(model).items()
        if i in made.numbers and j in made.numbers
    }
    made = made._replace(geoms=geoms)
    return loaded(what, kinematics, joints, made, left_out, _notes(model, joints))


def _read(given: Any) -> Any:
    """A model, or one from a file.

    Raises StandoffTypeError, StandoffError, FileNotFoundError.
    """
    if isinstance(given, mujoco.MjModel):
        return copy.copy(given)  # what is changed in it later is not the robot's
    if not isinstance(given, str | Path):
        raise StandoffTypeError(
            f"model = {shown(given)}: give a mujoco.MjModel, or the path of an MJCF file.",
            "model",
            given,
        )
    if not os.path.isfile(given):
        raise FileNotFoundError(f"There is no model file {shown(str(given))}.")
    try:
        return mujoco.MjModel.from_xml_path(str(given))
    except ValueError as error:
        raise StandoffError(f"MuJoCo does not read {given}: {error}", "model", given) from error


def model_name(model: Any) -> str:
    """The name of a model."""
    return bytes(model.names).split(b"\0", 1)[0].decode(errors="replace")


def _ancestors(model: Any) -> NDArray[np.bool_]:
    """(nbody, nbody): is the second an ancestor of the first, or it itself?"""
    found = np.eye(model.nbody, dtype=bool)
    for body in range(1, model.nbody):
        found[body] |= found[model.body_parentid[body]]
    return found


def _joints(model: Any) -> tuple[Joints, Ints, Array]:
    """The joints, and of each body the joint in whose moved frame it is fixed, and where."""
    of_bodies, frames_ = np.full(model.nbody, -1), np.tile(np.eye(4), (model.nbody, 1, 1))
    parents, placements = np.empty(model.njnt, dtype=np.int64), np.empty((model.njnt, 4, 4))
    for body in range(1, model.nbody):
        parent = model.body_parentid[body]
        joint, here = int(of_bodies[parent]), frames_[parent]
        here = here @ frame(from_wxyz(model.body_quat[body]), model.body_pos[body])
        first = model.body_jntadr[body]
        for j in range(first, first + model.body_jntnum[body]):
            free = model.jnt_type[j] == int(mujoco.mjtJoint.mjJNT_FREE)
            anchor = frame(np.eye(3), model.jnt_pos[j])
            parents[j], placements[j] = joint, np.eye(4) if free else here @ anchor
            joint = j
            here = np.eye(4) if free else frame(np.eye(3), -model.jnt_pos[j])
        of_bodies[body], frames_[body] = joint, here
    return _packed_joints(model, parents, placements), of_bodies, frames_


def _packed_joints(model: Any, parents: Ints, placements: Array) -> Joints:
    kinds = np.array([JOINT_KINDS[mujoco.mjtJoint(t)] for t in model.jnt_type], dtype=np.int64)
    single = (kinds == JointKind.HINGE) | (kinds == JointKind.SLIDE)
    at = model.jnt_qposadr.astype(np.int64)
    lower, upper = np.full(model.nq, -np.inf), np.full(model.nq, np.inf)
    limited = single & (model.jnt_limited != 0)
    lower[at[limited]], upper[at[limited]] = model.jnt_range[limited].T
    offsets = np.where(single, -model.qpos0[at], 0.0) if model.njnt else np.zeros(0)
    names = (model.joint(j).name or f"joint {j}" for j in range(model.njnt))
    return Joints(
        tuple(names),
        kinds,
        parents,
        placements,
        np.where(single[:, None], model.jnt_axis, 0.0),
        at,
        model.jnt_dofadr.astype(np.int64),
        np.ones(model.njnt),
        offsets,
        lower,
        upper,
        scalar_first=True,
    )


def _source(model: Any, k: int, of_bodies: Ints, body_frames: Array) -> Source:
    """Geometry k of the model."""
    body = int(model.geom_bodyid[k])
    kind = KINDS.get(mujoco.mjtGeom(model.geom_type[k]), "other")
    local = frame(from_wxyz(model.geom_quat[k]), model.geom_pos[k])
    paired = k in model.pair_geom1 or k in model.pair_geom2
    found = Source(
        model.geom(k).name,
        model.body(body).name or f"body {body}",
        kind,
        int(of_bodies[body]),
        body_frames[body] @ local,
        bool(model.geom_contype[k] or model.geom_conaffinity[k] or paired),
    )
    mesh = int(model.geom_dataid[k])
    if kind in SIZES:
        size = (*SIZES[kind](model.geom_size[k].tolist()), 0.0)
        return found._replace(size=size)
    if kind in ("mesh", "sdf") and mesh >= 0:
        shift = frame(from_wxyz(model.mesh_quat[mesh]), model.mesh_pos[mesh])
        own = Pose.of(shift).inverse().matrix
        return found._replace(mesh=lambda: _mesh(model, mesh), file_frame=own)
    return found


def _mesh(model: Any, k: int) -> tuple[Array, Ints]:
    first, faces = model.mesh_vertadr[k], model.mesh_faceadr[k]
    points = model.mesh_vert[first : first + model.mesh_vertnum[k]]
    triangles = model.mesh_face[faces : faces + model.mesh_facenum[k]]
    return np.asarray(points, dtype=float), np.asarray(triangles, dtype=np.int64)


def _within_geom(source: Source, report: GeomReport) -> Array:
    """(4, 4) where a body stands in MuJoCo's frame of its geometry: a body that was given for a
    mesh is in the frame of the file, and MuJoCo moves that to the centre of mass."""
    moved = report.became == GIVEN and source.file_frame is not None
    return np.asarray(source.file_frame) if moved else np.eye(4)


def _with_world_poses(model: Any, geoms: Geoms, numbers: list[int], within_geoms: Array) -> Geoms:
    """Placements of what is fixed in the world as MuJoCo has them, to the last bit."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    placements = geoms.placements.copy()
    for n in np.flatnonzero(geoms.joints < 0):
        k = numbers[n]
        here = frame(data.geom_xmat[k].reshape(3, 3), data.geom_xpos[k])
        placements[n] = here @ within_geoms[n]
    return geoms._replace(placements=placements)


def _notes(model: Any, joints: Joints) -> tuple[str, ...]:
    found = []
    if model.neq:
        found.append(
            f"{model.neq} equality constraints are not enforced: q is taken as it is given"
        )
    if model.nmocap:
        found.append(f"{model.nmocap} mocap bodies stand where the model has them")
    found += _notes_of_pairs(model)
    free = [
        name
        for name, kind, at in zip(joints.names, joints.kinds, joints.q_at, strict=True)
        if kind in (JointKind.HINGE, JointKind.SLIDE) and joints.lower[at] == -np.inf
    ]
    if free:
        found.append(f"without limits: {', '.join(free)}")
    return tuple(found)


def _notes_of_pairs(model: Any) -> list[str]:
    """Where the pairs are others than MuJoCo's, or than those of the same robot as a URDF file."""
    found = []
    watched = set(combinations(range(model.ngeom), 2)) - set(pairs_left_out(model))
    more = len(watched - set(watched_pairs(model)))
    if more:
        found.append(
            f"{counted(more, 'pair')} of bodies welded to a parent or child are watched: "
            "MuJoCo takes the two bodies that are welded for one, and leaves them out"
        )
    bodies, parents = model.geom_bodyid, model.body_parentid
    ends = [(int(bodies[g]), int(bodies[h])) for i, j in watched for g, h in ((i, j), (j, i))]
    based = sorted({b for a, b in ends if a > 0 == model.body_weldid[a] and parents[b] == a})
    if based and not model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_FILTERPARENT):
        names = ", ".join(model.body(b).name or f"body {b}" for b in based)
        found.append(
            f"the parents of {names} are fixed in the world: as MuJoCo does, it watches them with "
            "these, which of a URDF file are left out as joined by a joint; <exclude> leaves them "
            "out here"
        )
    return found
