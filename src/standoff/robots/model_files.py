"""A robot from the file of its model, whichever kind that is, and among the bodies of a scene."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from standoff.errors import StandoffError
from standoff.robots.robot import Robot
from standoff.scene import Scene, SceneError

MJCF, URDF = (".xml", ".mjcf"), ".urdf"


class ModelOptions(NamedTuple):
    """How a model is read, as ``Robot.from_urdf`` has it.

    Attributes
    ----------
    hulls : bool
        Take the hulls of meshes.
    skip : sequence of str
        Geometries or links to leave out.
    srdf : Path or None
    packages : sequence of Path
    free_base : bool
    mimic : "follow", "free" or None
        The last four are of URDF files alone.
    """

    hulls: bool = False
    skip: Sequence[str] = ()
    srdf: Path | None = None
    packages: Sequence[Path] = ()
    free_base: bool = False
    mimic: str | None = None

    @property
    def of_urdf(self) -> list[str]:
        """Names of those that are given and that only a URDF file has."""
        return [name for name in ("srdf", "packages", "free_base") if getattr(self, name)]


def robot_of_file(
    model: Path, options: ModelOptions | None = None, *, within: float | None = None
) -> Robot:
    """Return the robot of an MJCF file (.xml, .mjcf) or of a URDF file (.urdf).

    Raises StandoffError: the file is of another kind, or is refused; an option that it does not
    have. Raises FileNotFoundError: there is no such file. Raises ModuleNotFoundError: the package
    that reads it is not installed.
    """
    options = options or ModelOptions()
    kind = model.suffix.lower()
    if kind not in (*MJCF, URDF):
        raise StandoffError(f"{model}: give an MJCF file (.xml) or a URDF file (.urdf)", "model")
    common: dict[str, Any] = {
        "meshes": "hull" if options.hulls else None,
        "skip": tuple(options.skip),
        "within": within,
    }
    if kind == URDF:
        return Robot.from_urdf(
            model,
            options.srdf,
            package_dirs=tuple(options.packages),
            free_base=options.free_base,
            mimic=None if options.mimic is None else options.mimic == "follow",
            **common,
        )
    for name in options.of_urdf:
        raise StandoffError(f"only a URDF file has it, and {model} is none", name)
    return Robot.from_mujoco(model, **common)


def among(robot: Robot, scene: Scene) -> Robot:
    """Return the robot among the bodies of a scene, where they are at its start.

    Raises SceneError: a body has the name of a geometry, or the scene is no world.
    """
    scene = scene.as_world
    world, start = scene.world, scene.instant()
    poses = scene.poses(world, start) | world.fixed_poses
    try:
        return robot.with_obstacles({name: (world.bodies[name], poses[name]) for name in poses})
    except StandoffError as error:
        raise SceneError(str(error), key="bodies", file=scene.file) from error
