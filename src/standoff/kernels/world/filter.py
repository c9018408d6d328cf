"""Which pairs of bodies count."""

from typing import Any, NamedTuple

from standoff.kernels.compiler.decorators import kernel


class Filter(NamedTuple):
    """Rules by kind of body, and single pairs of bodies that are left out; pointers."""

    kinds: Any  # of each body: its number among the kinds
    n_kinds: int
    meets: Any  # n_kinds by n_kinds: 1 where two kinds meet
    left_out: Any  # i n + j of pairs i < j that do not count, sorted
    n_left_out: int
    n_bodies: int


@kernel
def position(sorted_numbers, n, number):
    """Where a number stands among n sorted ones, or would stand."""
    first, end = 0, n
    while first < end:
        middle = (first + end) // 2
        if sorted_numbers[middle] < number:
            first = middle + 1
        else:
            end = middle
    return first


@kernel
def counts(rules, i, j):
    """Does the pair of bodies i, j count?"""
    if i == j or rules.meets[rules.kinds[i] * rules.n_kinds + rules.kinds[j]] == 0:
        return False
    if rules.n_left_out == 0:
        return True
    key = min(i, j) * rules.n_bodies + max(i, j)
    at = position(rules.left_out, rules.n_left_out, key)
    return not (at < rules.n_left_out and rules.left_out[at] == key)
