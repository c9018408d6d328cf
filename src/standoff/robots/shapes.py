"""Exact bodies of a model's geometries, and hulls of meshes where they are asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
import scipy

from standoff.bodies import shapes
from standoff.bodies.body import Body
from standoff.bodies.hulls.qhull import hull_triangles
from standoff.checks.names import did_you_mean
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.robots.geoms import Geoms
from standoff.robots.report import EXACT, GIVEN, HULL, SKIPPED, UNSEEN, GeomReport
from standoff.typing import Array, Ints
from standoff.world import Compound
from standoff.world.shapes import Shape, as_shape

Meshes = Any

MOST_NAMED = 8
"""How many geometries a message names."""


class Source(NamedTuple):
    """One geometry as a model has it.

    Attributes
    ----------
    name, link, kind : str
    joint : int
        In whose moved frame it is fixed; -1 for the world.
    placement : (4, 4) array
        Of its frame there.
    collides : bool
    size : tuple of float
        Of a kind in `EXACT_KINDS`.
    mesh : callable or None
        Gives the points and triangles of a mesh, in the geometry's frame.
    file_frame : (4, 4) array or None
        Of a mesh: the frame of its file in the geometry's frame, where they differ.
    """

    name: str
    link: str
    kind: str
    joint: int
    placement: Array
    collides: bool = True
    size: tuple[float, ...] = ()
    mesh: Callable[[], tuple[Array, Ints]] | None = None
    file_frame: Array | None = None


class GeometryBodies(NamedTuple):
    """Bodies of a model's geometries.

    Attributes
    ----------
    geoms : Geoms
    numbers : dict of int to int
        From the number of a source to that of its geometry.
    reports : tuple of GeomReport
    """

    geoms: Geoms
    numbers: dict[int, int]
    reports: tuple[GeomReport, ...]


def _grown_box(x: float, y: float, z: float, rounding: float) -> Body:
    """A box with a ball swept over it: its outer size grows."""
    size = (x + 2.0 * rounding, y + 2.0 * rounding, z + 2.0 * rounding)
    return shapes.box(size, rounding)


EXACT_KINDS: dict[str, Callable[..., Body]] = {
    "sphere": lambda r, rounding: shapes.sphere(r, rounding=rounding),
    "capsule": lambda r, length, rounding: shapes.capsule(r, length, rounding=rounding),
    "cylinder": lambda r, height, rounding: shapes.cylinder(r, height, rounding=rounding),
    "ellipsoid": lambda a, b, c, rounding: shapes.ellipsoid(a, b, c, rounding=rounding),
    "box": _grown_box,
    "cone": lambda r, height, rounding: shapes.cone(r, height, rounding=rounding),
    "plane": lambda x, y, z, offset, rounding: shapes.halfspace(
        (x, y, z), offset, rounding=rounding
    ),
}
"""By kind, of the numbers in `Source.size`; the last is the radius of a ball swept over it."""

WHY_NOT = {
    "mesh": "a mesh: give meshes='hull' for its hull, or meshes={name: a body}",
    "hfield": "a height field: leave it out by skip=[name], or give convex pieces as obstacles",
    "sdf": "a signed distance function: give meshes={name: a body}, or leave it out by skip=[name]",
}
"""What is said of kinds without an exact body."""
OTHER_KIND = "of a kind that has no exact body: give meshes={name: a body}, or skip=[name]"


@lru_cache(maxsize=4096)
def exact_body(kind: str, size: tuple[float, ...]) -> Body:
    """The body of a geometry; the same object for equal ones, which a world then packs once."""
    return EXACT_KINDS[kind](*size)


def made_geoms(
    sources: Sequence[Source], meshes: Meshes, skip: Sequence[str], what: str
) -> GeometryBodies:
    """Bodies for all geometries that collide and are not skipped.

    Raises StandoffError: some have no body: all are named, with what to do.
    """
    sources = _with_own_names(sources)
    left_out = _skipped(sources, skip)
    given = _given_meshes(sources, meshes)
    kept: list[tuple[int, Shape | Compound, Array]] = []
    reports: list[GeomReport] = []
    refused: list[tuple[Source, str]] = []
    for k, source in enumerate(sources):
        if not source.collides or source.name in left_out:
            became = UNSEEN if not source.collides else SKIPPED
            reports.append(GeomReport(source.name, source.link, source.kind, became, 0.0))
            continue
        try:
            body, placement, report = _made(source, given)
        except StandoffError as error:
            refused.append((source, str(error)))
            continue
        kept.append((k, body, placement))
        reports.append(report)
    if refused:
        raise _refusal(refused, what)
    if not kept:
        raise StandoffError(
            f"{what} has no geometry that collides ({len(sources)} in all): give a model with "
            "collision geometries.",
            "model",
        )
    geoms = Geoms(
        tuple(sources[k].name for k, _, _ in kept),
        tuple(sources[k].link for k, _, _ in kept),
        np.array([sources[k].joint for k, _, _ in kept], dtype=np.int64),
        np.array([placement for _, _, placement in kept]),
        tuple(body for _, body, _ in kept),
    )
    return GeometryBodies(geoms, {k: n for n, (k, _, _) in enumerate(kept)}, tuple(reports))


def _made(source: Source, given: Mapping[str, Any]) -> tuple[Shape | Compound, Array, GeomReport]:
    """The body of one geometry, its placement, and what became of it."""
    name, link, kind = source.name, source.link, source.kind
    choice = given.get(name)
    if choice is not None and choice != HULL:
        frame = np.eye(4) if source.file_frame is None else source.file_frame
        return choice, source.placement @ frame, GeomReport(name, link, kind, GIVEN, np.nan)
    if kind in EXACT_KINDS:
        body = exact_body(kind, source.size)
        return body, source.placement, GeomReport(name, link, kind, EXACT, 0.0)
    if choice == HULL and source.mesh is not None:
        points, triangles = source.mesh()
        hull = Body.from_points(points, name=name)
        gap = hull_gap(points, triangles)
        return hull, source.placement, GeomReport(name, link, kind, HULL, gap)
    raise StandoffError(WHY_NOT.get(kind, OTHER_KIND))


def _refusal(refused: Sequence[tuple[Source, str]], what: str) -> StandoffError:
    """One error for all geometries that have no body."""
    lines = [
        f"  {source.name!r} on link {source.link!r} is {why}"
        for source, why in refused[:MOST_NAMED]
    ]
    if len(refused) > MOST_NAMED:
        lines.append(f"  and {len(refused) - MOST_NAMED} more")
    count = len(refused)
    said = f"{count} {'geometry' if count == 1 else 'geometries'} of {what} cannot be taken"
    return StandoffError("\n".join([f"{said}:", *lines]), "meshes", refused[0][0].name)


def _with_own_names(sources: Sequence[Source]) -> list[Source]:
    """Unnamed geometries are "link/0", ...; each has a name of its own."""
    taken = {source.name for source in sources if source.name}
    counts: dict[str, int] = {}
    found = []
    for source in sources:
        if not source.name:
            number = counts.get(source.link, 0)
            while f"{source.link}/{number}" in taken:
                number += 1
            counts[source.link] = number + 1
            source = source._replace(name=f"{source.link}/{number}")
        found.append(source)
    return found


def _skipped(sources: Sequence[Source], skip: Sequence[str]) -> set[str]:
    """Names of the geometries that are left out, by their names or their links'."""
    if isinstance(skip, str) or not all(isinstance(name, str) for name in skip):
        raise StandoffTypeError(
            f"skip = {shown(skip)}: give a list of names of geometries or links.", "skip", skip
        )
    known = {source.name for source in sources} | {source.link for source in sources}
    for name in skip:
        if name not in known:
            raise StandoffError(
                f"skip has {name!r}, which is no geometry or link of the model."
                f"{did_you_mean(name, sorted(known))}",
                "skip",
                name,
            )
    return {source.name for source in sources if {source.name, source.link} & set(skip)}


