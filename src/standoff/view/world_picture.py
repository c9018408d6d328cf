"""The bodies of a world with its near pairs in viser's scene."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from standoff.motion import Pose
from standoff.solids.answer import NearestPair
from standoff.typing import Array
from standoff.view.bodies_picture import FIXED_COLOURS, BodiesPicture
from standoff.view.gap_colours import gap_colours
from standoff.view.nodes import COLOURS, AnswerNodes, quaternion
from standoff.view.picture import FIRM, GRIP
from standoff.view.readout import beside
from standoff.view.segments import Segments
from standoff.view.solid_nodes import MOST_DRAWN, MinimaNodes, drawn_minima
from standoff.view.solid_readout import solid_beside
from standoff.view.tolerances import SEEN_INTO
from standoff.view.world_readout import closest_text
from standoff.world import World, WorldAnswer
from standoff.world.packed import pieces_of
from standoff.world.pair_answer import PairAnswer
from standoff.world.shapes import is_solid

MOST_LINES = 200
"""Near pairs that are drawn: of more, the nearest."""

LINE, CLOSEST_LINE = 2.0, 5.0
"""Thickness of the line of a pair, and of the closest one's [pixels]."""


class WorldPicture(BodiesPicture):
    """What a server shows of a world; all else in its scene is taken away.

    Parameters
    ----------
    server : viser.ViserServer
    world : World
    unit : str
        Label of lengths.

    Attributes
    ----------
    handle : viser's handle or None
        Of the body that can be dragged.
    """

    def __init__(self, server: Any, world: World, unit: str) -> None:
        still = set(world.fixed)
        colours = [FIXED_COLOURS if name in still else COLOURS[0] for name in world.bodies]
        super().__init__(server, tuple(world.bodies.values()), colours, planar=world.model.planar)
        self._unit = unit
        self._scene = scene = server.scene
        self._still = world.model.fixed_rows.tolist()
        self._pairs = PairLines(scene)
        self._closest = AnswerNodes(scene, self.size)
        pieces = (piece for body in world.bodies.values() for piece in pieces_of(body))
        solid = any(is_solid(piece.body) for piece in pieces)
        self._minima = MinimaNodes(scene, self.size) if solid else None
        self.handle: Any = None
        self._held_row = -1

    def give_handle(self, row: int | None, moved: Callable[[Any], Any] | None = None) -> None:
        """Put the handle at one body.

        Parameters
        ----------
        row : int or None
            Number of the body; None takes it away.
        moved : coroutine function, optional
            Takes viser's event.
        """
        if self.handle is not None:
            self.handle.remove()
        self.handle, self._held_row = None, -1 if row is None else row
        if row is None or moved is None:
            return
        # One for each body: what one of them still sends does not move another.
        self.handle = self._scene.add_transform_controls(
            f"/handle_{row}",
            scale=GRIP * max(float(self.sizes[row]), self.size),
            active_axes=(True, True, not self.planar),
            depth_test=False,
            opacity=FIRM,
        )
        self._put_handle()
        self.handle.on_update(moved)

    def show(self, answer: WorldAnswer, end: float, *, held: bool = False) -> None:
        """Draw an answer.

        Parameters
        ----------
        answer : WorldAnswer
        end : float
            Gap of the palest colour [length].
        held : bool
            The handle is in a user's hand: it is left there.
        """
        poses = answer.state.poses
        self.place(poses)
        if not held:
            self._put_handle()
        self._show_glass(answer)
        self._pairs.show(answer, end)
        closest = answer.closest
        if self._minima is not None:
            self._show_minima(answer, self._minima)
        if closest is None or not isinstance(closest, PairAnswer):
            nothing = np.full(3, np.nan)
            self._closest.show((nothing, nothing), nothing, "")
            return
        text = f"{closest_text(closest)}: {beside(closest, self._unit, self.size)}"
        deep = self._seen_into(
            closest.distance, answer.pairs.bodies[answer.pairs.distance.argmin()]
        )
        points = closest.point_a, closest.point_b
        self._closest.show(points, closest.normal, text, deep=bool(deep))

    def _show_minima(self, answer: WorldAnswer, nodes: MinimaNodes) -> None:
        """All minima and places of pairs with a solid."""
        closest = answer.closest
        first = None if isinstance(closest, PairAnswer) else closest
        others: list[NearestPair] = []
        for pair in answer.pairs:
            if not isinstance(pair, PairAnswer) and (first is None or pair.names != first.names):
                others += drawn_minima(pair)
            if len(others) >= MOST_DRAWN:
                break
        text = ""
        if first is not None:
            text = f"{closest_text(first)}: {solid_beside(first, self._unit, self.size)}"
        nodes.show(first, text, others)

    def _seen_into(self, distance: Any, bodies: Any) -> Any:
        return -distance > SEEN_INTO * self.sizes[bodies].min(axis=-1)

    def _show_glass(self, answer: WorldAnswer) -> None:
        pairs = answer.pairs
        deep = self._seen_into(pairs.distance, pairs.bodies)
        # Fixed bodies always are: shelves and walls hide what moves among them.
        within = {*pairs.bodies[deep].ravel().tolist(), *self._still}
        for row, body in enumerate(self._bodies):
            body.glass(row in within)

    def _put_handle(self) -> None:
        if self.handle is not None and np.isfinite(self._placed[self._held_row]).all():
            pose = Pose.of(self._placed[self._held_row])
            self.handle.wxyz, self.handle.position = quaternion(pose), tuple(pose.translation)


class PairLines(Segments):
    """Lines between the witness points of near pairs; the closest one's is thicker.

    Parameters
    ----------
    scene : viser.SceneApi
    """

    def __init__(self, scene: Any) -> None:
        super().__init__(scene, "/pairs")
        self.ends: Array = np.zeros((0, 2, 3))

    def show(self, answer: WorldAnswer, end: float) -> None:
        """Draw those of an answer; `end` [length] is the gap of the palest colour."""
        pairs = answer.pairs
        gaps = pairs.distance
        ends = np.stack([pairs.point_a, pairs.point_b], axis=1)
        known = np.flatnonzero(np.isfinite(ends).all(axis=(1, 2)))
        rows = known[np.argsort(gaps[known], kind="stable")][:MOST_LINES]
        self.ends = ends[rows]
        colours = np.repeat(gap_colours(gaps[rows], end)[:, None], 2, axis=1)
        self.draw("near", self.ends[1:], colours[1:], LINE)
        self.draw("closest", self.ends[:1], colours[:1], CLOSEST_LINE)
