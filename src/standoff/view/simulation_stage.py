"""A simulation on the page: a run that is played, or a system that is stepped."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from typing import Any

import numpy as np

from standoff.simulation.operator import Operator
from standoff.simulation.rigid_body import FIXED, FREE
from standoff.simulation.system_run import SystemRun
from standoff.simulation.system_state import SystemState
from standoff.simulation.units import Units
from standoff.view.bodies_picture import FIXED_COLOURS, BodiesPicture
from standoff.view.contact_nodes import LONGEST, Arrows, ContactNodes
from standoff.view.contact_readout import (
    contacts_list,
    energy_table,
    force_texts,
    simulation_readout,
)
from standoff.view.nodes import COLOURS
from standoff.view.played_stage import PlayedStage
from standoff.view.player import Player
from standoff.view.server import name_tab
from standoff.view.shown_simulation import (
    Instant,
    Simulated,
    SimulationCourse,
    course_of,
    instant_of,
    usual_force,
)
from standoff.view.simulation_panel import SimulationPanel

LOOK = 0.05
"""Time that the steps between two looks may take [s]: what is slower falls behind its clock."""


PACE = 0.95
"""Part of the steps that were asked from which on a system keeps up."""


class SimulationStage(ABC):
    """A simulation as a page shows it.

    Parameters
    ----------
    server : viser.ViserServer
    panel : SimulationPanel
    given : Simulated
    first : Instant
    usual : float
        Force that arrows are made for [force].

    Attributes
    ----------
    instant : Instant
        What is shown.
    picture : SimulationPicture
    """

    panel: SimulationPanel

    def __init__(
        self, server: Any, panel: SimulationPanel, given: Simulated, first: Instant, usual: float
    ) -> None:
        self._server, self.panel, self.given = server, panel, given
        self.usual, self.instant = usual, first
        self.picture = SimulationPicture(server, given)
        self.picture.aim(first.poses)
        name_tab(server, given.title)

    @property
    def title(self) -> str:
        """The scene's."""
        return self.given.title

    def glass(self, on: bool) -> None:
        """Show all bodies as if of glass, or only those that never move."""
        self.picture.glass = on
        self._show(self.instant)

    def stretch(self, factor: float) -> None:
        """Draw the arrows of forces so many times as long as usual."""
        self.picture.stretch = factor
        self._show(self.instant)

    def _show(self, instant: Instant, more: str = "") -> None:
        self.instant = instant
        arrows = self.picture.arrows(self.usual)
        texts = (
            simulation_readout(instant, self.given, arrows, more),
            contacts_list(instant, self.given),
            energy_table(instant.energy, Units.of(self.given.unit)),
        )
        with self._server.atomic():
            self.picture.show(instant, arrows)
            self.panel.show(texts, instant)

    @abstractmethod
    def step(self) -> None:
        """Show what comes next: a record, or a step of the system."""


class RunStage(SimulationStage, PlayedStage[SimulationCourse]):
    """A run that is played.

    Parameters
    ----------
    server : viser.ViserServer
    panel : SimulationPanel
    given : Simulated
    run : SystemRun
        It has kept its contacts.

    Attributes
    ----------
    player : Player
    """

    panel: SimulationPanel
    player: Player[SimulationCourse]

    def __init__(
        self, server: Any, panel: SimulationPanel, given: Simulated, run: SystemRun
    ) -> None:
        course = course_of(run)
        usual = usual_force(run.system, course.greatest)
        super().__init__(server, panel, given, instant_of(run, 0), usual)
        self.player = Player(course)
        panel.begin(given.title, self.player, usual)
        self._show(self.instant)

    def look(self, elapsed: float) -> None:
        """Let a time pass [s], and show what has changed."""
        if self.player.playing:
            self.player.advance(elapsed)
            self._show_frame(self.player)

    def step(self) -> None:
        """Show the next record, and pause."""
        times = self.player.recording.time
        self.player.playing = False
        self.seek(float(times[min(self.player.frame + 1, len(times) - 1)]))

    def back(self) -> None:
        """Show the first record."""
        self.seek(self.player.first)

    def _play_on(self) -> None:
        """Nothing is moved by hand."""

    def _show_frame(self, player: Player[SimulationCourse]) -> None:
        self._show(instant_of(player.recording.run, player.frame))
        self.panel.plays(player)


