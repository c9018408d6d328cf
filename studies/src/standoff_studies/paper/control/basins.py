"""Figure "basin": starts from which the raw law, Newton and the safeguarded law succeed."""

from __future__ import annotations

from collections import Counter
from functools import cache

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.ndimage import label

import standoff as so
from standoff.control.basin import Basin, basin
from standoff.motion import Pose
from standoff.tracking.places import PlaceLike
from standoff.typing import Array
from standoff_studies.paper import style
from standoff_studies.paper.control.decay import bodies as ellipsoids
from standoff_studies.paper.figure import Artwork, Statement, measured_by, own_statement
from standoff_studies.paper.keys import key_fill

STEP = 1e-3
"""Frame time [s]."""
COLUMNS, ROWS = 90, 45
"""Starts of the map, in longitude and latitude: one every 4 degrees."""
PAIRS = 1000
"""Random starts on two ellipsoids."""
GAIN = 100.0
"""K of the raw law [1/s]: K h = 0.1, close enough to continuous time except for single starts."""
GENTLER = 50
"""Fraction of `GAIN` at which those are tried again: K h = 0.002."""

LAWS: dict[str, tuple[so.PaperLaw | so.PredictorCorrector, int]] = {
    "raw law": (so.PaperLaw(gain=GAIN, solve="plain"), 250),
    "Newton": (so.PaperLaw(integrator="euler", gain=1.0 / STEP, solve="plain"), 60),
    "safeguarded": (so.PredictorCorrector(), 2),
}
"""Each law, and its frames per start: e^-25 of an error is left, or Newton's 60 steps.
The safeguarded law settles before its first frame."""

POINT_AT = (1.05, 0.75, 0.6)
"""The point beside the ellipsoid [length]."""
POSE_B = ([0.4, -0.1, 0.2], [1.7, 1.1, 0.6])
"""The second ellipsoid: rotation vector [rad] and position [length]."""


LAW = (
    "the raw law is so.PaperLaw(gain=100, solve='plain'), Newton's the same by Euler at 1000, the "
    "safeguarded one so.PredictorCorrector(), on untiled ellipsoids at rest; random starts"
)
"""What the statements say they were measured with."""


def place_of(direction: Array) -> PlaceLike:
    """The place of a unit vector's image in a full ellipsoid's atlas, in its most central chart."""
    k = int(np.abs(direction).argmax())
    # charts come in the order +z, -z, +x, -x, +y, -y
    chart = 2 * ((k + 1) % 3) + int(direction[k] < 0.0)
    surface = ellipsoids()[0].face_parts[0].charts[chart]
    y = np.linalg.solve(np.diag([1.0, 0.7, 0.5]) @ np.eye(3), surface.linear).T @ direction
    return ("face", 0), (y[0] / y[2], y[1] / y[2], chart)


def directions() -> tuple[Array, Array, Array]:
    """Longitudes and latitudes [degrees] of the map's starts, and their directions (n, 3)."""
    longitude = -180.0 + (np.arange(COLUMNS) + 0.5) * 360.0 / COLUMNS
    latitude = -90.0 + (np.arange(ROWS) + 0.5) * 180.0 / ROWS
    a, b = np.radians(np.meshgrid(longitude, latitude))
    around = np.stack([np.cos(b) * np.cos(a), np.cos(b) * np.sin(a), np.sin(b)], axis=-1)
    return longitude, latitude, around.reshape(-1, 3)


@cache
def beside_a_point(law: str) -> Basin:
    """Starts all over the ellipsoid, against a point."""
    followed, steps = LAWS[law]
    tracker = so.Tracker(ellipsoids()[0], so.shapes.point(), dt=STEP, law=followed)
    starts = [(place_of(x), (("vertex", 0), ())) for x in directions()[2]]
    return basin(tracker, Pose.identity(), Pose(np.eye(3), POINT_AT), starts, steps)


@cache
def of_two(law: str) -> Basin:
    """Random starts on two ellipsoids, uniform on the unit spheres they are images of."""
    followed, steps = LAWS[law]
    tracker = so.Tracker(*ellipsoids(), dt=STEP, law=followed)
    random = np.random.default_rng(8).normal(size=(PAIRS, 2, 3))
    random /= np.linalg.norm(random, axis=2, keepdims=True)
    starts = [(place_of(x), place_of(y)) for x, y in random]
    turn, shift = POSE_B
    return basin(tracker, Pose.identity(), Pose.exp(turn, shift), starts, steps)


def weighted(found: np.ndarray) -> float:
    """Share of the map's starts, weighted by their cells' areas on the unit sphere."""
    weight = np.repeat(np.cos(np.radians(directions()[1])), COLUMNS)
    return float((weight * found).sum() / weight.sum())


