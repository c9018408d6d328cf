"""Many bodies at once: which are near each other, and the proven clearance of all."""

from __future__ import annotations

import itertools
import math
import uuid
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from standoff.checks.numbers import not_negative, positive, whole_number
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.motion import Pose, PoseLike
from standoff.motion.moving import MotionLike
from standoff.progress import Progress
from standoff.read_only import KeepsReadOnly
from standoff.shown_names import hides
from standoff.tracking.law_options import Law
from standoff.tracking.laws import DEFAULT_LAW
from standoff.typing import Array
from standoff.wording import counted
from standoff.world.answer import WorldAnswer
from standoff.world.broad_phase import BroadPhase
from standoff.world.carried import carried_poses, changed_arguments
from standoff.world.frame import carried_state, next_state, started_state
from standoff.world.given import (
    BodyLike,
    checked_bodies,
    fixed_poses_of,
    law_of_pairs,
    mapping_of,
    named_pieces,
    pairs_of,
)
from standoff.world.impact import WorldImpact, first_impact, pairs_that_count
from standoff.world.model import Model
from standoff.world.packed import packed_laws, packed_pieces, pieces_of
from standoff.world.pieces import check_in_plane, dimension_of
from standoff.world.poses import (
    GivenPoses,
    check_frames,
    check_level,
    frames_of,
    read_poses_of,
    read_twists_of,
)
from standoff.world.rules import Names, PairRules, check_half_spaces, packed_rules
from standoff.world.solid_pairs import solid_pairs
from standoff.world.state import WorldState, check_key

PosesLike = Any
"""World poses of the moving bodies: (n, 4, 4) in the world's order, a list of poses, or a mapping
of names to poses."""

HIDDEN = ("check_state", "model")


