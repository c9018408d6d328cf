"""What a page does with what it is asked for, without a browser."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from browsing import until

import standoff as so
from standoff.errors import StandoffError
from standoff.motion import Pose, Twist
from standoff.scene import SceneError, load_scene
from standoff.scene.run import record
from standoff.view import laws
from standoff.view.gallery import scenes_in
from standoff.view.live_pair import LivePair
from standoff.view.player import Player
from standoff.view.pull import Pull
from standoff.view.shapes import shape_of

pytest.importorskip("viser", reason="viser is not installed (extra 'view')")

from standoff.view.export import chosen_frames, page_of, save_page
from standoff.view.page import Page

EXAMPLES = Path(__file__).parents[2] / "examples"
HALF = np.array([0.5, 0.4, 0.3])


def test_a_pair_that_is_moved_answers_as_a_cold_query_and_tells_its_switches(
    rng: np.random.Generator,
) -> None:
    ball, box = so.shapes.sphere(0.2), so.shapes.box(*(2.0 * HALF))
    home = Pose.identity()
    pair = LivePair(ball, box, (Pose(np.eye(3), [0.1, 0.1, 0.8]), home), so.PredictorCorrector())
    seen = set()
    for _ in range(20):
        towards = rng.normal(size=3)
        there = Pose.exp(rng.normal(size=3), 0.9 * towards / np.linalg.norm(towards))
        events = pair.move((there, home), 0.04)
        exact = np.linalg.norm(np.maximum(np.abs(there.translation) - HALF, 0.0)) - 0.2
        assert pair.answer.distance == pytest.approx(exact, abs=1e-9)
        seen |= {event.target.kind for event in events}
    assert {"face", "edge"} <= seen


def test_a_pair_that_cannot_go_on_is_left_as_it_was() -> None:
    scene = load_scene(EXAMPLES / "planar.toml")
    start = [Pose.of(motion.path.pose(0.0)) for motion in scene.pair_motions]
    pair = LivePair(*scene.pair_bodies, (start[0], start[1]), scene.settings.law)
    answer = pair.answer
    with pytest.raises(StandoffError):
        pair.move((start[0], Pose(np.eye(3), [3.0, 0.0, 1.0])), 0.04)
    assert pair.answer is answer
    assert pair.poses == (start[0], start[1])


def test_a_player_follows_its_recording() -> None:
    a, b = so.shapes.sphere(0.1), so.shapes.sphere(0.2)
    path = so.motion.ConstantTwist(Pose.identity(), Twist([1.0, 0.0, 0.0], [0.0, 0.0, 0.0]))
    run = so.track(so.Tracker(a, b, 0.01), path, Pose(np.eye(3), [3.0, 0.0, 0.0]), 1.0)
    player = Player(run)
    player.advance(0.5)
    assert player.time == 0.0
    player.playing, player.speed = True, 2.0
    player.advance(0.252)
    assert run.time[player.frame] == pytest.approx(0.5)
    assert run.time[player.behind(0.2, 10)][[0, -1]] == pytest.approx([0.32, 0.5])
    player.advance(0.3)
    assert player.time == 0.0
    player.seek(7.0)
    assert player.frame == len(run) - 1
    assert len(chosen_frames(run.time)) == 30


def test_laws_are_chosen_within_what_is_stable() -> None:
    settings = load_scene(EXAMPLES / "twist.toml").settings
    assert laws.chosen(settings, 1e-3) == ("paper", "heun", 0.5)
    changed = laws.with_law(settings, "paper", "rk4", 0.25, 1e-3)
    assert changed.law.gain == pytest.approx(0.25 * so.max_gain("rk4", 1e-3))
    assert laws.with_law(settings, "predictor-corrector", "heun", 0.5, 1e-3).law.name != "paper"
    for bad in (("none", "heun", 0.5), ("paper", "none", 0.5), ("paper", "heun", 1.5)):
        with pytest.raises(SceneError):
            laws.with_law(settings, *bad, 1e-3)


def test_a_gallery_has_the_scenes_of_pairs(tmp_path: Path) -> None:
    found = scenes_in(EXAMPLES)
    assert {"cam", "demo", "helix", "twist"} <= set(found)
    assert not any(name.startswith("simulation/") for name in found)
    (tmp_path / "broken.toml").write_text("[", "utf-8")
    assert scenes_in(tmp_path) == {}


def test_triangles_look_outward() -> None:
    for body in (so.shapes.box(1.0, 2.0, 3.0), so.shapes.capsule(0.2, 1.0), so.shapes.lens(1, 0.4)):
        shape = shape_of(body)
        assert shape.skin is not None
        corners = shape.skin.points[shape.skin.triangles]
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        outward = corners.mean(axis=1) - shape.middle
        assert (np.einsum("ij,ij->i", across, outward) > -1e-9).all()


def test_a_page_plays_changes_its_law_and_opens_another_scene() -> None:
    others = {"planar": EXAMPLES / "planar.toml", "gone": EXAMPLES / "gone.toml"}
    with Page(load_scene(EXAMPLES / "twist.toml"), others=others) as page:
        ask = page._asked.put
        ask(lambda: page.play(True))
        until(lambda: page.stage.player.time > 0.1)
        ask(lambda: page.law("paper", "euler", 0.2))
        until(lambda: page.stage._settings.law.integrator == "euler")
        assert page.stage.player.recording.info.options["integrator"] == "euler"
        before = page.stage
        ask(lambda: page.open("gone"))
        ask(lambda: page.law("paper", "nothing", 0.2))
        ask(lambda: page.open("planar"))
        until(lambda: page.stage is not before)
        assert page.stage.picture.planar
        wxyz, position = [0.9, 0.3, 0.0, 0.3], [0.0, 2.5, 0.4]
        ask(lambda: page.stage._drag(1, wxyz, position))
        until(lambda: page.stage.pair.poses[1].translation[1] == 2.5)
        assert page.stage.pair.poses[1].translation[2] == 0.0
        assert page._thread.is_alive()


def test_a_saved_run_names_no_other_host(tmp_path: Path) -> None:
    run = record(load_scene(EXAMPLES / "twist.toml").select("pair"))
    file = tmp_path / "run.html"
    save_page(run, file)
    html = file.read_text("utf-8")
    policy = re.search(r'http-equiv="Content-Security-Policy" content="([^"]*)"', html)
    assert policy is not None
    assert policy[1].startswith("default-src 'none'")
    assert "http" not in policy[1]
    with pytest.raises(StandoffError, match=r"name an \.html file"):
        save_page(run, tmp_path / "run.gif")
    run.save(tmp_path / "run.parquet")
    with pytest.raises(StandoffError, match="does not hold what moved"):
        page_of(so.open_recording(tmp_path / "run.parquet"))


SCENE = """
version = 1
bodies.ball = { shape = "sphere", radius = 0.02 }
bodies.box = { shape = "box", size = [0.1, 0.1, 0.1] }
placements.ball = { position = [0.0, 0.0, 0.08] }
pair = { a = "ball", b = "box" }
"""


def test_a_body_pulled_through_the_coupler_rests_on_the_other_and_the_page_lowers_the_force(
    tmp_path: Path,
) -> None:
    file = tmp_path / "scene.toml"
    file.write_text(SCENE, "utf-8")
    with Page(load_scene(file)) as page:
        ask, stage = page._asked.put, page.stage
        ask(lambda: page.pull(True))
        until(lambda: stage._pull is not None)
        # The handle goes 3 cm into the box; the spring of 200 N/m pulls with less than 10 N.
        ask(lambda: stage._drag(0, [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.04], held=True))
        until(lambda: stage._pull.force[2] < -5.0)

        def spring() -> float:
            return 200.0 * (0.04 - stage.pair.poses[0].translation[2])

        until(lambda: stage._pull.force[2] == pytest.approx(spring(), abs=0.2))
        assert 0.064 < stage.pair.poses[0].translation[2] < 0.0705
        for asked, kept in ((3.0, 3.0), (9.0, 3.0), (1e9, 3.0), (2.0, 2.0), (-5.0, 0.5)):
            ask(lambda asked=asked: page.limit(asked))
            until(lambda kept=kept: stage.max_force == kept)
        ask(lambda: page.limit(9.0))
        ask(lambda: page.open(""))
        until(lambda: page._asked.empty())
        assert stage.max_force == 0.5
        assert stage._pull.max_force == 0.5
        until(lambda: 0.3 < np.linalg.norm(stage._pull.force) <= 0.5)


@pytest.mark.parametrize("name", ["lenses", "tumbling", "twist"])
def test_bodies_of_the_examples_can_be_pulled(name: str) -> None:
    scene = load_scene(EXAMPLES / f"{name}.toml")
    start = scene.instant()
    poses = [Pose.of(motion.path.pose(start)) for motion in scene.pair_motions]
    pair = LivePair(*scene.pair_bodies, (poses[0], poses[1]), so.PredictorCorrector())
    for number in (0, 1):
        pull = Pull(pair, number, shape_of(pair.bodies[number]).size, 10.0)
        pull.step(poses[number], 0.04)
        assert pull.fault == ""


def test_a_page_goes_back_to_the_scene_s_poses(tmp_path: Path) -> None:
    file = tmp_path / "scene.toml"
    file.write_text(SCENE, "utf-8")
    others = {"twist": EXAMPLES / "twist.toml"}
    with Page(load_scene(file), others=others) as page:
        ask, panel = page._asked.put, page.panel
        home = page.stage.pair.poses
        assert tuple(panel._hand.options) == ("ball (A)", "box (B)", "nothing")
        for pulled in (False, True):
            ask(lambda pulled=pulled: page.pull(pulled))
            ask(lambda: page.stage._drag(0, [0.9, 0.3, 0.0, 0.3], [0.2, 0.0, 0.2], held=True))
            until(lambda: page.stage.pair.poses[0].translation[0] > 0.01)
            assert panel._back.visible
            ask(page.back)
            until(lambda: not panel._back.visible)
            assert page.stage.pair.poses == home
            assert page.stage.pair.answer.distance == pytest.approx(0.01, abs=1e-12)
            assert page.stage._pull is None
        ask(lambda: page.open("twist"))
        until(lambda: page.stage.player is not None)
        stage = page.stage
        ask(lambda: page.seek(0.2))
        ask(lambda: stage._drag(1, [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, -1.0]))
        until(lambda: stage.pair.poses[1].translation[2] == -1.0)
        ask(page.back)
        until(lambda: not panel._back.visible)
        until(lambda: panel._time.value == 0.2)
        assert not stage._by_hand
        assert stage.picture._bodies[1].frame.position[2] != -1.0


def test_bodies_are_of_glass_while_one_is_deep_in_the_other(tmp_path: Path) -> None:
    file = tmp_path / "scene.toml"
    file.write_text(SCENE, "utf-8")
    with Page(load_scene(file)) as page:
        stage = page.stage
        picture = stage.picture
        for height, deep in ((0.08, False), (0.0699, False), (0.05, True), (0.0, True), (1, False)):
            pose = [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, height]
            page._asked.put(lambda pose=pose: stage._drag(0, *pose))
            until(lambda height=height: stage.pair.poses[0].translation[2] == height)
            until(lambda deep=deep: picture._answer._depth.visible is deep)
            assert [body._glass for body in picture._bodies] == [deep, deep]
            assert [body._skin.visible for body in picture._bodies] == [not deep, not deep]
            assert picture._answer._normal.visible is not deep
            if deep:
                answer = picture._answer
                # it is seen before it has its length, and may have the last one still
                length = -stage.pair.answer.distance
                until(
                    lambda answer=answer, length=length: (
                        np.ndim(answer._depth.scale) == 1
                        and answer._depth.scale[2] == pytest.approx(length)
                    )
                )
                tip = answer._depth.position + length * stage.pair.answer.normal
                assert tip == pytest.approx(answer._points[0].position)


def test_the_page_opens_from_python(tmp_path: Path) -> None:
    a, b = so.shapes.sphere(0.1), so.shapes.sphere(0.2)
    away = Pose(np.eye(3), [1.0, 0.0, 0.0])
    with so.view(a, b, np.eye(4), away, open=False) as page:
        assert page.stage.pair.answer.distance == pytest.approx(0.7)
        assert page.stage.player is None
        assert page.address in page._repr_html_()
        assert page.address in repr(page)
    run = so.track(so.Tracker(a, b, 0.01), lambda t: Pose(np.eye(3), [t, 0, 0]), away, 0.5)
    with so.view(run, open=False) as page:
        assert page.stage.player.recording.distance[-1] == pytest.approx(0.2)
    with so.view(str(EXAMPLES / "cam.toml"), open=False) as page:
        assert page.stage.picture.planar
    for bad in ((), (3,), (a, b), (a, b, 3, 4)):
        with pytest.raises((TypeError, ValueError)):
            so.view(*bad, open=False)
