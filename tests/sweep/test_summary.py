"""Totals, histograms and lists against plain NumPy over all rows."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from standoff.kernels.state import arrays as K
from standoff.sweep.job import Job
from standoff.sweep.keep import Bins, Keep
from standoff.sweep.rows import Rows
from standoff.sweep.shard import NotThisShard, read_shard, text_of_shard
from standoff.sweep.summary import Summary, exact_sum
from standoff.tracking.status import BY_NUMBER, Status
from sweep.conftest import JOB, Make

Array = NDArray[np.float64]


def whole(job: Job) -> Summary:
    """The summary of all shards, each by way of its file's text."""
    found = Summary(job.keep)
    for k in range(job.shards):
        text = text_of_shard(job, "code", k, job.computed(k))
        found.add(read_shard(job, "code", k, text.encode()))
    return found


def test_totals_of_a_job(make: Make) -> None:
    job = make()
    found = whole(job)
    answers = job.distances(0, job.rows)
    d, low = answers.distance, answers.lower_bound
    names = [status.name for status in answers.status]
    assert found.rows == job.rows == 3000
    assert {s.name: n for s, n in zip(BY_NUMBER, found.statuses, strict=True) if n} == {
        name: names.count(name) for name in set(names)
    }
    assert len(set(names)) == 2  # apart and in contact
    assert found.certified == int(answers.certified.sum())
    for spread, values in ((found.distance, d), (found.lower_bound, low)):
        assert spread.count == 3000
        assert spread.sum == pytest.approx(math.fsum(values), rel=1e-15)
        assert (spread.least, spread.least_row) == (values.min(), values.argmin())
        assert (spread.most, spread.most_row) == (values.max(), values.argmax())
    assert job.keep.bins is not None
    counts, edges = np.histogram(d[d < 5.0], bins=50, range=(0.0, 5.0))
    np.testing.assert_allclose(job.keep.bins.edges, edges, atol=1e-15)
    assert np.array_equal(found.bins, counts)
    assert found.outside.tolist() == [(d < 0.0).sum(), (d >= 5.0).sum(), 0]
    order = np.argsort(d, kind="stable")[:40]
    assert np.array_equal(found.worst.row, order)
    assert np.array_equal(found.worst.distance, d[order])
    assert np.array_equal(found.worst.lower_bound, low[order])
    below = np.flatnonzero(low < 0.5)
    assert found.below.count == len(below) > 100
    assert np.array_equal(found.below.rows.row, below[:100])


def made_up(n: int) -> Array:
    """Answers with ties, nan, infinities and all statuses."""
    rng = np.random.default_rng(8)
    rows = np.full((n, K.N_OUT), np.nan)
    rows[:, K.DISTANCE] = rng.integers(-3, 12, n) / 4.0
    rows[:, K.LOWER_BOUND] = rows[:, K.DISTANCE] - rng.integers(0, 2, n)
    rows[:, K.STATUS] = rng.integers(0, len(BY_NUMBER), n)
    rows[rng.random(n) < 0.1, K.DISTANCE] = np.nan
    rows[rng.random(n) < 0.05, K.LOWER_BOUND] = -np.inf
    rows[rng.random(n) < 0.05] = np.nan
    return rows


@pytest.mark.parametrize("parts", [[1000], [1, 999], [300, 300, 400], [10] * 100])
def test_any_division_gives_the_same(parts: list[int]) -> None:
    keep = Keep(30, 0.3, 45, Bins(-0.5, 2.25, 11))
    rows, found, at = made_up(1000), Summary(keep), 0
    for n in parts:
        part = Summary(keep)
        for start in range(at, at + n, 100):
            part.add_rows(Rows.of(start, rows[start : min(start + 100, at + n)]))
        found.add(Summary.from_facts(part.facts(), keep))
        at += n
    d, low = rows[:, K.DISTANCE], rows[:, K.LOWER_BOUND]
    known = ~np.isnan(d)
    status = np.where(np.isnan(rows[:, K.STATUS]), Status.REFUSED.value, rows[:, K.STATUS])
    proven = np.array([BY_NUMBER[int(k)].certified for k in status])
    assert (found.rows, found.certified) == (1000, proven.sum())
    assert np.array_equal(found.statuses, np.bincount(status.astype(int), minlength=14))
    # quarters are added up without rounding
    assert (found.distance.count, found.distance.sum) == (known.sum(), d[known].sum())
    assert found.distance.least == d[known].min()
    assert found.distance.least_row == np.nanargmin(d)
    assert found.distance.most_row == np.nanargmax(d)
    finite = np.isfinite(low)
    assert (found.lower_bound.count, found.lower_bound.sum) == (finite.sum(), low[finite].sum())
    expected = np.histogram(d[known & (d < 2.25)], bins=11, range=(-0.5, 2.25))[0]
    assert np.array_equal(found.bins, expected)
    assert found.outside.tolist() == [(d < -0.5).sum(), (d >= 2.25).sum(), (~known).sum()]
    order = np.lexsort((np.arange(1000), np.where(known, d, np.inf)))[:30]
    assert np.array_equal(found.worst.row, order)
    below = np.flatnonzero(~(low >= 0.3))
    assert found.below.count == len(below)
    assert np.array_equal(found.below.rows.row, below[:45])
    assert np.array_equal(found.uncertified.rows.row, np.flatnonzero(~proven))


