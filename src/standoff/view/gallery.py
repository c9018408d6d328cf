"""The scenes that a page can open besides its own."""

from __future__ import annotations

from pathlib import Path

from standoff.scene import SceneError
from standoff.scene.files import text_of, toml_tables

PLACES = ("*.toml", "*/*.toml")
"""Where scenes are looked for: in a folder, and in those in it."""

MOST = 60
"""Scenes of a gallery: a list of more is not read."""


def scenes_in(folder: Path) -> dict[str, Path]:
    """Return the scenes of pairs in a folder by the names that the gallery shows.

    A file that cannot be read, and one of another kind, such as a simulation of free bodies, is
    left out.

    Parameters
    ----------
    folder : Path

    Returns
    -------
    dict of str to Path
    """
    files = [file for place in PLACES for file in sorted(folder.glob(place))]
    found = {file.relative_to(folder).with_suffix("").as_posix(): file for file in files}
    return dict([(name, file) for name, file in found.items() if _has_pairs(file)][:MOST])


def _has_pairs(file: Path) -> bool:
    try:
        tables = toml_tables(text_of(file))
    except SceneError:
        return False
    # A sweep's job names the pair of its scene.
    return not tables.keys() & {"free", "scene"} and ("pair" in tables or "pairs" in tables)
