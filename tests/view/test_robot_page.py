"""The page of a robot: its world where the joints put it, a path that is played, and a proof."""

from __future__ import annotations

import re
from base64 import b64decode
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browsing import opened, until

import standoff as so
from standoff.robots import FunctionPath
from standoff.robots.shown_robot import shown_robot

pytest.importorskip("viser", reason="viser is not installed (extra 'view')")
mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed (extra 'mujoco')")

ARM = Path(__file__).parents[2] / "examples" / "robots" / "arm.xml"

# A ball on a bar of length 0.4 that turns about z, and slides along x after it; a fixed ball.
BAR = """<mujoco model="bar"><worldbody>
<geom name="post" type="sphere" size="0.1" pos="0 1 0"/>
<body name="turned"><joint name="turn" axis="0 0 1" range="-100 100"/>
<geom name="hub" type="sphere" size="0.05"/>
<body name="slid"><joint name="slide" type="slide" axis="1 0 0"/>
<geom name="ball" type="sphere" size="0.1" pos="0.4 0 0"/>
</body></body></worldbody></mujoco>"""
QUARTER = 0.5 * np.pi


@pytest.fixture(scope="module")
def bar() -> so.Robot:
    return so.Robot.from_mujoco(mujoco.MjModel.from_xml_string(BAR))


def gap(q: Any) -> float:
    """Of the ball and the post, by hand."""
    reach = 0.4 + q[1]
    return float(np.hypot(reach * np.cos(q[0]), reach * np.sin(q[0]) - 1.0)) - 0.2


def told(page: Any) -> float:
    pair = page.stage.live.answer["post", "ball"]
    return float(pair.distance)


def test_a_configuration_and_its_sliders(bar: so.Robot) -> None:
    first = [0.3, 0.1]
    with bar.view(first, open=False) as page:
        stage, ask = page.stage, page._asked.put
        assert told(page) == pytest.approx(gap(first), abs=1e-12)
        assert stage.player is None
        assert stage.picture.handle is None
        turn, slide = page.panel._sliders
        assert (turn.label, slide.label) == ("turn", "slide")
        assert (turn.min, turn.max) == pytest.approx(np.radians([-100, 100]))
        assert (turn.value, slide.value) == pytest.approx(first)
        assert slide.min < 0.1 < slide.max
        for number, value, q in ((0, 1.2, [1.2, 0.1]), (1, 0.3, [1.2, 0.3]), (0, 9.0, None)):
            ask(lambda number=number, value=value: page.turn(number, value))
            q = [np.radians(100), 0.3] if q is None else q
            until(lambda q=q: bool(np.isclose(told(page), gap(q), atol=1e-12, rtol=0.0)))
            until(lambda q=q: stage.q == pytest.approx(q))
            drawn = stage.picture._bodies[list(bar.world.bodies).index("ball")].frame.position
            assert drawn == pytest.approx(bar.poses(q)[bar.geoms.names.index("ball"), :3, 3])
        until(lambda: page.panel._back.visible)
        ask(page.back)
        until(lambda: bool(np.isclose(told(page), gap(first), atol=1e-12, rtol=0.0)))
        until(lambda: turn.value == pytest.approx(0.3))
        until(lambda: stage.q == pytest.approx(first))
        until(lambda: not page.panel._back.visible)


def test_a_path_is_played_with_its_clearance(bar: so.Robot) -> None:
    points, times = [[0.0, 0.0], [QUARTER, 0.0], [QUARTER, 0.25]], [1.0, 3.0, 8.0]
    with bar.view(points, times=times, open=False) as page:
        stage, ask = page.stage, page._asked.put
        course = stage.player.recording
        assert (course.time[0], course.time[-1]) == (1.0, 8.0)
        assert np.diff(course.time).max() <= 0.0401
        at = [np.interp(course.time, times, column) for column in np.transpose(points)]
        expected = [gap(q) for q in np.transpose(at)]
        post = [min(each, 1.0 - 0.15) for each in expected]
        assert course.distance == pytest.approx(post, abs=1e-9)
        assert (course.lower_bound <= course.distance).all()
        for t in (2.0, 8.0, 3.0):
            ask(lambda t=t: page.seek(t))
            until(lambda t=t: page.panel._time.value == t)
            shown = course.time[stage.player.frame]
            q = [np.interp(shown, times, column) for column in np.transpose(points)]
            assert told(page) == pytest.approx(gap(q), abs=1e-9)
            until(lambda q=q: page.panel._sliders[0].value == pytest.approx(q[0]))
        # A slider takes it off the path where it stands, and a way leads back.
        ask(lambda: page.turn(1, 0.1))
        until(lambda: stage._by_hand)
        until(lambda: told(page) == pytest.approx(gap([stage.q[0], 0.1]), abs=1e-9))
        assert stage.q[0] == pytest.approx(q[0])
        ask(page.back)
        until(lambda: not stage._by_hand)
        until(lambda: told(page) == pytest.approx(gap(q), abs=1e-9))
        ask(lambda: page.play(True))
        until(lambda: stage.player.time > 3.1)
        assert stage.player.playing
        assert page.panel._picture == ""


