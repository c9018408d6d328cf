"""What can be broken: every tracker of simulations A to E that follows the paper's law.

Only these runs are broken. What the statements compare them with stays: the library's own law, the
resets that are computed independently, the global searches.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from functools import cache
from importlib import import_module
from typing import Any
from unittest.mock import patch

from standoff.motion import Pose, Twist
from standoff.recording.track import track_along
from standoff.tracking import Tracker, TrackerState, max_gain
from standoff.tracking.laws import PaperLaw

PAPER = "standoff_studies.paper"

STILL_STABLE = 0.9995
"""Fraction of the greatest gain below which a broken gain is kept: a tracker accepts no more."""

TRACKERS = (
    "simulation_a.run",
    "simulation_b.printed",
    "pair_simulation",
    "simulation_e.own_point",
)
"""Modules that make the trackers of the figures, and run them."""

RUNS = {
    "simulation_a.run": ("run",),
    "simulation_a.errors": ("shown",),
    "simulation_a.snapshots": ("snapshot_run",),
    "simulation_a.gains": ("settling", "held", "greatest_feedforward"),
    "simulation_b.run": ("run",),
    "pair_simulation": ("printed_runs",),
    "simulation_c.run": ("snapshots",),
}
"""What is kept of the law's runs, and must be made again: that of the figures' runs,"""

TRIALS = {
    "simulation_a.gains": ("trials", "rescued", "small_error_limit", "steady"),
    "simulation_a.raw_law": ("growth_of_small_errors",),
    "simulation_b.run": ("arrivals",),
    "simulation_c.run": ("arrivals",),
    "simulation_d.runs": ("arrivals", "moves_by_resets"),
    "simulation_e.runs": ("arrivals", "moves_by_resets"),
    "simulation_e.own_point": ("decisions",),
}
"""and that of many starts and gains, which take longer."""


Claim = tuple[str, str]
"""A figure, and words of its statement."""


@dataclass(frozen=True)
class Break:
    """One way to break the law.

    Attributes
    ----------
    key, told : str
    law : callable
        The broken law, of the law and the frame time [s].
    backwards : bool
        The law is given the twists with the other sign, and so b.
    claims : tuple of (str, str)
        Figures, and words of their statements about what it breaks: each must fail.
    """

    key: str
    told: str
    law: Callable[[PaperLaw, float], PaperLaw] = lambda law, dt: law
    backwards: bool = False
    claims: tuple[Claim, ...] = ()

    @property
    def claimed_by(self) -> set[str]:
        """The figures that claim what it breaks."""
        return {figure for figure, _ in self.claims}


def times(part: float) -> Callable[[PaperLaw, float], PaperLaw]:
    """Return a change that multiplies the gain, as far as it stays stable."""

    def law(law: PaperLaw, dt: float) -> PaperLaw:
        most = STILL_STABLE * max_gain(law.integrator, dt)
        return replace(law, gain=min(part * (law.gain or 1.0 / dt), most))

    return law


def resets_to_foot(law: PaperLaw, dt: float) -> PaperLaw:
    """Return the law with the exact reset; without Voronoi tests it has none."""
    return replace(law, reset="foot") if law.switching == "voronoi" else law


DECAY: tuple[Claim, ...] = (
    ("7", "K = 100 1/s: about 75 steps"),
    *((figure, "the projection errors decay as exp(−K t)") for figure in ("10", "15", "18", "20")),
)
"""How fast the errors decay."""

FOLLOWED: tuple[Claim, ...] = tuple(
    (figure, "the features follow those of the closest points") for figure in ("13", "20")
)
"""No lag, where the other witness point's place decides on the switches."""

SWITCHES: tuple[Claim, ...] = (
    ("9", "both kinds of switches occur"),
    ("11", "curve to vertex: the witness point is anchored"),
    *FOLLOWED,
    ("14", "each with its active features"),
    ("16", "visits faces, edges and a vertex"),
    ("17", "the active feature is that of the closest point"),
    ("18", "constant stretches at 0 or 1"),
    ("19", "in five snapshots"),
    ("20", "enters an edge and leaves it"),
)
"""What there is to switch."""

RESETS: tuple[Claim, ...] = tuple(
    (figure, "jump by what the reset implies") for figure in ("18", "20")
)
"""Resets from a face onto an edge; planar bodies have none."""

NOTHING_ELSE: tuple[Claim, ...] = tuple(
    (figure, "no search, restart or exact solution") for figure in ("9", "13", "17", "20")
)
"""Nothing but the printed law takes part."""

ON_ONE_FACE: Claim = ("7", "no search, restart or exact solution")

