"""A live page in a tab: opened, dragged on, and waited for."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation


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


def opened(page: Any, tab: Any) -> Any:
    """The page's tab, shown."""
    tab.page.goto(page.address)
    tab.shown("distance")
    until(lambda: bool(page.server.get_clients()))
    tab.page.wait_for_timeout(500)
    return tab


def pull(page: Any, tab: Any, axis: int, length: float, release: bool = True) -> None:
    """Drag the ball by an arrow of its handle."""
    grip = page.stage.picture.handles[0]
    start = page.stage.pair.poses[0].translation.copy()
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
