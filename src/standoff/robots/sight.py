"""A robot's pairs seen at many configurations: by bounding boxes, and by certified distances."""

from __future__ import annotations

from typing import Any, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np

from standoff.errors import StandoffError
from standoff.kernels.tolerances import EPS
from standoff.kernels.world import arrays as W
from standoff.robots.certify_tolerances import (
    KINEMATICS_ROUNDINGS,
    PATH_ROUNDINGS,
    SAME_KINEMATICS,
)
from standoff.robots.motion_bounds import (
    Cut,
    Reaches,
    least_way,
    least_way_along,
    reaches_of,
)
from standoff.robots.motions import WORLD, LinkFrames, motions_of
from standoff.robots.proof import Witness
from standoff.robots.robot_model import RobotModel
from standoff.robots.watched import PlacedCores, Watched, watched_of
from standoff.typing import Array, Bools, Ints
from standoff.world import World
from standoff.world.many_frames import answers_at, are_solids, pieces_placed


class Separations(NamedTuple):
    """Of k pairs, each at one configuration.

    Attributes
    ----------
    distance, lower, upper : (k,) arrays
        The signed distance and its bounds [length]; nan and infinite of pairs that are not known.
    normals : (k, 3) array
        From A to B, world; 0 where there is none.
    along : (k,) array of bool
        Is the pair at least ``lower`` apart along the normal? Convex pieces and boxes are. Between
        solids there need be no plane: only their distance is known.
    """

    distance: Array
    lower: Array
    upper: Array
    normals: Array
    along: Bools


class Middle(NamedTuple):
    """Of k pairs, each in the middle of a box of the joints.

    Attributes
    ----------
    seen : (Seen, Seen)
        The cores of A and B.
    half : (2, k, 3) array
        Half their sides.
    reaches : Reaches
    way : (k,) array
        No pair of points moves more than this against each other in the box [length].
    """

    seen: tuple[PlacedCores, PlacedCores]
    half: Array
    reaches: Reaches
    way: Array


