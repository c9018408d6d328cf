"""What is broken on purpose the report says: the law, the gain, a normal's sign, a reset."""

from __future__ import annotations

from dataclasses import replace

import pytest

from standoff.recording.simulate import track_along
from standoff.recording.times import even_times
from standoff.tracking import Tracker
from standoff.tracking.laws import PaperLaw
from standoff_studies.paper.catalogue import chosen, make
from standoff_studies.paper.figure import Entry, Statement
from standoff_studies.paper.simulation_b import run as b
from standoff_studies.paper.simulation_b import snapshots as snapshots_b
from standoff_studies.paper.simulation_b.printed import Printed
from standoff_studies.paper.simulation_c import regions as regions_c
from standoff_studies.paper.simulation_c import run as c
from standoff_studies.paper.simulation_e import parameters as parameters_e
from standoff_studies.paper.simulation_e import runs as e
from standoff_studies.paper.verdicts import Verdict


def saying(statements: tuple[Statement, ...], words: str) -> Statement:
    (found,) = (statement for statement in statements if words in statement.stated)
    return found


def decay_of(printed: Printed) -> Statement:
    """Simulation B's statement on the decay of the errors, of another run."""
    broken = b.run()._replace(paper=printed.run(b.WRONG_START))
    return saying(snapshots_b._statements(broken), "decay as exp")


def printed_at(gain: float) -> Printed:
    run = b.run()
    return Printed(run.body, run.regions, run.path, run.printed.times, gain)


def test_another_law_is_told() -> None:
    """Without the feedforward the errors come to b/K instead of falling as exp(-K t)."""
    printed = printed_at(b.GAIN)
    assert Verdict.of(decay_of(printed)) is Verdict.HOLDS
    law = replace(printed.parallel.law, feedforward=False)
    printed.parallel = Tracker(printed.body, printed.parallel.b, 1e-3, law=law)
    assert Verdict.of(decay_of(printed)) is Verdict.FAILS


def test_another_gain_is_told() -> None:
    assert Verdict.of(decay_of(printed_at(1.2 * b.GAIN))) is Verdict.FAILS


def test_a_normal_of_the_wrong_sign_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """External lines that go inwards: the switches are no longer on them."""
    words = "where the opposing witness point crosses"
    assert saying(regions_c._statements(c.run()), words).holds is True
    turned = tuple(
        replace(
            one,
            external=tuple(line._replace(directions=-line.directions) for line in one.external),
        )
        for one in regions_c.regions()
    )
    monkeypatch.setattr(regions_c, "regions", lambda: turned)
    assert Verdict.of(saying(regions_c._statements(c.run()), words)) is Verdict.FAILS


def test_an_exact_reset_is_told() -> None:
    """Entering edges at the foot point, as a solve finds it, is no longer the printed system."""
    runs, words = e.run(), "no search, restart or exact solution"
    assert saying(parameters_e._as_printed(runs), words).holds is True
    law = replace(PaperLaw.as_printed(gain=e.GAIN), reset="foot")
    tracker = Tracker(runs.a, runs.b, e.STEP, law=law)
    times = even_times(0.0, 1.2, e.STEP)
    other = track_along(tracker, e.PATH_A, e.PATH_B, times, state=e.begin(tracker, *e.START))
    broken = replace(runs, paper=other)
    assert Verdict.of(saying(parameters_e._as_printed(broken), words)) is Verdict.FAILS


@pytest.mark.parametrize("entry", chosen(["all"]), ids=lambda entry: entry.key)
def test_every_statement_names_its_law(entry: Entry) -> None:
    """All that "standoff paper all" makes: figures, chapters and what is beyond the paper."""
    for statement in make(entry).statements:
        assert statement.by, statement.measured
        if statement.constructed:
            assert statement.why, "says why it cannot fail"
