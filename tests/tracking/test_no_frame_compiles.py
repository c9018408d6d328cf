"""No frame waits for the compiler: what a loop can meet is loaded before it begins."""

import json
import os
import subprocess
import sys
import textwrap

import numpy as np
import pytest

import standoff as so
from standoff.kernels.entries import queries
from standoff.kernels.entries import tracker as kernels

JITTED = os.environ.get("NUMBA_DISABLE_JIT", "0") in ("", "0")
pytestmark = pytest.mark.skipif(not JITTED, reason="nothing is compiled under NUMBA_DISABLE_JIT")

# In a process of its own: in this one other tests have loaded what is asked for here.
WATCH = """
import json, pickle, sys
import numpy as np
import standoff as so
from numba.core import event
from standoff.kernels.compiler.cache import ModuleCache

asked = []
load = ModuleCache.load_overload
def counted(self, signature, context):
    asked.append(self._function.__name__)
    return load(self, signature, context)
ModuleCache.load_overload = counted

class Compiled(event.Listener):
    def on_start(self, one):
        asked.append(str(one.data["dispatcher"]))
    def on_end(self, one):
        pass
event.register("numba:compile", Compiled())

def pose(x, y=0.0, z=0.0, turn=0.0):
    T = np.eye(4)
    T[:2, :2] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
    T[:3, 3] = x, y, z
    return T

def loop(tracker, state, poses, **given):
    seen = set()
    for each in poses:
        state, answer = tracker.step(state, pose(0.0), each, **given)
        seen.add(answer.status.name)
        if answer.events:
            seen.add("switch")
    return state, seen

def tell(seen=()):
    print(json.dumps({"asked": asked, "seen": sorted(seen)}))
"""


def watched(code: str) -> dict[str, list[str]]:
    """What a process asked the cache or the compiler for after `asked.clear()`."""
    run = subprocess.run(
        [sys.executable, "-c", WATCH + textwrap.dedent(code)],
        capture_output=True,
        text=True,
        timeout=400,
    )
    assert run.returncode == 0, run.stderr
    return dict(json.loads(run.stdout.splitlines()[-1]))


def test_a_first_switch_overlap_and_search_compile_nothing():
    told = watched("""
        a, b = so.shapes.lens(1.0, 0.45), so.shapes.box(0.4, 0.5, 0.3)
        tracker = so.Tracker(a, b, 1e-2)
        state = tracker.start(pose(0.0), pose(2.0, 0.4, 0.1))
        buffer = tracker.buffer(state)
        asked.clear()
        path = [pose(2.0 - 0.02 * k, 0.4 - 0.01 * k, 0.1, 0.03 * k) for k in range(120)]
        state, seen = loop(tracker, state, path)
        tracker.step_into(buffer, pose(0.0), path[-1])
        tracker.step_into(buffer)
        # from a start deep inside, with a deadline, and where nothing proves an answer
        hasty = so.Tracker(a, b, 1e-2, so.PredictorCorrector(deadline=3))
        _, more = loop(hasty, hasty.start(pose(0.0), pose(0.05)), path)
        tell(seen | more)
    """)
    assert told["asked"] == []
    assert {"CONVERGED", "GLOBAL", "switch"} <= set(told["seen"])


def test_the_kind_of_array_that_holds_a_pose_compiles_nothing():
    told = watched("""
        tracker = so.Tracker(so.shapes.ellipsoid(0.3, 0.5, 0.4), so.shapes.sphere(0.2), 1e-2)
        state = tracker.start(pose(0.0), pose(2.0))
        asked.clear()
        frozen = pose(2.0, 0.1)
        frozen.flags.writeable = False
        single, columns = pose(2.0).astype(np.float32), np.asfortranarray(pose(2.0))
        value = so.Pose(np.eye(3), [2.0, 0.0, 0.0])
        kinds = [frozen, single, columns, pose(2.0).tolist(), value, (np.eye(3), [2, 0, 0])]
        still = np.zeros(3)
        still.flags.writeable = False
        for given in kinds:
            for twist in (None, so.Twist([0, 0, 0], [0, 0, 1]), (still, still), ([0] * 3, [0] * 3)):
                state, _ = tracker.step(state, pose(0.0), given, twist_b=twist)
        state, _ = tracker.step(state, pose(0.0), pose(2.0), dt=np.float32(0.01))
        state, _ = tracker.step(state, pose(0.0), pose(2.0), dt=1)
        tell()
    """)
    assert told["asked"] == []


