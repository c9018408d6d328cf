"""`so.track`: the tracker's own answers, its frames, its refusals, and the visited modes."""

from __future__ import annotations

import itertools
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from moving_pairs import REST, random_pairs, straight

import standoff as so
from shares import share
from standoff.geometry import Line
from standoff.motion import ConstantTwist, Fixed
from standoff.recording.track import track_along

BOX = so.shapes.box(1.0, 1.0, 1.0)
POINT = so.shapes.point()
AT_POINT = (("vertex", 0), ())
PAST = straight((-1.0, -0.9, 0.8), (1.0, 0.77, 0.013))
OFF = REST, so.Pose(np.eye(3), (2.0, 0.0, 0.0))
THROUGH = straight((-1.0, 0.1, 0.2), (1.0, 0.0, 0.0))


LAWS = so.PredictorCorrector(), so.PaperLaw()


@pytest.mark.parametrize(("number", "law"), share(2, [0, 3, 6, 7], LAWS), ids=repr)
def test_frames_are_the_tracker_s_own_steps(number: int, law: Any) -> None:
    a, b, path_a, path_b = random_pairs(8)[number]
    recording = so.track(so.Tracker(a, b, 2e-3, law), path_a, path_b, 0.8, start=0.25)
    check_against_steps(recording, a, b, path_a, path_b, so.Tracker(a, b, 2e-3, law))
    assert recording.time[0] == 0.25
    assert len(recording) == 401


def test_penetration_is_the_tracker_s_own() -> None:
    small = so.shapes.box(0.3, 0.2, 0.25)
    recording = so.track(so.Tracker(small, BOX, 5e-3), THROUGH, REST, 2.0)
    statuses = set(recording.status)
    assert statuses == {so.Status.CONVERGED, so.Status.GLOBAL}
    check_against_steps(recording, small, BOX, THROUGH, Fixed(REST), so.Tracker(small, BOX, 5e-3))
    np.testing.assert_array_equal(recording.distance < 1e-12, recording.penetrating)
    assert recording.certified.all()


def check_against_steps(recording, a, b, path_a, path_b, tracker) -> None:
    times = recording.time.tolist()

    def moved(t):
        return path_a.pose(t), path_b.pose(t), path_a.twist(t), path_b.twist(t)

    state = tracker.start(*moved(times[0]))
    answers = [state.proximity]
    for before, time in pairwise(times):
        state, answer = tracker.step(state, *moved(time), dt=time - before)
        answers.append(answer)
    for name in (
        *(
            "distance",
            "lower_bound",
            "upper_bound",
            "rate",
            "residual",
            "point_a",
            "point_b",
            "normal",
        ),
        *("velocity_a", "velocity_b", "certified"),
    ):
        np.testing.assert_array_equal(
            getattr(recording, name), [getattr(answer, name) for answer in answers], err_msg=name
        )
    for name in ("feature_a", "feature_b", "status"):
        assert getattr(recording, name).tolist() == [getattr(answer, name) for answer in answers]
    for name in ("parameters_a", "parameters_b"):
        for row, answer in zip(getattr(recording, name), answers, strict=True):
            assert tuple(row[~np.isnan(row)]) == getattr(answer, name)
    assert [so.tracking.Counts(*row) for row in recording.counts.tolist()] == [
        x.counts for x in answers
    ]


def test_a_run_begins_at_a_given_state() -> None:
    """The paper's law from a wrong start: the errors fall, and every frame is a step's answer."""
    lens, times = so.shapes.lens(1.0, 0.45), np.arange(200) * 1e-3
    path = straight((1.2, 0.3, 0.4), (0.1, 0.2, 0.0))
    tracker = so.Tracker(lens, POINT, law=so.PaperLaw())
    start = tracker.start_from(REST, path.pose(0.0), (("face", 0), (-0.3, 0.4)), AT_POINT)
    recording = track_along(tracker, Fixed(REST), path, times, state=start)
    assert recording.distance[0] == start.proximity.distance
    state = start
    for k, time in enumerate(times[1:].tolist(), start=1):
        twists = np.zeros(6), path.twist(time)
        state, answer = tracker.step(state, REST, path.pose(time), *twists, dt=time - times[k - 1])
        assert recording.distance[k] == answer.distance
    assert recording.residual[0] > 0.1
    assert recording.residual[-1] < 1e-6
    other = so.Tracker(BOX, POINT).start(*OFF)
    for wrong, error in (("here", TypeError), (other, ValueError)):
        with pytest.raises(error, match=r"[sS]tate"):
            track_along(tracker, Fixed(REST), path, times, state=wrong)


