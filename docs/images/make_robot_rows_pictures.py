"""Draw docs/images/robot-rows-pink.png and robot-rows-mink.png: rows of limits through contact.

Run: python -m docs.images.make_robot_rows_pictures [FOLDER]. Needs matplotlib, Pink and mink. What
is drawn is measured by benchmarks/robot_rows.py, which prints the numbers.
"""

import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from benchmarks import robot_rows
from matplotlib.ticker import FixedLocator

THEIRS, OURS, TRUE = "#c0392b", "#2471a3", "#9a9a9a"
LINEAR = 1e-8
"""m: gaps nearer to zero than this are drawn on a straight scale."""


def gap_axis(axes, ticks=(-1e-1, -1e-3, -1e-5, -1e-7, 0.0, 1e-7, 1e-5, 1e-3, 1e-1)):
    axes.set_xscale("symlog", linthresh=LINEAR, linscale=0.4)
    axes.xaxis.set_major_locator(FixedLocator(ticks))
    axes.xaxis.set_minor_locator(FixedLocator([]))
    axes.axvline(0.0, color="0.8", lw=0.8, zorder=0)
    axes.set_xlabel("signed distance, m: overlap on the left, apart on the right", fontsize=8.5)
    axes.tick_params(labelsize=8)
    axes.grid(axis="y", color="0.93", lw=0.8)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def row_panel(axes, found, column, theirs, title):
    axes.plot(found.gaps, found.true[:, column], color=TRUE, lw=5.0, label="differences")
    axes.plot(found.gaps, found.ours[:, column], color=OURS, lw=1.4, label="Standoff")
    axes.plot(found.gaps, found.theirs[:, column], color=THEIRS, lw=1.4, marker=".", ms=3.5,
              label=theirs)  # fmt: skip
    gap_axis(axes)
    axes.set_ylim(-1.2, 1.2)
    axes.set_title(title, fontsize=9, loc="left")
    axes.set_ylabel("the row's entry along the approach", fontsize=8.5)


def angle_panel(axes, found, theirs):
    least = 1e-12
    for rows, colour, name in ((found.theirs, THEIRS, theirs), (found.ours, OURS, "Standoff")):
        off = np.maximum(robot_rows.angles(rows, found.true), least)
        axes.plot(found.gaps, off, color=colour, lw=1.4, marker=".", ms=3.5, label=name)
    gap_axis(axes)
    axes.set_yscale("log")
    axes.set_ylim(1e-12, 1e3)
    axes.set_yticks([1e-12, 1e-9, 1e-6, 1e-3, 1.0, 90.0])
    axes.set_yticklabels(["1e-12°", "1e-9°", "1e-6°", "0.001°", "1°", "90°"])
    axes.minorticks_off()
    axes.set_title(
        "how far the row's direction is off (a row of zeros: 90°)", fontsize=9, loc="left"
    )


def draw(found, theirs, told, file):
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.2, 3.4), layout="constrained")
    row_panel(left, found, 2, theirs, told)
    left.legend(fontsize=8, frameon=False, loc=(0.62, 0.24))
    angle_panel(right, found, theirs)
    right.legend(fontsize=8, frameon=False, loc=(0.6, 0.27))
    figure.savefig(file, dpi=150)
    plt.close(figure)


def main() -> None:
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "docs/images")
    fine = np.geomspace(1e-1, 1e-9, 97)
    gaps = robot_rows.around_zero(fine)
    draw(
        robot_rows.of_pink(gaps),
        "Pink 4.4",
        "Pink: a row of zeros near contact, the wrong sign in overlap",
        folder / "robot-rows-pink.png",
    )
    draw(
        robot_rows.of_mink(gaps),
        "mink 1.3, MuJoCo 4.0",
        "mink: the row turns round at contact",
        folder / "robot-rows-mink.png",
    )


if __name__ == "__main__":
    main()
