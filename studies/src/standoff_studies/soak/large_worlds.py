"""``python -m standoff_studies.soak.large_worlds``: a large world against all of its pairs.

Bodies of all kinds drift, turn, jump and pause. In every checked frame all pairs are looked at:
those whose balls come within the horizon are asked by cold queries, which know nothing of the
world. No such pair may be missing, no bound too great, and the clearance never above the least
distance.

Options: --bodies N (1000), --frames M (10000), --every K (1: check every K-th frame), --seed S.
"""

from __future__ import annotations

import argparse
import itertools
import time
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.cli.terminal import tell
from standoff.world import World, WorldAnswer

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

WITHIN = 0.15
H = 2e-3
JUMPS = 0.002
"""Part of the bodies that jump in a frame."""
PAUSES = 0.2
"""Part of the bodies that rest at any time."""
ROOM = 1.45
"""Side of the cube that each body has to itself."""


def kinds() -> list[so.Body]:
    """Bodies of about one size: without faces, with flat and curved ones, of NURBS."""
    shapes = so.shapes
    patches = so.shapes.lens(0.5, 0.2)
    return [
        shapes.sphere(0.4),
        shapes.capsule(0.2, 0.6),
        shapes.ellipsoid(0.3, 0.5, 0.4),
        shapes.box((0.6, 0.5, 0.7)),
        shapes.box((0.6, 0.5, 0.7), rounding=0.1),
        shapes.cylinder(0.3, 0.7),
        shapes.cone(0.4, 0.8),
        patches,
        shapes.superellipsoid((0.4, 0.3, 0.5), (0.6, 0.8)),
        shapes.egg(0.3, 1.0),
        shapes.spindle(0.4, 1.0),
        shapes.gore(0.3, 0.8),
    ]


class Counts(NamedTuple):
    """Of all checked frames."""

    frames: int
    near: int
    asked: int
    missed: int
    wrong: int
    above: int


class Drift:
    """Bodies in a cube, by arrays."""

    def __init__(self, n: int, rng: np.random.Generator) -> None:
        self.rng, self.side = rng, ROOM * n ** (1.0 / 3.0)
        self.poses = self.drawn(n)
        self.speed = rng.normal(size=(n, 3))
        self.spin = 2.0 * rng.normal(size=(n, 3))
        self.turn = Rotation.from_rotvec(H * self.spin).as_matrix()

    def drawn(self, n: int) -> Array:
        poses = np.tile(np.eye(4), (n, 1, 1))
        poses[:, :3, :3] = Rotation.random(n, random_state=self.rng).as_matrix()
        poses[:, :3, 3] = self.rng.uniform(-0.5, 0.5, (n, 3)) * self.side
        return poses

    def step(self) -> Array:
        """Move all but those that pause; some jump."""
        n = len(self.poses)
        poses = self.poses.copy()
        go = self.rng.random(n) > PAUSES
        poses[go, :3, 3] += H * self.speed[go]
        poses[go, :3, :3] = self.turn[go] @ poses[go, :3, :3]
        at = poses[:, :3, 3]
        self.speed = np.where(
            np.abs(at) > self.side / 2, -np.sign(at) * abs(self.speed), self.speed
        )
        jump = np.flatnonzero(self.rng.random(n) < JUMPS)
        poses[jump] = self.drawn(len(jump))
        poses[:, :3, :3] = nearest_rotations(poses[:, :3, :3])
        self.poses = poses
        return poses


def nearest_rotations(turns: Array) -> Array:
    """One Newton step towards orthonormal matrices: products of many turns drift."""
    found: Array = turns @ (1.5 * np.eye(3) - 0.5 * turns.transpose(0, 2, 1) @ turns)
    return found


def candidates(centres: Array, radii: Array) -> Ints:
    """All pairs (k, 2) whose balls come within the horizon."""
    found = []
    for i in range(len(centres) - 1):
        away = centres[i + 1 :] - centres[i]
        reach = radii[i + 1 :] + radii[i] + WITHIN
        near = np.flatnonzero(np.einsum("ij,ij->i", away, away) <= reach * reach)
        found.append(np.stack([np.full(len(near), i), near + i + 1], axis=1))
    return np.concatenate(found) if found else np.zeros((0, 2), dtype=np.int64)


