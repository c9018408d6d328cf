"""What the panels of all pairs have: a motion that is played, and a body that is dragged."""

from __future__ import annotations

from typing import Any, Protocol

from standoff.view.motion_panel import Later, MotionPanel, Plays
from standoff.view.player import Player
from standoff.view.tolerances import MAX_TEXT

HANDS = ("A", "B", "nothing")


class Hands(Plays, Protocol):
    """What a user of the page of a pair can ask for."""

    def hand(self, which: str) -> None: ...
    def back(self) -> None: ...


class PairPanel(MotionPanel):
    """The part of a pair's panel that moves it; a subclass says where it stands.

    Parameters
    ----------
    server, later : as for `MotionPanel`
    asks : Hands
    """

    def __init__(self, server: Any, later: Later, asks: Hands) -> None:
        super().__init__(server, later, asks)
        self._hands = asks
        self._names, self._unit, self._size = ("A", "B"), "", 1.0

    def _make_hand(self) -> None:
        gui = self._gui
        self._hand = gui.add_dropdown("drag", HANDS, initial_value="A")
        self._back = gui.add_button("Back to the scene's poses", visible=False)

        @self._hand.on_update
        async def _(event: Any) -> None:
            options, value = tuple(self._hand.options), event.target.value
            if event.client is not None and value in options:
                which = HANDS[options.index(value)]
                self._later(lambda: self._hands.hand(which))

        @self._back.on_click
        async def _(_: Any) -> None:
            self._later(self._hands.back)

    def begin(
        self,
        title: str,
        player: Player[Any] | None,
        which: str,
        names: tuple[str, str],
        unit: str,
        size: float,
    ) -> None:
        """Set the panel up for a scene.

        Parameters
        ----------
        title : str
        player : Player or None
        which : str
            Of A and B the one that is dragged.
        names : (str, str)
            Of both bodies.
        unit : str
            Label of lengths.
        size : float
            Of the bodies, in that unit.
        """
        self._names, self._unit, self._size = names, unit, size
        self._gui.set_panel_label(title)
        self._moves(player)
        # A name is cut to what a message may hold; its letter keeps the two apart then.
        hands = [
            f"{name[: MAX_TEXT - 4]} ({letter})" for name, letter in zip(names, "AB", strict=True)
        ]
        self._hand.options = (*hands, HANDS[-1])
        self._hand.value = hands["AB".index(which)]
        self.strayed(False)
        self._plot.begin(size)
        self.forget()

    def strayed(self, off: bool) -> None:
        """Show whether bodies are elsewhere than the scene says, so that there is a way back."""
        self._back.visible = off

    def forget(self) -> None:
        """Empty the plot."""
        self._plot.forget()

    def rests(self) -> None:
        """Show the plot up to where the hand has stopped."""
        self._plot.rests()
