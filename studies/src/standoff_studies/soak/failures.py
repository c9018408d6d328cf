"""Files that reproduce a failure, and rerunning them."""

from __future__ import annotations

import math
import traceback
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from standoff.checks.numbers import whole_number
from standoff.kernels.entries import tracker as kernels
from standoff.kernels.state import arrays as K
from standoff.kernels.tolerances import ROTATION
from standoff.tracking.block import FrameBlock
from standoff.tracking.tracker import Tracker
from standoff.typing import Array
from standoff.version import __version__
from standoff_studies.soak.adversary import Breach, run_round
from standoff_studies.soak.cases import Case
from standoff_studies.soak.checks import Fault, judge
from standoff_studies.soak.motions import Frames
from standoff_studies.soak.reading import entry, mapping, number, numbers, read_facts, text
from standoff_studies.soak.running import Failure, run_case, start
from standoff_studies.soak.shapes import Made, made
from standoff_studies.soak.world_checks import WorldFault, run_world

Facts = dict[str, Any]

KIND = "standoff soak failure"

MOST_TOLD = 20
"""Faults of a world that its file lists."""


class Replayed(NamedTuple):
    """The result of rerunning a failure's file.

    Attributes
    ----------
    failure : Failure or None
        Of the whole pair, rerun from its first frame.
    step : Fault or None
        Of the single step, from the state in the file.
    breach : Breach or None
        Of the adversary's round, rerun.
    world : WorldFault or None
        Of the drawn world, rerun.
    """

    failure: Failure | None
    step: Fault | None
    breach: Breach | None = None
    world: WorldFault | None = None


def failure_facts(failure: Failure) -> Facts:
    """Return a failure as plain data: the case, and the step with the state before it."""
    case, fault = failure.case, failure.fault
    facts = _told(fault.what, fault.value, fault.allowed) | {
        "frame": fault.frame,
        "cold": failure.cold,
        "case": case.facts(),
    }
    try:
        facts["step"] = _step_facts(case, fault.frame)
    except Exception:
        facts["step_unknown"] = traceback.format_exc()
    return facts


def breach_facts(breach: Breach) -> Facts:
    """Return a failure found by the adversary as plain data."""
    miss = breach.miss
    return _told(miss.what, miss.value, miss.allowed) | {
        "round": {"seed": breach.seed, "number": breach.number, "cases": breach.cases},
        "asked": miss.case,
        "about": _plain(breach.facts),
    }


def world_facts(seed: int, number: int, frames: int, faults: list[WorldFault]) -> Facts:
    """Return what failed in a drawn world as plain data: seed and number repeat it."""
    first = faults[0]
    return _told(first.what, first.value, first.allowed) | {
        "world": {"seed": seed, "number": number, "frames": frames},
        "faults": [_plain(fault._asdict()) for fault in faults[:MOST_TOLD]],
    }


