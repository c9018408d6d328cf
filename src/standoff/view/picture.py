"""Both bodies with their answer in viser's scene, seen from a camera that is aimed at them."""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.bodies.boundary import Boundary
from standoff.bodies.features import Feature
from standoff.motion import Pose
from standoff.typing import Array
from standoff.view.nodes import COLOURS, AnswerNodes, BodyNodes, quaternion
from standoff.view.readout import beside
from standoff.view.shapes import ShownShape, shape_of
from standoff.view.shown import ShownPair
from standoff.view.tolerances import SEEN_INTO

GRIP = 0.5
"""Size of the handle that drags a body, over the body's own."""

FIRM, FAINT = 0.6, 0.25
"""Opacity of that handle, which is drawn over all else: faint where it would hide an overlap."""

AWAY = 2.5
"""Distance of a new page's camera, over half the width of what it should see."""

FIELD = 0.8
"""Angle that the camera sees from below to above, radians: bodies look little distorted."""


NARROW = 0.7
"""Width over height of a window, below which viser's panel lies over its lower half."""

LOWER = 0.28
"""How much lower the camera looks then, over the height that it sees."""


class Aimable:
    """A picture whose pages have cameras."""

    _server: Any

    def aim_one(self, client: Any) -> None:
        """Put one page's camera where new ones begin."""
        step_back(client.camera, self._server.initial_camera)

    def aim_again(self, client: Any) -> None:
        """Aim the camera of a narrow page that stands where viser puts it, too near."""
        usual = self._server.initial_camera
        if client.camera.aspect < 1.0 and np.allclose(client.camera.position, usual.position):
            self.aim_one(client)


class PairPicture(Aimable):
    """Both bodies of a pair with their handles; all else in a server's scene is taken away.

    Parameters
    ----------
    server : viser.ViserServer
    bodies : (Boundary, Boundary)
        Convex bodies, or boundaries of solids that need not be.
    unit : str
        Label of lengths.
    handles : bool
        Whether bodies have handles to drag them by.
    corners : bool
        Whether vertices are drawn.

    Attributes
    ----------
    handles : list
        Viser's, of A and B; empty where there are none.
    planar : bool
    size : float
        Of the larger body [length].
    """

    def __init__(
        self,
        server: Any,
        bodies: tuple[Boundary, Boundary],
        unit: str,
        *,
        handles: bool = True,
        corners: bool = True,
    ) -> None:
        self._server, self._unit = server, unit
        scene = server.scene
        scene.reset()
        scene.configure_default_lights(cast_shadow=False)
        self.planar = any(body.dimension == 2 for body in bodies)
        self.shapes: tuple[ShownShape, ShownShape] = shape_of(bodies[0]), shape_of(bodies[1])
        self._bodies = [
            BodyNodes(scene, f"/{which}", shape, COLOURS[number], corners=corners)
            for number, (which, shape) in enumerate(zip("AB", self.shapes, strict=True))
        ]
        self.size = max(shape.size for shape in self.shapes)
        self.handles = [self._handle(number) for number in (0, 1)] if handles else []

    def _handle(self, number: int) -> Any:
        return self._server.scene.add_transform_controls(
            f"/handle_{'AB'[number]}",
            scale=GRIP * self.shapes[number].size,
            active_axes=(True, True, not self.planar),
            depth_test=False,
            opacity=FIRM,
            visible=False,
        )

    def aim(self, poses: tuple[Pose, Pose]) -> None:
        """Point the camera of each new page at bodies at these poses."""
        middles = [pose.apply(shape.middle) for pose, shape in zip(poses, self.shapes, strict=True)]
        middle = 0.5 * (middles[0] + middles[1])
        reach = 0.5 * float(np.linalg.norm(middles[1] - middles[0]))
        reach += 0.6 * max(shape.size for shape in self.shapes)
        aim_all(self._server, middle, reach, planar=self.planar)

    def _seen_into(self, distance: float) -> bool:
        """Is an overlap so deep that it is looked into?"""
        return -distance > SEEN_INTO * min(shape.size for shape in self.shapes)

    def _place(
        self, poses: tuple[Pose, Pose], features: tuple[Feature, Feature], normal: Array
    ) -> None:
        """Put both bodies at poses, with their active features; normal (3,) from A to B."""
        for nodes, pose, feature, sign in zip(
            self._bodies, poses, features, (1.0, -1.0), strict=True
        ):
            nodes.place(pose)
            nodes.highlight(feature, sign * (pose.rotation.T @ normal))

    def _place_handles(
        self, poses: tuple[Pose, Pose], *, deep: bool, held: int | None = None
    ) -> None:
        for number, handle in enumerate(self.handles):
            handle.opacity = FAINT if deep else FIRM
            if number != held:
                # Its squares are never faint: they go, but not out of a hand.
                handle.disable_sliders = deep and not self.planar
                pose = poses[number]
                handle.wxyz, handle.position = quaternion(pose), tuple(pose.translation)


