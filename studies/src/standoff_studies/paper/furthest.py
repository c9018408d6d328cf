"""Key "furthest": the furthest points of two convex patches that intersect, and the depth.

s(n) is how far B must move along n until it only touches A. A pair of points x on A and y on B with
opposed normals and x - y = s n is stationary for s over the directions, and for |x - y| over both
patches. docs/penetration.md has the proof that these are of the same kind: of H, the Hessian of
|x - y|²/2, as many eigenvalues are positive as of the Hessian of s.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import scipy
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.geometry import ConicArc
from standoff.kernels.state import arrays as K
from standoff.motion import Pose, Twist
from standoff.recording.times import even_times
from standoff.tracking import Tracker, pair_system
from standoff.tracking.laws import PaperLaw
from standoff.typing import Array
from standoff_studies.paper import style
from standoff_studies.paper.drawing import draw_planar_body, show_plane
from standoff_studies.paper.figure import NOTHING, Artwork, Statement, measured_by
from standoff_studies.paper.law_words import law_words
from standoff_studies.paper.many_starts import begun, motion_along, stepped
from standoff_studies.paper.pair_simulation import REST, Place

FOOTNOTE = "Footnote on tracking the furthest points"
BODIES, TRIES = 30, 12
"""Drawn pairs of ellipsoids, and directions from which stationary ones are sought at each."""
CONVERGED, NEWTON_STEPS = 1e-13, 60
ASIDE = 0.1
"""How far from a point of a surface, along its normal, the place on it is asked [length]."""
LEAST = 1e-6
"""Stationary directions at which s, or an eigenvalue, is nearer to 0 are left out: their kind is
about to change."""

STEP, GAIN, DURATION = 1e-3, 25.0, 2.0
EVERY = 10
"""Every such frame is looked at."""
INSIDE = 1.0, 0.62
"""Where the middle of B is at the start and the end of a slide that stays in the overlap
[length],"""
QUICK = 1.6, 0.62
"""of one that comes from outside,"""
SLOW = 1e-3
"""and how far a slow one goes to either side of contact [length]."""
A_AXES, B_AXES = (0.8, 0.6), (0.55, 0.45)
"""Semi-axes of the two ellipses [length]."""
TURN, RAISED = 0.5, 0.12
"""Of B against A [rad], and how far its middle is off A's long axis [length]."""
TURNED = Rotation.from_rotvec([0.0, 0.0, TURN]).as_matrix()
DIRECTIONS = 3600
"""Directions in the plane among which the least s is sought."""
REACH = 0.2
"""How far the points are shifted in the picture of the saddle [length]."""
TOUCH_WITHIN = 1e-15
"""Of the place of contact, relative: roundoff."""
FOLLOWS = 1e-9
"""A law whose distance is that near to the true one follows it [length]."""


class Supports(NamedTuple):
    """Two ellipsoids, or ellipses, by support functions: Q = R diag(axes²) Rᵀ, and B's middle."""

    q_a: Array
    q_b: Array
    middle: Array

    def at(self, n: Array) -> tuple[float, Array, Array]:
        """s(n) of a unit vector, its gradient x - y, and the sum of the radii of curvature."""
        s, gradient, hessian = -float(self.middle @ n), -self.middle, np.zeros_like(self.q_a)
        for q in (self.q_a, self.q_b):
            h = math.sqrt(n @ q @ n)
            s, gradient = s + h, gradient + q @ n / h
            hessian = hessian + q / h - np.outer(q @ n, q @ n) / h**3
        return s, gradient, hessian

    def on_sphere(self, n: Array) -> tuple[float, Array, Array]:
        """s, and its gradient and Hessian along an orthonormal base of what is normal to n."""
        s, gradient, hessian = self.at(n)
        base = np.linalg.svd(n[None])[2][1:]
        return s, base @ gradient, base @ hessian @ base.T - s * np.eye(len(base))

    def stationary(self, n: Array) -> Array | None:
        """A stationary direction by Newton's method from another one."""
        for _ in range(NEWTON_STEPS):
            _, gradient, hessian = self.on_sphere(n)
            if np.linalg.norm(gradient) < CONVERGED:
                return n
            step = np.linalg.lstsq(hessian, -gradient, rcond=None)[0]
            step *= min(1.0, 0.3 / float(np.linalg.norm(step)))
            n = n + np.linalg.svd(n[None])[2][1:].T @ step
            n = n / np.linalg.norm(n)
        return None


