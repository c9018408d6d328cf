"""What the files of all scenes have: title, unit, bodies, where they are and how they move."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from standoff.long_loops import told
from standoff.motion import Pose
from standoff.scene.compounds import read_solid
from standoff.scene.errors import SceneError
from standoff.scene.files import text_of, toml_tables
from standoff.scene.placements import read_pose
from standoff.scene.reader import SceneTable, Value, shown, unknown_name
from standoff.wording import printable
from standoff.world import Compound
from standoff.world.shapes import Shape

VERSION = 1
"""The version of the scene format that this library reads."""

DEFAULT_LENGTH_UNIT = "m"

KEYS = ("version", "title", "length_unit", "bodies", "placements", "motions")
"""Keys that the top of every scene's file may have."""

PAIR_KEYS = ("pair", "pairs", "world", "track")
SIMULATION_KEYS = ("free", "contact", "contacts", "coupler", "device", "simulate")
"""Keys besides, of the scenes of pairs and of those of simulations."""


@dataclass(frozen=True, eq=False)
class FileContent:
    """What a scene's file says, as far as it is common to all scenes.

    Attributes
    ----------
    file : Path
    text : str
        Its content.
    title : str
        A line for the reader; the file's name where the scene has none.
    length_unit : str
        Label of lengths; no number of the file is converted, lengths of CAD files are.
    top : SceneTable
        What else is read is read from it.
    bodies : mapping of str to Body, Solid or Compound
    placements : mapping of str to Pose
        Of the bodies that have one.
    motions : mapping of str to Table
        Of the bodies that have one, still to be read.
    """

    file: Path
    text: str
    title: str
    length_unit: str
    top: SceneTable
    bodies: Mapping[str, Shape | Compound]
    placements: Mapping[str, Pose]
    motions: Mapping[str, SceneTable]


def of_a_simulation(top: SceneTable | Mapping[str, object]) -> str | None:
    """Return the key that makes a file the scene of a simulation; None of another's."""
    if any(key in top for key in ("pair", "pairs", "world")):
        return None
    return next((key for key in SIMULATION_KEYS if key in top), None)


def is_simulation(file: str | os.PathLike[str]) -> bool:
    """Is a file the scene of a simulation?

    Raises SceneError if the file is missing or is not TOML.
    """
    path = Path(file)
    try:
        return of_a_simulation(toml_tables(text_of(path))) is not None
    except SceneError as error:
        raise error.found_in(path) from error


def read_content(
    file: str | os.PathLike[str],
    keys: Sequence[str],
    refuse_other_kind: Callable[[SceneTable], None],
) -> FileContent:
    """Read a scene's file.

    Raises SceneError if the file is missing or is not TOML, or anything in what is read is unknown,
    missing, of the wrong type or shape, or refused by the shape or pose that it describes.

    Parameters
    ----------
    file : str or path
        A TOML file; the files that it names are relative to its folder.
    keys : sequence of str
        Those that the top of this kind of scene may have besides `KEYS`.
    refuse_other_kind : callable
        Raises SceneError with the command to use if the file is of the other kind.
    """
    path = Path(file)
    text = text_of(path)
    try:
        content = toml_tables(text)
    except SceneError as error:
        raise error.found_in(path) from error
    top = SceneTable(content, file=path)
    _check_version(top)
    refuse_other_kind(top)
    top.expect(*KEYS, *keys)
    unit = top.text("length_unit", DEFAULT_LENGTH_UNIT)
    bodies = named(top, "bodies", partial(read_solid, unit=unit))
    if not bodies:
        raise top.error("no bodies; add a table such as [bodies.tool]", "bodies")
    return FileContent(
        file=path,
        text=text,
        title=top.text("title", path.name),
        length_unit=unit,
        top=top,
        bodies=bodies,
        placements=named(top, "placements", read_pose, bodies),
        motions=named(top, "motions", lambda table: table, bodies),
    )


def _check_version(top: SceneTable) -> None:
    """Refuse a scene of another version of the format."""
    version = top.required("version", f"version = {VERSION}")
    if type(version) is not int or version != VERSION:
        raise top.error(
            f"is {shown(version)}, but this Standoff reads version {VERSION}: "
            f"write version = {VERSION}, or install the Standoff that the scene was made for",
            "version",
        )


def named(
    top: SceneTable,
    key: str,
    read: Callable[[SceneTable], Value],
    bodies: Mapping[str, Shape | Compound] | None = None,
) -> dict[str, Value]:
    """Return what the tables ``[key.NAME]`` describe; with `bodies`, each NAME must be one."""
    if key not in top:
        return {}
    table = top.table(key)
    for name in table.names():
        if bodies is not None and name not in bodies:
            raise table.error(unknown_name(name, bodies, "body"), name)
    names = told(
        table.names(), f"reading {key} of {printable(top.file.name if top.file else 'a scene')}"
    )
    return {name: read(table.table(name)) for name in names}
