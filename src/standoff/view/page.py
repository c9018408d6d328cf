"""The live page: one thread owns the pair and all that is shown of it."""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from standoff.errors import StandoffError
from standoff.motion import Fixed, Pose
from standoff.scene import Scene
from standoff.view.access import Access
from standoff.view.live_pair import LivePair
from standoff.view.nodes import AnswerNodes, BodyNodes, answer_text, quaternion
from standoff.view.readout import readout
from standoff.view.server import guarded_server, stop
from standoff.view.shapes import Shape, shape_of

PERIOD = 0.02
"""Time between two looks at what the pages ask for [s]: viser sends as often."""

GRIP = 0.5
"""Size of the handle that drags a body, over the body's own."""


AWAY = 2.5
"""Distance of a new page's camera, over half the width of what it should see."""


class Page:
    """A scene in the browser: the pair with its answer, a body of it dragged by a handle.

    Parameters
    ----------
    scene : Scene
    host : str
        Name or address to bind to.
    port : int, optional
        If not given, any that is free.

    Attributes
    ----------
    address : str
        To be opened in a browser; it holds the token of this run.
    pair : LivePair

    Raises
    ------
    ModuleNotFoundError
        If viser is not installed; the message names the extra.
    StandoffError
        If the port cannot be had, or the pair cannot be tracked.
    """

    def __init__(self, scene: Scene, *, host: str = "127.0.0.1", port: int | None = None) -> None:
        self._asked: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._closing = threading.Event()
        self._scene = scene
        self.pair = live_pair(scene)
        self._wanted = self.pair.poses
        access = Access(host)
        self.server = guarded_server(access, port)
        self.port: int = self.server.get_port()
        self.address = access.address(self.port)
        self._build()
        self._thread = threading.Thread(target=self._work, name="standoff-page", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Close the port; the page says that it is disconnected."""
        self._closing.set()
        self._thread.join()
        stop(self.server)

    def wait(self) -> None:
        """Return when the page is closed, as by an interrupt."""
        self._closing.wait()

    def __enter__(self) -> Page:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def _build(self) -> None:
        gui, scene = self.server.gui, self.server.scene
        gui.configure_theme(show_logo=False, show_share_button=False)
        gui.set_panel_label(self._scene.title)
        scene.configure_default_lights(cast_shadow=False)
        shapes = [shape_of(body) for body in self.pair.bodies]
        size = max(shape.size for shape in shapes)
        self._bodies = [
            BodyNodes(scene, f"/{which}", shape, number)
            for number, (which, shape) in enumerate(zip("AB", shapes, strict=True))
        ]
        self._answer = AnswerNodes(scene, size)
        self._readout = gui.add_html("")
        self._grips = [self._grip(number, shape) for number, shape in enumerate(shapes)]
        self._aim(shapes, size)

        @self.server.on_client_connect
        async def _(client: Any) -> None:
            step_back(client.camera, self.server.initial_camera)

        self._show()

    def _aim(self, shapes: list[Shape], size: float) -> None:
        """Point a new page's camera at both bodies."""
        middles = [
            pose.apply(shape.middle) for pose, shape in zip(self.pair.poses, shapes, strict=True)
        ]
        middle = 0.5 * (middles[0] + middles[1])
        reach = 0.5 * float(np.linalg.norm(middles[1] - middles[0])) + 0.6 * size
        # A plane is seen from above, its y upwards.
        self.server.scene.set_up_direction("+y" if self._planar else "+z")
        towards = np.array([0.0, 0.0, 1.0] if self._planar else [0.6, -1.0, 0.6])
        camera = self.server.initial_camera
        camera.fov = 0.8
        camera.near, camera.far = 1e-2 * reach, 1e2 * reach
        camera.look_at = middle
        camera.position = middle + AWAY * reach * towards / np.linalg.norm(towards)

    @property
    def _planar(self) -> bool:
        return any(body.dimension == 2 for body in self.pair.bodies)

    def _grip(self, number: int, shape: Shape) -> Any:
        grip = self.server.scene.add_transform_controls(
            f"/grip_{'AB'[number]}",
            scale=GRIP * shape.size,
            active_axes=(True, True, not self._planar),
            depth_test=False,
            opacity=0.6,
            visible=number == moving_body(self._scene),
        )

        @grip.on_update
        async def _(event: Any) -> None:
            held = event.target
            self._asked.put(lambda: self._drag(number, held.wxyz, held.position))

        return grip

    def _drag(self, number: int, wxyz: Any, position: Any) -> None:
        poses = list(self._wanted)
        poses[number] = _placed(wxyz, position, self._planar)
        self._wanted = poses[0], poses[1]

    def _work(self) -> None:
        last = time.monotonic()
        while not self._closing.wait(max(0.0, last + PERIOD - time.monotonic())):
            now = time.monotonic()
            try:
                self._tick(now - last)
            except StandoffError as error:
                self._tell(str(error))
            last = now

    def _tick(self, elapsed: float) -> None:
        while not self._asked.empty():
            self._asked.get()()
        before = self.pair.answer
        if self._wanted is not self.pair.poses or not before.certified:
            wanted = self._wanted
            try:
                self.pair.move(wanted, elapsed)
            except StandoffError:
                self._wanted = self.pair.poses
                raise
        if self.pair.answer is not before:
            self._show()

    def _show(self) -> None:
        answer, poses = self.pair.answer, self.pair.poses
        names, unit = self._scene.pair, self._scene.length_unit
        with self.server.atomic():
            sides = zip(self._bodies, self._grips, poses, (1.0, -1.0), strict=True)
            for (nodes, grip, pose, sign), feature in zip(
                sides, (answer.feature_a, answer.feature_b), strict=True
            ):
                nodes.place(pose)
                nodes.highlight(feature, sign * (pose.rotation.T @ answer.normal))
                grip.wxyz, grip.position = quaternion(pose), tuple(pose.translation)
            text = answer_text(answer.distance, answer.lower_bound, answer.status, unit)
            self._answer.show((answer.point_a, answer.point_b), answer.normal, text)
            self._readout.content = readout(answer, names, unit)

    def _tell(self, message: str) -> None:
        for client in self.server.get_clients().values():
            client.add_notification("Not done", message, auto_close_seconds=10.0, color="red")


def live_pair(scene: Scene) -> LivePair:
    """Return a scene's pair where it begins.

    Raises
    ------
    StandoffError
        What the tracker refuses.
    """
    start = scene.instant()
    pose_a, pose_b = (Pose.of(motion.path.pose(start)) for motion in scene.pair_motions)
    step = scene.settings.step
    dt = step if isinstance(step, float) else PERIOD
    return LivePair(*scene.pair_bodies, (pose_a, pose_b), scene.settings.law, dt)


def moving_body(scene: Scene) -> int:
    """Return the number of the body that a scene moves: 1 where it moves B alone."""
    still = [isinstance(motion.path, Fixed) for motion in scene.pair_motions]
    return 1 if still[0] and not still[1] else 0


def step_back(camera: Any, usual: Any) -> None:
    """Move a page's camera back where its window is higher than wide, as on a phone."""
    if camera.aspect < 1.0:
        camera.position = usual.look_at + (usual.position - usual.look_at) / camera.aspect
        camera.look_at = usual.look_at  # setting a position carries it along


def _placed(wxyz: Any, position: Any, planar: bool) -> Pose:
    """The pose of a handle; of a planar pair its part in the plane."""
    pose = Pose.from_wxyz(np.asarray(wxyz) / np.linalg.norm(wxyz), position)
    if not planar:
        return pose
    turn = np.arctan2(pose.rotation[1, 0], pose.rotation[0, 0])
    return Pose.exp([0.0, 0.0, turn], [pose.translation[0], pose.translation[1], 0.0])
