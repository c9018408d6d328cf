"""A switch that an automaton allows, from one feature of a body to another one."""

from __future__ import annotations

from typing import Literal, NamedTuple

from standoff.bodies.features import Feature

Kind = Literal["boundary", "smooth", "release"]


class Transition(NamedTuple):
    """A switch that one body's automaton allows.

    Attributes
    ----------
    body : "A" or "B"
    source, target : Feature
    kind : "boundary", "smooth" or "release"
        A step reaches the end of a feature; it reaches a smooth edge and continues on the next
        face; or, at rest, the distance falls into a larger feature, which is the Voronoi test.
        None where it is not known: of solids, several boundaries between two frames, or two faces
        of a solid that is not at hand.
    switching : str
        When it is taken. n is the unit vector from A to B, and −ε the least slope that counts.
        Empty where it is not known.
    reset : str
        What the parameters become.
    """

    body: str
    source: Feature
    target: Feature
    kind: Kind | None
    switching: str
    reset: str