def test_joints_of_all_kinds_and_times_of_all_paths(bar: so.Robot) -> None:
    model = mujoco.MjModel.from_xml_string(
        """<mujoco><worldbody><geom name="floor" type="plane" size="1 1 1"/>
        <body name="base" pos="0 0 1"><freejoint name="free"/><geom name="a" size="0.1"/>
        <body name="arm"><joint name="hinge"/><geom name="b" size="0.1" pos="1 0 0"/></body>
        </body></worldbody></mujoco>"""
    )
    free = so.Robot.from_mujoco(model)
    q = np.array([0, 0, 1, 1, 0, 0, 0, 4.0])
    (slider,) = shown_robot(free, q, None, None).sliders
    # A free joint has none; without limits a hinge has a whole turn, and where it is.
    assert (slider.name, slider.q_at, slider.low, slider.high) == ("hinge", 7, -np.pi, 4.0)
    circle = slider._replace(q_at=3, circle=True)
    assert circle.read(circle.put(q, 0.7)) == pytest.approx(0.7)
    assert circle.put(q, 0.7)[3:5] == pytest.approx([np.cos(0.7), np.sin(0.7)])
    swing = FunctionPath(lambda t: [np.sin(t), 0.0], 0.5, [1.0, 0.0], start=2.0)
    shown = shown_robot(bar, swing, None, None)
    assert (shown.world.times[0], shown.world.times[-1], len(shown.world.times)) == (2.0, 2.5, 101)
    long = shown_robot(bar, [[0, 0], [1, 0]], [0.0, 1e6], None)
    assert len(long.world.times) == 2001


def test_bad_input(bar: so.Robot) -> None:
    path = [[0.0, 0.0], [1.0, 0.0]]
    proof = bar.certify(path)
    for what, options in (
        ([0.0], {}),
        ([0.0, np.nan], {}),
        ([[0.0, 0.0]], {}),
        ([0.0, 0.0], {"times": [0.0]}),
        ([0.0, 0.0], {"proof": proof}),
        (path, {"proof": proof, "times": [0.0, 2.0]}),
        (path, {"proof": True}),
        (path, {"times": [1.0, 0.0]}),
        ("arm.csv", {}),
    ):
        with pytest.raises((TypeError, ValueError)):
            bar.view(what, open=False, **options)


@pytest.mark.soak
@pytest.mark.usefixtures("slowly")
def test_a_proof_in_a_browser(chromium: Any, tab: Callable[..., Any]) -> None:
    pytest.importorskip("matplotlib", reason="matplotlib is not installed (extra 'plot')")
    robot = so.Robot.from_mujoco(str(ARM))
    left = [-0.9, 0.6, 0.0, 0.5, 0.0, 0.3, 0.0]
    right = [-2.0, 0.6, 0.0, 0.5, 0.0, 0.3, 0.0]
    over = [-1.45, -0.8, 0.0, -0.5, 0.0, 0.1, 0.0]
    path = [left, over, right]
    proof = robot.certify(path, 5e-3)
    with robot.view(path, proof=proof, open=False) as page:
        desk = opened(page, tab(1280, 1400))
        picture = desk.page.locator("[data-of=proof] img")
        assert picture.get_attribute("alt") == str(proof)
        assert picture.evaluate("e => e.naturalWidth") == 640
        (data,) = re.findall(r"base64,([^\"]+)", page.panel._picture)
        assert b64decode(data).startswith(b"\x89PNG")
        page._asked.put(lambda: page.seek(0.8))
        until(lambda: page.panel._time.value == 0.8)
        q = page.stage.q
        until(lambda: desk.number("distance") == pytest.approx(robot.clearance(q).distance))
        desk.page.wait_for_timeout(1500)
        desk.shot("robot")
        desk.page.get_by_text("joints", exact=True).click()
        desk.page.get_by_text("j7", exact=True).wait_for()
        assert desk.foreign(page.address) == []
        assert (desk.failed, desk.errors) == ([], [])
