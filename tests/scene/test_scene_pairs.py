"""Several pairs in one scene: their names, their settings, and what is refused."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import standoff as so
from standoff.scene import Scene, SceneError, TrackSettings, query, record

LoadText = Callable[[str], Scene]

BODIES = """version = 1
[bodies.finger]
shape = "sphere"
radius = 0.01
[bodies.cup]
shape = "cylinder"
radius = 0.04
height = 0.1
[bodies.table]
shape = "halfspace"
[placements.table]
position = [0.0, 0.0, -0.06]
[placements.finger]
position = [0.1, 0.0, 0.02]
[motions.finger]
kind = "twist"
linear = [0.0, 0.1, -0.02]
"""
TRACK = '[track]\nstep = 0.05\nduration = 0.5\npredictor = "feedforward"\n'
FIRST = '[[pairs]]\nname = "grasp"\na = "finger"\nb = "cup"\n'
SECOND = '[[pairs]]\na = "finger"\nb = "table"\nduration = 0.2\ntolerance = 1e-9\n'


def test_each_pair_has_its_bodies_and_settings(load_text: LoadText) -> None:
    scene = load_text(BODIES + FIRST + SECOND + TRACK)
    assert [pair.name for pair in scene.pairs] == ["grasp", "finger-table"]
    assert scene.selected.name == "grasp"
    first, second = scene.each()
    assert (first.pair, second.pair) == (("finger", "cup"), ("finger", "table"))
    common = TrackSettings(so.PredictorCorrector(predictor="feedforward"), 0.05, duration=0.5)
    assert first.settings == common
    law = so.PredictorCorrector(predictor="feedforward", tolerance=1e-9)
    assert second.settings == TrackSettings(law, 0.05, duration=0.2)
    assert scene.select("finger-table").pair_bodies[1] is scene.bodies["table"]
    assert (len(first.times()), len(second.times())) == (11, 5)


def test_each_pair_gives_what_it_gives_alone(load_text: LoadText) -> None:
    scene = load_text(BODIES + FIRST + SECOND + TRACK)
    for name, alone in (("grasp", FIRST), ("finger-table", SECOND)):
        other = load_text(BODIES + alone + TRACK)
        mine, theirs = record(scene.select(name)), record(other)
        np.testing.assert_array_equal(mine.distance, theirs.distance)
        assert query(scene.select(name), 0.1)[1].distance == query(other, 0.1)[1].distance
    # The finger sinks at 0.02 m/s towards the table, 0.07 m below its centre's first height.
    found = record(scene.select("finger-table"))
    np.testing.assert_allclose(found.distance, 0.07 - 0.02 * found.time, atol=1e-14)


def test_the_single_pair_is_still_one(load_text: LoadText) -> None:
    scene = load_text(f'{BODIES}[pair]\na = "finger"\nb = "cup"\n{TRACK}')
    assert [pair.name for pair in scene.pairs] == ["pair"]
    assert scene.pair == ("finger", "cup")
    assert scene.settings.step == 0.05


@pytest.mark.parametrize(
    ("text", "key", "pieces"),
    [
        ("pairs = []\n", "pairs", ["empty list", "[[pairs]]"]),
        ("pairs = 3\n", "pairs", ["a list", "got 3"]),
        ("", "", ["'pair' is missing", "[pair]"]),
        (f'{FIRST}[pair]\na = "finger"\nb = "cup"\n', "pair", ["together with [[pairs]]"]),
        (FIRST + FIRST, "pairs[1].name", ["two pairs are called 'grasp'", "pairs[0]"]),
        (FIRST + FIRST.replace("grasp", "Grasp"), "pairs[1].name", ["'Grasp'", "pairs[0]"]),
        (SECOND + SECOND, "pairs[1].name", ["'finger-table'"]),
        (FIRST.replace("grasp", "../grasp"), "pairs[0].name", ["file names", "letters"]),
        (FIRST.replace("cup", "cupp"), "pairs[0].b", ["unknown body 'cupp'", "mean 'cup'"]),
        (FIRST + '[[pairs]]\na = "cup"\nb = "cup"\n', "pairs[1]", ["'cup' is both"]),
        (FIRST + "tolerence = 1\n", "pairs[0].tolerence", ["did you mean 'tolerance'?"]),
        (FIRST + "step = 0\n", "pairs[0].step", ["above zero"]),
        (FIRST + '[[pairs]]\na = "cup"\n', "pairs[1]", ["'b' is missing"]),
    ],
)
def test_refused(load_text: LoadText, text: str, key: str, pieces: list[str]) -> None:
    # A key of the top stands before the first table.
    text = f"{text}{BODIES}" if text.startswith("pairs") else f"{BODIES}{text}"
    with pytest.raises(SceneError) as caught:
        load_text(text)
    assert caught.value.key == key
    for piece in pieces:
        assert piece in caught.value.problem


def test_an_unknown_pair_is_refused_with_the_nearest(load_text: LoadText) -> None:
    scene = load_text(BODIES + FIRST + SECOND)
    with pytest.raises(SceneError, match=r"unknown pair 'gras'; did you mean 'grasp'\?"):
        scene.select("gras")