BREAKS: tuple[Break, ...] = (
    Break("gain halved", "K / 2", times(0.5), claims=DECAY),
    Break("gain x 1.2", "1.2 K", times(1.2), claims=DECAY),
    Break(
        "no feedforward",
        "b left out",
        lambda law, dt: replace(law, feedforward=False),
        claims=(*DECAY, *FOLLOWED),
    ),
    Break("b's sign", "−b in place of b", backwards=True, claims=(*DECAY, *FOLLOWED)),
    Break(
        "M definite",
        "solve='ranked'",
        lambda law, dt: replace(law, solve="ranked"),
        claims=(ON_ONE_FACE, *NOTHING_ELSE),
    ),
    Break(
        "no guards",
        "switching='none'",
        lambda law, dt: replace(law, switching="none", reset="foot"),
        claims=SWITCHES,
    ),
    Break("exact reset", "reset='foot'", resets_to_foot, claims=(*NOTHING_ELSE, *RESETS)),
    Break(
        "restarts",
        "restarts=True",
        lambda law, dt: replace(law, restarts=True),
        claims=(ON_ONE_FACE, *NOTHING_ELSE),
    ),
)


@contextmanager
def broken(one: Break, *, trials: bool = True) -> Iterator[None]:
    """Break the law of every tracker that simulations A to E make within the context.

    Parameters
    ----------
    one : Break
    trials : bool
        Also rerun what is counted over many starts and gains; otherwise that stays as it was, and
        simulation B has one start.
    """

    def tracker(a: Any, b: Any, dt: float = 1e-3, **options: Any) -> Tracker:
        law = options.get("law")
        if not isinstance(law, PaperLaw):
            return Tracker(a, b, dt, **options)
        made = _Backwards if one.backwards else Tracker
        return made(a, b, dt, law=one.law(law, dt))

    def along(tracker: Tracker, a: Any, b: Any, *rest: Any, **options: Any) -> Any:
        return track_along(tracker, *_told((a, b), one.backwards), *rest, **options)

    names = {"Tracker": tracker, "track_along": along}
    with ExitStack() as stack:
        for module in map(_module, TRACKERS):
            for name in names.keys() & vars(module).keys():
                stack.enter_context(patch.object(module, name, names[name]))
        for kept in (RUNS, TRIALS) if trials else (RUNS,):
            _forget(kept, stack)
        if not trials:
            stack.enter_context(patch.object(_module("simulation_b.run"), "OTHER_STARTS", ()))
        yield


def _module(name: str) -> Any:
    return import_module(f"{PAPER}.{name}")


def _forget(kept: dict[str, tuple[str, ...]], stack: ExitStack) -> None:
    """Replace functions with cached results, wherever they were imported, by new ones."""
    for module, names in kept.items():
        for name in names:
            known = getattr(_module(module), name)
            again = cache(known.__wrapped__)
            for other in [m for n, m in sys.modules.items() if n.startswith(f"{PAPER}.")]:
                for alias in [a for a, value in vars(other).items() if value is known]:
                    stack.enter_context(patch.object(other, alias, again))


class _Backwards(Tracker):
    """A tracker that gets twists of the opposite sign wherever it is stepped in place."""

    def start_from(self, pose_a: Any, pose_b: Any, *rest: Any, **options: Any) -> TrackerState:
        places, twists = rest[:2], rest[2:]
        return super().start_from(pose_a, pose_b, *places, *map(_turned, twists), **options)

    def step_into(self, buffer: Any, *rest: Any, **options: Any) -> float:
        for twist in (buffer.twist_a, buffer.twist_b):
            twist *= -1.0
        found = super().step_into(buffer, *rest, **options)
        for twist in (buffer.twist_a, buffer.twist_b):
            twist *= -1.0
        return found


def _turned(twist: Any) -> Twist:
    return Twist(-twist.v, -twist.omega)


class _Told:
    """A path as given to a law: each pose and twist computed once, twists reversed if wanted."""

    def __init__(self, path: Any, backwards: bool) -> None:
        self.path, self.backwards = path, backwards

    def pose(self, t: float) -> Pose:
        return _known(self.path)[0](t)

    def twist(self, t: float) -> Twist:
        twist = _known(self.path)[1](t)
        return _turned(twist) if self.backwards else twist


def _told(paths: tuple[Any, Any], backwards: bool) -> tuple[_Told, _Told]:
    return _Told(paths[0], backwards), _Told(paths[1], backwards)


_PATHS: dict[int, tuple[Callable[[float], Pose], Callable[[float], Twist]]] = {}
"""By the path's identity; both functions keep it alive."""


def _known(path: Any) -> tuple[Callable[[float], Pose], Callable[[float], Twist]]:
    """A path's pose and twist, cached by time: they take most of the time of a run."""
    if id(path) not in _PATHS:
        _PATHS[id(path)] = cache(path.pose), cache(path.twist)
    return _PATHS[id(path)]
