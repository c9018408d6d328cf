"""The live page of a robot: that of its world, moved by the joints."""

from __future__ import annotations

import io
import math
from base64 import b64encode
from collections.abc import Sequence
from html import escape
from typing import Any, Protocol

from standoff.errors import of_extra
from standoff.robots.proof import PathProof
from standoff.robots.shown_robot import ShownRobot
from standoff.typing import Array
from standoff.view.motion_panel import Later
from standoff.view.moving_world import WorldCourse
from standoff.view.player import Player
from standoff.view.served import ServedPage
from standoff.view.world_panel import WorldPanel, WorldRequests
from standoff.view.world_stage import WorldStage

STEPS = 1000
"""Steps of a slider, at least."""

PROOF_WIDTH, DOTS = 4.0, 160
"""Width of a proof's picture, inches, and its dots per inch: it stands in a panel of 300 pixels,
and is sharp on a screen of twice as many."""

PROOF_ROWS = 10
"""Pairs whose steps are drawn: the controls stay in sight."""

PROOF = (
    '<figure data-of="proof" style="margin:.4em .6em;font-size:.8em">'
    '<img alt="{0}" style="width:100%;background:white" src="data:image/png;base64,{1}">'
    "<figcaption>{0}</figcaption></figure>"
)


class JointAsks(WorldRequests, Protocol):
    """What a user of the page can ask for."""

    def turn(self, number: int, value: float) -> None: ...


class RobotPanel(WorldPanel):
    """The panel of a world, with sliders for the joints in place of a handle.

    Parameters
    ----------
    server, later : as for `MotionPanel`
    asks : JointAsks
    shown : ShownRobot
    """

    def __init__(
        self,
        server: Any,
        later: Later,
        asks: JointAsks,
        shown: ShownRobot,
    ) -> None:
        self._shown, self._turns = shown, asks.turn
        self._picture = "" if shown.proof is None else proof_picture(shown.proof)
        super().__init__(server, later, asks, ())

    def _make_hand(self, moving: Sequence[str]) -> None:
        gui = self._gui
        stands = self._shown.path is None
        to = "first configuration" if stands else "path"
        self._back = gui.add_button(f"Back to the {to}", visible=False)
        if self._picture:
            gui.add_html(self._picture)
        with gui.add_folder("joints", expand_by_default=stands):
            self._sliders = [self._slider(number) for number in range(len(self._shown.sliders))]

        @self._back.on_click
        async def _(_: Any) -> None:
            self._later(self._asks.back)

    def _slider(self, number: int) -> Any:
        joint = self._shown.sliders[number]
        step = 10.0 ** math.floor(math.log10((joint.high - joint.low) / STEPS))
        place = joint.read(self._shown.first)
        made = self._gui.add_slider(joint.name, joint.low, joint.high, step, place)

        @made.on_update
        async def _(event: Any) -> None:
            if event.client is not None:
                value = float(event.target.value)
                self._later(lambda: self._turns(number, value))

        return made

    def joints_are(self, q: Array) -> None:
        """Show a configuration."""
        for joint, slider in zip(self._shown.sliders, self._sliders, strict=True):
            slider.value = joint.read(q)


class RobotStage(WorldStage):
    """A robot's world as a page shows it: played along a path, or moved joint by joint.

    Parameters
    ----------
    panel : RobotPanel
    server, later : as for `MotionPanel`
    shown : ShownRobot

    Attributes
    ----------
    q : (nq,) array
        The configuration that is shown.
    """

    panel: RobotPanel

    def __init__(
        self,
        server: Any,
        panel: RobotPanel,
        later: Later,
        shown: ShownRobot,
    ) -> None:
        self.shown, self.q = shown, shown.first
        super().__init__(server, panel, later, shown.world)

    def hand(self, number: int | None) -> None:
        """Give no body the handle: a robot's bodies are moved by its joints."""

    def turn(self, number: int, value: float) -> None:
        """Put one of the joints that have a slider elsewhere, rad or length."""
        if not self._by_hand:
            self._take_in_hand()
        self.q = self.shown.sliders[number].put(self.q, value)
        self._wanted = self.shown.robot.kinematics.poses(self.q)
        self.panel.strayed(True)

    def back(self) -> None:
        """Go back to the first configuration, or to the path at its present time."""
        super().back()
        if self.player is None:
            self._stands_at(self.shown.first)

    def _show_frame(self, player: Player[WorldCourse]) -> None:
        super()._show_frame(player)
        self._stands_at(self.shown.at(float(player.recording.time[player.frame])))

    def _stands_at(self, q: Array) -> None:
        self.q = q
        self.panel.joints_are(q)


class RobotPage(ServedPage):
    """A robot in the browser.

    Raises ModuleNotFoundError if matplotlib is not installed, for a proof; and as `ServedPage`.

    Parameters
    ----------
    shown : ShownRobot
    host, port : as for `ServedPage`
    """

    def __init__(
        self, shown: ShownRobot, *, host: str = "127.0.0.1", port: int | None = None
    ) -> None:
        super().__init__(host=host, port=port)
        with self._opening():
            self.panel = RobotPanel(self.server, self._asked.put, self, shown)
            self.stage: RobotStage = RobotStage(self.server, self.panel, self._asked.put, shown)

    def hand(self, number: int | None) -> None:
        """Give no body the handle."""

    def turn(self, number: int, value: float) -> None:
        """Put one of the joints that have a slider elsewhere, by its number; rad or length."""
        self.stage.turn(number, value)


def proof_picture(proof: PathProof) -> str:
    """Return the picture of a proof as HTML."""
    with of_extra("", "plot"):
        from standoff.robots.proof_plot import proof_figure
    file = io.BytesIO()
    figure = proof_figure(proof, width=PROOF_WIDTH, most=PROOF_ROWS)
    figure.savefig(file, format="png", dpi=DOTS)
    return PROOF.format(escape(str(proof)), b64encode(file.getvalue()).decode())
