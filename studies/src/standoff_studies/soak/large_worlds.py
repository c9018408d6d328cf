"""``python -m standoff_studies.soak.large_worlds``: a large world against all of its pairs.

Bodies of all kinds drift, turn, jump and pause; after every --change frames some leave and some
enter, the horizon changes, and another world goes on from the state (`World.start_from`). In every
frame all pairs are judged by `large_truth`, which knows nothing of the world: no pair below the
horizon may be missing, no distance wrong, no bound above the truth, and the clearance never above
the least distance.

Every half minute a line says what was judged so far: it stands where a run is cut off.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from standoff.cli.terminal import tell
from standoff.kernels.world import arrays as W
from standoff.world import World, WorldAnswer
from standoff_studies.soak.large_motions import HORIZONS, Drift, H, kinds
from standoff_studies.soak.large_truth import Judge, Told, Verdict
from standoff_studies.soak.shapes import Made

Ints = NDArray[np.int64]

BLOCK = 20_000
"""Bodies, over frames, that are judged at once."""
TELL = 30.0
"""Seconds between two lines."""


def frames_of(made: list[Made], n: int, frames: int, change: int, seed: int) -> Iterator[Told]:
    """The frames of worlds of up to n bodies."""
    rng = np.random.default_rng(seed)
    drift, kind, there = Drift(n, rng), np.arange(n) % len(made), np.arange(n)
    world = world_of(made, kind, there, HORIZONS[1])
    state = world.start(drift.poses)
    yield told_by(world.answer(state), kind)
    for frame in range(1, frames):
        poses = drift.step()
        if frame % change == 0:
            before, there = there, drift.cast()
            after = world_of(made, kind, there, float(rng.choice(HORIZONS)))
            entering = {f"b{k}": poses[k] for k in np.setdiff1d(there, before).tolist()}
            # those that stay are where they were in the frame before
            state = after.start_from(world, state, entering)
            world, answer = after, after.answer(state)
        else:
            state, answer = world.step(state, poses[there])
        yield told_by(answer, kind[there])


def world_of(made: list[Made], kind: Ints, there: Ints, within: float) -> World:
    """Of some of the bodies."""
    bodies = {f"b{k}": made[kind[k]].body for k in there.tolist()}
    return World(bodies, within=within, dt=H)


def told_by(answer: WorldAnswer, kind: Ints) -> Told:
    """What an answer says; every body has one piece."""
    pairs, state = answer.pairs, answer.state
    return Told(
        kind,
        state.poses,
        answer.model.search.within,
        answer.clearance,
        pairs.bodies,
        pairs.distance,
        pairs.lower_bound,
        state.ints[:, [W.I_A, W.I_B]],
        state.known[:, W.C_BOUND],
    )


def run(made: list[Made], frames: Iterator[Told], count: int) -> Verdict:
    """Judge frames, and tell how far it is."""
    judge, verdict, block = Judge(made), Verdict(), []
    begun = told = time.monotonic()
    for one in frames:
        block.append(one)
        last = verdict.frames + len(block) == count
        if len(block) * len(one.kinds) < BLOCK and not last:
            continue
        verdict = verdict.plus(judge.verdict(block))
        block = []
        now = time.monotonic()
        if now - told > TELL and not last:
            told = now
            each = 1e3 * (now - begun) / verdict.frames
            tell(f"of {count} frames: {verdict} ({each:.0f} ms a frame)")
    return verdict


def main() -> int:
    """Read the options, run, and tell; 3 if anything was wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    options = (("bodies", 1000), ("frames", 10_000), ("change", 500), ("seed", 0))
    for name, usual in options:
        parser.add_argument(f"--{name}", type=int, default=usual)
    given = parser.parse_args()
    made = kinds()
    begun = time.monotonic()
    verdict = run(
        made, frames_of(made, given.bodies, given.frames, given.change, given.seed), given.frames
    )
    tell(f"up to {given.bodies} bodies, {time.monotonic() - begun:.0f} s: {verdict}")
    return 0 if verdict.sound else 3


if __name__ == "__main__":
    raise SystemExit(main())
