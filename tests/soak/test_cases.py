"""Drawn pairs: the same from their numbers, exact twists, and motions as their family says."""

import json

import numpy as np
import pytest

from standoff_studies.soak import cases
from standoff_studies.soak.cases import Case, draw_case
from standoff_studies.soak.directions import depths, spread
from standoff_studies.soak.ledger import Ledger
from standoff_studies.soak.motions import Motion, Turn, draw_path
from standoff_studies.soak.tally import Tally

SEED = 7


def test_a_case_is_the_same_drawn_twice_and_from_its_file():
    case, _, _, frames = draw_case(SEED, 3, 50)
    again, _, _, frames_again = draw_case(SEED, 3, 50)
    assert case == again
    read = Case.of(json.loads(json.dumps(case.facts())))
    assert read == case
    for drawn, twice, from_file in zip(frames, frames_again, read.motion.frames(50), strict=True):
        assert np.array_equal(drawn, twice)
        assert np.array_equal(drawn, from_file)


def test_twists_are_the_derivatives_of_the_poses(rng):
    path = draw_path(rng, 2.0, 1.5)
    turns = [Turn([0.0, 0.6, 0.8], 1.3, 0.4, 2.0, 0.3), Turn([1.0, 0.0, 0.0], -0.7)]
    path = type(path)(path.start, [1.0, 2.0, 3.0], [0.1, -0.2, 0.3], turns, path.waves)
    h = 1e-5
    t = rng.uniform(0.0, 10.0, 20)
    rotation, _, v, omega = path.at(t)
    after, before = path.at(t + h), path.at(t - h)
    np.testing.assert_allclose((after[1] - before[1]) / (2 * h), v, atol=1e-6)
    spin = (after[0] - before[0]) / (2 * h) @ np.swapaxes(rotation, 1, 2)
    found = np.stack([spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]], axis=1)
    np.testing.assert_allclose(found, omega, atol=1e-6)
    np.testing.assert_allclose(rotation @ np.swapaxes(rotation, 1, 2), [np.eye(3)] * 20, atol=1e-14)


def test_teleports_uneven_steps_and_wrong_twists(rng):
    path = draw_path(rng, 1.0, 1.0)
    shown = {"uneven": 0.8, "jumps": [[5.0, 3.0]]}
    motion = Motion(path, path, 0.01, **shown, twist_factor=2.0, twist_error=[1.0] * 6)
    t, steps = motion.times(10)
    assert steps.min() > 0.005
    assert np.ptp(steps) > 0.003
    smooth = np.arange(9) != 4
    np.testing.assert_allclose(np.diff(t)[smooth], steps[1:][smooth])
    assert t[5] - t[4] == pytest.approx(3.0 + steps[5])
    true = Motion(path, path, 0.01, **shown).frames(10)
    np.testing.assert_allclose(motion.frames(10).twists_a, 2.0 * true.twists_a + 1.0)


def deepest(family, monkeypatch):
    """The greatest depth of each of some pairs, over its lesser body's size."""
    monkeypatch.setattr(cases, "FAMILIES", {family: 1.0})
    found = []
    for number in range(12):
        case, a, b, frames = draw_case(SEED, number, 40)
        assert case.family == family
        if a.body.bounded and b.body.bounded:
            n = np.broadcast_to(spread(300), (40, 300, 3))
            sizes = [made.body.size for made in (a, b) if made.body.size > 0.0]
            depth = depths(a, b, frames.poses_a, frames.poses_b, n).min(axis=1)
            found.append(depth.max() / min(sizes, default=1.0))
    return np.array(found)


def test_families_are_what_they_say(monkeypatch):
    assert deepest("apart", monkeypatch).max() < 0.1  # as far as 300 directions tell
    passing = deepest("passing", monkeypatch)
    assert 0.0 < passing.max() < 0.25
    touching = deepest("touching", monkeypatch)
    assert ((touching > -0.3) & (touching < 1.0)).all()
    assert deepest("inside", monkeypatch).max() > 0.05


def test_what_is_left_goes_by_drawers():
    ledger = Ledger(0, 10)
    assert ledger.left(130) == [(0, 64), (64, 128), (128, 130)]
    for part in ((64, 128), (0, 10), (20, 30)):
        ledger.add(part, Tally())
    assert ledger.done == [(0, 10), (20, 30), (64, 128)]
    assert ledger.left(150) == [(10, 20), (30, 64), (128, 150)]
    assert ledger.left(15) == [(10, 15)]
    assert ledger.pairs_done() == 84
