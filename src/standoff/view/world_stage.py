"""One world on the page: where its bodies are, and what is known there."""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.tracking import Status
from standoff.view.clearance_matrix import matrix_picture
from standoff.view.motion_panel import Later
from standoff.view.moving_world import LiveWorld, MovingWorld, WorldCourse, course_of, known_of
from standoff.view.pair_stage import placed
from standoff.view.played_stage import PlayedStage
from standoff.view.player import Player
from standoff.view.server import name_tab
from standoff.view.world_panel import WorldPanel
from standoff.view.world_picture import WorldPicture
from standoff.view.world_readout import world_readout
from standoff.world import World

MATRIX_PERIOD = 0.4
"""Least time between two matrices [s]: more often they are not read, and they cost the most."""

MOST_COUNTED = 1000
"""Bodies of a world up to which its pairs are counted, one by one: half a million."""


class WorldStage(PlayedStage[WorldCourse]):
    """A world as a page shows it.

    Raises StandoffError: what the world refuses.

    Parameters
    ----------
    panel : WorldPanel
    server, later : as for `MotionPanel`
    given : MovingWorld

    Attributes
    ----------
    live : LiveWorld
        What is shown.
    player : Player or None
        What is played; None where nothing moves by itself.
    picture : WorldPicture
    """

    def __init__(
        self,
        server: Any,
        panel: WorldPanel,
        later: Later,
        given: MovingWorld,
    ) -> None:
        self.given, self._server, self._later = given, server, later
        self.panel: WorldPanel = panel
        world = given.world
        self.live = LiveWorld(world, given.poses(float(given.times[0])))
        self.player: Player[WorldCourse] | None = Player(course_of(given)) if given.moves else None
        self._home = self._wanted = self._there = self.live.poses
        self._by_hand = self.player is None
        self._clock = self._since = 0.0
        self._held = False
        self._hand: int | None = None
        self._drawn_matrix: Any = None
        self._count = len(list(world.pairs())) if len(world) <= MOST_COUNTED else None
        self.picture = WorldPicture(server, world, given.unit)
        self.end = _scale_end(world, self.live, self.picture.size)
        self.picture.aim(self.live.answer.state.poses)
        panel.begin(given.title, self.player, self.picture.size)
        name_tab(server, given.title)
        self._show()
        # Of an arm, the last that moves is its hand.
        self.hand(len(world.moving) - 1)
        self._refresh_matrix()

    @property
    def title(self) -> str:
        """The scene's."""
        return self.given.title

    def hand(self, number: int | None) -> None:
        """Give the handle to one of the moving bodies, by its number among them, or to nothing."""
        rows = self.given.world.model.moving_rows
        self._hand = number if number is not None and 0 <= number < len(rows) else None
        self._held = False
        self.panel.hand_is(self._hand)
        if self._hand is None:
            self.picture.give_handle(None)
            return
        chosen = self._hand

        async def moved(event: Any) -> None:
            held, phase = event.target, event.phase
            wxyz, position = np.array(held.wxyz), np.array(held.position)
            self._later(lambda: self._drag(chosen, wxyz, position, held=phase != "end"))

        self.picture.give_handle(int(rows[chosen]), moved)

    def back(self) -> None:
        """Put the bodies back to where the scene has them; in a motion, at its present time."""
        if self.player is not None:
            self._play_on()
            self._show_frame(self.player)
            return
        self._wanted = self._there = self._home
        self._held, self._clock = False, 0.0
        self.live.move(self._home)
        self.panel.forget()
        self.panel.strayed(False)
        self._show()

    def look(self, elapsed: float) -> None:
        """Let a time pass [s], and show what has changed."""
        super().look(elapsed)
        self._since += elapsed
        if self._since >= MATRIX_PERIOD:
            self._refresh_matrix()

    def _follow(self, elapsed: float) -> None:
        """Put the dragged body where it is wanted; a law that has not settled goes on settling."""
        self._clock += elapsed
        if self._wanted is self._there and not self._lags():
            self.panel.rests()
            return
        wanted = self._wanted
        try:
            self.live.move(wanted)
        except Exception:  # else it would be met again at every look
            self._wanted = self._there = self.live.poses
            raise
        self._there = wanted
        self._show()
        self.panel.traces(self._clock, known_of(self.live.answer))

    def _lags(self) -> bool:
        return bool((self.live.answer.pairs.status == Status.TRACKING).any())

    def _drag(self, number: int, wxyz: Any, position: Any, *, held: bool = False) -> None:
        if number != self._hand:  # what an earlier handle still sent
            return
        self._held = held
        if not self._by_hand:
            self._take_in_hand()
        poses = self._wanted.copy()
        poses[number] = placed(wxyz, position, self.picture.planar).matrix
        self._wanted = poses
        self.panel.strayed(True)

    def _take_in_hand(self) -> None:
        """Go from the motion to the hand, where the motion stands."""
        if self.player is not None:
            self.player.playing = False
            self.panel.plays(self.player)
        self._wanted = self._there = self.live.poses
        self.panel.forget()
        self._by_hand, self._clock = True, 0.0

    def _play_on(self) -> None:
        """Go from the hand to the motion."""
        if self._by_hand:
            self._by_hand, self._held = False, False
            self.panel.forget()
            self.panel.strayed(False)

    def _show_frame(self, player: Player[WorldCourse]) -> None:
        self.live.move(self.given.poses(float(player.recording.time[player.frame])))
        self._show()
        self.panel.plays(player)

    def _show(self) -> None:
        answer = self.live.answer
        text = world_readout(answer, self.given.unit, self.picture.size, self._count)
        with self._server.atomic():
            self.picture.show(answer, self.end, held=self._held)
            self.panel.show(text, known_of(answer))

    def _refresh_matrix(self) -> None:
        answer = self.live.answer
        if self._drawn_matrix is not answer:
            self.panel.matrix(matrix_picture(answer, self.given.unit, self.end))
            self._drawn_matrix, self._since = answer, 0.0


def _scale_end(world: World, live: LiveWorld, size: float) -> float:
    """The gap of the palest colour: the horizon, or the greatest distance at the beginning."""
    if np.isfinite(world.model.search.reach):
        return float(world.model.search.reach)
    greatest = float(live.answer.pairs.distance.max(initial=0.0))
    return greatest if greatest > 0.0 else size
