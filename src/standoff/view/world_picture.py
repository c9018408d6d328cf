"""The bodies of a world with its near pairs in viser's scene."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.motion import Pose
from standoff.view.gap_colours import gap_colours
from standoff.view.nodes import COLOURS, AnswerNodes, BodyNodes, Colour, quaternion
from standoff.view.picture import FIRM, GRIP, Aimable, aim_all
from standoff.view.readout import beside
from standoff.view.segments import Segments
from standoff.view.shapes import Shape, shape_of
from standoff.view.tolerances import SEEN_INTO
from standoff.view.world_readout import closest_text
from standoff.world import World, WorldAnswer
from standoff.world.packed import pieces_of
from standoff.world.pair_answer import convex
from standoff.world.pieces import PieceUnion

Array = NDArray[np.float64]

FIXED_COLOURS: tuple[Colour, Colour] = ((205, 205, 205), (120, 120, 120))
"""Of bodies that never move."""

MOST_LINES = 200
"""Near pairs that are drawn: of more, the nearest."""

LINE, CLOSEST_LINE = 2.0, 5.0
"""Thickness of the line of a pair, and of the closest one's [pixels]."""

HUGE = 10.0
"""Size of a body over the usual one from which it is no reason for a camera to step back."""


class WorldPicture(Aimable):
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
    planar : bool
    size : float
        Of a usual body [length].
    sizes : (n,) array
        Of each body [length].
    """

    def __init__(self, server: Any, world: World, unit: str) -> None:
        self._server, self._unit = server, unit
        self._scene = scene = server.scene
        scene.reset()
        scene.configure_default_lights(cast_shadow=False)
        self.planar = world.model.planar
        shapes: dict[int, Shape] = {}
        still = set(world.fixed)
        self._bodies = [
            _Drawn(
                scene, f"/body_{k}", body, FIXED_COLOURS if name in still else COLOURS[0], shapes
            )
            for k, (name, body) in enumerate(world.bodies.items())
        ]
        self._bounded = np.array(
            [all(piece.body.bounded for piece in pieces_of(body)) for body in world.bodies.values()]
        )
        self.sizes = np.array([body.size for body in self._bodies])
        usual = self.sizes[self._bounded]
        self.size = float(np.median(usual)) if len(usual) else float(self.sizes.max())
        self._still = world.model.fixed_rows.tolist()
        self._placed = np.full((len(world), 4, 4), np.nan)
        self._pairs = PairLines(scene)
        self._closest = AnswerNodes(scene, self.size)
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

    def aim(self, poses: Array) -> None:
        """Point the camera of each new page at the bodies, (n, 4, 4)."""
        seen = self._bounded & (self.sizes <= HUGE * self.size)
        if not seen.any():
            seen = np.ones(len(poses), dtype=bool)
        middles = np.array([body.middle for body in self._bodies])
        middles = np.einsum("nij,nj->ni", poses[:, :3, :3], middles) + poses[:, :3, 3]
        low = (middles - 0.5 * self.sizes[:, None])[seen].min(axis=0)
        high = (middles + 0.5 * self.sizes[:, None])[seen].max(axis=0)
        # A little wide: the panel covers the right of the window.
        reach = 0.55 * float(np.linalg.norm(high - low))
        aim_all(self._server, 0.5 * (low + high), reach, planar=self.planar)

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
        for row in np.flatnonzero((poses != self._placed).any(axis=(1, 2))):
            self._bodies[row].place(Pose.of(poses[row]))
        self._placed = poses
        if not held:
            self._put_handle()
        self._show_glass(answer)
        self._pairs.show(answer, end)
        closest = answer.closest
        if closest is None:
            nothing = np.full(3, np.nan)
            self._closest.show((nothing, nothing), nothing, "")
            return
        text = f"{closest_text(convex(closest))}: {beside(closest, self._unit, self.size)}"
        deep = self._seen_into(
            closest.distance, answer.pairs.bodies[answer.pairs.distance.argmin()]
        )
        points = closest.point_a, closest.point_b
        self._closest.show(points, closest.normal, text, deep=bool(deep))

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


class _Drawn:
    """The nodes of one body of the world, all its pieces.

    Attributes
    ----------
    size : float
        Of a box around its pieces [length].
    middle : (3,) array
        Of that box, body frame.
    """

    def __init__(
        self,
        scene: Any,
        name: str,
        body: Body | PieceUnion,
        colours: tuple[Colour, Colour],
        shapes: dict[int, Shape],
    ) -> None:
        self.frame = scene.add_frame(name, show_axes=False)
        self._pieces = []
        ends = []
        for number, (piece, pose) in enumerate(pieces_of(body)):
            # Bodies that are one object are measured once.
            if id(piece) not in shapes:
                shapes[id(piece)] = shape_of(piece)
            shape = shapes[id(piece)]
            nodes = BodyNodes(scene, f"{name}/piece_{number}", shape, colours, corners=False)
            nodes.place(pose)
            self._pieces.append(nodes)
            middle = pose.apply(shape.middle)
            ends += [middle - 0.5 * shape.size, middle + 0.5 * shape.size]
        low, high = np.min(ends, axis=0), np.max(ends, axis=0)
        self.middle = 0.5 * (low + high)
        one = len(self._pieces) == 1
        self.size = shape.size if one else float(np.linalg.norm(high - low)) / np.sqrt(3.0)

    def place(self, pose: Pose) -> None:
        """Put the body at a pose."""
        self.frame.wxyz, self.frame.position = quaternion(pose), tuple(pose.translation)

    def glass(self, on: bool) -> None:
        """Become glass, or solid again."""
        for nodes in self._pieces:
            nodes.glass(on)


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
