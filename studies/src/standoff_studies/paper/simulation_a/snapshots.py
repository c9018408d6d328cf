"""Fig. 6: snapshots of the witness lines, from a wrong start and along the path."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D

from standoff.geometry.validation import Array
from standoff.tracking import distance
from standoff_studies.paper import style
from standoff_studies.paper.drawing_space import space_axes
from standoff_studies.paper.figure import Animation, Artwork, Statement, measured_by
from standoff_studies.paper.law_words import law_words
from standoff_studies.paper.simulation_a.gains import TURN
from standoff_studies.paper.simulation_a.run import HOME, Run, run
from standoff_studies.paper.simulation_a.setting import FACE, PATH, STEP, point, vault
from standoff_studies.paper.simulation_a.statements import TOLD

GAIN = 100.0
"""K of the snapshots [1/s]: slow enough to see the witness point on its way."""

FIRST = (0, 5, 10, 16, 75)
"""Steps of the snapshots after the wrong start."""

EACH = 300
"""Steps from snapshot to snapshot along the path."""

ANIMATED = (*range(0, 76, 3), *range(100, TURN, 90))
"""Steps of the animation's frames: slow at first, then faster."""

LEAST_MISS = 0.1
"""A start is far off where its line is longer than the distance by this part at least."""

KEPT = 1e-6
"""A line that is longer than the distance by less [length] counts as the shortest one: with K = 100
1/s a thousandth of the first errors is left at step 75, and the length is off by its square."""

VIEW = (30.0, 68.0)
"""Elevation and azimuth that the patch is seen from [degrees]."""

BEYOND = 0.16
"""From a line's foot to its number [length], on along the line."""

ZOOM = 0.88
"""Of the axes in their panel, so that their labels are within."""

CURVES = np.linspace(0.0, 1.0, 9)
SAMPLES = np.linspace(0.0, 1.0, 33)


@cache
def snapshot_run() -> Run:
    """The run of Fig. 6: one turn of the point, at K = `GAIN`, from the wrong start."""
    return run(GAIN, TURN)


def figure_6() -> Artwork:
    """Fig. 6."""
    made = snapshot_run()
    return Artwork(
        caption=(
            "A point on a helix above a convex bicubic patch, the roof of a convex body; the "
            f"paper's law by Heun's method at 1 kHz, K = {GAIN:g} 1/s. Left: the witness line "
            f"after {', '.join(map(str, FIRST))} steps; it starts at the wrong end of the patch "
            f"and ends square on it, while the point goes {_way(FIRST[-1]):.2f} [length]. Right: "
            f"the line every {EACH * STEP:g} s for one turn, with the paths of the point (dashed) "
            "and of the witness point (thick). Lengths are in the scene's unit."
        ),
        text=(
            "Two views of a vaulted four-sided patch under a net of curves with a point above it. "
            "In the first five lines fan out from the point over the patch, numbered by steps, "
            "closing in on the shortest. In the second lines stand square on the patch all around "
            "the circle that the point goes."
        ),
        draw=_draw,
        tables={"run": run_table(made)},
        statements=measured_by(law_words(made.tracker, told=TOLD), _statements(made)),
        animation=Animation(
            frames=len(ANIMATED),
            draw=_draw_frame,
            seconds=0.08,
            size=(5.6, 5.0),
            text="The witness line swings across the patch to the closest point and follows it.",
        ),
    )


def run_table(made: Run) -> dict[str, Array]:
    """Columns of a run: time, parameters, witness point, point, errors."""
    columns = {"time_s": made.time, "u": made.q[:, 0], "v": made.q[:, 1]}
    for name, points in (("witness", made.witness), ("point", made.target)):
        columns |= {f"{name}_{axis}_length": points[:, k] for k, axis in enumerate("xyz")}
    columns |= {"psi_u_length2": made.psi[:, 0], "psi_v_length2": made.psi[:, 1]}
    return columns


def lengths(made: Run) -> Array:
    """Lengths of the witness lines [length], shape (n,)."""
    return np.asarray(np.linalg.norm(made.target - made.witness, axis=1))


def exact(made: Run, frames: Sequence[int]) -> Array:
    """Certified distances at some frames [length], by a search that knows no start."""
    home, other = vault(), point()
    poses = (PATH.pose(frame * STEP) for frame in frames)
    return np.array([distance(home, other, HOME, pose).distance for pose in poses])


