"""Faces with splines as trims: a box near a trim is told to be off the face, however near it is."""

from __future__ import annotations

from pathlib import Path

import cad_shapes as made
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
from shares import only
from standoff.tracking.status import Status

pytest.importorskip("OCP", reason="OpenCASCADE comes with the extra 'cad'")

PAIRS = [("twisted", "twisted"), ("twisted", "cut_off"), ("drilled_tube", "cut_off")]
GAPS = (0.1, 1e-2, 1e-2)
MOST_EVALUATIONS = 50_000
"""They take some 2,000. Two of these nine took all two million where boxes around parts of a trim
did not shrink with the parts."""


@pytest.mark.parametrize("names", only(PAIRS[1:], PAIRS), ids=lambda names: " and ".join(names))
def test_pairs_at_spline_trims_close(names: tuple[str, str], tmp_path: Path) -> None:
    a, b = (
        so.cad.read_brep(made.write_brep(getattr(made, name)(), tmp_path / f"{k}.brep"))
        .parts[0]
        .solid
        for k, name in enumerate(names)
    )
    rng = np.random.default_rng(3)
    for gap in GAPS:
        turn = Rotation.random(rng=rng).as_matrix()
        way = rng.normal(size=3)
        move = 100.0 * way / np.linalg.norm(way)
        for _ in range(8):
            answer = so.solids.distance(a, b, so.Pose.identity(), so.Pose(turn, move))
            assert answer.status is Status.CONVERGED
            assert answer.counts.evaluations < MOST_EVALUATIONS
            if abs(answer.distance - gap) < 0.1 * gap:
                break
            move = move + (gap - answer.distance) * answer.normal
        assert answer.distance == pytest.approx(gap, rel=0.1)
