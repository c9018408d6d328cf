"""Which cases are tried in every run."""

import pytest

from shares import only, share


def every_run(cases):
    """The values of those that are not marked, as tuples."""
    return {
        each.values if hasattr(each, "values") else (each,)
        for each in cases
        if not getattr(each, "marks", ())
    }


def test_what_is_kept_is_tried_and_the_others_are_still_there() -> None:
    cases = only(["b"], "abc")
    assert len(cases) == 3
    assert every_run(cases) == {("b",)}
    assert [mark.name for mark in cases[0].marks] == ["soak"]


def test_a_share_tries_every_value() -> None:
    cases = share(2, range(4), "ab")
    assert len({each.values for each in cases}) == 8
    assert every_run(cases) == {(0, "a"), (1, "b"), (2, "a"), (3, "b")}
    assert every_run(share(3, range(5), "abc")) >= {(0, "a"), (1, "c"), (2, "b"), (4, "c")}


def test_a_value_that_would_not_be_tried_is_refused() -> None:
    with pytest.raises(ValueError, match="would not be tried"):
        share(3, range(9), "ab")
    with pytest.raises(ValueError, match="kept by"):
        only(["d"], "abc")
    with pytest.raises(ValueError, match="kept by"):
        only([], "abc")
