"""The field's figure: the table of methods and work, the picture, and the statements."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from standoff.bodies import shapes
from standoff.motion import Pose
from standoff.tracking import Tracker, distance
from standoff_studies.paper import style
from standoff_studies.paper.bodies import lens_of_patches
from standoff_studies.paper.convergence.pairs import STRETCHED, set_apart
from standoff_studies.paper.field.algebra import ROWS, roots_of_two_faces, two_ellipsoids
from standoff_studies.paper.field.intervals import MOST_BOXES
from standoff_studies.paper.field.methods import METHODS, WRONG, law_of
from standoff_studies.paper.field.rows import Row, committed
from standoff_studies.paper.field.work import SEED, STEP
from standoff_studies.paper.figure import Artwork, Statement, measured_by, own_statement
from standoff_studies.paper.keys import key_below, key_line
from standoff_studies.paper.law_words import law_words

Rows = tuple[Row, ...]

WORKS = {
    "A": "A: vault and point",
    "B": "B: planar body and point, outside",
    "C": "C: two planar bodies",
    "D": "D: lens and point",
    "E": "E: two lenses",
    "drawn": "drawn pairs of stretched lenses",
}
"""The work, in words."""

LOOKS = {
    "vclip": ("P", style.ORANGE),
    "gjk": ("s", style.GREEN),
    "algebra": ("^", style.PURPLE),
    "boxes": ("D", style.SKY),
    "planes": ("v", style.QUIET),
    "newton": ("X", style.BLACK),
    "blind": ("x", style.BLACK),
    "paper": ("*", style.RED),
    "own": ("o", style.BLUE),
}
"""Marker and colour of each method, by the first word of its key."""

LETTERS = {
    "A": ("A", (9, -2)),
    "B": ("B", (9, 2)),
    "C": ("C", (-10, 2)),
    "D": ("D", (-10, -2)),
    "E": ("E", (0, 10)),
    "drawn": ("p", (0, -11)),
}
"""The letter of each work, and where it stands beside a mark [points], so that marks that are close
keep theirs."""

FLOOR = 1e-16
"""Least witness error [length] in the picture: roundoff of bodies of size 2."""

FEW = 27
"""Control points of a lens's three patches."""

ELLIPSOIDS = 20
"""Drawn pairs of ellipsoids for the resultants."""

LARGE = 1000
"""Corners of a polyhedron for one control point of the patches, from which it counts as large."""

NONE = "needs none"

UNTRIED = {"blind": "as Newton"}
"""Methods that begin at a place, but whose starts were not tried."""

WITH_STARTS = ("vclip", "gjk", "planes", "newton", "paper", "own")
"""Methods that begin at a place; the others search all places in every frame."""

ON_PATCHES = ("gjk", "algebra", "boxes", "planes", "newton", "blind")
"""The field's methods on the patches themselves."""


def as_committed() -> Artwork:
    """The study as last run and stored."""
    return artwork(committed())


def artwork(rows: Rows) -> Artwork:
    """Return the figure of a study."""
    return Artwork(
        caption=(
            "The methods that the paper compares itself with, on the motions of simulations A to E "
            "and on drawn pairs, frames of 1 ms. Above: greatest error of the witness points "
            "against the cost of a frame, in evaluations of the pair's second-order system; a mark "
            "is the median, its line goes to the worst frame, its letter is the simulation (p: "
            "drawn pairs). Down and to the left is better. A point alone is a twelfth of an "
            "evaluation of two faces, and so is a polyhedron's corner that is read. Marks of "
            "V-Clip on E: 20, 40 and 80 cells along a patch. Below: part of random starts from "
            "which a method comes to the true distance, bodies at rest; resultants and interval "
            "Newton need no start."
        ),
        text=(
            "Two diagrams. Above, from left to right: tangent planes, V-Clip, the library's frame, "
            "the paper's law and two Newton steps, Newton to its end, resultants, GJK, and far to "
            "the right interval Newton. V-Clip's errors are the greatest, at a hundredth; the "
            "law's go from a millionth to some thousandths, those of two Newton steps nearly as "
            "far; all others' are far smaller. Below, V-Clip, GJK and the library's frame arrive "
            "from all starts, the paper's law and Newton from fewer, of two lenses from few."
        ),
        draw=lambda: draw(rows),
        tables={"field": table(rows)},
        statements=measured_by(by(), statements(rows)),
        shown=("field",),
    )


