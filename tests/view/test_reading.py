"""What a reader of the page sees, in a real browser: at a desk and on a phone."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browsing import on_screen, opened, pull, until

from standoff.scene import load_scene

pytestmark = pytest.mark.usefixtures("slowly")

EXAMPLES = Path(__file__).parents[2] / "examples"
INSIDE = """
version = 1
title = "A marble \\"</script>\\" in a box"
length_unit = "mm"
bodies.marble = { shape = "sphere", radius = 12 }
bodies.case = { shape = "box", size = [100, 80, 60] }
placements.marble = { position = [10, 5, 8] }
pair = { a = "case", b = "marble" }
"""
TITLE = 'A marble "</script>" in a box'
SLOW = """
version = 1
bodies.ball = { shape = "sphere", radius = 0.2 }
bodies.block = { shape = "box", size = [1.0, 0.8, 0.6] }
motions.ball = { kind = "helix", radius = 0.1, pitch = 1e-5, rate = 6.0, centre = [0, 0, 1.33] }
pair = { a = "ball", b = "block" }
track = { step = 0.01, duration = 60.0 }
"""
PLOT = """() => Object.values(window.__viserTestpoints.uplots).map(
    ({chart}) => [chart.axes[1]._values, chart.scales.x.min, chart.scales.x.max])[0]"""

LAST = "() => Object.values(window.__viserTestpoints.uplots)[0].chart.data[1].at(-1)"


@pytest.fixture
def page_of(chromium: Any, tmp_path: Path) -> Callable[..., Any]:
    from standoff.view.page import Page

    def make(text: str, **given: Any) -> Any:
        file = tmp_path / "scene.toml"
        file.write_text(text, "utf-8")
        return Page(load_scene(file), **given)

    return make


def colour(page: Any, picture: Path, point: Any) -> Any:
    """What a picture of half the page's size shows at a point of the world, red to blue."""
    import matplotlib.image

    pixels = matplotlib.image.imread(picture)[..., :3]
    x, y = (round(0.5 * part) for part in on_screen(page, point))
    return pixels[y - 1 : y + 2, x - 1 : x + 2].mean(axis=(0, 1))


@pytest.mark.soak
def test_a_body_inside_another_is_seen_with_the_depth(
    page_of: Callable[..., Any], tab: Callable[..., Any]
) -> None:
    others = {"cam": EXAMPLES / "cam.toml"}
    with page_of(INSIDE, others=others) as page:
        page._asked.put(lambda: page.hand("nothing"))
        desk = opened(page, tab(1280, 800, 0.5))
        assert desk.page.title() == TITLE
        assert desk.shown("verdict") == "overlap, depth 34 mm, proven least"
        assert (desk.shown("a"), desk.shown("b")) == ("face 5 of case", "vertex 0 of marble")

        def reddish(point: Any) -> float:
            found = colour(page, desk.shot("inside"), point)
            return float(found[0] - found[2])

        # To the marble's left as the camera sees it, and as far to the right of the marble.
        across = np.array([1.0, 0.6, 0.0]) / np.hypot(1.0, 0.6)
        marble = np.array([10.0, 5.0, 8.0])
        until(lambda: reddish(marble - 7.0 * across) > reddish(marble + 20.0 * across) + 0.1)
        picture = desk.shot("inside")
        shaft = colour(page, picture, marble - [0.0, 0.0, 2.0])
        assert shaft.mean() < colour(page, picture, marble - 7.0 * across).mean() - 0.1
        page._asked.put(lambda: page.open("cam"))
        until(lambda: desk.page.title() == "Cam and roller follower")
        until(lambda: desk.shown("verdict").startswith("apart, distance"))
        assert desk.errors == []


@pytest.mark.soak
def test_a_dragged_body_goes_back(page_of: Callable[..., Any], tab: Callable[..., Any]) -> None:
    ball = INSIDE.replace("[10, 5, 8]", "[10, 5, 60]").replace('a = "case"', 'a = "marble"')
    with page_of(ball.replace('b = "marble"', 'b = "case"')) as page:
        desk = opened(page, tab(980, 420))
        start = page.stage.pair.poses[0].translation.copy()
        back = desk.page.get_by_role("button", name="Back to the scene's poses")
        assert back.count() == 0
        pull(page, desk, 0, -80.0)
        until(lambda: page.stage.pair.poses[0].translation[0] < -10.0)
        # The plot ends at what the table says, however seldom it is drawn.
        until(lambda: desk.page.evaluate(LAST) == pytest.approx(page.stage.pair.answer.distance))
        back.click()
        until(lambda: bool((page.stage.pair.poses[0].translation == start).all()))
        until(lambda: back.count() == 0)
        until(lambda: desk.number("distance") == pytest.approx(18.0))
        assert desk.page.get_by_label("drag").input_value() == "marble (A)"
        assert desk.errors == []


def test_ticks_differ_where_the_distance_hardly_changes(
    page_of: Callable[..., Any], tab: Callable[..., Any]
) -> None:
    with page_of(SLOW) as page:
        desk = opened(page, tab(760, 420))
        desk.page.get_by_role("button", name="Play").click()
        until(lambda: page.stage.player.time > 1.0)

        def ticks() -> list[str]:
            found: list[str] = desk.page.evaluate(PLOT)[0]
            return found

        until(lambda: float(ticks()[-1]) - float(ticks()[0]) < 1e-4)
        assert len(set(ticks())) == len(ticks()) > 2
        desk.page.get_by_role("button", name="Pause").click()
        until(lambda: not page.stage.player.playing)
        until(
            lambda: desk.page.evaluate(LAST) == pytest.approx(desk.number("distance"), rel=1e-8),
        )
        labels, first, last = desk.page.evaluate(PLOT)
        assert first < last
        assert float(labels[0]) <= desk.number("distance") <= float(labels[-1])
        assert desk.errors == []


def test_the_phone_s_panel_is_as_wide_as_the_phone(
    page_of: Callable[..., Any], tab: Callable[..., Any]
) -> None:
    with page_of(INSIDE) as page:
        phone = opened(page, tab(390, 844))
        panel = phone.page.locator(".mantine-Paper-root:has([data-of=verdict])").first
        box = panel.bounding_box()
        assert (box["x"], box["width"]) == (0, 390)
        plot = phone.page.locator(".uplot-container").bounding_box()
        assert plot["width"] > 350
        # Its camera stands farther off than a desk's, and is put there again where it was not.
        (client,) = page.server.get_clients().values()
        usual = page.server.initial_camera
        client.camera.position, client.camera.look_at = usual.position, usual.look_at
        until(lambda: not np.allclose(client.camera.position, usual.position))
        assert phone.errors == []
