"""Times of impact where rounding counts: pieces of time of a few roundings, and far arms."""

import math
from typing import Any

import mpmath
import numpy as np
import pytest

import standoff as so
from standoff.impact.moment import BodyBox
from standoff.kernels.body import layout as L
from standoff.motion import Bounded, Carried, ConstantTwist, Fixed, Offset, PoseSamples, Screw

REST = so.Pose.identity()


def at(*position: float) -> so.Pose:
    return so.Pose.exp([0.0, 0.0, 0.0], position)


def along_x(times: Any, places: Any) -> PoseSamples:
    return PoseSamples(times, [at(float(x), 0.0, 0.0) for x in places])


def test_a_piece_of_time_of_a_few_roundings_is_searched_as_any_other() -> None:
    """0.1 + 0.2 is one rounding after the sample at 0.3."""
    ball = so.shapes.sphere(0.1)
    moving = along_x([0.0, 0.1, 0.2, 0.3, 0.4], [0.0, 0.001, 0.002, 0.003, 0.004])
    found = so.time_of_impact(ball, ball, moving, at(1.0, 0.0, 0.0), 0.2, start=0.1)
    assert (found.status, found.time) == (so.impact.ImpactStatus.NO_IMPACT, 0.1 + 0.2)
    # two clocks of ten samples a second, 0.1 k and its running sum; they meet after 0.75 s
    clock = np.arange(11) * 0.1
    summed = np.cumsum(np.full(11, 0.1)) - 0.1
    assert 0.0 < np.abs(summed - clock).max() < 1e-15
    paths = along_x(clock, clock), along_x(summed, 1.7 - summed)
    found = so.time_of_impact(ball, ball, *paths, float(min(clock[-1], summed[-1])))
    assert found.status is so.impact.ImpactStatus.IMPACT
    assert 0.75 - 1e-8 < found.time <= 0.75 <= found.latest


def test_logs_of_a_far_epoch_with_clocks_of_their_own(rng: np.random.Generator) -> None:
    ball = so.shapes.sphere(0.1)
    for _ in range(10):
        times = 1.7e9 + np.cumsum(rng.normal(1e-2, 2e-4, 60)), 1.7e9 + np.arange(1, 60) / 100.0
        # a sample of each within a few roundings of one of the other (2.4e-7 s)
        times[1][10:50:5] = times[0][10:50:5] + rng.integers(-4, 5, 8) * math.ulp(1.7e9)
        paths = [along_x(np.sort(t), [x] * len(t)) for x, t in enumerate(times)]
        start = max(path.start for path in paths)
        end = min(path.end for path in paths)
        found = so.time_of_impact(ball, ball, *paths, end - start, start=start)
        assert (found.status, found.time) == (so.impact.ImpactStatus.NO_IMPACT, end)
    slow = ConstantTwist(at(1.0, 0.0, 0.0), ([-1e-10, 0.0, 0.0], [0.0, 0.0, 0.0]))
    found = so.time_of_impact(ball, ball, REST, slow, 1e-6, start=1.7e9)
    assert found.status is so.impact.ImpactStatus.NO_IMPACT
    found = so.time_of_impact(ball, ball, REST, slow, 1e-320)
    assert (found.status, found.time) == (so.impact.ImpactStatus.NO_IMPACT, 1e-320)


def test_nothing_is_claimed_of_a_motion_too_fast_for_the_times() -> None:
    """At rest in truth; the bound on its acceleration lets no interval be proven."""
    ball = so.shapes.sphere(0.1)
    wild = Bounded(
        Fixed(at(1.0, 0.0, 0.0)),
        speed=0.0,
        acceleration=1e45,
        angular_speed=0.0,
        angular_acceleration=0.0,
    )
    found = so.time_of_impact(ball, ball, REST, wild, 1.0, start=1.0)
    assert (found.status, found.time) == (so.impact.ImpactStatus.UNDECIDED, 1.0)
    assert math.isnan(found.latest)
    assert "too fast" in found.status.advice


@pytest.mark.parametrize(("start", "duration"), [(1.7e9, 1e-7), (1e17, 1.0), (-1e17, 1.0)])
def test_a_duration_lost_beside_the_start_is_refused(start: float, duration: float) -> None:
    body = so.shapes.sphere(1.0)  # they overlap: no impact would be wrong
    with pytest.raises(ValueError, match=r"is no later than the start.*longer duration"):
        so.time_of_impact(body, body, REST, at(1.0, 0.0, 0.0), duration, start=start)
    ended = along_x([0.0, 1.0], [3.0, 3.0])
    with pytest.raises(ValueError, match=r"a path ends at 1\.0: give a start before that"):
        so.time_of_impact(body, body, REST, ended, 1e-15, start=1.0)


