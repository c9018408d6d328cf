"""Every example gives the start the twists that it gives the steps.

A frame of a law is integrated, or predicted, from the velocities at both of its ends. A start
without them spoils the first frames: the printed law ends its first one with errors of 1.5e-3
instead of 1.9e-9.
"""

import ast
import json
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import standoff as so
from standoff.motion import Helix

ROOT = Path(__file__).parents[1]
FENCE = re.compile(r"^```python\n(.*?)^```$", re.DOTALL | re.MULTILINE)
# The number of positional arguments before the twists, by method of a tracker and of a world.
BEFORE = {"start": 2, "start_from": 4, "step": 3, "step_into": 3, "run": 3}
BEFORE_OF_WORLDS = {"start": 1, "step": 2, "run": 2}
OTHERS = ("coupler", "operator", "robot", "servo")  # stepped by other things than poses


def pages() -> list[Path]:
    kept = [ROOT / "README.md", *ROOT.glob("docs/**/*.md"), *ROOT.glob("docs/**/*.py")]
    return sorted([*kept, *ROOT.glob("examples/**/*.py"), *ROOT.glob("examples/**/*.ipynb")])


def sources(path: Path) -> str:
    """The Python code of a page, a notebook or a program; that of a page as one program."""
    text = path.read_text("utf-8")
    if path.suffix == ".ipynb":
        cells = [c for c in json.loads(text)["cells"] if c["cell_type"] == "code"]
        return "\n".join("".join(c["source"]) for c in cells)
    return text if path.suffix == ".py" else "\n".join(FENCE.findall(text))


def told(code: str) -> Iterator[tuple[str, str, bool]]:
    """(object, method, is it given twists?) of each call of a tracker or a world."""
    for node in ast.walk(ast.parse(code)):
        if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Attribute):
            continue
        owner, method = ast.unparse(node.func.value), node.func.attr
        if owner in OTHERS:
            continue
        before = (BEFORE_OF_WORLDS if "world" in owner else BEFORE).get(method)
        if before is not None:
            named = any((word.arg or "").startswith("twist") for word in node.keywords)
            yield owner, method, named or len(node.args) > before


def forgetful(code: str) -> set[str]:
    """The trackers and worlds that are stepped with twists, and started without."""
    calls = list(told(code))
    moved = {owner for owner, method, twists in calls if twists and not method.startswith("start")}
    return moved & {o for o, method, twists in calls if method.startswith("start") and not twists}


@pytest.mark.parametrize("path", pages(), ids=lambda p: str(p.relative_to(ROOT)))
def test_the_start_is_given_the_twists_of_the_steps(path: Path) -> None:
    assert not forgetful(sources(path)), f"{path}: give start its twists, too"


def test_docstrings_too() -> None:
    for path in (ROOT / "src").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
                for code in FENCE.findall(ast.get_docstring(node) or ""):
                    assert not forgetful(code), path


def test_who_forgets_is_found() -> None:
    step = "state, answer = tracker.step(state, rest, pose, twist_b=twist)\n"
    assert forgetful("state = tracker.start(rest, pose)\n" + step) == {"tracker"}
    assert not forgetful("state = tracker.start(rest, pose, None, twist)\n" + step)
    assert forgetful("s = world.start(poses)\nworld.step(s, poses, twists)") == {"world"}
    places = "tracker.start_from(rest, pose, on_a, on_b, settle=False)\n"
    assert forgetful(places + step) == {"tracker"}


def test_what_a_start_without_twists_costs() -> None:
    """Both of the paper's own integrator: the first frame's errors, and for how long they show."""
    rest, path = so.Pose.identity(), Helix(radius=1.2, pitch=0.4, rate=2.0)
    bodies = so.shapes.lens(1.0, 0.45), so.shapes.ellipsoid(0.15, 0.30, 0.20)
    tracker = so.Tracker(*bodies, law=so.PaperLaw.as_printed(gain=100.0))
    errors = []
    for twist in (path.twist(0.0), None):
        state, seen = tracker.start(rest, path.pose(0.0), twist_b=twist), []
        for t in 1e-3 * np.arange(1, 101):
            state, answer = tracker.step(state, rest, path.pose(t), twist_b=path.twist(t))
            seen.append(answer.residual)
        errors.append(np.array(seen))
    with_twist, without = errors
    assert with_twist[0] < 1e-8
    assert 1e-3 < without[0] < 2e-3
    assert np.flatnonzero(without > 2.0 * with_twist)[-1] >= 60
