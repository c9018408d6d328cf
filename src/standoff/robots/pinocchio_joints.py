"""Joints of a Pinocchio model as a robot's tree."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from standoff.errors import StandoffError, of_extra
from standoff.robots.joints import SINGLE, JointKind, Joints
from standoff.robots.mimics import MimicModel, read_as
from standoff.robots.tolerances import UNLIMITED
from standoff.typing import Array, Ints

with of_extra("Pinocchio", "pinocchio"):
    import pinocchio as pin


X, Y, Z = np.eye(3)
HINGE, SLIDE, CONTINUOUS = JointKind.HINGE, JointKind.SLIDE, JointKind.CONTINUOUS
GLIDE = JointKind.GLIDE


class JointMotion(NamedTuple):
    """One motion of a joint: its kind, axis, and where its number stands after the joint's first
    in q and v."""

    kind: JointKind
    axis: Array
    q: int = 0
    v: int = 0
    ratio: float = 1.0
    offset: float = 0.0


MOTIONS: dict[str, tuple[JointMotion, ...]] = {
    **{f"JointModelR{n}": (JointMotion(HINGE, a),) for n, a in zip("XYZ", (X, Y, Z), strict=True)},
    **{f"JointModelP{n}": (JointMotion(SLIDE, a),) for n, a in zip("XYZ", (X, Y, Z), strict=True)},
    **{
        f"JointModelRUB{n}": (JointMotion(CONTINUOUS, a),)
        for n, a in zip("XYZ", (X, Y, Z), strict=True)
    },
    "JointModelSpherical": (JointMotion(JointKind.BALL, 0.0 * X),),
    "JointModelFreeFlyer": (JointMotion(JointKind.FREE, 0.0 * X),),
    "JointModelTranslation": tuple(JointMotion(SLIDE, a, k, k) for k, a in enumerate((X, Y, Z))),
    "JointModelPlanar": (
        JointMotion(GLIDE, X),
        JointMotion(GLIDE, Y, 1, 0),
        JointMotion(CONTINUOUS, Z, 2, 2),
    ),
    "JointModelSphericalZYX": tuple(JointMotion(HINGE, a, k, k) for k, a in enumerate((Z, Y, X))),
}
"""Of each kind of joint without a direction of its own."""

ALONG_AXIS = {
    "JointModelRevoluteUnaligned": HINGE,
    "JointModelPrismaticUnaligned": SLIDE,
}
"""Of those with an axis."""


class JointMotions(NamedTuple):
    """A model's joints.

    Attributes
    ----------
    joints : Joints
    of_joints : (njoints,) array
        Of each joint of the model the last of its rows; -1 for the universe.
    notes : tuple of str
    """

    joints: Joints
    of_joints: Ints
    notes: tuple[str, ...]


def read_joints(model: Any, what: str, follows: MimicModel | None = None) -> JointMotions:
    """The tree of a model's joints; ``follows`` says which read the numbers of others.

    Raises StandoffError: a joint of a kind that is not known; its name and kind are told.
    """
    of_joints = np.full(model.njoints, -1)
    names: list[str] = []
    mimics: set[int] = set()
    rows: list[tuple[JointMotion, int, Array, int, int]] = []
    for j in range(1, model.njoints):
        motions = _motions(model, j, what)
        at_q, at_v = int(model.idx_qs[j]), int(model.idx_vs[j])
        if follows is not None:
            master, ratio, offset = follows.mimics.get(j, (j, 1.0, 0.0))
            at_q, at_v = int(follows.q_at[master]), int(follows.v_at[master])
            if master != j:
                motions = (motions[0]._replace(ratio=ratio, offset=offset),)
                motions = (_of_master(model, (j, master), motions[0], what),)
        if model.nqs[j] == 0 or (follows is not None and j in follows.mimics):
            mimics.add(len(rows))
        parent, placement = int(of_joints[model.parents[j]]), model.jointPlacements[j].homogeneous
        for k, row in enumerate(motions):
            names.append(model.names[j] + (f"/{k}" if len(motions) > 1 else ""))
            rows.append((row, parent, np.array(placement), at_q + row.q, at_v + row.v))
            parent, placement = len(rows) - 1, np.eye(4)
        of_joints[j] = parent
    limits = (model.lowerPositionLimit, -np.inf), (model.upperPositionLimit, np.inf)
    own = slice(None) if follows is None else follows.own_q
    lower, upper = (_limits(x, side)[own] for x, side in limits)
    for row, _, _, q, _ in rows:
        if row.kind not in SINGLE:
            first = q + (3 if row.kind == JointKind.FREE else 0)
            end = first + (2 if row.kind == CONTINUOUS else 4)
            lower[first:end], upper[first:end] = -np.inf, np.inf
    joints = Joints(
        tuple(names),
        np.array([row.kind for row, *_ in rows], dtype=np.int64),
        np.array([parent for _, parent, *_ in rows], dtype=np.int64),
        np.array([placement for _, _, placement, *_ in rows]).reshape(-1, 4, 4),
        np.array([row.axis for row, *_ in rows]).reshape(-1, 3),
        np.array([q for *_, q, _ in rows], dtype=np.int64),
        np.array([v for *_, v in rows], dtype=np.int64),
        np.array([row.ratio for row, *_ in rows]),
        np.array([row.offset for row, *_ in rows]),
        lower,
        upper,
        scalar_first=False,
        mimics=frozenset(mimics),
    )
    return JointMotions(joints, of_joints, _notes(joints))


def _motions(model: Any, j: int, what: str) -> tuple[JointMotion, ...]:
    """What a joint's motions are, from its base."""
    joint = model.joints[j]
    kind = joint.shortname()
    if kind in MOTIONS:
        return MOTIONS[kind]
    if kind in ALONG_AXIS:
        axis = np.array(joint.extract().axis, dtype=float)
        return (JointMotion(ALONG_AXIS[kind], axis),)
    if kind == "JointModelRevoluteUnboundedUnaligned":
        return (JointMotion(CONTINUOUS, _led(model, j, j, 1.0)[1]),)
    if kind == "JointModelMimic":
        return (_mimicking(model, j, what),)
    raise StandoffError(
        f"The joint {model.names[j]!r} of {what} is a {kind}, which is not known: build the model "
        "of joints that turn about an axis, slide, are spherical, planar or free.",
        "model",
        model,
    )


