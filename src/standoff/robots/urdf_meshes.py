"""Meshes of a URDF file: which are needed, whether their files are there, and stand-ins for those
that are not read."""

from __future__ import annotations

import copy
import os
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from standoff.errors import StandoffError
from standoff.robots.report import HULL
from standoff.robots.shapes import MOST_NAMED, Meshes

PACKAGE = "package://"


def collisions(root: Any) -> Iterator[tuple[str, str, Any]]:
    """(name as Pinocchio gives it, link, geometry element) of all collision elements."""
    for link in root.iter("link"):
        name = link.get("name", "")
        for k, collision in enumerate(link.findall("collision")):
            geometry = collision.find("geometry")
            if geometry is not None:
                yield f"{name}_{k}", name, geometry


def stand_ins(
    root: Any, meshes: Meshes, skip: Collection[str], places: tuple[Path, Sequence[str]]
) -> tuple[Any, dict[str, str]]:
    """The file with a sphere in place of each mesh that needs not be read, and their kinds by name.

    Those that are skipped, stood for by bodies, or refused later need no file.

    Raises
    ------
    StandoffError
        Files of meshes that are not there; all are named.
    """
    changed = copy.deepcopy(root)
    kinds: dict[str, str] = {}
    missing: list[str] = []
    for name, link, geometry in collisions(changed):
        mesh = geometry.find("mesh")
        if mesh is None:
            continue
        if _read(name, link, meshes, skip):
            file = mesh.get("filename", "")
            if _found(file, *places) is None:
                missing.append(f"  {name!r} on link {link!r}: {file}")
            continue
        kinds[name] = "mesh"
        geometry.remove(mesh)
        geometry.append(mesh.makeelement("sphere", {"radius": "1"}))
    if missing:
        more = [f"  and {len(missing) - MOST_NAMED} more"] if len(missing) > MOST_NAMED else []
        lines = "\n".join([*missing[:MOST_NAMED], *more])
        raise StandoffError(
            f"{len(missing)} files of meshes are not there:\n{lines}\nGive package_dirs=[the "
            "folder that has the packages], or leave them out by skip=[name].",
            "package_dirs",
        )
    return changed, kinds


def _read(name: str, link: str, meshes: Meshes, skip: Collection[str]) -> bool:
    """Is the file of a mesh needed?"""
    if name in skip or link in skip or meshes is None:
        return False
    return (meshes.get(name) if isinstance(meshes, Mapping) else meshes) == HULL


def _found(file: str, urdf: Path, folders: Sequence[str]) -> Path | None:
    """The file of a mesh, as Pinocchio finds it."""
    if file.startswith(PACKAGE):
        # files with package:/// are found by Pinocchio too: a path that begins with / would not be
        # joined to the folder
        within = file[len(PACKAGE) :].lstrip("/")
        tried = [Path(folder) / within for folder in folders]
    else:
        plain = file.removeprefix("file://")
        tried = [Path(plain), urdf.parent / plain]
    return next((path for path in tried if os.path.isfile(path)), None)
