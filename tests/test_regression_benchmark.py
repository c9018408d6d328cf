"""What the comparison of two commits calls slower: a change, and not the noise."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from benchmarks.regression import WORK, Row, judged, table

import standoff as so

STEADY = (10.0, 10.2, 9.9, 10.1, 10.0, 9.8, 10.3)
NOISY = (10.4, 9.7, 10.1, 9.9, 10.2, 9.6, 10.0)


def times(factor):
    return tuple(factor * t for t in STEADY)


@pytest.mark.parametrize(
    ("after", "verdict"),
    [
        (times(1.1), "slower"),
        (times(0.9), "faster"),
        (times(1.02), ""),
        (NOISY, ""),
        # twice the time in two rounds of seven is a disturbed machine
        ((10.0, 20.4, 9.9, 10.1, 20.0, 9.8, 10.3), ""),
        # the middle is 9 % above, but three rounds say the contrary
        ((11.0, 11.2, 10.9, 11.1, 9.0, 9.1, 9.2), ""),
        # a drift of the machine that both commits share
        ((*tuple(1.1 * t for t in STEADY[:6]), 9.0), "slower"),
    ],
    ids=["slower", "faster", "too little", "noise", "disturbed", "no agreement", "one round apart"],
)
def test_a_change_is_told_from_noise(after, verdict):
    assert judged(Row("work", STEADY, after, True)) == verdict


def test_the_table_says_where_answers_differ():
    rows = [Row("same", STEADY, STEADY, True), Row("other", STEADY, times(2.0), False)]
    head, _, same, other = table(rows, "A", "B").splitlines()
    assert head.startswith("| work | A | B |")
    assert same.endswith("| yes |")
    assert "| 1.000 |" in same
    assert other.endswith("| **no** |")
    assert "| 2.000 |" in other
    assert "slower" in other


def test_the_work_runs_as_a_script_from_another_folder(tmp_path):
    """As `worked` runs it on either commit: with that commit's sources, and not this folder's."""
    settings = {**os.environ, "PYTHONPATH": str(Path(so.__file__).parents[1])}
    done = subprocess.run(
        [sys.executable, str(WORK), "boxes in contact"],
        env=settings,
        cwd=tmp_path,
        check=True,
        stdout=subprocess.PIPE,
        text=True,
    )
    rows = {name: float(time) for name, time, _ in json.loads(done.stdout)}
    assert "boxes in contact: a frame of Tracker.run, ns" in rows
    assert min(rows.values()) > 0.0
