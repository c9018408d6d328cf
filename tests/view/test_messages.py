"""Messages with the token: what they hold is checked, and no fault ends the page's thread."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from browsing import until

from standoff.scene import load_scene
from waiting import LONG

pytest.importorskip("viser", reason="viser is not installed (extra 'view')")

from standoff.view.access import value_fault
from standoff.view.page import Page
from view.test_guard import EXAMPLES, closing_code, open_socket, send

POSE = {"wxyz": [1.0, 0.0, 0.0, 0.0], "position": [0.0, 0.0, 2.0]}


CAMERA = {
    "type": "ViewerCameraMessage",
    "wxyz": [1.0, 0.0, 0.0, 0.0],
    "position": [0.0, 0.0, -5.0],
    "look_at": [0.0, 0.0, 0.0],
    "up_direction": [0.0, 1.0, 0.0],
    "fov": 0.8,
    "near": 0.01,
    "far": 100.0,
    "image_height": 400,
    "image_width": 400,
}


@pytest.fixture(scope="module")
def page() -> Iterator[Page]:
    with Page(load_scene(EXAMPLES / "lenses.toml")) as page:
        yield page


def drag(page: Page, **given: Any) -> dict[str, Any]:
    handle = page.stage.picture.handles[0]
    return {"type": "TransformControlsUpdateMessage", "name": handle._impl.name, **POSE, **given}


def value(element: Any, given: Any) -> dict[str, Any]:
    return {"type": "GuiUpdateMessage", "uuid": element._impl.uuid, "updates": {"value": given}}


def state(page: Page) -> tuple[Any, ...]:
    """All that a message could change."""
    panel, handles = page.panel, page.stage.picture.handles
    elements = (panel._hand, panel._pull, panel._limit, panel._law, panel._share, panel._scenes)
    return (
        *(np.concatenate([handle.wxyz, handle.position]).tolist() for handle in handles),
        *(element.value for element in elements),
        panel._speed.value,
        page.stage.pair.poses[0].matrix.tolist(),
        page.stage.max_force,
    )


HUGE = 1e200
BAD: dict[str, Callable[[Page], dict[str, Any]]] = {
    "dictionaries": lambda page: drag(page, wxyz={}, position={}),
    "a name of no text": lambda page: drag(page, name={"a": 1}),
    "no quaternion": lambda page: drag(page, wxyz=None),
    "three of a quaternion": lambda page: drag(page, wxyz=[1.0, 0.0, 0.0]),
    "quaternion of zeros": lambda page: drag(page, wxyz=[0.0, 0.0, 0.0, 0.0]),
    "long quaternion": lambda page: drag(page, wxyz=[HUGE, 0.0, 0.0, 0.0]),
    "NaN in it": lambda page: drag(page, wxyz=[math.nan, 0.0, 0.0, 0.0]),
    "text in it": lambda page: drag(page, wxyz=["1", 0.0, 0.0, 0.0]),
    "truth in it": lambda page: drag(page, wxyz=[True, 0.0, 0.0, 0.0]),
    "position as text": lambda page: drag(page, position="000"),
    "NaN in the position": lambda page: drag(page, position=[0.0, math.nan, 0.0]),
    "infinite": lambda page: drag(page, position=[0.0, math.inf, 0.0]),
    "huge": lambda page: drag(page, position=[HUGE, 0.0, 0.0]),
    "two huge ones": lambda page: drag(page, position=[HUGE, -HUGE, 0.0]),
    "nested": lambda page: drag(page, position=[[0.0], 0.0, 0.0]),
    "a slider's NaN as text": lambda page: value(page.panel._limit, "nan"),
    "a slider's table": lambda page: value(page.panel._share, {"a": 1}),
    "a slider's truth": lambda page: value(page.panel._share, True),
    "a slider's nothing": lambda page: value(page.panel._limit, None),
    "a checkbox's text": lambda page: value(page.panel._pull, "yes"),
    "a checkbox's list": lambda page: value(page.panel._pull, [1]),
    "another choice": lambda page: value(page.panel._hand, "C"),
    "a choice's table": lambda page: value(page.panel._speed, {}),
    "a law of another name": lambda page: value(page.panel._law, "law"),
    "a scene that is not offered": lambda page: value(page.panel._scenes, "/etc/passwd"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_value_of_another_kind_is_refused_and_changes_nothing(page: Page, name: str) -> None:
    guard: Any = page.server._websock_server
    before, noted = state(page), len(guard.refused)
    with open_socket(page) as connection:
        send(connection, BAD[name](page))
        assert closing_code(connection) == 1008
        assert "the message" in str(connection.close_reason)
    until(lambda: len(guard.refused) == min(noted + 1, 100))
    time.sleep(0.1)  # two looks of the page's thread
    assert state(page) == before
    assert page._thread.is_alive()


def test_the_page_s_own_messages_pass_still(page: Page) -> None:
    with open_socket(page) as connection:
        turned = [math.cos(0.1), 0.0, 0.0, math.sin(0.1)]
        send(connection, drag(page, wxyz=turned, position=[0.0, 0, 3]))
        until(lambda: bool(page.stage.pair.poses[0].translation[2] == 3.0))
        send(connection, CAMERA)  # by which viser knows that a page is there
        until(lambda: len(page.server.get_clients()) == 1)
        send(connection, value(page.panel._hand, page.panel._hand.options[1]))
        until(lambda: page.stage._hand == 1)
        send(connection, value(page.panel._limit, 1))
        until(lambda: page.stage.max_force == 1.0)


def test_a_far_place_is_told_or_followed(page: Page) -> None:
    with open_socket(page) as connection:
        send(connection, drag(page, position=[1e90, 0.0, 0.0]))
        time.sleep(0.2)
        assert page._thread.is_alive()
        send(connection, drag(page, position=[0.0, 0.0, 2.5]))
        until(lambda: bool(page.stage.pair.poses[0].translation[2] == 2.5))


@pytest.mark.parametrize(
    "kind", [TypeError, KeyError, ZeroDivisionError, RecursionError, MemoryError]
)
def test_any_fault_of_a_task_is_told_once_and_survived(
    page: Page,
    kind: type[Exception],
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("STANDOFF_QUIET", "0")
    shown: list[str] = []
    monkeypatch.setattr(page, "_notify", shown.append)
    done: list[int] = []

    def fails() -> None:
        raise kind("of nobody's \x1b[2J")

    for task in (fails, fails, lambda: done.append(1)):
        page._asked.put(task)
    until(lambda: bool(done))
    told = capsys.readouterr().err
    assert told.count("the page goes on after a fault") == 1
    assert "in fails" in told
    assert kind.__name__ in told
    assert "\x1b" not in told
    assert len(shown) == 2
    assert kind.__name__ in shown[0]
    assert page._thread.is_alive()


def test_a_fault_at_every_look_stops_the_hand(page: Page, monkeypatch: pytest.MonkeyPatch) -> None:
    failed = []

    def fails(*given: Any) -> None:
        failed.append(given)
        raise TypeError("of nobody's")

    poses = page.stage.pair.poses
    with monkeypatch.context() as broken:
        broken.setattr(page.stage.pair, "move", fails)
        page._asked.put(lambda: page.stage._drag(0, [1.0, 0, 0, 0], [0.0, 0.0, 9.0]))
        until(lambda: bool(failed))
    until(lambda: page.stage._wanted is page.stage.pair.poses)
    assert page.stage.pair.poses is poses


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
@pytest.mark.parametrize("kind", [SystemExit, KeyboardInterrupt])
def test_an_end_that_is_asked_for_ends_it(kind: type[BaseException]) -> None:
    def ends() -> None:
        raise kind

    with Page(load_scene(EXAMPLES / "lenses.toml")) as page:
        page._asked.put(ends)
        page.wait()
        page._thread.join(LONG)
        assert not page._thread.is_alive()


@pytest.mark.parametrize(
    ("given", "current", "options"),
    [("1", 1.0, None), (True, 1.0, None), (1, True, None), (1, "1", None), ("c", "a", ("a", "b"))],
)
def test_values_of_another_kind(given: Any, current: Any, options: Any) -> None:
    assert value_fault(given, current, options) is not None
    assert value_fault(current, current, options) is None
