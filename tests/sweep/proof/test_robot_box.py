"""The box of a robot's joints, against samples and against the robot's own proof of a box."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from standoff.errors import StandoffError
from standoff.sweep.job import Job
from standoff.sweep.proof.cells import Cells
from standoff.sweep.proof.proof import Proof
from standoff.sweep.proof.search import search
from standoff.sweep.proof.summary import Kind
from standoff.sweep.reading import load_job

ARM = Path(__file__).parents[3] / "examples/robots/arm.xml"

JOB = f"""version = 1
robot = "{ARM}"
q = [0.1, 0.2, 0.0, -0.3, 0.0, 0.4, 0.0]
[parameters.shoulder]
joint = "j2"
[parameters.base]
joint = "j1"
from_degrees = -90
to_degrees = 45
[parameters.elbow]
joint = "j4"
[sampler]
kind = "random"
rows = 300
seed = 3
[prove]
finest = 0.02
shards = 4
queries = 20_000
"""


@pytest.fixture
def job(tmp_path: Path) -> Job:
    pytest.importorskip("mujoco")
    file = tmp_path / "job.toml"
    file.write_text(JOB, encoding="utf-8")
    return load_job(file)


@pytest.mark.parametrize("clearance", [0.02, 0.1])
def test_no_sample_contradicts_a_cell(job: Job, clearance: float) -> None:
    proof, looked = Proof(job, clearance), []
    found = search(proof.box, proof.box.whole, 20_000, 10, lambda *one: looked.append(one))
    assert sum((found.share(kind) for kind in Kind), Fraction(0)) == 1
    kinds = np.concatenate([kind for _, kind, _ in looked])
    cells = Cells.together([cells for cells, _, _ in looked]).at(kinds >= 0)
    kinds = kinds[kinds >= 0]
    rows, points = job.answers(0, 300), job.source.points(0, 300)
    low, high = cells.middles - cells.halves, cells.middles + cells.halves
    counts = np.zeros(len(Kind), dtype=int)
    for point, distance, lower in zip(points, rows.distance, rows.lower_bound, strict=True):
        (which,) = np.flatnonzero(((low <= point) & (point < high)).all(axis=1))
        counts[kinds[which]] += 1
        assert distance >= clearance if kinds[which] == Kind.PROVEN else True
        assert lower < clearance if kinds[which] == Kind.VIOLATED else True
    assert counts[Kind.PROVEN] > 50
    assert found.bound <= rows.distance.min()


def test_what_the_robot_proves_of_the_box_is_proven(job: Job) -> None:
    """By another search over the same bounds: where both are done, they agree."""
    narrow = JOB.replace('joint = "j2"', 'joint = "j2"\nfrom = 0.1\nto = 0.3')
    narrow = narrow.replace('joint = "j4"', 'joint = "j4"\nfrom = -0.8\nto = -0.5')
    job.file.write_text(narrow, encoding="utf-8")
    job = load_job(job.file)
    proof = Proof(job, 0.03)
    found = search(proof.box, proof.box.whole, 20_000, 10)
    ends = np.array([[p.low for p in job.parameters], [p.high for p in job.parameters]])
    low, high = job.subject.configurations(job.parameters, ends)
    box = job.subject.robot.certify_box(low, high, 0.03, whole=True)
    assert box.verdict == found.verdict
    assert found.verdict.name == "PROVEN"
    assert found.bound >= 0.03
    assert box.proven == pytest.approx(found.bound, rel=0.5)


def test_counterexamples_are_configurations_that_are_nearer(job: Job) -> None:
    proof = Proof(job, 0.1)
    found = search(proof.box, proof.box.whole, 5000, 10)
    places = found.counterexamples.places
    assert len(places.distance) == 10
    q = job.subject.configurations(job.parameters, places.numbers)
    for one, distance in zip(q, places.distance, strict=True):
        assert job.subject.robot.clearance(one).distance == pytest.approx(distance, abs=1e-9)
        assert distance < 0.1


def test_parts_and_budget(job: Job) -> None:
    proof = Proof(job, 0.03)
    parts = [proof.computed(k) for k in range(4)]
    assert sum((part.share(kind) for part in parts for kind in Kind), Fraction(0)) == 1
    assert all(0 < part.queries < 10_000 for part in parts)


def test_a_range_beyond_the_limits_is_refused(job: Job) -> None:
    job.file.write_text(
        JOB.replace('joint = "j2"', 'joint = "j2"\nfrom = 0.0\nto = 70.0'), encoding="utf-8"
    )
    with pytest.raises(StandoffError, match="limit"):
        Proof(load_job(job.file), 0.03)
