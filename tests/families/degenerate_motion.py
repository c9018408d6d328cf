"""Degenerate bodies in motion: a tracker passes their edges, seams and contact, frame by frame."""

from __future__ import annotations

import numpy as np

import standoff as so
from families.degenerate import KINDS, partner
from families.degenerate_queries import Pose, Tally, faults
from families.shapes import Rng, Twin
from oracles.bounds import separation
from oracles.exact_pairs import ExactPair, exact_pair, random_normal
from oracles.membership import outside
from oracles.poses import rotation_about, size_of
from oracles.revolved import RevolvedHull
from standoff_studies.oracles import Affine, HalfSpace, Placed

STEP = 1e-2
"""Frame time, s, of bodies that turn by about 2 rad/s: twenty degrees in as many frames."""
OUTSIDE = 1e-11
"""How far outside its body a witness point may lie, over the pair's size."""
REST = (np.zeros(3), np.zeros(3))


def _outside(twin: Twin, placed: Placed, point: np.ndarray) -> float:
    """How far a witness lies outside; hulls of revolution are too slow to ask in every frame."""
    shape, local = twin.shape, placed.local(point)
    if isinstance(shape, RevolvedHull):
        return 0.0
    if isinstance(shape, Affine):  # judged before it was flattened: its quadric is too steep
        back = np.linalg.solve(shape.matrix, local - shape.shift)
        return outside(shape.shape, back) * float(np.linalg.norm(shape.matrix, 2))
    return outside(shape, local)


def frame_faults(
    a: Twin, b: Twin, first: Placed, second: Placed, answer: so.Proximity
) -> list[str]:
    """What is wrong with a tracked answer: its bounds are judged along its own normal."""
    if not np.isfinite([answer.distance, *answer.normal]).all():
        return [f"not finite: {answer!r}"]
    low = separation(first, second, answer.normal)
    pose = Pose(a, b, first, second, low, np.inf)
    found = faults(pose, answer)
    for twin, placed, point in ((a, first, answer.point_a), (b, second, answer.point_b)):
        off = _outside(twin, placed, point)
        if not off <= OUTSIDE * pose.size + pose.noise:
            found.append(f"witness {off:.2g} outside {twin.body.name}")
    return found


def _start(name: str, level: float, rng: Rng) -> tuple[Twin, Twin, ExactPair]:
    kind = KINDS[name]
    body = kind.make(rng, level)
    other = partner(rng, body)
    while isinstance(other.shape, HalfSpace):
        other = partner(rng, body)
    gap = size_of(body.shape, other.shape) * 10.0 ** float(rng.uniform(-6, -1))
    return body, other, exact_pair(body.shape, other.shape, gap, rng)


def track(name: str, level: float, frames: int, rng: Rng, *, twists: bool = True) -> Tally:
    """Turn B about itself and slide it past A; the pair is ``gap`` apart amid the motion."""
    tally = Tally(name, level)
    a, b, pair = _start(name, level, rng)
    axis, spin = random_normal(rng), float(rng.uniform(1.0, 2.0))
    slide = 0.3 * size_of(a.shape, b.shape) * rng.normal(size=3)
    slide -= (slide @ pair.normal) * pair.normal
    tracker = so.Tracker(a.body, b.body, dt=STEP)
    state = None
    for frame in range(frames):
        t = (frame - frames // 2) * STEP
        turned = rotation_about(axis, spin * t) @ pair.b.rotation
        place = pair.b.position + t * slide
        given = (REST, (slide, spin * axis)) if twists else ()
        poses = pair.pose_a, (turned, place)
        if state is None:
            state = tracker.start(*poses, *given)
            answer = state.proximity
        else:
            state, answer = tracker.step(state, *poses, *given)
        tally.queries += 1
        tally.uncertified += not answer.certified
        tally.restarted += answer.counts.restarts > 0
        tally.evaluations.append(answer.counts.evaluations)
        found = frame_faults(a, b, pair.a, Placed(b.shape, turned, place), answer)
        tally.failures += [f"{name} at {level:g}, frame {frame}: {text}" for text in found]
    return tally
