"""Contacts of a MuJoCo model from exact distances: ``so.robots.MujocoContacts``."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from standoff.errors import StandoffError, of_extra
from standoff.robots.mujoco_pairs import watched_pairs
from standoff.robots.mujoco_robot import model_of, watched
from standoff.robots.near import NearLinks
from standoff.robots.report import GIVEN
from standoff.robots.robot import Robot
from standoff.robots.rows import RobotRows
from standoff.robots.tolerances import CONTACT_HORIZON, LEAST_FRICTION
from standoff.typing import Array
from standoff.world.packed import pieces_of

with of_extra("MuJoCo", "mujoco"):
    import mujoco


POINTED = ("sphere", "ellipsoid")
"""Kinds that touch any convex body at one point."""


class MujocoContacts:
    """Gives a MuJoCo simulation the contacts of exact bodies, one point for each pair in touch.

    Each contact has the parameters that MuJoCo's own would have: solref, solimp, friction,
    dimensions and margin, mixed by its rules. MuJoCo makes no contact of the same pair.

    Raises ModuleNotFoundError: MuJoCo is not installed; the message names the extra. Raises
    TypeError: no robot. Raises ValueError: a robot of another package, or with obstacles; a pair
    that it does not watch.

    Parameters
    ----------
    robot : Robot
        Of a MuJoCo model, without obstacles: only geoms of the model can be in touch.
    pairs : list of (str, str), optional
        Of which pairs, by the geoms' names. If not given: all of a sphere, an ellipsoid or a body
        that was given for a mesh. The others may lie flat on each other; MuJoCo holds them at
        several points, and goes on to do so.

    Attributes
    ----------
    model : mujoco.MjModel
        To make data of and to step: a copy of the model in which MuJoCo passes by our pairs, if
        all that collide are ours. Change its options as you like, not its geoms.
    rows : RobotRows or None
        The answers of the last call, near pairs that do not touch included.
    """

    def __init__(self, robot: Robot, pairs: Sequence[tuple[str, str]] | None = None) -> None:
        NearLinks(robot, -math.inf, None)
        model, numbers = model_of(robot)
        ours = _smooth(robot, model, numbers) if pairs is None else watched(robot, pairs)
        self._mixed = {(i, j): mixed(model, numbers[i], numbers[j]) for i, j in ours}
        self._numbers = numbers
        self.rows: RobotRows | None = None
        reach = max((pair.margin + pair.gap for pair in self._mixed.values()), default=0.0)
        sizes = [
            piece.body.size
            for body in robot.geoms.bodies
            for piece in pieces_of(body)
            if piece.body.bounded
        ]
        self._near = NearLinks(robot, -math.inf, reach + CONTACT_HORIZON * min(sizes, default=1.0))
        self._theirs = {frozenset((numbers[i], numbers[j])) for i, j in ours}
        self.model = copy.copy(model)
        if self._theirs == {frozenset(pair) for pair in watched_pairs(model)}:
            self.model.geom_contype[:] = self.model.geom_conaffinity[:] = 0
            self.model.body_contype[:] = self.model.body_conaffinity[:] = 0

    def __call__(self, data: Any) -> int:
        """Take MuJoCo's contacts of our pairs from the data, and add ours.

        Call it after ``mj_collision`` and before ``mj_makeConstraint``; ``step`` does.

        Raises ValueError: contacts that do not fit into MuJoCo's memory: give the model more
        (``<size memory>``).

        Returns
        -------
        int
            How many contacts were added.
        """
        self._leave_theirs(data)
        self.rows = rows = self._near.rows(data.qpos)
        middle = 0.5 * (rows.point_a + rows.point_b)
        seen = zip(rows.bodies.tolist(), rows.distance.tolist(), middle, rows.normal, strict=True)
        added = 0
        for (i, j), distance, point, normal in seen:
            pair = self._mixed.get((i, j))
            if pair is None or distance > pair.margin + pair.gap:
                continue
            contact = _contact(distance, point, normal, pair)
            contact.geom[:] = contact.geom1, contact.geom2 = self._numbers[i], self._numbers[j]
            if mujoco.mj_addContact(self.model, data, contact):
                raise StandoffError(
                    f"MuJoCo has no room for contact {data.ncon + 1}: give the model more by "
                    '<size memory="10M"/>.'
                )
            added += 1
        return added

    def _leave_theirs(self, data: Any) -> None:
        """Of MuJoCo's contacts, those of other pairs alone."""
        if not data.ncon:
            return
        pairs = map(frozenset, data.contact.geom.tolist())
        kept = [k for k, pair in enumerate(pairs) if pair not in self._theirs]
        if len(kept) < data.ncon:
            contacts = [copy.copy(data.contact[k]) for k in kept]
            data.ncon = 0
            for contact in contacts:
                mujoco.mj_addContact(self.model, data, contact)

    def step(self, data: Any) -> None:
        """``mj_step`` with these contacts, by the model's integrator but RK4.

        Raises ValueError: the model asks for RK4, which makes contacts within a step.
        """
        stepped(self.model, data, self)


