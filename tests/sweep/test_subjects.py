"""Sweeps of worlds, robots and solids: rows against single answers, bytes, and what is refused."""

from __future__ import annotations

import itertools
import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import standoff as so
from families.solid_shapes import prism, tube
from standoff.errors import StandoffError
from standoff.robots import Robot
from standoff.scene import SceneError
from standoff.solids import save_boundary
from standoff.sweep.job import Job
from standoff.sweep.reading import load_job
from standoff.sweep.run import run_sweep
from standoff.sweep.subjects.nearest import row_of
from standoff.tracking.status import BY_NUMBER, Status
from sweep.test_runs import contents

ARM = Path(__file__).parents[2] / "examples/robots/arm.xml"

WORLD = """version = 1
title = "Three"
length_unit = "mm"
[bodies.tool]
shape = "compound"
[bodies.tool.pieces.rod]
shape = "capsule"
radius = 0.2
length = 2.0
[bodies.tool.pieces.head]
shape = "box"
size = [0.6, 0.4, 0.2]
position = [0.0, 0.0, 1.2]
[bodies.ball]
shape = "sphere"
radius = 0.5
[bodies.wall]
shape = "box"
size = [0.2, 4.0, 4.0]
[placements.ball]
position = [1.5, 0.0, 0.0]
[placements.wall]
position = [-1.5, 0.0, 0.0]
[world]
fixed = ["wall"]
"""

OF_WORLD = """version = 1
world = "scene.toml"
[parameters.x]
moves = "tool"
what = "x"
from = -1.5
to = 0.5
[parameters.any]
moves = "tool"
rotation = "uniform"
[parameters.lift]
moves = "ball"
what = "z"
from = -1.0
to = 1.0
[sampler]
kind = "sobol"
rows = 60
[keep]
worst = 10
below = 0.1
histogram = { from = -1.0, to = 2.0, bins = 30 }
[shards]
rows = 25
"""

OF_ROBOT = f"""version = 1
robot = "{ARM}"
q = [0.1, 0.2, 0.0, -0.3, 0.0, 0.4, 0.0]
[parameters.shoulder]
joint = "j2"
[parameters.base]
joint = "j1"
from_degrees = -90
to_degrees = 45
[sampler]
kind = "random"
rows = 40
seed = 3
[keep]
worst = 10
[shards]
rows = 15
"""

SOLIDS = """version = 1
[bodies.ring]
body = "ring.json"
[bodies.pin]
shape = "cylinder"
radius = 0.8
height = 3.0
[pair]
a = "ring"
b = "pin"
"""

OF_SOLIDS = """version = 1
scene = "scene.toml"
[parameters.x]
moves = "pin"
what = "x"
from = -0.15
to = 0.15
[parameters.tilt]
moves = "pin"
what = "turn_y"
from_degrees = -2.0
to_degrees = 2.0
[sampler]
kind = "sobol"
rows = 6
[shards]
rows = 3
"""


def job_of(folder: Path, text: str, scene: str = "") -> Job:
    (folder / "scene.toml").write_text(scene or WORLD, encoding="utf-8")
    save_boundary(folder / "ring.json", tube(1.0, 1.5, -0.5, 0.5).boundary)
    (folder / "job.toml").write_text(text, encoding="utf-8")
    return load_job(folder / "job.toml")


def robot_job(folder: Path, text: str = OF_ROBOT) -> Job:
    pytest.importorskip("mujoco")
    return job_of(folder, text)


KINDS = {"world": (OF_WORLD, WORLD), "robot": (OF_ROBOT, WORLD), "solids": (OF_SOLIDS, SOLIDS)}


