"""Branches by hand-made cases: a state is a place on a line, a value is given or of a function."""

from __future__ import annotations

import pickle
from itertools import permutations, product

import numpy as np
import pytest

from standoff.tracking.branches import (
    NONE,
    Birth,
    Branch,
    BranchCounts,
    Branches,
    BranchPlace,
    Change,
    End,
)

TIE = 1e-3


def same(a: float, b: float) -> bool:
    return abs(a - b) <= 1e-6


def begun(*found: tuple[float, float]) -> Branches[float]:
    """Branches of (value, place) each, the least active."""
    return Branches[float]().joined(found, Birth.START, same).settled(TIE)


def to(places: dict[int, BranchPlace[float]]):
    return lambda branch: places[branch.key]


def still(branch: Branch[float]) -> BranchPlace[float]:
    return BranchPlace(branch.value, branch.state)


def values(branches: Branches[float]) -> list[float]:
    return [b.value for b in branches]


def test_the_first_of_equal_minima_is_active():
    branches = begun((1.0, 0.0), (1.0, 5.0))
    assert [b.key for b in branches] == [0, 1]
    assert branches.active == branches.least.key == 0
    assert branches.changes == (Change(0, Birth.START), Change(1, Birth.START))
    assert branches.counts == BranchCounts(start=2)


@pytest.mark.parametrize(
    ("other", "active"),
    [
        (1.0 + 2.0 * TIE, 0),
        (1.0, 0),
        (1.0 - 0.99 * TIE, 0),
        (1.0 - 1.01 * TIE, 1),
        (-np.inf, 1),
    ],
)
def test_another_wins_when_it_is_less_by_more_than_the_tie(other, active):
    branches = begun((1.0, 0.0), (1.0, 5.0))
    values = {0: BranchPlace(1.0, 0.0), 1: BranchPlace(other, 5.0)}
    assert branches.carried(to(values), same).settled(TIE).active == active


def test_two_minima_that_change_places_within_the_tie_make_one_switch():
    """There and back by a little: the one that has won stays."""
    branches, active = begun((1.0, 0.0), (1.0, 5.0)), []
    for offset in (0.4, -0.4, -1.5, -0.4, 0.4, 0.9, -0.9, 1.5):
        values = {0: BranchPlace(1.0, 0.0), 1: BranchPlace(1.0 + offset * TIE, 5.0)}
        branches = branches.carried(to(values), same).settled(TIE)
        active.append(branches.active)
    assert active == [0, 0, 1, 1, 1, 1, 1, 0]


def test_of_two_that_meet_the_one_that_has_moved_less_stays():
    for moved, stays in (((0.1, 0.2), 0), ((0.2, 0.1), 1), ((0.1, 0.1), 0)):
        branches = begun((1.0, 0.0), (2.0, 5.0))
        meeting = {k: BranchPlace(1.5, 3.0, moved[k]) for k in (0, 1)}
        after = branches.carried(to(meeting), same).settled(TIE)
        assert [b.key for b in after] == [stays]
        assert after.changes == (Change(1 - stays, End.MERGED, stays),)
        assert after.counts == BranchCounts(start=2, merged=1)
        assert after.active == stays


def test_merging_hands_the_answer_over_though_a_third_is_within_the_tie():
    """The active one merges: what follows its minimum answers, and no other one."""
    branches = begun((1.0, 0.0), (1.0, 1.0), (1.0, 5.0))
    assert branches.active == 0
    meeting = {
        0: BranchPlace(1.0, 1.0, 0.3),
        1: BranchPlace(1.0, 1.0, 0.1),
        2: BranchPlace(1.0 - 0.5 * TIE, 5.0),
    }
    assert branches.carried(to(meeting), same).settled(TIE).active == 1


def test_many_that_meet_leave_one():
    branches = begun(*((float(k), float(k)) for k in range(5)))
    after = branches.carried(lambda b: BranchPlace(0.0, 7.0, abs(b.state - 2.2)), same).settled(TIE)
    assert [b.key for b in after] == [2]
    assert [change[:2] for change in after.changes] == [(k, End.MERGED) for k in (0, 1, 3, 4)]
    assert {change.into for change in after.changes} == {2}


def test_a_jump_ends_a_branch_and_begins_one():
    branches = begun((1.0, 0.0), (2.0, 5.0))
    after = branches.carried(
        to({0: BranchPlace(3.0, 9.0, 0.0, End.JUMPED), 1: BranchPlace(2.0, 5.0)}), same
    )
    assert [b.key for b in after] == [1, 2]
    assert after.changes == (Change(2, Birth.JUMP), Change(0, End.JUMPED, 2))
    assert after.active == NONE
    assert after.settled(TIE).active == 1


