"""What a tracker of solids carries from frame to frame."""

from __future__ import annotations

from standoff.read_only import KeepsReadOnly
from standoff.shown_names import hides
from standoff.solids.answer import SolidProximity
from standoff.solids.spatial.solid_model import SolidModel
from standoff.solids.tracked.front import KeptFront


@hides("front")
class SolidState(KeepsReadOnly):
    """What a tracker of solids carries from frame to frame, as a value: it is never changed.

    Attributes
    ----------
    proximity : SolidProximity
        The answer at the frame of this state.
    born : int
        How many branches of local minima there have been since the start.
    rows : int
        Pairs of pieces whose bounds are kept; 0 after a frame in which the solids meet.
    """

    __slots__ = ("_pair", "born", "front", "proximity")

    def __init__(
        self,
        proximity: SolidProximity,
        pair: tuple[SolidModel, SolidModel],
        front: KeptFront | None,
        born: int = 0,
    ) -> None:
        self.proximity, self._pair, self.front, self.born = proximity, pair, front, born

    @property
    def rows(self) -> int:
        return int(self.front.store[0]) if self.front else 0

    def __repr__(self) -> str:
        return f"<SolidState of {self.rows} rows: {self.proximity!r}>"