@hides(*HIDDEN)
class World(KeepsReadOnly):
    """Named bodies, which pairs of them count, and how far away they matter.

    Immutable, and compiled once: what changes from frame to frame is its state, a value.

    Raises TypeError: not a body, a name that is no string, not a law. Raises ValueError: a name
    that nobody has, planar bodies among spatial ones or out of z = 0, a group of nobody, a body in
    a pair with itself, two half-spaces that would be a pair, a number that is negative or NaN, a
    law with a horizon of its own, a half-space or a rounded body in a pair with a solid.

    Parameters
    ----------
    bodies : mapping of str to Body, Solid, PlanarSolid or Compound
        Spatial ones, or planar ones. Pairs with a solid are asked anew in each frame.
    within : float, optional
        The horizon, length: of pairs that are farther apart only that is proven. Without one, the
        distances of all pairs are tracked.
    fixed : mapping of str to pose, optional
        World poses of bodies that never move; two of them are no pair.
    groups : mapping of str to list of str, optional
        Names for several bodies, to be used in `ignore`, `only` and `margins`.
    ignore : iterable of (str, str), optional
        Pairs of bodies or groups that do not count.
    only : iterable of (str, str), optional
        The pairs that count; all if not given.
    parents : mapping of str to str, optional
        The parent of each child: the two are no pair, as of links at one joint.
    margins : mapping of (str, str) to float, optional
        The clearance that a pair must keep, length; its horizon is at least that. Of several for
        one pair the greatest holds.
    minima : float, optional
        Of bodies of several pieces, all local minima below this distance are kept, length; the
        nearest alone if not given.
    law : PredictorCorrector or PaperLaw
        By which pairs are tracked.
    dt : float
        Frame time, s; ``step`` takes another one.

    Attributes
    ----------
    bodies : dict of str to Body, Solid, PlanarSolid or Compound
    moving, fixed : tuple of str
        Names, in the order of the bodies.
    within : float
    """

    def __init__(  # noqa: PLR0913 - all but one are keywords with defaults
        self,
        bodies: Mapping[str, BodyLike],
        *,
        within: float | None = None,
        fixed: Mapping[str, PoseLike] | None = None,
        groups: Mapping[str, Sequence[str]] | None = None,
        ignore: Iterable[tuple[str, str]] = (),
        only: Iterable[tuple[str, str]] | None = None,
        parents: Mapping[str, str] | None = None,
        margins: Mapping[tuple[str, str], float] | None = None,
        minima: float | None = None,
        law: Law = DEFAULT_LAW,
        dt: float = 1e-3,
    ) -> None:
        self.bodies = checked_bodies(bodies)
        self.within = math.inf if within is None else positive(within, "within", infinite=True)
        self.dt, self.law = positive(dt, "dt"), law_of_pairs(law)
        self._resolved = self.law.resolved(self.dt)
        self._fixed = mapping_of(fixed, "fixed", "poses")
        self._given = PairRules(
            mapping_of(groups, "groups", "lists of names"),
            pairs_of(ignore, "ignore"),
            None if only is None else pairs_of(only, "only"),
            mapping_of(parents, "parents", "names, of each child to its parent"),
            mapping_of(margins, "margins", "lengths, of pairs of names"),
        )
        least = -math.inf if minima is None else not_negative(minima, "minima")
        self.model = made_model(
            self.bodies, self._given, self._fixed, self.within, least, self.law, self.dt
        )

    @property
    def moving(self) -> tuple[str, ...]:
        """Names of the bodies whose poses are given, in their order."""
        return self.model.moving

    @property
    def fixed(self) -> tuple[str, ...]:
        """Names of those that stay where they are."""
        return self.model.fixed

    def __reduce__(self) -> Any:
        # addresses are those of this process
        return _restored, (self._arguments(self._given), self.model.key)

    def _arguments(self, given: PairRules) -> dict[str, Any]:
        """What this world was made of, with other rules of pairs."""
        least = None if self.minima == -math.inf else self.minima
        found = {**given._asdict(), "fixed": self._fixed, "within": self.within, "minima": least}
        return found | {"bodies": self.bodies, "law": self.law, "dt": self.dt}

    def changed(
        self, add: Mapping[str, BodyLike] | None = None, remove: Iterable[str] = (), **options: Any
    ) -> World:
        """Another world, with bodies that enter (after the others) or leave, or another horizon.

        Rules that name a body that leaves go with it. ``start_from`` takes a state along.

        Raises TypeError, ValueError as `World`; a name that it does not have, or has already.

        Parameters
        ----------
        add : mapping of str to Body or Compound, optional
        remove : iterable of str
        **options
            Arguments of `World`, instead of this world's: ``within``, ``fixed``, ``ignore``, ...

        Returns
        -------
        World
        """
        given = self._arguments(self._given)
        return World(**(changed_arguments(self._given, given, add, remove) | options))

    @property
    def minima(self) -> float:
        """Of bodies of several pieces, all minima below it are kept; -inf for the nearest alone."""
        return self.model.minima

    @property
    def dimension(self) -> int:
        """2 for a world of planar bodies, 3 for one of spatial ones."""
        return 2 if self.model.planar else 3

    @property
    def fixed_poses(self) -> dict[str, Pose]:
        """World poses of the fixed bodies, by name."""
        poses = map(Pose.of, self.model.poses_of_fixed)
        return dict(zip(self.fixed, poses, strict=True))

    def margin(self, a: str, b: str) -> float:
        """The clearance that two bodies must keep, length; 0 where none was given."""
        body = self.model.names.body
        i, j = body(a, "margin"), body(b, "margin")
        return self.model.search.rules.margin(i, j)

    def start(self, poses: PosesLike, twists: Any = None) -> WorldState:
        """Find all pairs within the horizon, and their distances, at some poses.

        Raises ValueError: a body's pose is missing, or none: its name is told; a planar body out of
        its plane.

        Parameters
        ----------
        poses : (n, 4, 4) array, list of poses, or mapping of str to pose
            World poses of the moving bodies, in the order of ``moving`` or by name.
        twists : (n, 6) array or mapping of str to twist, optional
            (v, omega) in world axes.

        Returns
        -------
        WorldState
            ``world.answer(state)`` is the answer at these poses.
        """
        given = self._read(poses)
        return started_state(self.model, given, self._twists(twists, given))

    def start_from(
        self,
        world: World,
        state: WorldState,
        poses: Any = None,
        *,
        progress: Progress | None = None,
    ) -> WorldState:
        """A state of this world where that of another is: what is known of the pairs that both
        have is kept, and only the others are asked anew.

        Two worlds have a pair where both have its two body objects under the same names.

        Raises TypeError, ValueError as ``start``; not a world, a state of yet another one.

        Parameters
        ----------
        world : World
            The other one.
        state : WorldState
            Of the other one; it is not changed.
        poses : mapping of str to pose, optional
            World poses of the moving bodies that enter. The others stay where they are.
        progress : callable, optional
            Told how many pairs with a solid are done, and of how many.

        Returns
        -------
        WorldState
            At the time of the other one.
        """
        if not isinstance(world, World):
            raise StandoffTypeError(f"{shown(world)} is not a World.", "world", world)
        world.check_state(state)
        old, same_law = world.model, self.law == world.law
        given = carried_poses(self.model, old, state, poses)
        return carried_state(self.model, old, state, given, same_law, self.dt, progress)

    def step(
        self,
        state: WorldState,
        poses: PosesLike,
        twists: Any = None,
        dt: float | None = None,
        *,
        workers: int = 1,
    ) -> tuple[WorldState, WorldAnswer]:
        """All near pairs at the given poses, from the state of the frame before.

        Raises TypeError, ValueError as ``start``; a state of another world, a time that is too long
        for the law.

        Parameters
        ----------
        state : WorldState
            Of this world; it is not changed.
        poses, twists
            As in ``start``, at the end of the step.
        dt : float, optional
            Time since the frame before, s; the world's own if not given.
        workers : int
            Threads that share the pairs; the answers are the same, to the last bit, for any number.

        Returns
        -------
        (WorldState, WorldAnswer)
        """
        self.check_state(state)
        workers = whole_number(workers, "workers")
        given = self._read(poses)
        h = self.dt if dt is None else self._frame_time(dt)
        after = next_state(self.model, state, given, self._twists(twists, given), h, workers)
        return after, WorldAnswer(self.model, after)

    def run(
        self, state: WorldState, poses: Any, twists: Any = None, *, workers: int = 1
    ) -> tuple[WorldState, list[WorldAnswer]]:
        """Many frames, each from the state of the one before, as with ``step``.

        Raises TypeError, ValueError as ``step``, with the number of the frame; twists of another
        number of frames.

        Parameters
        ----------
        poses : (m, n, 4, 4) array, or an iterable of what ``step`` reads
        twists : (m, n, 6) array or an iterable, optional

        Returns
        -------
        (WorldState, list of WorldAnswer)
        """
        poses, twists = frames_of(poses, "poses"), frames_of(twists, "twists")
        check_frames(poses, twists)
        answers = []
        each = itertools.repeat(None) if twists is None else twists
        for k, (frame, velocities) in enumerate(zip(poses, each, strict=twists is not None)):
            try:
                state, answer = self.step(state, frame, velocities, workers=workers)
            except StandoffError as error:
                told = f"Frame {k}: {error}"
                raise type(error)(told, error.argument, error.value) from error
            answers.append(answer)
        return state, answers

    def answer(self, state: WorldState) -> WorldAnswer:
        """The answer at the frame of a state."""
        self.check_state(state)
        return WorldAnswer(self.model, state)

    def distances(self, poses: PosesLike, progress: Progress | None = None) -> WorldAnswer:
        """All near pairs at some poses by themselves, from nothing; `progress` is told how many
        pairs with a solid are done, and of how many."""
        given = self._read(poses)
        state = started_state(self.model, given, self._twists(None, given), progress)
        return WorldAnswer(self.model, state)

    def time_of_impact(
        self, paths: Mapping[str, MotionLike], duration: float, **options: Any
    ) -> WorldImpact:
        """The first time at which any pair comes to its clearance: never later than the true one.

        A pair's clearance is the one that is given, or its margin where that is more. Pairs whose
        boxes never come so near are left out; each of the others is searched by itself, up to the
        earliest time found so far.

        Parameters
        ----------
        paths : mapping of str to path or pose
            Of each moving body, as ``so.time_of_impact`` reads them.
        duration : float
            Time to search [s].
        **options
            ``clearance``, ``tolerance``, ``start``, ``max_evaluations`` of ``so.time_of_impact``,
            the same for all pairs.

        Returns
        -------
        WorldImpact
        """
        return first_impact(self.model, paths, duration, options)

    def pairs(self) -> Iterator[tuple[str, str]]:
        """The names of all pairs that count."""
        return pairs_that_count(self.model)

    def check_state(self, state: WorldState) -> None:
        """Refuse what is not a state of this world.

        Raises TypeError, ValueError.
        """
        check_key(state, self.model.key)

    def _frame_time(self, dt: float) -> float:
        """A frame's own time, s: positive, and short enough for the law to be stable."""
        dt = positive(dt, "dt")
        self._resolved.check_step(dt)
        return dt

    def _read(self, poses: Any) -> GivenPoses:
        given = read_poses_of(poses, self.moving, self.model.planar)
        return given._replace(matrices=self.model.all_poses(given.matrices))

    def _twists(self, twists: Any, given: GivenPoses) -> tuple[Array, bool]:
        return read_twists_of(twists, self.moving, given.matrices, self.model.moving_rows)

    def __len__(self) -> int:
        return len(self.bodies)

    def __repr__(self) -> str:
        horizon = "" if self.within == math.inf else f" within {self.within:g}"
        return f"<World of {counted(len(self), 'body', 'bodies')}{horizon}>"


