"""The page of solids: it draws every minimum and place, and a drag changes them."""

from __future__ import annotations

import re
import threading
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browsing import drag, opened, until

import standoff as so
from families.solid_shapes import peg, prism, tube
from standoff.cli.entry import main
from standoff.geometry import ConicArc
from standoff.motion import Pose
from standoff.scene import SceneError, load_scene
from standoff.solids import Continuum, Overlap, PlanarSolid, save_boundary
from standoff.tracking import Status
from standoff.tracking.status import OF_SOLIDS

pytest.importorskip("viser", reason="viser is not installed (extra 'view')")

from standoff.view.nodes import WITNESS_COLOUR
from standoff.view.page import Page
from standoff.view.served import ServedPage
from standoff.view.solid_nodes import OVERLAP_COLOUR, PATCH_COLOUR, drawn_minima
from standoff.view.solid_page import SolidPage
from standoff.view.solid_readout import minima_list, solid_beside, solid_readout, solid_verdict

# A bridge upside down, its two feet at y = 1, and a lid over them, tilted about z.
OUTLINE = [(0, 0), (3, 0), (3, 1), (2, 1), (2, 0.5), (1, 0.5), (1, 1), (0, 1)]
TILT = 0.002
LID = so.shapes.box((6.0, 1.0, 4.0))
STILL = Pose.identity()
TURNED = [np.cos(0.5 * TILT), 0.0, 0.0, np.sin(0.5 * TILT)]


def over(height: float, tilt: float = TILT) -> Pose:
    """The lid with its centre so high over the feet's tops, beside the half of its thickness."""
    return Pose.exp((0, 0, tilt), (1.5, 1.5 + height, 0.5))


def heights(height: float) -> list[float]:
    """Of the lid's lower face, a plane, over the nearest corners of both feet, by hand."""
    lower = 0.5 * (np.cos(TILT) - 1.0) + np.cos(TILT) * height
    return [float(lower + np.sin(TILT) * (x - 1.5)) for x in (0.0, 2.0)]


def shown(panel: Any, name: str) -> str:
    """What the table says under a name; nothing where it has no such row."""
    found = re.search(f'data-of="{name}">([^<]*)<', panel._readout.content)
    return found[1] if found else ""


def listed(panel: Any) -> list[float]:
    """The distances of the list of minima."""
    rows = re.findall(r"<tr[^>]*>(.*?)</tr>", panel._minima.content)
    return [float(re.sub("<[^>]*>", " ", row).split()[1]) for row in rows]


@pytest.fixture
def page() -> Iterator[Any]:
    feet = prism(OUTLINE, 1.0)
    with so.view(feet, LID, STILL, over(0.1), open=False, minima=0.45, patch=0.05) as page:
        yield page


def put(page: Any, height: float) -> None:
    there = over(height)
    page._asked.put(lambda: page.stage._drag(1, TURNED, there.translation))
    until(lambda: page.stage.pair.poses[1].translation[1] == there.translation[1])


def lines(page: Any, *names: str) -> np.ndarray:
    nodes = page.stage.picture._minima._lines._nodes
    return np.concatenate([nodes[name].points for name in names if name in nodes])


def colours(page: Any, *names: str) -> set[tuple[int, ...]]:
    nodes = page.stage.picture._minima._lines._nodes
    return {tuple(c) for n in names if n in nodes for c in nodes[n].colors.reshape(-1, 3).tolist()}


