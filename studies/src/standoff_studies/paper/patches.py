"""Figs. 1 and 2: a patch with its isoparametric curves and tangents; two patches with dR."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import standoff as so
from standoff.bodies import Body
from standoff.geometry import BezierPatch
from standoff.motion import Pose
from standoff.tracking import PairSystem, Proximity
from standoff.typing import Array
from standoff_studies.paper import style
from standoff_studies.paper.drawing_3d import PALE, View
from standoff_studies.paper.figure import Artwork, Statement, measured_by, own_statement

HALF = (1.0, 0.8)
"""Half the block's extent in x and y [length]."""
FALL = (0.45, 0.3)
"""How far the curved face drops from its middle to the ends of u, and of v [length]."""
FLOOR = -1.1
"""Height of the block's flat side; the middle of the curved face is at 0 [length]."""

POINT = (0.42, -0.35, 0.75)
"""The point above the patch of Fig. 1 [length]."""

POSE_B = (np.array([0.3, 0.3, 1.3]), (2.6, 0.7, 0.35))
"""Where block B is [length], and the rotation vector that turns its curved face to A's [rad]."""

CURVES = np.linspace(0.0, 1.0, 9)
"""Parameters of the isoparametric curves that are drawn."""
SAMPLES = np.linspace(0.0, 1.0, 33)

ARROW = 0.35
"""Fraction of its length at which a tangent is drawn, so that it stays near its patch."""

SEEN_ABOVE, SEEN_ACROSS = (-62.0, 32.0), (-50.0, 30.0)
"""Azimuth and elevation of the two views [degrees]."""

DIFFERENCES = 1e-9
"""Error of a central difference at steps of 1e-5: h² of the third derivatives, above the rounding
of the points over h [length]."""
ROUNDOFF = 1e-12
"""Projections on unit vectors below this count as zero: 1e4 roundings."""


LAW = "so.distance, a global search: no law"
"""The law with which the statements were measured."""


def _control_points() -> Array:
    """Control points of z = -p (2u - 1)^2 - q (2v - 1)^2 over a rectangle, shape (3, 3, 3)."""
    (a, b), (p, q) = HALF, FALL
    # (2u - 1)^2 has the Bernstein coefficients 1, -1, 1.
    square = np.array([1.0, -1.0, 1.0])
    x, y = np.meshgrid([-a, 0.0, a], [-b, 0.0, b], indexing="ij")
    return np.stack([x, y, -p * square[:, None] - q * square[None, :]], axis=-1)


@cache
def curved_face() -> BezierPatch:
    """The biquadratic patch of both figures, with u and v in [0, 1]."""
    return BezierPatch(_control_points())


@cache
def block() -> Body:
    """A block whose face 0 is curved, with four upright sides and a flat bottom."""
    top = _control_points()
    floor = top * [1.0, 1.0, 0.0] + [0.0, 0.0, FLOOR]
    rims = [(t[0], t[-1], t[:, 0], t[:, -1]) for t in (top, floor)]
    walls = [BezierPatch(rim) for rim in zip(*rims, strict=True)]
    bottom = BezierPatch(floor[::2, ::2])
    return Body.from_patches([curved_face(), *walls, bottom], name="block with a curved face")


class Foot(NamedTuple):
    """The patch of Fig. 1 and the foot of a point on it, as the tracker finds it."""

    answer: Proximity
    system: PairSystem


@cache
def foot() -> Foot:
    """Find the foot point of `POINT`."""
    a, b = block(), so.shapes.point()
    poses = Pose.identity(), Pose(np.eye(3), POINT)
    return Foot(*_answer(a, b, *poses))


@cache
def pair() -> Foot:
    """Find the closest points of two blocks."""
    return Foot(*_answer(block(), block(), Pose.identity(), pose_b()))


def pose_b() -> Pose:
    """The pose of the upper block in Fig. 2."""
    shift, turn = POSE_B
    return Pose.exp(turn, shift)


def _answer(a: Body, b: Body, pose_a: Pose, pose_b: Pose) -> tuple[Proximity, PairSystem]:
    answer = so.distance(a, b, pose_a, pose_b)
    places = (
        answer.place_a,
        answer.place_b,
    )
    return answer, so.tracking.pair_system(a, b, pose_a, pose_b, *places)


