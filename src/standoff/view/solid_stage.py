"""A scene of two solids on the page: its motion and its live pair, and which is shown."""

from __future__ import annotations

from typing import Any

from standoff.motion import Pose
from standoff.scene import Scene, SceneError
from standoff.solids.answer import SolidProximity
from standoff.view import laws
from standoff.view.live_solids import (
    LiveSolids,
    Poses,
    SolidCourse,
    course_of,
    tracker_of,
)
from standoff.view.minima_asked import MinimaAsked
from standoff.view.motion_panel import Later
from standoff.view.pair_stage import PairStage, moving_body
from standoff.view.player import Player
from standoff.view.server import name_tab
from standoff.view.solid_panel import SolidPanel
from standoff.view.solid_picture import SolidPicture


class SolidStage(PairStage[SolidCourse]):
    """A scene of a pair, at least one of both a solid, as a page shows it.

    Raises SceneError if the pair cannot be tracked, or the scene's times are not possible.

    Parameters
    ----------
    panel : SolidPanel
    server, later : as for `MotionPanel`
    scene : Scene
    asked : MinimaAsked

    Attributes
    ----------
    pair : LiveSolids
        What is dragged.
    player : Player or None
        What is played; None where nothing moves by itself.
    picture : SolidPicture
    """

    def __init__(
        self, server: Any, panel: SolidPanel, later: Later, scene: Scene, asked: MinimaAsked
    ) -> None:
        self._server = server
        self.panel: SolidPanel = panel
        start = scene.instant()
        times = scene.times() if laws.moves(scene) else None
        try:
            tracker = tracker_of(*scene.pair_shapes, asked, laws.frame_time(scene))
            self.pair: LiveSolids = LiveSolids(tracker, _poses(scene, start))
            self.player: Player[SolidCourse] | None = None
            if times is not None:
                poses = [_poses(scene, time) for time in times.tolist()]
                self.player = Player(course_of(tracker, times, poses))
        except (ValueError, TypeError) as error:
            raise SceneError(str(error), key="pair", file=scene.file) from error
        self._begin(scene, self.pair.poses)
        # All that may be refused has been asked: now the page changes.
        self.picture: SolidPicture = SolidPicture(server, (tracker.a, tracker.b), scene.length_unit)
        self._listen(self.picture.handles, later)
        self.picture.aim(self.pair.poses)
        which = "AB"[moving_body(scene)]
        unit, size = scene.length_unit, self.picture.size
        panel.begin(scene.title, self.player, which, scene.pair, unit, size)
        name_tab(server, scene.title)
        self.hand(which)
        self._show_pair()

    def glass(self, on: bool) -> None:
        """Show both as if of glass, or only where they overlap."""
        self.picture.glass = on
        self._show(*self._shown)

    def _follow(self, elapsed: float) -> None:
        """Put the dragged solid where it is wanted; a frame that was cut short goes on."""
        self._clock += elapsed
        if self._wanted is self.pair.poses and self.pair.settled:
            self.panel.rests()
            return
        try:
            self.pair.move(self._wanted)
        except Exception:  # else it would be met again at every look
            self._wanted = self.pair.poses
            raise
        self._show_pair()
        self.panel.traces(self._clock, self.pair.answer)

    def _played(self, player: Player[SolidCourse]) -> Poses:
        return player.recording.poses[player.frame]

    def _show_frame(self, player: Player[SolidCourse]) -> None:
        self._show(player.recording.answers[player.frame], self._played(player))
        self.panel.plays(player)

    def _show_pair(self) -> None:
        self._show(self.pair.answer, self.pair.poses)

    def _show(self, answer: SolidProximity, poses: Poses) -> None:
        self._shown = answer, poses
        with self._server.atomic():
            self.picture.show(answer, poses, held=self._held)
            self.panel.show(answer)

    def _let_go(self) -> None:
        """Nothing else moves solids."""


def _poses(scene: Scene, time: float) -> Poses:
    a, b = (Pose.of(motion.path.pose(time)) for motion in scene.pair_motions)
    return a, b