def _smooth(robot: Robot, model: Any, numbers: Sequence[int]) -> list[tuple[int, int]]:
    """MuJoCo's pairs of which one cannot lie flat, and those with a body that it does not have."""
    reports = {report.name: report for report in robot.loaded.reports}
    geoms = [reports[name] for name in robot.geoms.names]
    ours = [geom.kind in POINTED or geom.became == GIVEN for geom in geoms]
    theirs = {frozenset(pair) for pair in watched_pairs(model)}
    return [
        (i, j)
        for i, j in sorted(robot.loaded.pairs)
        if (ours[i] or ours[j]) and frozenset((numbers[i], numbers[j])) in theirs
    ]


def _contact(distance: float, point: Array, normal: Array, pair: Mixed) -> Any:
    """A contact in the middle between the witness points, as MuJoCo has them."""
    contact = mujoco.MjContact()
    x, y, z = normal.tolist()
    # the second axis of MuJoCo's own frames: y, or z where that is near the normal, made square
    side = np.array(
        (-y * x, 1.0 - y * y, -y * z) if abs(y) < 0.5 else (-z * x, -z * y, 1.0 - z * z)
    )
    side /= math.sqrt(side @ side)
    u, v, w = side.tolist()
    contact.frame[:3], contact.frame[3:6] = normal, side
    contact.frame[6:] = y * w - z * v, z * u - x * w, x * v - y * u
    contact.dist, contact.pos[:] = distance, point
    contact.dim, contact.includemargin = pair.dim, pair.margin
    contact.solref[:], contact.solimp[:] = pair.solref, pair.solimp
    contact.friction[:], contact.solreffriction[:] = pair.friction, pair.solreffriction
    contact.flex[:] = contact.elem[:] = contact.vert[:] = -1
    contact.exclude, contact.efc_address = int(distance >= pair.margin), -1
    return contact


# Parameters of a contact of two geoms, by MuJoCo's own rules.
#
# MuJoCo gives its rules in ``XMLreference.html#body-geom`` and applies them inside
# ``mj_collision``, which hands them out only with contacts of its own; a test compares the two.

with of_extra("MuJoCo", "mujoco"):
    import mujoco


class Mixed(NamedTuple):
    """Of one pair of geoms: numbers of a contact, and how near they are when it is made."""

    dim: int
    solref: Array
    solreffriction: Array
    solimp: Array
    friction: Array
    margin: float
    gap: float


def mixed(model: Any, i: int, j: int) -> Mixed:
    """The parameters of geoms i and j: of the model's ``<pair>`` if it has one for them."""
    found = _of_pair(model, i, j) or _of_geoms(model, i, j)
    if model.opt.enableflags & mujoco.mjtEnableBit.mjENBL_OVERRIDE:
        opt = model.opt
        found = found._replace(
            solref=np.array(opt.o_solref),
            solreffriction=np.array(opt.o_solref),
            solimp=np.array(opt.o_solimp),
            friction=np.array(opt.o_friction),
            margin=float(opt.o_margin),
        )
    return found._replace(friction=np.maximum(found.friction, LEAST_FRICTION))


