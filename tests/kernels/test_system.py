"""The pair system against central differences, for every kind of feature pair.

M and b of Eqs. (9)-(10) are the derivatives of Psi, J and r_t those of the contact-regular
residual: by the parameters at rest, and by time when either body moves and the parameters stay.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
from families.shapes import PLANAR
from standoff.geometry import ConicArc, Line, RationalBezier
from standoff.kernels.body.features import feature_jet, moved_jet
from standoff.kernels.pair.system import (
    contact_feedforward,
    contact_jacobian,
    contact_residual,
    feedforward,
    hessian,
    projection_errors,
)
from standoff.kernels.values import Pose

TOLERANCE = 1e-7
"""Error of an entry, relative to the greatest of its matrix or vector."""
# Central differences of eighth order; the first term left out and the roundoff are below 1e-10.
OFFSETS = np.array([1, 2, 3, 4])
WEIGHTS = np.array([4 / 5, -1 / 5, 4 / 105, -1 / 280])
STEP = 0.004
SIGNS = np.diag([1.0, 1.0, -1.0, -1.0])
"""S of H = S M."""
UPPER = np.triu_indices(4)


@dataclass(frozen=True)
class Spot:
    """A feature of a body and the parameters (p, q) about which it is differentiated."""

    body: so.Body
    kind: str
    number: int
    chart: int = -1
    parameters: tuple[float, float] = (0.0, 0.0)

    @property
    def free(self):
        """Which of the two parameters exist."""
        return {"face": (True, True), "edge": (True, False), "vertex": (False, False)}[self.kind]

    def jet(self, parameters, rotation, position):
        """The world jet at a pose, as the kernels take it."""
        jet = feature_jet(self.body.ints, self.body.reals, self.number, self.chart, *parameters)
        return moved_jet(Pose(tuple(rotation.ravel()), tuple(position)), jet)


def face(body, number, chart, u, v):
    return Spot(body, "face", number, chart, (u, v))


def edge(body, number, t):
    return Spot(body, "edge", body.n_faces + number, -1, (t, 0.0))


def vertex(body, number):
    return Spot(body, "vertex", body.n_faces + body.n_edges + number)


LENS = so.shapes.lens(1.0, 0.45).transformed(np.diag([0.8, 1.2, 1.0]))
LOOP = so.shapes.planar_loop([RationalBezier(points, [1, 2, 1.5, 1]) for points in PLANAR])
HALF_DISC = so.shapes.planar_loop(
    [ConicArc((0, 0), (1, 0), (0, 0.8), 0, np.pi), Line((-1, 0), (1, 0))]
)
SPATIAL = {
    "ellipsoid's face": face(so.shapes.ellipsoid(1.0, 0.7, 0.5), 0, 3, 0.4, -0.3),
    "lens's face": face(LENS, 1, 1, 0.2, 0.1),
    "plane": face(so.shapes.box(1, 2, 3), 2, 2, 0.1, 0.3),
    "cylinder's side": face(so.shapes.cylinder(0.6, 1.5), 0, 0, 2.0, 0.3),
    "cone's side": face(so.shapes.cone(0.6, 1.5), 0, 0, -1.0, 0.6),
    "conic edge": edge(LENS, 2, 0.3),
    "straight edge": edge(so.shapes.box(1, 2, 3), 4, 0.4),
    "vertex": vertex(LENS, 1),
}
PLANE = {
    "Bezier curve": edge(LOOP, 1, 0.35),
    "conic curve": edge(HALF_DISC, 0, 1.1),
    "line": edge(HALF_DISC, 1, 0.3),
    "vertex": vertex(LOOP, 2),
}


def moved(pose, twist, time):
    """The pose after ``time`` at a twist (v, omega), which it has at time 0."""
    turn = Rotation.from_rotvec(twist[3:] * time).as_matrix()
    return turn @ pose[0], pose[1] + twist[:3] * time


@dataclass(frozen=True)
class Placed:
    """Two spots, their poses, and (n, d) of the contact-regular form."""

    a: Spot
    b: Spot
    poses: tuple
    normal: np.ndarray
    depth: float

    def jets(self, q, poses):
        first = self.a.jet(q[:2], *poses[0])
        return first, self.b.jet(q[2:], *poses[1])

    def moved(self, twists, time):
        """The poses after ``time`` at the twists."""
        return [moved(pose, twist, time) for pose, twist in zip(self.poses, twists, strict=True)]

    def motion(self, twists):
        """(p, v, omega) of A and of B, as the kernels take them."""
        return [
            (tuple(position), tuple(twist[:3]), tuple(twist[3:]))
            for (_, position), twist in zip(self.poses, twists, strict=True)
        ]

    @property
    def q(self):
        return np.array([*self.a.parameters, *self.b.parameters])

    @property
    def free(self):
        return np.array([*self.a.free, *self.b.free])


def place(a, b, rng, planar):
    """Put two spots at random poses; n and d are random too: the derivatives hold anywhere."""
    poses = []
    for _ in range(2):
        vector, position = rng.normal(size=3), rng.normal(size=3)
        if planar:
            vector[:2], position[2] = 0.0, 0.0
        poses.append((Rotation.from_rotvec(vector).as_matrix(), position))
    normal = rng.normal(size=3)
    if planar:
        normal[2] = 0.0
    return Placed(a, b, tuple(poses), normal / np.linalg.norm(normal), float(rng.normal()))


def difference(function):
    """Derivative at 0 of an array-valued function of one number."""
    total = 0.0
    for offset, weight in zip(OFFSETS, WEIGHTS, strict=True):
        step = offset * STEP
        total = total + weight * (function(step) - function(-step))
    return total / STEP


def assert_close(found, known):
    found, known = np.asarray(found), np.asarray(known)
    assert np.abs(found - known).max() <= TOLERANCE * max(np.abs(known).max(), 1e-3)


def cases(features, planar):
    """Every pair of features, either way round."""
    return [
        pytest.param(features[a], features[b], planar, id=f"{a}, {b}, planar={planar}")
        for a, b in product(features, repeat=2)
    ]


CASES = cases(SPATIAL, False) + cases(PLANE, True)


def unit_twists(planar):
    """(twist of A, twist of B) with one component at a time."""
    for component in (0, 1, 5) if planar else range(6):
        for body in range(2):
            twists = np.zeros((2, 6))
            twists[body, component] = 1.0
            yield twists


@pytest.mark.parametrize(("a", "b", "planar"), CASES)
def test_m_and_b_are_the_derivatives_of_psi(a, b, planar):
    placed = place(a, b, np.random.default_rng(51), planar)
    q, free = placed.q, placed.free

    def psi(parameters, poses):
        return np.array(projection_errors(*placed.jets(parameters, poses)))

    m = np.zeros((4, 4))
    m[UPPER] = hessian(*placed.jets(q, placed.poses))
    m = SIGNS @ (m + np.triu(m, 1).T)
    known = np.stack(
        [difference(lambda s, e=e: psi(q + s * e, placed.poses)) for e in np.eye(4)], axis=1
    )
    # Parameters that do not exist: no error, no coupling, and 1 on the diagonal of H.
    assert not known[~free].any()
    assert not known[:, ~free].any()
    known[~free, ~free] = np.diag(SIGNS)[~free]
    assert_close(m, known)

    for twists in unit_twists(planar):

        def psi_at(time, twists=twists):
            return psi(q, placed.moved(twists, time))

        found = feedforward(*placed.jets(q, placed.poses), *placed.motion(twists))
        assert_close(found, difference(psi_at))


@pytest.mark.parametrize(("a", "b", "planar"), CASES)
def test_j_and_r_t_are_the_derivatives_of_r(a, b, planar):
    placed = place(a, b, np.random.default_rng(52), planar)
    y = np.array([*placed.q, *placed.normal, placed.depth])

    def residual(y, poses):
        return np.array(contact_residual(*placed.jets(y[:4], poses), tuple(y[4:7]), y[7]))

    jets = placed.jets(placed.q, placed.poses)
    normal = tuple(placed.normal)
    found = np.empty((8, 8))
    contact_jacobian(*jets, normal, placed.depth, found.reshape(64))
    known = np.stack(
        [difference(lambda s, e=e: residual(y + s * e, placed.poses)) for e in np.eye(8)], axis=1
    )
    masked = np.flatnonzero(~placed.free)
    assert not known[masked].any()
    assert not known[:, masked].any()
    known[masked, masked] = 1.0
    assert_close(found, known)
    np.testing.assert_array_equal(found, found.T)

    for twists in unit_twists(planar):

        def residual_at(time, twists=twists):
            return residual(y, placed.moved(twists, time))

        rate = contact_feedforward(*jets, normal, *placed.motion(twists))
        assert_close(rate, difference(residual_at))