def _restored(given: Mapping[str, Any], key: str) -> World:
    """A world from what it was made of, whose states keep belonging to it."""
    world = World(**given)
    world.model = world.model._replace(key=key)
    return world


# A world's data, made of what its user gives.


def made_model(
    bodies: Mapping[str, BodyLike],
    given: PairRules,
    at_rest: Mapping[str, PoseLike],
    within: float,
    minima: float,
    law: Law,
    dt: float,
) -> Model:
    """The data, checked; what its frames call is compiled. See `World` for what raises."""
    names = Names(tuple(bodies), given.groups)
    still = np.zeros(len(bodies), dtype=bool)
    for name in at_rest:
        still[names.body(name, "fixed")] = True
    rules = packed_rules(names, still, given)
    parts = named_pieces(bodies)
    planar = dimension_of({name: piece.body for name, piece in parts.items()}) == 2
    pieces = [pieces_of(body) for body in bodies.values()]
    fixed = tuple(name for name in bodies if name in at_rest)
    poses = fixed_poses_of(fixed, at_rest)
    if planar:
        check_level(fixed, poses, "fixed")
        check_in_plane(parts)
    check_half_spaces(list(bodies), pieces, rules)
    solids = solid_pairs(list(bodies), pieces, rules)
    tracked = np.repeat(solids.tracked, [len(each) for each in pieces]).tolist()
    reach = max(within, rules.greatest_margin)
    return Model(
        key=uuid.uuid4().hex,
        listed=tuple(bodies.items()),
        names=names,
        moving=tuple(name for name in bodies if name not in at_rest),
        fixed=fixed,
        moving_rows=np.flatnonzero(~still),
        fixed_rows=np.flatnonzero(still),
        poses_of_fixed=poses,
        planar=planar,
        minima=minima,
        search=BroadPhase(packed_pieces(pieces, planar), rules, within, reach),
        laws=packed_laws([piece for each in pieces for piece in each], law, dt, tracked),
        solids=solids,
    )