def test_a_pose_is_a_body_at_rest() -> None:
    one = so.track(so.Tracker(POINT, BOX, 1e-2), PAST, REST, 0.5)
    two = so.track(so.Tracker(POINT, BOX, 1e-2), PAST, np.eye(4), 0.5)
    three = so.track(so.Tracker(POINT, BOX, 1e-2), PAST, Fixed(REST), 0.5)
    np.testing.assert_array_equal(one.distance, two.distance)
    np.testing.assert_array_equal(one.distance, three.distance)


def test_frame_times() -> None:
    recording = so.track(so.Tracker(POINT, BOX, 0.1), PAST, REST, 0.3)
    np.testing.assert_allclose(recording.time, [0.0, 0.1, 0.2, 0.3], rtol=1e-15)
    assert len(so.track(so.Tracker(POINT, BOX, 0.1), PAST, REST, 0.35)) == 4


@pytest.mark.parametrize(
    ("arguments", "error", "piece"),
    [
        ({"duration": -1.0}, ValueError, "duration = -1.0"),
        ({"duration": float("inf")}, ValueError, "duration = inf"),
        ({"tracker": BOX}, TypeError, "is not a Tracker: make one with so.Tracker(a, b, dt)"),
        ({"tracker": None}, TypeError, "None is not a Tracker: make one with so.Tracker(a, b, dt)"),
        ({"dt": 3.0}, ValueError, "there are 1 frames"),
        ({"dt": 1e-9}, ValueError, "2e+09 frames"),
        ({"start": float("nan")}, ValueError, "start = nan"),
        ({"start": 1e17}, ValueError, "at different times"),
        ({"path_a": "left"}, TypeError, "path_a = 'left' is neither a path"),
        ({"path_b": (1.0, 0.0, 0.0, 0.0)}, TypeError, "path_b"),
    ],
)
def test_what_is_refused(arguments: dict, error: type[Exception], piece: str) -> None:
    given = {"path_a": PAST, "path_b": REST, "duration": 2.0, "dt": 1e-2} | arguments
    if "tracker" not in given:
        given["tracker"] = so.Tracker(POINT, BOX, given.pop("dt"))
    else:
        del given["dt"]
    with pytest.raises(error) as caught:
        so.track(given.pop("tracker"), **given)
    assert piece in str(caught.value)


def test_a_pose_that_goes_wrong_on_the_way_is_named() -> None:
    class Broken:
        def pose(self, t):
            matrix = np.eye(4)
            matrix[0, 3] = 3.0 if t < 0.5 else np.nan
            return matrix

        def twist(self, t):
            return so.Twist.zero()

    with pytest.raises(ValueError, match="nan"):
        so.track(so.Tracker(POINT, BOX, 1e-2), Broken(), REST, 1.0)


def test_planar_pairs_stay_in_their_plane() -> None:
    corners = [(-0.5, -0.5, 0.0), (0.5, -0.5, 0.0), (0.5, 0.5, 0.0), (-0.5, 0.5, 0.0)]
    loop = so.shapes.planar_loop([Line(corners[k], corners[(k + 1) % 4]) for k in range(4)])
    with pytest.raises(ValueError, match="z = 0"):
        so.track(
            so.Tracker(POINT, loop, 1e-2), straight((2.0, 0.0, 0.0), (0.0, 0.0, 1.0)), REST, 1.0
        )


def test_progress_reaches_the_end() -> None:
    told: list[tuple[int, int]] = []
    so.track(
        so.Tracker(POINT, BOX, 2e-3), PAST, REST, 2.0, progress=lambda *done: told.append(done)
    )
    assert told[-1] == (1001, 1001)
    assert len(told) > 5
    assert told == sorted(told)


def test_modes_are_the_visits_between_the_switches() -> None:
    recording = so.track(so.Tracker(POINT, BOX, 1e-2), PAST, REST, 2.0)
    visits = recording.modes()
    times = [event.time for event in recording.events]
    assert [visit.start for visit in visits] == [0.0, *times]
    assert [visit.end for visit in visits] == [*times, 2.0]
    assert [v.feature_b.kind for v in visits] == ["vertex", "edge", "face", "edge", "vertex"]
    assert {v.feature_a for v in visits} == {so.Feature("vertex", 0)}
    for visit in visits:
        inside = (recording.time > visit.start) & (recording.time < visit.end)
        assert (recording.feature_b[inside] == visit.feature_b).all()