@pytest.mark.parametrize(("arm", "tolerance"), [(1e3, 1e-12), (6.4e6, 1e-9), (6.4e6, 1e-12)])
@pytest.mark.parametrize("kind", ["offset", "carried", "bounded"])
def test_far_carriers_whose_arms_cancel(
    kind: str, arm: float, tolerance: float, rng: np.random.Generator
) -> None:
    """The body's place is t - 2, and the obstacle's a binary fraction: exact."""
    ball, back = so.shapes.sphere(0.5), at(arm, 0.0, 0.0)
    velocity = ([1.0, 0.0, 0.0], [0.0, 0.0, 0.0])
    path: Any = Offset(ConstantTwist(at(-arm - 2.0, 0.0, 0.0), velocity), back)
    if kind == "carried":
        path = Carried(Fixed(at(-arm - 2.0, 0.0, 0.0)), ConstantTwist(back, velocity))
    if kind == "bounded":
        rates = dict.fromkeys(("acceleration", "angular_speed", "angular_acceleration"), 0.0)
        path = Bounded(path, speed=1.0, **rates, lengths=2.0 * arm + 10.0)
    for _ in range(10):
        place = float(rng.integers(1 << 20)) / (1 << 20)
        goal = at(place, 0.0, 0.0)
        found = so.time_of_impact(ball, ball, path, goal, 5.0, tolerance=tolerance)
        assert found.status is so.impact.ImpactStatus.IMPACT
        assert found.time <= place + 1.0 <= found.latest
        assert found.error < 10.0 * found.tolerance


def test_a_screw_about_a_far_point_is_never_late(rng: np.random.Generator) -> None:
    """The contact to 40 digits: the place of a ball's centre on its circle, by cosine and sine."""
    ball = so.shapes.sphere(0.5)
    for _ in range(30):
        arm, angle = float(10.0 ** rng.uniform(6, 8)), rng.uniform(0, math.tau)
        speed = float(10.0 ** rng.uniform(-1, 1))
        out = np.array([math.cos(angle), math.sin(angle), 0.0])
        point, rate = out * arm, speed / arm
        path = Screw(REST, (0.0, 0.0, 1.0), point, rate)
        goal = (speed + 1.0) * np.array([out[1], -out[0], 0.0])
        with mpmath.workdps(40):
            numbers = [mpmath.mpf(float(number)) for number in (rate, *point[:2], *goal[:2])]

            def gap(t: Any, numbers: Any = numbers) -> Any:
                omega, x, y, goal_x, goal_y = numbers
                cosine, sine = mpmath.cos(omega * t), mpmath.sin(omega * t)
                return (
                    mpmath.hypot(
                        x - cosine * x + sine * y - goal_x, y - sine * x - cosine * y - goal_y
                    )
                    - 1
                )

            truth = mpmath.findroot(gap, (0.9, 1.1), solver="anderson", tol=1e-50)
            found = so.time_of_impact(ball, ball, path, at(*goal), 1.5, tolerance=1e-12)
            assert found.status is so.impact.ImpactStatus.IMPACT
            assert found.time <= truth <= found.latest
            assert gap(mpmath.mpf(found.latest)) < 0
            assert found.error * speed < 10.0 * found.tolerance


def test_touching_as_given_is_contact_at_the_start() -> None:
    """A pose that is given carries no rounding; the spheres touch to the last digit."""
    ball = so.shapes.sphere(1.0)
    away = ConstantTwist(at(2.0, 0.0, 0.0), ([1.0, 0.0, 0.0], [0.0, 0.0, 0.0]))
    for path in (Fixed(at(2.0, 0.0, 0.0)), away, along_x([0.0, 1.0], [2.0, 3.0])):
        found = so.time_of_impact(ball, ball, REST, path, 1.0)
        assert (found.status, found.time) == (so.impact.ImpactStatus.AT_START, 0.0)


def test_bounding_balls_hold_what_a_body_may_be_off(rng: np.random.Generator) -> None:
    """A hull whose facets were merged is known to its slack, and so are its balls and chords."""
    points = rng.normal(size=(300, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    hull = so.Body.from_points(points, tolerance=0.03)
    half, slack = hull.reals[L.BOX_HALF : L.BOX_HALF + 3], hull.reals[L.SLACK]
    assert slack > 0.0
    box = BodyBox(hull)
    assert (box.half >= half + slack).all()
    assert box.reach >= np.linalg.norm(half) + slack
