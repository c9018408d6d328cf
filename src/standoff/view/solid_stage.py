"""A scene of two solids on the page: its motion and its live pair, and which is shown."""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.bodies.features import Feature
from standoff.motion import Pose
from standoff.scene import Scene, SceneError
from standoff.solids.answer import SolidProximity
from standoff.solids.spatial.solid_model import SolidModel
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
from standoff.view.picture import PairPicture
from standoff.view.player import Player
from standoff.view.server import name_tab
from standoff.view.solid_nodes import MinimaNodes
from standoff.view.solid_panel import SolidPanel
from standoff.view.solid_readout import solid_beside


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


# Both solids with their minima in viser's scene.


class SolidPicture(PairPicture):
    """What a server shows of a pair of solids; all else in its scene is taken away.

    Parameters
    ----------
    server : viser.ViserServer
    solids : (SolidModel, SolidModel)
    unit : str
        Label of lengths.

    Attributes
    ----------
    glass : bool
        Whether both are as if of glass even where they do not overlap.
    """

    def __init__(self, server: Any, solids: tuple[SolidModel, SolidModel], unit: str) -> None:
        boundaries = solids[0].boundary, solids[1].boundary
        # Vertices would be taken for points of minima.
        super().__init__(server, boundaries, unit, corners=False)
        self._solids, self.glass = solids, True
        self._minima = MinimaNodes(server.scene, min(shape.size for shape in self.shapes))

    def show(
        self, answer: SolidProximity, poses: tuple[Pose, Pose], *, held: int | None = None
    ) -> None:
        """Draw an answer.

        Parameters
        ----------
        answer : SolidProximity
        poses : (Pose, Pose)
            That it was asked for.
        held : int, optional
            Number of the handle that is in a user's hand: it is left there.
        """
        deep = answer.penetrating and self._seen_into(answer.distance)
        for nodes in self._bodies:
            nodes.glass(deep or self.glass)
        told = (answer.feature_a, answer.feature_b)
        features = [part_shown(*each) for each in zip(self._solids, told, strict=True)]
        self._place(poses, (features[0], features[1]), np.nan_to_num(answer.normal))
        self._place_handles(poses, deep=deep, held=held)
        self._minima.show(answer, solid_beside(answer, self._unit, self.size))


def part_shown(solid: SolidModel, feature: Feature) -> Feature:
    """Return the face or edge of a solid's boundary that is active with a feature; none with a
    vertex, which is where the minimum's own point is drawn."""
    part = solid.part_told(feature) if feature.kind else feature
    return part if part.kind in ("face", "edge") else Feature("", 0)
