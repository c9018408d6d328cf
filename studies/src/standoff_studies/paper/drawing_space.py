"""Drawing in space that several figures share: axes of one scale, with units."""

from __future__ import annotations

from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d import Axes3D

PANES = "#F7F7F7"


def space_axes(
    figure: Figure, elevation: float, azimuth: float, place: tuple[int, int, int] = (1, 1, 1)
) -> Axes3D:
    """Return axes in space, with names and units.

    A length is the same along x, y and z once the limits and the box's sides agree: set both
    after drawing (``set_box_aspect``). What is drawn later lies over what was drawn before,
    whatever its depth: draw from the back.

    Parameters
    ----------
    figure : Figure
    elevation, azimuth : float
        Where it is seen from [degrees].
    place : (int, int, int)
        Rows, columns and number of the panel.
    """
    axes = figure.add_subplot(*place, projection="3d", computed_zorder=False)
    assert isinstance(axes, Axes3D)
    axes.view_init(elev=elevation, azim=azimuth)
    for axis, name in ((axes.xaxis, "x"), (axes.yaxis, "y"), (axes.zaxis, "z")):
        axis.set_pane_color(PANES)
        axis.set_label_text(f"{name} [length]")
        axis.set_major_locator(MaxNLocator(4))
    return axes
