"""Trackers that are led astray: started at any place, moved in leaps, given any twist, by any law.

Every pose has a known distance (`known_gaps`), so that bounds, statuses and numbers are checked
without a search, whatever the law does.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.body import layout as L
from standoff.kernels.entries import tracker as kernels
from standoff.kernels.state import arrays as K
from standoff.kernels.tolerances import BLUR, START_GAP
from standoff.tracking import calls
from standoff.tracking.block import FrameBlock
from standoff.tracking.law_options import Law
from standoff.tracking.laws import OptionsConflict, PaperLaw, law_of_facts
from standoff.tracking.status import Status
from standoff.tracking.tracker import Tracker
from standoff.typing import Array
from standoff_studies.oracles import HalfSpace, Region, Swept, lengths
from standoff_studies.soak import any_places as P
from standoff_studies.soak.certificate_checks import Miss, ask_all, worst
from standoff_studies.soak.checks import BLURRED, BOX_CENTRE, LEAST, ON_BODY, PROVEN, ROUNDOFF
from standoff_studies.soak.known_gaps import Scene
from standoff_studies.soak.motions import Frames
from standoff_studies.soak.placing import heights, outside
from standoff_studies.soak.tally import Tally

Rng = np.random.Generator

STEP = 1e-3
"""Time from frame to frame [s]."""

WILDEST = 90.0
"""Twists are up to 10 to this power."""

TOLD = 0.85
"""Share of the runs that are given twists."""

PLACES = 12
"""Places that are drawn to find one that lies on its features."""

FINITE = slice(K.POINT_A, K.OUT_MODE)
"""Columns of points and normal."""


class Run(NamedTuple):
    """A tracker's frames and answers, and how it was started.

    Attributes
    ----------
    scenes : list of Scene
        Of one pair, one for each frame.
    law : Law
    frames : Frames
    twists : bool
        Was it given those of the frames?
    given, place : int, list
        How it was started, and at which features, charts (2 + 2 numbers) and parameters.
    rows : (n, N_OUT) array
    """

    scenes: list[Scene]
    law: Law
    frames: Frames
    twists: bool
    given: int
    place: list[float]
    rows: Array


def draw_law(rng: Rng) -> Law:
    """Draw any law, with options that go together."""
    while True:
        try:
            return law_of_facts(_options(rng))
        except OptionsConflict:
            continue


def _options(rng: Rng) -> dict[str, Any]:
    def one(*names: str) -> str:
        return str(rng.choice(names))

    options: dict[str, Any] = {}
    if rng.random() < 0.5:
        options["tolerance"] = float(rng.choice([np.inf, 10.0 ** rng.uniform(-11.0, -4.0)]))
    if rng.random() < 0.3:
        options["depth"] = "local"
    if rng.random() < 0.4:
        options["deadline"] = int(10.0 ** rng.uniform(0.0, 2.3))
    if rng.random() < 0.4:
        names = ["feedforward-2", "feedforward", "secant", "none"]
        return {"law": "predictor-corrector", "predictor": one(*names), **options}
    if rng.random() < 0.2:
        printed = PaperLaw.as_printed(gain=float(rng.choice([25.0, 100.0, 800.0])))
        return printed.facts()
    options |= {
        "law": "paper",
        "integrator": one("euler", "heun", "midpoint", "rk4"),
        "realisation": one("evaluated", "integrated"),
        "switching": one("multipliers", "voronoi", "none"),
        "solve": one("ranked", "plain"),
        "feedforward": bool(rng.random() < 0.8),
        "restarts": bool(rng.random() < 0.5),
    }
    if rng.random() < 0.5:
        options["saturation"] = one("hold", "zero")
    if options["switching"] == "voronoi":
        options["reset"] = one("foot", "nearest")
    if rng.random() < 0.3:
        options["gain"] = float(rng.choice([10.0, 100.0, 900.0]))
    return options


def draw_frames(rng: Rng, scenes: list[Scene]) -> tuple[Frames, bool]:
    """The scenes' poses with twists of any size, and whether twists are given."""
    count = len(scenes)
    twists = rng.normal(size=(2, count, 6))
    draw = rng.random()
    if draw < 0.4:
        twists *= 10.0 ** rng.uniform(-3.0, 3.0, (2, count, 1))
    elif draw < 0.7:
        twists *= 10.0 ** rng.uniform(0.0, WILDEST, (2, count, 1))
    planar = scenes[0].a.body.dimension == 2 or scenes[0].b.body.dimension == 2
    if planar:
        twists[:, :, 2:5] = 0.0
    poses_a, poses_b = np.array([(s.pose_a, s.pose_b) for s in scenes]).swapaxes(0, 1)
    frames = Frames(poses_a, poses_b, twists[0], twists[1], np.full(count, STEP))
    return frames, bool(rng.random() < TOLD)


def run(rng: Rng, scenes: list[Scene]) -> Run:
    """Track a walk by a drawn law, from a drawn place."""
    a, b = scenes[0].a.body, scenes[0].b.body
    law = draw_law(rng)
    tracker = Tracker(a, b, STEP, law)
    frames, twists = draw_frames(rng, scenes)
    state, rows = np.zeros(K.N_STATE), np.empty((len(scenes), K.N_OUT))
    given = int(rng.choice([K.START_ANYWHERE, K.START_DESCEND, K.START_HERE], p=[0.1, 0.3, 0.6]))
    asked = ask_all(scenes[0], rng.random((PLACES, P.N_DRAWN)))
    asked = asked[asked[:, P.ON] > 0.5]
    if not len(asked):
        given = K.START_ANYWHERE
    else:
        place = asked[0, P.PLACE : P.PLACE + 8]
        state[K.MODE : K.MODE + 4] = place[[0, 1, 4, 5]]
        state[K.Q : K.Q + 4] = place[[2, 3, 6, 7]]
    begun = state[K.MODE : K.MODE + 8].tolist()
    motions, table = frames.motions, tracker.table
    block = FrameBlock.empty(state, motions[0], 0.0, twists)
    kernels.start(table.address, block.data, given)
    rows[0] = block.out
    rows[1:] = calls.run(table, motions[1:], twists, frames.steps[1:], block.state.copy()).rows
    return Run(scenes, law, frames, twists, given, begun, rows)