def test_unpickled_bodies_trackers_and_states_compile_nothing():
    told = watched("""
        tracker = so.Tracker(so.shapes.lens(1.0, 0.45), so.shapes.capsule(0.2, 0.5), 1e-2)
        state = tracker.start(pose(0.0), pose(2.0))
        stored = pickle.dumps((tracker, state, tracker.a, tracker.b))
        asked.clear()
        tracker, state, a, b = pickle.loads(stored)
        state, _ = loop(tracker, state, [pose(2.0 - 0.01 * k) for k in range(20)])
        again = so.Tracker(a, b, 1e-2)
        loop(again, again.start(pose(0.0), pose(2.0)), [pose(2.0 - 0.05 * k) for k in range(40)])
        tell()
    """)
    assert told["asked"] == []


def test_the_papers_law_and_recorded_runs_compile_nothing_in_a_frame():
    told = watched("""
        a, b = so.shapes.lens(1.0, 0.45), so.shapes.box(0.4, 0.5, 0.3)
        tracker = so.Tracker(a, b, 1e-2, so.PaperLaw(switching="voronoi"))
        asked.clear()
        state = tracker.start(pose(0.0), pose(2.0, 0.4, 0.1))
        twist = so.Twist([-2.0, -1.0, 0.0], [0.0, 0.0, 0.0])
        path = [pose(2.0 - 0.02 * k, 0.4 - 0.01 * k, 0.1) for k in range(110)]
        _, seen = loop(tracker, state, path, twist_b=twist)
        frames = list(asked)
        from standoff.motion import Helix
        way = Helix(radius=1.2, pitch=0.4, rate=2.0)
        # the second run asks for nothing that the first did not prepare
        still = so.Pose(np.eye(3), [3.0, 0.0, 0.0])
        so.track(so.Tracker(a, b), so.Pose.identity(), still, 0.01)
        asked.clear()
        found = so.track(so.Tracker(a, b), so.Pose.identity(), way, 2.0)
        assert found.events
        asked[:0] = frames
        tell(seen)
    """)
    assert told["asked"] == []


def test_a_first_formula_body_compiles_its_own_formula_before_the_loop():
    pytest.importorskip("sympy")
    told = watched("""
        import sys
        sys.path[:0] = ["tests"]
        from families.formula_bodies import power_ball
        body = power_ball(np.random.default_rng(1)).body
        tracker = so.Tracker(so.shapes.sphere(0.3), body, 1e-2)
        asked.clear()
        path = [pose(3.0 - 0.03 * k) for k in range(90)]
        loop(tracker, tracker.start(pose(0.0), path[0]), path)
        tell()
    """)
    assert told["asked"] == []


def test_an_array_of_the_wrong_kind_is_refused_and_compiles_nothing():
    tracker = so.Tracker(so.shapes.sphere(0.3), so.shapes.sphere(0.2), 1e-2)
    state = tracker.start(np.eye(4), so.Pose(np.eye(3), [2.0, 0.0, 0.0]))
    before = len(kernels.step.signatures)
    frozen = state.data.copy()
    frozen.flags.writeable = False
    with pytest.raises(TypeError, match="block is readonly array"):
        kernels.step(tracker.table.address, frozen)
    with pytest.raises(TypeError):  # of a terse entry, whose caller converts them
        kernels.value(tracker.table.address, *[frozen] * 5, 1e-2, frozen)
    with pytest.raises(TypeError, match="reals is array\\(float32"):
        queries.curve_jet(np.zeros(3, dtype=np.float32), 0, 0, 0.5)
    assert len(kernels.step.signatures) == before
    assert len(kernels.value.signatures) == before
