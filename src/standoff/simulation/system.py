"""A system: bodies, which pairs of them meet, how, and in what field of gravity."""

from __future__ import annotations

import uuid
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate, combinations
from typing import Any

import numpy as np

from standoff.bodies.body import Body
from standoff.checks.numbers import is_whole
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.geometry.validation import vector3
from standoff.kernels.body import layout as L
from standoff.motion import Pose, Twist
from standoff.read_only import KeepsReadOnly
from standoff.simulation.contact import HuntCrossley
from standoff.simulation.coupler import VirtualCoupler
from standoff.simulation.flat_parts import FlatParts
from standoff.simulation.rigid_body import FIXED, FREE, RigidBody
from standoff.simulation.solid_parts import (
    SOLID_SPRINGS,
    contact_model,
    flats_of,
    kept_length,
    room_for_rows,
)
from standoff.simulation.tolerances import UNSEEN_PART
from standoff.solids.spatial.solid_model import SolidModel
from standoff.tracking.inputs import check_pair
from standoff.typing import Array

EARTH = (0.0, 0.0, -9.81)
"""Gravity if none is given, length/s² in metres."""

FLAT_SPRINGS = 4.0
"""Springs of one stiffness that a flat contact is worth (``kernels.dynamics.flat_contact``)."""


