"""Any number of bodies in viser's scene, compounds among them, seen from an aimed camera."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from standoff.motion import Pose
from standoff.typing import Array
from standoff.view.nodes import BodyNodes, Colour, quaternion
from standoff.view.picture import Aimable, aim_all
from standoff.view.shapes import ShownShape, shape_of
from standoff.world.packed import pieces_of
from standoff.world.shapes import is_bounded

FIXED_COLOURS: tuple[Colour, Colour] = ((205, 205, 205), (120, 120, 120))
"""Of bodies that never move."""

HUGE = 10.0
"""Size of a body over the usual one from which it is no reason for a camera to step back."""


class BodiesPicture(Aimable):
    """Bodies at their places; all else in a server's scene is taken away.

    Parameters
    ----------
    server : viser.ViserServer
    bodies : sequence of Body, Solid or Compound
    colours : sequence of (Colour, Colour)
        Of each, light and strong.
    planar : bool

    Attributes
    ----------
    planar : bool
    size : float
        Of a usual body [length].
    sizes : (n,) array
        Of each body [length].
    """

    def __init__(
        self,
        server: Any,
        bodies: Sequence[Any],
        colours: Sequence[tuple[Colour, Colour]],
        *,
        planar: bool = False,
    ) -> None:
        self._server, self.planar = server, planar
        scene = server.scene
        scene.reset()
        scene.configure_default_lights(cast_shadow=False)
        shapes: dict[int, ShownShape] = {}
        self._bodies = [
            _Drawn(scene, f"/body_{k}", body, colour, shapes)
            for k, (body, colour) in enumerate(zip(bodies, colours, strict=True))
        ]
        self._bounded = np.array(
            [all(is_bounded(piece.body) for piece in pieces_of(body)) for body in bodies]
        )
        self.sizes = np.array([body.size for body in self._bodies])
        usual = self.sizes[self._bounded]
        self.size = float(np.median(usual)) if len(usual) else float(self.sizes.max())
        self._placed = np.full((len(bodies), 4, 4), np.nan)

    def place(self, poses: Array) -> None:
        """Put the bodies at poses, (n, 4, 4)."""
        for row in np.flatnonzero((poses != self._placed).any(axis=(1, 2))):
            self._bodies[row].place(Pose.of(poses[row]))
        self._placed = poses

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
        body: Any,
        colours: tuple[Colour, Colour],
        shapes: dict[int, ShownShape],
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