def test_modes_go_on_in_penetration() -> None:
    recording = so.track(so.Tracker(so.shapes.sphere(0.2), BOX, 1e-2), THROUGH, REST, 2.5)
    inside = np.flatnonzero(recording.penetrating)
    assert inside.size
    visits = recording.modes()
    assert visits[0].start == 0.0
    assert visits[-1].end == 2.5
    assert all(first.end == second.start for first, second in itertools.pairwise(visits))
    events = [event for event in recording.events if event.frame in inside]
    assert not any(event.located for event in events)


def test_info_tells_the_run() -> None:
    recording = so.track(so.Tracker(POINT, BOX, 1e-2, law=so.PaperLaw(gain=50.0)), PAST, REST, 0.1)
    info = recording.info
    assert info.bodies == ("point", "box")
    assert info.digests == (POINT.digest, BOX.digest)
    assert info.version == so.__version__
    assert info.options == {
        "law": "paper",
        "integrator": "heun",
        "gain": 50.0,
        "feedback": None,
        "reset": "foot",
        "far_side": "left",
        "restarts": True,
        "within": None,
        "feedforward": True,
        "tolerance": 1e-10,
        "dt": 1e-2,
        "depth": "global",
        "deadline": None,
        "locate": True,
        "realisation": "evaluated",
        "saturation": "hold",
        "switching": "multipliers",
        "solve": "ranked",
    }
    assert recording.pair == (POINT, BOX)


def test_the_papers_variants_are_passed_on() -> None:
    """Each is told in the recording, and the printed saturation shows in the counts."""
    recording = so.track(
        so.Tracker(
            POINT,
            BOX,
            1e-2,
            law=so.PaperLaw(
                feedback=so.feedback.PI(40.0, 300.0),
                realisation="integrated",
                switching="voronoi",
                solve="plain",
            ),
        ),
        PAST,
        REST,
        0.5,
    )
    options = recording.info.options
    assert options["feedback"] == {"kind": "pi", "gain": 40.0, "integral": 300.0}
    assert options["gain"] is None
    assert options["realisation"] == "integrated"
    assert (options["saturation"], options["switching"]) == ("zero", "voronoi")
    assert options["solve"] == "plain"


def test_a_digest_names_the_geometry() -> None:
    assert BOX.digest == so.shapes.box(1.0, 1.0, 1.0).digest
    assert BOX.digest != so.shapes.box(1.0, 1.0, 1.0 + 1e-15).digest
    assert so.shapes.sphere(0.2).digest != so.shapes.sphere(0.3).digest
    assert BOX.digest != so.shapes.box(1.0, 1.0, 1.0, rounding=0.1).digest
    assert len(BOX.digest) == 64


def test_a_world_twist_path_and_a_body_twist_path_agree() -> None:
    class InBody:
        def __init__(self, path):
            self.pose, self._path = path.pose, path

        def twist(self, t):
            twist, pose = self._path.twist(t), self.pose(t)
            return so.Twist(pose.rotation.T @ twist.v, pose.rotation.T @ twist.omega, "body")

    path = ConstantTwist(so.Pose(np.eye(3), (1.5, 0.2, 0.4)), so.Twist((-0.2, 0, 0), (1, 2, 3)))
    a = so.shapes.ellipsoid(0.3, 0.1, 0.2)
    one = so.track(so.Tracker(a, BOX, 1e-2), path, REST, 0.5)
    two = so.track(so.Tracker(a, BOX, 1e-2), InBody(path), REST, 0.5)
    np.testing.assert_allclose(one.rate, two.rate, atol=1e-13)


@pytest.mark.parametrize(("depth", "deadline"), [("local", 40), ("global", None)])
def test_depth_and_deadline_are_recorded(depth: str, deadline: int | None, tmp_path: Path) -> None:
    small = so.shapes.box(0.3, 0.2, 0.25)
    recording = so.track(
        so.Tracker(small, BOX, 2e-2, law=so.PredictorCorrector(depth=depth, deadline=deadline)),
        THROUGH,
        REST,
        2.0,
    )
    recording.save(tmp_path / "run.parquet")
    for one in (recording, so.open_recording(tmp_path / "run.parquet")):
        assert one.info.options["depth"] == depth
        assert one.info.options["deadline"] == deadline
        np.testing.assert_array_equal(one.upper_bound, recording.upper_bound)
        apart = one.distance > 0.0
        assert apart.any()
        assert not apart.all()
        np.testing.assert_array_equal(one.upper_bound[apart], one.distance[apart])
        assert (one.lower_bound <= one.upper_bound + 1e-12).all()