@dataclass(frozen=True, init=False, eq=False)
class System(KeepsReadOnly):
    """Bodies that are moved by gravity and by each other.

    Raises StandoffTypeError: something that is not a RigidBody or not a HuntCrossley. Raises
    StandoffError: no body that is free; a pair that does not exist, is given twice, or cannot move;
    two half-spaces; a coupler without its tool, or a tool that is not free.

    Parameters
    ----------
    bodies : sequence of RigidBody
    contact : HuntCrossley or sequence of it
        Of all pairs, or one for each pair, in their order.
    pairs : sequence of (int, int), optional
        Numbers of the bodies that are tracked and may touch; all pairs with a free body if not
        given.
    gravity : (3,) array_like
        Acceleration [length/time²], world axes.
    coupler : VirtualCoupler, optional
        Joins the handle of a device to one of the bodies.
    tool : int, optional
        The number of that body, a free one.

    Attributes
    ----------
    bodies : tuple of RigidBody
    pairs : tuple of (int, int)
    contacts : tuple of HuntCrossley
        One for each pair.
    gravity : (3,) array
    coupler : VirtualCoupler or None
    tool : int or None
    key : str
        Of this system and of its copies and pickles, whose states it takes; no other has it.
    """

    bodies: tuple[RigidBody, ...]
    pairs: tuple[tuple[int, int], ...]
    contacts: tuple[HuntCrossley, ...]
    gravity: Array
    flats: tuple[FlatParts, ...]
    of_solids: tuple[bool, ...]
    models: tuple[SolidModel | None, ...]
    coupler: VirtualCoupler | None
    tool: int | None
    key: str

    def __init__(
        self,
        bodies: Sequence[RigidBody],
        contact: HuntCrossley | Sequence[HuntCrossley],
        pairs: Sequence[tuple[int, int]] | None = None,
        gravity: Any = EARTH,
        coupler: VirtualCoupler | None = None,
        tool: int | None = None,
    ) -> None:
        found = _listed(bodies, "bodies", RigidBody)
        if not any(b.kind == FREE for b in found):
            raise StandoffError(
                "None of the bodies is free, so nothing moves by itself: make one with "
                "RigidBody.free.",
                "bodies",
                bodies,
            )
        moving = _pairs(found, pairs)
        for a, b in moving:
            if FREE not in (found[a].kind, found[b].kind):
                raise StandoffError(
                    f"Neither body of the pair {(a, b)} is free: nothing would feel their contact.",
                    "pairs",
                    pairs,
                )
        self._meet(found, contact, moving)
        object.__setattr__(self, "gravity", vector3(gravity, "gravity"))
        object.__setattr__(self, "tool", _tool(coupler, tool, found))
        object.__setattr__(self, "coupler", coupler)

    @classmethod
    def placed(
        cls,
        bodies: Sequence[Body],
        contact: HuntCrossley | Sequence[HuntCrossley],
        pairs: Sequence[tuple[int, int]],
        motion: Sequence[tuple[Pose, Twist]] | None = None,
    ) -> System:
        """Return bodies that other equations move: fixed here, they only press on each other.

        Parameters
        ----------
        bodies : sequence of Body
        contact, pairs
            As of a `System`.
        motion : sequence of (Pose, Twist), optional
            Of each body, at the start; at rest in the world's frame if not given.
        """
        system = cls.__new__(cls)
        listed = _listed(bodies, "bodies", Body)
        at = motion if motion is not None else [(Pose.identity(), Twist.zero())] * len(listed)
        found = tuple(RigidBody(b, FIXED, None, *m) for b, m in zip(listed, at, strict=True))
        system._meet(found, contact, _pairs(found, pairs))
        for name, value in (("gravity", np.zeros(3)), ("tool", None), ("coupler", None)):
            object.__setattr__(system, name, value)
        return system

    def _meet(
        self,
        bodies: tuple[RigidBody, ...],
        contact: HuntCrossley | Sequence[HuntCrossley],
        pairs: tuple[tuple[int, int], ...],
    ) -> None:
        """Keep the bodies, which of them meet, and how."""
        object.__setattr__(self, "key", uuid.uuid4().hex)
        object.__setattr__(self, "bodies", bodies)
        object.__setattr__(self, "pairs", pairs)
        if not isinstance(contact, HuntCrossley | list | tuple):
            raise StandoffTypeError(
                f"contact is {shown(contact)}: give a HuntCrossley, or a list of one for each "
                "pair.",
                "contact",
                contact,
            )
        if isinstance(contact, HuntCrossley):
            contacts = (contact,) * len(self.pairs)
        else:
            contacts = _listed(contact, "contact", HuntCrossley)
        if len(contacts) != len(self.pairs):
            raise StandoffError(
                f"contact has {len(contacts)} entries for {len(self.pairs)} pairs {self.pairs}: "
                "give one for all, or one for each.",
                "contact",
                contact,
            )
        object.__setattr__(self, "contacts", contacts)
        object.__setattr__(self, "flats", tuple(flats_of(b.body) for b in bodies))
        met = tuple(any(isinstance(bodies[k].body, SolidModel) for k in p) for p in pairs)
        object.__setattr__(self, "of_solids", met)
        seen = {k for pair, solid in zip(pairs, met, strict=True) if solid for k in pair}
        models = (contact_model(b.body) if k in seen else None for k, b in enumerate(bodies))
        object.__setattr__(self, "models", tuple(models))

    def pair_models(self, pair: int) -> tuple[SolidModel, SolidModel] | None:
        """Both bodies of a pair as solids, where one of them is one."""
        a, b = (self.models[k] for k in self.pairs[pair])
        return (a, b) if self.of_solids[pair] and a and b else None

    def kept_starts(self) -> list[int]:
        """Where what each pair keeps from tick to tick begins among what all pairs do, and how many
        numbers these are."""
        lengths = (kept_length(room_for_rows(self.pair_models(k))) for k in range(len(self.pairs)))
        return [0, *accumulate(lengths)]

    def convex_pair(self, pair: int) -> tuple[Body, Body]:
        """Both bodies of a pair without a solid."""
        a, b = (self.bodies[k].body for k in self.pairs[pair])
        assert isinstance(a, Body)
        assert isinstance(b, Body)
        return a, b

    def give(self, pair: int) -> float:
        """The inverse of the least mass [1/mass] that a push between a pair's bodies moves: at the
        point of each that is farthest from its centre, perpendicular to the axis of its least
        moment of inertia.
        """
        total = 0.0
        for number in self.pairs[pair]:
            body = self.bodies[number]
            if body.mass_properties is None:
                continue
            mass = body.mass_properties
            arm = farthest(body) ** 2 / float(mass.principal_moments[0])
            total += 1.0 / mass.mass + arm
        return total

    def springs(self, pair: int) -> float:
        """How many springs of its stiffness a pair's contact can be."""
        if self.of_solids[pair]:
            return SOLID_SPRINGS
        a, b = (self.flats[k] for k in self.pairs[pair])
        if not (a.several and b.several):
            return 1.0
        return max(FLAT_SPRINGS, float(max(a.springs, b.springs)))

    def depth(self, pair: int) -> float:
        """The depth for which a pair's contact is meant, length."""
        given = self.contacts[pair].depth
        sizes = [self.bodies[k].body.size for k in self.pairs[pair]]
        return given if given is not None else 0.01 * min(sizes)

    def weight(self, pair: int) -> float:
        """The weight of the heavier of a pair's free bodies, force."""
        masses = [self.bodies[k].mass_properties for k in self.pairs[pair]]
        field = float(np.linalg.norm(self.gravity))
        return max(field * m.mass for m in masses if m is not None)

    def __repr__(self) -> str:
        coupled = "" if self.tool is None else f", body {self.tool} coupled to a device"
        return f"<System of {len(self.bodies)} bodies, {len(self.pairs)} pairs{coupled}>"