def by() -> str:
    """Return the laws with which the statements were measured."""
    pair = lens_of_patches(), shapes.point()
    laws = [Tracker(*pair, STEP, law=law_of(key)) for key in ("paper", "own")]
    return law_words(*laws, told="the others as described; cold certified queries are the truth")


def table(rows: Rows) -> dict[str, list[str]]:
    """Cost, accuracy, failures and basin, by method and work; what was not run says so."""
    found: list[tuple[str, ...]] = []
    for key, method in METHODS.items():
        own = [row for row in rows if row.method == key]
        found += [(method.name, row.work, *_cells(row)) for row in own]
        if key == "algebra":
            errors = [f"{each:.0e}" for each in of_ellipsoids()]
            found.append((method.name, "ellipsoids", str(ELLIPSOIDS), "–", "–", *errors, "0", NONE))
            found.append((method.name, "E, drawn", "not run", *["–"] * 5, "–"))
    names = (
        *("method", "work", "frames", "evaluations, median", "worst"),
        *("witness error", "distance error", "failed", "starts that arrive"),
    )
    return {
        name: list(column) for name, column in zip(names, zip(*found, strict=True), strict=True)
    }


def _cells(row: Row) -> tuple[str, ...]:
    return (
        str(row.frames),
        f"{row.median:.3g}",
        f"{row.worst:.3g}",
        f"{row.error:.0e}",
        f"{row.off:.0e}",
        str(row.failures),
        f"{row.arrived} of {row.tried}" if row.tried else UNTRIED.get(row.method, NONE),
    )


def statements(rows: Rows) -> tuple[Statement, ...]:
    """Return the paper's claims about the field, and what was measured."""
    return (
        _efficient(rows),
        _subsumes_newton(rows),
        _large_basin(rows),
        _large_polyhedra(rows),
        *_own(rows),
    )


def of(rows: Iterable[Row], method: str) -> dict[str, Row]:
    """Return a method's rows, by their work."""
    return {row.work: row for row in rows if row.method == method}


def _efficient(rows: Rows) -> Statement:
    """The law's cost against that of every method of the field that is as accurate."""
    law, lost = of(rows, "paper"), []
    told = [f"the law {_range(row.median for row in law.values())}"]
    for key in ("vclip", *ON_PATCHES):
        theirs = of(rows, key)
        told.append(f"{METHODS[key].name} {_range(row.median for row in theirs.values())}")
        both = [(row, law[work]) for work, row in theirs.items() if work in law]
        lost += [
            f"{METHODS[key].name} on {own.work}"
            for row, own in both
            if row.error <= own.error and row.median <= own.median
        ]
    return Statement(
        "Abstract",
        "higher computational efficiency than previously available algorithms",
        f"evaluations a frame, median: {'; '.join(told)}. As accurate as the law for no more: "
        f"{', '.join(lost) or 'none'}",
        not lost,
        "two Newton steps cost what the law's two stages cost; where a side is near, the patch "
        "beyond costs them more. V-Clip's polyhedra and Thompson's planes are cheaper and less "
        "accurate",
    )


def _subsumes_newton(rows: Rows) -> Statement:
    law, newton = of(rows, "paper"), of(rows, "newton")
    pairs = [(row, newton[work]) for work, row in law.items()]
    error = max(row.error for row in newton.values())
    return Statement(
        "Section VI",
        "all the computational efficiency of the algorithms by Newton's iteration, to its end",
        f"a frame of the law {_range(own.median for own, _ in pairs)} evaluations, at worst "
        f"{max(own.worst for own, _ in pairs):.3g}; tracking by Newton "
        f"{_range(other.median for _, other in pairs)}, at worst "
        f"{max(other.worst for _, other in pairs):.3g}",
        all(own.median <= other.median and own.worst <= other.worst for own, other in pairs),
        f"for that Newton's witness points are off by at most {error:.0e}, the law's by "
        f"{max(own.error for own, _ in pairs):.0e}, and Newton needs no twists",
    )


