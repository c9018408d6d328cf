"""From ``[[bodies.NAME.patches]]``, or a JSON file of the same, to surface patches."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import NamedTuple

from standoff.geometry import BezierPatch, FormulaSurface, NurbsSurface, Surface
from standoff.nesting import JSON, text_problem
from standoff.scene.errors import SceneError
from standoff.scene.files import beyond_python, existing_file
from standoff.scene.reader import SceneTable, shown
from standoff.typing import Array

FORMAT = "standoff-patches"
FORMAT_VERSION = 1
"""What a JSON file of patches calls itself; docs/scene-format.md describes it."""


class PatchKind(NamedTuple):
    """One kind of patch: its keys, and what reads them."""

    keys: tuple[str, ...]
    read: Callable[[SceneTable], Surface]


def _nurbs(table: SceneTable) -> Surface:
    points, weights = _points(table), _weights(table)
    knots_u, knots_v = table.numbers("knots_u"), table.numbers("knots_v")
    return table.build(lambda: NurbsSurface(points, knots_u, knots_v, weights))


def _bezier(table: SceneTable) -> Surface:
    points, weights = _points(table), _weights(table)
    return table.build(lambda: BezierPatch(points, weights))


def _points(table: SceneTable) -> Array:
    return table.net("control_points", 3)


def _weights(table: SceneTable) -> Array | None:
    return table.net("weights", None) if "weights" in table else None


def _formula(table: SceneTable) -> Surface:
    x, y, z = (table.formula(key) for key in ("x", "y", "z"))
    domain = table.vector("domain", 4, example="domain = [0.0, 1.0, 0.0, 1.0]")
    parameters = table.named_numbers("parameters")
    return table.build(lambda: FormulaSurface(x, y, z, domain.tolist(), parameters))


PATCHES: Mapping[str, PatchKind] = {
    "nurbs": PatchKind(("control_points", "weights", "knots_u", "knots_v"), _nurbs),
    "bezier": PatchKind(("control_points", "weights"), _bezier),
    "formula": PatchKind(("x", "y", "z", "domain", "parameters"), _formula),
}
"""Every kind of patch that a body may be sewn of."""


def read_patches(table: SceneTable) -> list[Surface]:
    """Return the patches of a body, from its own tables or from the file that it names.

    Raises SceneError: at an unknown kind or key, a value that the patch refuses, or a file that is
    missing, truncated, or of another format or version.
    """
    given = table.only_one(("patches", "file"))
    if given == "file":
        file = existing_file(table, "file", 'file = "pebble.json"')
        return [_patch(entry) for entry in _of_file(file).tables("patches")]
    return [_patch(entry) for entry in table.tables("patches")]


def _patch(table: SceneTable) -> Surface:
    kind = PATCHES[table.choice("kind", list(PATCHES), "nurbs")]
    table.expect("kind", *kind.keys)
    return kind.read(table)


def _of_file(file: Path) -> SceneTable:
    """The checked top of a JSON file of patches."""
    try:
        text = file.read_bytes().decode("utf-8-sig")
        problem = text_problem(text, JSON)
        if problem:
            raise SceneError(problem)
        content = json.loads(text, object_pairs_hook=_each_key_once)
    except SceneError as error:
        raise error.found_in(file) from error
    except json.JSONDecodeError as error:
        ended = text.rstrip().endswith("}") and error.pos < len(text.rstrip())
        cut = "" if ended else "; it seems to be cut off: write it again"
        raise SceneError(
            f"is not JSON: {error.msg}: line {error.lineno}, column {error.colno}{cut}", file=file
        ) from error
    except UnicodeDecodeError as error:
        raise SceneError(
            f"is not text in UTF-8 (byte {error.start}); save it as UTF-8", file=file
        ) from error
    except OSError as error:
        raise SceneError(f"cannot be read: {error.strerror}", file=file) from error
    except ValueError as error:
        raise SceneError(beyond_python(text, error), file=file) from error
    if not isinstance(content, dict):
        raise SceneError(f"must be an object in braces, got {shown(content)}", file=file)
    top = SceneTable(content, file=file, json=True)
    if top.text("format") != FORMAT:
        raise top.error(
            f"is {shown(top.text('format'))}; a file of patches says '{FORMAT}'", "format"
        )
    version = top.required("version", "")
    if type(version) is not int or version != FORMAT_VERSION:
        raise top.error(
            f"is {shown(version)}, but this Standoff reads version {FORMAT_VERSION} of patches",
            "version",
        )
    top.expect("format", "version", "title", "patches")
    return top


def _each_key_once(pairs: list[tuple[str, object]]) -> dict[str, object]:
    content = dict(pairs)
    if len(content) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise SceneError(f"the key {shown(twice)} appears twice in one object; keep one of them")
    return content