def test_rows_of_a_world_are_its_answers(tmp_path: Path) -> None:
    """The least over all pairs of pieces, each asked alone, and what the world says itself."""
    job = job_of(tmp_path, OF_WORLD)
    world, scene = job.subject.world, job.subject.scene  # type: ignore[attr-defined]
    rows, poses = job.answers(0, 60), job.subject.poses(job.parameters, job.numbers(0, 60))  # type: ignore[attr-defined]
    assert world.moving == ("tool", "ball")
    numbers, nearest = job.numbers(0, 60), set()
    np.testing.assert_array_equal(poses[:, 0, :3, 3], numbers[:, :1] * [1.0, 0.0, 0.0])
    at_ball = [1.5, 0.0, 0.0] + numbers[:, 4:] * [0.0, 0.0, 1.0]
    np.testing.assert_array_equal(poses[:, 1, :3, 3], at_ball)
    assert (poses[:, 1, :3, :3] == np.eye(3)).all()
    for k, frame in enumerate(poses):
        answer = world.distances(frame)
        assert answer.closest is not None
        assert rows.distance[k] == answer.closest.distance
        assert rows.lower_bound[k] == answer.clearance
        assert BY_NUMBER[rows.status[k]] is answer.closest.status
        names = job.subject.pair_names(int(rows.pair[k]))
        assert names == answer.closest.names
        nearest.add(names)
        where = {"tool": frame[0], "ball": frame[1], "wall": scene.motions["wall"].path.pose(0.0)}
        bodies = scene.bodies
        pairs = itertools.combinations(bodies, 2)
        least = min(
            so.distance(bodies[a], bodies[b], where[a], where[b]).distance for a, b in pairs
        )
        assert abs(least - rows.distance[k]) < 1e-12
    assert nearest == {("tool", "ball"), ("tool", "wall")}
    assert (rows.distance < 0.0).any()


def test_a_horizon_of_a_world(tmp_path: Path) -> None:
    full = job_of(tmp_path, OF_WORLD).answers(0, 60)
    job = job_of(tmp_path, f"within = 0.2\n{OF_WORLD}")
    cut = job.answers(0, 60)
    far = cut.status == Status.FAR.value
    assert 5 < far.sum() < 55
    assert np.isnan(cut.distance[far]).all()
    assert (cut.pair[far] == -1).all()
    assert (full.distance[far] >= 0.2).all()
    assert (cut.lower_bound[far] >= 0.2).all()
    assert np.array_equal(cut.distance[~far], full.distance[~far])
    assert job.alone(int(np.flatnonzero(far)[0])).nearest is None
    assert job_of(tmp_path, OF_WORLD, WORLD + "within = 0.3\n").within == 0.3
    with pytest.raises(SceneError, match=r"beyond the horizon 'within', 0\.05"):
        job_of(tmp_path, f"within = 0.05\n{OF_WORLD}")


def test_rows_of_a_robot_are_its_clearances(tmp_path: Path) -> None:
    job = robot_job(tmp_path)
    robot = Robot.from_mujoco(ARM)
    numbers, rows = job.numbers(0, 40), job.answers(0, 40)
    q = np.tile([0.1, 0.2, 0.0, -0.3, 0.0, 0.4, 0.0], (40, 1))
    q[:, 1], q[:, 0] = numbers[:, 0], np.radians(numbers[:, 1])
    assert (np.abs(numbers[:, 0]) <= 1.8).all()
    assert np.ptp(numbers[:, 0]) > 3.0
    assert ((numbers[:, 1] >= -90) & (numbers[:, 1] <= 45)).all()
    found = robot.clearances(q)
    assert np.array_equal(rows.distance, found.distance)
    assert np.array_equal(rows.lower_bound, found.clearance)
    assert [BY_NUMBER[k] for k in rows.status] == found.status.tolist()
    assert [job.subject.pair_names(int(k)) for k in rows.pair] == found.names
    near = robot_job(tmp_path, f"within = 0.05\n{OF_ROBOT}").answers(0, 40)
    far = near.status == Status.FAR.value
    assert (far == (found.distance >= 0.05)).all()
    assert 0 < far.sum() < 40


def test_rows_of_solids_are_their_distances(tmp_path: Path) -> None:
    job = job_of(tmp_path, OF_SOLIDS, SOLIDS)
    rows, numbers = job.answers(0, 6), job.numbers(0, 6)
    ring, pin = job.subject.bodies  # type: ignore[attr-defined]
    for k, (x, tilt) in enumerate(numbers):
        c, s = np.cos(np.radians(tilt)), np.sin(np.radians(tilt))
        pose = so.Pose([[c, 0, s], [0, 1, 0], [-s, 0, c]], [x, 0, 0])
        alone = so.distance(ring, pin, so.Pose.identity(), pose)
        assert abs(rows.distance[k] - alone.distance) < 1e-9
        assert abs(rows.lower_bound[k] - alone.lower_bound) < 1e-9
        assert BY_NUMBER[rows.status[k]] is alone.status
    with pytest.raises(StandoffError, match=r"over ring and pin, .* job\.answers"):
        job.distances(0, 1)


