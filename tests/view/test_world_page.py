"""The page of a world: what it draws is the answer, and a drag changes it."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browsing import drag, opened, until

import standoff as so
from standoff.motion import ConstantTwist, Pose, Twist
from standoff.scene import load_scene
from standoff.wording import at_least

pytest.importorskip("viser", reason="viser is not installed (extra 'view')")

from standoff.clearance.verdicts import Verdict
from standoff.view.clearance_matrix import MOST_BODIES, cells_of, drawn_bodies, matrix_picture
from standoff.view.gallery import scenes_in
from standoff.view.gap_colours import gap_colours
from standoff.view.moving_world import world_of_scene
from standoff.view.page import Page

SHELVES = Path(__file__).parents[2] / "examples" / "shelves.toml"
BALL = so.shapes.sphere(0.1)
UPRIGHT = [1.0, 0.0, 0.0, 0.0]


def balls(*places: float, within: float = 1.0, **given: Any) -> tuple[so.World, dict[str, Pose]]:
    """Balls of radius 0.1 along x, and where they are: gaps are known by subtraction."""
    names = [f"ball {k}" for k in range(len(places))]
    world = so.World(dict.fromkeys(names, BALL), within=within, **given)
    return world, {
        name: Pose(np.eye(3), [x, 0.0, 0.0]) for name, x in zip(names, places, strict=True)
    }


@pytest.fixture
def row() -> Iterator[Any]:
    """The page of three balls, gaps 0.3 and 0.5 and, of the outer two, 1: at the horizon."""
    world, poses = balls(0.0, 0.5, 1.2, 3.0)
    with so.view(world, poses, open=False) as page:
        yield page


def ends(page: Any) -> np.ndarray:
    nodes = page.stage.picture._pairs._nodes
    return np.concatenate([nodes[name].points for name in ("closest", "near") if name in nodes])


def test_lines_end_at_the_answer_s_points(row: Any) -> None:
    pairs = row.stage.live.answer.pairs
    order = np.argsort(pairs.distance)
    expected = np.stack([pairs.point_a, pairs.point_b], axis=1)[order]
    assert ends(row) == pytest.approx(expected.astype(np.float32))
    # By hand: along x from surface to surface; the outer pair, 1.0 apart, is not beyond 1.0.
    exact = [[0.1, 0.4], [0.6, 1.1], [0.1, 1.1]]
    assert ends(row)[: len(exact), :, 0] == pytest.approx(np.array(exact)[: len(ends(row))])
    nodes = row.stage.picture._pairs._nodes
    assert len(nodes["closest"].points) == 1
    assert nodes["closest"].thickness > nodes["near"].thickness
    gaps = np.sort(pairs.distance)
    assert (nodes["near"].colors[:, 0] == gap_colours(gaps[1:], row.stage.end)).all()


def test_a_drag_changes_the_answer_and_back_undoes_it(row: Any) -> None:
    stage, panel = row.stage, row.panel
    assert tuple(panel._hand.options) == ("ball 0", "ball 1", "ball 2", "ball 3", "nothing")
    row._asked.put(lambda: row.hand(1))
    for x, distance in ((0.4, 0.2), (0.7, 0.3), (0.05, -0.15)):
        row._asked.put(lambda x=x: stage._drag(1, UPRIGHT, [x, 0.0, 0.0], held=True))
        until(lambda x=x: stage.live.poses[1, 0, 3] == x)
        closest = stage.live.answer.closest
        assert closest.distance == pytest.approx(distance, abs=1e-12)
        until(lambda closest=closest: f"{abs(closest.distance):.4g}" in panel._readout.content)
        expected = np.array([closest.point_a, closest.point_b])
        until(lambda expected=expected: np.allclose(ends(row)[0], expected))
    assert "overlap" in panel._readout.content
    assert [each._pieces[0]._glass for each in stage.picture._bodies] == [True, True, False, False]
    # What an earlier handle still sends moves nothing.
    row._asked.put(lambda: stage._drag(0, UPRIGHT, [9.0, 0.0, 0.0]))
    row._asked.put(row.back)
    until(lambda: stage.live.poses[1, 0, 3] == 0.5)
    assert stage.live.poses[0, 0, 3] == 0.0
    assert stage.live.answer.closest.distance == pytest.approx(0.3, abs=1e-12)
    assert not panel._back.visible
    row._asked.put(lambda: row.hand(None))
    until(lambda: stage.picture.handle is None)
    assert panel._hand.value == "nothing"


def test_the_matrix_is_that_of_the_gaps(row: Any) -> None:
    world, poses = balls(0.0, 0.15, 0.35, 0.85, 5.0, ignore=[("ball 0", "ball 3")])
    answer = world.distances(poses)
    cells = cells_of(answer, list(world.bodies))
    verdicts = {(int(a[-1]), int(b[-1])): cell for (a, b), cell in cells.items()}
    assert len(cells) == 9
    assert (0, 3) not in verdicts
    assert verdicts[0, 1].verdict is Verdict.OVERLAPPING
    assert verdicts[0, 1].gap == pytest.approx(-0.05)
    assert verdicts[1, 2].verdict is Verdict.TOUCHING
    assert verdicts[2, 3].gap == pytest.approx(0.3)
    assert {key for key, cell in verdicts.items() if cell.far} == {(k, 4) for k in range(4)}
    # Of a pair beyond the horizon the proven bound stands there, and none above the truth.
    assert all(1.0 <= verdicts[k, 4].gap <= 4.8 for k in range(4))
    picture = matrix_picture(answer, "m", 1.0)
    kinds = re.findall(r'<g class="(\w+)"', picture)
    assert {kind: kinds.count(kind) for kind in kinds} == {
        "overlapping": 1,
        "touching": 1,
        "apart": 3,
        "far": 4,
    }
    red, grey = 'fill="rgb(213,94,0)"', 'fill="rgb(229,229,229)"'
    assert re.search(rf'class="overlapping"><rect [^>]*{re.escape(red)}', picture)
    assert re.search(rf'class="far"><rect [^>]*{re.escape(grey)}', picture)
    assert "<title>ball 0 - ball 1: overlapping, depth 0.05 m</title>" in picture
    assert picture.count("does not count") == 1
    # The page's own follows a drag.
    before = row.panel._matrix.content
    assert "ball 0 - ball 1: apart, gap 0.3</title>" in before
    row._asked.put(lambda: row.hand(1))
    row._asked.put(lambda: row.stage._drag(1, UPRIGHT, [0.6, 0.0, 0.0]))
    until(lambda: "ball 0 - ball 1: apart, gap 0.4</title>" in row.panel._matrix.content)


def test_a_large_matrix_is_that_of_the_nearest_and_names_are_texts() -> None:
    places = np.cumsum(np.linspace(1.0, 0.25, 40))
    world, poses = balls(*places)
    answer = world.distances(poses)
    names = drawn_bodies(answer)
    assert len(names) == MOST_BODIES
    assert set(answer.closest.names) <= set(names)
    assert "16 more are left out" in matrix_picture(answer, "", 1.0)
    odd = so.World({"<b>": BALL, "a & b": BALL})
    picture = matrix_picture(odd.distances(np.stack([np.eye(4)] * 2)), "", 1.0)
    assert "<b>" not in picture
    assert "&lt;b&gt;" in picture
    with so.view(odd, np.stack([np.eye(4)] * 2), open=False) as page:
        assert "<b>" not in page.panel._readout.content


def test_a_world_without_near_pairs_says_so_and_draws_no_line() -> None:
    world, poses = balls(0.0, 5.0, within=0.4)
    with so.view(world, poses, open=False) as page:
        stage = page.stage
        assert stage.live.answer.closest is None
        assert "all pairs are at least 0.4" in page.panel._readout.content
        assert stage.picture._pairs._nodes == {}
        assert not stage.picture._closest._points[0].visible
        page._asked.put(lambda: stage._drag(1, UPRIGHT, [0.3, 0.0, 0.0]))
        until(lambda: stage.live.answer.closest is not None)
        until(lambda: "closest" in stage.picture._pairs._nodes)
        assert ends(page)[0, :, 0] == pytest.approx([0.1, 0.2])
        page._asked.put(page.back)
        until(lambda: stage.picture._pairs._nodes == {})
    alone = so.World({"one": BALL})
    with so.view(alone, [np.eye(4)], open=False) as page:
        assert "no pair of bodies counts" in page.panel._readout.content


def test_a_scene_of_a_world_is_played_dragged_and_played_on() -> None:
    with so.view(SHELVES, open=False) as page:
        stage, ask = page.stage, page._asked.put
        world = stage.given.world
        course = stage.player.recording
        scene = load_scene(SHELVES)
        for t in (-1.0, 0.3, 1.0):
            ask(lambda t=t: page.seek(t))
            until(lambda t=t: page.panel._time.value == t)
            cold = world.distances(scene.poses(world, float(course.time[stage.player.frame])))
            assert stage.live.answer.closest.distance == pytest.approx(cold.closest.distance)
            assert course.distance[stage.player.frame] == pytest.approx(cold.closest.distance)
        fingers = stage.picture._bodies[list(world.bodies).index("gripper")]
        assert len(fingers._pieces) == 3
        ask(lambda: page.play(True))
        until(lambda: stage.player.time not in (stage.player.first, stage.player.last))
        ask(lambda: stage._drag(stage._hand, UPRIGHT, [1.0, 0.0, 0.9]))
        until(lambda: stage._by_hand and stage.live.poses[-1, 2, 3] == 0.9)
        assert not stage.player.playing
        ask(page.back)
        until(lambda: not stage._by_hand)
        until(lambda: stage.live.poses[-1, 2, 3] == pytest.approx(0.62))
    # A pair of such a scene has the page of a pair, and worlds are in no gallery of pairs.
    assert "shelves" not in scenes_in(SHELVES.parent)


def test_paths_and_bad_input(tmp_path: Path) -> None:
    world, poses = balls(0.0, 1.0, dt=0.01)
    path = ConstantTwist(poses["ball 1"], Twist([-0.5, 0.0, 0.0], [0.0, 0.0, 0.0]))
    with so.view(world, {"ball 0": np.eye(4), "ball 1": path}, 1.0, open=False) as page:
        course = page.stage.player.recording
        assert course.distance == pytest.approx(0.8 - 0.5 * course.time, abs=1e-9)
        assert (course.lower_bound <= course.distance).all()
    for bad in (({"ball 0": np.eye(4)},), (3,), (poses, 0.0), (poses, 1e9), ([np.eye(4)], 1.0)):
        with pytest.raises((TypeError, ValueError)):
            so.view(world, *bad, open=False)
    file = tmp_path / "both.toml"
    file.write_text(
        """
