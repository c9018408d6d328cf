"""Which of a scene's pairs a command works on, and where each one's files go."""

from __future__ import annotations

from pathlib import Path

from standoff.cli.errors import CommandError
from standoff.cli.output import check_named
from standoff.scene import Scene, SceneError


def chosen(scene: Scene, name: str | None) -> tuple[Scene, ...]:
    """Return the scene once for every pair, or once for the pair that ``--pair`` names.

    Raises CommandError if the scene has no such pair.
    """
    if name is None:
        return scene.each()
    try:
        return (scene.select(name),)
    except SceneError as error:
        raise CommandError(f"--pair: {error.problem}") from error


def target_of(
    target: Path | None, option: str, scene: Scene, scenes: tuple[Scene, ...]
) -> Path | None:
    """Return the file of one pair: as the option names it, or with the pair's name at its end.

    Raises CommandError if the option names no file.
    """
    if target is None or len(scenes) == 1:
        return target
    check_named(target, option)
    return target.with_name(f"{target.stem}-{scene.selected.name}{target.suffix}")