class Kind(NamedTuple):
    """A stationary pair.

    Attributes
    ----------
    s : float
        How far B must move along its direction [length].
    up : int
        Positive eigenvalues of the Hessian of s.
    signs : (int, int)
        Positive and negative eigenvalues of H, by the library.
    error : float
        The greatest projection error there [length²].
    """

    s: float
    up: int
    signs: tuple[int, int]
    error: float


def place_at(body: so.Body, pose: Pose, point: Array, out: Array) -> Place:
    """The feature and parameters of a point of a body's surface, its outward normal given."""
    found = so.distance(body, so.shapes.point(), pose, Pose(np.eye(3), point + ASIDE * out))
    feature, parameters = found.place_a
    return (str(feature.kind), feature.index), tuple(parameters)


@cache
def kinds() -> tuple[tuple[Kind, ...], ...]:
    """Return the stationary pairs that are found of each drawn pair of ellipsoids that overlap, and
    in front the depth's own, at what ``so.distance`` answers."""
    rng = np.random.default_rng(5)
    found: list[tuple[Kind, ...]] = []
    while len(found) < BODIES:
        axes, turn = rng.uniform(0.3, 1.0, (2, 3)), Rotation.random(random_state=rng).as_matrix()
        middle = rng.normal(size=3)
        middle *= rng.uniform(0.2, 0.8) / np.linalg.norm(middle)
        a, b = (so.shapes.ellipsoid(*each) for each in axes)
        pose = Pose(turn, middle)
        answer = so.distance(a, b, Pose.identity(), pose)
        if answer.distance > -10.0 * LEAST or not answer.certified:
            continue
        model = Supports(np.diag(axes[0] ** 2), turn @ np.diag(axes[1] ** 2) @ turn.T, middle)
        ways = [answer.normal]
        for n in rng.normal(size=(TRIES, 3)):
            way = model.stationary(n / np.linalg.norm(n))
            if way is not None and not any(np.linalg.norm(way - other) < LEAST for other in ways):
                ways.append(way)
        found.append(tuple(each for way in ways if (each := _kind((a, b), pose, model, way))))
    return tuple(found)


def _kind(bodies: tuple[so.Body, so.Body], pose: Pose, model: Supports, n: Array) -> Kind | None:
    """The kind of a stationary direction; None where it is about to change."""
    s, _, hessian = model.on_sphere(n)
    curved = np.linalg.eigvalsh(hessian)
    if s < LEAST or np.abs(curved).min() < LEAST:
        return None
    x = model.q_a @ n / math.sqrt(n @ model.q_a @ n)
    y = model.middle - model.q_b @ n / math.sqrt(n @ model.q_b @ n)
    still = Pose.identity()
    places = place_at(bodies[0], still, x, n), place_at(bodies[1], pose, y, -n)
    system = pair_system(*bodies, still, pose, *places)
    of_h = np.linalg.eigvalsh(system.H)
    signs = int((of_h > 0.0).sum()), int((of_h < 0.0).sum())
    return Kind(s, int((curved > 0.0).sum()), signs, float(np.abs(system.Psi).max()))


class Slide:
    """B's path: along A's long axis from one place to another."""

    start, end = 0.0, math.inf

    def __init__(self, first: float, last: float) -> None:
        self.first, self.rate = first, (last - first) / DURATION

    def pose(self, t: float) -> Pose:
        """Return where B is at a time [s]."""
        return Pose(TURNED, (self.first + self.rate * t, RAISED, 0.0))

    def twist(self, t: float) -> Twist:
        """Return how it moves."""
        del t
        return Twist((self.rate, 0.0, 0.0), (0.0, 0.0, 0.0))


class Followed(NamedTuple):
    """The printed law along a slide, at every tenth frame; distances below 0 in the overlap.

    Attributes
    ----------
    time : ndarray [s]
    true : ndarray
        -s of the direction with the least s, by brute force [length].
    told : ndarray
        |x - y| of the law, with the sign that H has [length].
    own : ndarray
        The distance by the library's own law [length].
    nearest_to_0 : ndarray
        Of the eigenvalues of H the one that is nearest to 0, without its sign [length²].
    tracker : Tracker
    """

    time: Array
    true: Array
    told: Array
    own: Array
    nearest_to_0: Array
    tracker: Tracker

    @property
    def error(self) -> Array:
        """Of the printed law [length]."""
        return np.asarray(np.abs(self.told - self.true))


