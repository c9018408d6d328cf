"""One scene on the page: its recording and its live pair, and which of the two is shown."""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.errors import StandoffError
from standoff.motion import Pose
from standoff.recording import Recording
from standoff.scene import Scene
from standoff.scene.run import record
from standoff.tracking import PaperLaw
from standoff.view import laws
from standoff.view.live_pair import LivePair
from standoff.view.motion_panel import Later
from standoff.view.pair_stage import PairStage, moving_body
from standoff.view.panel import Panel
from standoff.view.picture import Picture
from standoff.view.player import Player
from standoff.view.pull import LEAST_FORCE, MAX_FORCE, Pull
from standoff.view.server import name_tab
from standoff.view.shown import ShownPair, of_answer, of_frame


class Stage(PairStage[Recording]):
    """A scene as a page shows it.

    Raises StandoffError: what tracking the scene raises; then nothing on the page is changed.

    Parameters
    ----------
    panel : Panel
    server, later : as for `MotionPanel`
    scene : Scene
    max_force : float
        Greatest force of the coupler [N].

    Attributes
    ----------
    max_force : float
        As it was lowered since [N].
    pair : LivePair
        What is dragged.
    player : Player or None
        What is played; None where nothing moves by itself.
    picture : Picture
    """

    def __init__(
        self,
        server: Any,
        panel: Panel,
        later: Later,
        scene: Scene,
        max_force: float = MAX_FORCE,
    ) -> None:
        self._server = server
        self.panel: Panel = panel
        self._settings = scene.settings
        self._dt = laws.frame_time(scene)
        start = scene.instant()
        poses = [Pose.of(motion.path.pose(start)) for motion in scene.pair_motions]
        home = poses[0], poses[1]
        self.pair: LivePair = LivePair(*scene.pair_bodies, home, scene.settings.law, self._dt)
        self.player = Player(record(scene)) if laws.moves(scene) else None
        self._begin(scene, self.pair.poses)
        self._pull: Pull | None = None
        self.max_force = max_force
        # All that may be refused has been asked: now the page changes.
        self.picture: Picture = Picture(server, self.pair.bodies, scene.length_unit)
        self._listen(self.picture.handles, later)
        self.picture.aim(self.pair.poses)
        which = "AB"[moving_body(scene)]
        panel.pull_is(False, max_force)
        unit, size = scene.length_unit, self.picture.size
        panel.begin(scene.title, self.player, which, scene.pair, unit, size)
        name_tab(server, scene.title)
        self._tell_law()
        self.hand(which)
        self._show_pair()

    def hand(self, which: str) -> None:
        """Give the handle to A, to B or to nothing."""
        super().hand(which)
        if self._pull is not None and self._pull.number != self._hand:
            self._let_go()

    def pull(self, on: bool) -> None:
        """Pull the dragged body through the virtual coupler, or carry it.

        Raises StandoffError if nothing is dragged, or the pair cannot be simulated.
        """
        self._let_go()
        if not on:
            return
        if self._hand is None:
            raise StandoffError(
                "No body is being dragged, so nothing can be pulled: choose one under 'drag'."
            )
        if not self._by_hand:
            self._take_in_hand()
        size = self.picture.shapes[self._hand].size
        self._pull = Pull(self.pair, self._hand, size, self.max_force)
        self._wanted = self.pair.poses
        self.panel.pull_is(True, self.max_force)
        self.panel.strayed(True)

    def limit(self, force: float) -> None:
        """Lower the coupler's greatest force [N]; one above the present one is ignored."""
        lowered = max(min(force, self.max_force), LEAST_FORCE)
        if lowered < self.max_force:
            self.max_force = lowered
            if self._pull is not None:
                self._pull.lower(lowered)
        self.panel.pull_is(self._pull is not None, self.max_force)

    def _let_go(self) -> None:
        if self._pull is not None:
            self.picture.pull(np.zeros(3), np.zeros(3), 1.0)
            self._wanted = self.pair.poses
        self._pull = None
        self.panel.pull_is(False, self.max_force)

    def law(self, name: str, integrator: str, share: float) -> None:
        """Follow another law, with a share of the greatest stable gain.

        Raises StandoffError if the pair cannot be tracked by it; all is as it was then.
        """
        try:
            settings = laws.with_law(self._settings, name, integrator, share, self._dt)
            recording = None if self.player is None else record(self.scene, settings)
            self.pair.follow(settings.law)
        except StandoffError:
            self._tell_law()
            raise
        self._settings = settings
        if self.player is not None and recording is not None:
            self.player.recording = recording
        self._tell_law()
        self.panel.forget()

    def look(self, elapsed: float) -> None:
        """Let a time pass [s], and show what has changed."""
        if self._by_hand:
            self._follow(elapsed)
        elif self.player is not None and self.player.playing:
            before = self.player.frame
            self.player.advance(elapsed)
            self._note_switches(self.player, before)
            self._show_frame(self.player)

    def _follow(self, elapsed: float) -> None:
        """Move the dragged body on; a law that has not settled goes on settling."""
        self._clock += elapsed
        settled = self.pair.answer.certified or self.pair.answer.status.penetrating
        if self._pull is None and self._wanted is self.pair.poses and settled:
            self.panel.rests()
            return
        try:
            events = self.pair.move(self._next_poses(elapsed), elapsed)
        except Exception:  # else it would be met again at every look
            self._wanted = self.pair.poses
            raise
        for event in events:
            self.panel.switched(self._clock, self._name(event.body), event.source, event.target)
        shown = of_answer(self.pair.answer, self.pair.poses)
        self._show(shown)
        self.panel.traces(self._clock, shown)

    def _next_poses(self, elapsed: float) -> tuple[Pose, Pose]:
        """Where the hand wants the bodies, or where the coupler has pulled the tool."""
        if self._pull is None:
            return self._wanted
        number = self._pull.number
        try:
            tool = self._pull.step(self._wanted[number], elapsed)
        except StandoffError:
            self._let_go()
            raise
        if self._pull.fault:
            fault = self._pull.fault
            self._let_go()
            raise StandoffError(f"The coupler let go: {fault}")
        self.picture.pull(tool.translation, self._pull.force, MAX_FORCE)
        return (tool, self._wanted[1]) if number == 0 else (self._wanted[0], tool)

    def _played(self, player: Player[Recording]) -> tuple[Pose, Pose]:
        return of_frame(player.recording, player.frame).poses

    def _note_switches(self, player: Player[Recording], before: int) -> None:
        for event in player.recording.events:
            if before < event.frame <= player.frame:
                name = self._name(event.body)
                self.panel.switched(event.time, name, event.source, event.target)

    def _name(self, body: str) -> str:
        return self.scene.pair["AB".index(body)]

    def _show_frame(self, player: Player[Recording]) -> None:
        self._show(of_frame(player.recording, player.frame))
        self.panel.plays(player)

    def _show_pair(self) -> None:
        self._show(of_answer(self.pair.answer, self.pair.poses))

    def _show(self, shown: ShownPair) -> None:
        with self._server.atomic():
            pull = self._pull
            held = self._held if pull is None else pull.number
            force = None if pull is None else float(np.linalg.norm(pull.force))
            self.picture.show(shown, held=held)
            self.panel.show(shown, force)

    def _tell_law(self) -> None:
        resolved = self.pair.tracker.resolved_law
        gain = resolved.gain if isinstance(resolved, PaperLaw) else None
        self.panel.law_is(*laws.chosen(self._settings, self._dt), gain)