def misses(one: Run) -> Iterator[Miss]:
    """Check every answer of a run; return the worst frame of each failed check."""
    with np.errstate(all="ignore"):  # numbers that are not finite are reported
        yield from _bounds(one)
        yield from _along_normals(one)
        yield from _points(one)


def _bounds(one: Run) -> Iterator[Miss]:
    """The bounds hold, and a certified distance is the true one."""
    rows, status = one.rows, one.rows[:, K.STATUS].astype(int)
    truth, noise, slack, gap = _allowed(one)
    distance, lower, upper = (rows[:, k] for k in (K.DISTANCE, K.LOWER_BOUND, K.UPPER_BOUND))
    told = np.column_stack([distance, upper, rows[:, FINITE]])
    yield from worst("a number that is not finite", (~np.isfinite(told)).sum(axis=1) * 1.0, 0.0)
    no_bound = np.isnan(lower) | (lower == np.inf)
    yield from worst("a lower bound that is not a number", no_bound * 1.0, 0.0)
    yield from worst("the lower bound is above the distance", lower - truth, noise)
    yield from worst("the upper bound is below the distance", truth - upper, noise + slack)
    yield from worst("the distance is above its upper bound", distance - upper, noise)
    off = np.abs(distance - truth)
    yield from worst("CONVERGED at a wrong distance", off, gap, status == Status.CONVERGED.value)
    loose = gap + PROVEN * np.abs(distance)
    yield from worst("GLOBAL at a wrong depth", off, loose, status == Status.GLOBAL.value)


def _along_normals(one: Run) -> Iterator[Miss]:
    """A plane perpendicular to the normal separates by the lower bound; a depth separates the
    bodies."""
    a, b, rows = one.scenes[0].a, one.scenes[0].b, one.rows
    if isinstance(a.support, HalfSpace) or isinstance(b.support, HalfSpace):
        return
    _, noise, _, gap = _allowed(one)
    n, named = _normals(one)
    up = heights(a, one.frames.poses_a, n)[0] + heights(b, one.frames.poses_b, -n)[0]
    over = rows[:, K.LOWER_BOUND] + up
    yield from worst("the lower bound is above what its normal separates", over, noise, named)
    status = rows[:, K.STATUS].astype(int)
    deep = named & ((status == Status.LOCAL.value) | (status == Status.GLOBAL.value))
    yield from worst("the depth does not part the bodies", rows[:, K.DISTANCE] + up, gap, deep)


def _normals(one: Run) -> tuple[Array, NDArray[np.bool_]]:
    """The normals (n, 3), those of the scenes where none is reported, and where one is."""
    told = one.rows[:, K.NORMAL : K.NORMAL + 3]
    named = np.isfinite(told).all(axis=1) & (lengths(np.nan_to_num(told)) > 0.5)
    return np.where(named[:, None], told, [scene.normal for scene in one.scenes]), named


def _points(one: Run) -> Iterator[Miss]:
    """The witness points lie on their bodies, for bodies that can check it."""
    _, noise, slack, _ = _allowed(one)
    n, named = _normals(one)
    sides = (
        ("point_a is off A", one.scenes[0].a, one.frames.poses_a, K.POINT_A, 1.0),
        ("point_b is off B", one.scenes[0].b, one.frames.poses_b, K.POINT_B, -1.0),
    )
    for what, made, poses, at, sign in sides:
        core = made.support.core if isinstance(made.support, Swept) else made.support
        if isinstance(core, Region):
            out = outside(made, poses, one.rows[:, at : at + 3], sign * n)
            limit = ON_BODY / ROUNDOFF * noise + slack
            yield from worst(what, out, limit, named | (made.body.radius == 0.0))


def _allowed(one: Run) -> tuple[Array, Array, float, Array]:
    """The true distances, roundoff, slack, and the allowed error of a certified distance."""
    a, b = one.scenes[0].a, one.scenes[0].b
    truth = np.array([scene.truth for scene in one.scenes])
    sizes = sum(
        body.size + body.radius + float(np.linalg.norm(body.reals[BOX_CENTRE]))
        for body in (a.body, b.body)
        if body.bounded
    )
    away = lengths(one.frames.poses_a[:, 9:]) + lengths(one.frames.poses_b[:, 9:])
    # a point far away on a half-space's plane has the roundoff of its own coordinates
    points = one.rows[:, K.POINT_A : K.POINT_A + 6]
    far = np.abs(np.where(np.isfinite(points), points, 0.0)).max(axis=1)
    size = np.maximum(sizes + away + far + np.abs(truth), LEAST)
    noise = ROUNDOFF * size
    slack = float(a.body.reals[L.SLACK] + b.body.reals[L.SLACK])
    tolerance = one.law.tolerance if np.isfinite(one.law.tolerance) else START_GAP
    blur = BLUR if {a.shape.kind, b.shape.kind} & BLURRED else 0.0
    return truth, noise, slack, (tolerance + blur) * size + slack + noise


def count(tally: Tally, one: Run) -> None:
    """Count the frames by status."""
    tally.count("wild frames", len(one.rows))
    status = one.rows[:, K.STATUS].astype(int)
    for each in Status:
        tally.count(f"wild frames {each.name}", (status == each.value).sum())