@pytest.mark.parametrize("kind", ["scene", "world"])
def test_what_is_inside_a_solid_is_nearest_of_all(tmp_path: Path, kind: str) -> None:
    """Its distance is less the wall, and nothing bounds it."""
    save_boundary(tmp_path / "block.json", prism([(-2, -2), (2, -2), (2, 2), (-2, 2)], 4).boundary)
    scene = (
        'version = 1\n[bodies.block]\nbody = "block.json"\n[bodies.seed]\nshape = "sphere"\n'
        'radius = 0.5\n[placements.seed]\nposition = [0, 0, 2]\n[pair]\na = "block"\nb = "seed"\n'
    )
    text = (
        f'version = 1\n{kind} = "scene.toml"\n[parameters.x]\nmoves = "seed"\nwhat = "x"\n'
        'from = 0\nto = 6\nsteps = 4\n[sampler]\nkind = "grid"\n'
    )
    rows = job_of(tmp_path, text, scene).answers(0, 4)
    assert [BY_NUMBER[k].name for k in rows.status] == [
        *("CONTAINED", "OVERLAPPING", "CONVERGED", "CONVERGED")
    ]
    np.testing.assert_allclose(rows.distance[[0, 2, 3]], [-1.5, 1.5, 3.5], atol=1e-6)
    assert rows.lower_bound[0] == -np.inf


@pytest.mark.soak
@pytest.mark.parametrize("kind", list(KINDS))
def test_two_processes_write_the_same_bytes(tmp_path: Path, kind: str) -> None:
    if kind == "robot":
        pytest.importorskip("mujoco")
    job = job_of(tmp_path, *KINDS[kind])
    run_sweep(job, tmp_path / "one")
    run_sweep(job, tmp_path / "two", workers=2)
    assert contents(tmp_path / "one") == contents(tmp_path / "two")


@pytest.mark.parametrize("kind", list(KINDS))
def test_reports_and_resumed_runs(tmp_path: Path, kind: str) -> None:
    """A row alone has the bits that it has in a block; the report names each row's nearest pair."""
    if kind == "robot":
        pytest.importorskip("mujoco")
    job = job_of(tmp_path, *KINDS[kind])
    run_sweep(job, tmp_path / "out")
    before = contents(tmp_path / "out")
    (tmp_path / "out/shards/000000001.json").unlink()
    run_sweep(load_job(job.file), tmp_path / "out")
    assert contents(tmp_path / "out") == before
    facts = json.loads(before["report.json"])
    worst = facts["worst"]
    for k, row in enumerate(worst["row"][:4]):
        alone = job.alone(row)
        assert alone.rows.distance[0] == worst["distance"][k]
        assert alone.rows.lower_bound[0] == worst["lower_bound"][k]
        assert ("pair" in worst) == (kind != "solids")
        if kind != "solids":
            assert tuple(worst["pair"][k]) == alone.names
            assert alone.nearest.distance == worst["distance"][k]
    assert sum(facts["statuses"].values()) == job.rows


def test_a_pair_that_may_be_nearer_and_is_not_proven_is_told() -> None:
    def row(status: list[Status], bounds: list[float]) -> Any:
        pairs = SimpleNamespace(
            inside=np.zeros(3, dtype=bool),
            distance=np.array([3.0, 1.0, 2.0]),
            lower_bound=np.array(bounds),
            status=np.array(status, dtype=object),
            bodies=np.array([[0, 1], [0, 2], [1, 2]]),
        )
        model = SimpleNamespace(listed=[None] * 3)
        return row_of(SimpleNamespace(pairs=pairs, clearance=min(bounds), model=model))  # type: ignore[arg-type]

    good, bad = Status.CONVERGED, Status.NOT_CERTIFIED
    assert row([good] * 3, [3.0, 1.0, 2.0]) == (1.0, 1.0, good.value, 2)
    assert row([bad, good, good], [1.5, 1.0, 2.0]) == (1.0, 1.0, good.value, 2)
    assert row([bad, good, Status.WITHIN], [0.7, 1.0, 0.5]) == (1.0, 0.5, Status.WITHIN.value, 2)
    assert row([bad, Status.DEADLINE, good], [0.5, 0.9, 2.0])[2] == Status.DEADLINE.value


SOBOL = '[sampler]\nkind = "sobol"\nrows = 10\n'


def arm(text: str, top: str = "") -> str:
    return f'version = 1\nrobot = "{ARM}"\n{top}[parameters.p]\n{text}\n{SOBOL}'


