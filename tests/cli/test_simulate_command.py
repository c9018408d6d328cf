"""``standoff simulate``: the example scenes by closed forms, its files, and what it refuses."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

from standoff.scene import SceneError, load_scene
from standoff.scene.simulation import load_simulation

Standoff = Callable[..., Any]
EXAMPLES = Path(__file__).parents[2] / "examples" / "simulation"
G = 9.81


def recorded(standoff: Standoff, name: str, target: Path, *options: str) -> tuple[Any, Any]:
    """(summary, table) of an example."""
    file = target / "run.parquet"
    ended = standoff("simulate", EXAMPLES / f"{name}.toml", "-o", file, "--json", *options)
    assert ended.code == 0, ended.err
    return json.loads(ended.out), pq.read_table(file)


def column(table: Any, name: str) -> np.ndarray:
    return np.array(table[name].to_pylist())


def test_the_ball_bounces_to_the_heights_of_its_restitution(
    standoff: Standoff, tmp_path: Path
) -> None:
    facts, table = recorded(standoff, "bounce", tmp_path)
    height = column(table, "ball.position")[:, 2] - 0.1
    contact = load_simulation(EXAMPLES / "bounce.toml").system.contacts[0]
    speed = np.sqrt(2.0 * G * 0.3)
    time = column(table, "time")
    first = (time > speed / G + 0.02) & (time < 0.6)
    # friction takes a little while it grips: a hundredth
    wanted = contact.restitution(speed) ** 2 * 0.3
    assert height[first].max() == pytest.approx(wanted, rel=2e-2)
    assert facts["uncertified"] == 0
    assert facts["balance_drift"] < 5e-3 * facts["energy"]["dissipated"][1]
    # spin became speed: it goes faster than it was thrown, and slower than its surface turned
    assert 0.3 < column(table, "ball.velocity")[-1, 0] < 0.8


def test_the_rattleback_turns_round(standoff: Standoff, tmp_path: Path) -> None:
    facts, table = recorded(standoff, "rattleback", tmp_path, "--duration", "2.2")
    spin = column(table, "stone.angular_velocity")[:, 2]
    assert spin[0] == pytest.approx(-5.0)
    assert spin.max() > 2.0
    assert facts["energy"]["kinetic"][1] < facts["energy"]["kinetic"][0]
    assert facts["uncertified"] == 0


def test_the_crate_takes_the_belts_speed(standoff: Standoff, tmp_path: Path) -> None:
    facts, table = recorded(standoff, "conveyor", tmp_path)
    mass = 400.0 * 0.3 * 0.3 * 0.2
    assert facts["bodies"]["crate"]["mass"] == pytest.approx(mass)
    assert column(table, "crate.velocity")[-1] == pytest.approx([1.0, 0.0, 0.0], abs=1e-3)
    # half of what the belt gives is lost where it slides: m v² in all
    assert facts["energy"]["supplied"][1] == pytest.approx(mass, rel=2e-3)
    assert facts["energy"]["dissipated"][1] == pytest.approx(0.5 * mass, rel=5e-3)
    # v²/(2 mu g) behind a point of the belt, from where it was set down
    lag = 1.0 * facts["end"] - column(table, "crate.position")[-1, 0]
    assert lag == pytest.approx(1.0 / (2.0 * 0.5 * G), rel=1e-2)
    assert (column(table, "belt-crate.spots")[200:] == 4).all()


def test_a_run_writes_the_same_file_again(standoff: Standoff, tmp_path: Path) -> None:
    files = []
    for name in ("one", "two"):
        files.append(tmp_path / f"{name}.parquet")
        options = ("--duration", "0.01", "-o", files[-1])
        assert standoff("simulate", EXAMPLES / "bounce.toml", *options).code == 0
    assert files[0].read_bytes() == files[1].read_bytes()


def test_it_draws_and_sums_up(standoff: Standoff, tmp_path: Path) -> None:
    picture = tmp_path / "run.svg"
    scene = EXAMPLES / "conveyor.toml"
    ended = standoff("simulate", scene, "--duration", "0.05", "--plot", picture)
    assert ended.code == 0
    assert "A crate on a conveyor" in ended.out
    assert "closest" in ended.out
    assert picture.read_text("utf-8").startswith("<?xml")


def test_a_hand_drags_the_ball_over_the_lens(standoff: Standoff, tmp_path: Path) -> None:
    facts, table = recorded(standoff, "hand-on-lens", tmp_path)
    found = facts["coupler"]
    assert (found["tool"], found["engaged"], found["fault"]) == ("ball", True, "NONE")
    assert found["counts"]["ticks"] == facts["ticks"] == 4000
    assert facts["uncertified"] == 0
    handle, tool = column(table, "coupler.handle_position"), column(table, "ball.position")
    # before it engages nothing is known of the handle; then whole counts of its encoders
    assert np.isnan(handle[0]).all()
    counts = (handle[1:] - [0.0425, 0.001, 0.0]) / 1e-5
    assert np.abs(counts - np.round(counts)).max() < 1e-6
    touching = column(table, "lens-ball.spots") > 0
    assert 0.2 < touching.mean() < 0.8
    # over the upper vertex, which the hand would cut off
    top = np.abs(tool[:, 0]) < 1e-3
    assert tool[top, 2].max() > 0.05 * np.sqrt(1.0 - 0.45**2) + 0.01 - 1e-3
    assert handle[top, 2].max() < tool[top, 2].max() - 2e-3
    # spring and damper pull no harder than they may, and both ways the same
    pull = column(table, "coupler.force_on_device")
    assert found["greatest_force"] == pytest.approx(np.linalg.norm(pull, axis=1).max())
    assert 2.0 < found["greatest_force"] < 10.0
    # what the hand gave went into friction and damping, or is still there
    rest = column(table, "ball.position")[-1] - handle[-1]
    assert np.abs(rest).max() < 1e-3
    kept = sum(facts["energy"][name][1] for name in ("kinetic", "stored", "dissipated"))
    lost = found["damped"] + found["stored"]
    assert found["device_work"] == pytest.approx(kept + lost, rel=0.1)
    # while it engages the growing stiffness lifts what its spring holds
    assert found["least_observed"] >= -1e-4


def test_a_coupler_that_lets_go_is_told(standoff: Standoff, tmp_path: Path) -> None:
    text = (EXAMPLES / "hand-on-lens.toml").read_text("utf-8")
    file, picture = tmp_path / "scene.toml", tmp_path / "run.svg"
    more = '\n[device.disturbances.script]\n40 = "nan"\n'
    file.write_text(text.replace("duration = 2.0", "duration = 0.1") + more, encoding="utf-8")
    ended = standoff("simulate", file, "--plot", picture)
    assert ended.code == 0, ended.err
    assert "let go: NON_FINITE" in ended.out
    assert "coupler lets go" in picture.read_text("utf-8")
    facts = json.loads(standoff("simulate", file, "--json").out)
    assert facts["coupler"]["counts"]["faults"] == 1
    assert facts["coupler"]["counts"]["engaged"] == 81


SCENE = """version = 1
bodies.floor = { shape = "halfspace" }
bodies.ball = { shape = "sphere", radius = 0.1 }
placements.ball = { position = [0, 0, 0.2] }
free.ball = { density = 1000.0 }
contact = { stiffness = 1e4 }
simulate = { step = 1e-3, duration = 0.01 }
"""


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("density = 1000.0", "", "density"),
        ("density = 1000.0", "density = 1.0, mass = 1.0", "keep one"),
        ("density = 1000.0", "mass = -1.0", "free.ball.mass"),
        ("free.ball", "free.bal", "did you mean"),
        ("stiffness = 1e4", "stiffness = 1e12", "largest stable one is"),
        ("stiffness = 1e4", "stiffness = 1e4, friction = 0.1", "slip_speed"),
        ("position = [0, 0, 0.2]", "position = [0, 0, 0.09]", "or set allow_overlap"),
        ("step = 1e-3", "step = 0.0", "simulate.step"),
        ("step = 1e-3", "step = 1e-3, method = 'rk5'", "rk4"),
        ("step = 1e-3", "step = 1e-3, tracker = 'inside', gain = 1e5", "gain"),
        ("step = 1e-3", "step = 1e-3, gravity = [0, 0]", "gravity"),
        ("step = 1e-3, ", "", "'step' is missing"),
        ("free.ball = { density = 1000.0 }", "", "free"),
        (
            "contact = ",
            "contacts = [{ a = 'ball', b = 'ball', stiffness = 1.0 }]\ncontact = ",
            "twice",
        ),
    ],
)
def test_what_is_wrong_is_told_with_its_place(
    standoff: Standoff, tmp_path: Path, old: str, new: str, told: str
) -> None:
    file = tmp_path / "scene.toml"
    assert old in SCENE
    file.write_text(SCENE.replace(old, new), encoding="utf-8")
    ended = standoff("simulate", file)
    assert ended.code == 2
    assert told in ended.err
    assert "Traceback" not in ended.err


def test_a_scene_may_say_its_pairs_one_by_one(tmp_path: Path) -> None:
    file = tmp_path / "scene.toml"
    two = SCENE.replace(
        "contact = { stiffness = 1e4 }",
        'contacts = [{ a = "ball", b = "floor", stiffness = 2e4, damping = 0.1 }]',
    )
    file.write_text(two, encoding="utf-8")
    scene = load_simulation(file)
    assert scene.system.pairs == ((0, 1),)
    assert scene.system.contacts[0].stiffness == 2e4
    assert scene.pair_name(0) == "floor-ball"
    assert (scene.ticks, scene.every) == (10, 1)
    with pytest.raises(SceneError, match=r"simulate\.step"):
        load_simulation(file, {"step": -1.0})


HAND = """
coupler = { tool = "ball", stiffness = 100.0, damping = 0.1, max_force = 5.0 }
device = { period = 1e-3, mass = 0.1, damping = 1.0 }
"""


def with_hand(tmp_path: Path, old: str, new: str) -> Path:
    file = tmp_path / "scene.toml"
    text = SCENE + HAND
    assert old in text
    file.write_text(text.replace(old, new), encoding="utf-8")
    return file


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('tool = "ball", ', "", "'tool' is missing"),
        ('tool = "ball"', 'tool = "floor"', "free body"),
        ("stiffness = 100.0", "stiffness = 1e5", "the largest passive stiffness"),
        ("stiffness = 100.0, ", "", "'stiffness' is missing"),
        ("stiffness = 100.0", "stiffnes = 100.0", "did you mean 'stiffness'"),
        ("max_force = 5.0", "max_force = 0.0", "coupler.max_force"),
        ("max_force = 5.0", "max_force = 5.0, rotational_stiffness = 0.1", "max_torque"),
        ("max_force = 5.0", "max_force = 5.0, engage_time = -1.0", "coupler.engage_time"),
        ("coupler = { tool", "# { tool", "[coupler]"),
        ("device = {", "# {", "[device]"),
        ("period = 1e-3, ", "", "'period' is missing"),
        ("period = 1e-3", "period = 1.5e-3", "whole number of times"),
        ("mass = 0.1", "mass = 0.0", "device.mass"),
        ("mass = 0.1", "mass = 0.1, delay = -1", "device.delay"),
        ("mass = 0.1", "mass = 0.1, delay = 30", "0 to 20"),
        ("mass = 0.1", "mass = 0.1, arm = 'tensed'", "an arm needs a path"),
        (
            "mass = 0.1",
            "mass = 0.1, path = { kind = 'twist', linear = [1, 0, 0] }, arm = 'soft'",
            "relaxed",
        ),
        (
            "mass = 0.1",
            "mass = 0.1, path = { kind = 'twist', linear = [1, 0, 0] }, arm = { mass = 1.0 }",
            "device.arm",
        ),
        ("mass = 0.1", "mass = 0.1, path = { kind = 'circle' }", "device.path.kind"),
        ("mass = 0.1", "mass = 0.1, disturbances = { script = { a = 'nan' } }", "from 0"),
        ("mass = 0.1", "mass = 0.1, disturbances = { script = { 3 = 'nun' } }", "nan"),
        ("mass = 0.1", "mass = 0.1, velocities = 3", "true or false"),
        ("step = 1e-3", "step = 5e-4, every = 3", "multiple of 2"),
    ],
)
def test_what_is_wrong_with_coupler_or_device_is_told(
    standoff: Standoff, tmp_path: Path, old: str, new: str, told: str
) -> None:
    ended = standoff("simulate", with_hand(tmp_path, old, new))
    assert ended.code == 2
    assert told in ended.err
    assert "Traceback" not in ended.err


def test_arms_have_names_or_numbers(tmp_path: Path) -> None:
    for arm, masses in (
        ("'fingertip'", 0.006),
        ("{ mass = 0.3, damping = 2.0, stiffness = 50.0 }", 0.3),
    ):
        path = f"mass = 0.1, path = {{ kind = 'twist', linear = [0.1, 0, 0] }}, arm = {arm}"
        scene = load_simulation(with_hand(tmp_path, "mass = 0.1", path))
        assert scene.device is not None
        assert scene.device.hand is not None
        assert scene.device.hand.arm.mass == masses
        assert scene.every == 1
    free = load_simulation(with_hand(tmp_path, "step = 1e-3", "step = 2.5e-4"))
    assert free.device is not None
    assert free.device.hand is None
    assert free.every == 4
    assert free.system.tool == 1


def test_a_scene_of_the_other_kind_is_sent_to_its_command() -> None:
    with pytest.raises(SceneError, match="`standoff track` runs it and `standoff view` shows it"):
        load_simulation(EXAMPLES.parent / "cam.toml")
    for name in ("bounce", "conveyor", "hand-on-lens", "rattleback"):
        with pytest.raises(SceneError, match="`standoff simulate` runs it"):
            load_scene(EXAMPLES / f"{name}.toml")