class Picture(PairPicture):
    """What a server shows of a pair of convex bodies; its arguments are those of `PairPicture`."""

    def __init__(
        self, server: Any, bodies: tuple[Boundary, Boundary], unit: str, *, handles: bool = True
    ) -> None:
        super().__init__(server, bodies, unit, handles=handles)
        self._answer = AnswerNodes(server.scene, self.size)

    def pull(self, at: Any, force: Any, greatest: float) -> None:
        """Draw the coupler's force on a tool; see `AnswerNodes.pull`."""
        self._answer.pull(at, force, greatest)

    def show(self, shown: ShownPair, note: str = "", *, held: int | None = None) -> None:
        """Draw what is shown at an instant.

        Parameters
        ----------
        shown : ShownPair
        note : str
            Stands before the distance.
        held : int, optional
            Number of the handle that is in a user's hand: it is left there.
        """
        deep = shown.status.penetrating and self._seen_into(shown.distance)
        for nodes in self._bodies:
            nodes.glass(deep)
        self._place(shown.poses, shown.features, shown.normal)
        self._place_handles(shown.poses, deep=deep, held=held)
        text = beside(shown, self._unit, self.size)
        self._answer.show(shown.points, shown.normal, f"{note}{text}", deep=deep)


def aim_all(server: Any, middle: Array, reach: float, *, planar: bool) -> None:
    """Point the camera of each page, and of each new one, at a ball.

    Parameters
    ----------
    server : viser.ViserServer
    middle : (3,) array
    reach : float
        Radius of the ball [length].
    planar : bool
        A plane is seen from above, its y upwards.
    """
    server.scene.set_up_direction("+y" if planar else "+z")
    towards = np.array([0.0, 0.0, 1.0] if planar else [0.6, -1.0, 0.6])
    camera = server.initial_camera
    camera.fov = FIELD
    camera.near, camera.far = 1e-2 * reach, 1e2 * reach
    camera.position = middle + AWAY * reach * towards / np.linalg.norm(towards)
    camera.look_at = middle
    for client in server.get_clients().values():
        step_back(client.camera, camera)


def step_back(camera: Any, usual: Any) -> None:
    """Put a page's camera where new ones begin.

    Where the window is narrow, as on a phone, it stands farther off, and looks lower: the panel
    covers the lower half there.
    """
    camera.near, camera.far, camera.fov = usual.near, usual.far, usual.fov
    towards = (usual.position - usual.look_at) / min(1.0, camera.aspect)
    target = usual.look_at
    if camera.aspect < NARROW:
        distance = float(np.linalg.norm(towards))
        ahead = -towards / distance
        up = camera.up_direction - (camera.up_direction @ ahead) * ahead
        height = 2.0 * distance * np.tan(0.5 * usual.fov)
        target = target - LOWER * height * up / max(float(np.linalg.norm(up)), 0.1)
    camera.position = target + towards
    camera.look_at = target  # setting a position carries it along
