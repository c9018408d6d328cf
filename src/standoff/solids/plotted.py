"""What solids in the plane and in space have in common: they draw themselves."""

from __future__ import annotations

from abc import abstractmethod
from pathlib import Path
from typing import TYPE_CHECKING, Any

from standoff.solids.answer import SolidProximity

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Plotted:
    """A solid that is drawn, alone or with another one and an answer about both."""

    __slots__ = ()

    def plot(self, path: str | Path | None = None, *, unit: str = "") -> Figure:
        """Draw the solid: one in space from two opposite sides, with its convex, reflex and smooth
        edges told apart, a planar one with such vertices.

        Raises ModuleNotFoundError if matplotlib is not installed; the message names the extra.
        Raises TypeError if `path` is neither a string nor a Path. Raises ValueError if it is empty
        or has a different file extension. Raises OSError if the file cannot be written.

        Parameters
        ----------
        path : str or path, optional
            Also write the picture there, whole or not at all: .png, .svg or .pdf.
        unit : str
            Label of lengths.

        Returns
        -------
        matplotlib.figure.Figure
        """
        from standoff.bodies.drawing.files import drawn

        figure: Figure = drawn(path, lambda: self._figure(str(unit)))
        return figure

    @abstractmethod
    def _figure(self, unit: str) -> Figure: ...

    @abstractmethod
    def pictured(
        self, a: Any, b: Any, answer: Any, view: tuple[float, float] | None, unit: str
    ) -> Figure:
        """The picture that ``so.plot`` makes of two solids, of which this is one.

        Raises TypeError, StandoffError: something that is no such solid, or no answer.

        Parameters
        ----------
        a, b : Solid, PlanarSolid, Boundary or Body
            As they were asked, in their order.
        answer : SolidProximity
        view : (float, float) or None
            Elevation and azimuth of the viewer, degrees.
        unit : str
            Label of lengths.

        Returns
        -------
        matplotlib.figure.Figure
        """
        ...


def checked_answer(answer: Any) -> SolidProximity:
    """An answer about two solids.

    Raises TypeError: something else.
    """
    if isinstance(answer, SolidProximity):
        return answer
    from standoff.checks.real_numbers import shown
    from standoff.errors import StandoffTypeError

    raise StandoffTypeError(
        f"answer = {shown(answer)} is not an answer of solids: give one of so.distance.",
        "answer",
        answer,
    )