def _of_pair(model: Any, i: int, j: int) -> Mixed | None:
    pairs = zip(model.pair_geom1.tolist(), model.pair_geom2.tolist(), strict=True)
    for k, pair in enumerate(pairs):
        if pair in ((i, j), (j, i)):
            return Mixed(
                int(model.pair_dim[k]),
                np.array(model.pair_solref[k]),
                np.array(model.pair_solreffriction[k]),
                np.array(model.pair_solimp[k]),
                np.array(model.pair_friction[k]),
                float(model.pair_margin[k]),
                float(model.pair_gap[k]),
            )
    return None


def _of_geoms(model: Any, i: int, j: int) -> Mixed:
    priority = model.geom_priority
    if priority[i] != priority[j]:
        leader = i if priority[i] > priority[j] else j
        dim, solref = model.geom_condim[leader], model.geom_solref[leader]
        solimp, friction = model.geom_solimp[leader], model.geom_friction[leader]
    else:
        part = _part(float(model.geom_solmix[i]), float(model.geom_solmix[j]))
        a, b = model.geom_solref[i], model.geom_solref[j]
        standard = a[0] > 0.0 and b[0] > 0.0
        solref = part * a + (1.0 - part) * b if standard else np.minimum(a, b)
        solimp = part * model.geom_solimp[i] + (1.0 - part) * model.geom_solimp[j]
        friction = np.maximum(model.geom_friction[i], model.geom_friction[j])
        dim = max(model.geom_condim[i], model.geom_condim[j])
    return Mixed(
        int(dim),
        np.array(solref),
        np.zeros(mujoco.mjNREF),
        np.array(solimp),
        np.asarray(friction)[[0, 0, 1, 2, 2]],
        float(model.geom_margin[i] + model.geom_margin[j]),
        float(model.geom_gap[i] + model.geom_gap[j]),
    )


def _part(a: float, b: float) -> float:
    """The part of the first in a mean by weights of which either may be zero."""
    if max(a, b) < mujoco.mjMINVAL:
        return 0.5
    a, b = (x if x >= mujoco.mjMINVAL else 0.0 for x in (a, b))
    return a / (a + b)


# A step of MuJoCo with contacts that are given between its own collision and constraints.

with of_extra("MuJoCo", "mujoco"):
    import mujoco

POSITION = (
    mujoco.mj_checkPos,
    mujoco.mj_checkVel,
    mujoco.mj_kinematics,
    mujoco.mj_comPos,
    mujoco.mj_camlight,
    mujoco.mj_flex,
    mujoco.mj_tendon,
    mujoco.mj_makeM,
    mujoco.mj_factorM,
)
"""What a step of MuJoCo does before its contacts."""

VELOCITY = (
    mujoco.mj_makeConstraint,
    mujoco.mj_island,
    mujoco.mj_transmission,
    mujoco.mj_projectConstraint,
    mujoco.mj_sensorPos,
    mujoco.mj_fwdVelocity,
    mujoco.mj_sensorVel,
)
"""And between them and the control."""


def stepped(model: Any, data: Any, give_contacts: Callable[[Any], Any]) -> None:
    """``mj_step`` by the model's integrator but RK4; `give_contacts` is called with the data.

    Raises StandoffError: the model asks for RK4, which makes contacts within a step.
    """
    if model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4:
        raise StandoffError(
            "The model's integrator is RK4, within whose steps no contact can be given: set "
            "contacts.model.opt.integrator to Euler, implicit or implicitfast.",
            "integrator",
        )
    for work in (*POSITION, mujoco.mj_collision):
        work(model, data)
    give_contacts(data)
    for work in VELOCITY:
        work(model, data)
    if model.opt.enableflags & mujoco.mjtEnableBit.mjENBL_ENERGY:
        mujoco.mj_energyPos(model, data)
        mujoco.mj_energyVel(model, data)
    control = mujoco.get_mjcb_control()
    if control is not None:
        control(model, data)
    mujoco.mj_step2(model, data)