def test_every_minimum_is_drawn_where_the_closed_form_has_it(page: Any) -> None:
    drawn = lines(page, "nearest", "others")
    assert len(drawn) == 2
    assert np.linalg.norm(drawn[:, 1] - drawn[:, 0], axis=1) == pytest.approx(heights(0.1))
    # On the feet's edges at x = 0 and x = 2; anywhere along z, where all points are as near.
    assert drawn[:, 0, :2] == pytest.approx(np.array([[0.0, 1.0], [2.0, 1.0]]), abs=1e-7)
    nodes = page.stage.picture._minima
    assert nodes._lines._nodes["nearest"].thickness > nodes._lines._nodes["others"].thickness
    assert nodes._clouds._nodes["nearest"].point_size > nodes._clouds._nodes["others"].point_size
    for name in ("nearest", "others"):
        assert nodes._clouds._nodes[name].points == pytest.approx(lines(page, name).reshape(-1, 3))
    # Each normal is a shaft from A's point on, and two pairs of barbs.
    shafts = lines(page, "normals").reshape(2, 5, 2, 3)[:, 0]
    assert shafts[:, 0] == pytest.approx(drawn[:, 0], abs=1e-6)
    along = shafts[:, 1] - shafts[:, 0]
    along /= np.linalg.norm(along, axis=1)[:, None]
    assert along == pytest.approx(np.tile([-np.sin(TILT), np.cos(TILT), 0.0], (2, 1)), abs=1e-6)
    keys = [m.key for m in page.stage.pair.answer.minima]
    assert nodes._label.text == f"#{keys[0]}: {heights(0.1)[0]:.4g}"
    assert [label.text for label in nodes._labels] == [f"#{keys[1]}"]


def test_another_way_out_is_listed_and_not_drawn() -> None:
    """A peg beside its hole, a hundredth in the face round the mouth, nearer to that than to the
    rim over which it could leave."""
    bush, pin = tube(1.001, 2.0, -2.0, 2.0), peg(1.0, 0.0, 6.0)
    pair = so.Tracker(bush, pin, minima=0.2)
    poses = [so.Pose(np.eye(3), [0.05, 0.05, 2.0 + h]) for h in (0.01, -0.01)]
    _, answer = pair.step(pair.start(so.Pose.identity(), poses[0]), np.eye(4), poses[1])
    assert [m.felt for m in answer.minima] == [True, False]
    assert drawn_minima(answer) == answer.minima[:1]
    assert minima_list(answer, "mm").count("another way out") == 1
    assert solid_verdict(answer, ("A", "B"), "mm", 1.0) == "overlap in one place, depth 0.01 mm"


def test_patches_span_what_is_nearly_as_near(page: Any) -> None:
    outline = lines(page, "patches")
    assert colours(page, "patches") == {PATCH_COLOUR}
    near = outline[np.abs(outline[:, :, 0] - 2.5).max(axis=1) < 0.6]
    # The top of the second foot, and as much of the lid, each closed.
    on_foot = near[np.abs(near[:, :, 1] - 1.0).max(axis=1) < 1e-6]
    corners = {tuple(np.round(p, 5).tolist()) for p in on_foot.reshape(-1, 3)}
    assert corners == {(2.0, 1.0, 0.0), (3.0, 1.0, 0.0), (2.0, 1.0, 1.0), (3.0, 1.0, 1.0)}
    assert len(on_foot) == 4
    assert len(near) == 8
    ends = sorted(tuple(np.round(p, 5).tolist()) for p in on_foot.reshape(-1, 3))
    assert ends[::2] == ends[1::2]


def test_a_drag_leads_through_contact_and_minima_keep_their_keys(page: Any) -> None:
    stage, panel = page.stage, page.panel
    keys = [m.key for m in stage.pair.answer.minima]
    assert len(set(keys)) == 2
    seen = []
    for height in (0.1, 0.02, 0.002, -0.01, -0.03, 0.01):
        put(page, height)
        truth = heights(height)
        answer = stage.pair.answer
        seen.append(answer.status)
        assert [m.distance for m in answer.minima] == pytest.approx(truth, abs=1e-8)
        assert [m.key for m in answer.minima] == keys
        until(lambda truth=truth: np.allclose(listed(panel), truth, rtol=0.0, atol=1e-6))
        assert float(shown(panel, "distance")) == pytest.approx(truth[0], abs=1e-8)
        assert shown(panel, "status") == answer.status.name
        assert f"#{keys[0]}, #{keys[1]}" in shown(panel, "minima")
        assert ("in overlap" in shown(panel, "minima")) is (truth[0] < 0.0)
        depth = shown(panel, "depth")
        assert float(depth or 0.0) == pytest.approx(max(0.0, -truth[0]), abs=1e-8)
        expected = WITNESS_COLOUR if truth[0] > 0.0 else OVERLAP_COLOUR
        assert colours(page, "nearest") == {expected}
        expected = WITNESS_COLOUR if truth[1] > 0.0 else OVERLAP_COLOUR
        assert colours(page, "others") == {expected}
    assert {Status.OVERLAPPING} < set(seen)
    assert panel._back.visible
    page._asked.put(page.back)
    until(lambda: not panel._back.visible)
    assert stage.pair.answer.minima[0].distance == pytest.approx(heights(0.1)[0], abs=1e-8)
    until(lambda: np.ptp(panel._plot._node.data[1]) == 0.0)