@cache
def planar() -> tuple[so.Body, so.Body]:
    """Return the two ellipses of the picture; their ends are on the sides that turn away."""
    arcs = (
        ConicArc((0, 0), (-A_AXES[0], 0), (0, -A_AXES[1])),
        ConicArc((0, 0), (B_AXES[0], 0), (0, B_AXES[1])),
    )
    a, b = (so.shapes.planar_loop([arc]) for arc in arcs)
    return a, b


def support(pose: Pose) -> Supports:
    """Return the two ellipses by support functions."""
    turn = pose.rotation[:2, :2]
    q_b = turn @ np.diag(np.square(B_AXES)) @ turn.T
    return Supports(np.diag(np.square(A_AXES)), q_b, pose.translation[:2])


def least_way(pose: Pose) -> tuple[float, Array]:
    """Return the least s, and its direction, by brute force and Newton's method."""
    model = support(pose)
    angle = np.linspace(0.0, 2.0 * math.pi, DIRECTIONS, endpoint=False)
    ways = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    s = sum(np.sqrt(np.einsum("ni,ij,nj->n", ways, q, ways)) for q in (model.q_a, model.q_b))
    way = model.stationary(ways[np.argmin(s - ways @ model.middle)])
    assert way is not None, "no stationary direction beside the least sample"
    return model.at(way)[0], way


def points_of(pose: Pose, way: Array) -> tuple[Array, Array]:
    """Return the support points of A along a direction, and of B against it, (3,)."""
    model = support(pose)
    x = model.q_a @ way / math.sqrt(way @ model.q_a @ way)
    y = model.middle - model.q_b @ way / math.sqrt(way @ model.q_b @ way)
    return np.append(x, 0.0), np.append(y, 0.0)


@cache
def contact() -> float:
    """Return where the middle of B is when the ellipses touch, coming from outside [length]."""
    low, high = INSIDE[0], QUICK[0]

    def depth(x: float) -> float:
        return least_way(Slide(x, x).pose(0.0))[0]

    return float(scipy.optimize.brentq(depth, low, high, xtol=TOUCH_WITHIN, rtol=TOUCH_WITHIN))


def slow() -> tuple[float, float]:
    """Return the slow slide through contact."""
    return contact() + SLOW, contact() - SLOW


@cache
def followed(first: float, last: float) -> Followed:
    """Run the printed law from the nearest, or deepest, pair at the start of a slide."""
    path, time, (a, b) = Slide(first, last), even_times(0.0, DURATION, STEP), planar()
    law = PaperLaw(gain=GAIN, switching="none", saturation="zero", solve="plain", restarts=False)
    tracker, begin, still = Tracker(a, b, STEP, law=law), path.pose(0.0), Pose.identity()
    way = np.append(least_way(begin)[1], 0.0)
    x, y = points_of(begin, way[:2])
    places = place_at(a, still, x, way), place_at(b, begin, y, -way)
    state = begun(tracker, (REST, path), *places)
    step = motion_along(REST, path, time[:3])
    rows = step[0] + np.arange(len(time) - 1.0)[:, None] * (step[1] - step[0])  # a straight slide
    q = [[*places[0][1], *places[1][1]]]
    q += [buffer.out[[K.OUT_Q, K.OUT_Q + 2]].tolist() for buffer in stepped(tracker, state, rows)]
    default = Tracker(a, b, STEP)
    begun_by_itself = default.start(still, begin, None, path.twist(0.0))
    own = [begun_by_itself.proximity.distance]
    own += [buffer.distance for buffer in stepped(default, begun_by_itself, rows)]
    told, nearest, looks = [], [], range(0, len(time), EVERY)
    for k in looks:
        on = tuple((("edge", 0), (u,)) for u in q[k])
        system = pair_system(a, b, still, path.pose(time[k]), *on)
        of_h = np.linalg.eigvalsh(system.H)
        nearest.append(float(np.abs(of_h).min()))
        told.append(float(np.linalg.norm(system.dR)) * (1.0 if of_h[0] > 0.0 else -1.0))
    true = [-least_way(path.pose(time[k]))[0] for k in looks]
    return Followed(
        time[::EVERY],
        np.array(true),
        np.array(told),
        np.array(own[::EVERY]),
        np.array(nearest),
        tracker,
    )


