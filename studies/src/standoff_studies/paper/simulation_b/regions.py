"""Fig. 8: the planar body, its Voronoi lines and medial axis, and the point's spiral."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from standoff.bodies.voronoi import MedialBranch
from standoff_studies.paper import style
from standoff_studies.paper.drawing import draw_planar_body, name_features, short_name, show_plane
from standoff_studies.paper.figure import Artwork, Statement
from standoff_studies.paper.simulation_b.run import NO_LAW, Run, run
from standoff_studies.paper.voronoi_drawing import draw_planar_regions

EXTENT = 1.85
"""Half width of the view [length]: the spiral ends at 1.73."""
ARROWS = (0.5, 1.25, 2.2, 3.1, 3.72)
"""Times of the arrow heads on the spiral [s]."""
SAME = 1e-9
"""Two depths at the medial axis's junction that differ less are equal [length]."""


def figure_8() -> Artwork:
    """Make Fig. 8."""
    simulation = run()
    return Artwork(
        caption=(
            "The planar body: three convex curves C0, C1, C2 and three vertices V0, V1, V2. "
            "Outside, two Voronoi lines (dashed) go out from each vertex: between them the vertex "
            "is nearest, beside them a curve. Inside, on the medial axis (dash-dotted), two "
            "curves are equally near, and at its junction all three. The grey spiral is the "
            "point's path, from the middle outwards. Lengths in the body's unit."
        ),
        text=(
            "A rounded triangle with six dashed rays, three branches inside that meet in the "
            "middle, and a spiral of four turns around the origin."
        ),
        draw=lambda: _draw(simulation),
        tables={"voronoi_lines": _lines(simulation), "medial_axis": _axis(simulation)},
        statements=_statements(simulation),
    )


def _lines(simulation: Run) -> dict[str, ArrayLike]:
    """Each external line: its two features, where it begins and its direction."""
    rays = [(ray, ray.grid(1.0)[0]) for ray in simulation.regions.external]
    table: dict[str, ArrayLike] = {
        f"feature_{k + 1}": [short_name(ray.features[k]) for ray, _ in rays] for k in range(2)
    }
    for k, axis in enumerate("xy"):
        table[f"vertex_{axis}_length"] = [points[0, k] for _, points in rays]
        table[f"direction_{axis}"] = [points[-1, k] - points[0, k] for _, points in rays]
    return table


def _axis(simulation: Run) -> dict[str, ArrayLike]:
    branches = simulation.regions.medial_axis
    counts = [len(branch.points) for branch in branches]
    points = np.vstack([branch.points for branch in branches])
    return {
        "branch": np.repeat([_name(branch) for branch in branches], counts),
        "x_length": points[:, 0],
        "y_length": points[:, 1],
        "depth_length": np.concatenate([branch.depth for branch in branches]),
    }


def _name(branch: MedialBranch) -> str:
    return "-".join(short_name(feature) for feature in branch.features)


def _statements(simulation: Run) -> tuple[Statement, ...]:
    regions = simulation.regions
    ends = [
        (end.kind, branch.points[k], float(branch.depth[k]))
        for branch in regions.medial_axis
        for k, end in zip((0, -1), branch.ends, strict=True)
    ]
    junctions = [(point, depth) for kind, point, depth in ends if kind == "junction"]
    spread = max(
        float(np.linalg.norm(point - junctions[0][0])) + abs(depth - junctions[0][1])
        for point, depth in junctions
    )
    corners = sum(kind == "corner" for kind, _, _ in ends)
    x, y = junctions[0][0][:2]
    return (
        Statement(
            "Fig. 8",
            "six external Voronoi lines",
            f"{len(regions.external)} lines, two from each of {simulation.body.n_vertices} "
            "vertices, perpendicular to its two curves",
            len(regions.external) == 6,
            "the body is ours, with three vertices, and two lines are drawn from each",
            NO_LAW,
            constructed=True,
        ),
        Statement(
            "Fig. 8",
            "internal medial axes",
            f"{len(regions.medial_axis)} branches from {corners} corners to one junction at "
            f"({x:.4f}, {y:.4f}), depth {junctions[0][1]:.4f} length; their ends there agree "
            f"within {spread:.0e}",
            len(regions.medial_axis) == 3 and corners == 3 and spread < SAME,
            by=NO_LAW,
        ),
    )


def _draw(simulation: Run) -> Figure:
    figure = style.new_figure(style.WIDTH, 7.3)
    axes = figure.subplots()
    _draw_path(axes, simulation)
    draw_planar_regions(
        axes, simulation.regions, reach=3.0, colour=style.RED, label="Voronoi:", linewidth=1.4
    )
    draw_planar_body(axes, simulation.body, colour=style.BLUE, linewidth=2.4)
    name_features(
        axes,
        simulation.body,
        inset=-0.12,
        color=style.BLUE,
        fontweight="bold",
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.6, "alpha": 0.85},
        zorder=6,
    )
    show_plane(axes, EXTENT)
    figure.legend(loc="outside lower center", ncols=3, frameon=False)
    return figure


def _draw_path(axes: Axes, simulation: Run) -> None:
    points = simulation.exact.point
    axes.plot(
        points[:, 0], points[:, 1], color=style.QUIET, linewidth=1.2, label="path of the point"
    )
    axes.plot(*points[0, :2], "o", color=style.BLACK, markersize=4.5, zorder=6)
    for time in ARROWS:
        k = int(np.searchsorted(simulation.exact.time, time))
        axes.annotate(
            "",
            tuple(points[k + 4, :2].tolist()),
            tuple(points[k, :2].tolist()),
            arrowprops={"arrowstyle": "-|>", "color": "#5F5F5F", "mutation_scale": 14.0},
        )
