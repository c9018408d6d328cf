"""An egg past three curved obstacles: SLSQP with exact gradients, then with finite differences.

Run it as `python past_three_obstacles.py [picture.png]`. At the end a clearance is proven along the
whole trajectory, between the knots too. The picture needs the extra `plot`.
"""

import sys
import time

import numpy as np
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

import standoff as so

EGG = so.shapes.ellipsoid(0.22, 0.08, 0.08)
OBSTACLES = [
    (so.shapes.ellipsoid(0.4, 0.3, 0.5), so.Pose(np.eye(3), [0.8, 0.12, 0.0])),
    (so.shapes.lens(0.6, 0.27), so.Pose(np.eye(3), [1.8, -0.15, 0.05])),
    (so.shapes.cylinder(0.3, 1.2), so.Pose(np.eye(3), [2.8, 0.1, 0.0])),
]
START, GOAL = np.zeros(6), np.array([0.0, 0.0, 0.0, 3.6, 0.0, 0.0])
AT_KNOTS, PROVEN = 0.09, 0.05
"""Clearance asked for at the knots, and proven between them too [length]."""
KNOTS = 12
TURNING = 0.05
"""What a squared radian costs beside a squared length."""


def knots(z):
    """(n + 2, 6) rotation vectors and positions, with start and goal."""
    return np.vstack([START, z.reshape(-1, 6), GOAL])


def poses(q):
    """(n, 4, 4) matrices."""
    found = np.tile(np.eye(4), (len(q), 1, 1))
    found[:, :3, :3] = Rotation.from_rotvec(q[:, :3]).as_matrix()
    found[:, :3, 3] = q[:, 3:]
    return found


def turns_by_vectors(vectors):
    """(n, 3, 3) angular velocity by the rate of a rotation vector: the left Jacobian of SO(3)."""
    angles = np.linalg.norm(vectors, axis=1)[:, None, None] + 1e-12
    k = np.cross(vectors[:, None, :], np.eye(3)).transpose(0, 2, 1)
    bend, twist = (1 - np.cos(angles)) / angles**2, (angles - np.sin(angles)) / angles**3
    return np.eye(3) + bend * k + twist * k @ k


def length(z):
    """Sum of the squared legs, and its gradient."""
    weights = np.repeat([TURNING, 1.0], 3)
    legs = np.diff(knots(z), axis=0)
    gradient = 2.0 * weights * (legs[:-1] - legs[1:])
    return (weights * legs**2).sum(), gradient.ravel()


class Clearances:
    """What SLSQP asks for, and how often: all knots and one obstacle are one call."""

    def __init__(self):
        self.evaluations = self.gradients = 0

    def found(self, z):
        at = poses(z.reshape(-1, 6))
        return [so.distances(body, EGG, pose.matrix, at) for body, pose in OBSTACLES]

    def values(self, z):
        self.evaluations += 1
        return np.concatenate([one.distance for one in self.found(z)]) - AT_KNOTS

    def jacobian(self, z):
        self.gradients += 1
        q = z.reshape(-1, 6)
        rows = np.zeros((len(OBSTACLES), len(q), len(q), 6))
        each = np.arange(len(q))
        for k, one in enumerate(self.found(z)):
            by_twist = one.gradient[:, 6:]  # (v, omega) of the egg
            rows[k, each, each, 3:] = by_twist[:, :3]
            turns = turns_by_vectors(q[:, :3])
            rows[k, each, each, :3] = np.einsum("ni,nij->nj", by_twist[:, 3:], turns)
        return rows.reshape(-1, z.size)


def plan(exact):
    """Solve, and tell what it took."""
    asked = Clearances()
    constraint = {"type": "ineq", "fun": asked.values}
    if exact:
        constraint["jac"] = asked.jacobian
    first = np.linspace(START, GOAL, KNOTS + 2)[1:-1]
    first[:, 1] += 0.02 * np.arange(KNOTS) / KNOTS  # off the symmetric saddle
    asked.jacobian(first.ravel())  # loads the kernels: not what is measured
    asked.gradients = 0
    began = time.perf_counter()
    found = minimize(
        length, first.ravel(), jac=True, constraints=[constraint], method="SLSQP",
        options={"maxiter": 300, "ftol": 1e-8},
    )  # fmt: skip
    took = time.perf_counter() - began
    assert found.success, found.message
    print(
        f"{'exact gradients' if exact else 'finite differences'}: {found.nit} iterations, "
        f"{asked.evaluations} evaluations, {asked.gradients} Jacobians, {took:.2f} s, "
        f"cost {found.fun:.6f}"
    )
    return found.x, asked, took


def proven(path, clearance):
    """Is the egg farther than that from all obstacles, all the way?"""
    motion = so.motion.PoseSamples(np.arange(len(path)), poses(path))
    proofs = [
        so.time_of_impact(
            body, EGG, so.motion.Fixed(pose), motion, duration=len(path) - 1.0, clearance=clearance
        )
        for body, pose in OBSTACLES
    ]
    return all(proof.status.name == "NO_IMPACT" for proof in proofs)


def draw(path, file):
    """Seen from above: obstacles cut at the height of the path, and the egg at every knot."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(9.0, 3.6), layout="constrained")
    for (body, pose), colour in zip(OBSTACLES, ("C0", "C1", "C2"), strict=True):
        outline(axes, body, pose.matrix, colour, body.name, 0.45)
    for k, pose in enumerate(poses(path)):
        outline(axes, EGG, pose, "0.25", "egg at the knots" if not k else None, 0.25)
    motion = so.motion.PoseSamples(np.arange(len(path)), poses(path))
    way = [motion.pose(t).translation for t in np.linspace(0, len(path) - 1, 400)]
    axes.plot(*np.array(way)[:, :2].T, "k", linewidth=0.8, label="its centre")
    axes.set_aspect("equal")
    axes.set_xlabel("x")
    axes.set_ylabel("y")
    axes.set_title(f"From above: a clearance of {PROVEN} is proven all the way")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=5, fontsize=8)
    figure.savefig(file, dpi=130)


def outline(axes, body, matrix, colour, label, alpha):
    """The shadow on the x-y plane, by where half-planes touch the body."""
    angles = np.linspace(0.0, 2.0 * np.pi, 181)
    points = []
    for angle in angles:
        outward = np.array([np.cos(angle), np.sin(angle), 0.0])
        wall = so.shapes.halfspace(-outward)
        far = so.Pose(np.eye(3), matrix[:3, 3] + 10.0 * outward)
        points.append(so.distance(wall, body, far, matrix).point_b[:2])
    axes.fill(*np.array(points).T, facecolor=colour, edgecolor=colour, alpha=alpha, label=label)


def main():
    z, exact, took = plan(exact=True)
    _, differences, slow = plan(exact=False)
    calls = exact.evaluations + exact.gradients
    print(
        f"differences ask {differences.evaluations / calls:.0f} times as often and take "
        f"{slow / took:.0f} times as long"
    )
    path = knots(z)
    assert proven(path, PROVEN)
    low, high = PROVEN, AT_KNOTS
    while high - low > 1e-4:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if proven(path, middle) else (low, middle)
    print(f"at the knots {AT_KNOTS}; proven between them too: {low:.4f}")
    if len(sys.argv) > 1:
        draw(path, sys.argv[1])


if __name__ == "__main__":
    main()
