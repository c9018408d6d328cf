"""The meshes of a file, by name, each as a convex body or, where that is asked for, as its hull or
its convex pieces."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal, NamedTuple, TypeAlias

from standoff.bodies.body import Body
from standoff.bodies.meshes.decomposition import decomposition
from standoff.bodies.meshes.mesh import mesh_scene
from standoff.checks.units import METRES
from standoff.errors import BodyError, StandoffError

InsteadOf: TypeAlias = Literal["", "hull", "pieces"]
"""What stands for meshes: nothing, so that they must be convex; hulls; or convex pieces."""

UNITS = {
    "micron": ("micron", 1.0 / 1e6),
    "millimeter": ("mm", METRES["mm"]),
    "centimeter": ("cm", METRES["cm"]),
    "meter": ("m", METRES["m"]),
    "inch": ("inch", METRES["inch"]),
    "foot": ("foot", 0.3048),
}
"""Units of length by the names that 3MF has for them, with their metres; other kinds tell none."""


class MeshFile(NamedTuple):
    """The meshes of a file.

    Attributes
    ----------
    bodies : mapping of str to mapping of str to Body
        By the mesh's name; its pieces by theirs, one named "" where there is no other.
    file_unit : str
        Empty where the file tells none; else lengths were converted from it.
    notes : tuple of str
        What pieces add to their meshes and lose of them.
    """

    bodies: Mapping[str, Mapping[str, Body]]
    file_unit: str
    notes: tuple[str, ...]


def read_meshes(path: Path, unit: str, instead: InsteadOf) -> MeshFile:
    """The meshes of a file as convex bodies, in the file's frame.

    Raises BodyError: no mesh; as ``Body.from_mesh`` and ``so.bodies.decomposition``, with the
    mesh's name. Raises ModuleNotFoundError, OSError, StandoffError as ``Body.from_mesh`` of a path.

    Parameters
    ----------
    path : Path
    unit : str
        One of `METRES`, to which lengths are converted where the file tells theirs.
    instead : "", "hull" or "pieces"
    """
    scene = mesh_scene(path)
    told = str(scene.units or "").lower()
    file_unit, metres = UNITS.get(told, UNITS.get(told.removesuffix("s"), ("", 0.0)))
    factor = metres / METRES[unit] if file_unit else 1.0
    nodes = list(scene.graph.nodes_geometry)
    found: dict[str, Mapping[str, Body]] = {}
    notes = []
    for node in nodes:
        pose, geometry = scene.graph[node]
        mesh = scene.geometry[geometry]
        if not hasattr(mesh, "faces"):
            continue
        points = (mesh.vertices @ pose[:3, :3].T + pose[:3, 3]) * factor
        # a mirrored mesh faces inward, which reading mends
        name = path.stem if len(nodes) == 1 else str(node)
        try:
            found[name], note = _bodies((points, mesh.faces), instead)
        except StandoffError as error:
            raise BodyError(f"{name}: {error}", "path", path) from error
        notes += [f"{name}: {note}"] if note else []
    if not found:
        raise BodyError(f"{path.name} has no mesh of triangles.", "path", path)
    return MeshFile(found, file_unit, tuple(notes))


def _bodies(mesh: Any, instead: InsteadOf) -> tuple[Mapping[str, Body], str]:
    if instead == "pieces":
        made = decomposition(mesh)
        return made.pieces, str(made)
    return {"": Body.from_mesh(mesh, hull=instead == "hull")}, ""
