"""Solids that touch all round, and those that only seem to."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import standoff as so
from families.solid_shapes import ball, peg, prism, socket, tube
from on_first_use import OnFirstUse
from standoff.solids import Solid, distance
from standoff.solids.spatial.held import depth_bound
from standoff.solids.spatial.models import as_model
from standoff.solids.spatial.pair import PlacedPair
from standoff.tracking.status import Status

STILL = so.Pose.identity()


@cache
def hole() -> Solid:
    return tube(1.0, 2.0, 0.0, 1.0)


@cache
def slot() -> Solid:
    return prism([(-1, -1), (3, -1), (3, 2), (2, 2), (2, 0), (0, 0), (0, 2), (-1, 2)], 3.0)


def block(width: float, height: float, depth: float) -> Solid:
    return prism([(0, 0), (width, 0), (width, height), (0, height)], depth)


@cache
def channel() -> Solid:
    return prism([(0, 0), (3, 0), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2)], 2.0)


def raised_key() -> Solid:
    """As wide as the channel and longer. It is above the ground, so that between the walls its
    lower face is near nothing."""
    return prism([(1.0, 1.25), (2.0, 1.25), (2.0, 1.75), (1.0, 1.75)], 3.0)


HELD = OnFirstUse(
    {
        "pin through its hole": lambda: (hole(), peg(1.0, -0.5, 1.5), 0.0),
        "pin flush with its hole": lambda: (hole(), peg(1.0, 0.0, 1.0), 0.0),
        "pin within its hole": lambda: (hole(), peg(1.0, 0.2, 0.7), 0.0),
        "pin half out of its hole": lambda: (hole(), peg(1.0, 0.2, 1.7), 0.0),
        "block on three sides": lambda: (slot(), block(2.0, 1.0, 2.0), 0.5),
        "block flush with its slot": lambda: (slot(), block(2.0, 1.0, 3.0), 0.0),
        "block through its slot": lambda: (slot(), block(2.0, 3.0, 5.0), -1.0),
        "key off the ground of its channel": lambda: (channel(), raised_key(), -0.5),
        "ball in its socket": lambda: (socket(1.0, 2.0), ball(1.0), 0.0),
    }
)


LONGEST = ("pin flush with its hole", "pin half out of its hole")


@pytest.mark.parametrize(
    "name", [pytest.param(k, marks=[pytest.mark.soak] if k in LONGEST else []) for k in HELD]
)
def test_what_is_held_all_round_touches(name: str) -> None:
    a, b, up = HELD[name]
    for first, other, at in ((a, b, up), (b, a, -up)):
        answer = distance(first, other, STILL, so.Pose(np.eye(3), (0.0, 0.0, at)))
        assert answer.status is Status.TOUCHING
        assert abs(answer.distance) <= 1e-10 * (a.size + b.size)
        assert -2.1e-10 * (a.size + b.size) <= answer.lower_bound <= 0.0


def pair_of(a: Solid, b: Solid, move: tuple[float, float, float]) -> PlacedPair:
    return PlacedPair(a, b, STILL, so.Pose(np.eye(3), move))


@settings(max_examples=10, deadline=None)
@given(st.floats(-9.0, -3.0), st.floats(0.0, 1.0), st.floats(0.0, 6.28))
def test_no_bound_is_below_the_depth_of_a_pin_in_its_hole(
    exponent: float, share: float, angle: float
) -> None:
    """A pin that is too thick, or off its hole's axis, or both, by a known length."""
    depth = 10.0**exponent
    thicker, off = share * depth, (1.0 - share) * depth
    pin = peg(1.0 + thicker, 0.2, 0.7)
    pair = pair_of(hole(), pin, (off * np.cos(angle), off * np.sin(angle), 0.0))
    tolerance = 1e-10 * pair.size
    assert depth_bound(pair, tolerance) >= depth * (1.0 - 1e-6) - 1e-15


@settings(max_examples=6, deadline=None)
@given(st.floats(-9.0, -3.0), st.floats(-0.4, 0.4))
def test_no_bound_is_below_the_depth_of_a_block_in_its_slot(exponent: float, up: float) -> None:
    depth = 10.0**exponent
    pair = pair_of(slot(), block(2.0 + depth, 1.0, 2.0), (-0.5 * depth, 0.0, 0.5 + up))
    assert depth_bound(pair, 1e-10 * pair.size) >= 0.5 * depth * (1.0 - 1e-6) - 1e-15


def test_what_is_inside_is_not_held() -> None:
    """No boundary enters the other solid, but one solid is in the other's material."""
    inside = (
        pair_of(ball(1.0), ball(1.0), (0.0, 0.0, 0.0)),
        pair_of(block(4.0, 4.0, 2.0), block(1.0, 1.0, 1.0), (1.0, 1.0, 0.0)),
        pair_of(block(4.0, 4.0, 2.0), peg(0.5, 0.0, 1.0), (2.0, 2.0, 0.0)),
        pair_of(block(4.0, 4.0, 4.0), peg(0.5, 1.0, 2.0), (2.0, 2.0, 0.0)),
        pair_of(socket(1.0, 2.0), ball(2.0), (0.0, 0.0, 0.0)),
    )
    for pair in inside:
        assert depth_bound(pair, 1e-10 * pair.size) == np.inf


@pytest.mark.parametrize("depth", [1e-9, 1e-6, 1e-3])
def test_a_block_in_a_half_space_is_as_deep_as_it_is_whichever_comes_first(depth: float) -> None:
    """The half-space's frame is not that of the square of its plane that is searched."""
    turned = so.Pose(Rotation.from_rotvec([0.3, -0.5, 0.2]).as_matrix(), (1.0, 2.0, 3.0))
    ground, cube = as_model(so.shapes.halfspace()), block(1.0, 1.0, 1.0)
    at = turned @ so.Pose(np.eye(3), (0.4, 0.2, -depth))
    for pair in (PlacedPair(ground, cube, turned, at), PlacedPair(cube, ground, at, turned)):
        assert depth_bound(pair, 1e-10 * pair.size) >= depth * (1.0 - 1e-6)
        swapped = pair.swapped()
        assert np.array_equal(swapped.in_b(np.eye(3)), pair.in_a(np.eye(3)))
