"""Fig. 6: snapshots of the witness lines, from a wrong start and along the path."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from standoff.tracking import distance
from standoff.typing import Array
from standoff_studies.paper import style
from standoff_studies.paper.drawing_3d import PALE, View, patch_points
from standoff_studies.paper.figure import Animation, Artwork, Statement, measured_by
from standoff_studies.paper.law_words import law_words
from standoff_studies.paper.pair_simulation import REST
from standoff_studies.paper.simulation_a.gains import TURN
from standoff_studies.paper.simulation_a.run import Run, run
from standoff_studies.paper.simulation_a.setting import FACE, PATH, STEP, point, vault
from standoff_studies.paper.simulation_a.statements import TOLD

GAIN = 100.0
"""K of the snapshots [1/s]: slow enough to see the witness point on its way."""

FIRST = (0, 5, 10, 16, 75)
"""Steps of the snapshots after the wrong start."""

EACH = 300
"""Steps from snapshot to snapshot along the path."""

ANIMATED = (*range(0, 76, 3), *range(100, TURN, 90))
"""Steps between the animation's frames: few at first, then more."""

LEAST_MISS = 0.1
"""A start is far off if its line is longer than the distance by at least this fraction."""

KEPT = 1e-6
"""A line that is longer than the distance by less [length] counts as the shortest one: with K = 100
1/s a thousandth of the first errors is left at step 75, and the length's error is its square."""

AZIMUTH, ELEVATION = 68.0, 30.0
"""Where the viewer stands [degrees]."""

ACROSS, UP = (-1.35, 1.35), (-1.15, 1.6)
"""The area shown [length in the picture]: the patch, and the point at all times."""

TRIAD = (0.8, 1.0)
"""Where the world's axes are drawn [length in the picture]."""

IN_FRONT = 100.0
"""Rank of the witness lines: the first ones go through the body, but are visible throughout."""

DASHES = (0.07, 0.05)
"""Dashes and gaps of the point's path [length]."""

BEYOND = 0.16
"""From a line's foot to its number [length], along the extended line."""

GRID = 32
"""Pieces along each side of the drawn patch."""


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
        statements=measured_by(law_words(made.recording, told=TOLD), _statements(made)),
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
    columns = {"time_s": made.recording.time, "u": made.q[:, 0], "v": made.q[:, 1]}
    for name, points in (("witness", made.witness), ("point", made.target)):
        columns |= {f"{name}_{axis}_length": points[:, k] for k, axis in enumerate("xyz")}
    columns |= {"psi_u_length2": made.psi[:, 0], "psi_v_length2": made.psi[:, 1]}
    return columns


def lengths(made: Run) -> Array:
    """Lengths of the witness lines [length], shape (n,)."""
    return np.asarray(np.linalg.norm(made.target - made.witness, axis=1))


def exact(made: Run, frames: Sequence[int]) -> Array:
    """Certified distances at some frames [length], by a search without a start."""
    poses = (PATH.pose(frame * STEP) for frame in frames)
    found = [distance(vault(), point(), REST.pose(0.0), pose).distance for pose in poses]
    return np.array(found)


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
    return float(np.linalg.norm(PATH.twist(0.0).v) * frame * STEP)


def _draw() -> Figure:
    made = snapshot_run()
    figure = style.new_figure(style.WIDTH, 4.0)
    left, right = figure.subplots(1, 2)
    view = _view()
    for n, frame in enumerate(FIRST):
        _add_line(view, made, frame, style.COLOURS[n], 1.6)
    _paint(left, view)
    for frame in FIRST:
        foot, top = made.witness[frame], made.target[frame]
        place = foot + BEYOND * (foot - top) / np.linalg.norm(foot - top)
        view.text(left, place, str(frame), fontweight="bold")
    view.triad(left, TRIAD, 0.4, "length")
    left.set_title(f"the first {FIRST[-1]} steps: numbers are steps")
    view = _view()
    view.line(made.witness[FIRST[-1] :], style.GREEN, 2.6, rank=1.5)
    view.line(made.target, style.RED, 1.6, dashes=DASHES)
    for frame in range(FIRST[-1], len(made.q), EACH):
        _add_line(view, made, frame, style.BLACK, 1.2)
    _paint(right, view)
    right.set_title("one turn")
    return figure


def _draw_frame(figure: Figure, k: int) -> None:
    made, frame = snapshot_run(), ANIMATED[k]
    axes, view = figure.add_subplot(), _view()
    view.line(made.witness[: frame + 1], style.GREEN, 2.6, rank=1.5)
    view.line(made.target[: frame + 1], style.RED, 1.6, dashes=DASHES)
    _add_line(view, made, frame, style.BLACK, 2.0)
    _paint(axes, view)
    errors = made.normalised[frame].max()
    axes.set_title(f"step {frame}: greatest normalised error {errors:.0e}")


def _view() -> View:
    """A view of the patch alone."""
    view = View(AZIMUTH, ELEVATION)
    view.patch(patch_points(vault(), FACE.index, GRID), PALE[0], lines=7)
    return view


def _add_line(view: View, made: Run, frame: int, colour: str, width: float) -> None:
    ends = np.array([made.witness[frame], made.target[frame]])
    view.line(ends, colour, width, rank=IN_FRONT)
    for end in ends:
        view.mark(end, colour)


def _paint(axes: Axes, view: View) -> None:
    """The whole patch and the point's path, in the same place in every frame."""
    view.paint(axes)
    axes.set(xlim=ACROSS, ylim=UP)
