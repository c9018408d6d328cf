"""Beyond a horizon a proven bound is enough: it holds, and nothing nearer is left out."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
from draws import draws
from standoff.bodies.features import NO_FEATURE
from standoff.kernels.state import arrays as K

SHAPES = (
    so.shapes.ellipsoid(0.3, 0.5, 0.7),
    so.shapes.box((0.5, 0.6, 0.4)),
    so.shapes.lens(0.6, 0.25),
    so.shapes.cylinder(0.3, 0.8),
    so.shapes.segment(0.7),
    so.shapes.halfspace((0.0, 0.6, 0.8), offset=-0.3),
    so.shapes.sphere(0.4),
    so.shapes.box((0.5, 0.6, 0.4), rounding=0.1),
)


def drawn_pose(rng: np.random.Generator, far: float) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, :3] = Rotation.random(random_state=rng).as_matrix()
    pose[:3, 3] = rng.normal(size=3) * far
    return pose


def drawn_pair(rng: np.random.Generator) -> tuple[so.Body, so.Body]:
    a, b = rng.choice(len(SHAPES), 2)
    if a == b == 5:
        b = 0
    pair = [SHAPES[k] if k == 5 else SHAPES[k].transformed(0.5 * np.eye(3)) for k in (a, b)]
    return pair[0], pair[1]


def test_a_cold_query_is_far_or_the_same(rng: np.random.Generator) -> None:
    counts = {True: 0, False: 0}
    for _ in range(draws(300)):
        a, b = drawn_pair(rng)
        # also poses far from the world's origin, where roundoff is large
        shift = np.eye(4)
        shift[:3, 3] = rng.normal(size=3) * 10.0 ** rng.uniform(-1, 5)
        poses = [shift @ drawn_pose(rng, 1.0) for _ in range(2)]
        true = so.distance(a, b, *poses)
        within = max(1e-3, abs(true.distance)) * 10.0 ** rng.uniform(-0.5, 0.5)
        found = so.distance(a, b, *poses, within=within)
        counts[found.far] += 1
        assert found.lower_bound <= true.upper_bound
        assert found.far == (found.lower_bound > within)
        if found.far:
            assert true.upper_bound > within
            assert found.certified
            assert found.distance == np.inf
        else:
            assert np.array_equal(found.row, true.row, equal_nan=True)
    assert min(counts.values()) > 30


@pytest.mark.parametrize("law", [so.PredictorCorrector, so.PaperLaw])
def test_tracked_frames_are_far_or_near_the_same(rng: np.random.Generator, law) -> None:
    within, spared = 0.4, 0
    for _ in range(draws(8)):
        a, b = drawn_pair(rng)
        near, every = so.Tracker(a, b, law=law(within=within)), so.Tracker(a, b, law=law())
        way = rng.normal(size=3)
        spin = rng.normal(size=(2, 3))
        start = [drawn_pose(rng, 0.3), drawn_pose(rng, 0.3)]
        states = [tracker.start(*poses_at(start, way, spin, 0)) for tracker in (near, every)]
        for k in range(1, 400):
            if k == 250:  # a jump, and back at the end of the way
                start = [drawn_pose(rng, 0.3), drawn_pose(rng, 0.3)]
            poses = poses_at(start, way, spin, k)
            states[0], found = near.step(states[0], *poses)
            states[1], true = every.step(states[1], *poses)
            assert found.time == pytest.approx(true.time)
            assert found.lower_bound <= true.upper_bound + 1e-12
            if found.far:
                spared += found.counts.evaluations == 0
                assert true.upper_bound > within
            elif true.certified and found.certified:
                slack = 1e-9 if true.distance > 0.0 else 1e-3 * true.depth + 1e-9
                assert abs(found.distance - true.distance) <= slack
    assert (spared > 300) == (law is so.PredictorCorrector)


@pytest.mark.parametrize("first", [True, False])
def test_a_half_space_saves_frames_too(rng: np.random.Generator, first: bool) -> None:
    """Over a plane that turns and a plane at rest, in both orders; the bound is near the truth."""
    for shape in (SHAPES[1], SHAPES[2], SHAPES[6]):
        pair = (SHAPES[5], shape) if first else (shape, SHAPES[5])
        near = so.Tracker(*pair, law=so.PredictorCorrector(within=0.4))
        plane, body = drawn_pose(rng, 0.3), np.eye(4)
        normal = plane[:3, :3] @ [0.0, 0.6, 0.8]
        body[:3, 3] = plane[:3, 3] + 1.5 * normal
        body[:3, :3] = Rotation.random(random_state=rng).as_matrix()
        poses = (plane, body) if first else (body, plane)
        state, spared, far = near.start(*poses), 0, 0
        for k in range(60):
            body[:3, 3] += 0.02 * normal
            if k >= 30:
                turn = Rotation.from_rotvec([0.002, -0.001, 0.0]).as_matrix()
                plane[:3, :3] = turn @ plane[:3, :3]
            state, found = near.step(state, *poses)
            true = so.distance(*pair, *poses)
            assert found.far
            far += 1
            spared += found.counts.evaluations == 0
            assert found.lower_bound <= true.upper_bound
            assert found.lower_bound > true.distance - 0.4
        assert spared >= far - 1
        assert so.distance(*pair, *poses, within=0.4).counts.evaluations == 0


def poses_at(start, way, spin, k: int) -> list[np.ndarray]:
    poses = []
    for pose, turn, sign in zip(start, spin, (0.0, 1.0), strict=True):
        moved = pose.copy()
        moved[:3, :3] = Rotation.from_rotvec(0.01 * k * turn).as_matrix() @ moved[:3, :3]
        moved[:3, 3] += sign * way * (1.0 - np.cos(0.02 * k))
        poses.append(moved)
    return poses


def test_rows_and_runs_have_the_same_horizon() -> None:
    a, b = SHAPES[0], SHAPES[1]
    poses = np.tile(np.eye(4), (9, 1, 1))
    poses[:, 0, 3] = np.linspace(0.0, 4.0, 9)
    cold = so.distances(a, b, np.eye(4), poses, within=1.0)
    warm = so.distances(a, b, np.eye(4), poses, within=1.0, warm=True)
    for found in (cold, warm):
        far = found.status == so.Status.FAR
        assert far.tolist() == [False] * 4 + [True] * 5
        assert found.certified.all()
        assert np.isinf(found.distance[far]).all()
        assert np.isnan(found.normal[far]).all()
        assert np.isnan(found.gradient[far]).all()
        assert np.isfinite(found.gradient[2:4]).all()
        assert (found.feature_a["index"][far] == -1).all()
        assert found[8].far
    assert so.distances(a, b, np.eye(4), poses).distance[:4] == pytest.approx(cold.distance[:4])


def test_what_a_far_answer_says() -> None:
    pose = np.eye(4)
    pose[0, 3] = 5.0
    far = so.distance(SHAPES[0], SHAPES[1], np.eye(4), pose, within=1.0)
    assert repr(far).startswith("Proximity(FAR: at least 4.45 apart")
    told = far.as_dict()
    assert told["status"] == "FAR"
    assert told["feature_a"] == str(far.feature_a) == ""
    assert far.place_b == (NO_FEATURE, ())
    assert far.row[K.OUT_MODE] == -1.0
    drawn = so.plot(SHAPES[0], SHAPES[1], far)
    assert "no distance, FAR" in [text.get_text() for text in drawn.legends[0].get_texts()]
    for name in ("gradient", "hessian", "unique"):
        with pytest.raises(ValueError, match=r"beyond the horizon|no derivatives"):
            getattr(far, name)
    assert far.derivatives().smoothness.name == "UNDEFINED"
    assert "raise `within`" in so.Status.FAR.advice


def test_a_recorded_run_keeps_far_frames(tmp_path: Path) -> None:
    from standoff.motion import ConstantTwist
    from standoff.view import save_page, save_video

    tracker = so.Tracker(SHAPES[0], SHAPES[1], 4e-2, so.PredictorCorrector(within=0.5))
    pose = np.eye(4)
    pose[0, 3] = 3.0
    flying = ConstantTwist(pose, ([-1.0, 0, 0], [0, 0, 0.3]))
    run = so.track(tracker, np.eye(4), flying, 2.2)
    far = np.array([status is so.Status.FAR for status in run.status])
    assert far[0]
    assert not far[-1]
    assert np.isinf(run.distance[far]).all()
    assert run.certified.all()
    assert run.distance[~far].max() <= 0.5 + 1e-9
    assert not far[run.closest()]
    assert np.isnan(run.gap[far]).all()
    assert 0.0 < run.gap[run.widest_gap()] < 1e-9
    _, errors, *_ = run.plot().axes
    assert errors.get_ylim()[0] < run.gap[~far].max() < errors.get_ylim()[1]
    assert len(errors.lines)
    save_page(run, tmp_path / "run.html")
    save_video(run, tmp_path / "run.gif", pictures=12)
    run.save(tmp_path / "run.parquet")
    again = so.open_recording(tmp_path / "run.parquet")
    assert again.feature_a[0] == NO_FEATURE
    assert again.status_frames() == run.status_frames()
    away = so.track(tracker, np.eye(4), pose, 0.1)
    assert away.closest() is None
    assert away.widest_gap() is None
    away.plot()


def test_bad_horizons() -> None:
    pose = np.eye(4)
    for within in (0.0, -1.0, np.nan, "far"):
        with pytest.raises((ValueError, TypeError), match="within"):
            so.distance(SHAPES[0], SHAPES[1], pose, pose, within=within)
        with pytest.raises((ValueError, TypeError), match="within"):
            so.PredictorCorrector(within=within)
    with pytest.raises(ValueError, match="no horizon"):
        so.PointTracker(SHAPES[0], law=so.PredictorCorrector(within=1.0))