def test_a_start_in_overlap_tells_all_places(page: Any) -> None:
    with so.view(prism(OUTLINE, 1.0), LID, STILL, over(-0.01), open=False, minima=0.45) as other:
        told = [m.distance for m in other.stage.pair.answer.minima]
        assert told == pytest.approx(heights(-0.01), abs=1e-8)
        assert min(m.key for m in other.stage.pair.answer.minima) >= 0
        assert "overlap in 2 places" in other.panel._readout.content


def test_both_are_as_if_of_glass_or_not(page: Any) -> None:
    stage = page.stage
    assert [body._glass for body in stage.picture._bodies] == [True, True]
    page._asked.put(lambda: page.glass(False))
    until(lambda: not any(body._glass for body in stage.picture._bodies))
    # Where they overlap so deep that it is looked into, they are all the same.
    put(page, -0.3)
    until(lambda: all(body._glass for body in stage.picture._bodies))
    put(page, 0.1)
    until(lambda: not any(body._glass for body in stage.picture._bodies))


SCENE = """
version = 1
title = "A ball in a tube"
length_unit = "mm"
[bodies.tube]
body = "tube.json"
[bodies.ball]
shape = "sphere"
radius = 0.2
[motions.ball]
kind = "twist"
linear = [1.0, 0.0, 0.0]
[placements.ball]
position = [0.1, 0.0, 0.0]
[pair]
a = "tube"
b = "ball"
[track]
step = 0.01
duration = 0.9
"""


MOTION = SCENE[SCENE.index("[motions") : SCENE.index("[placements")]


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    save_boundary(tmp_path / "tube.json", tube(1.0, 1.5, -0.5, 0.5).boundary)
    (tmp_path / "scene.toml").write_text(SCENE, "utf-8")
    return tmp_path / "scene.toml"


def test_a_scene_is_played_and_its_numbers_are_those_of_the_closed_form(scene: Path) -> None:
    with so.view(scene, open=False, minima=0.5) as page:
        assert isinstance(page, SolidPage)
        stage, panel = page.stage, page.panel
        course = stage.player.recording
        # From the wall inside, into which the ball goes at the end: its deepest place then.
        assert course.distance == pytest.approx(0.7 - course.time, abs=1e-7)
        assert course.distance.min() < -0.1
        apart = course.distance > 1e-6
        assert (course.lower_bound <= course.distance)[apart].all()
        assert np.isfinite(course.lower_bound).all()
        page._asked.put(lambda: page.seek(0.3))
        until(lambda: panel._time.value == 0.3)
        assert lines(page, "nearest")[0, :, 0] == pytest.approx([1.0, 0.6], abs=1e-6)
        assert stage.picture._bodies[1].frame.position[0] == pytest.approx(0.4)
        assert "apart, distance 0.4 mm" in panel._readout.content
        page._asked.put(lambda: page.seek(0.9))
        until(lambda: "overlap in one place, depth 0.2 mm" in panel._readout.content)
        page._asked.put(lambda: page.seek(0.2))
        page._asked.put(lambda: page.play(True))
        until(lambda: stage.player.time > 0.3)
        # In a hand it goes on from where the motion stood.
        page._asked.put(lambda: stage._drag(1, [1.0, 0.0, 0.0, 0.0], [0.0, 0.5, 0.0]))
        until(lambda: stage.pair.poses[1].translation[1] == 0.5)
        assert not stage.player.playing
        assert stage.pair.answer.distance == pytest.approx(0.3, abs=1e-8)
        page._asked.put(page.back)
        until(lambda: not panel._back.visible)