def _statements(made: Run) -> tuple[Statement, ...]:
    frames = [0, *range(FIRST[-1], len(made.q), EACH)]
    over = lengths(made)[frames] - exact(made, frames)
    first = over[0] / (lengths(made)[0] - over[0])
    return (
        Statement(
            "Fig. 6",
            "from a large initial error the law finds the closest point and then keeps it",
            f"the line is {first:.0%} longer than the distance at first, and "
            f"{over[1:].max():.0e} [length] at most at {len(frames) - 1} instants from step "
            f"{FIRST[-1]} to the end",
            bool(first > LEAST_MISS and over[1:].max() < KEPT),
        ),
    )


def _way(frame: int) -> float:
    return float(np.linalg.norm(PATH.velocities(0.0)) * frame * STEP)


def _draw() -> Figure:
    made = snapshot_run()
    figure = style.new_figure(style.WIDTH, 4.0)
    above = space_axes(figure, *VIEW, place=(1, 2, 1))
    _draw_patch(above)
    for n, frame in enumerate(FIRST):
        colour = style.COLOURS[n]
        _draw_line(above, made, frame, colour, 1.6)
        foot, top = made.witness[frame], made.target[frame]
        place = foot + BEYOND * (foot - top) / np.linalg.norm(foot - top)
        above.text(*place, str(frame), ha="center", va="center", fontweight="bold", zorder=9)
    below = space_axes(figure, *VIEW, place=(1, 2, 2))
    _draw_patch(below)
    settled = made.witness[FIRST[-1] :]
    below.plot(*settled.T, color=style.GREEN, linewidth=2.6, zorder=6)
    below.plot(*made.target.T, color=style.RED, linestyle="--", zorder=8)
    for frame in range(FIRST[-1], len(made.q), EACH):
        _draw_line(below, made, frame, style.BLACK, 1.2)
    for axes, title in (
        (above, f"the first {FIRST[-1]} steps: numbers are steps"),
        (below, "one turn"),
    ):
        axes.set_title(title)
        _same_limits(axes)
    return figure


def _draw_frame(figure: Figure, k: int) -> None:
    made, frame = snapshot_run(), ANIMATED[k]
    axes = space_axes(figure, *VIEW)
    _draw_patch(axes)
    axes.plot(*made.witness[: frame + 1].T, color=style.GREEN, linewidth=2.6, zorder=6)
    axes.plot(*made.target[: frame + 1].T, color=style.RED, linestyle="--", zorder=8)
    _draw_line(axes, made, frame, style.BLACK, 2.0)
    errors = made.normalised[frame].max()
    axes.set_title(f"step {frame}: greatest normalised error {errors:.0e}")
    _same_limits(axes)


@cache
def patch_points() -> Array:
    """Points of the patch at `SAMPLES` of u and of v [length], shape (n, n, 3)."""
    (patch,) = vault().face_parts[FACE.index].charts
    return np.array([[patch.jet(u, v)[0] for v in SAMPLES.tolist()] for u in SAMPLES.tolist()])


def _draw_patch(axes: Axes3D) -> None:
    grid = patch_points()
    axes.plot_surface(
        *np.moveaxis(grid, -1, 0), color=style.BLUE, alpha=0.13, linewidth=0, rcount=17, ccount=17
    )
    step = (len(SAMPLES) - 1) // (len(CURVES) - 1)
    for net in (grid[::step], grid.swapaxes(0, 1)[::step]):
        for k, line in enumerate(net):
            rim = k in (0, len(net) - 1)
            colour = style.BLUE if rim else style.QUIET
            axes.plot(*line.T, color=colour, linewidth=1.4 if rim else 0.5)


def _draw_line(axes: Axes3D, made: Run, frame: int, colour: str, width: float) -> None:
    ends = np.array([made.witness[frame], made.target[frame]])
    axes.plot(*ends.T, "o-", color=colour, linewidth=width, markersize=4, zorder=7)


def _same_limits(axes: Axes3D) -> None:
    """The whole patch and the point, in the same place in every frame."""
    axes.set(xlim=(-1.1, 1.1), ylim=(-1.2, 1.2), zlim=(-0.7, 1.6))
    axes.set_box_aspect((2.2, 2.4, 2.3), zoom=ZOOM)
