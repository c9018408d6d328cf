"""The local minima of two solids, and the places where they overlap, as nodes of viser's scene."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from standoff.simulation.solid_places import ContactPlace
from standoff.solids.answer import NearestPair, SolidProximity
from standoff.typing import Array
from standoff.view.nodes import ARROW, BOUND_COLOUR, WITNESS_COLOUR, WITNESS_RADIUS, Colour
from standoff.view.segments import Clouds, Segments, arrow_of

OVERLAP_COLOUR: Colour = (190, 0, 110)
"""Of places in overlap: like neither body, nor the normals, nor what is apart."""

PATCH_COLOUR: Colour = (110, 50, 190)
"""Of patches of minima that are apart, which may lie along the edges of both."""

END_COLOUR: Colour = (120, 90, 160)
"""Of the pairs at the ends of a continuum."""

LINE, NEAREST_LINE, PATCH_LINE, END_LINE, SHAFT = 2.0, 5.0, 2.5, 1.5, 2.0
"""Thickness of lines [pixels]."""

MOST_DRAWN = 200
"""Minima that are drawn: of more, the nearest."""

LABELLED = 16
"""Minima with their keys beside them: more would hide each other."""

POINT, NEAREST_POINT = 1.4 * WITNESS_RADIUS, 2.4 * WITNESS_RADIUS
"""Diameter of the points of a minimum, and of those of the nearest, over the scene's size."""


class MinimaNodes:
    """Of each minimum its two points, the line between them, its normal and its patch; of the
    nearest in larger size, with its distance.

    Parameters
    ----------
    scene : viser.SceneApi
    size : float
        Of the scene [length].
    """

    def __init__(self, scene: Any, size: float) -> None:
        self._scene, self._size = scene, size
        scene.add_frame("/minima", show_axes=False)
        self._lines = Segments(scene, "/minima")
        self._clouds = Clouds(scene, "/minima/points", size)
        self._labels: list[Any] = []
        self._label = scene.add_label("/minima/label", "", anchor="bottom-left")
        self._ball = scene.add_icosphere(
            "/minima/ball", 1.0, OVERLAP_COLOUR, opacity=0.5, visible=False
        )

    def show(
        self, answer: SolidProximity | None, text: str, others: Sequence[NearestPair] = ()
    ) -> None:
        """Draw what an answer tells, nothing of None, and minima of other pairs; `text` stands
        beside the nearest minimum."""
        own = () if answer is None else drawn_minima(answer)
        minima, first = (*own, *others)[:MOST_DRAWN], len(own[:1])
        ends, along = ends_of(minima)
        self._lines.draw("others", ends[first:], along[first:], LINE)
        self._lines.draw("nearest", ends[:first], along[:first], NEAREST_LINE)
        self._clouds.draw("others", ends[first:], along[first:], POINT)
        self._clouds.draw("nearest", ends[:first], along[:first], NEAREST_POINT)
        self._normals(minima, first)
        outlines = [
            (outline_of(m), OVERLAP_COLOUR if m.distance < 0.0 else PATCH_COLOUR) for m in minima
        ]
        self._lines.draw_groups("patches", outlines, PATCH_LINE)
        self._continuum(answer)
        self._show_ball(answer)
        self._write(minima, ends, text if first else "")

    def _normals(self, minima: Sequence[NearestPair], first: int) -> None:
        """From A's point on; pieces of line, as arrows would each be a mesh of its own size."""
        shafts = []
        for number, m in enumerate(minima):
            length = ARROW * self._size * (1.0 if number < first else 0.5)
            shafts.append(arrow_of(m.point_a, m.normal, length))
        self._lines.draw_groups("normals", [(each, BOUND_COLOUR) for each in shafts], SHAFT)

    def _continuum(self, answer: SolidProximity | None) -> None:
        continuum = None if answer is None else answer.continuum
        pairs = np.array(() if continuum is None else continuum.ends).reshape(-1, 2, 3)
        if continuum is not None and continuum.kind == "line" and len(pairs):
            pairs = np.concatenate([pairs, pairs.transpose(1, 0, 2)])
        self._lines.draw_groups("ends", [(pairs, END_COLOUR)], END_LINE)

    def _show_ball(self, answer: SolidProximity | None) -> None:
        """The ball inside both, where no place of an overlap is told."""
        overlap = None if answer is None or answer.minima else answer.overlap
        shown = overlap is not None and overlap.radius > 0.0
        self._ball.visible = shown
        if shown and overlap is not None:
            self._ball.position = tuple(overlap.common_point)
            self._ball.scale = float(overlap.radius)

    def _write(self, minima: Sequence[NearestPair], ends: Array, text: str) -> None:
        middles = ends.mean(axis=1)
        self._label.visible = bool(text)
        self._label.text = text
        if text:
            self._label.position = tuple(middles[0])
        keyed = [k for k in range(bool(text), min(len(minima), LABELLED)) if minima[k].key >= 0]
        while len(self._labels) < len(keyed):
            name = f"/minima/key_{len(self._labels)}"
            self._labels.append(self._scene.add_label(name, "", anchor="top-right"))
        for label in self._labels[len(keyed) :]:
            label.visible = False
        for label, k in zip(self._labels, keyed, strict=False):
            label.text, label.visible = f"#{minima[k].key}", True
            label.position = tuple(middles[k])


def ends_of(pairs: Sequence[NearestPair | ContactPlace]) -> tuple[Array, Any]:
    """Return both points of each of some pairs of points, (n, 2, 3), and their colours, that of an
    overlap where they are below 0."""
    ends = np.array([(p.point_a, p.point_b) for p in pairs]).reshape(-1, 2, 3)
    colours = np.array(
        [OVERLAP_COLOUR if p.distance < 0.0 else WITNESS_COLOUR for p in pairs], dtype=np.uint8
    ).reshape(-1, 3)
    return ends, np.repeat(colours[:, None], 2, axis=1)


def drawn_minima(answer: SolidProximity) -> tuple[NearestPair, ...]:
    """Return the minima of an answer that are drawn, the nearest first: no other ways out of what
    is drawn."""
    felt = (m for m in answer.minima if m.felt)
    known = (m for m in felt if np.isfinite([*m.point_a, *m.point_b, *m.normal]).all())
    return tuple(known)[:MOST_DRAWN]


def outline_of(minimum: NearestPair) -> Array:
    """Return the pieces of line around a minimum's patch on both solids, (n, 2, 3); none of a patch
    of one pair."""
    pairs = np.array(minimum.patch).reshape(-1, 2, 3)
    if len(pairs) < 2:
        return np.zeros((0, 2, 3))
    sides = [
        np.stack([side, np.roll(side, -1, axis=0)], axis=1) for side in np.moveaxis(pairs, 1, 0)
    ]
    return np.concatenate(sides)