def farthest(body: RigidBody) -> float:
    """A bound on how far a body reaches from its centre of mass, of one that is not free from its
    origin, length; 0 for a half-space."""
    mass = body.mass_properties
    centre = mass.centre if mass is not None and body.kind == FREE else np.zeros(3)
    middle, half, swept = _box(body)
    corner = np.abs(middle - centre) + half
    return float(np.linalg.norm(corner)) + swept if np.isfinite(corner).all() else 0.0


def unseen_depth(system: System, pair: int) -> float:
    """How deep a tick may have hidden two bodies in each other before it is counted, length: the
    depth that their contact is meant for, or a part of what is thinner."""
    boxes = (_box(system.bodies[k]) for k in system.pairs[pair])
    thinnest = min(2.0 * (float(half.min()) + swept) for _, half, swept in boxes)
    return min(system.depth(pair), UNSEEN_PART * thinnest)


def _box(body: RigidBody) -> tuple[Array, Array, float]:
    """Centre and half the sides of the box around what a body's radius sweeps, its frame; and the
    radius."""
    shape = body.body.boundary if isinstance(body.body, SolidModel) else body.body
    swept = shape.radius if isinstance(shape, Body) else 0.0
    middle, half = (shape.reals[at : at + 3] for at in (L.BOX_CENTRE, L.BOX_HALF))
    return middle, half, swept


def _tool(coupler: Any, tool: Any, bodies: tuple[RigidBody, ...]) -> int | None:
    """The number of the body that a coupler joins to a device; None without a coupler."""
    if coupler is not None and not isinstance(coupler, VirtualCoupler):
        raise StandoffTypeError(
            f"coupler is {shown(coupler)}: give a VirtualCoupler, or None.", "coupler", coupler
        )
    if coupler is None and tool is None:
        return None
    if coupler is None or tool is None:
        raise StandoffError(
            "A coupler goes with the number of the body that it moves: give coupler=... and "
            "tool=..., or neither.",
            "tool",
            tool,
        )
    free = [k for k, body in enumerate(bodies) if body.kind == FREE]
    if not is_whole(tool) or tool not in free:
        raise StandoffError(
            f"tool is {shown(tool)}: give the number of a free body; here those are {free}.",
            "tool",
            tool,
        )
    return int(tool)


def _listed(given: Any, name: str, kind: type) -> tuple[Any, ...]:
    if not isinstance(given, list | tuple):
        raise StandoffTypeError(
            f"{name} is {shown(given)}: give a list of {kind.__name__}.", name, given
        )
    found = tuple(given)
    for item in found:
        if not isinstance(item, kind):
            raise StandoffTypeError(
                f"{name} has {shown(item)}, which is not a {kind.__name__}.", name, given
            )
    return found


def _pairs(bodies: tuple[RigidBody, ...], given: Any) -> tuple[tuple[int, int], ...]:
    if given is None:
        return tuple(
            (i, j)
            for i, j in combinations(range(len(bodies)), 2)
            if FREE in (bodies[i].kind, bodies[j].kind)
        )
    found = []
    for item in _listed(given, "pairs", object):
        pair = _pair(item, len(bodies), given)
        if pair in found or pair[::-1] in found:
            raise StandoffError(f"pairs names {pair} twice.", "pairs", given)
        a, b = (bodies[k].body for k in pair)
        if not (isinstance(a, SolidModel) or isinstance(b, SolidModel)):
            check_pair(a, b)
        found.append(pair)
    return tuple(found)


def _pair(item: Any, count: int, given: Any) -> tuple[int, int]:
    numbers = tuple(item) if isinstance(item, tuple | list) else ()
    whole = len(numbers) == 2 and all(is_whole(k) and 0 <= k < count for k in numbers)
    if not whole or numbers[0] == numbers[1]:
        raise StandoffError(
            f"pairs has {shown(item)}: give two different numbers of bodies, from 0 to "
            f"{count - 1}.",
            "pairs",
            given,
        )
    return int(numbers[0]), int(numbers[1])