def true_distances(bodies: list[so.Body], kind: Ints, pairs: Ints, poses: Array) -> Array:
    """Cold queries of all candidates: (distance, upper bound) of each."""
    found = np.empty((len(pairs), 2))
    for a, b in itertools.product(range(len(bodies)), repeat=2):
        here = np.flatnonzero((kind[pairs[:, 0]] == a) & (kind[pairs[:, 1]] == b))
        if len(here):
            i, j = pairs[here].T
            asked = so.distances(bodies[a], bodies[b], poses[i], poses[j])
            found[here, 0], found[here, 1] = asked.distance, asked.upper_bound
    return found


def check(answer: WorldAnswer, pairs: Ints, true: Array, counts: Counts) -> Counts:
    """Compare a frame with the truth."""
    n = len(answer.model.listed)
    told = answer.pairs
    keys = told.bodies @ [n, 1]
    order = np.argsort(keys)
    wanted = np.flatnonzero(true[:, 0] <= WITHIN)
    at = np.searchsorted(keys[order], pairs[wanted] @ [n, 1])
    at = np.minimum(at, max(0, len(keys) - 1))
    there = keys[order][at] == pairs[wanted] @ [n, 1] if len(keys) else np.zeros(len(wanted), bool)
    distance, lower = told.distance[order][at], told.lower_bound[order][at]
    depth = np.maximum(0.0, -true[wanted, 0])
    off = np.abs(distance - true[wanted, 0]) > 1e-9 + 1e-3 * depth
    wrong = (off | (lower > true[wanted, 1] + 1e-12)) & there
    least = min(WITHIN, float(true[:, 0].min(initial=np.inf)))
    return Counts(
        counts.frames + 1,
        counts.near + len(wanted),
        counts.asked + len(pairs),
        counts.missed + int(np.count_nonzero(~there)),
        counts.wrong + int(np.count_nonzero(wrong)),
        counts.above + int(answer.clearance > least + 1e-12),
    )


def run(n: int, frames: int, every: int, seed: int) -> Counts:
    """Step a world, and check its frames."""
    bodies, rng = kinds(), np.random.default_rng(seed)
    kind = np.arange(n) % len(bodies)
    world = World({f"b{k}": bodies[x] for k, x in enumerate(kind)}, within=WITHIN, dt=H)
    radii = np.array([0.5 * body.size for body in bodies])[kind]
    facts = world.model.search.pieces.facts
    drift = Drift(n, rng)
    state = world.start(drift.poses)
    counts, told = Counts(0, 0, 0, 0, 0, 0), time.monotonic()
    for frame in range(frames):
        poses = drift.step()
        state, answer = world.step(state, poses)
        if frame % every == 0:
            # a body's ball is about the middle of its box, which may stand off its origin
            centres = np.einsum("nij,nj->ni", poses[:, :3, :3], facts[:, 13:16]) + poses[:, :3, 3]
            pairs = candidates(centres, radii)
            counts = check(answer, pairs, true_distances(bodies, kind, pairs, poses), counts)
        if time.monotonic() - told > 30.0:
            told = time.monotonic()
            tell(f"frame {frame + 1} of {frames}: {counts}, {answer.counts}")
    return counts


def main() -> int:
    """Read the options, run, and tell; 3 if anything was wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    for name, usual in (("bodies", 1000), ("frames", 10_000), ("every", 1), ("seed", 0)):
        parser.add_argument(f"--{name}", type=int, default=usual)
    given = parser.parse_args()
    counts = run(given.bodies, given.frames, given.every, given.seed)
    tell(
        f"{counts.frames} frames of {given.bodies} bodies: {counts.near} near pairs, "
        f"{counts.asked} asked; {counts.missed} missed, {counts.wrong} wrong, clearance "
        f"{counts.above} times above the truth"
    )
    return 3 if counts.missed or counts.wrong or counts.above else 0


if __name__ == "__main__":
    raise SystemExit(main())
