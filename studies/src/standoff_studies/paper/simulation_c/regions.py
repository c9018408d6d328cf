"""Fig. 12: both bodies with the Voronoi regions of their features, outside and inside."""

from __future__ import annotations

from functools import cache

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from standoff.bodies import Body
from standoff.bodies.voronoi import VoronoiRegions, voronoi_regions
from standoff.motion import Pose, Twist
from standoff.recording import RecordedEvent
from standoff.tracking import Tracker
from standoff_studies.paper import style
from standoff_studies.paper.drawing import (
    draw_planar_body,
    name_features,
    planar_features,
    short_name,
)
from standoff_studies.paper.figure import HYBRID, Artwork, Statement
from standoff_studies.paper.pair_simulation import Simulation
from standoff_studies.paper.simulation_c.run import (
    SIMULATION,
)
from standoff_studies.paper.voronoi_drawing import draw_planar_regions

VIEWS = (((-1.75, 1.95), 0.34), ((-1.45, 1.45), 0.17))
"""For A and B: the range of x [length], and how far inside a curve its inner region is named."""
HEIGHT = (-1.75, 1.85)
"""The range of y of both, so that both have the same scale [length]."""
RAY = 4.0
"""Length of the drawn external lines: out of the view [length]."""
LINES = "#404040"
"""Dark enough for thin broken lines."""
CURVES_OUT, VERTICES_OUT, NARROW_OUT = 0.33, 0.52, 1.15
"""How far outside curves and vertices their regions are named, and B's narrow V2 [length]."""
ON_LINE = 1e-9
"""A witness point within this of an external line is on it [length]: instants of 1e-9 s."""


def figure_12() -> Artwork:
    """Make Fig. 12."""
    simulation = SIMULATION
    return Artwork(
        caption=(
            "The two bodies, each in its own axes, at one scale. Dashed: external lines, the "
            "normals of the curves at their ends, two at each vertex. Dash-dotted: the medial "
            "axis, whose points have two nearest curves. A name stands in the region of the points "
            "that have their nearest boundary point on that curve (C) or vertex (V)."
        ),
        text=(
            "Left body A with three curves and three vertices, six outward lines and a "
            "three-branched medial axis; right body B, a leaf with two sharp tips and one blunt "
            "corner, the same, flatter."
        ),
        draw=lambda: _draw(simulation),
        tables={"external_lines": _lines(simulation), "medial_axes": _axes(simulation)},
        statements=_statements(simulation),
    )


@cache
def regions() -> tuple[VoronoiRegions, VoronoiRegions]:
    """Return the Voronoi regions of A and of B, computed once."""
    simulation = SIMULATION
    return voronoi_regions(simulation.a), voronoi_regions(simulation.b)


def _lines(simulation: Simulation) -> dict[str, ArrayLike]:
    found = [(name, line) for name, r in zip("AB", regions(), strict=True) for line in r.external]
    points = np.array([[line.origins[0], line.directions[0]] for _, line in found])
    return {
        "body": [name for name, _ in found],
        "between": ["/".join(short_name(f) for f in line.features) for _, line in found],
        "start_x_length": points[:, 0, 0],
        "start_y_length": points[:, 0, 1],
        "direction_x": points[:, 1, 0],
        "direction_y": points[:, 1, 1],
    }


def _axes(simulation: Simulation) -> dict[str, ArrayLike]:
    rows = [
        (name, number, "/".join(short_name(f) for f in branch.features), *point[:2], depth)
        for name, r in zip("AB", regions(), strict=True)
        for number, branch in enumerate(r.medial_axis)
        for point, depth in zip(branch.points.tolist(), branch.depth.tolist(), strict=True)
    ]
    names = ("body", "branch", "between", "x_length", "y_length", "depth_length")
    return dict(zip(names, map(list, zip(*rows, strict=True)), strict=True))


def off_line(simulation: Simulation, event: RecordedEvent) -> float:
    """Return how far the other body's witness point is from the external line at a switch [length].

    It is the line between the regions of the features that the switch is from and to.
    """
    path = simulation.paths[1]
    poses = Pose.identity(), path.pose(event.time)
    tracker = Tracker(simulation.a, simulation.b, simulation.step)
    answer = tracker.start(*poses, Twist.zero(), path.twist(event.time)).proximity
    own = "AB".index(event.body)
    opposing = (answer.point_b, answer.point_a)[own]
    local = poses[own].rotation.T @ (opposing - poses[own].translation)
    both = {event.source, event.target}
    (line,) = (line for line in regions()[own].external if set(line.features) == both)
    arm = local - line.origins[0]
    across = arm - max(0.0, float(arm @ line.directions[0])) * line.directions[0]
    return float(np.linalg.norm(across))


def _statements(simulation: Simulation) -> tuple[Statement, ...]:
    first, second = regions()
    counts = len(first.external), len(second.external)
    branches = len(first.medial_axis), len(second.medial_axis)
    off = max(off_line(simulation, event) for event in simulation.exact.events)
    corners = simulation.a.n_vertices, simulation.b.n_vertices
    return (
        Statement(
            "Fig. 12",
            "both bodies have external and internal Voronoi regions",
            f"external lines: {counts[0]} of A, {counts[1]} of B, two a vertex; branches of the "
            f"medial axis: {branches[0]} of A, {branches[1]} of B",
            counts == (2 * corners[0], 2 * corners[1]) and min(branches) >= 1,
            "two lines are drawn from each vertex, and a body with a corner has a branch inside",
            "so.voronoi_regions, before the run: no law",
            constructed=True,
        ),
        Statement(
            HYBRID,
            "features switch where the opposing witness point crosses into another Voronoi region",
            f"at all {len(simulation.exact.events)} switching instants it is within {off:.1e} "
            "length of the external line between the two features",
            off <= ON_LINE,
            by=simulation.own + ": the claim is of the closest points",
        ),
    )


def _draw(simulation: Simulation) -> Figure:
    figure = style.new_figure(style.WIDTH, 3.9)
    ratios = [right - left for (left, right), _ in VIEWS]
    panels = figure.subplots(1, 2, width_ratios=ratios)
    bodies = simulation.a, simulation.b
    for k, (axes, body) in enumerate(zip(panels, bodies, strict=True)):
        _draw_body(axes, body, k)
    panels[0].set_ylabel("y [length]")
    return figure


def _draw_body(axes: Axes, body: Body, k: int) -> None:
    colour = (style.BLUE, style.RED)[k]
    width, inset = VIEWS[k]
    axes.grid(visible=False)
    draw_planar_regions(axes, regions()[k], reach=RAY, colour=LINES, linewidth=1.3)
    draw_planar_body(axes, body, colour=colour)
    own = [f for f in planar_features(body) if f.kind == "edge"]
    name_features(axes, body, inset=inset, features=own, color=colour)
    name_features(axes, body, inset=-CURVES_OUT, features=own, fontweight="bold")
    corners = [f for f in planar_features(body) if f.kind == "vertex"]
    for corner in corners:
        out = NARROW_OUT if (k, corner.index) == (1, 2) else VERTICES_OUT
        name_features(axes, body, inset=-out, features=[corner], fontweight="bold")
    axes.set_xlim(width)
    axes.set_ylim(HEIGHT)
    axes.set_xlabel("x [length]")
    axes.set_title(f"body {'AB'[k]}")
