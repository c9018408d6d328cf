"""Pickles and deep copies: what could not be written in the object cannot be written in them."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numba import typeof

import standoff as so
from families.array_flags import writable
from public_calls import Call, calls, pair_calls
from standoff import geometry
from standoff.bound_to_run import BoundToRun
from standoff.geometry import FormulaCurve, Revolution

NO_FILE = ("motion.read_pose_samples", "standoff.open_recording")
CALLS = [call for call in (*calls(), *pair_calls()) if call.name not in NO_FILE]

STORED: dict[str, Callable[[Any], Any]] = {
    "pickle": lambda value: pickle.loads(pickle.dumps(value)),
    "oldest pickle": lambda value: pickle.loads(pickle.dumps(value, 2)),
    "deep copy": copy.deepcopy,
    "copy": copy.copy,
    "twice": lambda value: copy.deepcopy(pickle.loads(pickle.dumps(value))),
}

AWAY = so.Pose(np.eye(3), [3.0, 0.2, 0.1])


def formula_body() -> so.Body:
    profile = FormulaCurve("cos(t)", "0", "1.3*sin(t)", -np.pi / 2, np.pi / 2)
    turns = (0.0, 2.0, 4.0, 2.0 * np.pi)
    return so.Body.from_patches([Revolution(profile, a, b) for a, b in pairwise(turns)])


def tracked(a: so.Body, b: so.Body, law: Any) -> dict[str, Any]:
    tracker = so.Tracker(a, b, law=law)
    state = tracker.start(np.eye(4), AWAY, so.Twist.zero(), so.Twist.zero())
    _, answers = tracker.run(state, np.eye(4), np.stack([AWAY.matrix] * 2))
    state, answer = tracker.step(state, np.eye(4), AWAY, so.Twist.zero(), so.Twist.zero())
    return {
        "tracker": tracker,
        "state": state,
        "answer": answer,
        "buffer": tracker.buffer(state),
        "witness set": answer.witness_set(),
        "patch": answer.patch(1e-3),
        "patches": answers.patches(1e-3),
        "all": {"tracker": tracker, "states": [state, (state,)]},
    }


def same(value: Any) -> None:
    # a recording's paths, which may be functions, are not stored
    fresh = {name: flag for name, flag in writable(value).items() if ".paths[" not in name}
    for how, stored in STORED.items():
        assert writable(stored(value)) == fresh, how


def bound(call: Call) -> bool:
    return isinstance(call.public, type) and issubclass(call.public, BoundToRun)


@pytest.mark.parametrize("call", [c for c in CALLS if not bound(c)], ids=lambda call: call.name)
def test_every_public_object_keeps_what_is_read_only(call: Call) -> None:
    same(call.public(**call.arguments))


@pytest.mark.parametrize("call", [c for c in CALLS if bound(c)], ids=lambda call: call.name)
@pytest.mark.parametrize("how", STORED)
def test_what_belongs_to_one_run_says_that_it_cannot_be_stored(call: Call, how: str) -> None:
    live = call.public(**call.arguments)
    with pytest.raises(so.StandoffError, match=f"make another {type(live).__name__}"):
        STORED[how](live)


@pytest.mark.parametrize(
    "law", [so.PredictorCorrector(), so.PaperLaw(feedback=so.feedback.GainMatrix([1, 2, 3, 4]))]
)
def test_trackers_states_and_answers_keep_it(law: Any) -> None:
    pairs = [
        (so.shapes.lens(1.0, 0.4), so.shapes.box(1, 1, 1, rounding=0.1)),
        (formula_body(), so.shapes.superellipsoid(1, 2, 3, 0.5, 1.5)),
        (so.Body.from_patches(geometry.ellipsoid_octants(1, 2, 1)), so.shapes.egg(1, 3, 0.3)),
    ]
    for a, b in pairs:
        for value in tracked(a, b, law).values():
            assert writable(value)
            same(value)


def test_a_stored_body_is_of_the_same_type_to_the_kernels() -> None:
    """Else they would be compiled anew for it."""
    for body in (so.shapes.box(1, 1, 1), so.shapes.egg(1, 3, 0.3), formula_body()):
        tracker = so.Tracker(body, so.shapes.sphere(0.5))
        for how, stored in STORED.items():
            again = stored(tracker)
            read, own = again.table.arrays, tracker.table.arrays
            assert typeof(read) == typeof(own), how
            # What a tracker hands to the kernels are its bodies' own arrays, not a second copy.
            kept = (again.a.ints, again.a.reals, again.b.ints, again.b.reals)
            assert all(x is y for x, y in zip(read[:4], kept, strict=True)), how


def test_writing_to_a_stored_body_is_refused() -> None:
    body = so.shapes.box(1, 1, 1)
    for how, stored in STORED.items():
        again = stored(body)
        for array in (
            again.ints,
            again.reals,
            again.vertex_points,
            again.face_parts[0].charts[0].linear,
        ):
            with pytest.raises(ValueError, match="read-only"):
                array[...] = 0
        assert again.digest == body.digest, how
