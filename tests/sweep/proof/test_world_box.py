"""The box of a world's parameters: all pairs, piece by piece, against samples."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from families.solid_shapes import tube
from standoff.errors import StandoffError
from standoff.solids import save_boundary
from standoff.sweep.job import Job
from standoff.sweep.proof.cells import Cells
from standoff.sweep.proof.proof import Proof
from standoff.sweep.proof.search import search
from standoff.sweep.proof.summary import Kind
from standoff.sweep.reading import load_job
from sweep.test_subjects import OF_WORLD, WORLD

TURNED = OF_WORLD.replace('rotation = "uniform"', 'what = "turn_y"\nfrom = -1.0\nto = 1.5')


def job_of(folder: Path, text: str = TURNED, scene: str = WORLD) -> Job:
    (folder / "scene.toml").write_text(scene, encoding="utf-8")
    (folder / "job.toml").write_text(text.replace("rows = 60", "rows = 500"), encoding="utf-8")
    return load_job(folder / "job.toml")


@pytest.mark.parametrize("clearance", [0.05, 0.4])
def test_no_sample_contradicts_a_cell(tmp_path: Path, clearance: float) -> None:
    job = job_of(tmp_path)
    box, looked = Proof(job, clearance).box, []
    box.finest = 0.05
    found = search(box, box.whole, 20_000, 10, lambda *one: looked.append(one))
    assert sum((found.share(kind) for kind in Kind), Fraction(0)) == 1
    kinds = np.concatenate([kind for _, kind, _ in looked])
    cells = Cells.together([cells for cells, _, _ in looked]).at(kinds >= 0)
    kinds = kinds[kinds >= 0]
    rows, points = job.answers(0, 500), job.source.points(0, 500)
    low, high = cells.middles - cells.halves, cells.middles + cells.halves
    counts = np.zeros(len(Kind), dtype=int)
    for point, distance in zip(points, rows.distance, strict=True):
        (which,) = np.flatnonzero(((low <= point) & (point < high)).all(axis=1))
        counts[kinds[which]] += 1
        assert distance >= clearance if kinds[which] == Kind.PROVEN else True
        assert distance < clearance if kinds[which] == Kind.VIOLATED else True
    assert counts[Kind.PROVEN] > 20
    assert counts[Kind.VIOLATED] > 20
    assert found.bound <= rows.distance.min()
    worst = found.nearest.places.numbers
    told = job.subject.rows(job.parameters, worst, 0)
    assert told.distance[0] == pytest.approx(found.nearest.places.distance[0], abs=1e-12)


def test_pairs_that_do_not_count_are_not_asked(tmp_path: Path) -> None:
    """The compound has two pieces, and beside it there are a ball and a wall: the ball and the
    wall count as well."""
    box = Proof(job_of(tmp_path), 0.1).box
    assert box.pairs == 2 + 2 + 1


def test_what_need_not_be_convex_is_refused(tmp_path: Path) -> None:
    save_boundary(tmp_path / "ring.json", tube(1.0, 1.5, -0.5, 0.5).boundary)
    scene = WORLD.replace(
        '[bodies.ball]\nshape = "sphere"\nradius = 0.5',
        '[bodies.ball]\nbody = "ring.json"',
    )
    with pytest.raises(StandoffError, match="'ball' need not be convex"):
        Proof(job_of(tmp_path, scene=scene), 0.1)
