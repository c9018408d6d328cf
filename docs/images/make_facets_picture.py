"""Draw docs/images/facets.png for the README: a tool slides over a lens, exact and tessellated.

Run: python -m docs.images.make_facets_picture [FILE]. Needs matplotlib and coal. What is drawn is
measured by benchmarks/facets.py, which prints the numbers.
"""

import os
import sys
import tempfile
from itertools import pairwise
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from benchmarks import facets
from matplotlib.collections import PolyCollection
from scipy.spatial import ConvexHull

COLOURS = {1e-2: "#b9770e", 1e-3: "#2e86c1", 1e-4: "#7d9c3a"}
NAMES = {1e-2: "hulls, 1e-2", 1e-3: "hulls, 1e-3", 1e-4: "hulls, 1e-4"}
INK = "#222222"
FEATURE_COLOURS = {"face": "#dcebf7", "edge": "#f6dfc6", "vertex": "#d9ead3"}
WINDOW = 0.84, 0.98
"""s, what the panel of changes shows: onto the vertex, over it, and onto the edge."""
SHOWN = 0.30
"""s, where the tool stands in the scene: on the face."""

EYE = np.array([0.72, -0.55, 0.42])
EYE = EYE / np.linalg.norm(EYE)
RIGHT = np.cross([0.0, 0.0, 1.0], EYE)
RIGHT = RIGHT / np.linalg.norm(RIGHT)
UP = np.cross(EYE, RIGHT)
LIGHT = 0.55 * EYE - 0.35 * RIGHT + 0.75 * UP
LIGHT = LIGHT / np.linalg.norm(LIGHT)


def flat(points):
    """Picture coordinates of world points, (..., 3) -> (..., 2)."""
    return np.stack([points @ RIGHT, points @ UP], axis=-1)


def draw_hull(axes, vertices, colour, zorder):
    """A hull's facets that face the eye, each in one shade."""
    hull = ConvexHull(vertices)
    normals = hull.equations[:, :3]
    seen = normals @ EYE > 0.0
    shade = 0.42 + 0.58 * np.maximum(normals[seen] @ LIGHT, 0.0)
    base = np.array(matplotlib.colors.to_rgb(colour))
    colours = np.clip(base * shade[:, None] + 0.08, 0.0, 1.0)
    corners = flat(vertices[hull.simplices[seen]])
    axes.add_collection(
        PolyCollection(corners, facecolors=colours, edgecolors=colours, lw=0.4, zorder=zorder)
    )


def draw_scene(axes, led, vertices, title):
    k = int(np.searchsorted(led.times, SHOWN))
    draw_hull(axes, vertices[0], "#5b8db8", 2)
    draw_hull(axes, vertices[1] + led.positions[k], "#d98e4a", 4)
    axes.plot(*flat(led.positions).T, color=INK, lw=0.9, ls=(0, (4, 3)), zorder=3)
    axes.set_title(title, fontsize=8.5, loc="left", pad=1)
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.axis("off")


def shade(axes, led, features, names=False):
    """Bands of the lens's active features."""
    cuts = [0, *(k for k in range(1, len(features)) if features[k] != features[k - 1])]
    for first, last in pairwise([*cuts, len(features) - 1]):
        span = led.times[first], led.times[last]
        kind = features[first].split()[0]
        axes.axvspan(*span, color=FEATURE_COLOURS[kind], lw=0)
        if names:
            axes.text(
                sum(span) / 2, 0.03, features[first], ha="center", va="bottom", fontsize=7.5,
                transform=axes.get_xaxis_transform(), color="0.35", rotation=90,
            )  # fmt: skip


def draw_force(axes, led, rides, features):
    shade(axes, led, features, names=True)
    for name, ride, look in rides:
        axes.plot(led.times, np.linalg.norm(ride.forces, axis=1), label=name, **look)
    axes.set_ylim(0.0, 2.3)
    axes.set_xlim(led.times[0], led.times[-1])
    axes.set_ylabel("force, N")
    axes.set_title("force on the tool", fontsize=9, loc="left")
    axes.set_xlabel("time, s", labelpad=1)


def draw_changes(axes, led, rides, features):
    shade(axes, led, features)
    for name, ride, look in rides:
        if name != NAMES[1e-2]:
            axes.plot(led.times[1:], facets.steps(ride), **look)
    axes.axhline(facets.explained(), color="#a03030", lw=0.9, ls="--")
    axes.text(
        WINDOW[1], 0.98, "dashed: most that stiffness and motion explain", ha="right", va="top",
        fontsize=7.5, color="#a03030", transform=axes.get_xaxis_transform(),
    )  # fmt: skip
    axes.set_xlim(*WINDOW)
    axes.set_ylim(0.0, None)
    axes.set_ylabel("N a frame")
    axes.set_title("change of the force in a frame of 1 ms", fontsize=9, loc="left")
    axes.set_xlabel("time, s", labelpad=1)


def draw_spectrum(axes, rides):
    for name, ride, look in rides:
        f, amplitude = facets.spectrum(ride)
        # means over a twelfth of an octave, so that lines do not cover each other
        edges = np.geomspace(2.0, 500.0, 97)
        number = np.digitize(f, edges)
        bins = [number == k for k in range(1, len(edges)) if np.any(number == k)]
        mean = [np.sqrt(np.mean(amplitude[b] ** 2)) for b in bins]
        axes.loglog([np.mean(f[b]) for b in bins], mean, label=name, **look)
    axes.set_xlabel("frequency, Hz", labelpad=1)
    axes.set_ylabel("amplitude, N")
    axes.set_title("spectrum of the force", fontsize=9, loc="left")
    axes.legend(fontsize=7.5, frameon=False, loc="lower left")


def main():
    default = Path(__file__).parent / "facets.png"
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else default
    led = facets.way()
    exact, features = facets.exact_ride(led)
    vertices = {fineness: facets.meshes(fineness) for fineness in facets.FINENESS}
    rides = [
        (NAMES[k], facets.coal_ride(led, v), {"color": COLOURS[k], "lw": 1.0})
        for k, v in vertices.items()
    ]
    rides.append(("exact", exact, {"color": INK, "lw": 1.6}))
    plt.rcParams["font.size"] = 9
    figure = plt.figure(figsize=(9.6, 4.4), dpi=110)
    grid = figure.add_gridspec(2, 3, width_ratios=(0.62, 1.15, 1.0))
    fine = facets.meshes(2e-5)
    draw_scene(figure.add_subplot(grid[0, 0]), led, fine, "exact")
    draw_scene(figure.add_subplot(grid[1, 0]), led, vertices[1e-2], "hulls, 1e-2")
    panels = [figure.add_subplot(grid[k, 1]) for k in (0, 1)]
    draw_force(panels[0], led, rides, features)
    draw_changes(panels[1], led, rides, features)
    last = figure.add_subplot(grid[:, 2])
    draw_spectrum(last, rides)
    for axes in (*panels, last):
        axes.spines[["top", "right"]].set_visible(False)
        axes.tick_params(labelsize=8)
    figure.tight_layout(w_pad=1.2)
    handle, name = tempfile.mkstemp(suffix=".png", dir=target.parent)
    os.close(handle)
    figure.savefig(name)
    os.replace(name, target)
    print(f"{target}: {target.stat().st_size} bytes")


if __name__ == "__main__":
    main()