def test_the_worst_of_many_blocks() -> None:
    """Most rows are passed over, by a limit that sinks from block to block."""
    keep, rows = Keep(7), np.zeros((5000, K.N_OUT))
    d = rows[:, K.DISTANCE] = np.random.default_rng(9).normal(size=5000)
    found = Summary(keep)
    for start in range(0, 5000, 50):
        found.add_rows(Rows.of(start, rows[start : start + 50]))
    order = np.argsort(d)[:7]
    assert np.array_equal(found.worst.row, order)
    assert np.array_equal(found.worst.distance, d[order])


def test_a_sum_is_exact_in_each_block() -> None:
    rows = np.zeros((3, K.N_OUT))
    rows[:, K.DISTANCE] = [1e16, 1.0, -1e16]
    found = Summary(Keep())
    found.add_rows(Rows.of(0, rows))
    assert found.distance.sum == 1.0


def changed(text: str, key: str, value: Any) -> str:
    import json

    facts = json.loads(text)
    facts[key] = value
    return json.dumps(facts)


def test_a_damaged_shard_is_refused(make: Make) -> None:
    job = make(JOB.replace("rows = 3000", "rows = 1000"))
    text = text_of_shard(job, "code", 1, job.kept(700, 1000))
    assert read_shard(job, "code", 1, text.encode()).rows == 300
    for broken in (text[:-30], "", "[]", "3", changed(text, "rows", 301), "\x00" * len(text)):
        with pytest.raises(NotThisShard):
            read_shard(job, "code", 1, broken.encode())
    at = text.index('"max": ') + 8
    digit = "1" if text[at] != "1" else "2"
    with pytest.raises(NotThisShard, match="checksum"):
        read_shard(job, "code", 1, (text[:at] + digit + text[at + 1 :]).encode())
    for code, k, told in (("other", 1, "its code"), ("code", 0, "its shard")):
        with pytest.raises(NotThisShard, match=told):
            read_shard(job, code, k, text.encode())
    other = make(JOB.replace("rows = 3000", "rows = 1000").replace("seed = 5", "seed = 6"))
    with pytest.raises(NotThisShard, match="its job"):
        read_shard(other, "code", 1, text.encode())


def test_sums_are_rounded_once() -> None:
    """Those of `math.fsum`, bit for bit: of magnitudes far apart, of what cancels, of few."""
    rng = np.random.default_rng(0)
    for k in range(600):
        n = 8192 if k % 100 == 0 else int(rng.integers(0, 200))
        reach = (1, 20, 300)[k % 3]
        values = rng.normal(size=n) * 10.0 ** rng.uniform(-reach, reach, n)
        if k % 4 == 0:
            slight = 1.0 + rng.choice([0.0, 1e-16, 1e-8])
            values = np.concatenate([values, -values[::-1] * slight])
        if k % 5 == 0:
            values[rng.random(len(values)) < 0.5] = 0.0
        assert exact_sum(values) == math.fsum(values.tolist())


def test_many_bins_and_numbers_at_their_ends() -> None:
    bins = Bins(0.1, 0.7, 6)
    values = np.concatenate([bins.edges, np.nextafter(bins.edges, -1.0), [np.nan, -5.0, 9.0]])
    whole_numbers = np.arange(len(values))
    found = Summary(Keep(worst=1, bins=bins))
    none = np.full(len(values), -1)
    found.add_rows(Rows(whole_numbers, values, values, np.zeros(len(values), np.int64), none))
    assert found.bins.tolist() == [2] * 6
    assert found.outside.tolist() == [2, 2, 1]