def furthest() -> Artwork:
    """Make the figure."""
    quick = followed(*QUICK)
    return Artwork(
        caption=(
            "Above: two ellipses that overlap. Their boundaries have two stationary pairs of "
            "points with opposed normals: the deepest (green), along which B has the shortest way "
            "out, and the furthest (red, dashed), along which it has the longest. Beside it: "
            "|x − y| less the depth, where x and y are shifted from the deepest pair, both alike "
            "(across) and against each other (up) [length]: it is a saddle. Below: B comes slowly "
            f"through contact, {SLOW:g} length to either side in {DURATION:g} s. The printed law "
            "comes to a common point of both boundaries and stays there."
        ),
        text=(
            "Two overlapping ellipses with a short line across the overlap and a long one through "
            "both; contour lines of a saddle; a falling line that a second one leaves at contact "
            "to stay at zero."
        ),
        draw=_draw,
        tables={
            "stationary_pairs": _kinds_table(),
            "through_contact": _contact_table(followed(*slow())),
        },
        statements=measured_by(law_words(quick.tracker), _statements()),
        shown=("stationary_pairs",),
    )


NAMES = {0: "furthest: s is greatest", 1: "s has a saddle", 2: "depth: s is least"}


def _kinds_table() -> dict[str, list[str]]:
    """How many stationary pairs are of which kind, and the signs of H there."""
    every = [kind for found in kinds() for kind in found]
    rows = sorted({(kind.up, kind.signs) for kind in every}, reverse=True)
    return {
        "stationary pair": [NAMES[up] for up, _ in rows],
        "eigenvalues of H above, below 0": [f"{p}, {n}" for _, (p, n) in rows],
        "pairs": [str(sum((k.up, k.signs) == row for k in every)) for row in rows],
    }


def _contact_table(one: Followed) -> dict[str, Array]:
    return {
        "time_s": one.time,
        "true_length": one.true,
        "printed_law_length": one.told,
        "own_law_length": one.own,
        "least_eigenvalue_length2": one.nearest_to_0,
    }


def _statements() -> tuple[Statement, ...]:
    every = [kind for found in kinds() for kind in found]
    proved = sum(kind.signs == (kind.up, 4 - kind.up) for kind in every)
    deepest = [found[0] for found in kinds()]
    saddles = sum(kind.signs == (2, 2) for kind in deepest)
    inside, quick, slowly = (followed(*way) for way in (INSIDE, QUICK, slow()))
    stays = float(np.abs(slowly.told[-1]))
    return (
        Statement(
            FOOTNOTE,
            "the furthest points on two intersecting convex patches can be tracked",
            f"the same law, with the sign of K as it is, from the deepest pair through an overlap "
            f"of {-inside.true[0]:.2f} to {-inside.true[-1]:.2f}: off by at most "
            f"{inside.error.max():.0e} length; least |eigenvalue| of H "
            f"{inside.nearest_to_0.min():.2f}",
            bool(inside.error.max() < FOLLOWS),
            "Ψ' = −KΨ needs a regular M and not a definite one: the law goes to any stationary "
            "pair, and does not know of which kind it is",
        ),
        Statement(
            FOOTNOTE,
            NOTHING,
            f"of {len(every)} stationary pairs with opposed normals of {len(kinds())} pairs of "
            f"ellipsoids, H has as many positive eigenvalues as the Hessian of s at {proved}",
            proved == len(every),
            by=NO_LAW,
        ),
        Statement(
            FOOTNOTE,
            "read by the letter: the pair to track has |x − y| greatest over both patches",
            f"H is indefinite, (2, 2), at {saddles} of {len(deepest)} depths that so.distance "
            "proves: |x − y| is greatest over shifts of both points alike, and least over shifts "
            "against each other. Greatest outright it is at the longest way out",
            saddles == 0,
            "so a law that climbs |x − y| leaves the depth; the depth by directions is the same "
            "pair, as the least s",
            NO_LAW,
        ),
        Statement(
            "Section IV",
            "extensions to interpenetration are relatively straightforward",
            f"through contact the law as it is goes on if it is quick ({_rate(QUICK):.1g} length/s:"
            f" off by {quick.error.max():.0e}); slowly ({_rate(slow()):.0e} length/s) it stays at "
            f"a common point of both boundaries: it tells {stays:.0e} where the depth is "
            f"{-slowly.true[-1]:.0e}. The library's own law is off by "
            f"{np.abs(slowly.own - slowly.true).max():.0e}",
            bool(max(quick.error.max(), slowly.error.max()) < FOLLOWS),
            "at contact ΔR = 0, so Ψ = 0 for any common point, and M is singular: the contact-"
            "regular form has the normal as an unknown instead",
        ),
    )


