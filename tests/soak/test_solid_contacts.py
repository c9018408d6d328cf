"""The soak of solids that fall on each other: what it judges, and that a planted fault is seen."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from standoff.solids import distance
from standoff.tracking.status import Status
from standoff_studies.soak.solid_contacts import (
    BLOCK,
    LOOKED_FOR,
    STRETCH,
    compared,
    falling,
    judged,
    judged_fall,
)
from standoff_studies.soak.solid_pairs import made
from standoff_studies.soak.solid_parts import MAKERS
from standoff_studies.soak.solid_poses import pairs_of


def test_a_fall_is_judged() -> None:
    verdict, lines = judged_fall(0, 1, [("plate", "pin")], 600)
    assert lines == []
    assert verdict.sound
    assert verdict.ticks >= 200
    assert verdict.sampled == verdict.ticks // STRETCH
    assert verdict.overlaps > 0
    assert verdict.lost == verdict.jumps == verdict.uncertified == 0
    assert "0 wrong" in str(verdict)


def test_planted_faults_are_seen(rng: np.random.Generator) -> None:
    a, b = (made(name)[1] for name in ("plate", "brick"))
    operator = falling(a, b, rng)
    below = LOOKED_FOR * operator.system.depth(0)
    state = operator.start()
    for _ in range(100):
        state = operator.run(state, 5, 5).final
        if state.contact(0).spots:
            break
    contact = state.contact(0)
    cold = distance(a, b, state.pose(0), state.pose(1), minima=below)
    assert cold.status is Status.OVERLAPPING
    assert judged(a, b, state, below) == compared(contact, cold, below, 1e-9)
    sound, lines = compared(contact, cold, below, 1e-9)
    assert (sound.wrong, sound.lost, lines) == (0, 0, [])
    silent = contact._replace(spots=())
    assert compared(silent, cold, below, 1e-9)[0].wrong == 1
    # where it is told that some were not looked for, nobody is misled
    assert compared(silent._replace(complete=False), cold, below, 1e-9)[0].wrong == 0
    missed = contact._replace(places=())
    assert compared(missed, cold, below, 1e-9)[0].lost == sound.minima > 0
    elsewhere = replace(cold, minima=(cold.minima[0]._replace(distance=-0.5 * below),))
    assert compared(contact, elsewhere, below, 1e-9)[0].lost == 1


@pytest.mark.parametrize(("block", "least"), [(108, 10), (246, 10), (265, 3)])
def test_falls_whose_normals_were_once_lost(block: int, least: int) -> None:
    """Common normals above 0 that rested for half of their distance had left their leaves, unseen,
    when the solids met; one that came from the next face was looked for from the middles of leaves
    that bend both ways."""
    verdict, lines = judged_fall(block, 2, pairs_of(list(MAKERS)), BLOCK)
    assert lines == []
    assert verdict.minima > least
    assert verdict.wrong == verdict.lost == verdict.jumps == verdict.uncertified == 0
