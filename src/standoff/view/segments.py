"""Pieces of line and points in viser's scene, whose number may change from picture to picture."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from standoff.typing import Array


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

    def draw_groups(self, name: str, groups: Sequence[tuple[Array, Any]], width: float) -> None:
        """Draw pieces of line (n, 2, 3) as one group, each part of them in a colour of its own."""
        pieces = [np.zeros((0, 2, 3)), *(each for each, _ in groups)]
        colours = [np.zeros((0, 2, 3), dtype=np.uint8)]
        for each, colour in groups:
            colours.append(np.broadcast_to(np.asarray(colour, np.uint8), (len(each), 2, 3)))
        self.draw(name, np.concatenate(pieces), np.concatenate(colours), width)


class Clouds:
    """Groups of points, each a node of viser's scene while it has any.

    Parameters
    ----------
    scene : viser.SceneApi
    name : str
        With which those of all of them begin.
    size : float
        Of the scene [length].
    """

    def __init__(self, scene: Any, name: str, size: float) -> None:
        self._scene, self._name, self._size = scene, name, size
        self._nodes: dict[str, Any] = {}

    def draw(self, name: str, points: Array, colours: Any, share: float) -> None:
        """Draw a group in place of the one of that name.

        Parameters
        ----------
        name : str
        points : (..., 3) array
            World axes.
        colours : (..., 3) array of uint8
        share : float
            Diameter over the scene's size.
        """
        node = self._nodes.get(name)
        drawn = points.reshape(-1, 3).astype(np.float32)
        if node is not None and len(node.points) != len(drawn):
            self._nodes.pop(name).remove()
            node = None
        if not len(drawn):
            return
        if node is None:
            self._nodes[name] = self._scene.add_point_cloud(
                f"{self._name}_{name}",
                drawn,
                colours.reshape(-1, 3),
                point_size=share * self._size,
                point_shape="circle",
                precision="float32",
            )
            return
        node.points, node.colors = drawn, colours.reshape(-1, 3)


def arrow_of(start: Array, direction: Array, length: float) -> Array:
    """A shaft and two pairs of barbs, (5, 2, 3)."""
    tip = start + length * direction
    aside = np.eye(3)[np.abs(direction).argmin()]
    first = np.cross(direction, aside)
    first /= np.linalg.norm(first)
    second = np.cross(direction, first)
    back = tip - 0.2 * length * direction
    barbs = [(tip, back + 0.08 * length * side) for side in (first, -first, second, -second)]
    return np.array([(start, tip), *barbs])