NO_LAW = "so.distance and so.pair_system: no law"
"""Where nothing is tracked."""


def _rate(way: tuple[float, float]) -> float:
    """Speed of a slide [length/s]."""
    return abs(way[1] - way[0]) / DURATION


def _draw() -> Figure:
    figure = style.new_figure(height=6.2)
    halves: Any = figure.subfigures(2, 1, height_ratios=(1.15, 1.0))
    above, below = halves
    left, right = above.subplots(1, 2, width_ratios=(1.35, 1.0))
    _draw_pairs(left)
    _draw_saddle(right)
    one, scale, axes = followed(*slow()), 1.0 / SLOW, below.subplots()
    axes.plot(one.time, scale * one.true, color=style.QUIET, linewidth=5.0, label="true")
    axes.plot(one.time, scale * one.own, **style.line(0), label="library's own law")
    axes.plot(one.time, scale * one.told, **style.line(1), label="printed law")
    axes.set(xlabel="time [s]", ylabel="signed distance\n[length / 1000]")
    axes.legend(frameon=False, loc="upper right")
    return figure


def _draw_pairs(axes: Axes) -> None:
    pose, (a, b) = Slide(*INSIDE).pose(0.0), planar()
    draw_planar_body(axes, a, colour=style.BLUE)
    draw_planar_body(axes, b, pose, colour=style.ORANGE)
    for way, look in ((least_way(pose)[1], style.line(2)), (longest_way(pose), style.line(1))):
        x, y = points_of(pose, way)
        ends = np.array([x[:2], y[:2]])
        axes.plot(*ends.T, marker="o", markersize=4.0, zorder=5, **look)
    axes.text(-0.5, 0.25, "A", color=style.BLUE)
    axes.text(1.2, 0.25, "B", color=style.RED)
    show_plane(axes, 1.0)
    axes.set(xlim=(-0.95, 1.7), ylim=(-0.75, 0.75))


def longest_way(pose: Pose) -> Array:
    """Return the direction with the greatest s."""
    way = support(pose).stationary(-least_way(pose)[1])
    assert way is not None, "no stationary direction on the far side"
    return way


def _draw_saddle(axes: Axes) -> None:
    """|x - y| less the depth, over shifts along both ellipses from the deepest pair."""
    pose, shift = Slide(*INSIDE).pose(0.0), np.linspace(-REACH, REACH, 61)
    s, way = least_way(pose)
    alike, against = np.meshgrid(shift, shift)
    along = np.array([-way[1], way[0]])
    ends = []
    for side, half in ((0, 0.5), (1, -0.5)):
        turn = np.eye(2) if side == 0 else pose.rotation[:2, :2]
        size = np.array((A_AXES, B_AXES)[side])
        middle = side * pose.translation[:2]
        at = (points_of(pose, way)[side][:2] - middle) @ turn / size
        speed = (turn @ (size * np.array([-at[1], at[0]]))) @ along
        angle = math.atan2(at[1], at[0]) + (alike + half * against) / speed
        on = np.stack([size[0] * np.cos(angle), size[1] * np.sin(angle)], axis=-1)
        ends.append(middle + on @ turn.T)
    over = np.linalg.norm(ends[0] - ends[1], axis=-1) - s
    levels = [-0.06, -0.03, -0.01, 0.01, 0.03]
    lines = axes.contour(shift, shift, over, levels=levels, colors=style.QUIET, linewidths=0.8)
    axes.clabel(lines, fontsize=style.FONT - 3.0, fmt="%+.2f")
    axes.contour(shift, shift, over, levels=[0.0], colors=style.BLACK, linewidths=1.4)
    axes.plot(0.0, 0.0, "o", color=style.GREEN)
    axes.set(xlabel="both alike [length]", ylabel="against each other [length]")
    axes.set_xticks([-0.1, 0.0, 0.1])
    axes.set_aspect("equal")
    axes.grid(visible=False)
