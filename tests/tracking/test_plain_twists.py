"""A twist given as six plain numbers: read as a Twist of them, and refused as one."""

import numpy as np
import pytest

import standoff as so

BODIES = so.shapes.ellipsoid(0.5, 0.9, 0.7), so.shapes.lens(1.0, 0.5)
REST, AWAY = np.eye(4), so.Pose(np.eye(3), [2.0, 0.3, 0.1])


@pytest.mark.parametrize(
    "form",
    [
        lambda x: x,
        lambda x: x.tolist(),
        lambda x: (x[:3], x[3:]),
        lambda x: np.repeat(x, 2)[::2],
        lambda x: x.astype(np.float32),
    ],
    ids=["array", "list", "pair", "strided", "float32"],
)
def test_all_forms_give_the_same_answer(form, rng):
    tracker = so.Tracker(*BODIES)
    twists = rng.normal(size=(2, 6)).astype(np.float32).astype(float)
    as_twists = [so.Twist(x[:3], x[3:]) for x in twists]
    wanted = tracker.step(tracker.start(REST, AWAY, *as_twists), REST, AWAY, *as_twists)[1]
    given = [form(x) for x in twists]
    found = tracker.step(tracker.start(REST, AWAY, *given), REST, AWAY, *given)[1]
    assert found.rate == wanted.rate != 0.0
    assert (found.velocity_b == wanted.velocity_b).all()


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_numbers_that_are_not_finite_are_refused(bad):
    tracker = so.Tracker(*BODIES)
    state = tracker.start(REST, AWAY)
    with pytest.raises(ValueError, match=r"[Tt]wist"):
        tracker.step(state, REST, AWAY, np.array([0.0, 0.0, bad, 0.0, 0.0, 0.0]))


def test_a_masked_twist_is_refused():
    tracker = so.Tracker(*BODIES)
    state = tracker.start(REST, AWAY)
    with pytest.raises(ValueError, match="mask"):
        tracker.step(state, REST, AWAY, np.ma.masked_array(np.zeros(6), mask=[1, 0, 0, 0, 0, 0]))