def _plain(value: Any) -> Any:
    """Numbers that are not finite as words, because JSON has no numbers for them."""
    if isinstance(value, dict):
        return {name: _plain(one) for name, one in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    return _number(value) if isinstance(value, float) else value


def exception_facts(seed: int, number: int, frames: int, text: str) -> Facts:
    """Return an exception, a crash or a hang of a pair as plain data, without answers."""
    return _told(text) | {"seed": seed, "number": number, "frames": frames}


def _told(what: str, *measured: float) -> Facts:
    """What every failure contains: what failed, and for a check the value and what is allowed."""
    numbers = zip(("value", "allowed"), map(_number, measured), strict=False)
    return {"kind": KIND, "standoff": __version__, "what": what, **dict(numbers)}


def _number(value: float) -> float | str:
    return float(value) if math.isfinite(value) else str(float(value))


def _numbers(array: Array) -> list[float | str]:
    return [_number(x) for x in array.tolist()]


def _step_facts(case: Case, k: int) -> Facts:
    """The poses, twists and step of frame k, the tracker's state before it, and its answer."""
    _, _, frames, tracker = _ready(case)
    state, row = np.zeros(K.N_STATE), np.empty(K.N_OUT)
    start(tracker, frames, 0, case.motion.twists, state, row)
    before = state.copy()
    for at in range(1, k + 1):
        before = state.copy()
        _step(tracker, frames.part(np.array([at])), case.motion.twists, state, row)
    return {
        name: _numbers(array[k]) for name, array in zip(frames._fields[:4], frames[:4], strict=True)
    } | {
        "step": float(frames.steps[k]),
        "state": _numbers(before) if k else None,
        "answer": _numbers(row),
    }


def _ready(case: Case) -> tuple[Made, Made, Frames, Tracker]:
    a, b = made(case.a), made(case.b)
    tracker = Tracker(a.body, b.body, case.motion.step, case.law)
    return a, b, case.motion.frames(case.frames), tracker


def _step(tracker: Tracker, one: Frames, has_twist: bool, state: Array, row: Array) -> int:
    """Answer one frame; return FINE, or what was rejected."""
    block = FrameBlock.empty(state, one.motions[0], float(one.steps[0]), has_twist)
    done = int(kernels.step(tracker.table.address, block.data))
    state[:], row[:] = block.state, block.out
    return done


def read_failure(file: Path) -> Facts:
    """Return the contents of a failure's file.

    Raises
    ------
    OSError
        It cannot be read.
    ValueError
        It is not such a file, or damaged.
    """
    facts = read_facts(file)
    if facts.get("kind") != KIND:
        raise ValueError(f"it is not a failure of a soak: its 'kind' is not '{KIND}'")
    text(entry(facts, "what"), "'what'")
    if "round" in facts:
        numbers_of = mapping(facts["round"], "'round'")
        for name, least in (("seed", 0), ("number", 0), ("cases", 1)):
            whole_number(entry(numbers_of, name), f"the round's '{name}'", least)
        for name in ("value", "allowed"):
            number(entry(facts, name), f"'{name}'")
        whole_number(entry(facts, "asked"), "'asked'", 0)
        return facts
    if "world" in facts or "case" not in facts:
        known = mapping(facts["world"], "'world'") if "world" in facts else facts
        for name, least in (("seed", 0), ("number", 0), ("frames", 1)):
            whole_number(entry(known, name), f"'{name}'", least)
        return facts
    case = mapping(facts["case"], "'case'")
    for name, least in (("seed", 0), ("number", 0), ("frames", 1)):
        whole_number(entry(case, name), f"the case's '{name}'", least)
    mapping(entry(case, "options"), "the case's 'options'")
    if whole_number(entry(facts, "frame"), "'frame'", 0) >= case["frames"]:
        raise ValueError(f"'frame' is {facts['frame']}, beyond the case's {case['frames']} frames")
    for name in ("value", "allowed"):
        number(entry(facts, name), f"'{name}'")
    if not isinstance(entry(facts, "cold"), bool):
        raise ValueError(f"'cold' is {facts['cold']!r}, not true or false")
    if facts.get("step") is not None:
        _read_step(mapping(facts["step"], "'step'"))
    return facts


def _read_step(step: Facts) -> None:
    for name, count in (("poses_a", 12), ("poses_b", 12), ("twists_a", 6), ("twists_b", 6)):
        numbers(entry(step, name), f"the step's '{name}'", count)
    number(entry(step, "step"), "the step's 'step'")
    if entry(step, "state") is not None:
        numbers(step["state"], "the step's 'state'")


def replay(facts: Facts) -> Replayed:
    """Rerun a failure's case, and its step alone.

    Raises
    ------
    ValueError
        The file does not fit this version.
    """
    if "round" in facts:
        _, breaches = run_round(**{k: facts["round"][k] for k in ("seed", "number", "cases")})
        return Replayed(None, None, breaches[0] if breaches else None)
    if "world" in facts:
        _, faults = run_world(**{k: facts["world"][k] for k in ("seed", "number", "frames")})
        return Replayed(None, None, None, faults[0] if faults else None)
    if "case" not in facts:
        from standoff_studies.soak.cases import draw_case

        return Replayed(
            run_case(*draw_case(facts["seed"], facts["number"], facts["frames"]))[1], None
        )
    try:
        case = Case.of(facts["case"])
        a, b, frames, tracker = _ready(case)
    except (
        ArithmeticError,
        AttributeError,
        LookupError,
        MemoryError,
        TypeError,
        ValueError,
    ) as error:
        # anything that a body, a path or a tracker may raise for damaged numbers
        why = str(error).splitlines()[0] if str(error) else type(error).__name__
        if isinstance(error, KeyError):
            why = f"{why} is missing"
        raise ValueError(f"the file's case is none of this version: {why}") from error
    if not _is_motion(frames):
        raise ValueError("the file's motion has invalid poses, twists or steps")
    _, failure = run_case(case, a, b, frames)
    return Replayed(failure, _stepped(facts, case, a, b, tracker))


def _is_motion(frames: Frames) -> bool:
    """Are all numbers finite, steps positive, and rotations orthonormal?"""
    if not all(np.isfinite(array).all() for array in frames) or frames.steps.min() <= 0.0:
        return False
    turns = np.concatenate([frames.poses_a, frames.poses_b])[:, :9].reshape(-1, 3, 3)
    return bool(np.abs(turns @ turns.transpose(0, 2, 1) - np.eye(3)).max() <= ROTATION)


def _stepped(facts: Facts, case: Case, a: Made, b: Made, tracker: Tracker) -> Fault | None:
    step = facts.get("step")
    if step is None or step["state"] is None or len(step["state"]) != K.N_STATE:
        return None
    one = Frames(
        _array(step["poses_a"])[None],
        _array(step["poses_b"])[None],
        _array(step["twists_a"])[None],
        _array(step["twists_b"])[None],
        np.array([step["step"]]),
    )
    row = np.empty((1, K.N_OUT))
    if _step(tracker, one, case.motion.twists, _array(step["state"]), row[0]) != K.FINE:
        raise ValueError("the file's step holds no pose or twist")
    tolerance = tracker.law.tolerance
    faults = judge(a, b, one, row, tolerance, case.motion.twists).faults
    return faults[0]._replace(frame=facts["frame"]) if faults else None


def _array(numbers: list[float | str]) -> Array:
    return np.array([float(x) for x in numbers])
