"""What a page's stage has that plays a motion: the recording it stands in, and how it is moved."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Generic

from standoff.view.motion_panel import MotionPanel
from standoff.view.player import Player, R


class PlayedStage(ABC, Generic[R]):
    """The part of a stage that plays; a subclass shows the frames.

    Attributes
    ----------
    panel : MotionPanel
    player : Player or None
        What is played; None where nothing moves by itself.
    """

    panel: MotionPanel
    player: Player[R] | None
    _by_hand = False

    def look(self, elapsed: float) -> None:
        """Let a time pass [s], and show what has changed."""
        if self._by_hand:
            self._follow(elapsed)
        elif self.player is not None and self.player.playing:
            self.player.advance(elapsed)
            self._show_frame(self.player)

    def _follow(self, elapsed: float) -> None:
        """Show what was moved by hand in a time [s]."""

    def play(self, playing: bool) -> None:
        """Play the motion, or pause."""
        if self.player is not None:
            self.player.playing = playing
            self._play_on()
            self.panel.plays(self.player)

    def seek(self, time: float) -> None:
        """Show the motion at a time [s]."""
        if self.player is not None:
            self.player.seek(time)
            self._play_on()
            self._show_frame(self.player)

    def speed(self, factor: float) -> None:
        """Play this many times as fast as the motion."""
        if self.player is not None:
            self.player.speed = factor

    @abstractmethod
    def _play_on(self) -> None:
        """Go from the hand to the motion."""

    @abstractmethod
    def _show_frame(self, player: Player[R]) -> None:
        """Show the frame at which the player stands."""
