"""What the tracker refuses: an error that names the value and the fix, and nothing changed."""

from functools import partial

import numpy as np
import pytest

import standoff as so
from standoff.geometry import ConicArc

NAN, INF = np.nan, np.inf
LENS, POINT, BOX = so.shapes.lens(1.0, 0.45), so.shapes.point(), so.shapes.box(1, 1, 1)
DISC = so.shapes.planar_loop([ConicArc((0, 0), (1, 0), (0, 1))])
HOME = np.eye(4)
AWAY = np.array([[1.0, 0, 0, 3], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
REST = (np.zeros(3), np.zeros(3))


def with_entry(row, column, value):
    matrix = AWAY.copy()
    matrix[row, column] = value
    return matrix


def with_rotation(rotation):
    matrix = AWAY.copy()
    matrix[:3, :3] = rotation
    return matrix


BAD_POSES = {
    "NaN in the rotation": (with_entry(1, 2, NAN), "nan.*finite"),
    "infinite rotation": (with_entry(1, 2, INF), "inf.*finite"),
    "NaN in the translation": (with_entry(0, 3, NAN), "nan.*finite"),
    "infinite translation": (with_entry(2, 3, -INF), "-inf.*finite"),
    "infinite both ways": (with_entry(0, 3, INF) - with_entry(1, 3, INF) + HOME, "finite"),
    "singular": (with_rotation(np.diag([1, 1, 0])), "not orthonormal.*by 1"),
    "sheared": (
        with_rotation([[1, 1e-4, 0], [0, 1, 0], [0, 0, 1]]),
        "orthonormal.*0.0001.*nearest",
    ),
    "scaled": (with_rotation(2 * np.eye(3)), "not orthonormal.*transformed"),
    "mirrored": (with_rotation(np.diag([1, 1, -1])), "mirrored.*transformed"),
    "translation in the last row": (AWAY.T, "last row.*transpose"),
    "only a rotation": (np.eye(3), r"shape \(3, 3\).*give a Pose"),
    "short translation": ((np.eye(3), (1, 2)), r"translation has shape \(2,\).*give 3"),
    "quaternion": (np.array([1.0, 0, 0, 0]), "from_wxyz"),
    "quaternion with a translation": (([1.0, 0, 0, 0], (0, 0, 3)), "from_wxyz"),
    "text": ("here", "'here'.*give a Pose"),
    "nothing": (None, "None.*give a Pose"),
    "complex": (1j * HOME, "all of them real"),
}


@pytest.mark.parametrize("name", BAD_POSES)
@pytest.mark.parametrize("body", ["a", "b"])
def test_poses(name, body):
    pose, words = BAD_POSES[name]
    pair = (pose, HOME) if body == "a" else (HOME, pose)
    with pytest.raises(ValueError, match=f"(?s){words}"):
        so.distance(LENS, POINT, *pair)


@pytest.mark.parametrize("name", BAD_POSES)
def test_a_refused_step_leaves_the_state_as_it_was(name):
    pose, words = BAD_POSES[name]
    tracker = so.Tracker(LENS, POINT)
    state = tracker.start(HOME, AWAY)
    before = state.data.copy()
    with pytest.raises(ValueError, match=f"(?s){words}"):
        tracker.step(state, HOME, pose)
    np.testing.assert_array_equal(state.data, before)
    assert tracker.step(state, HOME, AWAY)[1].certified


@pytest.mark.parametrize("entry", [(0, NAN), (4, 2.0), (9, INF), (11, NAN)])
def test_a_refused_frame_in_place_leaves_the_buffer_as_it_was(entry):
    tracker = so.Tracker(LENS, POINT)
    buffer = tracker.buffer(tracker.start(HOME, AWAY))
    buffer.pose_b[9] = 3.0
    tracker.step_into(buffer)
    state, out = buffer.state.copy(), buffer.out.copy()
    place, value = entry
    buffer.pose_b[place] = value
    with pytest.raises(ValueError, match=r"finite|orthonormal"):
        tracker.step_into(buffer)
    np.testing.assert_array_equal(buffer.state, state)
    np.testing.assert_array_equal(buffer.out, out)


@pytest.mark.parametrize(
    ("twist", "words"),
    [
        (np.zeros(5), r"shape \(5,\).*give a Twist"),
        ((0, 0, 0), r"shape \(3,\).*give a Twist"),
        (((0, 0), (0, 0)), r"shape \(2, 2\).*give a Twist"),
        (np.full(6, NAN), "nan.*finite"),
        ((np.array([NAN, 0, 0]), np.zeros(3)), "(?i)nan.*(in)?finite"),
        ((np.zeros(3), np.array([0, 0, INF])), "(?i)inf"),
        (((0, 0, 0), (0, 0, INF)), "inf.*finite"),
        ("fast", "'fast'.*give a Twist"),
    ],
)
def test_twists(twist, words):
    tracker = so.Tracker(LENS, POINT)
    state = tracker.start(HOME, AWAY)
    for given in ((twist, None), (None, twist), (REST, twist)):
        with pytest.raises(ValueError, match=f"(?s){words}"):
            tracker.start(HOME, AWAY, *given)
        with pytest.raises(ValueError, match=f"(?s){words}"):
            tracker.step(state, HOME, AWAY, *given)


NOT_POSITIVE = [(0, "0.0"), (-1.5, "-1.5"), (NAN, "nan"), ("fast", "'fast'"), (None, "None")]


@pytest.mark.parametrize("name", ["dt", "gain", "tolerance"])
@pytest.mark.parametrize(("value", "shown"), [*NOT_POSITIVE, (INF, "inf")])
def test_numbers_that_are_not_positive(name, value, shown):
    # Without a gain there is the default one; an infinite tolerance means one correction.
    if (name, value) in (("gain", None), ("tolerance", INF)):
        so.PaperLaw(**{name: value})
        return
    made = partial(so.Tracker, LENS, POINT) if name == "dt" else so.PaperLaw
    with pytest.raises(ValueError, match=f"{name} = {shown}.*(positive|finite|not a number)"):
        made(**{name: value})


@pytest.mark.parametrize(("value", "shown"), [*NOT_POSITIVE[:-1], (INF, "inf")])
def test_steps_that_are_not_positive(value, shown):
    tracker = so.Tracker(LENS, POINT)
    state = tracker.start(HOME, AWAY)
    with pytest.raises(ValueError, match=f"dt = {shown}.*(positive|finite|not a number)"):
        tracker.step(state, HOME, AWAY, dt=value)
    with pytest.raises(ValueError, match=f"dt = {shown}.*(positive|finite|not a number)"):
        tracker.step_into(tracker.buffer(state), dt=value)
    with pytest.raises(ValueError, match=f"dt = {shown}.*(positive|finite|not a number)"):
        so.max_gain("heun", value)


@pytest.mark.parametrize(
    ("law", "options", "words"),
    [
        (so.PredictorCorrector, {"predictor": "feed-forward"}, "Did you mean 'feedforward'"),
        (so.PredictorCorrector, {"depth": None}, "depth = None: give 'global' or 'local'"),
        (so.PaperLaw, {"integrator": "rk5"}, "integrator = 'rk5'.*Did you mean 'rk4'"),
        (so.PaperLaw, {"feedforward": 1}, "feedforward = 1: must be True or False"),
    ],
)
def test_unknown_names(law, options, words):
    with pytest.raises(ValueError, match=words):
        law(**options)


@pytest.mark.parametrize(
    ("integrator", "limit"), [("euler", 2e3), ("heun", 2e3), ("midpoint", 2e3), ("rk4", 2785.29)]
)
def test_gains_that_are_not_stable(integrator, limit):
    so.Tracker(LENS, POINT, 1e-3, so.PaperLaw(integrator=integrator, gain=0.999 * limit))
    law = so.PaperLaw(integrator=integrator, gain=1.001 * limit)
    with pytest.raises(ValueError, match=f"gain = {1.001 * limit}.*{integrator}.*stay below"):
        so.Tracker(LENS, POINT, 1e-3, law)
    with pytest.raises(ValueError, match="integrator = 'rk5'"):
        so.max_gain("rk5", 1e-3)


@pytest.mark.parametrize("body", ["lens", None, LENS.reals])
def test_what_is_no_body(body):
    for pair in ((body, POINT), (POINT, body)):
        with pytest.raises(TypeError, match=r"is not a Body: make one with so\.shapes"):
            so.Tracker(*pair)
        with pytest.raises(TypeError, match=r"is not a Body: make one with so\.shapes"):
            so.distance(*pair, HOME, AWAY)


def test_bodies_that_are_no_pair():
    with pytest.raises(ValueError, match=r"Two half-spaces.*must be bounded"):
        so.Tracker(so.shapes.halfspace(), so.shapes.halfspace())
    for other in (LENS, so.shapes.segment(1.0), so.shapes.halfspace()):
        for pair in ((DISC, other), (other, DISC)):
            with pytest.raises(ValueError, match=r"planar partner.*Body"):
                so.Tracker(*pair)


@pytest.mark.parametrize(
    ("pose", "words"),
    [
        ((np.eye(3), (3, 0, 0.1)), "z = 0.1"),
        (([[1, 0, 0], [0, 0, -1], [0, 1, 0]], (3, 0, 0)), "tilt 1,"),
        ((np.diag([1.0, -1, -1]), (3, 0, 0)), "turn about z"),
    ],
)
def test_poses_out_of_the_plane(pose, words):
    for other in (POINT, DISC):
        with pytest.raises(ValueError, match=f"pose_b takes a planar body out of z = 0.*{words}"):
            so.distance(other, DISC, HOME, pose)
        with pytest.raises(ValueError, match=f"pose_a takes a planar body out of z = 0.*{words}"):
            so.distance(DISC, other, pose, HOME)


def test_a_frame_in_place_out_of_the_plane():
    tracker = so.Tracker(DISC, POINT)
    buffer = tracker.buffer(tracker.start(HOME, AWAY))
    buffer.pose_b[9:] = 3.0, 0.0, 0.1
    before = buffer.state.copy()
    with pytest.raises(ValueError, match=r"pose_b takes a planar body out of z = 0.*z = 0\.1"):
        tracker.step_into(buffer)
    np.testing.assert_array_equal(buffer.state, before)


@pytest.mark.parametrize(
    ("feature", "parameters", "words"),
    [
        (("face", 7), (0, 0), "no face 7.*numbered from 0"),
        (("face", -1), (0, 0), "no face -1"),
        (("corner", 0), (), "no corner 0"),
        (("face", 0), (0,), r"face takes 2 .*\(0,\)"),
        (("face", 0), (NAN, 0), r"face takes 2 finite.*nan"),
        (("edge", 0), (0, 0), r"edge takes 1 .*\(0, 0\)"),
        (("vertex", 0), (1,), r"vertex takes 0 .*\(1,\)"),
        (("face", 0), (50, 0), "50.*outside face 0"),
        (("edge", 0), (9.0,), r"9.0 lies outside edge 0: \[-1.32"),
    ],
)
def test_features_and_parameters(feature, parameters, words):
    for tracker, order in ((so.Tracker(LENS, POINT), 1), (so.Tracker(POINT, LENS), -1)):
        given = [(feature, parameters), (("vertex", 0), ())][::order]
        with pytest.raises(ValueError, match=words):
            tracker.start_from(HOME, AWAY, *given)


def test_charts_that_a_face_does_not_have():
    tracker = so.Tracker(so.shapes.ellipsoid(1, 2, 3), POINT)
    tracker.start_from(HOME, 4 * AWAY - 3 * HOME, (("face", 0), (0.1, 0.2, 5)), (("vertex", 0), ()))
    for chart in (6, -1, 0.5):
        with pytest.raises(ValueError, match=f"charts 0 to 5, not {chart}"):
            tracker.start_from(HOME, AWAY, (("face", 0), (0.1, 0.2, chart)), (("vertex", 0), ()))


def test_a_state_stored_by_another_version():
    """The kernels read and write a state by address: a shorter one would be overrun."""
    tracker = so.Tracker(LENS, POINT)
    state = tracker.start(HOME, AWAY)
    block = state.proximity._out
    for data in (block[:39].copy(), block[:120].copy(), block.astype(np.float32)):
        strange = so.TrackerState(so.Proximity(LENS, tracker.b, data))
        for ask in (
            lambda s=strange: tracker.step(s, HOME, AWAY),
            lambda s=strange: tracker.buffer(s),
        ):
            with pytest.raises(ValueError, match="stored by another version"):
                ask()


def test_names_and_numbers_of_another_type():
    with pytest.raises(TypeError, match=r"law = \['paper'\] is not a law: give so\.Predictor"):
        so.Tracker(LENS, POINT, law=["paper"])
    with pytest.raises(TypeError, match=r"PaperLaw is a class: .* law=so\.PaperLaw\(\)"):
        so.Tracker(LENS, POINT, law=so.PaperLaw)
    with pytest.raises(ValueError, match="dt = '1e-3' is not a number"):
        so.Tracker(LENS, POINT, dt="1e-3")


def test_states_and_buffers_of_another_pair():
    """Their feature numbers would lead outside this pair's arrays."""
    tracker = so.Tracker(LENS, POINT)
    for pair, body in (((BOX, POINT), "A"), ((LENS, BOX), "B"), ((POINT, LENS), "A")):
        other = so.Tracker(*pair)
        strange = other.start(HOME, AWAY)
        with pytest.raises(ValueError, match=f"belongs to another pair: its body {body} is <Body"):
            tracker.step(strange, HOME, AWAY)
        with pytest.raises(ValueError, match=f"belongs to another pair: its body {body} is <Body"):
            tracker.buffer(strange)
    # The same bodies made again are no other pair.
    again = so.Tracker(so.shapes.lens(1.0, 0.45), so.shapes.point())
    assert tracker.step(again.start(HOME, AWAY), HOME, AWAY)[1].certified
    with pytest.raises(ValueError, match=r"buffer belongs to another tracker: .*tracker\.buffer"):
        tracker.step_into(other.buffer(other.start(HOME, AWAY)))
    with pytest.raises(TypeError, match=r"None is not a TrackerState: .*tracker\.start"):
        tracker.step(None, HOME, AWAY)


@pytest.mark.parametrize("feature", ["face 0", "face", None, ("face", 0.5), ("face", "0"), 3])
def test_what_is_no_feature(feature):
    tracker = so.Tracker(LENS, POINT)
    with pytest.raises((ValueError, TypeError), match="feature"):
        tracker.start_from(HOME, AWAY, (feature, (0, 0)), (("vertex", 0), ()))


def test_what_is_no_state_or_answer_is_named():
    box = so.shapes.box(1, 1, 1)
    tracker = so.PointTracker(box)
    with pytest.raises(TypeError, match="PointState"):
        tracker.step(None, (0, 0, 0))
    state = so.Tracker(box, box).start(so.Pose.identity(), so.Pose.exp([0, 0, 0], [3, 0, 0]))
    with pytest.raises(TypeError, match="not an answer"):
        so.witness_set(state)


@pytest.mark.parametrize("given", [(0, 0, 0), None, 3, "face"])
def test_a_place_is_a_feature_and_its_parameters(given):
    tracker = so.Tracker(LENS, POINT)
    with pytest.raises(so.StandoffError, match=r"place_a = .*give \(feature, parameters\)"):
        tracker.start_from(HOME, AWAY, given, (("vertex", 0), ()))
    with pytest.raises(so.StandoffError, match=r"place_b = .*give \(feature, parameters\)"):
        tracker.start_from(HOME, AWAY, (("face", 0), (0.1, 0.2)), given)


def test_an_answers_places_begin_the_same_frame():
    tracker = so.Tracker(LENS, so.shapes.ellipsoid(0.5, 0.4, 0.3), law=so.PaperLaw())
    best = so.distance(tracker.a, tracker.b, HOME, AWAY)
    begun = tracker.start_from(HOME, AWAY, best.place_a, best.place_b).proximity
    assert (begun.place_a, begun.place_b) == (best.place_a, best.place_b)
    assert begun.distance == best.distance