def _large_basin(rows: Rows) -> Statement:
    law, newton = of(rows, "paper"), of(rows, "newton")
    return Statement(
        "Section I",
        "a large basin of attraction: large initialization errors are tolerated, other tracking "
        "methods need exact initial conditions",
        f"starts that arrive: the law {_shares(law)}; Newton {_shares(newton)}",
        all(row.arrived > newton[work].arrived for work, row in law.items()),
        "on two lenses M as printed is indefinite on large parts of the facing faces",
    )


def _large_polyhedra(rows: Rows) -> Statement:
    """The corners that V-Clip would need for the law's accuracy: its errors are facets wide."""
    kinds = [row for row in rows if row.method.startswith("vclip") and row.work == "E"]
    kinds.sort(key=lambda row: row.corners)
    finest, law = kinds[-1], of(rows, "paper")["E"]
    needed = finest.corners * (finest.error / law.error) ** 2
    told = ", ".join(f"{row.error:.1e} with {row.corners}" for row in kinds)
    reads = _range(row.median for row in kinds)
    return Statement(
        "Section I",
        "polyhedral approximations of curved bodies grow very large",
        f"on simulation E's lenses V-Clip's witness points are off by {told} corners; for the "
        f"law's {law.error:.1e} it would take about {needed:.0e} corners, where three patches have "
        f"{FEW} control points",
        needed > LARGE * FEW,
        f"the size costs memory, not time: a frame reads as much of each polyhedron ({reads})",
    )


def _own(rows: Rows) -> tuple[Statement, ...]:
    """What the paper does not state, above all where others are better."""
    own, boxes, law = (of(rows, key) for key in ("own", "boxes", "paper"))
    sure = "; ".join(
        f"{METHODS[key].name} {_shares(of(rows, key))}" for key in ("vclip", "gjk", "own")
    )
    errors = "; ".join(
        f"{METHODS[key].name} {_errors(of(rows, key))}" for key in LOOKS if of(rows, key)
    )
    failed = "; ".join(
        f"{METHODS[key].name} {sum(r.failures for r in of(rows, key).values())} of "
        f"{sum(r.frames for r in of(rows, key).values())}"
        for key in LOOKS
        if of(rows, key)
    )
    return (
        own_statement(
            "The field",
            f"starts that arrive: {sure}; resultants and interval Newton need none",
            "all of these are better than the printed law here. The library's frame arrives since "
            "it begins anew where it can't certify",
        ),
        own_statement("The field", f"greatest witness errors [length]: {errors}"),
        own_statement(
            "The field",
            f"frames that failed, that is, gave up or are off by more than {WRONG:g} length: "
            f"{failed}",
            f"interval Newton gives up after {MOST_BOXES} pairs of boxes: its failures are those",
        ),
        own_statement(
            "The field",
            f"evaluations of the library's frame: {_range(r.median for r in own.values())}, at "
            f"worst {max(r.worst for r in own.values()):.3g}, with witness errors up to "
            f"{max(r.error for r in own.values()):.0e}",
            "it is the paper's feedforward, then a Newton step at the new pose. Its certificate is "
            "not counted; only V-Clip, GJK and interval Newton prove as much by themselves",
        ),
        own_statement(
            "The field",
            f"interval Newton, which proves its answer and keeps nothing, takes "
            f"{_range(r.median for r in boxes.values())} evaluations, of bounds",
            "of two faces it searches four parameters",
        ),
        own_statement(
            "The field",
            "the printed law's guards sought foot points that would add "
            f"{_range(r.guards for r in law.values())} evaluations a frame",
            "they are not in its cost: the paper reads them from Voronoi regions that were "
            "computed before",
        ),
        *_of_resultants(),
    )