def joined(found: np.ndarray) -> NDArray[np.int64]:
    """Number the connected parts of a basin on the map from 1, shape (ROWS, COLUMNS); 0 is outside.

    Cells are connected by their sides, across the seam of the longitudes, and all at a pole.
    """
    cells = found.reshape(ROWS, COLUMNS)
    # an additional row at each pole and a column on the right connect what meets there
    around = np.pad(np.hstack([cells, cells[:, :1]]), ((1, 1), (0, 0)))
    around[0], around[-1] = cells[0].any(), cells[-1].any()
    names, _ = label(around)
    names, same = names[1:-1], {}
    for left, right in zip(names[:, 0].tolist(), names[:, -1].tolist(), strict=True):
        if left and right:
            same[max(left, right)] = min(left, right)
    flat = [same.get(name, name) for name in names[:, :-1].ravel().tolist()]
    return np.array(flat).reshape(ROWS, COLUMNS)


def parts(found: np.ndarray) -> list[int]:
    """Cells of each connected part of a basin on the map, the largest first."""
    names = joined(found)
    return sorted(Counter(names[names > 0].tolist()).values(), reverse=True)


def stray(found: np.ndarray) -> list[int]:
    """Starts of a basin on the map that do not join its largest part, by their number."""
    names = joined(found).ravel()
    ((largest, _),) = Counter(names[names > 0].tolist()).most_common(1)
    return np.flatnonzero((names > 0) & (names != largest)).tolist()


@cache
def strays_in_small_steps() -> int:
    """How many of the raw law's stray starts find the minimum at `GENTLER` times the gain."""
    _, steps = LAWS["raw law"]
    law = so.PaperLaw(gain=GAIN / GENTLER, solve="plain")
    tracker = so.Tracker(ellipsoids()[0], so.shapes.point(), dt=STEP, law=law)
    around = directions()[2][stray(beside_a_point("raw law").found)]
    starts = [(place_of(x), (("vertex", 0), ())) for x in around]
    poses = Pose.identity(), Pose(np.eye(3), POINT_AT)
    return int(basin(tracker, *poses, starts, GENTLER * steps).found.sum())


def attraction() -> Artwork:
    """Basins of the three laws."""
    return Artwork(
        caption=(
            "Above: the ellipsoid's surface by longitude and latitude of the start, with a point "
            f"beside it; what becomes of {ROWS * COLUMNS} starts under the raw law "
            f"w = −M⁻¹(KΨ + b) (Heun, K = {GAIN:g} 1/s, {LAWS['raw law'][1]} steps of 1 ms) and "
            "under Newton's method (Euler, K h = 1). The star is the nearest point. Single cells "
            "that find it from outside the island, on both maps, are beside a singular M, from "
            "where one long step happens to lead back. The law's "
            "direction depends on the parameters, so the charts' borders (dotted) show. Below: "
            f"shares of starts that end at the true minimum, by area of the unit sphere, and of "
            f"{PAIRS} random starts on two ellipsoids."
        ),
        text=(
            "Two maps in which an island around the star finds the minimum, other patches settle "
            "on the far side or nowhere; and bars: the raw law finds it in about a quarter of the "
            "starts beside a point and far fewer of two ellipsoids, the safeguarded law in all."
        ),
        draw=_draw,
        tables=_tables(),
        statements=measured_by(LAW, _statements()),
    )


def _statements() -> tuple[Statement, ...]:
    def share(law: str) -> str:
        return f"{weighted(beside_a_point(law).found):.1%}, {of_two(law).fraction:.1%}"

    all_found = of_two("safeguarded").found.all() and beside_a_point("safeguarded").found.all()
    sizes, own = (parts(beside_a_point(law).found) for law in ("Newton", "raw law"))
    lone = stray(beside_a_point("raw law").found)
    return (
        own_statement(
            "Convergence",
            f"raw law: {share('raw law')} of the starts (body and point, two bodies)",
            "The paper claims that a start anywhere converges on two convex bodies composed of "
            "tiled convex surface patches; these ellipsoids have no tiles. M⁻¹ also leads to the "
            "farthest points and to saddles: M must be definite",
        ),
        own_statement("Convergence", f"Newton, K h = 1: {share('Newton')} of the starts"),
        Statement(
            "Section I",
            "the basin of Newton's method is not connected",
            f"on the map of body and point it falls into {len(sizes)} separate parts of "
            f"{', '.join(map(str, sizes))} starts",
            len(sizes) > 1,
            f"the raw law's own map, at K h = {GAIN * STEP:g}, has {len(lone)} stray cells too",
            by="PaperLaw(integrator='euler', gain=1000, solve='plain'): Newton's method; "
            f"{ROWS * COLUMNS} starts on an ellipsoid beside a point",
        ),
        own_statement(
            "Section I",
            f"the raw law's basin on that map has parts of {', '.join(map(str, own))} starts; at "
            f"K h = {GAIN * STEP / GENTLER:g} {strays_in_small_steps()} of the {len(lone)} stray "
            "starts find the minimum",
            "Such a start is near a singular M, and its first step is long enough to land in the "
            "basin, as many of Newton's steps are.",
        ),
        Statement(
            "Convergence",
            "-",
            f"with the safeguards: {share('safeguarded')} of the starts",
            bool(all_found),
            "descent directions, line search, restart on the far side",
        ),
    )


