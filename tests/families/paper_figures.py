"""Figures that no paper has: what the making, the report and the command line are tested with."""

from __future__ import annotations

import os
from functools import partial

import numpy as np
from matplotlib.figure import Figure

from standoff_studies.paper import style
from standoff_studies.paper.figure import Animation, Artwork, Entry, Statement

entry = partial(Entry, module="families.paper_figures")

GOOD = entry("7", "A line & a <dot>", "Simulation A", function="good")
MOVING = entry("12", "A dot that moves", "Simulation C", function="moving")
FAILING = entry("13", "A figure that fails", "Simulation C", function="failing")
LAST = entry("14", "After the failing one", "Simulation C", function="good")
DYING = entry("gains", "A figure whose process dies", "Gains", function="dying")
WRONG = entry("verdict", "No figure at all", "Verdict", function="wrong")

ALL = (GOOD, MOVING, FAILING, LAST, DYING, WRONG)

STATEMENTS = (
    Statement("Fig. 7", "10 steps at K = 1000", "10 steps", np.True_),  # as comparisons give it
    Statement("Fig. 7", "75 steps at K = 100", "70 steps", False, "Another start <b>"),
    Statement("Section II", "it is fast", "it is", None),
    Statement("-", "-", "1.5 s", True),
)


def draw() -> Figure:
    figure = style.new_figure(3.0, 2.0)
    figure.add_subplot().plot([0.0, 1.0], [1.0, 0.0], color=style.BLUE)
    return figure


def good() -> Artwork:
    return Artwork(
        "A line, x [length] & more.",
        'It "falls" <steadily>.',
        draw,
        {"steps": {"time_s": np.arange(3.0), "mode": ["a", "b", "b"], "steps": np.arange(3)}},
        STATEMENTS,
    )


def moving() -> Artwork:
    def frame(figure: Figure, k: int) -> None:
        axes = figure.add_subplot()
        axes.plot([k], [k], "o", color=style.RED)
        axes.set(xlim=(-1, 4), ylim=(-1, 4))
        axes.set_axis_off()  # no background, that would cover a frame that was left

    animation = Animation(4, frame, 0.1, (2.0, 2.0), "A dot goes up.")
    return Artwork("A dot.", "A dot at rest.", draw, animation=animation)


def failing() -> Artwork:
    raise ZeroDivisionError("no\nreason")


def dying() -> Artwork:
    os._exit(9)


def wrong() -> str:
    return "no artwork"
