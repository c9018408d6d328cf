"""Large worlds against all of their pairs, and that the judge sees what is wrong."""

import numpy as np
import pytest

from standoff_studies.soak import large_worlds
from standoff_studies.soak.large_motions import kinds
from standoff_studies.soak.large_truth import Judge, Told


@pytest.fixture(scope="module")
def made():
    return kinds()


@pytest.fixture(scope="module")
def frames(made):
    return list(large_worlds.frames_of(made, 60, 12, change=5, seed=1))


def test_all_pairs_of_all_frames_are_sound(made, frames):
    verdict = large_worlds.run(made, iter(frames), len(frames))
    assert verdict.sound, verdict
    assert verdict.frames == 12
    assert verdict.near > 100
    assert len({len(one.kinds) for one in frames}) > 1  # some have left, or entered
    assert len({one.within for one in frames}) > 1


def test_a_cut_off_run_has_told_of_its_frames(made, frames, monkeypatch, capsys):
    monkeypatch.setattr(large_worlds, "BLOCK", 1)
    monkeypatch.setattr(large_worlds, "TELL", -1.0)
    large_worlds.run(made, iter(frames[:3]), 1000)
    lines = capsys.readouterr().out.splitlines()
    assert [line.split(":")[1].split(",")[0] for line in lines] == [
        " 1 frames",
        " 2 frames",
        " 3 frames",
    ]


def nearest(told: Told) -> int:
    return int(np.argmin(told.distance))


def lost(told):
    k = nearest(told)
    keep = np.arange(len(told.distance)) != k
    return told._replace(
        listed=told.listed[keep], distance=told.distance[keep], lower=told.lower[keep]
    )


def far_listed(told):
    """A pair that is beyond the horizon, in the place of one that is not."""
    away = np.linalg.norm(told.poses[:, None, :3, 3] - told.poses[None, :, :3, 3], axis=2)
    i, j = np.unravel_index(int(np.argmax(away)), away.shape)
    listed = np.concatenate([told.listed, [sorted((i, j))]])
    distance = np.append(told.distance, 0.1)
    return told._replace(listed=listed, distance=distance, lower=np.append(told.lower, 0.1))


def longer(told):
    return told._replace(distance=told.distance + 1e-8 + 2e-3 * abs(told.distance))


def claimed(told):
    return told._replace(lower=told.lower + 1e-7)


def bounded(told):
    return told._replace(bounds=np.full(len(told.bounds), 10.0))


def clear(told):
    least = float(told.distance.min())  # a depth is proven to one part in a thousand
    return told._replace(clearance=least + 1e-7 + 2e-3 * abs(least))


BREAKS = {
    "missed": [lost],
    "wrong": [far_listed, longer, claimed, bounded],
    "above": [clear],
}


@pytest.mark.parametrize(
    ("count", "broken"), [(count, each) for count, some in BREAKS.items() for each in some]
)
def test_a_mistake_is_counted(made, frames, count, broken):
    verdict = Judge(made).verdict([frames[0], broken(frames[1])])
    others = [name for name in BREAKS if name != count]
    assert getattr(verdict, count) > 0, verdict
    assert not any(getattr(verdict, name) for name in others), verdict
