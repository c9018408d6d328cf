"""Pieces of line in viser's scene, whose number may change from picture to picture."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Segments:
    """Groups of pieces of line, each a node of viser's scene while it has any.

    Parameters
    ----------
    scene : viser.SceneApi
    name : str
        Of the node that all of them hang from.
    """

    def __init__(self, scene: Any, name: str) -> None:
        self._scene, self._name = scene, name
        self._nodes: dict[str, Any] = {}

    def draw(self, name: str, ends: Array, colours: Any, width: float) -> None:
        """Draw a group in place of the one of that name.

        Parameters
        ----------
        name : str
        ends : (n, 2, 3) array
            World axes.
        colours : (n, 2, 3) array of uint8
            At both ends.
        width : float
            Thickness [pixels].
        """
        node = self._nodes.get(name)
        if node is not None and len(node.points) != len(ends):
            self._nodes.pop(name).remove()
            node = None
        if not len(ends):
            return
        points = ends.astype(np.float32)
        if node is None:
            self._nodes[name] = self._scene.add_line_segments(
                f"{self._name}/{name}", points, colours, thickness=width, thickness_units="screen"
            )
            return
        node.points, node.colors = points, colours
