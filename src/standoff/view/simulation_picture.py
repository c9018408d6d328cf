"""The bodies of a simulation with all their contacts in viser's scene."""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.simulation.rigid_body import FIXED, FREE
from standoff.simulation.units import Units
from standoff.view.bodies_picture import FIXED_COLOURS, BodiesPicture
from standoff.view.contact_nodes import LONGEST, Arrows, ContactNodes
from standoff.view.contact_readout import force_texts
from standoff.view.nodes import COLOURS
from standoff.view.shown_simulation import Instant, Simulated

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