def _tables() -> dict[str, dict[str, Array | list[str]]]:
    longitude, latitude, _ = directions()
    a, b = np.meshgrid(longitude, latitude)
    table: dict[str, Array | list[str]] = {
        "start_longitude_deg": a.ravel(),
        "start_latitude_deg": b.ravel(),
    }
    for law in LAWS:
        name = law.replace(" ", "_")
        table[f"{name}_found"] = beside_a_point(law).found.astype(float)
        table[f"{name}_end_distance"] = beside_a_point(law).distance
    return {
        "map": table,
        "shares": {
            "law": list(LAWS),
            "point_found": np.array([weighted(beside_a_point(law).found) for law in LAWS]),
            "point_elsewhere": np.array([weighted(beside_a_point(law).elsewhere) for law in LAWS]),
            "ellipsoids_found": np.array([of_two(law).fraction for law in LAWS]),
            "ellipsoids_elsewhere": np.array([of_two(law).elsewhere.mean() for law in LAWS]),
        },
    }


FATES = ("finds the minimum", "settles elsewhere", "settles nowhere")
SHADES = (style.BLUE, style.ORANGE, "#F2F2F2")
HATCHES = ("", "////", "..")


def _draw() -> Figure:
    figure = style.new_figure(style.WIDTH, 10.0)
    first, second, bars = figure.subplots(3, 1, height_ratios=(1.0, 1.0, 0.52))
    for axes, law in ((first, "raw law"), (second, "Newton")):
        _draw_map(axes, law)
    first.set_title("raw law", loc="left")
    second.set_title("Newton, K h = 1", loc="left")
    keys = [
        key_fill(fate, shade, hatch=hatch, edgecolor=style.BLACK, linewidth=0.5)
        for fate, shade, hatch in zip(FATES, SHADES, HATCHES, strict=True)
    ]
    figure.legend(handles=keys, loc="outside upper center", ncols=3)
    _draw_bars(bars)
    return figure


def _draw_map(axes: Axes, law: str) -> None:
    longitude, latitude, _ = directions()
    made = beside_a_point(law)
    fate = np.where(made.found, 0, np.where(made.elsewhere, 1, 2)).reshape(ROWS, COLUMNS)
    # each cell four times, so that the hatches end where the cells do
    edges = [np.linspace(-half, half, n + 1) for half, n in ((180.0, COLUMNS), (90.0, ROWS))]
    axes.pcolormesh(*edges, fate, cmap=ListedColormap(SHADES), vmin=-0.5, vmax=2.5, rasterized=True)
    for k in (1, 2):
        axes.contourf(
            longitude,
            latitude,
            (fate == k).astype(float),
            levels=[0.5, 1.5],
            colors="none",
            hatches=[HATCHES[k]],
        )
    _draw_borders(axes)
    best = so.distance(
        ellipsoids()[0], so.shapes.point(), Pose.identity(), Pose(np.eye(3), POINT_AT)
    )
    x, y, z = best.point_a / np.array([1.0, 0.7, 0.5])
    axes.plot(
        np.degrees(np.arctan2(y, x)),
        np.degrees(np.arcsin(z)),
        "*",
        color="white",
        markeredgecolor=style.BLACK,
        markersize=14,
    )
    axes.set(xlabel="longitude [°]", ylabel="latitude [°]", aspect="equal")
    axes.set_xticks(range(-180, 181, 60))
    axes.set_yticks(range(-90, 91, 45))
    axes.grid(visible=False)


def _draw_borders(axes: Axes) -> None:
    """Where the most central chart changes: two of |x|, |y|, |z| are equal and greatest."""
    a, b = np.meshgrid(np.linspace(-180.0, 180.0, 721), np.linspace(-90.0, 90.0, 361))
    x, y = (
        np.cos(np.radians(b)) * np.cos(np.radians(a)),
        np.cos(np.radians(b)) * np.sin(np.radians(a)),
    )
    size = np.abs(np.stack([x, y, np.sin(np.radians(b))]))
    for k in range(3):
        ahead = size[k] - np.delete(size, k, axis=0).max(axis=0)
        axes.contour(a, b, ahead, levels=[0.0], colors=style.BLACK, linewidths=0.7, linestyles=":")


def _draw_bars(axes: Axes) -> None:
    for k, (name, of) in enumerate(
        (
            ("ellipsoid and point", lambda law: weighted(beside_a_point(law).found)),
            ("two ellipsoids", lambda law: of_two(law).fraction),
        )
    ):
        shares = [100.0 * of(law) for law in LAWS]
        rows = np.arange(len(LAWS)) + 0.2 - 0.4 * (1 - k)
        bars = axes.barh(
            rows,
            shares,
            0.38,
            color=(style.BLUE, style.SKY)[k],
            hatch=("", "\\\\\\\\")[k],
            edgecolor=style.BLACK,
            linewidth=0.6,
            label=name,
        )
        axes.bar_label(bars, fmt="%.0f %%", padding=3)
    axes.set_yticks(range(len(LAWS)), list(LAWS))
    axes.invert_yaxis()
    axes.set(xlabel="starts that find the minimum [%]", xlim=(0.0, 112.0))
    axes.grid(axis="y", visible=False)
    axes.set_axisbelow(True)
    axes.legend(loc="upper right")
