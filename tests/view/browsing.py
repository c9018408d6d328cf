"""A live page in a tab: opened, dragged on, and waited for."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

import waiting

# A page's thread holds it while it does one thing: `conftest` sees to it.
ONE_THING = threading.RLock()


def until(holds: Callable[[], object]) -> None:
    """Wait until something holds, and what the page's thread is amid when it does is done."""
    waiting.until(holds)
    with ONE_THING:
        pass


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
    before = page.stage.pair.poses[0].translation.copy()
    along = np.eye(3)[axis]

    def grip() -> Any:
        place = page.stage.pair.poses[0].translation
        return place + 0.8 * page.stage.picture.handles[0].scale * along

    def moved() -> bool:
        return bool((page.stage.pair.poses[0].translation != before).any())

    drag(page, tab, grip, length * along, moved, release)
    tab.page.wait_for_timeout(300)


def drag(
    page: Any,
    tab: Any,
    grip: Callable[[], Any],
    way: Any,
    moved: Callable[[], bool],
    release: bool = True,
) -> None:
    """Drag from a point of the world, `grip`, along a vector until something has moved. A browser
    that is short of time may not have drawn a handle yet when the button goes down: tried again."""
    mouse = tab.page.mouse
    for tries in range(10):
        start = grip()
        mouse.move(*on_screen(page, start))
        tab.page.wait_for_timeout(500 * (1 + tries))
        mouse.down()
        for part in np.linspace(0.0, 1.0, 8):
            mouse.move(*on_screen(page, start + part * way))
        held = waiting.happens(moved, 5.0 * (1 + tries))
        if held:
            tab.page.wait_for_timeout(500)
        if release or not held:
            mouse.up()
        if held:
            return
    raise AssertionError("nothing was dragged")
