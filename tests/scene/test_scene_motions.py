"""Placements and motions of the format are those of `standoff.motion`."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from standoff.motion import (
    Carried,
    ConstantTwist,
    Fixed,
    Helix,
    Offset,
    Pose,
    PoseSamples,
    Screw,
    Spiral,
    Twist,
)
from standoff.motion import Path as MotionPath
from standoff.scene import Scene
from standoff.scene.motions import MOTIONS
from standoff.scene.placements import ORIENTATIONS

LoadText = Callable[[str], Scene]

HEAD = """version = 1
[bodies.a]
shape = "sphere"
radius = 0.1
[bodies.b]
shape = "sphere"
radius = 0.1
[pair]
a = "a"
b = "b"
"""

Q = (0.5, 0.5, 0.5, 0.5)
PLACED = Pose.exp((0.0, 0.0, 0.3), (1.0, 2.0, 3.0))
PLACEMENT = "[placements.a]\nposition = [1, 2, 3]\nrotation_vector = [0, 0, 0.3]\n"

PLACEMENTS: list[tuple[str, Pose]] = [
    ("", Pose.identity()),
    ("position = [1, 2, 3]", Pose(np.eye(3), (1.0, 2.0, 3.0))),
    ("position = [1, 2]", Pose(np.eye(3), (1.0, 2.0, 0.0))),
    ("quaternion_wxyz = [0.8, 0.6, 0, 0]", Pose.from_wxyz((0.8, 0.6, 0.0, 0.0))),
    ("quaternion_xyzw = [0.8, 0.6, 0, 0]", Pose.from_xyzw((0.8, 0.6, 0.0, 0.0))),
    ("rotation_vector = [0.1, 0.2, 0.3]", Pose.exp((0.1, 0.2, 0.3))),
    (
        "rotation_vector_degrees = [0, 90, -30]",
        Pose.exp((0.0, np.radians(90.0), np.radians(-30.0))),
    ),
    ("angle_degrees = 30", Pose.exp((0.0, 0.0, np.pi / 6.0))),
    ("angle = 0.4\nposition = [1, 2]", Pose.exp((0.0, 0.0, 0.4), (1.0, 2.0, 0.0))),
    (
        "matrix = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]\nposition = [1, 2, 3]",
        Pose([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], (1.0, 2.0, 3.0)),
    ),
    (
        "matrix = [[0, -1, 0, 4], [1, 0, 0, 5], [0, 0, 1, 6], [0, 0, 0, 1]]",
        Pose([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], (4.0, 5.0, 6.0)),
    ),
]

MOTION_CASES: list[tuple[str, MotionPath]] = [
    (f"{PLACEMENT}", Fixed(PLACED)),
    (
        f'{PLACEMENT}[motions.a]\nkind = "twist"\nlinear = [1, 2]\nangular = [0.1, 0.2, 0.3]',
        ConstantTwist(PLACED, Twist((1.0, 2.0, 0.0), (0.1, 0.2, 0.3))),
    ),
    (
        f'{PLACEMENT}[motions.a]\nkind = "twist"\nangular = [0.1, 0.2, 0.3]\nframe = "body"\n',
        ConstantTwist(PLACED, Twist((0.0, 0.0, 0.0), (0.1, 0.2, 0.3), "body")),
    ),
    (
        f'{PLACEMENT}[motions.a]\nkind = "twist"\nlinear = [1, 2]\nangular_degrees = [0, 0, 90]',
        ConstantTwist(PLACED, Twist((1.0, 2.0, 0.0), (0.0, 0.0, np.radians(90.0)))),
    ),
    (
        f'{PLACEMENT}[motions.a]\nkind = "screw"\naxis = [1, 1, 0]\nangular_rate_degrees = 45.0',
        Screw(PLACED, (1.0, 1.0, 0.0), (0.0, 0.0, 0.0), np.radians(45.0), 0.0),
    ),
    (
        '[motions.a]\nkind = "helix"\nradius = 2\npitch = 0.5\nrate_degrees = 90\n'
        "phase_degrees = 10",
        Helix(2.0, 0.5, np.radians(90.0), phase=np.radians(10.0)),
    ),
    (
        f'{PLACEMENT}[motions.a]\nkind = "screw"\naxis = [1, 1, 0]\npoint = [0, 1, 0]\n'
        "angular_rate = 2.0\npitch = 0.5",
        Screw(PLACED, (1.0, 1.0, 0.0), (0.0, 1.0, 0.0), 2.0, 0.5),
    ),
    (
        '[motions.a]\nkind = "helix"\nradius = 2\npitch = 0.5\nrate = 1.5\ncentre = [1, 2, 3]\n'
        'axis = [1, 0, 0]\nphase = 0.2\norientation = "turning"',
        Helix(2.0, 0.5, 1.5, (1.0, 2.0, 3.0), (1.0, 0.0, 0.0), 0.2, "turning"),
    ),
    (
        '[motions.a]\nkind = "helix"\nradius = 2\npitch = 0.5\nrate = 1.5',
        Helix(2.0, 0.5, 1.5),
    ),
    (
        '[motions.a]\nkind = "spiral"\nradius = 2\ngrowth = 0.5\nrate = 1.5\ncentre = [1, 2]\n'
        "phase = 0.2",
        Spiral(2.0, 0.5, 1.5, (1.0, 2.0), 0.2),
    ),
    (
        '[motions.a]\nkind = "spiral"\nradius = 0\ngrowth = 0.1\nrate = -2\n'
        'orientation = "turning"\noffset = {position = [0.5, 0]}',
        Offset(Spiral(0.0, 0.1, -2.0, orientation="turning"), Pose(np.eye(3), (0.5, 0.0, 0.0))),
    ),
    (
        '[motions.a]\nkind = "helix"\nradius = 2\npitch = 0.5\nrate = 1.5\n'
        "offset = {position = [0, 0, 1], angle = 0.5}",
        Offset(Helix(2.0, 0.5, 1.5), Pose.exp((0.0, 0.0, 0.5), (0.0, 0.0, 1.0))),
    ),
]

SPIN = Twist((0.0, 0.0, 0.0), (0.1, 2.0, 0.3), "body")
MOTION_CASES += [
    (
        '[motions.a]\nkind = "helix"\nradius = 2\npitch = 0\nrate = 1.5\nspin = [0.1, 2, 0.3]\n'
        "offset = {position = [0, 0, 1], angle = 0.5}",
        Carried(
            Offset(Helix(2.0, 0.0, 1.5), Pose.exp((0.0, 0.0, 0.5), (0.0, 0.0, 1.0))),
            ConstantTwist(Pose.identity(), SPIN),
        ),
    ),
]

STAMPS = (100.0, 100.25, 101.0)
POSES = [Pose.from_xyzw((0.6, 0.0, 0.0, 0.8), (x, 0.0, 0.0)) for x in (0.0, 1.0, 5.0)]


@pytest.fixture
def samples(tmp_path: Path) -> Path:
    """Three uneven samples, written as TUM, as CSV and as Parquet."""
    rows = [(t, x, 0.0, 0.0, 0.6, 0.0, 0.0, 0.8) for t, x in zip(STAMPS, (0, 1, 5), strict=True)]
    lines = [" ".join(map(str, row)) for row in rows]
    (tmp_path / "hand.tum").write_text("# comment\n" + "\n".join(lines) + "\n")
    table = ["t,x,y,z,qx,qy,qz,qw", *(",".join(map(str, row)) for row in rows)]
    (tmp_path / "hand.csv").write_text("\n".join(table) + "\n")
    columns = zip(table[0].replace("t,", "time,").split(","), zip(*rows, strict=True), strict=True)
    pq.write_table(
        pa.table({name: list(map(float, values)) for name, values in columns}),
        tmp_path / "hand.parquet",
    )
    return tmp_path


def assert_same_path(mine: MotionPath, theirs: MotionPath, times: tuple[float, ...]) -> None:
    for t in times:
        np.testing.assert_array_equal(mine.pose(t).matrix, theirs.pose(t).matrix)
        np.testing.assert_array_equal(mine.twist(t).v, theirs.twist(t).v)
        np.testing.assert_array_equal(mine.twist(t).omega, theirs.twist(t).omega)


@pytest.mark.parametrize(("table", "pose"), PLACEMENTS)
def test_placement(load_text: LoadText, table: str, pose: Pose) -> None:
    scene = load_text(f"{HEAD}[placements.a]\n{table}\n")
    np.testing.assert_array_equal(scene.motions["a"].path.pose(0.0).matrix, pose.matrix)


def test_every_orientation_and_motion_is_among_the_cases() -> None:
    placements = "".join(table for table, _ in PLACEMENTS)
    assert all(f"{orientation} =" in placements for orientation in ORIENTATIONS)
    motions = "".join(table for table, _ in MOTION_CASES) + 'kind = "samples"'
    assert all(f'kind = "{kind}"' in motions for kind in MOTIONS)


@pytest.mark.parametrize(("table", "path"), MOTION_CASES)
def test_motion(load_text: LoadText, table: str, path: MotionPath) -> None:
    assert_same_path(load_text(HEAD + table).motions["a"].path, path, (0.0, 0.3, 2.0))


@pytest.mark.parametrize("file", ["hand.tum", "hand.csv", "hand.parquet"])
def test_samples_keep_the_file_s_times(load_text: LoadText, samples: Path, file: str) -> None:
    scene = load_text(f'{HEAD}[motions.a]\nkind = "samples"\nfile = "{file}"\nstart = "file"\n')
    motion = scene.motions["a"]
    np.testing.assert_array_equal(motion.sample_times, STAMPS)
    assert_same_path(motion.path, PoseSamples(STAMPS, POSES), (100.0, 100.1, 100.9, 101.0))
    assert motion.file == samples / file
    assert motion.repaired == 0


def test_samples_begin_at_zero_or_where_told(load_text: LoadText, samples: Path) -> None:
    table = f'{HEAD}[motions.a]\nkind = "samples"\nfile = "hand.tum"\n'
    np.testing.assert_array_equal(load_text(table).motions["a"].sample_times, [0.0, 0.25, 1.0])
    shifted = load_text(table + "start = 7.0\n").motions["a"]
    np.testing.assert_array_equal(shifted.sample_times, [7.0, 7.25, 8.0])


def test_samples_with_an_offset(load_text: LoadText, samples: Path) -> None:
    table = f'{HEAD}[motions.a]\nkind = "samples"\nfile = "hand.tum"\n'
    scene = load_text(table + "offset = {position = [0, 0, 1]}\n")
    path = PoseSamples((0.0, 0.25, 1.0), POSES)
    offset = Pose(np.eye(3), (0.0, 0.0, 1.0))
    assert_same_path(scene.motions["a"].path, Offset(path, offset), (0.0, 0.6))
    assert scene.times().size == 3


def test_rounded_rotations_are_reported(load_text: LoadText, samples: Path) -> None:
    (samples / "rounded.tum").write_text("0 0 0 0 0 0 0.7071 0.7071\n1 0 0 0 0 0 0.6 0.8\n")
    scene = load_text(
        f'{HEAD}[motions.a]\nkind = "samples"\nfile = "rounded.tum"\n'
        "[placements.b]\nquaternion_wxyz = [0.7071, 0.7071, 0, 0]\n"
    )
    rounded = "rotations of {} were rounded; replaced by the nearest ones"
    assert scene.notes == [f"1 {rounded.format(name)}" for name in "ab"]
    assert not load_text(HEAD).notes
    matrix = "[[0.866025, -0.5, 0.0], [0.5, 0.866025, 0.0], [0.0, 0.0, 1.0]]"
    scene = load_text(f"{HEAD}[placements.a]\nmatrix = {matrix}\n")
    assert scene.notes == [f"1 {rounded.format('a')}"]


def test_file_is_relative_to_the_scene(
    load_text: LoadText, samples: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir("/")
    scene = load_text(f'{HEAD}[motions.a]\nkind = "samples"\nfile = "hand.tum"\n')
    assert scene.times().size == 3
