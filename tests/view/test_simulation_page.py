"""The page of a simulation: it draws every place, spot and force, plays a run, steps a system."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browsing import opened, until

import standoff as so
from standoff.cli.entry import main
from standoff.errors import StandoffError
from standoff.simulation import (
    Energy,
    HuntCrossley,
    Operator,
    PairContact,
    RigidBody,
    SpotForce,
    System,
    SystemRun,
)
from standoff.simulation.solid_places import ContactPlace
from standoff.simulation.units import Units
from standoff.solids import Solid
from standoff.tracking import Status

pytest.importorskip("viser", reason="viser is not installed (extra 'view')")

from standoff.view.contact_nodes import FORCE_COLOUR, LONGEST, drawn_places
from standoff.view.contact_readout import certified_text, contacts_list, contacts_verdict
from standoff.view.served import ServedPage
from standoff.view.shown_simulation import Instant, Simulated, usual_force
from standoff.view.simulation_page import SimulationPage
from standoff.view.simulation_stage import RESTING
from standoff.view.solid_nodes import OVERLAP_COLOUR

LAW = HuntCrossley(stiffness=1e5, damping=5.0, friction=0.3, slip_speed=1e-2, depth=2e-3)
SIDE, HEIGHT = 0.2, 0.1
WEIGHT = 9.81 * 1000.0 * SIDE * SIDE * HEIGHT
DEPTH = (WEIGHT / (4.0 * LAW.stiffness)) ** (2.0 / 3.0)
SIZE = float(np.linalg.norm([SIDE, SIDE, HEIGHT]))


def at(x: float, z: float) -> so.Pose:
    return so.Pose(np.eye(3), [x, 0.0, z])


def two_boxes(**given: Any) -> Operator:
    """A solid and a convex body, each set down on a convex plate."""
    box = so.shapes.box(SIDE, SIDE, HEIGHT)
    height = 0.5 * HEIGHT + 1e-3
    bodies = [
        RigidBody.fixed(so.shapes.box(1.0, 0.5, 0.1), at(0.0, -0.05)),
        RigidBody.free(Solid(box), density=1000.0, pose=at(-0.3, height)),
        RigidBody.free(box, density=1000.0, pose=at(0.3, height)),
    ]
    return Operator(System(bodies, LAW, [(0, 1), (0, 2)], **given), 2e-4)


@pytest.fixture(scope="module")
def run() -> SystemRun:
    operator = two_boxes()
    return operator.run(operator.start(), 2500, 50, contacts=True)


@pytest.fixture
def page(run: SystemRun) -> Iterator[Any]:
    with so.view(run, open=False) as page:
        yield page


def told(panel: Any, name: str) -> str:
    """What the table says under a name."""
    found = re.search(f'data-of="{name}">([^<]*)<', panel._readout.content + panel._energy.content)
    assert found is not None, name
    return found[1]


def arrows_of(page: Any, name: str) -> np.ndarray:
    """Start and tip of each arrow of a group."""
    node = page.stage.picture._contacts._lines._nodes.get(name)
    return np.zeros((0, 2, 3)) if node is None else node.points.reshape(-1, 5, 2, 3)[:, 0]


def points_of(page: Any, name: str) -> np.ndarray:
    node = page.stage.picture._contacts._clouds._nodes.get(name)
    return np.zeros((0, 3)) if node is None else node.points


def by_place(points: np.ndarray) -> np.ndarray:
    return points[np.lexsort(np.round(points, 4).T)]


def test_all_spots_of_solids_and_of_convex_bodies_are_drawn(page: Any, run: SystemRun) -> None:
    assert isinstance(page, SimulationPage)
    assert len(points_of(page, "spots")) == len(arrows_of(page, "forces")) == 0
    # Both are a millimetre above the plate: a place each, apart.
    assert len(points_of(page, "places")) == 4
    page._asked.put(lambda: page.seek(float(run.times[-1])))
    until(lambda: len(points_of(page, "spots")) == 8)
    corners = [
        (x + dx, dy, -0.5 * DEPTH)
        for x in (-0.3, 0.3) for dx in (-0.1, 0.1) for dy in (-0.1, 0.1)
    ]  # fmt: skip
    found = by_place(points_of(page, "spots"))
    assert found == pytest.approx(by_place(np.array(corners)), abs=1e-5)
    forces, normals = arrows_of(page, "forces"), arrows_of(page, "normals")
    assert len(forces) == len(normals) == 8
    for arrows in (forces, normals):
        assert by_place(arrows[:, 0]) == pytest.approx(found, abs=1e-6)
        along = arrows[:, 1] - arrows[:, 0]
        along /= np.linalg.norm(along, axis=1)[:, None]
        assert along == pytest.approx(np.tile([0.0, 0.0, 1.0], (8, 1)), abs=1e-3)
    # The weight of a box is as long as the box: a quarter of it at each corner.
    lengths = np.linalg.norm(forces[:, 1] - forces[:, 0], axis=1)
    assert lengths == pytest.approx(np.full(8, 0.25 * RESTING * SIZE), rel=1e-3)
    nodes = page.stage.picture._contacts
    assert (nodes._lines._nodes["forces"].colors == np.array(FORCE_COLOUR)).all()
    assert (nodes._clouds._nodes["places"].colors == np.array(OVERLAP_COLOUR)).all()
    texts = [label.text for label in nodes._labels if label.visible]
    assert texts == [f"{WEIGHT:.3g}"] * 2


def test_the_panel_tells_depths_forces_statuses_and_energies(page: Any, run: SystemRun) -> None:
    page._asked.put(lambda: page.seek(float(run.times[-1])))
    until(lambda: told(page.panel, "time") == "0.5 s")
    panel = page.panel
    assert "8 spots of 2 pairs push with" in panel._readout.content
    assert float(told(panel, "forces").split(",")[0]) == pytest.approx(2.0 * WEIGHT, rel=1e-3)
    assert float(told(panel, "greatest")) == pytest.approx(0.25 * WEIGHT, rel=1e-3)
    assert float(told(panel, "distance")) == pytest.approx(-DEPTH, rel=1e-3)
    assert float(told(panel, "deepest").split()[0]) == pytest.approx(run.deepest, rel=1e-3)
    assert told(panel, "certified") == "all so far"
    for name in ("kinetic", "potential", "stored", "dissipated", "supplied", "shared", "balance"):
        expected = float(getattr(run.energy, name)[-1])
        assert float(told(panel, name)) == pytest.approx(expected, rel=1e-5, abs=1e-15)
    # An arrow's length is that of its force, as the panel says.
    scale = float(told(panel, "arrows").split()[2])
    assert scale == pytest.approx(RESTING * SIZE / WEIGHT, rel=1e-2)
    rows = re.findall(r"<tr data-(\w+)=\"(\d+)\">(.*?)</tr>", panel._contacts.content)
    texts = [re.sub("<[^>]*>", " ", text).split() for *_, text in rows]
    assert [kind for kind, *_ in rows] == ["pair", "place", *["spot"] * 4] * 2
    heads = [" ".join(text[:-1]) for text in texts[::6]]
    assert heads == ["box 0 – box 1: LOCAL,", "box 0 – box 2: GLOBAL,"]
    for text in (*texts[2:6], *texts[8:12]):
        assert float(text[2]) == pytest.approx(DEPTH, rel=1e-3)
        assert float(text[3]) == pytest.approx(0.25 * WEIGHT, rel=1e-3)
    # The plot has the sum of all forces and the greatest, up to here.
    until(lambda: np.isclose(panel._plot._node.data[1][-1], 2.0 * WEIGHT, rtol=1e-3))
    assert panel._plot._node.data[2][-1] == pytest.approx(0.25 * WEIGHT, rel=1e-3)


def test_a_run_is_played_and_stepped_by_records(page: Any, run: SystemRun) -> None:
    stage = page.stage
    page._asked.put(lambda: page.play(True))
    until(lambda: stage.player.time > 0.05)
    until(lambda: stage.instant.time > 0.0)
    page._asked.put(page.step)
    until(lambda: not stage.player.playing)
    until(lambda: stage.instant.time == run.times[stage.player.frame])
    frame = stage.player.frame
    page._asked.put(page.step)
    until(lambda: stage.player.frame == frame + 1)
    heights = [body.frame.position[2] for body in stage.picture._bodies]
    assert heights[1:] == pytest.approx([run.positions(k)[frame + 1, 2] for k in (1, 2)])
    assert page.panel._play.label == "Play"
    page._asked.put(page.back)
    until(lambda: stage.instant.time == 0.0)


def test_arrows_are_stretched_cut_and_seen_through_glass(page: Any, run: SystemRun) -> None:
    picture = page.stage.picture
    page._asked.put(lambda: page.seek(float(run.times[-1])))
    page._asked.put(lambda: page.stretch(0.1))
    expected = 0.025 * RESTING * SIZE
    until(lambda: len(arrows_of(page, "forces")) == 8)
    until(lambda: np.allclose(np.ptp(arrows_of(page, "forces"), axis=1)[:, 2], expected, rtol=1e-3))
    page._asked.put(lambda: page.stretch(10.0))
    longest = LONGEST * SIZE
    until(lambda: np.allclose(np.ptp(arrows_of(page, "forces"), axis=1)[:, 2], longest, rtol=1e-3))
    assert [body._pieces[0]._glass for body in picture._bodies] == [True] * 3
    page._asked.put(lambda: page.glass(False))
    until(lambda: [b._pieces[0]._glass for b in picture._bodies] == [True, False, False])


def test_a_system_is_stepped_and_goes_on_by_itself() -> None:
    operator = two_boxes()
    with so.view(operator, open=False) as page:
        stage, panel = page.stage, page.panel
        assert stage.instant.time == 0.0
        assert not panel._time.visible
        assert panel._play.visible
        for k in (1, 2):
            page._asked.put(page.step)
            until(lambda k=k: stage.instant.time == pytest.approx(k * operator.dt, abs=1e-12))
        page._asked.put(lambda: page.play(True))
        until(lambda: stage.instant.time > 0.3)
        assert panel._play.label == "Pause"
        page._asked.put(lambda: page.play(False))
        until(lambda: not stage.playing)
        stands = stage.instant.time
        # The same as a run of as many ticks, to the last bit.
        ticks = round(stands / operator.dt)
        whole = operator.run(operator.start(), ticks, ticks)
        np.testing.assert_array_equal(stage.state.pose(2).matrix, whole.final.pose(2).matrix)
        np.testing.assert_array_equal(stage.state.pose(1).matrix, whole.final.pose(1).matrix)
        assert len(points_of(page, "spots")) == 8
        assert len(panel._plot._node.data[0]) > 2
        page._asked.put(page.back)
        until(lambda: stage.instant.time == 0.0)
        assert len(points_of(page, "spots")) == 0
        start = operator.run(operator.start(), 50, 50).final
    with so.view(operator, start, open=False) as page:
        assert page.stage.instant.time == pytest.approx(0.01)


def test_a_step_that_fails_is_told_and_pauses() -> None:
    with so.view(two_boxes(), open=False) as page:
        notes = list[str]()
        page._notify = notes.append

        def fails(*_: Any, **__: Any) -> Any:
            raise StandoffError("no longer finite")

        page.stage.operator.run = fails
        page._asked.put(lambda: page.play(True))
        until(lambda: bool(notes))
        assert notes == ["no longer finite"]
        assert not page.stage.playing


def test_without_gravity_arrows_are_made_for_the_greatest_force() -> None:
    operator = two_boxes(gravity=(0.0, 0.0, 0.0))
    assert usual_force(operator.system, [0.0, 7.0, 3.0]) == 7.0
    assert usual_force(operator.system, []) == 1.0
    assert usual_force(two_boxes().system, [7.0]) == pytest.approx(WEIGHT)


def test_what_cannot_be_shown_is_refused() -> None:
    operator = two_boxes()
    run = operator.run(operator.start(), 1)
    with pytest.raises(StandoffError, match=r"contacts=True"):
        so.view(run, open=False)
    with pytest.raises(StandoffError, match="another system"):
        so.view(operator, two_boxes().start(), open=False)
    for bad in ((operator, 3), (operator.start(),)):
        with pytest.raises(TypeError, match="cannot be shown"):
            so.view(*bad, open=False)
    with pytest.raises(StandoffError, match="no pair with a solid"):
        so.view(operator, open=False, minima=1.0)


def instant(*contacts: PairContact, uncertified: int = 0) -> Instant:
    none = Energy(0.0, 0.0, 0.0, 0.0, 0.0)
    return Instant(0.0, np.zeros((0, 4, 4)), contacts, 0.0, none, 0.0, uncertified, 0.0, 0.0)


def test_words_of_contacts() -> None:
    operator = two_boxes()
    given = Simulated((operator, operator.start()), "t", "m", ("<a>", "b", "c"))
    up, zero = np.array([0.0, 0.0, 1.0]), np.zeros(3)
    spot = SpotForce(zero, up, 1e-3, 0.5, 2.0 * up)
    felt = ContactPlace(3, True, -1e-3, up, zero, zero)
    other = felt._replace(key=4, felt=False)
    near = felt._replace(key=5, felt=False, distance=1e-3)
    first = PairContact(0, Status.NOT_CERTIFIED, -1e-3, (felt, other, near), (spot, spot))
    units = Units.of("m")
    assert contacts_verdict([], 0.0, units) == "nothing touches"
    assert contacts_verdict([first], 4.0, units) == "2 spots of 1 pair push with 4 N in all"
    text = contacts_list(instant(first), given)
    assert "&lt;a&gt; – b: NOT_CERTIFIED, 4 N" in text
    assert text.count("another way out") == 2
    assert re.findall(r">([^<>]*#[^<>]*)<", text) == ["place #3", "place #4", "place #5"]
    assert text.count(str(OVERLAP_COLOUR)) == 2
    assert drawn_places([first]) == [felt, near]
    many = first._replace(spots=(spot,) * 96)
    assert contacts_list(instant(many, first), given).count("<tr") == 60
    assert "and 46 more rows" in contacts_list(instant(many, first), given)
    assert certified_text(instant(first, uncertified=7), given) == (
        "not now: <a> – b; 7 not since the start"
    )
    sound = first._replace(status=Status.LOCAL)
    assert certified_text(instant(sound, uncertified=7), given) == "7 not since the start"


SCENE = """
version = 1
title = "A ball that falls"
[bodies.floor]
shape = "halfspace"
[bodies.ball]
shape = "sphere"
radius = 0.1
[placements.ball]
position = [0.0, 0.0, 0.101]
[free.ball]
density = 1000.0
[contact]
stiffness = 1e6
damping = 5.0
depth = 4e-3
[simulate]
step = 1e-4
duration = 0.3
every = 100
"""


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    (tmp_path / "ball.toml").write_text(SCENE, "utf-8")
    return tmp_path / "ball.toml"


def test_the_command_runs_a_simulation_and_shows_it(
    scene: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    seen: list[Any] = []

    def wait(page: Any) -> None:
        given = page.stage.given
        seen.append((type(page), given.names, given.unit, given.what.times[-1]))
        raise KeyboardInterrupt

    monkeypatch.setattr(ServedPage, "wait", wait)
    assert main(["view", str(scene)]) == 0
    assert seen == [(SimulationPage, ("floor", "ball"), "m", pytest.approx(0.3))]
    assert "A ball that falls: open http" in capsys.readouterr().out
    for option in ("pair", "gallery", "minima", "patch"):
        assert main(["view", str(scene), f"--{option}", "1.0"]) == 2
        assert f"--{option}: the page of a simulation" in capsys.readouterr().err
    scene.write_text(SCENE.replace("0.101", "0.05"))
    assert main(["view", str(scene)]) == 2
    assert "overlap at the start" in capsys.readouterr().err
    assert main(["view", str(scene.with_name("none.toml"))]) == 2
    assert main(["track", str(scene)]) == 2
    assert "`standoff view` shows it" in capsys.readouterr().err
    assert len(seen) == 1


@pytest.mark.usefixtures("slowly")
def test_a_simulation_in_a_browser(scene: Path, chromium: Any, tab: Callable[..., Any]) -> None:
    weight = 9.81 * 1000.0 * 4.0 / 3.0 * np.pi * 0.1**3
    with so.view(scene, open=False) as page:
        desk = opened(page, tab(760, 420))
        assert desk.number("distance") == pytest.approx(1e-3, abs=1e-9)
        assert desk.shown("verdict") == "nothing touches"
        desk.page.get_by_role("button", name="Play").click()
        until(lambda: desk.number("time") > 0.1)
        page._asked.put(lambda: page.play(False))
        page._asked.put(lambda: page.seek(page.stage.player.last))
        until(lambda: desk.shown("time") == "0.3 s")
        assert float(desk.shown("forces").split()[0]) == pytest.approx(weight, rel=0.02)
        assert "1 spot of 1 pair pushes" in desk.shown("verdict")
        desk.page.get_by_role("tab", name="Contacts").click()
        row = desk.page.locator("[data-of=contacts-list] tr[data-spot='1']")
        force = page.stage.instant.greatest
        assert f"{force:.4g} N" in row.text_content()
        desk.shot("simulation")
        desk.page.get_by_role("tab", name="Energy").click()
        stored = page.stage.instant.energy.stored
        until(lambda: desk.number("stored") == pytest.approx(stored, rel=1e-4))
        assert desk.foreign(page.address) == []
        assert (desk.failed, desk.errors) == ([], [])