def _of_master(model: Any, pair: tuple[int, int], row: JointMotion, what: str) -> JointMotion:
    """The row of a joint that follows another: it reads what that one has in q."""
    names = model.names[pair[0]], model.names[pair[1]]
    kind = read_as(row.kind, int(model.nqs[pair[1]]), row.ratio, names, what)
    return row._replace(kind=kind)


def _mimicking(model: Any, j: int, what: str) -> JointMotion:
    """The motion of a joint that mimics another of one number, or of (cos, sin)."""
    joint = model.joints[j].extract()
    ratio, offset, at = float(joint.scaling), float(joint.offset), int(model.idx_qs[j])
    master = next(i for i in range(1, model.njoints) if model.idx_qs[i] == at and model.nqs[i])
    kind, axis, way = _led(model, master, j, (1.0 - offset) / ratio if ratio else 0.0)
    # one that follows by 0 stands where its offset leads it
    row = JointMotion(kind, axis, 0, 0, ratio, offset if ratio else way)
    return _of_master(model, (j, master), row, what)


def _led(model: Any, master: int, j: int, number: float) -> tuple[JointKind, Array, float]:
    """Kind and axis of a joint, and how far along it the number of a joint leads it: Pinocchio
    does not tell all axes."""
    data, q, at = model.createData(), pin.neutral(model), int(model.idx_qs[master])
    q[at : at + model.nqs[master]] = (
        number if model.nqs[master] == 1 else (np.cos(number), np.sin(number))
    )
    pin.forwardKinematics(model, data, q)
    base = data.oMi[model.parents[j]] * model.jointPlacements[j]
    way = pin.log6(base.actInv(data.oMi[j]))
    turn, shift = float(np.linalg.norm(way.angular)), float(np.linalg.norm(way.linear))
    if turn > shift:
        return HINGE, way.angular / turn, turn
    return SLIDE, way.linear / shift if shift else X, shift


def _limits(given: Any, none: float) -> Array:
    found = np.array(given, dtype=float)
    return np.where(np.abs(found) < UNLIMITED, found, none)


def _notes(joints: Joints) -> tuple[str, ...]:
    single = np.isin(joints.kinds, SINGLE)
    ends = joints.upper[joints.q_at] - joints.lower[joints.q_at]
    free = [
        name
        for name, kind, one, span in zip(joints.names, joints.kinds, single, ends, strict=True)
        if kind == CONTINUOUS or (one and not np.isfinite(span))
    ]
    return (f"without limits: {', '.join(free)}",) if free else ()
