"""What a job's file names, a pair, a world or a robot, read and built."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from standoff.bodies.body import Body
from standoff.errors import StandoffError
from standoff.robots.model_files import ModelOptions, among, robot_of_file
from standoff.scene import Scene, SceneError, load_scene
from standoff.scene.file_content import DEFAULT_LENGTH_UNIT
from standoff.scene.files import existing_file
from standoff.scene.reader import SceneTable, shown
from standoff.sweep.subjects.pair import ConvexPair
from standoff.sweep.subjects.robot import RobotSubject
from standoff.sweep.subjects.solids import SolidPair
from standoff.sweep.subjects.subject import Subject
from standoff.sweep.subjects.world import SceneWorld
from standoff.tracking.inputs import check_pair
from standoff.wording import printable

KINDS = ("scene", "world", "robot")
"""Keys that say what is swept: a job has one of them."""

MODEL_KEYS = ("hulls", "skip", "srdf", "packages", "free_base", "mimic")
ROBOT_KEYS = ("obstacles", "q", *MODEL_KEYS)
SUBJECT_KEYS = (*KINDS, "pair", "within", *ROBOT_KEYS)

FIXES = {
    "meshes='hull'": "hulls = true",
    ", or meshes={name: a body}": "",
    "mimic=True": 'mimic = "follow"',
    "mimic=False": 'mimic = "free"',
    "skip=[name]": 'skip = ["NAME"]',
}
"""What the library's messages say to do, as a job's file says it."""


def read_subject(top: SceneTable) -> tuple[Subject, str]:
    """Return what a job sweeps, and a title for it.

    Raises SceneError: a file that is missing or refused; keys that do not go together.

    Parameters
    ----------
    top : SceneTable
        The job's.
    """
    given = [key for key in KINDS if key in top]
    if not given:
        top.required("scene", 'scene = "scene.toml"')
    if len(given) > 1:
        raise top.error(f"a job sweeps one thing, and '{given[0]}' is given too", given[1])
    kind = given[0]
    for key in ROBOT_KEYS:
        if key in top and kind != "robot":
            raise top.error("is of a robot; leave it out, or write robot = ...", key)
    if "pair" in top and kind != "scene":
        raise top.error(f"is of a scene; a {kind} is swept with all of its pairs", "pair")
    within = top.positive("within") if "within" in top else None
    if kind == "robot":
        return _robot(top, within)
    scene = load_scene(existing_file(top, kind, f'{kind} = "scene.toml"'))
    made = _world(top, scene, within) if kind == "world" else _pair(top, scene, within)
    return made, scene.title


def _pair(top: SceneTable, scene: Scene, within: float | None) -> Subject:
    scene = _seen(top, scene)
    start = scene.instant()
    a, b = (motion.path.pose(start) for motion in scene.pair_motions)
    shapes = scene.pair_shapes
    if not all(isinstance(shape, Body) for shape in shapes):
        solid = SolidPair(scene, shapes, (a, b), within)
        top.build(solid.check, "scene")
        return solid
    top.build(lambda: check_pair(*scene.pair_bodies), "scene")
    return ConvexPair(scene, scene.pair_bodies, (a, b), within)


def _seen(top: SceneTable, scene: Scene) -> Scene:
    """The scene through the pair that is named, or its only one."""
    if not scene.pairs:
        file = printable(scene.file.name)
        raise top.error(
            f"the scene has a [world] and no [pair]; to sweep all of its pairs, write: "
            f'world = "{file}"',
            "scene",
        )
    if "pair" in top:
        name = top.choice("pair", [pair.name for pair in scene.pairs])
        return scene.select(name)
    if len(scene.pairs) > 1:
        raise top.error(
            f"the scene has {len(scene.pairs)} pairs: add a line such as: "
            f'pair = "{scene.pairs[0].name}"',
            "pair",
        )
    return scene


def _world(top: SceneTable, scene: Scene, within: float | None) -> Subject:
    scene = scene.as_world
    world, start = scene.world_with(within), scene.instant()
    if not world.moving:
        raise top.error("no body of the world moves: all are 'fixed' in its [world]", "world")
    if next(world.pairs(), None) is None:
        raise top.error("no pair of the world counts, so that there is no distance", "world")
    poses = scene.poses(world, start)
    homes = tuple(poses[name] for name in world.moving)
    horizon = None if world.within == math.inf else world.within
    return SceneWorld(scene, world, homes, horizon)


def _robot(top: SceneTable, within: float | None) -> tuple[Subject, str]:
    model = existing_file(top, "robot", 'robot = "arm.urdf"')
    obstacles = None
    if "obstacles" in top:
        obstacles = load_scene(existing_file(top, "obstacles", 'obstacles = "scene.toml"'))
    robot = _built(top, lambda: robot_of_file(model, _options(top), within=within))
    if obstacles is not None:
        robot = among(robot, obstacles)
    if not robot.pairs:
        raise top.error("watches no pair, so that there is no distance: add 'obstacles'", "robot")
    rest = robot.kinematics.neutral()
    if "q" in top:
        given = top.numbers("q")
        rest = top.build(lambda: robot.kinematics.check(given), "q")
    unit = DEFAULT_LENGTH_UNIT if obstacles is None else obstacles.length_unit
    return RobotSubject(robot, rest, unit, within), f"{model.stem}"


def _options(top: SceneTable) -> ModelOptions:
    def flag(key: str) -> bool:
        return top.true_or_false(key) if key in top else False

    return ModelOptions(
        hulls=flag("hulls"),
        skip=_texts(top, "skip"),
        srdf=existing_file(top, "srdf", 'srdf = "arm.srdf"') if "srdf" in top else None,
        packages=[_beside(top, name) for name in _texts(top, "packages")],
        free_base=flag("free_base"),
        mimic=top.choice("mimic", ("follow", "free")) if "mimic" in top else None,
    )


def _texts(top: SceneTable, key: str) -> list[str]:
    found = top.entries(key, f'{key} = ["NAME"]') if key in top else []
    for k, name in enumerate(found):
        if not isinstance(name, str):
            raise top.error(f"must be a string in quotes, got {shown(name)}", f"{key}[{k}]")
    return [str(name) for name in found]


def _beside(top: SceneTable, name: str) -> Path:
    """A folder relative to the job's."""
    return (top.file.parent if top.file is not None else Path()) / name


def _built(top: SceneTable, make: Any) -> Any:
    """What is made of the model, with the fixes of its errors as a job's file says them."""
    try:
        return make()
    except SceneError:
        raise
    except (StandoffError, FileNotFoundError, ModuleNotFoundError) as error:
        told = str(error)
        for argument, key in FIXES.items():
            told = told.replace(argument, key)
        argument = getattr(error, "argument", "")
        raise top.error(told, argument if argument in top else "robot") from error