def test_what_cannot_be_shown_is_refused(scene: Path, tmp_path: Path) -> None:
    ring, ball = load_scene(scene).pair_shapes
    away = Pose.exp((0, 0, 0), (3, 0, 0))
    disc = PlanarSolid.from_loops([ConicArc((0, 0), (1, 0), (0, 1))])
    beside = so.shapes.halfspace([0.0, 0.0, 1.0], -9.0)
    for bad, words in (
        (lambda: so.view(ball, ball, STILL, away, open=False, minima=1.0), "no pair with a solid"),
        (lambda: so.view(ring, ball, STILL, away, open=False, minima=-1.0), "positive"),
        (lambda: so.view(ring, ball, STILL, away, open=False, patch=0.0), "positive"),
        (lambda: so.view(ring, beside, STILL, away, open=False), "half-space"),
        (lambda: so.view(disc, disc, STILL, away, open=False), "planar"),
    ):
        with pytest.raises(ValueError, match=words):
            bad()
    # The page of convex bodies keeps its scene, and tells where a solid's page is.
    other = tmp_path / "convex.toml"
    other.write_text(SCENE.replace('body = "tube.json"', 'shape = "sphere"\nradius = 0.05'))
    with Page(load_scene(other), others={"ring": scene}) as page:
        stage, told = page.stage, list[str]()
        page._notify = told.append
        page._asked.put(lambda: page.open("ring"))
        until(lambda: bool(told))
        assert "a page of its own" in told[0]
        assert page.stage is stage
    scene.write_text(SCENE.replace('shape = "sphere"\nradius = 0.2', 'shape = "point"'))
    with pytest.raises(SceneError, match=r"scene\.toml.*is a point"):
        so.view(scene, open=False)


