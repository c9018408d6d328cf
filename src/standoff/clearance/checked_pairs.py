"""Which pairs are looked at, how far, and the report on them: the same in Python, for a scene and
for an assembly's file."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from typing import Any, NamedTuple

from standoff.checks.numbers import not_negative, positive, whole_number
from standoff.clearance.fits import matching, unmatched
from standoff.clearance.report import Report, Wanted, bounds_of, nearest_of, report_on
from standoff.clearance.tolerances import FIRST_REACH, TOUCHING_PART
from standoff.errors import StandoffError
from standoff.progress import Progress
from standoff.scene.worlds import by_piece
from standoff.world import World, WorldAnswer
from standoff.world.shapes import is_bounded, slack_of

CLOSEST = 40
"""Pairs whose distances are asked where nothing says how far to look."""


class Scope(NamedTuple):
    """Which pairs are looked at, and how far.

    Attributes
    ----------
    within : float or None
        The horizon [length]: of pairs that are farther apart only that is proven. None: the world's
        own; and if it has none, as far as what is wanted needs, or the closest pairs.
    closest : int
        How many pairs these are, at least.
    parts : sequence of str
        Patterns of names: only bodies that one of them fits. All if empty.
    pairs : sequence of (str, str)
        Pairs of patterns: only pairs of bodies that one of them fits. All if empty.
    """

    within: float | None = None
    closest: int = CLOSEST
    parts: Sequence[str] = ()
    pairs: Sequence[tuple[str, str]] = ()


EVERYTHING, NOTHING = Scope(), Wanted()


def check(
    world: World,
    poses: Any,
    wanted: Wanted = NOTHING,
    scope: Scope = EVERYTHING,
    *,
    time: float = 0.0,
    progress: Progress | None = None,
) -> Report:
    """Report what is proven of the clearances of a world's pairs at some poses.

    Raises StandoffError: a pattern that fits no body, a number out of its range, or as
    `World.distances`.

    Parameters
    ----------
    world : World
    poses : mapping of str to pose
        World poses of the moving bodies.
    wanted : Wanted, optional
        What must hold.
    scope : Scope, optional
        Which pairs are looked at, and how far.
    time : float, optional
        Of the poses, as the report tells it, s.
    progress : callable, optional
        Told how many pairs with a solid are done, and of how many.

    Returns
    -------
    Report
    """
    looked = narrowed(world, scope, wanted)
    here = {name: pose for name, pose in poses.items() if name in looked.bodies}
    if looked.within == math.inf and scope.within is None:
        looked, answer = _closest(looked, here, scope.closest, wanted, progress)
    else:
        answer = looked.distances(here, progress)
    near = nearest_of(answer, time)
    return report_on(looked, near, bounds_of(looked, answer, near), wanted)


def narrowed(world: World, scope: Scope, wanted: Wanted) -> World:
    """Return a world of the pairs that are looked at, with the horizon that is given, or that is
    needed for a clearance that is wanted.

    Raises StandoffError as `check`.
    """
    for value, name in ((wanted.least, "least"), (wanted.tolerance, "tolerance")):
        if value is not None:
            not_negative(value, name)
    parts = _each(scope.parts or ["*"], world.bodies, "parts")
    changes: dict[str, Any] = {}
    if scope.pairs:
        sides = [[_each([x], world.bodies, "pairs") for x in pair] for pair in scope.pairs]
        changes["only"] = [
            (a, b)
            for a, b in world.pairs()
            if {a, b} <= parts and any((a in x and b in y) or (b in x and a in y) for x, y in sides)
        ]
    own = world.within if scope.within is None else positive(scope.within, "within", infinite=True)
    if wanted.least and own == math.inf and scope.within is None:
        own = 0.0
    if own < math.inf:
        changes["within"] = max(own, _reach(world, wanted))
    elif scope.within is not None:
        changes["within"] = own
    gone = [name for name in world.bodies if name not in parts]
    return world.changed(remove=gone, **changes) if gone or changes else world


def _each(patterns: Sequence[str], names: Collection[str], argument: str) -> frozenset[str]:
    """The bodies that patterns fit.

    Raises StandoffError: one that fits none.
    """
    for pattern in patterns:
        if not matching(pattern, names):
            raise StandoffError(f"{argument}: {unmatched(pattern, names)}", argument, pattern)
    return frozenset().union(*(matching(pattern, names) for pattern in patterns))


def _reach(world: World, wanted: Wanted) -> float:
    """How far what is wanted needs answers: a fit's range has the touching tolerance beside it."""
    if not wanted.fits:
        return wanted.reach
    shapes = [shape for shape in by_piece(world.bodies).values() if is_bounded(shape)]
    size = max((shape.size for shape in shapes), default=0.0)
    slack = max((slack_of(shape) for shape in shapes), default=0.0)
    return wanted.reach + TOUCHING_PART * size + 2.0 * slack


def _closest(
    world: World, poses: Any, count: int, wanted: Wanted, progress: Progress | None
) -> tuple[World, WorldAnswer]:
    """A world with so many pairs within its horizon, and its answer: the horizon grows, and what is
    answered is kept."""
    whole_number(count, "closest")
    total = sum(1 for _ in world.pairs())
    sizes = sorted(shape.size for shape in by_piece(world.bodies).values() if is_bounded(shape))
    if total <= count or not sizes:
        return world, world.distances(poses, progress)
    within = max(FIRST_REACH * sizes[len(sizes) // 2], _reach(world, wanted))
    looked = world.changed(within=within)
    answer = looked.distances(poses, progress)
    while len(answer.pairs) < count:
        before, within = looked, 2.0 * within
        looked = world.changed(within=within)
        state = looked.start_from(before, answer.state, progress=progress)
        answer = looked.answer(state)
    return looked, answer