class SteppedStage(SimulationStage):
    """A system that is stepped.

    Parameters
    ----------
    server : viser.ViserServer
    panel : SimulationPanel
    given : Simulated
    operator : Operator
    state : SystemState
        Where it begins.

    Attributes
    ----------
    state : SystemState
        Where it stands.
    playing : bool
    """

    def __init__(
        self,
        server: Any,
        panel: SimulationPanel,
        given: Simulated,
        operator: Operator,
        state: SystemState,
    ) -> None:
        self.operator, self.state, self._home = operator, state, state
        self.playing, self._speed, self._owed, self._pace = False, 1.0, 0.0, 1.0
        self._cost = LOOK
        first = self._first()
        super().__init__(
            server, panel, given, first, usual_force(operator.system, [first.greatest])
        )
        panel.begin(given.title, None, self.usual)
        self._show(first)

    def _first(self) -> Instant:
        """What is known before any step: the beginning of a run of one."""
        ticks = self.operator.ticks_a_reading
        return instant_of(self.operator.run(self._home, ticks, ticks, contacts=True), 0)

    def play(self, playing: bool) -> None:
        """Go on by itself, or pause."""
        self.playing, self._owed = playing, 0.0
        self.panel.playing_is(playing)
        self.panel.rests()

    def seek(self, time: float) -> None:
        """A system that is stepped has no other times than now."""

    def speed(self, factor: float) -> None:
        """Go this many times as fast as the clock, as far as that can be computed."""
        self._speed = factor

    def step(self) -> None:
        """Take one step, and pause."""
        self.play(False)
        self._advance(1)
        self.panel.rests()

    def back(self) -> None:
        """Stand at the beginning."""
        self.state = self._home
        self.play(False)
        self.panel.forget()
        self._show(self._first())

    def look(self, elapsed: float) -> None:
        """Let a time pass [s], and show what has changed."""
        if not self.playing:
            return
        a_step = self.operator.dt * self.operator.ticks_a_reading
        self._owed += self._speed * elapsed / a_step
        most = max(1, int(LOOK / self._cost))
        steps = min(int(self._owed), most)
        self._pace = min(1.0, steps / max(self._owed, 1.0))
        self._owed = min(self._owed - steps, 1.0)
        if steps:
            self._advance(steps)

    def _advance(self, steps: int) -> None:
        """Take steps, each of the ticks of one reading."""
        ticks = steps * self.operator.ticks_a_reading
        begun = time.perf_counter()
        try:
            run = self.operator.run(self.state, ticks, ticks, contacts=True)
        except Exception:  # else it would be met again at every look
            self.play(False)
            raise
        self._cost = (time.perf_counter() - begun) / steps
        self.state = run.final
        instant = instant_of(run, 1)
        if not self.given.system.gravity.any():
            self.usual = usual_force(self.given.system, [self.usual, instant.greatest])
        self._show(instant, f"{self._pace:.2g} of what is asked" if self._pace < PACE else "")
        self.panel.traces(instant)


# The bodies of a simulation with all their contacts in viser's scene.

RESTING = 1.0
"""Length of the arrow of the usual force, over the scene's size."""


class SimulationPicture(BodiesPicture):
    """What a server shows of a simulation; all else in its scene is taken away.

    Parameters
    ----------
    server : viser.ViserServer
    given : Simulated

    Attributes
    ----------
    glass : bool
        Whether all bodies are as if of glass, or only those that never move.
    stretch : float
        How much longer arrows are than usual.
    mark : float
        Of a usual body that is free [length].
    """

    def __init__(self, server: Any, given: Simulated) -> None:
        bodies = given.system.bodies
        colours = {FREE: COLOURS[0], FIXED: FIXED_COLOURS}
        kinds = [colours.get(body.kind, COLOURS[1]) for body in bodies]
        super().__init__(server, [body.body for body in bodies], kinds)
        self._given, self.glass, self.stretch = given, True, 1.0
        self._still = [body.kind == FIXED for body in bodies]
        free = np.array([body.kind == FREE for body in bodies])
        self.mark = float(np.median(self.sizes[free]))
        self._contacts = ContactNodes(server.scene, self.mark)

    def arrows(self, usual: float) -> Arrows:
        """How forces are drawn, where one is usual [force]."""
        return Arrows(RESTING * self.stretch * self.mark / usual, LONGEST * self.mark)

    def show(self, instant: Instant, arrows: Arrows) -> None:
        """Draw an instant."""
        self.place(instant.poses)
        for body, still in zip(self._bodies, self._still, strict=True):
            body.glass(self.glass or still)
        texts = force_texts(instant.contacts, Units.of(self._given.unit))
        self._contacts.show(instant.contacts, arrows, texts)