def tangents_patch() -> Artwork:
    """Fig. 1: isoparametric curves, a point and its two tangents."""
    answer, system = foot()
    u, v = answer.parameters_a
    return Artwork(
        caption=(
            "A convex patch f(u, v) with its isoparametric curves, one each eighth of u and v, and "
            f"the tangents f_u and f_v (drawn at {ARROW:g} of their length) at the foot "
            f"(u, v) = ({u:.3f}, {v:.3f}) of the point above it. The dashed line from the foot to "
            "the point is the shortest, and is perpendicular to both tangents. Lengths are in the "
            "scene's unit."
        ),
        text=(
            "A curved four-sided patch in space under a net of curves, with a dot on it from which "
            "two arrows, f_u and f_v, lie along the net and a dashed line leads up to a point."
        ),
        draw=_draw_tangents,
        tables={"isoparametric": _curve_table(), "tangents": _system_table(answer, system)},
        statements=measured_by(LAW, (_quotients(u, v), _perpendicular("Fig. 1", "-", system))),
    )


def witness_pair() -> Artwork:
    """Fig. 2: two patches with dR and the four tangents."""
    answer, system = pair()
    return Artwork(
        caption=(
            "Two patches, f(u, v) below and h(r, s) above, with their witness points, the vector "
            f"ΔR between them (dashed, {answer.distance:.6f} long) and the four tangents (drawn at "
            f"{ARROW:g} of their length). At the closest points ΔR is perpendicular to all four. "
            "Lengths are in the scene's unit."
        ),
        text=(
            "Two curved four-sided patches, one above the other and turned towards it, each with "
            "a dot and two arrows along its net; a dashed line joins the dots."
        ),
        draw=_draw_pair,
        tables={"tangents": _system_table(answer, system)},
        statements=measured_by(
            LAW,
            (
                _perpendicular(
                    "Fig. 2, Eqs. (1)–(4)",
                    "at the closest points ΔR has no projection on the tangents of either patch: "
                    "Ψ = 0",
                    system,
                ),
                _certified(answer),
            ),
        ),
    )


def _quotients(u: float, v: float) -> Statement:
    """The patch's partial derivatives against central difference quotients."""
    face, h = curved_face(), 1e-5
    _, f_u, f_v, *_ = face.jet(u, v)
    across = (face.jet(u + h, v)[0] - face.jet(u - h, v)[0]) / (2 * h)
    along = (face.jet(u, v + h)[0] - face.jet(u, v - h)[0]) / (2 * h)
    off = max(float(np.linalg.norm(f_u - across)), float(np.linalg.norm(f_v - along)))
    return Statement(
        "Fig. 1",
        "f_u and f_v are the first partial derivatives of the patch",
        f"they are difference quotients of f to {off:.0e} [length]",
        off < DIFFERENCES,
    )


def _perpendicular(source: str, stated: str, system: PairSystem) -> Statement:
    """The cosines of dR with the tangents at the witness points."""
    worst = float(np.max(np.abs(cosines(system))))
    holds = None if stated == "-" else worst < ROUNDOFF
    count = len(system.Psi)
    return Statement(
        source, stated, f"greatest |cosine| of ΔR with the {count} tangents: {worst:.1e}", holds
    )


def _certified(answer: Proximity) -> Statement:
    gap = answer.distance - answer.lower_bound
    return own_statement(
        "Fig. 2",
        f"distance {answer.distance:.12f}, proven to be no less than that minus {gap:.1e} [length]",
    )


def cosines(system: PairSystem) -> Array:
    """Return the cosines of dR with every tangent, A's first."""
    tangents = np.hstack([system.F, system.G])
    lengths = np.linalg.norm(tangents, axis=0) * np.linalg.norm(system.dR)
    return np.asarray(system.dR @ tangents / lengths)


def _curve_table() -> dict[str, Array]:
    """Points of the isoparametric curves: those of constant u, then those of constant v."""
    grid = [(c, t) for c in CURVES for t in SAMPLES] + [(t, c) for c in CURVES for t in SAMPLES]
    points = np.array([curved_face().jet(u, v)[0] for u, v in grid])
    parameters = np.array(grid)
    names = ("u", "v", "x_length", "y_length", "z_length")
    return dict(zip(names, np.hstack([parameters, points]).T, strict=True))


