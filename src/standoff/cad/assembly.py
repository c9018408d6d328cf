"""What a CAD file becomes: parts with their places, names and colours, and what was found."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from standoff.cad.finished import Finished
from standoff.checks.units import lengths_told
from standoff.wording import counted

if TYPE_CHECKING:
    from standoff.bodies.body import Body
    from standoff.bodies.boundary import Boundary
    from standoff.solids import Solid
    from standoff.typing import Array


@dataclass(frozen=True)
class PartReport:
    """What reading found about a part.

    Attributes
    ----------
    name : str
    faces : dict
        How many faces of the file there are by kind of surface.
    cut : int
        Faces that close on themselves, which were cut in two.
    trims : dict
        How many trimming curves are "exact", how many the "file"'s own (exactly as it has them),
        and how many "fitted".
    convex : bool
        Is it a `Body`?
    size, area, volume : float
        Diagonal of its box, length; area; volume.
    area_error, volume_error : float
        Difference from OpenCASCADE's, relative.
    slack : float
        How far its boundary may be from the file's, length: what its edges and trimming curves
        miss its surfaces by.
    trim_bound : float
        Proven bound of the part of it that comes from trimming curves, length.
    tolerance : float
        Greatest tolerance that the file gives an edge or a vertex, length.
    accuracy : float
        The one that the file states, length; 0 where it states none.
    allowed : float
        What its parts may miss each other by, length: the accuracy, four times the tolerance, or
        the ``tolerance`` that was asked for.
    self_intersections : tuple of str
        What was found of places where its boundary meets itself; empty of a convex part.
    healed : tuple of str
        What healing changed; empty unless it was asked for.
    refused : str
        Why there is no such part; empty if there is.
    notes : tuple of str
    seconds : float
        Time that it took.
    """

    name: str
    faces: dict[str, int]
    cut: int = 0
    trims: dict[str, int] | None = None
    convex: bool = False
    size: float = 0.0
    area: float = 0.0
    volume: float = 0.0
    area_error: float = 0.0
    volume_error: float = 0.0
    slack: float = 0.0
    trim_bound: float = 0.0
    tolerance: float = 0.0
    accuracy: float = 0.0
    allowed: float = 0.0
    self_intersections: tuple[str, ...] = ()
    healed: tuple[str, ...] = ()
    refused: str = ""
    notes: tuple[str, ...] = ()
    seconds: float = 0.0

    def claims(self) -> str:
        """What the file says of its accuracy."""
        stated = f"the file says {self.accuracy:.3g}" if self.accuracy else "the file says nothing"
        return f"{stated}, and OpenCASCADE's tolerance is {self.tolerance:.3g}"

    def lines(self, unit: str = "") -> list[str]:
        """The report in lines of text."""
        kinds = ", ".join(f"{n} {kind}" for kind, n in sorted(self.faces.items()))
        count = sum(self.faces.values())
        found = [f"{self.name}: {counted(count, 'face')} ({kinds})"]
        if self.refused:
            return [*found, f"  refused: {self.refused}"]
        after = f" {unit}" if unit else ""
        trims = ", ".join(f"{n} {how}" for how, n in sorted((self.trims or {}).items()))
        found += [
            f"  {'convex: a Body' if self.convex else 'not convex: a Boundary'}; "
            f"size {self.size:.6g}{after}, volume {self.volume:.6g}, area {self.area:.6g}",
            f"  slack {self.slack:.3g}{after}: its faces miss its edges by at most that (trims "
            f"within {self.trim_bound:.3g}); {self.claims()}",
            "  volume and area differ from OpenCASCADE's by "
            f"{self.volume_error:.1e} and {self.area_error:.1e}",
            f"  trimming curves: {trims or 'none'}; faces cut in two: {self.cut}; "
            f"{self.seconds:.2f} s",
        ]
        found += [f"  {one}" for one in self.self_intersections]
        found += [f"  healed: {one}" for one in self.healed]
        return found + [f"  {note}" for note in self.notes]


@dataclass(frozen=True, eq=False)
class Part:
    """A solid at its place in an assembly.

    Attributes
    ----------
    name : str
        Of the instance and its assemblies, such as "rod-assembly/NUT::1", as a person gave them;
        with a number where another part has it already.
    pose : (4, 4) array
        Of its frame in the assembly's.
    colour : (red, green, blue, opacity) or None
        Each within [0, 1], as in the file.
    report : PartReport
    finished : Finished
        What instances of one solid share.
    """

    name: str
    pose: Array
    colour: tuple[float, float, float, float] | None
    report: PartReport
    finished: Finished

    @property
    def shape(self) -> Boundary | Body:
        """In its own frame. Instances of one solid share it."""
        return self.finished.shape

    @property
    def solid(self) -> Solid:
        """The shape as a `Solid`, for distances of parts that need not be convex; they share it
        too."""
        return self.finished.solid

    @property
    def body(self) -> Boundary | Solid:
        """What a world takes: the shape where it is convex, a `Body`, else the solid."""
        return self.shape if self.report.convex else self.solid


@dataclass(frozen=True, eq=False)
class Assembly:
    """The parts of a CAD file.

    Attributes
    ----------
    parts : tuple of Part
    unit : str
        Of its lengths; empty where the file does not tell.
    file_unit : str
        That of the file; lengths were converted if it differs.
    source : str
        The file's name.
    refusals : tuple of str
        Parts left out because `keep="readable"` was asked for, with the reasons, and shapes without
        a face.
    seconds : float
    stored : bool
        Was all of it in the store?
    """

    parts: tuple[Part, ...]
    unit: str
    file_unit: str
    source: str
    refusals: tuple[str, ...] = ()
    seconds: float = 0.0
    stored: bool = False

    def __len__(self) -> int:
        return len(self.parts)

    def __iter__(self) -> Iterator[Part]:
        return iter(self.parts)

    def __getitem__(self, key: int | str) -> Part:
        if isinstance(key, str):
            found = [part for part in self.parts if part.name == key]
            if not found:
                raise KeyError(f"no part {key!r}; there are {[p.name for p in self.parts]}")
            return found[0]
        return self.parts[key]

    @property
    def by_name(self) -> dict[str, Part]:
        """The parts by their names."""
        return {part.name: part for part in self.parts}

    @property
    def shape(self) -> Boundary | Body:
        """The only part's, in the file's frame."""
        from standoff.errors import CadError

        if len(self.parts) != 1:
            raise CadError(
                f"{self.source} has {counted(len(self.parts), 'part')}: take one of .parts."
            )
        part = self.parts[0]
        if np.array_equal(part.pose, np.eye(4)):
            return part.shape
        raise CadError(f"{self.source}: its part is placed: take .parts[0].shape and .pose.")

    def report(self) -> str:
        """What was found, as text."""
        lengths = lengths_told(self.unit, self.file_unit) + (", read before" if self.stored else "")
        lines = [f"{self.source}: {counted(len(self.parts), 'part')}, {lengths}"]
        seen: list[PartReport] = []
        for part in self.parts:
            if all(part.report is not one for one in seen):
                seen.append(part.report)
                lines += part.report.lines(self.unit)
        lines += [f"left out: {one}" for one in self.refusals]
        return "\n".join(lines)
