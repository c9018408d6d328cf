"""A robot from the arguments of a command."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from standoff.cli.errors import CommandError
from standoff.errors import StandoffError

if TYPE_CHECKING:
    from standoff.cli.option_groups import RobotFlags
    from standoff.robots.robot import Robot

OPTIONS = {
    "meshes='hull'": "--hulls",
    ", or meshes={name: a body}": "",
    "mimic=True": "--mimic follow",
    "mimic=False": "--mimic free",
    "skip=[name]": "--skip NAME",
}
"""What the library's messages say to do, as this command says it."""


def robot_of(model: Any, flags: RobotFlags, *, within: float | None = None) -> Robot:
    """The robot of an MJCF file (.xml, .mjcf) or of a URDF file (.urdf).

    Raises
    ------
    CommandError
        The file is not there or not usable, an option does not fit it, or its package is missing.
    """
    from standoff.robots.robot import Robot

    kind = model.suffix.lower()
    if kind not in (".xml", ".mjcf", ".urdf"):
        raise CommandError(f"{model}: give an MJCF file (.xml) or a URDF file (.urdf)")
    common: dict[str, Any] = {
        "meshes": "hull" if flags.hulls else None,
        "skip": tuple(flags.skip),
        "within": within,
    }
    of_urdf = {"--srdf": flags.srdf, "--packages": flags.packages, "--free-base": flags.free_base}
    for name, given in of_urdf.items():
        if given and kind != ".urdf":
            raise CommandError(f"{name}: only a URDF file has it, and {model} is none")
    try:
        if kind != ".urdf":
            return Robot.from_mujoco(model, **common)
        return Robot.from_urdf(
            model,
            flags.srdf,
            package_dirs=flags.packages,
            free_base=flags.free_base,
            mimic=None if flags.mimic is None else flags.mimic == "follow",
            **common,
        )
    except (StandoffError, FileNotFoundError, ModuleNotFoundError) as error:
        raise CommandError(_as_options(str(error))) from error


def _as_options(message: str) -> str:
    """A message whose fixes are those of the command line."""
    for argument, option in OPTIONS.items():
        message = message.replace(argument, option)
    return message
