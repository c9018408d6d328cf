"""What ``standoff check`` is asked about: a scene, a file of patches, a DXF drawing or meshes, or a
shape in a line."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from standoff.cli.errors import CommandError
from standoff.cli.part_file import parts_of
from standoff.scene import SceneError, load_scene
from standoff.scene.file_content import DEFAULT_LENGTH_UNIT
from standoff.scene.files import file_problem, toml_tables
from standoff.scene.part_files import ENDINGS
from standoff.scene.reader import SceneTable, shown, unknown_name
from standoff.scene.shapes import read_body
from standoff.scene.worlds import by_piece

if TYPE_CHECKING:
    from standoff.cli.arguments import CheckCommand

EXAMPLE = "'shape = \"box\", size = [0.3, 0.2, 0.1]'"


class CheckedSubject(NamedTuple):
    """A body or a solid to report on, what it is called, the label of its lengths, and what was
    found when its file was read."""

    name: str
    body: Any
    unit: str
    notes: tuple[str, ...] = ()


def subjects(command: CheckCommand) -> list[CheckedSubject]:
    """Return the bodies that a command names; its `body` picks one of them.

    Raises CommandError if it names no scene, no file and no shape, or what it names has no such
    body. Raises SceneError if the scene or the shape is refused.
    """
    what, body = command.what, command.body
    path = Path(what)
    if "=" in what and not os.path.exists(path):
        found = [_shape(what)]
    elif path.suffix.lower() == ".toml":
        scene = load_scene(path)
        bodies = by_piece(scene.bodies)
        found = [CheckedSubject(name, made, scene.length_unit) for name, made in bodies.items()]
    elif path.suffix.lower() in ENDINGS:
        parts = parts_of(path, command.meshes)
        shapes = by_piece({name: part.shape for name, part in parts.found.items()})
        found = [
            CheckedSubject(name, made, parts.unit, parts.notes) for name, made in shapes.items()
        ]
    elif path.suffix.lower() == ".json":
        problem = file_problem(path, what, "the current folder")
        if problem is not None:
            raise CommandError(problem)
        table = SceneTable({"shape": "patches", "file": what}, path="body")
        found = [CheckedSubject(path.stem, read_body(table), DEFAULT_LENGTH_UNIT)]
    else:
        raise CommandError(
            f"{shown(what)} is not a scene (.toml), a file of patches (.json) or a shape such as "
            f"{EXAMPLE}, nor a file of parts ({', '.join(ENDINGS)})"
        )
    if body is None:
        return found
    chosen = [subject for subject in found if subject.name == body]
    if not chosen:
        known = [subject.name for subject in found]
        raise CommandError(f"--body: {unknown_name(body, known, 'body')}")
    return chosen


def _shape(text: str) -> CheckedSubject:
    """The body of a line such as ``shape = "box", size = [1, 2, 3]``."""
    try:
        content = toml_tables(f"body = {{{text}}}")["body"]
    except SceneError as error:
        raise CommandError(
            f"{shown(text)} is not a shape in the form that scenes use: it {error.problem}; write "
            f"one such as {EXAMPLE}"
        ) from error
    body = read_body(SceneTable(content, path="body"))
    return CheckedSubject(body.name, body, DEFAULT_LENGTH_UNIT)