def world(text: str, top: str = "") -> str:
    return f'version = 1\nworld = "scene.toml"\n{top}[parameters.p]\n{text}\n{SOBOL}'


@pytest.mark.parametrize(
    ("text", "key", "told"),
    [
        (world('moves = "tol"\nwhat = "x"\nfrom = 0\nto = 1'), "moves", "did you mean 'tool'?"),
        (world('moves = "wall"\nwhat = "x"\nfrom = 0\nto = 1'), "moves", "'wall' is fixed"),
        (world('moves = "tool"\nwhat = "x"\nfrom = 0\nto = 1', 'pair = "a"\n'), "pair", "all of"),
        (world('moves = "tool"\nwhat = "x"\nfrom = 0\nto = 1', "hulls = true\n"), "hulls", "robot"),
        (arm('joint = "j8"'), "joint", "unknown joint 'j8'"),
        (arm('joint = "j2"\nto = 2.0'), "to", "outside its limits -1.8 to 1.8"),
        (arm('joint = "j2"\nfrom_degrees = -104'), "from_degrees", "outside its limits"),
        (arm('joint = "j2"\nfrom = 1.9'), "to", "must be above 'from'"),
        (arm('moves = "j2"\nwhat = "x"'), "moves", "has 'joint' instead"),
        (arm('joint = "j2"\nfrom = 0\nfrom_degrees = 0'), "", "say the same thing"),
        (arm('joint = "j2"\n[parameters.r]\njoint = "j2"'), "", "changes the same of 'j2'"),
        (arm('joint = "j2"', "q = [0, 1]\n"), "q", "nq = 7"),
        (arm('joint = "j2"', 'skip = ["hand"'), "", "TOML"),
        (arm('joint = "j2"', "skip = [3]\n"), "skip[0]", "string in quotes"),
        (arm('joint = "j2"', 'skip = ["hant"]\n'), "skip", "hant"),
        (arm('joint = "j2"', 'srdf = "job.toml"\n'), "srdf", "only a URDF file"),
        (arm('joint = "j2"', 'world = "scene.toml"\n'), "robot", "one thing"),
        (arm('joint = "j2"').replace(str(ARM), "scene.toml"), "robot", "URDF file (.urdf)"),
        (arm('joint = "j2"').replace(".xml", ".xm"), "robot", "no file"),
    ],
)
def test_what_is_refused(tmp_path: Path, text: str, key: str, told: str) -> None:
    if "robot" in text:
        pytest.importorskip("mujoco")
    with pytest.raises(SceneError) as caught:
        job_of(tmp_path, text)
    assert told in str(caught.value)
    assert caught.value.key.endswith(key)


def test_joints_of_several_numbers_and_those_that_follow(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    (tmp_path / "ball.xml").write_text(
        '<mujoco><worldbody><geom name="floor" type="plane" size="1 1 1"/><body pos="0 0 2">'
        '<joint name="any" type="ball"/><geom name="tip" type="sphere" size="0.1"/>'
        '<body pos="1 0 0"><joint name="free spin" axis="0 0 1"/>'
        '<geom name="end" type="box" size="0.1 0.2 0.3"/></body></body></worldbody></mujoco>'
    )
    text = f'version = 1\nrobot = "ball.xml"\n[parameters.p]\njoint = "any"\n{SOBOL}'
    with pytest.raises(SceneError, match="'any' is a ball joint"):
        job_of(tmp_path, text)
    with pytest.raises(SceneError, match="'from' is missing"):
        job_of(tmp_path, text.replace("any", "free spin"))
    spin = 'joint = "free spin"\nfrom_degrees = -180\nto_degrees = 180'
    job = job_of(tmp_path, text.replace('joint = "any"', spin))
    assert np.isfinite(job.answers(0, 4).distance).all()


def test_rows_of_a_file_keep_to_the_limits(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    (tmp_path / "rows.csv").write_text("p\n0.5\n-1.7\n1.81\n")
    text = arm('joint = "j2"').replace(SOBOL, '[sampler]\nkind = "file"\nfile = "rows.csv"\n')
    job = job_of(tmp_path, text)
    assert job.answers(0, 2).distance.shape == (2,)
    with pytest.raises(StandoffError, match=r"row 2: joint 'j2' \(q\[1\]\) is 1.81, outside"):
        job.answers(1, 3)
