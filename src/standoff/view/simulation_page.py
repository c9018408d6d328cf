"""The live page of a simulation."""

from __future__ import annotations

from standoff.simulation.system_run import SystemRun
from standoff.view.served import ServedPage
from standoff.view.shown_simulation import Simulated
from standoff.view.simulation_panel import SimulationPanel
from standoff.view.simulation_stage import RunStage, SteppedStage


class SimulationPage(ServedPage):
    """A simulation in the browser, with all its contacts: a run that is played, or a system that is
    stepped.

    Parameters
    ----------
    given : Simulated
    host, port : as for `ServedPage`, which raises the same
    """

    def __init__(
        self, given: Simulated, *, host: str = "127.0.0.1", port: int | None = None
    ) -> None:
        super().__init__(host=host, port=port)
        with self._opening():
            self.panel = SimulationPanel(self.server, self._asked.put, self)
            self.stage: RunStage | SteppedStage = _stage_of(self, given)

    def step(self) -> None:
        """Show what comes next: a record of a run, or a step of a system."""
        self.stage.step()

    def glass(self, on: bool) -> None:
        """Show all bodies as if of glass, or only those that never move."""
        self.stage.glass(on)

    def stretch(self, factor: float) -> None:
        """Draw the arrows of forces so many times as long as usual."""
        self.stage.stretch(factor)


def _stage_of(page: SimulationPage, given: Simulated) -> RunStage | SteppedStage:
    if isinstance(given.what, SystemRun):
        return RunStage(page.server, page.panel, given, given.what)
    return SteppedStage(page.server, page.panel, given, *given.what)