def _given_meshes(sources: Sequence[Source], meshes: Meshes) -> dict[str, Any]:
    """What stands for meshes, by name."""
    if meshes is None:
        return {}
    if isinstance(meshes, str) and meshes == HULL:
        return {source.name: HULL for source in sources}
    if not isinstance(meshes, Mapping):
        raise StandoffTypeError(
            f"meshes = {shown(meshes)}: give None, 'hull', or a mapping of names of geometries to "
            "'hull', a Body, a Solid or a Compound.",
            "meshes",
            meshes,
        )
    kinds = {source.name: source.kind for source in sources}
    found: dict[str, Any] = {}
    for name, choice in meshes.items():
        if name not in kinds:
            hint = did_you_mean(str(name), sorted(kinds))
            raise StandoffError(
                f"meshes has {shown(name)}, which is no geometry of the model.{hint}",
                "meshes",
                name,
            )
        if kinds[name] in EXACT_KINDS:
            raise StandoffError(
                f"meshes has {name!r}, which is a {kinds[name]}: it has its exact body.",
                "meshes",
                name,
            )
        shape = choice if isinstance(choice, str | Compound) else as_shape(choice)
        if shape is None or (isinstance(shape, str) and shape != HULL):
            raise StandoffTypeError(
                f"meshes[{name!r}] is {shown(choice)}: give 'hull', a Body, a Solid or a Compound.",
                "meshes",
                choice,
            )
        found[name] = shape
    return found


