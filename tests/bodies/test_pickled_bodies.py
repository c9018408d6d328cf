"""Bodies that go to another process: formulas are compiled there, at other addresses."""

import pickle
import subprocess
import sys
from functools import cache
from itertools import pairwise

import numpy as np
import pytest

import standoff as so
from standoff.geometry import FormulaCurve, FormulaSurface, Revolution

READ = """
import pickle, sys
import numpy as np
import standoff as so
block = [bytearray(1 << 20) for _ in range(7)]  # another layout of the process's memory
body, other, pose = pickle.loads(sys.stdin.buffer.read())
answer = so.distance(body, other, so.Pose(np.eye(3)), pose)
print(repr(answer.distance), body.digest, answer.status.name)
"""


def formula_ball(scale):
    """Six gnomonic patches of an ellipsoid, as formulas."""
    root = "/sqrt(1 + u**2 + v**2)"
    u, v, w = f"{scale}*u{root}", f"v{root}", "0.7/sqrt(1 + u**2 + v**2)"
    rows = [(u, v, w), (u, f"-({v})", f"-({w})")]
    turned = (f"{scale}*1{root}", f"u{root}", f"0.7*v{root}")
    rows += [turned, (f"-({turned[0]})", f"-({turned[1]})", turned[2])]
    side = (f"{scale}*v{root}", f"1{root}", f"0.7*u{root}")
    rows += [side, (side[0], f"-({side[1]})", f"-({side[2]})")]
    return so.Body.from_patches([FormulaSurface(*row, (-1, 1, -1, 1)) for row in rows])


@cache
def usual_ball():
    """Proven once: it takes seconds."""
    return formula_ball(1.2)


def revolved_formula(height=1.3):
    profile = FormulaCurve("cos(t)", "0", f"{height}*sin(t)", -np.pi / 2, np.pi / 2)
    turns = np.linspace(0.0, 2.0 * np.pi, 4)
    return so.Body.from_patches([Revolution(profile, a, b) for a, b in pairwise(turns)])


BODIES = {
    "formula": usual_ball,
    "revolved formula": revolved_formula,
    "lens": lambda: so.shapes.lens(1, 0.4),
    "superellipsoid": lambda: so.shapes.superellipsoid(1, 2, 3, 1.5, 0.5),
}


@pytest.mark.parametrize("name", BODIES)
def test_another_process_gets_the_same_answer_and_digest(name):
    body, other = BODIES[name](), so.shapes.box(1, 0.4, 0.3)
    pose = so.Pose(np.eye(3), [2.0, 1.5, -1.7])
    here = so.distance(body, other, so.Pose(np.eye(3)), pose)
    assert here.certified
    done = subprocess.run(
        [sys.executable, "-c", READ],
        input=pickle.dumps((body, other, pose)),
        capture_output=True,
        check=True,
    )
    assert done.stdout.decode().split() == [repr(here.distance), body.digest, "CONVERGED"]


READ_TRACKER = """
import pickle, sys
import numpy as np
block = [bytearray(1 << 20) for _ in range(7)]  # another layout of the process's memory
tracker, state, pose = pickle.loads(sys.stdin.buffer.read())
state, answer = tracker.step(state, np.eye(4), pose)
print(repr(answer.distance), answer.status.name)
"""


def test_a_tracker_goes_on_in_another_process():
    """It must not call formulas at the addresses that they had here."""
    tracker = so.Tracker(usual_ball(), so.shapes.box(1, 0.4, 0.3))
    pose = so.Pose(np.eye(3), [2.0, 1.5, -1.7])
    state = tracker.start(np.eye(4), pose)
    _, here = tracker.step(state, np.eye(4), pose)
    done = subprocess.run(
        [sys.executable, "-c", READ_TRACKER],
        input=pickle.dumps((tracker, state, pose)),
        capture_output=True,
        check=True,
    )
    assert done.stdout.decode().split() == [repr(here.distance), "CONVERGED"]


def test_digests_tell_formulas_apart():
    digests = {revolved_formula(height).digest for height in (1.3, 1.3, 1.35)}
    assert len(digests) == 2