def test_the_command_shows_solids(
    scene: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    seen: list[Any] = []

    def wait(page: Any) -> None:
        tracker = page.stage.pair.tracker
        seen.append((type(page), tracker.minima, tracker.patch))
        raise KeyboardInterrupt

    monkeypatch.setattr(ServedPage, "wait", wait)
    scene.write_text(SCENE.replace(MOTION, ""))
    assert main(["view", str(scene), "--minima", "0.9", "--patch", "0.01"]) == 0
    assert main(["view", str(scene)]) == 0
    # 0.3 of the ball's size, which is the diagonal of its box.
    usual = pytest.approx(0.3 * 0.4 * np.sqrt(3.0))
    assert seen == [(SolidPage, 0.9, 0.01), (SolidPage, usual, None)]
    capsys.readouterr()
    assert main(["view", str(scene), "--gallery", str(scene.parent)]) == 2
    assert "opens no other scenes" in capsys.readouterr().err
    assert main(["view", str(scene), "--minima", "-1"]) == 2
    scene.write_text(SCENE.replace('body = "tube.json"', 'shape = "sphere"\nradius = 0.05'))
    assert main(["view", str(scene), "--patch", "0.01"]) == 2
    assert "--patch: it is for a pair with a solid" in capsys.readouterr().err
    assert len(seen) == 2


WORDS = [
    (Status.CONVERGED, 0.5, 0.5, {}, "apart, distance 0.5 mm, proven"),
    (
        Status.CONVERGED,
        0.5,
        0.5,
        {"cavity": "B"},
        "apart, distance 0.5 mm, proven, <b> in a cavity of lens",
    ),
    (Status.CONTAINED, 0.5, 0.5, {"inside": "B"}, "<b> inside lens, wall 0.5 mm, proven"),
    (Status.CONTAINED, 0.5, 0.5, {"inside": "A"}, "lens inside <b>, wall 0.5 mm, proven"),
    (
        Status.CONTINUUM,
        0.5,
        0.5,
        {"continuum": Continuum("arc", ())},
        "apart, distance 0.5 mm all along an arc, proven",
    ),
    (Status.WITHIN, 0.5, 0.25, {}, "distance between 0.25 and 0.5 mm: not proven closer"),
    (Status.WITHIN, 0.5, -np.inf, {}, "distance at most 0.5 mm: not proven closer"),
    (Status.DEADLINE, 0.5, 0.25, {}, "distance between 0.25 and 0.5 mm: stopped by the deadline"),
    (Status.TOUCHING, 1e-12, -1e-12, {}, "touching, to within 1e-12 mm"),
    (Status.TOUCHING, 0.0, 0.0, {}, "touching"),
    (
        Status.OVERLAPPING,
        -0.4,
        -np.inf,
        {"minima": (), "overlap": Overlap(np.zeros(3), 0.2, 0.4)},
        "overlap, no shift shorter than 0.4 mm parts them",
    ),
    (
        Status.OVERLAPPING,
        0.0,
        -np.inf,
        {"minima": (), "overlap": Overlap(np.zeros(3), 0.0, 0.0)},
        "overlap, depth not known",
    ),
]


@pytest.fixture(scope="module")
def told() -> Any:
    return so.distance(prism(OUTLINE, 1.0), LID, STILL, over(0.1))


@pytest.mark.parametrize(("status", "distance", "bound", "given", "said"), WORDS)
def test_answers_of_solids_are_said_in_words(
    told: Any, status: Status, distance: float, bound: float, given: dict[str, Any], said: str
) -> None:
    answer = replace(told, status=status, distance=distance, lower_bound=bound, **given)
    assert solid_verdict(answer, ("lens", "<b>"), "mm", 3.0) == said
    table = solid_readout(answer, ("lens", "<b>"), "mm", 3.0)
    assert said.replace("<", "&lt;").replace(">", "&gt;") in table
    assert "<b>" not in table
    assert f'data-of="status">{status.name}' in table
    assert "array" not in table + minima_list(answer, "mm")
    assert {*OF_SOLIDS, Status.OVERLAPPING} < {status for status, *_ in WORDS}


def test_what_stands_beside_the_nearest(told: Any) -> None:
    nearest = told.minima[0]
    for minimum, text in (
        (nearest._replace(distance=0.5, key=3), "#3: 0.5 mm"),
        (nearest._replace(distance=0.5), "0.5 mm"),
        (nearest._replace(distance=-0.5, key=0), "#0: depth 0.5 mm"),
        (nearest._replace(distance=1e-12, key=0), "#0: touching"),
    ):
        assert solid_beside(replace(told, minima=(minimum,)), "mm", 3.0) == text
    assert solid_beside(replace(told, minima=()), "mm", 3.0) == ""
    many = [nearest._replace(distance=0.01 * k - 0.02, key=k) for k in range(70)]
    text = minima_list(replace(told, minima=tuple(many)), "mm")
    assert text.count("<tr") == 60
    assert "and 10 more" in text
    assert text.count(str(OVERLAP_COLOUR)) == 2


def wait_until_drawn(page: ServedPage) -> None:
    """What the page does now, it has drawn when it comes to what is asked of it next."""
    drawn = threading.Event()
    page._asked.put(drawn.set)
    assert drawn.wait(15.0)


def test_a_world_draws_what_it_tells_of_all_its_pairs_of_solids() -> None:
    """Two feet under a lid, and a ball beside both: of the lid and the ball, which are convex, the
    line of their pair. A world tells the nearest minimum, at both ends of its edge, or the deepest
    place."""
    solids = {"feet": prism(OUTLINE, 1.0), "lid": LID, "ball": so.shapes.sphere(0.2)}
    world = so.World(solids, minima=0.45, within=3.0, fixed={"feet": np.eye(4)})
    away = Pose.exp((0, 0, 0), (5.0, 1.5, 0.5))

    with so.view(world, {"lid": over(0.1), "ball": away}, open=False) as page:
        stage, panel = page.stage, page.panel
        page._asked.put(lambda: page.hand(0))
        for height in (0.1, 0.002, -0.01, 0.05):
            there = over(height)
            page._asked.put(lambda there=there: stage._drag(0, TURNED, there.translation))
            until(lambda there=there: stage.live.poses[0, 1, 3] == there.translation[1])
            wait_until_drawn(page)
            truth = heights(height)
            drawn = lines(page, "nearest", "others")
            lengths = np.linalg.norm(drawn[:, 1] - drawn[:, 0], axis=1)
            assert lengths[:-1] == pytest.approx(np.full(len(drawn) - 1, abs(truth[0])), abs=1e-6)
            # The last one is that of the ball and a foot, from its corner at (3, 1).
            assert lengths[-1] == pytest.approx(np.hypot(2.0, 0.5) - 0.2, abs=1e-6)
            expected = WITNESS_COLOUR if truth[0] > 0.0 else OVERLAP_COLOUR
            assert colours(page, "nearest") == {expected}
            said = "overlap in one place, depth" if truth[0] < 0.0 else "apart, distance"
            until(lambda said=said: f"feet – lid: {said}" in panel._readout.content)
            until(lambda truth=truth: f"{abs(truth[0]):.4g}" in panel._readout.content)
        # The ball is nearest to the lid's edge: two convex bodies, and no minimum of theirs.
        page._asked.put(lambda: page.hand(1))
        page._asked.put(lambda: stage._drag(1, [1.0, 0.0, 0.0, 0.0], [4.72, 1.55, 0.5]))
        until(lambda: stage.live.poses[1, 0, 3] == 4.72)
        wait_until_drawn(page)
        assert stage.live.answer.closest.names == ("lid", "ball")
        until(lambda: stage.picture._closest._label.text.startswith("lid – ball: "))
        assert not stage.picture._minima._label.visible
        assert len(lines(page, "others")) > 1
        until(lambda: "feet - lid: apart" in panel._matrix.content)


def test_a_world_of_planar_solids_is_dragged_in_its_plane() -> None:
    ring = PlanarSolid.from_loops(
        [[ConicArc((0, 0), (2, 0), (0, 2))], [ConicArc((0, 0), (1, 0), (0, 1))]]
    )
    disc = PlanarSolid.from_loops([ConicArc((0, 0), (0.5, 0), (0, 0.5))])
    world = so.World({"ring": ring, "disc": disc})
    with so.view(world, [np.eye(4), Pose.exp((0, 0, 0), (3, 0, 0)).matrix], open=False) as page:
        stage = page.stage
        assert stage.picture.planar
        assert [body.size for body in stage.picture._bodies] == pytest.approx([32**0.5, 2**0.5])
        assert stage.live.answer.closest.distance == pytest.approx(0.5)
        page._asked.put(lambda: stage._drag(1, [1.0, 0.0, 0.0, 0.0], [0.0, 0.2, 0.0]))
        until(lambda: abs(stage.live.answer.closest.distance - 0.3) < 1e-9)
        wait_until_drawn(page)


@pytest.mark.usefixtures("slowly")
def test_a_solid_dragged_in_a_browser(scene: Path, chromium: Any, tab: Callable[..., Any]) -> None:
    scene.write_text(
        SCENE.replace('[motions.ball]\nkind = "twist"\nlinear = [1.0, 0.0, 0.0]\n', "")
    )
    with so.view(scene, open=False) as page:
        stage = page.stage
        page._asked.put(lambda: page.hand("B"))
        desk = opened(page, tab(980, 420))
        assert desk.number("distance") == pytest.approx(0.7, abs=1e-8)
        assert desk.shown("status") == "CONVERGED"
        handle = stage.picture.handles[1]
        drag(page, desk, handle, (2, 0.3), lambda: stage.pair.poses[1].translation[2] > 0.1)
        desk.page.wait_for_timeout(500)
        distance = stage.pair.answer.distance
        assert stage.pair.poses[1].translation[0] == pytest.approx(0.1)
        until(lambda: desk.number("distance") == pytest.approx(distance, rel=1e-8))
        desk.page.get_by_role("tab", name="Minima").click()
        key = stage.pair.answer.minima[0].key
        listed = desk.page.locator(f"[data-of=minima-list] tr[data-key='{key}']")
        assert f"{distance:.6g}" in listed.text_content()
        desk.shot("solids")
        assert desk.foreign(page.address) == []
        assert (desk.failed, desk.errors) == ([], [])
