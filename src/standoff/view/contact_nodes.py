"""The contacts of a simulation as nodes of viser's scene: places, spots, normals and forces."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from standoff.simulation.pair_contacts import PairContact, SpotForce
from standoff.simulation.solid_places import ContactPlace
from standoff.typing import Array
from standoff.view.nodes import ARROW, BOUND_COLOUR, Colour
from standoff.view.segments import Clouds, Segments, arrow_of
from standoff.view.solid_nodes import LABELLED, LINE, OVERLAP_COLOUR, POINT, SHAFT, ends_of

FORCE_LINE = 4.0
"""Thickness of the arrows of forces [pixels]."""

FORCE_COLOUR: Colour = (215, 120, 0)
"""Of forces: seen on either body, on normals and on points."""

SPOT = 2.0 * POINT
"""Diameter of a spot, over the scene's size."""

LONGEST = 2.0
"""Of the arrow of a force, over the scene's size: blows are many times what rests."""


class Arrows(NamedTuple):
    """How forces are drawn.

    Attributes
    ----------
    scale : float
        Length of the arrow of one unit of force.
    longest : float
        Length at which arrows are cut.
    """

    scale: float
    longest: float

    def length(self, force: Array) -> float:
        """Of a force's arrow, (3,)."""
        return min(self.scale * float(np.linalg.norm(force)), self.longest)


class ContactNodes:
    """Of each place both points and the line between them, of each spot its point, its normal and
    its force.

    Parameters
    ----------
    scene : viser.SceneApi
    size : float
        Of the bodies that move [length].
    """

    def __init__(self, scene: Any, size: float) -> None:
        self._scene, self._size = scene, size
        scene.add_frame("/contacts", show_axes=False)
        self._lines = Segments(scene, "/contacts")
        self._clouds = Clouds(scene, "/contacts/points", size)
        self._labels: list[Any] = []

    def show(
        self, contacts: Sequence[PairContact], arrows: Arrows, texts: Sequence[tuple[Array, str]]
    ) -> None:
        """Draw contacts; `texts` stand at points (3,)."""
        ends, along = ends_of(drawn_places(contacts))
        self._lines.draw("places", ends, along, LINE)
        self._clouds.draw("places", ends, along, POINT)
        spots = [spot for each in contacts for spot in each.spots]
        points = np.array([spot.point for spot in spots]).reshape(-1, 3)
        self._clouds.draw("spots", points, _all(OVERLAP_COLOUR, len(points)), SPOT)
        normals = [arrow_of(s.point, s.normal, 0.5 * ARROW * self._size) for s in spots]
        self._lines.draw_groups("normals", [(each, BOUND_COLOUR) for each in normals], SHAFT)
        forces = [(each, FORCE_COLOUR) for each in _forces(spots, arrows)]
        self._lines.draw_groups("forces", forces, FORCE_LINE)
        self._write(texts)

    def _write(self, texts: Sequence[tuple[Array, str]]) -> None:
        while len(self._labels) < min(len(texts), LABELLED):
            name = f"/contacts/label_{len(self._labels)}"
            self._labels.append(self._scene.add_label(name, "", anchor="bottom-left"))
        for label in self._labels[len(texts) :]:
            label.visible = False
        for label, (point, text) in zip(self._labels, texts, strict=False):
            label.text, label.position, label.visible = text, tuple(point), True


def drawn_places(contacts: Sequence[PairContact]) -> list[ContactPlace]:
    """Return the places that are drawn: those that are felt, or are still apart."""
    return [p for each in contacts for p in each.places if p.felt or p.distance > 0.0]


def _forces(spots: Sequence[SpotForce], arrows: Arrows) -> list[Array]:
    found = []
    for spot in spots:
        length = arrows.length(spot.force)
        if length > 0.0:
            found.append(arrow_of(spot.point, spot.force / np.linalg.norm(spot.force), length))
    return found


def _all(colour: Colour, count: int) -> Any:
    return np.broadcast_to(np.array(colour, dtype=np.uint8), (count, 3)).copy()
