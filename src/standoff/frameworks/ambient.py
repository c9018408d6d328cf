"""Derivatives of the distance by the 16 numbers of each pose matrix.

On matrices the distance stands for that of the nearest pose, F(M) = f(nearest(M)): R is replaced by
the rotation of its polar decomposition, and the bottom row is not read. F is smooth near the poses
and equal to f on them, so the chain rule through any formula of the pose holds at every order.

With dR = E R, and E = S + W in its symmetric and its skew part (W the turn by w), the nearest
rotation to R + dR is exp(ω) R with

    ω = w - ((tr S) I - S) w / 2 + third order,

from (I + E) ((I + E)ᵀ (I + E))^(-1/2), expanded: so the twists of `Derivatives` become matrices.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from standoff.bodies.body import Body
from standoff.checks.names import choice
from standoff.checks.real_numbers import shown
from standoff.errors import DerivativeWarning, StandoffError, StandoffTypeError
from standoff.tracking.cold_query import distance
from standoff.tracking.derivatives import Smoothness
from standoff.tracking.distance_arrays import Distances
from standoff.tracking.many_distances import answered_rows
from standoff.tracking.proximity import Proximity
from standoff.typing import Array

ENTRIES = 16
NONE = np.zeros(0)

UNDEFINED = ("nan", "raise")
"""What is done where a derivative is not defined."""

LACKING = (Smoothness.PARTIAL, Smoothness.UNDEFINED)
"""Flags of answers that lack derivatives."""

NO_THIRD = (
    "Standoff has first and second derivatives of the distance, not third ones: one of the "
    "derivatives asked for goes through the Hessian."
)

# w of E: the vector of its skew part, -ε_mil E_il / 2.
SKEW = np.zeros((3, 3, 3))
for _m, _i, _l in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
    SKEW[_m, _i, _l], SKEW[_m, _l, _i] = -0.5, 0.5


class AmbientPair(NamedTuple):
    """Two bodies, and what is done where derivatives are not defined."""

    a: Body
    b: Body
    undefined: str

    @classmethod
    def of(cls, a: Body, b: Body, undefined: str) -> AmbientPair:
        """The pair, checked."""
        for name, body in (("a", a), ("b", b)):
            if not isinstance(body, Body):
                raise StandoffTypeError(
                    f"{name} = {shown(body)} is not a body: give one of so.shapes.", name, body
                )
        choice(undefined, "undefined", UNDEFINED)
        return cls(a, b, undefined)


class AmbientGradients(NamedTuple):
    """Distances (...) and their gradients by both matrices, (..., 2, 4, 4)."""

    distance: Array
    gradient: Array


class Second(NamedTuple):
    """The same with Hessians, (..., 2, 4, 4, 2, 4, 4)."""

    distance: Array
    gradient: Array
    hessian: Array


class AmbientRows(NamedTuple):
    """n answers: derivatives by twists, up to the order that was asked for."""

    distance: Array
    gradient: Array
    hessian: Array
    turns: tuple[Array, Array]
    """Rotations of A and of B, (n, 3, 3) or (1, 3, 3)."""
    answers: Proximity | Distances
    """A single one, or those of all rows."""
    lacking: Mapping[int, tuple[Smoothness, str]]
    """Of rows that lack derivatives, their flag and the reason."""


def value(pair: AmbientPair, poses_a: Array, poses_b: Array) -> Array:
    """Distances (...) at poses (..., 4, 4), which are broadcast.

    Raises StandoffError if a matrix is not a pose; the first such row is named.
    """
    rows, lead = _rows(pair, poses_a, poses_b, 0)
    return rows.distance.reshape(lead)


def first(pair: AmbientPair, poses_a: Array, poses_b: Array) -> AmbientGradients:
    """Distances and gradients; where they are not defined, as the pair says."""
    rows, lead = _rows(pair, poses_a, poses_b, 1)
    return AmbientGradients(rows.distance.reshape(lead), by_matrices(rows).reshape(*lead, 2, 4, 4))


def second(pair: AmbientPair, poses_a: Array, poses_b: Array) -> Second:
    """Distances, gradients and Hessians; where they are not defined, as the pair says."""
    rows, lead = _rows(pair, poses_a, poses_b, 2)
    twists = _twists(rows)
    by_entries = _by_entries(rows.gradient, twists)
    bent = twists.transpose(0, 2, 1) @ rows.hessian @ twists
    for body in range(2):
        here = slice(16 * body, 16 * body + 16)
        turn = slice(6 * body + 3, 6 * body + 6)
        mixed = _across(rows.turns[body], rows.gradient[:, turn]) @ twists[:, turn, here]
        bent[:, here, here] -= 0.5 * (mixed + mixed.transpose(0, 2, 1))
    return Second(
        rows.distance.reshape(lead),
        by_entries.reshape(*lead, 2, 4, 4),
        bent.reshape(*lead, 2, 4, 4, 2, 4, 4),
    )


def lead_of(shape_a: tuple[int, ...], shape_b: tuple[int, ...]) -> tuple[int, ...]:
    """The common leading shape of two arrays of poses."""
    for name, shape in (("pose_a", shape_a), ("pose_b", shape_b)):
        if shape[-2:] != (4, 4):
            raise StandoffError(
                f"{name} has the shape {shape}: give (4, 4), or (n, 4, 4) for n poses.", name, shape
            )
    try:
        return np.broadcast_shapes(shape_a[:-2], shape_b[:-2])
    except ValueError as error:
        raise StandoffError(
            f"pose_a has the shape {shape_a} and pose_b {shape_b}: give the same number "
            "of both, or one for all.",
            "pose_a",
            shape_a,
        ) from error


def _rows(
    pair: AmbientPair, poses_a: Array, poses_b: Array, order: int
) -> tuple[AmbientRows, tuple[int, ...]]:
    lead = lead_of(poses_a.shape, poses_b.shape)
    found = answered(pair, flat_poses((poses_a, poses_b), lead), order)
    tell(pair.undefined, found.lacking, len(found.distance), 4)
    return found, lead


def flat_poses(poses: Sequence[Array], lead: tuple[int, ...]) -> list[Array]:
    """(n, 4, 4) poses of all rows; one pose for all stays one, which `answered` takes as it is."""
    given = [np.broadcast_to(x, (*lead, 4, 4)) if x.size > ENTRIES else x for x in poses]
    return [np.ascontiguousarray(x).reshape(-1, 4, 4) for x in given]


def answered(pair: AmbientPair, poses: Sequence[Array], order: int) -> AmbientRows:
    """Answers at poses (n, 4, 4), or (1, 4, 4) for all, with their derivatives by twists.

    Raises StandoffError if a matrix is not a pose; the first such row is named.
    """
    return (_one if len(poses[0]) == len(poses[1]) == 1 else _many)(pair, poses, order)


def _one(pair: AmbientPair, poses: Sequence[Array], order: int) -> AmbientRows:
    """By the single query, which takes a fraction of the time of an array of one row."""
    answer = distance(pair.a, pair.b, poses[0][0], poses[1][0])
    number = np.array([answer.distance])
    if not order:
        return AmbientRows(number, NONE, NONE, (NONE, NONE), answer, {})
    derived = answer.derivatives()
    flag, reason = derived.smoothness, derived.reason
    at = answer.poses
    assert at is not None  # a cold answer keeps them
    turns = (at[0][:9].reshape(1, 3, 3), at[1][:9].reshape(1, 3, 3))
    lacking = {0: (flag, reason)} if flag in LACKING else {}
    return AmbientRows(
        number, derived.gradient[None], derived.hessian[None], turns, answer, lacking
    )


def _many(pair: AmbientPair, poses: Sequence[Array], order: int) -> AmbientRows:
    found = answered_rows(pair.a, pair.b, *poses)
    if found.errors:
        raise found.errors[min(found.errors)]
    if not order:
        return AmbientRows(found.distance, NONE, NONE, (NONE, NONE), found, {})
    turns = (found.poses[0][:, :3, :3], found.poses[1][:, :3, :3])
    derived = found.derivatives()
    missing = np.flatnonzero([flag in LACKING for flag in derived.smoothness]).tolist()
    lacking = {row: (derived.smoothness[row], derived.reasons[row]) for row in missing}
    return AmbientRows(found.distance, derived.gradient, derived.hessian, turns, found, lacking)


def by_matrices(rows: AmbientRows) -> Array:
    """(n, 32) derivatives by the entries of both matrices."""
    return _by_entries(rows.gradient, _twists(rows))


def _twists(rows: AmbientRows) -> Array:
    """(n, 12, 32) twists of unit changes of the entries, the first order."""
    count = len(rows.distance)
    twists = np.zeros((count, 12, 2, 4, 4))
    for body in range(2):
        for axis in range(3):
            twists[:, 6 * body + axis, body, axis, 3] = 1.0
        turn = slice(6 * body + 3, 6 * body + 6)
        twists[:, turn, body, :3, :3] = np.einsum("mil,nlj->nmij", SKEW, rows.turns[body])
    return twists.reshape(count, 12, 32)


def _by_entries(gradient: Array, twists: Array) -> Array:
    """(n, 32) derivatives by the entries, from those by twists; nan where a nan has a part in it,
    and there alone: in flat contact the entries of the position keep theirs."""
    lost = np.isnan(gradient)
    found: Array = np.einsum("nt,nte->ne", np.where(lost, 0.0, gradient), twists)
    if lost.any():
        found[np.einsum("nt,nte->ne", lost, twists != 0.0)] = np.nan
    return found


def _across(turns: Array, by_turn: Array) -> Array:
    """(n, 16, 3) vectors ((tr S) I - S) g, of unit changes of the entries.

    A change of entry (i, j) is E = e_i r_jᵀ, with the column r_j of R.
    """
    lengths = np.einsum("nij,ni->nj", turns, by_turn)
    found = np.zeros((len(by_turn), 4, 4, 3))
    found[:, :3, :3] = np.einsum("nij,nk->nijk", turns, by_turn)
    for i in range(3):
        found[:, i, :3, i] -= 0.5 * lengths
        found[:, i, :3] -= 0.5 * by_turn[:, i, None, None] * turns.transpose(0, 2, 1)
    return found.reshape(-1, 16, 3)


def tell(
    undefined: str, lacking: Mapping[int, tuple[Smoothness, str]], count: int, stacklevel: int
) -> None:
    """Warn of answers that lack derivatives, or raise; the first of `count` rows is named."""
    if not lacking:
        return
    row = min(lacking)
    flag, reason = lacking[row]
    which, more = (
        ("", "") if count == 1 else (f" of row {row}", f" ({len(lacking)} of {count} rows.)")
    )
    some = flag is Smoothness.PARTIAL
    lacks = "does not have all" if some else "has no"
    told = f"The distance{which} {lacks} derivatives: {reason}{more}"
    if undefined == "raise":
        raise StandoffError(told)
    warnings.warn(
        f"{told} {'The others' if some else 'They'} are nan; undefined='raise' makes this an "
        "error.",
        DerivativeWarning,
        stacklevel=stacklevel,
    )
