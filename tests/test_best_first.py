"""The best-first search by hand-made cases: intervals of a line, functions of known minima."""

from __future__ import annotations

import math
from itertools import pairwise, permutations

import numpy as np
import pytest

from standoff.best_first import Ending, SearchPart, best_first

LEAST = 1e-12


class Line:
    """Intervals of a function that is Lipschitz with a constant; each split is written down."""

    def __init__(self, f, lipschitz, shortest=0.0):
        self.f, self.lipschitz, self.shortest = f, lipschitz, shortest
        self.split_ones = []

    def part(self, low, high):
        middle = 0.5 * (low + high)
        value = float(self.f(middle))
        bound = value - 0.5 * self.lipschitz * (high - low)
        return SearchPart(bound, (low, high), value, high - low <= self.shortest)

    def halves(self, chosen):
        self.split_ones += [part.body for part in chosen]
        out = []
        for part in chosen:
            low, high = part.body
            middle = 0.5 * (low + high)
            out += [self.part(low, middle), self.part(middle, high)]
        return out

    def search(self, goal, most=lambda _: math.inf, batch=1, parts=8):
        ends = np.linspace(0.0, 1.0, parts + 1).tolist()
        first = [self.part(a, b) for a, b in pairwise(ends)]
        return best_first(first, self.halves, goal, most, batch)


def wavy(x):
    """Its least value on [0, 1] is -1 - 0.2 at x = 0.75, and -0.6 at 0.25 beside it."""
    return -0.2 * x / 0.75 - np.cos(8.0 * np.pi * (x - 0.75)) * (1.0 if x > 0.5 else 0.5)


@pytest.mark.parametrize("batch", [1, 4, 100])
@pytest.mark.parametrize("width", [1e-1, 1e-3, 1e-6])
def test_the_least_value_is_enclosed_as_closely_as_is_asked(width, batch):
    line = Line(lambda x: abs(x - 0.3), 1.0)
    found = line.search(lambda seen: seen - width, batch=batch)
    assert found.ending is Ending.GOAL
    assert found.least <= 0.0 <= found.found
    assert found.found - found.least <= width
    low, high = found.place
    assert low <= 0.3 + width
    assert high >= 0.3 - width


def test_of_many_minima_the_least_is_found_against_a_grid(rng):
    for _ in range(20):
        waves = rng.uniform(-1.0, 1.0, (4, 2))

        def f(x, waves=waves):
            return sum(a * np.sin(9.0 * k * x + b) for k, (a, b) in enumerate(waves, 1))

        line = Line(f, 9.0 * sum(k * abs(a) for k, (a, _) in enumerate(waves, 1)))
        found = line.search(lambda seen: seen - 1e-4)
        truth = min(f(x) for x in np.linspace(0.0, 1.0, 20_001))
        assert found.least <= truth <= found.found + 1e-6  # of a grid, not the truth itself
        assert found.found <= truth + 1e-4


def test_the_part_with_the_least_bound_is_split_first():
    line = Line(lambda x: abs(x - 0.3), 1.0)
    bounds = {}
    old = line.halves

    def halves(chosen):
        bounds[chosen[0].body] = chosen[0].bound
        return old(chosen)

    first = [line.part(0.0, 0.5), line.part(0.5, 1.0)]
    best_first(first, halves, lambda seen: seen - 1e-3, lambda _: math.inf)
    split = list(bounds)
    assert split[0] == (0.0, 0.5)
    for (low, high), bound in bounds.items():
        # nothing was split that the goal had already left behind
        assert bound < abs(0.3 - 0.5 * (low + high)) + 1.0
    assert all(not (low >= 0.5 and high <= 1.0) for low, high in split)


def test_equal_bounds_are_split_as_they_came():
    order = []

    def halves(chosen):
        order.extend(part.body for part in chosen)
        return [SearchPart(1.0, part.body + "'") for part in chosen]

    best_first([SearchPart(0.0, name) for name in "abc"], halves, lambda _: 1.0, lambda _: math.inf)
    assert order == ["a", "b", "c"]


def test_the_order_of_the_parts_does_not_change_what_is_proven():
    line = Line(wavy, 32.0)
    ends = np.linspace(0.0, 1.0, 5)
    parts = [line.part(a, b) for a, b in pairwise(ends.tolist())]
    due = best_first(parts, line.halves, lambda seen: seen - 1e-3, lambda _: math.inf)
    for order in permutations(parts):
        found = best_first(order, line.halves, lambda seen: seen - 1e-3, lambda _: math.inf)
        assert (found.least, found.found, found.splits) == (due.least, due.found, due.splits)


def test_it_ends_when_the_work_is_spent_and_says_so():
    line = Line(lambda x: abs(x - 0.3), 1.0)
    found = line.search(lambda _: 0.1, lambda _: 3)
    assert (found.ending, found.splits, len(line.split_ones)) == (Ending.SPENT, 3, 3)
    assert found.least < 0.1
    assert len(found.open) == 8 + 3
    more = Line(lambda x: abs(x - 0.3), 1.0).search(lambda seen: seen - 1e-9, lambda seen: 20)
    assert more.splits == 20
    assert more.least > found.least


def test_what_may_be_spent_may_hang_on_what_was_seen():
    line = Line(lambda x: abs(x - 0.3), 1.0)
    found = line.search(lambda seen: seen - LEAST, lambda seen: 100 if seen > 0.01 else 0)
    assert found.ending is Ending.SPENT
    assert found.found <= 0.01
    assert found.splits < 10


def test_it_ends_where_nothing_can_be_split_any_more_and_says_so():
    line = Line(lambda x: abs(x - 0.3), 1.0, shortest=1.0 / 64.0)
    found = line.search(lambda seen: seen - LEAST)
    assert found.ending is Ending.CLOSED
    # what is left open can no more hold the least; the closed ones alone may
    assert all(part.bound >= found.found - LEAST for part in found.open)
    assert found.least == min(part.bound for part in found.closed)
    assert found.least <= 0.0


def test_a_search_that_has_met_what_it_looks_for_may_end():
    line = Line(lambda x: abs(x - 0.3), 1.0)
    found = line.search(lambda seen: -math.inf if seen < 0.05 else 1.0)
    assert found.ending is Ending.GOAL
    assert found.found < 0.05
    assert found.splits <= 4


def test_the_first_place_of_the_least_value_is_kept_and_no_number_is_none():
    seen = {"a": math.nan, "b": 2.0, "c": 1.0, "d": 1.0}
    parts = [SearchPart(0.0, name, value) for name, value in seen.items()]
    found = best_first(parts, lambda chosen: [], lambda _: -1.0, lambda _: math.inf)
    assert (found.found, found.place, found.splits) == (1.0, "c", 0)


def test_nothing_to_search_is_proven():
    found = best_first([], lambda chosen: chosen, lambda _: 1.0, lambda _: math.inf)
    assert (found.ending, found.least, found.found, found.place) == (
        Ending.GOAL,
        math.inf,
        math.inf,
        None,
    )


def test_parts_that_are_closed_at_first_are_left_alone():
    parts = [SearchPart(-1.0, "a", closed=True), SearchPart(0.0, "b")]
    split = []
    found = best_first(
        parts, lambda chosen: split.append(chosen[0].body) or [], lambda _: 1.0, lambda _: math.inf
    )
    assert split == ["b"]
    assert found.ending is Ending.CLOSED
    assert found.least == -1.0


def test_every_ending_has_a_sentence():
    assert len({ending.sentence for ending in Ending}) == len(Ending)
    assert all(ending.sentence.endswith(".") for ending in Ending)
