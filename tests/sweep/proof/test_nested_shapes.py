"""Bodies that are said to nest, by their supports along many directions, and those that don't."""

from __future__ import annotations

import numpy as np
import pytest

import standoff as so
from standoff.bodies.body import Body
from standoff.sweep.proof.extent import directions_for, supports
from standoff.sweep.proof.mover import GROWS, OWN, sense_of
from standoff.sweep.subjects.shaped_body import shape_numbers
from sweep.shape_jobs import TABLES, shaped_of, table_of

ROUNDOFF = 1e-12
"""Of supports of bodies of this size."""


def reach(body: Body) -> np.ndarray:
    """Along all of some directions, and of a half-space along its normal alone."""
    if not body.bounded:
        far = so.Pose.exp([0.0, 0.0, 0.0], [0.0, 60.0, 80.0])
        return np.array([100.0 - so.distance(body, so.shapes.point(), np.eye(4), far).distance])
    return supports(body, directions_for(body, 8)[0]) + body.radius


def two_of(shape: str, what: str, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Supports of a body of a lesser number and of a greater one, all others drawn too."""
    table, whats = table_of(shape), shape_numbers(table_of(shape))
    shaped, low, high = shaped_of(shape, *whats), [], []
    for own in whats:
        key, _, entry = own.partition(".")
        given = table.required(key, "") if key in table else {"taper": 0.4}.get(key, 0.1)
        usual = 1.0 if key == "scale" else float(given[int(entry) - 1] if entry else given)
        ends = usual * rng.uniform([0.8, 1.05], [0.95, 1.2])
        low.append(ends[0])
        high.append(ends[1] if own == what else ends[0])
    return reach(shaped.made(tuple(low))), reach(shaped.made(tuple(high)))


ALL = [(shape, what) for shape in TABLES for what in shape_numbers(table_of(shape))]


@pytest.mark.parametrize(("shape", "what"), [x for x in ALL if sense_of(*x) is not None])
def test_the_larger_body_holds_the_smaller(shape: str, what: str, rng: np.random.Generator) -> None:
    for _ in range(1 if shape in ("spindle", "gore", "egg", "lens") else 3):
        less, more = two_of(shape, what, rng)
        grown = sense_of(shape, what) * (more - less)
        assert grown.min() >= -ROUNDOFF
        assert grown.max() > 1e-4 or (shape, what) == ("point", "scale")


@pytest.mark.parametrize(("shape", "what"), [x for x in ALL if sense_of(*x) is None])
def test_what_is_not_said_to_nest_does_not_always(
    shape: str, what: str, rng: np.random.Generator
) -> None:
    if what == "scale":
        assert shape not in OWN or shape in ("segment", "cap", "halfspace")
        return
    less, more = two_of(shape, what, rng)
    assert (more - less).min() < -1e-4 < 1e-4 < (more - less).max()


def test_every_number_that_is_told_is_one_of_its_shape() -> None:
    for shape, numbers in OWN.items():
        assert {*numbers} <= {*shape_numbers(table_of(shape))}
        assert sense_of(shape, "rounding") == (-GROWS if shape == "box" else GROWS)