class Sight:
    """A robot's pairs, and what was asked of them.

    Attributes
    ----------
    robot : Robot
    watched : Watched
    solid : (n,) array of bool
        Is a pair asked as one of solids, which need not be convex?
    configurations, queries : int
        At which the package's kinematics were evaluated, and certified distances taken.
    """

    def __init__(self, robot: RobotModel, workers: int = 1) -> None:
        self.robot, self.workers = robot, workers
        self.model = robot.world.model
        self.watched = _kept(robot)
        self.solid: Bools = are_solids(self.model, (self.watched.a, self.watched.b))
        self.configurations = self.queries = 0

    @property
    def pairs(self) -> int:
        """How many pairs of pieces count."""
        return len(self.watched.a)

    def names(self, pair: int) -> tuple[str, str]:
        """Of the two bodies of a pair."""
        i, j = self.watched.bodies[pair].tolist()
        return self.model.listed[i][0], self.model.listed[j][0]

    def links(self, pair: int) -> tuple[str, str]:
        """The links that carry them; of an obstacle its own name."""
        geoms = self.robot.geoms
        links = dict(zip(geoms.names, geoms.links, strict=True))
        a, b = self.names(pair)
        return links.get(a, a), links.get(b, b)

    def witness(self, pair: int, q: Array, apart: Separations) -> Witness:
        """A pair at a configuration, as an answer shows it, of the first of what is known."""
        q = np.array(q)
        q.flags.writeable = False
        numbers = (float(each[0]) for each in apart[:3])
        return Witness(self.names(pair), self.links(pair), q, *numbers)

    def frames(self, q: Array) -> LinkFrames:
        """Where the motions' frames are at configurations (m, nq)."""
        return self.watched.motions.frames(q)

    def roundoff(self, q: Array, ways: Array, time: float = 0.0, speed: float = 0.0) -> float:
        """What roundoff of kinematics and path may do to a distance [length].

        Parameters
        ----------
        q : (nq,) array
            A configuration.
        ways : (nm,) array
            How far each motion goes from it, at most.
        time, speed : float
            The greatest time on the path's clock [s], and its fastest joint.
        """
        motions = self.watched.motions
        length = self.watched.length
        shifts = ~motions.turns
        length += float(ways[: motions.size][shifts].sum())
        for k in np.flatnonzero(shifts).tolist():
            at = int(motions.q_at[k])
            length += float(np.abs(q[at : at + int(motions.q_count[k])]).sum())
        joints = float(np.abs(q).max(initial=0.0) + ways.max(initial=0.0)) + time * speed
        count = motions.size + 1
        return EPS * count * length * (KINEMATICS_ROUNDINGS + PATH_ROUNDINGS * joints)

    def middle(self, pairs: Ints, frames: LinkFrames, at: Ints, ways: Array) -> Middle:
        """Pairs in the middle of boxes: how far each can move."""
        watched = self.watched
        a, b = watched.a[pairs], watched.b[pairs]
        seen = watched.see(frames, at, a), watched.see(frames, at, b)
        half = np.stack([watched.cores.half[a], watched.cores.half[b]])
        reaches = reaches_of(watched, pairs, frames, at, ways, seen)
        return Middle(seen, half, reaches, least_way(reaches).bound)

    def by_boxes(self, pairs: Ints, frames: LinkFrames, at: Ints, middle: Middle) -> Separations:
        """How far apart the pieces' boxes are, along the line of their centres."""
        cores, (a, b) = self.watched.cores, (self.watched.a[pairs], self.watched.b[pairs])
        between = middle.seen[1].centres - middle.seen[0].centres
        size = np.sqrt(np.einsum("ki,ki->k", between, between))
        normals = between / np.where(size > 0.0, size, 1.0)[:, None]
        normals[size == 0.0] = 1.0, 0.0, 0.0
        for pieces, sign in ((a, 1.0), (b, -1.0)):
            for k in np.flatnonzero(cores.planes[pieces]):
                carrier = cores.motions[pieces[k]]
                turn = frames.rotations[at[k], carrier]
                normals[k] = sign * (turn @ cores.normals[pieces[k]])
        lower = np.einsum("ki,ki->k", normals, between) - cores.radius[a] - cores.radius[b]
        for seen, half in zip(middle.seen, middle.half, strict=True):
            spread = np.abs(np.einsum("ki,kij->kj", normals, seen.axes))
            lower -= np.einsum("kj,kj->k", spread, half)
        every = np.full(len(pairs), np.inf), normals, np.ones(len(pairs), dtype=bool)
        return Separations(lower, lower, *every)

    def ask(self, pairs: Ints, q: Array, frames: LinkFrames, at: Ints) -> Separations:
        """Certified distances of pairs, each at one of several configurations; the same pair at the
        same configuration is asked once."""
        keys, first, again = np.unique(pairs * len(q) + at, return_index=True, return_inverse=True)
        of_pairs, where = pairs[first], at[first]
        used, rows = np.unique(where, return_inverse=True)
        placed = [self.placed(q[k], frames, int(k)) for k in used.tolist()]
        pieces = self.watched.a[of_pairs], self.watched.b[of_pairs]
        found = answers_at(self.model, placed, rows, pieces, self.workers)
        self.queries += len(keys)
        normals = np.nan_to_num(found.normal)
        told = found.distance, found.lower, found.upper, normals, ~self.solid[of_pairs]
        return Separations._make(each[again] for each in told)

    def placed(self, q: Array, frames: LinkFrames, k: int) -> Array:
        """Where the pieces are, by the package's own kinematics.

        Raises StandoffError: the joints as read place a geom elsewhere: no bound of its motion
        would hold.
        """
        self.configurations += 1
        placed = pieces_placed(self.model, self.model.all_poses(self.robot.kinematics.poses(q)))
        n, cores = len(placed), self.watched.cores
        own = self.watched.see(frames, np.full(n, k), np.arange(n))
        turns = placed[:, W.P_ROTATION : W.P_SHIFT].reshape(-1, 3, 3) - own.axes
        shifts = np.where(
            cores.planes[:, None], 0.0, placed[:, W.P_CENTRE : W.P_CENTRE + 3] - own.centres
        )
        size = self.watched.length + np.abs(own.centres).max(initial=0.0)
        wrong = np.abs(turns).max(axis=(1, 2), initial=0.0)
        wrong = np.maximum(wrong, np.abs(shifts).max(axis=1, initial=0.0) / (size or 1.0))
        if not (wrong <= SAME_KINEMATICS).all():
            body = int(self.model.search.pieces.owners[int(np.argmax(wrong))])
            raise StandoffError(
                f"{self.model.listed[body][0]!r} is not where the joints as read place it (a part "
                f"of {wrong.max():.3g} of the robot's size away): no bound of its motion would "
                "hold. Please report the model.",
                "robot",
            )
        return placed


