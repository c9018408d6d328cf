"""The block diagram of Fig. 5: hand, device, coupler, dynamics, tracker and contact."""

from __future__ import annotations

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from standoff_studies.paper import style
from standoff_studies.paper.realisations.diagrams import STATE, arrow, box

TOP, MIDDLE, LOW = 4.55, 2.6, 0.75
"""Heights of the three rows, in the diagram's own unit."""

TALL = 0.48
"""Half the height of a box of two lines."""


SMALL = 8.0
"""Points of the text: a wide diagram on a page's width."""


def draw_loop(axes: Axes) -> None:
    """Draw Fig. 5: the dashed frame contains what the paper integrates together."""
    axes.set(xlim=(-0.1, 15.3), ylim=(0.1, 5.4))
    axes.set_aspect("equal")
    axes.axis("off")
    with rc_context({"font.size": SMALL}):
        _frame(axes)
        _hand_and_device(axes)
        _dynamics(axes)
        _tracker(axes)
        _contact(axes)


def _frame(axes: Axes) -> None:
    axes.add_patch(
        Rectangle(
            (5.75, 0.12),
            9.5,
            5.0,
            facecolor="#F4F8FB",
            edgecolor=style.QUIET,
            linestyle="--",
            linewidth=1.0,
            zorder=0,
        )
    )
    axes.text(15.2, 5.17, "one operator", ha="right", va="bottom", color="#606060")


def _hand_and_device(axes: Axes) -> None:
    """On the left: what the hand does, and what it feels."""
    box(axes, (1.25, TOP), "human", 0.85, height=TALL)
    box(axes, (1.25, MIDDLE), "haptic device\n(impedance)", 1.25, height=TALL)
    box(axes, (4.35, MIDDLE), "virtual\ncoupler", 0.8, height=TALL)
    arrow(axes, [(0.9, TOP - TALL), (0.9, MIDDLE + TALL)], "pushes", (-0.62, 0.05))
    arrow(axes, [(1.6, MIDDLE + TALL), (1.6, TOP - TALL)], "feels", (0.52, 0.05))
    arrow(axes, [(2.5, MIDDLE + 0.25), (3.55, MIDDLE + 0.25)], "pose", (0.0, 0.2))
    arrow(axes, [(3.55, MIDDLE - 0.25), (2.5, MIDDLE - 0.25)], "−F", (0.0, -0.25))
    arrow(axes, [(4.35, MIDDLE + TALL), (4.35, TOP + 0.15), (6.35, TOP + 0.15)])
    axes.text(5.0, TOP + 0.37, "wrench F", ha="center", va="center")


def _dynamics(axes: Axes) -> None:
    """The tool's forward dynamics, integrated twice."""
    box(axes, (8.3, TOP), "forward dynamics\nθ'' = M⁻¹(F − C − N)", 1.95, height=TALL)
    box(axes, (11.4, TOP), "∫ dt", 0.5, STATE)
    box(axes, (13.3, TOP), "∫ dt", 0.5, STATE)
    arrow(axes, [(10.25, TOP), (10.9, TOP)], "θ''", (0.0, 0.22))
    arrow(axes, [(11.9, TOP), (12.8, TOP)], "θ'", (0.0, 0.22))
    # poses and twists: to the coupler, and down to tracker and contact
    arrow(axes, [(13.8, TOP), (14.6, TOP), (14.6, LOW), (14.1, LOW)], motion=True)
    arrow(axes, [(14.6, 3.55), (5.4, 3.55), (5.4, MIDDLE), (5.15, MIDDLE)], motion=True)
    axes.text(14.2, TOP + 0.22, "θ", ha="center", va="center", color=style.RED)
    axes.text(10.4, 3.62, "poses and twists of the bodies", ha="center", color=style.RED)


def _tracker(axes: Axes) -> None:
    """The paper's law, at poses that are not known in advance."""
    law = "tracker\nw = M⁻¹(u − b),  u = −KΨ"
    box(axes, (8.9, MIDDLE), law, 2.3, height=TALL)
    box(axes, (12.6, MIDDLE), "∫ dt", 0.5, STATE)
    arrow(axes, [(11.2, MIDDLE), (12.1, MIDDLE)], "w", (0.0, 0.22))
    arrow(axes, [(8.9, 3.55), (8.9, MIDDLE + TALL)], motion=True)
    arrow(axes, [(13.1, MIDDLE), (13.5, MIDDLE), (13.5, LOW + TALL)], "q", (0.2, 0.35))
    arrow(axes, [(13.5, 1.62), (8.9, 1.62), (8.9, MIDDLE - TALL)])
    axes.text(11.2, 1.83, "witness points’ parameters", ha="center", va="center")


def _contact(axes: Axes) -> None:
    """Distance and force, which enter the dynamics."""
    box(axes, (12.0, LOW), "collision detector\ndistance, normal, points", 2.1, height=TALL)
    box(axes, (7.9, LOW), "contact force\nby depth and its rate", 1.6, height=TALL)
    arrow(axes, [(9.9, LOW), (9.5, LOW)])
    arrow(axes, [(6.3, LOW), (6.05, LOW), (6.05, TOP - 0.2), (6.35, TOP - 0.2)])
