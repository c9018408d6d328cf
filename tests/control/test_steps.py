"""What two steps do to a pair's errors: by hand on a circle, by runs, and what is refused."""

import warnings

import numpy as np
import pytest

import standoff as so
from standoff import control
from standoff.errors import GainWarning
from standoff_studies.paper.control.lower import beside, circle, cycle, levels, tracker

HOME = so.Pose.identity()
POINT = so.shapes.point()


@pytest.mark.parametrize("gain", [400.0, 1500.0, 1990.0])
@pytest.mark.parametrize("integrator", ["euler", "heun", "midpoint", "rk4"])
def test_small_errors_grow_by_the_growth_factor(integrator: str, gain: float) -> None:
    found = control.step_growth(tracker(integrator, gain), HOME, beside(), levels())
    small = abs(control.growth_factor(integrator, -1e-3 * gain)) ** 2
    assert found.growth[0] == pytest.approx(small, abs=1e-4)


def test_what_settles_ends_where_a_step_turns_the_error_round() -> None:
    """sqrt(2 V) = D sin x on the circle, D = 2: the last that falls is next to tan x / x = 2/z."""
    for gain in (1500.0, 1900.0, 1999.0):
        found = control.step_growth(tracker("euler", gain), HOME, beside(), levels())
        angles = np.arcsin(found.slopes / 2.0)
        np.testing.assert_array_equal(found.growth < 1.0, angles < cycle(gain))


def test_levels_of_another_pair_are_refused() -> None:
    law = tracker("euler", 1500.0)
    elsewhere = so.Pose(np.eye(3), (0.0, 2.0, 0.0))
    with pytest.raises(ValueError, match="another pair or pose"):
        control.step_growth(law, HOME, elsewhere, levels())
    with pytest.raises(TypeError, match="is not a Tracker"):
        control.step_growth("law", HOME, beside(), levels())
    with pytest.raises(TypeError, match="is not a LyapunovLevels"):
        control.step_growth(law, HOME, beside(), 0.3)


def test_a_gain_just_below_the_limit_is_warned_of_at_the_user_s_line() -> None:
    with pytest.warns(GainWarning, match=r"errors by 0\.999001 in magnitude") as told:
        so.Tracker(circle(), POINT, law=so.PaperLaw(gain=1999.0))
    assert told[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for gain in (0.5, 1000.0, 1500.0):
            so.Tracker(circle(), POINT, law=so.PaperLaw(gain=gain))
        so.Tracker(circle(), POINT, law=so.PaperLaw(feedback=so.feedback.MotionGain(1e-3)))