def _of_resultants() -> tuple[Statement, ...]:
    """Of two faces: not of two biquadratic ones, but of the lowest degree."""
    return (
        own_statement(
            "The field",
            f"two biquadratic faces have {roots_of_two_faces(2, 2)} common roots of Eqs. (1)-(4), "
            "by Bernstein's bound: as many eigenvalues in every frame",
            "so resultants were not run on E and the drawn pairs",
        ),
        own_statement(
            "The field",
            f"of {ELLIPSOIDS} drawn pairs of whole ellipsoids, two faces of the lowest degree, "
            f"resultants find the closest points as eigenvalues of a matrix of {ROWS} rows: off by "
            + ", the distance by ".join(f"{each:.0e}" for each in of_ellipsoids()),
            "by two multipliers, without parameters and so without an evaluation of a patch",
        ),
    )


@cache
def of_ellipsoids() -> tuple[float, float]:
    """The greatest errors of a witness point and of the distance by resultants, of drawn pairs of
    ellipsoids [length]."""
    rng, found = np.random.default_rng(SEED), []
    for number in range(ELLIPSOIDS):
        axes = rng.uniform(*STRETCHED, (2, 3))
        bodies = shapes.ellipsoid(*axes[0]), shapes.ellipsoid(*axes[1])
        one = set_apart(f"ellipsoids {number}", *bodies, rng)
        pose = one.path.pose(0.0)
        turn, (a, b) = pose.rotation, (np.diag(each**-2.0) for each in axes)
        points = two_ellipsoids(a, turn @ b @ turn.T, pose.translation)
        due = distance(one.a, one.b, Pose.identity(), pose)
        error = np.linalg.norm(points - [due.point_a, due.point_b], axis=1).max()
        off = abs(float(np.linalg.norm(points[0] - points[1])) - due.distance)
        found.append((float(error), off))
    error, off = np.max(found, axis=0).tolist()
    return error, off


def _range(values: Iterable[float]) -> str:
    numbers = list(values)
    low, high = f"{min(numbers):.3g}", f"{max(numbers):.3g}"
    return low if low == high else f"{low} to {high}"


def _errors(own: dict[str, Row]) -> str:
    return f"{max(row.error for row in own.values()):.0e}"


def _shares(own: dict[str, Row]) -> str:
    return ", ".join(f"{work} {row.arrived}/{row.tried}" for work, row in own.items())


def draw(rows: Rows) -> Figure:
    """Cost and accuracy above, starts below."""
    figure = style.new_figure(height=8.6)
    above, below = figure.subplots(2, 1, height_ratios=(5, 2))
    for row in rows:
        _mark(above, row)
    above.set(xscale="log", yscale="log")
    above.set_xlabel("evaluations of the pair's second-order system, a frame")
    above.set_ylabel("greatest witness error [length]")
    works = list(WORKS)
    for k, key in enumerate(WITH_STARTS):
        marker, colour = LOOKS[key]
        own = of(rows, key)
        at = [works.index(work) + 0.11 * (k - 2.5) for work in own]
        parts = [row.arrived / row.tried for row in own.values()]
        below.plot(at, parts, marker, color=colour, markersize=7)
    below.set_xticks(range(len(works)), works)
    below.set_ylim(-0.05, 1.08)
    below.set_ylabel("part of starts\nthat arrive")
    handles = [
        key_line(METHODS[key].name, colour, dashes="", marker=marker, markersize=7)
        for key, (marker, colour) in LOOKS.items()
    ]
    key_below(figure, handles, 2)
    return figure


def _mark(axes: Axes, row: Row) -> None:
    """A method on a work: its median, a line to its worst frame, its letter."""
    marker, colour = LOOKS[row.method.split()[0]]
    error = max(row.error, FLOOR)
    if np.isnan(error):
        return
    look: dict[str, Any] = {"color": colour}
    axes.plot([row.median, row.worst], [error, error], linewidth=0.9, alpha=0.6, **look)
    axes.plot(row.median, error, marker, markersize=9 if marker == "*" else 6, **look)
    letter, off = LETTERS[row.work]
    look |= {"textcoords": "offset points", "fontsize": 8, "ha": "center", "va": "center"}
    axes.annotate(letter, (row.median, error), off, **look)