def closing(middle: Middle, apart: Separations) -> Array:
    """(k,): how much nearer the pieces can come than in the middle [length]: seen from a link, or,
    where they are apart along a normal, along that normal alone."""
    along: Cut = least_way_along(middle.reaches, apart.normals, middle.seen, middle.half)
    return np.where(apart.along, np.minimum(middle.way, along.bound), middle.way)


def gains(middle: Middle, apart: Separations | None, numbers: Ints, most: int) -> Array:
    """(k, most): how much less `closing` is where some motions go half as far [length]; without
    ``apart``, how much less the way is.

    Where nothing is less (turns by more than π, or what is seen does not move), it is told by the
    motions' own ways.

    Parameters
    ----------
    middle : Middle
    apart : Separations or None
    numbers : (k, n) array of int
        Of each motion of the chains, with which others it is halved: 0 to most - 1, or less than 0.
    most : int
    """
    k, reaches = len(middle.way), middle.reaches
    every = np.tile(np.arange(k), most + 1)
    all_ = some_of(middle, every)
    which = (numbers[every] == np.repeat(np.arange(most + 1), k)[:, None]) & (numbers[every] >= 0)
    h = np.where(which, 0.5 * all_.reaches.h, all_.reaches.h)
    all_ = all_._replace(reaches=all_.reaches._replace(h=h))
    bound = least_way(all_.reaches).bound
    if apart is not None:
        all_ = all_._replace(way=bound)
        bound = closing(all_, Separations._make(each[every] for each in apart))
    of_number = bound.reshape(most + 1, k)
    found: Array = (of_number[most] - of_number[:most]).T
    own = reaches.h * np.minimum(reaches.r_a, reaches.r_b)
    none = np.flatnonzero(found.max(axis=1, initial=0.0) <= 0.0)
    for i in range(most):
        found[none, i] = np.where(numbers[none] == i, own[none], 0.0).sum(axis=1)
    return found


def some_of(middle: Middle, which: Any) -> Middle:
    """Some of the pairs."""
    seen_a, seen_b = (PlacedCores(*(x[which] for x in each)) for each in middle.seen)
    reaches = Reaches(*(x[which] for x in middle.reaches))
    return Middle((seen_a, seen_b), middle.half[:, which], reaches, middle.way[which])


_KEPT: WeakKeyDictionary[World, Watched] = WeakKeyDictionary()


def _kept(robot: RobotModel) -> Watched:
    """The pairs of a robot, which are found once for each of its worlds."""
    world = robot.world
    if world not in _KEPT:
        _KEPT[world] = _watched(robot)
    return _KEPT[world]


def _watched(robot: RobotModel) -> Watched:
    world, geoms = robot.world, robot.geoms
    motions = motions_of(robot.joints)
    at = {name: k for k, name in enumerate(geoms.names)}
    carriers = np.full(len(world.bodies), WORLD, dtype=np.int64)
    placements = np.tile(np.eye(4), (len(world.bodies), 1, 1))
    fixed = world.fixed_poses
    for k, name in enumerate(world.bodies):
        if name in fixed:
            placements[k] = fixed[name].matrix
            continue
        placements[k], joint = geoms.placements[at[name]], int(geoms.joints[at[name]])
        if joint >= 0:
            carriers[k], placements[k] = motions.links[joint], motions.ends[joint] @ placements[k]
    return watched_of(world.model, motions, carriers, placements)
