"""Meshes of a URDF file: which are needed, whether their files are there, and stand-ins for those
that are not read."""

from __future__ import annotations

import copy
import os
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

from standoff.errors import StandoffError
from standoff.robots.pinocchio_shapes import GeometryShape
from standoff.robots.report import HULL
from standoff.robots.shapes import MOST_NAMED, Meshes
from standoff.robots.urdf_xml import UNUSED
from standoff.robots.urdf_xml import Collision as Element

Shapes = Mapping[str, GeometryShape]
"""By name: geometries for which others stand."""
PACKAGE = "package://"


def stand_ins(
    root: Any,
    collisions: Sequence[Element],
    meshes: Meshes,
    skip: Collection[str],
    places: tuple[Path, Sequence[str]],
) -> tuple[Any, Shapes]:
    """The file with a sphere in place of each mesh that needs not be read, and what these are, by
    name; and without what says nothing of where geometry is.

    Meshes that are skipped, stood for by bodies, or refused later need no file.

    Raises StandoffError: files of meshes that are not there; all are named.
    """
    changed = copy.deepcopy(root)
    shapes: dict[str, GeometryShape] = {}
    missing: list[str] = []
    elements = (each.find("geometry") for each in changed.iterfind("link/collision"))
    for element, (name, link, kind, *_) in zip(elements, collisions, strict=True):
        shape = element.find(kind)
        if kind == "mesh" and _read(name, link, meshes, skip):
            file = shape.get("filename", "")
            if _found(file, *places) is None:
                missing.append(f"  {name!r} on link {link!r}: {file}")
        elif kind == "mesh":
            shapes[name] = GeometryShape(kind)
            element.remove(shape)
            element.append(shape.makeelement("sphere", {"radius": "1"}))
    for above in (changed, *changed.iterfind("link"), *changed.iterfind("link/collision")):
        for element in [x for x in above if x.tag in ("visual", *UNUSED)]:
            above.remove(element)
    if missing:
        more = [f"  and {len(missing) - MOST_NAMED} more"] if len(missing) > MOST_NAMED else []
        lines = "\n".join([*missing[:MOST_NAMED], *more])
        raise StandoffError(
            f"{len(missing)} files of meshes are not there:\n{lines}\nGive package_dirs=[the "
            "folder that has the packages], or leave them out by skip=[name].",
            "package_dirs",
        )
    return changed, shapes


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
