"""The paper's linear system at any pair of points: Psi, M, b and what they are made of."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from standoff.bodies.body import Body
from standoff.kernels.entries import queries
from standoff.motion import Pose, PoseLike, TwistLike
from standoff.tracking.inputs import (
    check_in_plane,
    check_pair,
    flat_pose,
    flat_twist,
    refuse_twists,
)
from standoff.tracking.places import PlaceLike, put
from standoff.tracking.rows import StateRow, motion_row
from standoff.typing import Array

UPPER = np.triu_indices(4)
SIGNS = np.array([1.0, 1.0, -1.0, -1.0])
STILL = np.zeros(6)


class PairSystem(NamedTuple):
    """Eqs. (1)-(14) at a pair of points, with n parameters in all (0 to 4; 2 on a face, 1 on an
    edge, 0 on a vertex; those of A first).

    Attributes
    ----------
    dR : (3,) array
        x_f - x_h [length], world.
    F, G : (3, 2), (3, 1) or (3, 0) arrays
        Tangents of A and of B [length per parameter], world.
    Psi : (n,) array
        Projection errors (F'dR, G'dR).  Eqs. (1)-(4)
    M : (n, n) array
        Psi' = M w + b.  Eq. (9)
    b : (n,) array
        Feedforward of the bodies' motion.  Eq. (10)
    g, H, g_t : (n,), (n, n), (n,) arrays
        S Psi, S M, S b with S = diag(1, 1, -1, -1): gradient and Hessian of E = |dR|^2 / 2 and
        the gradient's rate by the motion.
    repaired : int
        How many of the two poses were given with a rounded rotation, and were replaced by the
        nearest one.
    """

    dR: Array
    F: Array
    G: Array
    Psi: Array
    M: Array
    b: Array
    g: Array
    H: Array
    g_t: Array
    repaired: int = 0


def pair_system(
    a: Body,
    b: Body,
    pose_a: PoseLike,
    pose_b: PoseLike,
    place_a: PlaceLike,
    place_b: PlaceLike,
    twist_a: TwistLike | None = None,
    twist_b: TwistLike | None = None,
) -> PairSystem:
    """Evaluate the paper's system at given points of two bodies.

    Raises TypeError: not a body. Raises ValueError: no pose, twist or feature, or parameters
    outside it; a planar pair out of its plane.

    Parameters
    ----------
    a, b : Body
    pose_a, pose_b : Pose or what ``Pose.of`` reads
        World poses.
    place_a, place_b : (feature, parameters)
        Of the cores, as ``Tracker.start_from`` takes them.
    twist_a, twist_b : Twist or what ``Twist.of`` reads, optional
        (v, omega) in world; a body without one is at rest.

    Returns
    -------
    PairSystem
    """
    systems = PairSystems(a, b, place_a, place_b)
    pose_a, pose_b = Pose.of(pose_a), Pose.of(pose_b)
    flat_a, flat_b = flat_pose(pose_a), flat_pose(pose_b)
    xi_a, xi_b = flat_twist(twist_a, pose_a), flat_twist(twist_b, pose_b)
    if not np.isfinite([xi_a, xi_b]).all():
        refuse_twists(xi_a, xi_b)
    if a.dimension == 2 or b.dimension == 2:
        check_in_plane(flat_a, flat_b)
    system = systems.at(systems.q, flat_a, flat_b, xi_a, xi_b)
    return system._replace(repaired=pose_a.repaired + pose_b.repaired)


class PairSystems:
    """The paper's system of one pair of features, for many parameters and poses.

    Neither is checked. A little outside a feature, its surface or curve continues.

    Parameters
    ----------
    a, b : Body
    place_a, place_b : (feature, parameters)
        As ``pair_system`` takes them.

    Attributes
    ----------
    q : (n,) array
        Parameters of the places.
    """

    def __init__(self, a: Body, b: Body, place_a: PlaceLike, place_b: PlaceLike) -> None:
        check_pair(a, b)
        state = StateRow()
        put(state, 0, a, place_a)
        put(state, 1, b, place_b)
        self.packed = (a.ints, a.reals, b.ints, b.reals)
        mode = state.mode.astype(np.int64)
        self.counts = [
            2 - int(number >= body.n_faces) - int(number >= body.n_faces + body.n_edges)
            for number, body in zip(mode[::2], (a, b), strict=True)
        ]
        self.kept = np.array([0, 1, 2, 3])[np.r_[: self.counts[0], 2 : 2 + self.counts[1]]]
        self.q = np.asarray(state.q[self.kept])
        self._state, self._out = state, np.empty(queries.N_SYSTEM)

    def at(
        self, q: Array, flat_a: Array, flat_b: Array, xi_a: Array = STILL, xi_b: Array = STILL
    ) -> PairSystem:
        """The system at parameters (n,), for poses (12,) and twists (6,) as ``step_into`` reads."""
        out = self._evaluated(q, flat_a, flat_b, xi_a, xi_b)
        jets = out[queries.JETS : queries.ERRORS].reshape(2, 6, 3) @ flat_a[:9].reshape(3, 3).T
        H = np.empty((4, 4))
        H[UPPER] = H.T[UPPER] = out[queries.HESSIAN :]
        H = H[np.ix_(self.kept, self.kept)]
        sign = SIGNS[self.kept]
        psi = out[queries.ERRORS : queries.FEEDFORWARD][self.kept]
        b_vector = out[queries.FEEDFORWARD : queries.HESSIAN][self.kept]
        return PairSystem(
            dR=jets[0, 0] - jets[1, 0],
            F=jets[0, 1 : 1 + self.counts[0]].T,
            G=jets[1, 1 : 1 + self.counts[1]].T,
            Psi=psi,
            M=sign[:, None] * H,
            b=b_vector,
            g=sign * psi,
            H=H,
            g_t=sign * b_vector,
        )

    def psi(self, q: Array, flat_a: Array, flat_b: Array) -> Array:
        """The projection errors alone, (n,).  Eqs. (1)-(4)"""
        out = self._evaluated(q, flat_a, flat_b, STILL, STILL)
        return np.asarray(out[queries.ERRORS : queries.FEEDFORWARD][self.kept])

    def _evaluated(self, q: Array, flat_a: Array, flat_b: Array, xi_a: Array, xi_b: Array) -> Array:
        self._state.q[self.kept] = q
        motion = motion_row(flat_a, flat_b, xi_a, xi_b)
        queries.pair_system(self.packed, motion, self._state.data, self._out)
        return self._out
