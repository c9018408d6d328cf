"""A world that a page shows: where its bodies are over time, and the course of its clearance."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from standoff.checks.numbers import positive
from standoff.errors import StandoffError
from standoff.motion import Fixed, Pose
from standoff.motion.moving import moving
from standoff.scene import Scene
from standoff.typing import Array
from standoff.view.tolerances import MOST_COURSE
from standoff.wording import counted
from standoff.world import World, WorldAnswer
from standoff.world.poses import check_names


class MovingWorld(NamedTuple):
    """A world with its poses.

    Attributes
    ----------
    world : World
    title : str
        A line for the reader.
    unit : str
        Label of lengths.
    times : (m,) array
        Of the frames [s]; one where nothing moves by itself.
    poses : callable
        Takes a time [s], returns what `World.start` reads.
    """

    world: World
    title: str
    unit: str
    times: Array
    poses: Callable[[float], Any]

    @property
    def moves(self) -> bool:
        """Does any body move by itself?"""
        return len(self.times) > 1


def world_of_scene(scene: Scene) -> MovingWorld:
    """Return the world of a scene, moved as the scene says.

    Raises SceneError if the bodies are no world, or the times are not possible.

    Parameters
    ----------
    scene : Scene
    """
    scene = scene.as_world
    still = all(isinstance(scene.motions[name].path, Fixed) for name in scene.world.moving)
    if still:
        times, world = np.array([scene.instant()]), scene.world
    else:
        times = scene.times()
        world = scene.world_with(times=times)
    return MovingWorld(
        world, scene.title, scene.length_unit, times, lambda t: scene.poses(world, t)
    )


def moving_world(world: World, given: Any, duration: float | None = None) -> MovingWorld:
    """Return a world at poses, or moved along paths.

    Raises TypeError, ValueError if there are none of these.

    Parameters
    ----------
    world : World
    given : array, list or mapping
        Poses as `World.start` reads them; with a duration a mapping of names to paths, functions of
        time or poses.
    duration : float, optional
        Of the motion [s], in frames of the world's own time.
    """
    title = counted(len(world), "body", "bodies")
    if duration is None:
        return MovingWorld(world, title, "", np.zeros(1), lambda t: given)
    end = positive(duration, "duration")
    if not isinstance(given, Mapping):
        raise StandoffError("With a duration, give a mapping of names to paths.", "paths", given)
    check_names(given, world.moving, "paths")
    paths = {name: moving(given[name], f"paths[{name!r}]", 0.0, end) for name in world.moving}
    count = round(end / world.dt) + 1
    if not 2 <= count <= MOST_COURSE:
        raise StandoffError(
            f"{end:g} s in frames of {world.dt:g} s are {counted(count, 'frame')}, and a page "
            f"shows 2 to {MOST_COURSE}: change the duration, or the world's dt.",
            "duration",
            duration,
        )
    times = np.minimum(world.dt * np.arange(count), end)
    return MovingWorld(
        world,
        title,
        "",
        times,
        lambda t: {name: Pose.of(path.pose(t)) for name, path in paths.items()},
    )


class WorldPlotPoint(NamedTuple):
    """What the plot shows of a frame: both end at the horizon.

    Attributes
    ----------
    distance : float
        Of the closest pair [length].
    lower_bound : float
        Proven for all pairs [length].
    """

    distance: float
    lower_bound: float


def known_of(answer: WorldAnswer) -> WorldPlotPoint:
    """Return what the plot shows of an answer."""
    least = float(answer.pairs.distance.min(initial=np.inf))
    return WorldPlotPoint(min(least, answer.model.search.reach), answer.clearance)


class WorldCourse(NamedTuple):
    """The clearance of a world over its frames.

    Attributes
    ----------
    time : (m,) array
    distance, lower_bound : (m,) arrays
        As in `WorldPlotPoint`.
    """

    time: Array
    distance: Array
    lower_bound: Array


def course_of(given: MovingWorld) -> WorldCourse:
    """Return the course of a world that moves by itself.

    Raises StandoffError: what `World.step` refuses.
    """
    world, times = given.world, given.times
    state = world.start(given.poses(float(times[0])))
    known = [known_of(world.answer(state))]
    for before, time in pairwise(times.tolist()):
        state, answer = world.step(state, given.poses(time), dt=time - before)
        known.append(known_of(answer))
    distance, bound = np.array(known).T
    return WorldCourse(times, distance, bound)


class LiveWorld:
    """A world whose bodies are where they are put, and its answer there.

    Raises TypeError, ValueError: what `World.start` refuses.

    Parameters
    ----------
    world : World
    poses
        Of the moving bodies, as `World.start` reads them.

    Attributes
    ----------
    world : World
    answer : WorldAnswer
    """

    def __init__(self, world: World, poses: Any) -> None:
        self.world = world
        self.answer = world.distances(poses)

    @property
    def poses(self) -> Array:
        """(n, 4, 4) of the moving bodies, in the world's order."""
        found: Array = self.answer.state.poses[self.world.model.moving_rows]
        return found

    def move(self, poses: Any) -> WorldAnswer:
        """Put the bodies at poses, however far away, and return the answer there.

        Raises TypeError, ValueError: what `World.step` refuses; all is as it was then.
        """
        _, self.answer = self.world.step(self.answer.state, poses)
        return self.answer
