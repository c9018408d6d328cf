"""The soak's worlds, a few of them: every pair of every frame judged, and that a judge can fail."""

import pytest

from draws import draws
from standoff_studies.soak import world_checks
from standoff_studies.soak.drawn_worlds import draw_world
from standoff_studies.soak.tally import Tally


def test_every_pair_of_drawn_worlds_is_right() -> None:
    tally = Tally()
    for number in range(draws(12)):
        counted, faults = world_checks.run_world(7, number, 20)
        tally.add(counted)
        assert not faults, (number, faults[:3])
    assert tally.sums["near pair-frames"] > 500
    assert tally.sums["minima"] > 50


@pytest.mark.parametrize(
    ("where", "wrong", "what"),
    [
        ("lower", lambda x: x + 1.0, "the lower bound is above the distance"),
        ("upper", lambda x: x - 1e3, "the upper bound is below the distance"),
        ("distance", lambda x: x + 1e-3, "the distance is not that of a query"),
        ("near", lambda x: x & False, "a pair below its horizon is missed"),
    ],
)
def test_the_judge_can_fail(monkeypatch: pytest.MonkeyPatch, where, wrong, what) -> None:
    chapter = next(
        chapter
        for number in range(40)
        for chapter in draw_world(7, number, 4)
        if len(chapter.counted) > 20 and chapter.flight.poses[..., :3, 3].max() < 1e3
    )
    answers = [chapter.world.answer(state) for state in world_checks.answered(chapter)]
    assert any(len(answer.pairs) for answer in answers)
    assert not world_checks.judge(chapter, answers, Tally())
    true = world_checks._Checks.told

    def told(self):
        found = true(self)
        return found._replace(**{where: wrong(getattr(found, where))})

    monkeypatch.setattr(world_checks._Checks, "told", told)
    faults = world_checks.judge(chapter, answers, Tally())
    assert what in {fault.what for fault in faults}