def _system_table(answer: Proximity, system: PairSystem) -> dict[str, list[float] | list[str]]:
    """One row per tangent: its foot, its components and its projection error."""
    names = ["f_u", "f_v", "h_r", "h_s"][: len(system.Psi)]
    rows = [
        (*point, *tangent)
        for point, tangents in ((answer.point_a, system.F), (answer.point_b, system.G))
        for tangent in tangents.T
    ]
    columns = ("x_length", "y_length", "z_length", "dx_length", "dy_length", "dz_length")
    table: dict[str, list[float] | list[str]] = {"tangent": names}
    table |= {
        name: list(values) for name, values in zip(columns, zip(*rows, strict=True), strict=True)
    }
    return table | {"psi_length2": list(system.Psi), "cosine": list(cosines(system))}


def _draw_tangents() -> Figure:
    answer, system = foot()
    view = View(*SEEN_ABOVE)
    _add_patch(view, Pose.identity(), PALE[0])
    _add_witnesses(view, answer)
    _add_arrows(view, answer.point_a, system.F, style.BLUE)
    figure = style.new_figure(style.WIDTH, 4.6)
    axes = figure.add_subplot()
    view.paint(axes)
    _name_arrows(view, axes, answer.point_a, system.F, ("$f_u$", "$f_v$"))
    view.text(axes, answer.point_b, "point  ", ha="right")
    view.text(axes, answer.point_a - [0.0, 0.0, 0.06], "$f(u, v)$  ", ha="right", va="top")
    view.text(axes, 0.5 * (answer.point_a + answer.point_b), "shortest line  ", ha="right")
    view.triad(axes, (-1.62, 0.0), 0.4, "length")
    return figure


def _draw_pair() -> Figure:
    answer, system = pair()
    view = View(*SEEN_ACROSS)
    _add_patch(view, Pose.identity(), PALE[0])
    _add_patch(view, pose_b(), PALE[1], 0.55)
    _add_witnesses(view, answer)
    _add_arrows(view, answer.point_a, system.F, style.BLUE)
    _add_arrows(view, answer.point_b, system.G, style.RED)
    figure = style.new_figure(style.WIDTH, 5.6)
    axes = figure.add_subplot()
    view.paint(axes)
    _name_arrows(view, axes, answer.point_a, system.F, ("$f_u$", "$f_v$"))
    _name_arrows(view, axes, answer.point_b, system.G, ("$h_r$", "$h_s$"))
    view.text(axes, 0.5 * (answer.point_a + answer.point_b), "ΔR  ", ha="right")
    view.text(axes, curved_face().jet(0.0, 0.0)[0], "A: $f(u, v)$  ", ha="right")
    corner = pose_b().apply(curved_face().jet(0.0, 1.0)[0])
    view.text(axes, corner, "B: $h(r, s)$  ", ha="right")
    view.triad(axes, (-1.55, 0.05), 0.4, "length")
    return figure


def _add_patch(view: View, pose: Pose, colour: str, opacity: float = 1.0) -> None:
    """The curved face with its isoparametric curves and its rim."""
    face = curved_face()
    grid = np.array([[pose.apply(face.jet(u, v)[0]) for v in SAMPLES] for u in SAMPLES])
    view.patch(grid, colour, opacity=opacity, lines=len(CURVES) - 2)


def _add_witnesses(view: View, answer: Proximity) -> None:
    view.line([answer.point_a, answer.point_b], style.BLACK, 1.8, dashes=(0.05, 0.04))
    for point in (answer.point_a, answer.point_b):
        view.mark(point, style.BLACK)


def _add_arrows(view: View, foot: Array, tangents: Array, colour: str) -> None:
    for tangent in ARROW * tangents.T:
        tip = foot + tangent
        view.line([foot, tip], colour, 2.6, rank=3.0)
        # two barbs in the plane of the picture
        back = 0.1 * np.linalg.norm(view.flat(tangent)) * _unit(-tangent)
        side = 0.5 * np.linalg.norm(view.flat(back)) * _unit(np.cross(view.towards, tangent))
        for barb in (back + side, back - side):
            view.line([tip, tip + barb], colour, 2.6, rank=3.0)


def _name_arrows(
    view: View, axes: Axes, foot: Array, tangents: Array, names: tuple[str, str]
) -> None:
    for tangent, name in zip(ARROW * tangents.T, names, strict=True):
        view.text(axes, foot + (1.0 + 0.12 / np.linalg.norm(view.flat(tangent))) * tangent, name)


def _unit(vector: Array) -> Array:
    return np.asarray(vector / np.linalg.norm(vector))
