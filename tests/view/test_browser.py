"""The page in a real browser: what it loads, what it shows, and what a drag does."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browsing import opened, pull, until

from standoff.scene import load_scene

pytestmark = pytest.mark.usefixtures("slowly")

EXAMPLES = Path(__file__).parents[2] / "examples"
HALF = np.array([0.5, 0.4, 0.3])
RADIUS = 0.2
SCENE = """
version = 1
title = "A ball over a box"
[bodies.ball]
shape = "sphere"
radius = 0.2
[bodies.box]
shape = "box"
size = [1.0, 0.8, 0.6]
[placements.ball]
position = [0.1, 0.1, 0.8]
[pair]
a = "ball"
b = "box"
[track]
step = 0.001
"""


def colours(picture: Path) -> int:
    """How many the scene of a saved run has, above its buttons: an empty one has one."""
    import matplotlib.image

    pixels = matplotlib.image.imread(picture)
    pixels = pixels[: 8 * len(pixels) // 10]
    return len(np.unique(pixels.reshape(-1, pixels.shape[-1]), axis=0))


def from_box(centre: Any) -> float:
    """The ball's distance from the box, in closed form."""
    return float(np.linalg.norm(np.maximum(np.abs(centre) - HALF, 0.0))) - RADIUS


@pytest.fixture
def page(chromium: Any, tmp_path: Path) -> Iterator[Any]:
    from standoff.view.page import Page

    file = tmp_path / "ball.toml"
    file.write_text(SCENE, "utf-8")
    with Page(load_scene(file)) as page:
        yield page


def test_a_dragged_ball_s_distance_is_that_of_the_closed_form(
    page: Any, tab: Callable[..., Any]
) -> None:
    desk = opened(page, tab(980, 420))
    assert desk.number("distance") == pytest.approx(0.3, abs=1e-8)
    assert desk.shown("b") == "face 5 of box"
    pull(page, desk, 0, -0.8)
    centre = page.stage.pair.poses[0].translation
    assert centre[0] == pytest.approx(-0.7, abs=0.15)
    until(lambda: desk.number("distance") == pytest.approx(from_box(centre), rel=1e-8))
    assert desk.shown("b").startswith("edge")
    assert desk.number("bound") <= desk.number("distance")
    assert desk.foreign(page.address) == []
    assert desk.failed == []
    assert desk.errors == []


@pytest.mark.soak
def test_one_browser_goes_in_mid_drag_and_another_goes_on(
    page: Any, tab: Callable[..., Any]
) -> None:
    desk = opened(page, tab(980, 420))
    pull(page, desk, 0, -0.8, release=False)
    until(lambda: page.stage._held == 0)
    phone = tab(390, 844)
    phone.page.goto(page.address)
    until(lambda: len(page.server.get_clients()) == 2)
    distance = from_box(page.stage.pair.poses[0].translation)
    until(lambda: phone.number("distance") == pytest.approx(distance, rel=1e-8))
    assert desk.number("distance") == phone.number("distance")
    desk.page.close()
    until(lambda: page.stage._held is None)
    page._asked.put(lambda: page.hand("B"))
    until(lambda: page.stage._hand == 1)
    assert phone.number("distance") == pytest.approx(distance, rel=1e-8)
    phone.shot("phone")
    assert phone.foreign(page.address) == []
    assert (phone.failed, phone.errors) == ([], [])


def test_a_run_is_played_saved_and_opened_from_its_file(
    chromium: Any, tab: Callable[..., Any], tmp_path: Path
) -> None:
    from standoff.view.page import Page

    with Page(load_scene(EXAMPLES / "twist.toml")) as page:
        desk = opened(page, tab(760, 420))
        begin = desk.shown("distance")
        desk.page.get_by_role("button", name="Play").click()
        until(lambda: desk.shown("distance") != begin)
        player = page.stage.player
        until(lambda: player.time > 0.3)
        desk.page.get_by_role("button", name="Pause").click()
        until(lambda: not player.playing)
        shown = player.recording.distance[player.frame]
        until(lambda: desk.number("distance") == pytest.approx(shown, rel=1e-8))
        with desk.page.expect_download() as saved:
            desk.page.get_by_role("button", name="Save the run as a page").click()
        file = tmp_path / saved.value.suggested_filename
        saved.value.save_as(file)
        assert desk.foreign(page.address) == []
        assert (desk.failed, desk.errors) == ([], [])
    assert file.name == "twist.html"
    opened_file = tab(420, 300)
    opened_file.page.goto(file.as_uri())
    clock = opened_file.page.locator("input").first
    first = clock.input_value()
    until(lambda: clock.input_value() != first)
    opened_file.page.wait_for_timeout(300)
    until(lambda: colours(opened_file.shot("saved-run")) > 100)
    assert opened_file.page.title() == "Capsule tumbling past a rounded box"
    assert [url for url in opened_file.requests if not url.startswith(("file:", "blob:"))] == []
    assert (opened_file.failed, opened_file.errors) == ([], [])
