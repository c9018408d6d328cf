"""What the rows of the promises rest on, changed: each quotation is turned by the change it names.

The changes are in broken_on_purpose.changes, which prints what they turn; here each is made once.
"""

from __future__ import annotations

import pytest

from standoff_studies.paper.promises import PROMISES

ROWS = [row for rows in PROMISES.values() for row in rows]
CASES = sorted({(one.key, one.turned_by) for row in ROWS for one in row.shown if one.turned_by})
"""A figure or page, and a change of it."""

QUICK = {
    ("2", "a place beside the foot"),
    ("arrivals", "half as many arrive"),
    ("../automaton.md", "a lens for the ellipsoid"),
    ("../certificate.md", "one face turned"),
    ("../laws.md", "gain halved"),
    ("../pair-system.md", "first fundamental forms for H"),
    ("../pair-system.md", "missing parameters not held"),
    ("../penetration.md", "depth='local'"),
    ("../penetration.md", "distances without a sign"),
}
"""Changes that are tried in every run; the others are for `make soak`."""


@pytest.mark.parametrize(
    ("key", "by"),
    [
        pytest.param(*case, id="-".join(case), marks=[] if case in QUICK else [pytest.mark.soak])
        for case in CASES
    ],
)
def test_each_quotation_is_turned(key: str, by: str) -> None:
    from standoff_studies.paper.broken_on_purpose.changes import turned_by

    found = turned_by(key, by)
    assert found.turned
    assert [one.text for one in found.unturned] == []


def test_every_row_is_turned_by_a_change() -> None:
    """What no change turns says why, and no row rests on it alone."""
    from standoff_studies.paper.broken_on_purpose.breaks import BREAKS
    from standoff_studies.paper.broken_on_purpose.changes import CHANGES

    named = {case for case in CHANGES if case[1] not in {one.key for one in BREAKS}}
    assert named <= {*CASES} <= {*CHANGES}
    quoted = {one for row in ROWS for one in row.shown}
    assert [one.text for one in quoted if bool(one.turned_by) == bool(one.fixed)] == []
    assert [row.says for row in ROWS if not any(one.turned_by for one in row.shown)] == []
    assert {*QUICK} <= {*CASES}


@pytest.mark.parametrize("words", ["1 face", "not unique", "Newton step", "flat", "kinds", "depth"])
def test_words_of_a_page_are_so(words: str) -> None:
    from standoff_studies.paper.broken_on_purpose.pages import CHECKS

    (check,) = (check for part, check in CHECKS.items() if words in part)
    assert check()


@pytest.mark.soak
@pytest.mark.parametrize("words", ["never", "jumps", "missed", "bounds", "hold a local minimum"])
def test_words_of_a_page_are_so_too(words: str) -> None:
    """Those that take longer."""
    test_words_of_a_page_are_so(words)
