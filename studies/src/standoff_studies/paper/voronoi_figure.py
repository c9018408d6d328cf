"""Key "voronoi": regions of the planar body and of the lens, computed before any run."""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from standoff.bodies import Body, shapes
from standoff.bodies.features import Feature
from standoff.bodies.voronoi import VoronoiRegions, voronoi_regions
from standoff.geometry import ConicArc, Line
from standoff.motion import Pose
from standoff.tracking import distance
from standoff.typing import Array
from standoff_studies.paper import style
from standoff_studies.paper.bodies import lens_of_patches, planar_body
from standoff_studies.paper.drawing import curve_points, draw_planar_body, short_name
from standoff_studies.paper.drawing_3d import View
from standoff_studies.paper.figure import Artwork, Statement, measured_by, own_statement
from standoff_studies.paper.keys import key_fill
from standoff_studies.paper.voronoi_drawing import draw_planar_regions, draw_space_regions

REACH = 0.8
"""Length of the drawn rays [length]."""
POINTS = 100
"""Random points around each body at which two ways to find the nearest feature are compared."""
DENSE = 5001
"""Samples of a curve for the distances by brute force."""
SQUARE = 1e-12
"""A line this near to its curve's normal is along it [rad]: roundoff."""
SAME = 1e-7
"""Two distances that differ by less are equal if one is to chords of such samples [length]."""
EXACT = 1e-11
"""Largest error against a closed form [length]."""


LAW = "so.voronoi_regions and so.distance, before any run: no law"
"""The law with which the statements were measured: none."""


class Study(NamedTuple):
    """What is drawn and measured.

    Attributes
    ----------
    planar, lens : VoronoiRegions
    worst_depth : float
        Largest difference between a depth of the axis and the distance to either of its two
        curves, or to the nearest curve, by dense samples [length].
    agreed : (int, int)
        At how many of `POINTS` points outside the planar body, and outside the lens, ``feature_at``
        and ``so.distance`` name the same feature.
    ellipse_error, half_disc_error : float
        Errors of two medial axes against their closed forms [length].
    """

    planar: VoronoiRegions
    lens: VoronoiRegions
    worst_depth: float
    agreed: tuple[int, int]
    ellipse_error: float
    half_disc_error: float


@cache
def study() -> Study:
    """Compute the regions and the numbers about them."""
    planar = voronoi_regions(planar_body(), reach=REACH)
    lens = voronoi_regions(lens_of_patches(), reach=REACH)
    return Study(
        planar,
        lens,
        _worst_depth(planar),
        (_agreed(planar), _agreed(lens)),
        _ellipse_error(2.0, 1.0),
        _half_disc_error(),
    )


def _worst_depth(regions: VoronoiRegions) -> float:
    body = regions.body
    samples = [curve_points(body, k, count=DENSE) for k in range(body.n_edges)]
    worst = 0.0
    for branch in regions.medial_axis:
        for point, depth in zip(branch.points[:, :2], branch.depth.tolist(), strict=True):
            found = [_to_chords(point, s) for s in samples]
            named = [found[feature.index] for feature in branch.features]
            worst = max(worst, *(abs(d - depth) for d in (*named, min(found))))
    return worst


def _to_chords(point: Array, along: Array) -> float:
    """Distance from a point (2,) to the chords between samples (n, 2) [length]."""
    chords, out = np.diff(along, axis=0), point - along[:-1]
    shares = (out * chords).sum(axis=1) / (chords * chords).sum(axis=1)
    miss = out - np.clip(shares, 0.0, 1.0)[:, None] * chords
    return float(np.sqrt((miss * miss).sum(axis=1).min()))


def _agreed(regions: VoronoiRegions) -> int:
    """At how many of `POINTS` random points outside do both ways name the same feature?"""
    body, point, rng = regions.body, shapes.point(), np.random.default_rng(1)
    same = asked = 0
    while asked < POINTS:
        place = rng.normal(size=3) * body.size
        if body.dimension == 2:
            place[2] = 0.0
        answer = distance(body, point, Pose.identity(), Pose(np.eye(3), place))
        if answer.certified and answer.distance > 0.0:
            asked += 1
            same += regions.feature_at(place) == answer.feature_a
    return same


def _ellipse_error(a: float, b: float) -> float:
    """For the axis of an ellipse with semi-axes a > b: ends at ±(a - b²/a), with depth b²/a."""
    (branch,) = voronoi_regions(shapes.planar_loop([ConicArc((0, 0), (a, 0), (0, b))])).medial_axis
    ends = np.sort(branch.points[[0, -1], 0])
    found = np.concatenate([ends, branch.depth[[0, -1]], branch.points[:, 1]])
    exact = np.zeros_like(found)
    exact[:4] = [-(a - b * b / a), a - b * b / a, b * b / a, b * b / a]
    return float(np.abs(found - exact).max())


def _half_disc_error() -> float:
    """For the axis of half a unit disc: the parabola y = (1 - x²)/2."""
    body = shapes.planar_loop([ConicArc((0, 0), (1, 0), (0, 1), 0.0, np.pi), Line((-1, 0), (1, 0))])
    (branch,) = voronoi_regions(body).medial_axis
    x, y = branch.points[:, 0], branch.points[:, 1]
    return float(np.abs(y - 0.5 * (1.0 - x * x)).max())


