"""What the stages of all pairs have: a motion that is played, or bodies that follow a hand."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterable
from typing import Any, Protocol

import numpy as np

from standoff.motion import Fixed, Pose
from standoff.scene import Scene
from standoff.view.motion_panel import Later
from standoff.view.pair_panel import PairPanel
from standoff.view.picture import PairPicture
from standoff.view.played_stage import PlayedStage
from standoff.view.player import Player, R

Poses = tuple[Pose, Pose]


class StillPair(Protocol):
    """A pair that is where it is put."""

    @property
    def poses(self) -> Poses:
        """Of A and B."""

    def restart(self, poses: Poses) -> None:
        """Start again at poses, as after a leap."""


class PairStage(PlayedStage[R]):
    """The part of a pair's stage that moves it; a subclass shows what is known of it.

    Attributes
    ----------
    scene : Scene
    panel : PairPanel
    picture : PairPicture
    pair : StillPair
        What is dragged.
    player : Player or None
        What is played; None where nothing moves by itself.
    """

    scene: Scene
    panel: PairPanel
    picture: PairPicture
    pair: StillPair

    def _begin(self, scene: Scene, poses: Poses) -> None:
        """Stand at a scene's poses."""
        self.scene = scene
        self._home = self._wanted = poses
        self._by_hand = self.player is None
        self._clock = 0.0
        self._held: int | None = None
        self._hand: int | None = moving_body(scene)

    @property
    def title(self) -> str:
        """The scene's."""
        return self.scene.title

    def _listen(self, handles: Iterable[Any], later: Later) -> None:
        for number, handle in enumerate(handles):
            self._listen_to(number, handle, later)

    def _listen_to(self, number: int, handle: Any, later: Later) -> None:
        @handle.on_update
        async def _(event: Any) -> None:
            held, phase = event.target, event.phase
            wxyz, position = np.array(held.wxyz), np.array(held.position)
            later(lambda: self._drag(number, wxyz, position, held=phase != "end"))

    def hand(self, which: str) -> None:
        """Give the handle to A, to B or to nothing."""
        self._hand = "AB".index(which) if which in "AB" else None
        for name, handle in zip("AB", self.picture.handles, strict=True):
            handle.visible = name == which

    def back(self) -> None:
        """Put the bodies back to where the scene has them; in a motion, at its present time."""
        if self.player is not None:
            self._play_on()
            self._show_frame(self.player)
            return
        self._let_go()
        self.pair.restart(self._home)
        self._wanted, self._held, self._clock = self._home, None, 0.0
        self.panel.forget()
        self.panel.strayed(False)
        self._show_pair()

    def _drag(self, number: int, wxyz: Any, position: Any, *, held: bool = False) -> None:
        self._held = number if held else None
        if not self._by_hand:
            self._take_in_hand()
        poses = list(self._wanted)
        poses[number] = placed(wxyz, position, self.picture.planar)
        self._wanted = poses[0], poses[1]
        self.panel.strayed(True)

    def _take_in_hand(self) -> None:
        """Go from the motion to the hand, where the motion stands."""
        if self.player is not None:
            self.player.playing = False
            self.panel.plays(self.player)
            self.pair.restart(self._played(self.player))
            self._wanted = self.pair.poses
        self.panel.forget()
        self._by_hand, self._clock = True, 0.0

    def _play_on(self) -> None:
        """Go from the hand to the motion."""
        if self._by_hand:
            self._let_go()
            self._by_hand, self._held = False, None
            self.panel.forget()
            self.panel.strayed(False)

    @abstractmethod
    def _played(self, player: Player[R]) -> Poses:
        """Return where the bodies are in the frame at which the player stands."""

    @abstractmethod
    def _show_pair(self) -> None:
        """Show the pair that is dragged."""

    @abstractmethod
    def _let_go(self) -> None:
        """Let nothing but the hand move the pair."""


def moving_body(scene: Scene) -> int:
    """Return the number of the body that a scene moves: 1 where it moves B alone."""
    still = [isinstance(motion.path, Fixed) for motion in scene.pair_motions]
    return 1 if still[0] and not still[1] else 0


def placed(wxyz: Any, position: Any, planar: bool) -> Pose:
    """Return the pose of a handle; of a planar pair its part in the plane."""
    pose = Pose.from_wxyz(np.asarray(wxyz) / np.linalg.norm(wxyz), position)
    if not planar:
        return pose
    turn = np.arctan2(pose.rotation[1, 0], pose.rotation[0, 0])
    return Pose.exp([0.0, 0.0, turn], [pose.translation[0], pose.translation[1], 0.0])