# How far the surface of a mesh's hull is from the mesh.

SPOTS, SAMPLES = 4096, 40_000
"""Points of the hull, and of the mesh beside its corners: evenly by area."""
MEASURED = 64
"""Points of the hull whose distance from all triangles is taken: those farthest from samples of
the mesh."""
GOLDEN = np.array([0.7548776662466927, 0.5698402909980532])
"""Steps of the sequence in the plane that is spread most evenly (of Roberts)."""


def hull_gap(points: Array, triangles: Ints) -> float:
    """The greatest distance of the hull's surface from the triangles that was found, length.

    It is exact for the points that are measured, so never more than the true one. The mesh may
    have holes.
    """
    facets = hull_triangles(points, "vertices of the mesh").corners
    spots = _samples(points[facets], SPOTS)
    corners = points[triangles]
    samples = np.concatenate([points, _samples(corners, SAMPLES)])
    near = scipy.spatial.cKDTree(samples, balanced_tree=False).query(spots)[0]
    middles = corners.mean(axis=1)
    radii = np.linalg.norm(corners - middles[:, None], axis=2).max(axis=1)
    gap = 0.0
    for k in np.argsort(near)[-MEASURED:]:
        # a sample is this near, so triangles that are farther are not the nearest
        some = np.linalg.norm(middles - spots[k], axis=1) - radii <= near[k]
        gap = max(gap, _from_triangles(spots[k], corners[some]))
    return gap


def _samples(corners: Array, count: int) -> Array:
    """Points of triangles (t, 3, 3), as dense everywhere."""
    sides = corners[:, 1:] - corners[:, :1]
    areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    ends = np.cumsum(areas)
    owners = np.searchsorted(ends, (np.arange(count) + 0.5) / count * ends[-1])
    shares = np.modf((1.0 + np.arange(count))[:, None] * GOLDEN)[0]
    over = shares.sum(axis=1) > 1.0
    shares[over] = 1.0 - shares[over]
    return np.asarray(corners[owners, 0] + np.einsum("nk,nkj->nj", shares, sides[owners]))


def _from_triangles(spot: Array, corners: Array) -> float:
    """The least distance of a point from triangles (t, 3, 3)."""
    starts, ends = corners, np.roll(corners, -1, axis=1)
    sides = ends - starts
    lengths = np.maximum(np.einsum("tkj,tkj->tk", sides, sides), np.finfo(float).tiny)
    shares = np.clip(np.einsum("tkj,tkj->tk", spot - starts, sides) / lengths, 0.0, 1.0)
    from_sides = np.linalg.norm(spot - (starts + shares[..., None] * sides), axis=2).min()
    normals = np.cross(sides[:, 0], sides[:, 1])
    sizes = np.linalg.norm(normals, axis=1)
    firm = sizes > 0.0
    normals = normals[firm] / sizes[firm, None]
    inward = np.cross(normals[:, None], sides[firm])
    above = (np.einsum("tkj,tkj->tk", spot - starts[firm], inward) >= 0.0).all(axis=1)
    heights = np.abs(np.einsum("tj,tj->t", spot - starts[firm, 0], normals))
    return float(min(from_sides, heights[above].min(initial=np.inf)))