def regions() -> Artwork:
    """Make the figure."""
    found = study()
    return Artwork(
        caption=(
            "Above: the planar body with the six lines that separate the regions of its curves "
            "C0 to C2 and vertices V0 to V2 outside (dashed), and its medial axis inside "
            "(dash-dotted); each region bears the name of its feature. Below: the lens with the "
            "surfaces between its external regions. Above an edge is a wedge between two ruled "
            "surfaces (orange), normal to the two faces there; above a vertex, a cone with three "
            "plane sides (blue); the rest belongs to the faces. Surfaces are cut off "
            f"{REACH:g} length from the body."
        ),
        text=(
            "A rounded triangle with two dashed rays at each corner and a three-armed line "
            "inside; a lens with curved translucent sheets along its edges and fans at its tips."
        ),
        draw=_draw,
        tables={"planar_lines": _rays(found.planar), "lens_rays": _rays(found.lens)},
        statements=measured_by(LAW, _statements(found)),
    )


def _rays(regions: VoronoiRegions) -> dict[str, ArrayLike]:
    """Every ray: number of its boundary, the two features, start and direction."""
    counts = [len(b.origins) for b in regions.external]
    table: dict[str, ArrayLike] = {"boundary": np.repeat(np.arange(len(counts)), counts)}
    for k in range(2):
        table[f"feature_{k + 1}"] = np.repeat(
            [str(b.features[k]) for b in regions.external], counts
        )
    starts = np.concatenate([b.origins for b in regions.external])
    ways = np.concatenate([b.directions for b in regions.external])
    for k, axis in enumerate("xyz"):
        table[f"start_{axis}_length"] = starts[:, k]
        table[f"direction_{axis}"] = ways[:, k]
    return table


def _statements(found: Study) -> tuple[Statement, ...]:
    kinds = [tuple(f.kind for f in b.features) for b in found.lens.external]
    sheets, sectors = kinds.count(("face", "edge")), kinds.count(("edge", "vertex"))
    squareness = max(
        float(abs(_tangent(found.planar.body, *ray.features) @ ray.directions[0]))
        for ray in found.planar.external
    )
    return (
        Statement(
            "Fig. 8",
            "six external Voronoi lines, drawn before the run",
            f"{len(found.planar.external)} lines, perpendicular to their curves within "
            f"{max(squareness, 1e-16):.0e} rad",
            len(found.planar.external) == 6 and squareness < SQUARE,
        ),
        Statement(
            "Fig. 8",
            "internal medial axes",
            f"{len(found.planar.medial_axis)} branches; their depths are the distances to both "
            f"curves and to the nearest one within {found.worst_depth:.0e} length (dense samples)",
            len(found.planar.medial_axis) == 3 and found.worst_depth < SAME,
        ),
        own_statement(
            "Fig. 16",
            f"lens: {sheets} surfaces between face and edge, {sectors} sectors between edge and "
            "vertex",
        ),
        Statement(
            "so.distance",
            "-",
            f"the region that a point lies in is that of the certified answer's feature: planar "
            f"body {found.agreed[0]} of {POINTS} points, lens {found.agreed[1]} of {POINTS}",
            found.agreed == (POINTS, POINTS),
        ),
        Statement(
            "closed forms",
            "-",
            f"medial axis of an ellipse off by {found.ellipse_error:.0e}, of half a disc by "
            f"{found.half_disc_error:.0e} length",
            max(found.ellipse_error, found.half_disc_error) < EXACT,
        ),
    )


def _tangent(body: Body, edge: Feature, vertex: Feature) -> Array:
    """The unit tangent (3,) of an edge at one of its vertices."""
    part = body.edge_parts[edge.index]
    curve = part.curve
    tangent = curve.jet(curve.first if part.first == vertex.index else curve.last)[1]
    return np.asarray(tangent / np.linalg.norm(tangent))


def _draw() -> Figure:
    found = study()
    figure = style.new_figure(style.WIDTH, 11.6)
    above, below = figure.subplots(2, 1)
    _draw_planar(above, found.planar)
    _draw_lens(below, found.lens)
    return figure


def _draw_planar(axes: Axes, regions: VoronoiRegions) -> None:
    draw_planar_regions(axes, regions, colour=style.RED, label="Voronoi:", linewidth=1.5)
    draw_planar_body(axes, regions.body, colour=style.BLUE, linewidth=2.2)
    name: dict[str, Any] = {"ha": "center", "va": "center", "color": style.BLACK}
    for cone in regions.cones:
        way = cone.normals.sum(axis=0)
        place = cone.point + 0.72 * REACH * way / np.linalg.norm(way)
        axes.text(place[0], place[1], short_name(cone.vertex), **name)
    for k, edge in enumerate(regions.body.edge_parts):
        x, tangent, _ = edge.curve.jet(0.5)
        out = np.array([tangent[1], -tangent[0], 0.0]) / np.linalg.norm(tangent)
        for offset in (0.35, -0.4):
            place = x + offset * out
            axes.text(place[0], place[1], short_name(Feature("edge", k)), **name)
    axes.grid(visible=False)
    axes.set_xlabel("x [length]")
    axes.set_ylabel("y [length]")
    axes.legend(loc="lower right", frameon=False)


def _draw_lens(axes: Axes, regions: VoronoiRegions) -> None:
    view = View(azimuth=24.0, elevation=22.0)
    view.body(regions.body)
    draw_space_regions(view, regions)
    view.paint(axes)
    marks = [
        key_fill("between a face and an edge", style.ORANGE, edgecolor=style.ORANGE, alpha=0.5),
        key_fill("between an edge and a vertex", style.BLUE, edgecolor=style.BLUE, alpha=0.5),
    ]
    axes.legend(handles=marks, loc="upper center", bbox_to_anchor=(0.5, -0.01), frameon=False)
    corner = view.flat(np.zeros(3)) + np.array([-1.75, -1.55])
    view.triad(axes, (float(corner[0]), float(corner[1])), 0.3, "length")
