"""The adversary, in rounds: places and directions that no search would choose, and wild trackers.

A round is a scene of known distance, for which only the certificate is queried, many times; one
round in WILD_EVERY also has a tracker led astray. Seed and number determine a round.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from standoff_studies.soak import any_places as P
from standoff_studies.soak import certificate_checks, wild_runs
from standoff_studies.soak.certificate_checks import Miss
from standoff_studies.soak.known_gaps import Scene, draw_scene, draw_walk
from standoff_studies.soak.motions import stream
from standoff_studies.soak.shapes import Shape
from standoff_studies.soak.tally import Tally

CASES = 200
"""Cases of a round that accompanies a pair of the soak."""

WILD_EVERY = 40
"""Rounds from one with a wild run to the next: such a run takes as long as thousands of cases."""

WILD_FRAMES = 30
"""Frames of a wild run."""

PER_DRAWER = 64
"""Rounds that share bodies."""

SCENES, WALKS = 4, 5
"""Streams of a seed's random numbers, different from those of the soak's pairs."""


class Breach(NamedTuple):
    """A failed check of a round.

    Attributes
    ----------
    seed, number, cases : int
        The round, and its number of cases.
    miss : Miss
        The check, and the number of the case or the frame.
    facts : dict
        The bodies, the poses, the true distance, and what was asked and answered.
    """

    seed: int
    number: int
    cases: int
    miss: Miss
    facts: dict[str, Any]


def run_round(seed: int, number: int, cases: int = CASES) -> tuple[Tally, list[Breach]]:
    """Run a round: count, and return the worst case of every check that fails."""
    tally = Tally()
    rng = stream(seed, SCENES, number)
    scene = draw_scene(rng, seed, number // PER_DRAWER)
    asked = certificate_checks.ask_all(scene, rng.random((cases, P.N_DRAWN)))
    certificate_checks.count(tally, scene, asked)
    found = [
        Breach(seed, number, cases, miss, _asked_facts(scene, asked[miss.case].tolist()))
        for miss in certificate_checks.misses(scene, asked)
    ]
    if number % WILD_EVERY == 0:
        rng = stream(seed, WALKS, number)
        walk = draw_walk(rng, seed, number // PER_DRAWER, WILD_FRAMES)
        run = wild_runs.run(rng, walk)
        wild_runs.count(tally, run)
        found += [
            Breach(seed, number, cases, miss, _run_facts(run, miss.case))
            for miss in wild_runs.misses(run)
        ]
    return tally, found


def wild_frames(rounds: int) -> int:
    """Return how many frames the wild runs of rounds 0 .. rounds - 1 have."""
    return -(-rounds // WILD_EVERY) * WILD_FRAMES


def _scene_facts(scene: Scene) -> dict[str, Any]:
    return {
        "a": _shape_facts(scene.a.shape),
        "b": _shape_facts(scene.b.shape),
        "pose_a": scene.pose_a.tolist(),
        "pose_b": scene.pose_b.tolist(),
        "distance": scene.truth,
    }


def _shape_facts(shape: Shape) -> dict[str, Any]:
    return dict(shape._asdict())


def _asked_facts(scene: Scene, row: list[float]) -> dict[str, Any]:
    along = row[P.HOW] >= P.ALONG
    return _scene_facts(scene) | {
        "asked": "certify_along" if along else "weigh",
        "place": row[P.PLACE : P.PLACE + 8],
        "on_features": row[P.ON] > 0.5,
        "direction": row[P.HINT : P.HINT + 3],
        "tolerance": row[P.TOLERANCE],
        "points_apart": row[P.D],
        "lower_bound": row[P.LOWER],
        "normal": row[P.NORMAL : P.NORMAL + 3],
        "outcome": row[P.OUTCOME],
        "status": row[P.STATUS],
    }


def _run_facts(run: wild_runs.Run, frame: int) -> dict[str, Any]:
    return _scene_facts(run.scenes[frame]) | {
        "asked": "a wild run",
        "law": run.law.facts(),
        "given": run.given,
        "place": run.place,
        "twists": run.twists,
        "motions": run.frames.motions[: frame + 1].tolist(),
        "answer": run.rows[frame].tolist(),
    }
