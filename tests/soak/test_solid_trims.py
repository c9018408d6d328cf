"""A few of the parts that the soak draws in their thousands, judged by OpenCASCADE."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("OCP")

import standoff as so
from standoff_studies.soak import solid_trims as trims

FEW = 6
"""Of a thousand parts: what a minute of one core allows."""
AT_ATLASES = ((418, 11), (474, 11))
"""Balls cut by planes: nearest to a vertex of a face that has several charts are points inside."""

AT_A_GAP = ((86, 11), (518, 11))
"""A ball's face whose trimming curves miss each other by 6e-12 at the end of a period."""

NOT_AS_WRITTEN = ((95, 72), (188, 72))
"""Their STEP files do not hold what was written: OpenCASCADE reads other parts."""


@pytest.mark.parametrize(
    ("number", "seed"), [*((k, 1) for k in range(FEW)), *AT_ATLASES, *AT_A_GAP, *NOT_AS_WRITTEN]
)
def test_a_part_is_as_opencascade_has_it(number: int, seed: int) -> None:
    seen, lines = trims.judge_part(number, seed)
    assert seen.sound, lines
    assert seen.points + seen.refused.total() > 0


def test_what_opencascade_fails_on_is_refused() -> None:
    """Its own exceptions are of no class that a program could name."""
    rng = np.random.default_rng([72, 95, 3])
    shape = next(shape for shape in iter(lambda: trims.part_of(rng), 0) if shape is not None)
    with pytest.raises(so.cad.CadError, match="OpenCASCADE fails on it with gp_VectorWithNull"):
        so.cad.from_shape(shape)


def test_what_is_wrong_is_noticed() -> None:
    seen = trims.Judged(parts=1)
    shape = trims.primitive("ball", np.random.default_rng(1), False)
    solid, _ = trims.read_through(shape, "as it is")
    points = np.random.default_rng(2).uniform(-1.0, 1.0, (4, 3))
    assert not list(trims.judge_points(shape, solid, points, seen))
    told = solid.signed_distance(points)
    for wrong in (-told.distance, told.distance + 1e-3):
        bent = SimpleNamespace(
            slack=0.0, signed_distance=lambda points, wrong=wrong: told._replace(distance=wrong)
        )
        assert list(trims.judge_points(shape, bent, points, seen))
    assert (seen.sides, seen.far, seen.sound) == (4, 4, False)
    assert not replace(seen, sides=0, far=0).plus(seen).sound
