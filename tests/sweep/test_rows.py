"""Rows: their poses against SciPy's rotations, alone and in blocks, and those of files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import kstest

import standoff as so
from standoff.sweep.rows import Rows
from standoff.sweep.sample_file import SampleFile
from standoff.sweep.subjects import pair as pairs
from standoff.tracking.status import Status
from sweep.conftest import JOB, TOP, Make

ROUNDOFF = 1e-14
"""Of bodies of this size, length."""


def test_poses_are_what_the_page_says(make: Make) -> None:
    """Turns one after the other, each about the body's own axes; shifts along the world's."""
    job = make(
        f"""{TOP}
[parameters.a]
moves = "tool"
what = "turn_z"
from = -3.0
to = 3.0
[parameters.b]
moves = "part"
what = "turn_x"
from_degrees = -90.0
to_degrees = 180.0
[parameters.c]
moves = "tool"
what = "y"
from = -1.0
to = 2.0
[parameters.d]
moves = "tool"
what = "turn_y"
from = 0.0
to = 1.0
[sampler]
kind = "random"
rows = 50
"""
    )
    numbers = job.numbers(0, 50)
    assert ((numbers >= [-3, -90, -1, 0]) & (numbers <= [3, 180, 2, 1])).all()
    poses = job.poses(numbers)
    home = Rotation.from_rotvec([0.3, -0.2, 0.4])
    for row, pose_a, pose_b in zip(numbers, *poses, strict=True):
        turned = home * Rotation.from_euler("ZY", [row[0], row[3]])
        np.testing.assert_allclose(pose_a[:3, :3], turned.as_matrix(), atol=1e-14)
        np.testing.assert_allclose(pose_a[:3, 3], [1.0, 0.5 + row[2], 7.0], atol=1e-14)
        expected = Rotation.from_euler("x", row[1], degrees=True)
        np.testing.assert_allclose(pose_b[:3, :3], expected.as_matrix(), atol=1e-14)
        assert (pose_b[3] == [0, 0, 0, 1]).all()


def test_uniform_rotations_are_uniform_and_orthonormal(make: Make) -> None:
    job = make(JOB.replace('"sobol"', '"random"'))
    turns = job.poses(job.numbers(0, 3000))[0][:, :3, :3]
    defects = turns.transpose(0, 2, 1) @ turns - np.eye(3)
    assert np.abs(defects).max() < 1e-14
    assert np.allclose(np.linalg.det(turns), 1.0)
    # Haar's measure: of every entry uniform in [-1, 1], of the angle (1 - cos) / pi
    for entry in turns.reshape(-1, 9).T:
        assert kstest(entry, "uniform", args=(-1.0, 2.0)).pvalue > 1e-4
    angle = Rotation.from_matrix(turns).magnitude()
    assert kstest(angle, lambda x: (x - np.sin(x)) / np.pi).pvalue > 1e-4


@pytest.mark.parametrize("kind", ["random", "sobol", "latin-hypercube"])
def test_a_row_alone_is_the_row_in_a_block(make: Make, kind: str) -> None:
    job = make(JOB.replace("sobol", kind))
    block = job.distances(100, 1300)
    a, b = job.poses(job.numbers(100, 1300))
    for k in (0, 1, 2, 3, 77, 640, 1199):
        alone = job.distances(100 + k, 101 + k)
        assert alone.rows[0].tobytes() == block.rows[k].tobytes()
        for pose, all_poses in zip(job.poses(job.numbers(100 + k, 101 + k)), (a, b), strict=True):
            assert pose[0].tobytes() == all_poses[k].tobytes()
        # rows of ellipsoids are those of `so.distances`, to roundoff those of `so.distance`
        assert so.distances(*job.bodies, a[k], b[k]).distance[0] == block.distance[k]
        single = so.distance(*job.bodies, a[k], b[k]).distance
        assert abs(single - block.distance[k]) <= ROUNDOFF


def test_a_horizon(make: Make) -> None:
    job, near = make(), make(JOB.replace(TOP, f"{TOP}within = 1.0\n"))
    full, cut = job.distances(0, 400), near.distances(0, 400)
    far = np.array([status.name == "FAR" for status in cut.status])
    assert 50 < far.sum() < 350
    assert (full.distance[far] > 1.0).all()
    # with a horizon rows of ellipsoids take the general code
    np.testing.assert_allclose(full.distance[~far], cut.distance[~far], rtol=0.0, atol=ROUNDOFF)


def test_poses_that_are_not_looked_at_again_give_the_same_bits(
    make: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    job, looked = make(), []
    looked_at = Rows.of(0, job.distances(0, 500).rows)
    real = pairs.fit_poses
    monkeypatch.setattr(pairs, "fit_poses", lambda *given: looked.append(1) or real(*given))
    for column, other in zip(job.answers(0, 500), looked_at, strict=True):
        assert column.tobytes() == other.tobytes()
    assert not looked
    # too far away for a pose, so that it is refused: of the other rows, the same
    far = make(JOB.replace("to = 5.0", "to = 1e101"))
    some = far.answers(0, 50)
    assert len(looked) == 1
    assert np.array_equal(some.status, Rows.of(0, far.distances(0, 50).rows).status)
    assert Status.REFUSED.value in some.status
    # a home that is off by more than half of what is repaired
    turn = np.array([[1.0, 7e-10, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    home = so.Pose(turn, [0.0, 0.0, 5.0])
    off = replace(job, subject=replace(job.pair, homes=(home, job.homes[1])))
    assert np.array_equal(off.answers(0, 50).distance, off.distances(0, 50).distance)
    assert len(looked) == 2


FILE = """{top}[parameters.x]
moves = "tool"
what = "x"
[parameters.t]
moves = "part"
what = "turn_y"
degrees = true
[sampler]
kind = "file"
file = "{name}"
"""


def test_files_of_all_kinds_give_the_same_rows(make: Make, tmp_path: Path) -> None:
    pa, pq = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    rows = np.random.default_rng(2).normal(size=(2500, 2)) * [1.0, 40.0]
    np.save(tmp_path / "rows.npy", rows)
    lines = "\n".join(f"{t!r},-,{x!r}" for x, t in rows.tolist())
    (tmp_path / "rows.csv").write_text(f"t,note, x\n{lines}\n")
    table = pa.table({"t": rows[:, 1], "other": ["a"] * 2500, "x": rows[:, 0]})
    pq.write_table(table, tmp_path / "rows.parquet", row_group_size=700)
    digests = set()
    for ending in ("npy", "csv", "parquet"):
        job = make(FILE.format(top=TOP, name=f"rows.{ending}"))
        assert job.rows == 2500
        for first, end in ((0, 2500), (0, 1), (699, 701), (700, 1400), (1399, 2101), (2499, 2500)):
            assert np.array_equal(job.numbers(first, end), rows[first:end])
        pose = job.poses(job.numbers(7, 8))[1][0, :3, :3]
        expected = Rotation.from_euler("y", rows[7, 1], degrees=True).as_matrix()
        np.testing.assert_allclose(pose, expected, atol=1e-14)
        digests.add(job.digest)
    assert len(digests) == 3
    assert isinstance(job.source, SampleFile)
    assert make(FILE.format(top=TOP, name="rows.npy") + "rows = 9\n").rows == 9


def test_a_grid_meets_both_ends(make: Make) -> None:
    job = make(
        f"""{TOP}
[parameters.x]
moves = "tool"
what = "x"
from = 0.1
to = 0.7
steps = 4
[parameters.t]
moves = "part"
what = "turn_y"
from_degrees = -30.0
to_degrees = 60.0
steps = 3
[sampler]
kind = "grid"
"""
    )
    assert job.rows == 12
    numbers = job.numbers(0, 12)
    assert numbers[:, 0].min() == 0.1
    assert numbers[:, 0].max() == 0.7
    assert sorted(set(numbers[:, 1])) == [-30.0, 15.0, 60.0]
    assert len({tuple(row) for row in numbers.tolist()}) == 12
