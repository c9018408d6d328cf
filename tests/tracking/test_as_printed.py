"""The system as the paper prints it, by one name; and that the library's own form of it arrives."""

from __future__ import annotations

import numpy as np
import pytest

import standoff as so
from standoff.tracking.inputs import flat_pose
from standoff_studies.paper.bodies import lens_of_patches

LENS, POINT = lens_of_patches(), so.shapes.point()
OTHER = LENS.transformed(np.diag((0.8, 0.6, 0.7)))
REST, STILL = so.Pose.identity(), so.Twist.zero()
H, SPEED, AHEAD = 1e-3, 2.0, 0.33


def circling(t: float) -> tuple[so.Pose, so.Twist]:
    """A point on a circle about the lens, off its middle; it comes to an edge in 0.07 s."""
    t += AHEAD
    x = np.array([1.6 * np.cos(SPEED * t), 1.6 * np.sin(SPEED * t), 0.5])
    return so.Pose(np.eye(3), x), so.Twist(SPEED * np.array([-x[1], x[0], 0.0]), np.zeros(3))


def run(
    law: so.PaperLaw, start: tuple[float, float] = (0.7, 0.3), frames: int = 1600
) -> list[so.Proximity]:
    tracker = so.Tracker(LENS, POINT, H, law=law)
    pose, twist = circling(0.0)
    places = (("face", 0), start), (("vertex", 0), ())
    state = tracker.start_from(REST, pose, *places, STILL, twist, settle=False)
    answers = [state.proximity]
    for k in range(1, frames + 1):
        pose, twist = circling(k * H)
        state, answer = tracker.step(state, REST, pose, STILL, twist)
        answers.append(answer)
    return answers


def entries(answers: list[so.Proximity]) -> list[int]:
    """Frames that enter an edge from a face."""
    return [
        k
        for k, answer in enumerate(answers)
        for event in answer.events
        if event.source.kind == "face" and event.target.kind == "edge"
    ]


def on_face(face: int, edge: int, t: float) -> np.ndarray:
    """(u, v) on a face of an edge's point."""
    part = LENS.face_parts[face]
    curve = next(
        pcurve for pcurve, (own, _) in zip(part.pcurves, part.loop, strict=True) if own == edge
    )
    assert curve is not None
    return np.asarray(curve.point(t)[:2])


def test_it_is_one_configuration() -> None:
    law = so.PaperLaw.as_printed(gain=50.0)
    assert law == so.PaperLaw(
        gain=50.0, switching="voronoi", saturation="zero", solve="plain", reset="nearest",
        far_side="kept", restarts=False,
    )  # fmt: skip
    assert (law.integrator, law.realisation, law.feedforward) == ("heun", "evaluated", True)
    assert so.PaperLaw.as_printed(gain=50.0, integrator="rk4").integrator == "rk4"
    with pytest.raises(TypeError):
        so.PaperLaw.as_printed()  # type: ignore[call-arg]


@pytest.mark.parametrize("gain", [25.0, 100.0])
def test_a_switch_onto_an_edge_takes_the_parameter_nearest_to_the_faces_own(gain: float) -> None:
    """While the law still converges that is not the foot point: an error is left."""
    answers = run(so.PaperLaw.as_printed(gain=gain))
    found = entries(answers)
    assert len(found) >= 2
    for k in found:
        before, after = answers[k - 1], answers[k]
        face, edge = before.feature_a.index, after.feature_a.index
        exact = np.linspace(0.0, 1.0, 20001)
        own = LENS.edge_parts[edge].curve
        t = own.first + exact * (own.last - own.first)
        uv = np.array([on_face(face, edge, x) for x in t[::50]])
        # the frame has moved the face's parameters on by a step before it switched
        moved = np.abs(on_face(face, edge, after.parameters_a[0]) - before.parameters_a)
        assert moved[1] < 0.02
        assert np.ptp(uv[:, 0]) < 1e-12  # the edge is an isoline
        assert after.counts.solved_parameters == 0
    first = answers[found[0]]
    foot = so.distance(LENS, POINT, REST, circling(found[0] * H)[0])
    assert abs(first.parameters_a[0] - foot.parameters_a[0]) > (1e-3 if gain == 25.0 else 0.0)
    exact_reset = so.PaperLaw(gain=gain, switching="voronoi", solve="plain", restarts=False)
    solved = run(exact_reset)
    k = entries(solved)[0]
    assert solved[k].counts.solved_parameters == 1
    assert abs(solved[k].parameters_a[0] - foot.parameters_a[0]) < 1e-9


def test_nothing_is_searched_restarted_or_taken_from_a_solve() -> None:
    answers = run(so.PaperLaw.as_printed(gain=25.0))
    for answer in answers:
        counts = answer.counts
        assert counts.restarts == counts.searches == counts.solved_parameters == 0
    assert sum(answer.counts.foot_points for answer in answers) >= len(answers) - 1
    by_multipliers = run(so.PaperLaw(gain=25.0))
    assert sum(answer.counts.foot_points for answer in by_multipliers) == 0


def test_the_switches_of_body_and_point_do_not_depend_on_the_start() -> None:
    law = so.PaperLaw.as_printed(gain=25.0)
    orders = []
    for start in ((0.7, 0.3), (0.2, 0.8)):
        events = [event for answer in run(law, start) for event in answer.events]
        orders.append([(event.time, event.source, event.target) for event in events])
    assert len(orders[0]) >= 3
    assert orders[0] == orders[1]


def arrived(law: so.PaperLaw, starts: int, frames: int) -> int:
    """Of random starts on two lenses at rest, how many come to the distance of a cold query."""
    rng = np.random.default_rng(5)
    pose = so.Pose(so.Pose.exp((-0.1, 0.0, 0.3)).rotation, (1.49, -0.82, -0.18))
    exact = so.distance(LENS, OTHER, REST, pose).distance
    tracker = so.Tracker(LENS, OTHER, H, law=law)
    found = 0
    for _ in range(starts):
        faces, places = rng.integers(3, size=2), rng.uniform(size=(2, 2))
        state = tracker.start_from(
            REST, pose, (("face", int(faces[0])), places[0]), (("face", int(faces[1])), places[1]),
            STILL, STILL, settle=False,
        )  # fmt: skip
        buffer = tracker.buffer(state)
        buffer.pose_a[:], buffer.pose_b[:] = flat_pose(REST), flat_pose(pose)
        for _ in range(frames):
            tracker.step_into(buffer)
        found += abs(float(buffer.out[0]) - exact) < 1e-7
    return found


def test_the_default_of_the_papers_law_arrives_from_wrong_starts() -> None:
    """A frame that entered a boundary and was released again within itself stood still for ever:
    a quarter of the starts."""
    assert arrived(so.PaperLaw(restarts=False), 150, 120) >= 146


def test_the_printed_system_does_not_always_arrive() -> None:
    """With M as it is: two bodies have other stationary points, and nothing restarts it."""
    found = arrived(so.PaperLaw.as_printed(gain=1000.0), 60, 120)
    assert 3 <= found <= 30
