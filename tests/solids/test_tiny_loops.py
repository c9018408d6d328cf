"""Loops too small to take squares of are refused in our words, however they are read."""

import numpy as np
import pytest

import standoff as so
from standoff.geometry import ConicArc, Line
from standoff.solids import PlanarSolid

CORNERS = np.array([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)], dtype=float)


SIZES = [5e-324, 1e-308, 1e-200, 1e-160, 1e-100, 1e-60, 1e60, 1e200, 1e300]


def lines(size):
    at = CORNERS * size
    return [Line(p, q) for p, q in zip(at, np.roll(at, -1, axis=0), strict=True)]


def disc(size):
    return [ConicArc((0.0, 0.0), (size, 0.0), (0.0, size))]


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("make", [lines, disc])
@pytest.mark.parametrize("read", [PlanarSolid.from_loops, so.shapes.planar_loop])
def test_what_is_too_small_or_large_is_refused(read, make, size):
    with pytest.raises(so.StandoffError):
        read(make(size))


@pytest.mark.parametrize("size", [1e-40, 1e40])
def test_what_is_small_or_large_is_read(size):
    assert PlanarSolid.from_loops(lines(size)).size == pytest.approx(np.sqrt(8.0) * size)
