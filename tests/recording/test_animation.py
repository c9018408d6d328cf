"""A recording as an animation, saved as a GIF."""

from __future__ import annotations

import copy
import pickle
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from moving_pairs import REST, straight
from PIL import Image

import standoff as so

SMALL, BOX = so.shapes.box(0.3, 0.2, 0.25), so.shapes.box(1.0, 1.0, 1.0)


@pytest.fixture(scope="module")
def passing() -> so.Recording:
    path = straight((-1.5, 0.1, 0.8), (1.0, 0.05, 0.0))
    return so.track(so.Tracker(SMALL, BOX, 1e-1), path, REST, 3.0)


def test_a_gif_has_the_pictures_asked_for_and_moves(passing: so.Recording, tmp_path: Path) -> None:
    passing.animate(pictures=4).save(tmp_path / "run.gif", writer="pillow", dpi=40)
    with Image.open(tmp_path / "run.gif") as gif:
        assert gif.n_frames == 4
        pictures = []
        for k in range(4):
            gif.seek(k)
            pictures.append(np.asarray(gif.convert("RGB"), dtype=float))
    for one, two in pairwise(pictures):
        assert np.mean(np.abs(one - two).max(axis=2) > 30.0) > 0.01


def test_no_more_pictures_than_frames(passing: so.Recording, tmp_path: Path) -> None:
    short = so.track(so.Tracker(SMALL, BOX, 1e-1), straight((-1.5, 0, 0), (1, 0, 0)), REST, 0.2)
    short.animate(pictures=60).save(tmp_path / "run.gif", writer="pillow", dpi=30)
    with Image.open(tmp_path / "run.gif") as gif:
        assert gif.n_frames == len(short) == 3


def test_what_cannot_be_animated_says_why(passing: so.Recording, tmp_path: Path) -> None:
    passing.save(tmp_path / "run.parquet")
    for other in (
        so.open_recording(tmp_path / "run.parquet"),
        copy.deepcopy(passing),
        pickle.loads(pickle.dumps(passing)),
    ):
        with pytest.raises(ValueError, match=r"animate the one that so\.track returned"):
            other.animate()
    with pytest.raises(ValueError, match="pictures = 0: must be a whole number of at least 1"):
        passing.animate(0)
    with pytest.raises(ValueError, match="view is not numeric"):
        passing.animate(view="above")  # type: ignore[arg-type]


def test_a_recording_of_a_function_can_be_stored() -> None:
    tracker = so.Tracker(SMALL, BOX, 1e-1)
    path = lambda t: so.Pose(np.eye(3), [2.0 + t, 0.0, 0.0])  # noqa: E731
    recording = so.track(tracker, path, np.eye(4), 0.3)
    again = pickle.loads(pickle.dumps(recording))
    np.testing.assert_array_equal(again.distance, recording.distance)
    assert again.paths is None
    assert recording.paths is not None
