"""The page in a real browser: what it loads, what it shows, and what a drag does."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from standoff.scene import load_scene

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


def until(holds: Callable[[], bool], seconds: float = 15.0) -> None:
    end = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < end, "it did not come about"
        time.sleep(0.05)


def on_screen(page: Any, point: Any) -> tuple[float, float]:
    """Where the one open tab shows a point of the world, pixels."""
    (client,) = page.server.get_clients().values()
    camera = client.camera
    w, x, y, z = camera.wxyz
    axes = Rotation.from_quat([x, y, z, w]).as_matrix()
    right, down, ahead = axes.T @ (np.asarray(point) - camera.position)
    scale = 0.5 * camera.image_height / np.tan(0.5 * camera.fov)
    return (
        0.5 * camera.image_width + scale * right / ahead,
        0.5 * camera.image_height + scale * down / ahead,
    )


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


def opened(page: Any, tab: Any) -> Any:
    """The page's tab, shown."""
    tab.page.goto(page.address)
    tab.shown("distance")
    until(lambda: bool(page.server.get_clients()))
    tab.page.wait_for_timeout(500)
    return tab


def pull(page: Any, tab: Any, axis: int, length: float, release: bool = True) -> None:
    """Drag the ball by an arrow of its handle."""
    grip = page._grips[0]
    start = page.pair.poses[0].translation.copy()
    start[axis] += 0.8 * grip.scale
    along = np.eye(3)[axis]
    mouse = tab.page.mouse
    mouse.move(*on_screen(page, start))
    tab.page.wait_for_timeout(300)
    mouse.down()
    for part in np.linspace(0.0, length, 8):
        mouse.move(*on_screen(page, start + part * along))
    if release:
        mouse.up()
    tab.page.wait_for_timeout(300)


def test_a_dragged_ball_s_distance_is_that_of_the_closed_form(
    page: Any, tab: Callable[..., Any]
) -> None:
    desk = opened(page, tab(900, 560))
    assert desk.number("distance") == pytest.approx(0.3, abs=1e-8)
    assert desk.shown("b") == "face 5"
    pull(page, desk, 0, -0.8)
    centre = page.pair.poses[0].translation
    assert centre[0] == pytest.approx(-0.7, abs=0.15)
    until(lambda: desk.number("distance") == pytest.approx(from_box(centre), rel=1e-8))
    assert desk.shown("b").startswith("edge")
    assert desk.number("bound") <= desk.number("distance")
    assert desk.foreign(page.address) == []
    assert desk.failed == []
    assert desk.errors == []
