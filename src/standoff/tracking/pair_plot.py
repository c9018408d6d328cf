"""A picture of two bodies and the answer of a query."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from standoff.bodies.body import Body
from standoff.checks.arrays import finite
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.tracking.proximity import Proximity

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@runtime_checkable
class MakesPicture(Protocol):
    """What is no `Body`, and makes the picture of itself with another: a solid."""

    def pictured(
        self, a: Any, b: Any, answer: Any, view: tuple[float, float] | None, unit: str
    ) -> Any:
        """The picture of A and B, one of which this is, and of their answer."""
        ...


def plot(
    a: Any,
    b: Any,
    answer: Any,
    path: str | Path | None = None,
    *,
    view: tuple[float, float] | None = None,
    unit: str = "",
) -> Figure:
    """Draw two bodies where an answer holds, their active features, and the witness line.

    In equal scales. The active face or edge of each body is drawn in a stronger colour, and the
    legend names it. Where the bodies overlap, both are drawn transparent.

    Of solids that need not be convex there are more marks: edges by their kinds (convex, reflex,
    smooth), every tie and local minimum that the answer has, the ends of a continuum, the ball
    inside both in an overlap, and where the answer is not proven the pieces that are open in its
    search. Where a solid would hide its nearest points, both are drawn transparent.

    Raises ModuleNotFoundError if matplotlib is not installed; the message names the extra. Raises
    TypeError: no bodies, no answer, or a path that is neither a string nor a Path. Raises
    ValueError: the answer is of other bodies, or holds no poses; the view is not two numbers; the
    file has another ending. Raises OSError if the file cannot be written.

    Parameters
    ----------
    a, b : Body, Solid or PlanarSolid
    answer : Proximity or SolidProximity
        Of these bodies; it holds their poses.
    path : str or path, optional
        Also write the picture there, whole or not at all: .png, .svg or .pdf.
    view : (float, float), optional
        Elevation and azimuth of the viewer, degrees. If not given, the view is across the normal,
        so that the witness line is seen in its full length.
    unit : str
        Label of lengths.

    Returns
    -------
    matplotlib.figure.Figure
    """
    solid = next((each for each in (a, b) if isinstance(each, MakesPicture)), None)
    if solid is not None:
        return _of_solids(solid, (a, b, answer), path, (view_angles(view), str(unit)))
    bodies: tuple[Any, Any] = (a, b)
    for name, body in zip("ab", bodies, strict=True):
        if not isinstance(body, Body):
            raise StandoffTypeError(
                f"{name} = {shown(body)} is not a body: give one of so.shapes.", name, body
            )
    angles = view_angles(view)
    poses = _poses(bodies, answer)
    from standoff.bodies.drawing.files import drawn
    from standoff.bodies.drawing.pair_picture import DrawnAnswer, pair_figure
    from standoff.bodies.drawing.solids import solid_of

    marks = DrawnAnswer(
        poses,
        (answer.point_a, answer.point_b),
        answer.normal,
        answer.distance,
        (answer.feature_a, answer.feature_b),
        answer.status.name,
    )
    solids = solid_of(a), solid_of(b)
    figure: Figure = drawn(path, lambda: pair_figure(solids, marks, angles, str(unit)))
    return figure


def _of_solids(
    solid: MakesPicture, asked: tuple[Any, Any, Any], path: Any, look: tuple[Any, str]
) -> Figure:
    from standoff.bodies.drawing.files import drawn

    figure: Figure = drawn(path, lambda: solid.pictured(*asked, *look))
    return figure


def view_angles(view: Any) -> tuple[float, float] | None:
    """Return a viewer's elevation and azimuth, degrees, as given.

    Raises ValueError if they are not two finite numbers.
    """
    if view is None:
        return None
    elevation, azimuth = finite(view, "view", (2,)).tolist()
    return elevation, azimuth


def _poses(bodies: tuple[Body, Body], answer: Any) -> tuple[Any, Any]:
    if not isinstance(answer, Proximity):
        raise StandoffTypeError(
            f"answer = {shown(answer)} is not an answer: give one of so.distance or a Tracker.",
            "answer",
            answer,
        )
    same = all(
        one is own or one.digest == own.digest
        for one, own in zip(bodies, answer.bodies, strict=True)
    )
    if not same:
        raise StandoffError(
            f"The answer is of {answer.bodies[0]!r} and {answer.bodies[1]!r}, not of these bodies: "
            "give a and b as they were asked, in their order.",
            "answer",
            answer,
        )
    if answer.poses is None:
        raise StandoffError(
            "The answer does not hold its poses: give one of so.distance or a Tracker.",
            "answer",
            answer,
        )
    return answer.poses
