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

DRAWN = 1e-3
"""How far a handle may be drawn from its place, relative to its size: pages are sent floats."""


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

    def moved() -> bool:
        return bool((page.stage.pair.poses[0].translation != before).any())

    drag(page, tab, page.stage.picture.handles[0], (axis, length), moved, release)
    tab.page.wait_for_timeout(300)


PLACED = """([name, at]) => {
    const nodes = (window.__viserMutable ?? {}).nodeRefFromName ?? {};
    const handle = nodes[name], scene = nodes[''];
    if (!handle || !handle.visible || !scene) return null;
    const [x, y, z] = at, m = scene.matrixWorld.elements, is = handle.matrixWorld.elements;
    const off = [0, 1, 2].map(k => m[k] * x + m[4 + k] * y + m[8 + k] * z + m[12 + k] - is[12 + k]);
    return Math.hypot(...off);
}"""
"""How far from its place the browser has drawn a handle last; null if it has not yet."""


def drag(
    page: Any,
    tab: Any,
    handle: Any,
    way: tuple[int, float],
    moved: Callable[[], bool],
    release: bool = True,
) -> None:
    """Drag a handle by an arrow, (axis, length), until something has moved. What a browser that is
    short of time misses turns the scene instead: it is turned back, and tried again."""
    mouse, (axis, length) = tab.page.mouse, way
    along, (client,) = np.eye(3)[axis], page.server.get_clients().values()
    seen_from, seen_at = client.camera.position.copy(), client.camera.look_at.copy()

    def drawn() -> bool:
        off = tab.page.evaluate(PLACED, [handle.name, [float(x) for x in handle.position]])
        return off is not None and off <= DRAWN * handle.scale

    for tries in range(10):
        until(drawn)
        tab.page.wait_for_timeout(500 * tries)  # the scene is being turned back
        start = handle.position + 0.8 * handle.scale * along
        mouse.move(*on_screen(page, start))
        tab.page.wait_for_timeout(500)
        mouse.down()
        for part in np.linspace(0.0, length, 8):
            mouse.move(*on_screen(page, start + part * along))
        held = waiting.happens(moved, 5.0 * (1 + tries))
        if held:
            tab.page.wait_for_timeout(500)
        if release or not held:
            mouse.up()
        if held:
            return
        tab.page.wait_for_timeout(500)  # what the turn still sends
        client.camera.position, client.camera.look_at = seen_from, seen_at
    raise AssertionError("nothing was dragged")
