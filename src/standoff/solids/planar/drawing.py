"""What a DXF drawing becomes: its solids, with their unit and what was found."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import overload

from standoff.checks.units import lengths_told
from standoff.solids.planar.solid import PlanarSolid
from standoff.wording import counted


@dataclass(frozen=True, eq=False)
class Drawing(Sequence[PlanarSolid]):
    """The solids of a DXF drawing, in its order; itself a sequence of them.

    Attributes
    ----------
    solids : tuple of PlanarSolid
        Their names are the file's, with a number from the second on.
    unit : str
        Of their lengths; empty where the file does not tell.
    file_unit : str
        That of the file; lengths were converted if it differs. Empty where it does not tell, or
        where `scale` was given in its place.
    source : str
        The file's name.
    notes : tuple of str
        What was joined, by how much at most, and what was added to the file to read it.
    """

    solids: tuple[PlanarSolid, ...]
    unit: str
    file_unit: str
    source: str
    notes: tuple[str, ...] = ()

    def __len__(self) -> int:
        return len(self.solids)

    @overload
    def __getitem__(self, key: int) -> PlanarSolid: ...

    @overload
    def __getitem__(self, key: slice) -> tuple[PlanarSolid, ...]: ...

    def __getitem__(self, key: int | slice) -> PlanarSolid | tuple[PlanarSolid, ...]:
        return self.solids[key]

    def report(self) -> str:
        """What was found, as text."""
        told = lengths_told(self.unit, self.file_unit)
        lines = [f"{self.source}: {counted(len(self), 'planar solid')}, {told}"]
        return "\n".join([*lines, *(f"  {note}" for note in self.notes), *map(self._line, self)])

    def _line(self, solid: PlanarSolid) -> str:
        after = f" {self.unit}" if self.unit else ""
        edges, loops = counted(solid.n_edges, "edge"), counted(len(solid.loops), "loop")
        return (
            f"{solid.name}: {edges} in {loops}; size {solid.size:.6g}{after}, area "
            f"{solid.area:.9g}, to {solid.area_error:.2g}; slack {solid.slack:.3g}{after}"
        )