def test_a_jump_onto_a_minimum_that_is_followed_begins_none():
    branches = begun((1.0, 0.0), (2.0, 5.0))
    after = branches.carried(
        to({0: BranchPlace(2.0, 5.0, 0.0, End.JUMPED), 1: BranchPlace(2.0, 5.0)}), same
    )
    assert [b.key for b in after] == [1]
    assert after.changes == (Change(0, End.JUMPED, 1),)
    assert after.next_key == 2


def test_two_jumps_onto_one_minimum_begin_one():
    branches = begun((1.0, 0.0), (2.0, 5.0))
    after = branches.carried(lambda _: BranchPlace(3.0, 9.0, 0.0, End.JUMPED), same).settled(TIE)
    assert [b.key for b in after] == [2]
    assert [change.reason for change in after.changes] == [Birth.JUMP, End.JUMPED, End.JUMPED]
    assert {change.into for change in after.changes[1:]} == {2}


def test_what_leaves_its_minimum_and_what_is_lost_ends():
    branches = begun((1.0, 0.0), (2.0, 5.0), (3.0, 8.0))
    after = branches.carried(
        to(
            {
                0: BranchPlace(1.0, 0.0, 0.0, End.LEFT),
                1: BranchPlace(np.nan, 5.0),
                2: BranchPlace(3.0, 8.0),
            }
        ),
        same,
    ).settled(TIE)
    assert after.changes == (Change(0, End.LEFT), Change(1, End.LOST))
    assert after.active == 2
    assert after.counts == BranchCounts(start=3, left=1, lost=1)
    assert (after.counts.born, after.counts.ended) == (3, 2)


def test_the_last_one_gone_leaves_none():
    after = begun((1.0, 0.0)).ended([0, 0, 9], End.LEFT)
    assert (len(after), after.active) == (0, NONE)
    assert after.changes[1:] == (Change(0, End.LEFT),)
    assert after.settled(TIE).active == NONE
    with pytest.raises(LookupError, match="settle"):
        after.least  # noqa: B018


def test_found_ones_that_are_known_begin_no_branch():
    branches = begun((1.0, 0.0))
    after = branches.joined([(1.0, 1e-7), (0.5, 4.0), (0.5, 4.0)], Birth.SEARCH, same).settled(TIE)
    assert [b.key for b in after] == [0, 1]
    assert after.changes[1:] == (Change(1, Birth.SEARCH),)
    assert after.active == 1
    with pytest.raises(ArithmeticError, match="not a number"):
        branches.joined([(np.nan, 3.0)], Birth.PROOF, same)


def test_changes_are_of_one_frame_and_counts_of_all():
    branches = begun((1.0, 0.0)).carried(still, same)
    assert (branches.changes, branches.counts) == ((), BranchCounts(start=1))
    branches = branches.joined([(2.0, 3.0)], Birth.PROOF, same)
    assert [c.reason for c in branches.changes] == [Birth.PROOF]
    assert branches.at_frame().changes == ()
    assert branches.at_frame().counts == BranchCounts(start=1, proof=1)


def test_every_reason_is_counted_by_its_name_and_has_a_sentence():
    counts = BranchCounts()
    for reason in (*Birth, *End):
        counts = counts.with_one(reason)
        assert counts.of(reason) == 1
        assert reason.sentence.endswith(".")
    assert len({reason.sentence for reason in (*Birth, *End)}) == len(counts) == 10
    assert set(counts) == {1}
    assert (counts.born, counts.ended) == (len(Birth), len(End))


def drawn(rng: np.random.Generator, n: int) -> dict[int, BranchPlace[float]]:
    """Where branches go, some of them to one place."""
    places = np.round(rng.uniform(0.0, 3.0, n))
    ends = rng.choice(np.array([None, None, None, End.JUMPED, End.LEFT]), n)
    return {
        k: BranchPlace(float(10.0 - x), float(x), float(rng.integers(3)), ends[k])
        for k, x in enumerate(places.tolist())
    }


def test_the_order_of_branches_does_not_matter(rng):
    """Handed over in any order, the same branches, changes and answer come out."""
    begin = begun((3.0, 10.0), (2.0, 11.0), (2.0, 12.0), (4.0, 13.0))
    for _ in range(40):
        places = drawn(rng, len(begin))
        due = begin.carried(to(places), same).settled(TIE)
        for order in permutations(begin.branches):
            mixed = Branches(order, begin.active, begin.next_key, (), begin.counts)
            after = mixed.carried(to(places), same).settled(TIE)
            assert after.branches == due.branches
            assert (after.changes, after.counts) == (due.changes, due.counts)
            assert after.active == due.active