version = 1
bodies.a = { shape = "sphere", radius = 0.1 }
bodies.b = { shape = "sphere", radius = 0.1 }
placements.b = { position = [1.0, 0.0, 0.0] }
pair = { a = "a", b = "b" }
world = { within = 0.5 }
""",
        "utf-8",
    )
    assert world_of_scene(load_scene(file)).world.within == 0.5
    with Page(load_scene(file)) as page:
        assert page.stage.pair.answer.distance == pytest.approx(0.8)


def test_looks_without_a_change_send_no_matrix(row: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    sent = []
    monkeypatch.setattr(row.panel, "matrix", lambda picture: sent.append(time.monotonic()))
    row._asked.put(lambda: row.hand(1))
    for k in range(60):
        row._asked.put(lambda k=k: row.stage._drag(1, UPRIGHT, [0.4 + 1e-3 * k, 0.0, 0.0]))
        time.sleep(0.02)
    until(lambda: sent and time.monotonic() - sent[-1] > 1.0)
    # Drags for 1.2 s or longer: one each 0.4 s at most, and one after the last.
    assert len(sent) <= 3 + (sent[-1] - sent[0]) / 0.4
    count = len(sent)
    time.sleep(0.6)
    assert len(sent) == count


@pytest.mark.usefixtures("slowly")
def test_a_body_dragged_in_a_browser(chromium: Any, tab: Callable[..., Any]) -> None:
    world, poses = balls(0.0, 0.5, 1.2)
    with so.view(world, poses, open=False) as page:
        desk = opened(page, tab(980, 600))
        assert desk.number("distance") == pytest.approx(0.3)
        assert desk.shown("near").startswith("3 of 3 pairs")
        stage = page.stage
        page._asked.put(lambda: page.hand(1))
        until(lambda: stage._hand == 1)
        drag(page, desk, stage.picture.handle, (2, 0.4), lambda: stage.live.poses[1, 2, 3] > 0.2)
        desk.page.wait_for_timeout(500)
        centre = stage.live.poses[1, :3, 3]
        assert stage.live.answer["ball 1", "ball 2"].distance == pytest.approx(
            np.hypot(centre[0] - 1.2, centre[2]) - 0.2
        )
        desk.page.get_by_role("tab", name="Matrix").click()
        desk.page.locator("svg[data-of=matrix]").wait_for()
        gap = at_least(stage.live.answer["ball 1", "ball 2"].distance, 2)
        until(lambda: gap in desk.page.locator("svg[data-of=matrix]").text_content())
        assert desk.foreign(page.address) == []
        assert (desk.failed, desk.errors) == ([], [])