def test_two_branches_may_change_names(rng):
    """With the keys of two exchanged, the same minima are followed and the same one answers."""
    for _ in range(200):
        moved = rng.permutation(3).astype(float)  # no two alike, so that age does not decide
        ways = {
            k: BranchPlace(float(rng.integers(3)), float(rng.integers(3)), moved[k])
            for k in range(3)
        }
        other = {0: ways[1], 1: ways[0], 2: ways[2]}
        one = begun((1.0, 10.0), (2.0, 11.0), (3.0, 12.0)).carried(to(ways), same)
        two = begun((2.0, 11.0), (1.0, 10.0), (3.0, 12.0)).carried(to(other), same)
        names = {0: 1, 1: 0, 2: 2, NONE: NONE}
        assert {(names[b.key], b.value, b.state) for b in one} == {tuple(b) for b in two}
        assert names[one.active] == two.active
        assert {(names[c.key], c.reason, names[c.into]) for c in one.changes} == set(two.changes)


def test_the_order_in_which_minima_are_found_does_not_matter():
    found = [(3.0, 0.0), (1.0, 1.0), (2.0, 2.0), (1.0 - 1e-9, 3.0)]
    for order in permutations(found):
        branches = begun(*order)
        assert sorted(values(branches)) == sorted(v for v, _ in found)
        assert branches.least.value == 1.0 - 1e-9


def test_branches_are_a_value():
    branches = begun((1.0, 0.0), (2.0, 5.0))
    before = branches.branches, branches.active, branches.changes, branches.counts
    branches.carried(lambda _: BranchPlace(0.0, 0.0), same).ended([0], End.LEFT).settled(TIE)
    branches.joined([(0.0, 8.0)], Birth.PROOF, same)
    assert (branches.branches, branches.active, branches.changes, branches.counts) == before
    with pytest.raises(AttributeError):
        branches.active = 1  # type: ignore[misc]
    again = pickle.loads(pickle.dumps(branches))
    assert (again.branches, again.active, again.changes, again.counts) == before


def double_well(t: float) -> np.polynomial.Polynomial:
    """Two minima of (x² - 1)² + slope·x, one of which goes where |slope| > 1.54."""
    return np.polynomial.Polynomial([1.0, 2.0 * np.sin(t), -2.0, 0.0, 1.0])


def minima_of(f: np.polynomial.Polynomial) -> list[float]:
    roots = [r.real for r in f.deriv().roots() if abs(r.imag) < 1e-9]
    return [x for x in roots if f.deriv(2)(x) > 0.0]


def test_a_double_well_is_followed_as_its_minima_come_and_go():
    """Against all roots of the derivative: the least to roundoff, each end and birth where one is.

    A minimum goes as it meets the maximum between the two; its branch slides down to the other.
    """

    def follow_in(f):
        _, b, c, _, e = f.coef.tolist()

        def follow(branch):
            x = branch.state
            for _ in range(2000):  # steepest descent, which stays in its own basin
                x -= 0.02 * (b + 2.0 * c * x + 4.0 * e * x**3)
            for _ in range(5):
                x -= f.deriv()(x) / f.deriv(2)(x)
            return BranchPlace(float(f(x)), float(x), abs(x - branch.state))

        return follow

    f = double_well(0.0)
    branches = Branches[float]().joined([(f(x), x) for x in minima_of(f)], Birth.START, same)
    branches, numbers = branches.settled(TIE), []
    for t in np.linspace(0.0, 2.0 * np.pi, 126)[1:]:
        f = double_well(float(t))
        truth = minima_of(f)
        branches = branches.carried(follow_in(f), same)
        branches = branches.joined([(f(x), x) for x in truth], Birth.SEARCH, same).settled(TIE)
        np.testing.assert_allclose(sorted(b.state for b in branches), sorted(truth), atol=1e-9)
        assert branches.least.value <= min(f(x) for x in truth) + TIE
        numbers.append(len(truth))
    gone = sum(b < a for a, b in zip([2, *numbers], numbers, strict=False))
    come = sum(b > a for a, b in zip([2, *numbers], numbers, strict=False))
    assert gone == come == 2
    assert branches.counts == BranchCounts(start=2, search=come, merged=gone)


def test_any_mixture_of_ends_is_counted_once(rng):
    """As many branches as were born and have not ended; no key twice; every end is told."""
    for n, _ in product((1, 2, 5, 9), range(50)):
        begin = begun(*((float(k), 100.0 + k) for k in range(n)))
        after = begin.carried(to(drawn(rng, n)), same).settled(TIE)
        assert len(after) == after.counts.born - after.counts.ended
        keys = [b.key for b in after]
        assert keys == sorted(set(keys))
        told = [c.key for c in after.changes if isinstance(c.reason, End)]
        assert sorted([*told, *(k for k in keys if k < n)]) == list(range(n))
        assert after.active in keys or (not keys and after.active == NONE)
