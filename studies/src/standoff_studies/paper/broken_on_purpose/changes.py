"""What the rows of the promises rest on, changed: each quotation is turned by a change.

``promises.toml`` names for each quotation the change that turns it; what the change is stands here.
``python -m standoff_studies.paper.broken_on_purpose --promises`` makes all and prints what turned.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import replace
from functools import cache, partial
from importlib import import_module
from time import perf_counter
from types import SimpleNamespace
from typing import Any, NamedTuple
from unittest.mock import patch

import numpy as np

import standoff as so
from standoff.geometry import BezierPatch, ellipsoid_patches
from standoff.kernels.pair import system
from standoff.points import PointTracker
from standoff.simulation import DeviceReadings
from standoff_studies.paper import (
    furthest,
    nonconvex,
    nonconvex_runs,
    normals_study,
    pair_simulation,
    patches,
    update_cost,
    voronoi_figure,
)
from standoff_studies.paper.broken_on_purpose import pages
from standoff_studies.paper.broken_on_purpose.breaks import BREAKS, PAPER, broken
from standoff_studies.paper.broken_on_purpose.matrix import FIGURES, statements_of
from standoff_studies.paper.catalogue import chosen
from standoff_studies.paper.control import gains, levels, lower, roots
from standoff_studies.paper.convergence import cells, rings
from standoff_studies.paper.convergence import figures as arrivals
from standoff_studies.paper.convergence.cells import Cell
from standoff_studies.paper.convergence.pairs import pair
from standoff_studies.paper.field import figures as field
from standoff_studies.paper.field import methods, newton, rows, support
from standoff_studies.paper.field.work import STEP as STEP_OF_FIELD
from standoff_studies.paper.field.work import Work
from standoff_studies.paper.figure import Statement
from standoff_studies.paper.in_the_loop import run as loop
from standoff_studies.paper.in_the_loop import statements as loop_said
from standoff_studies.paper.nonconvex_bore import in_bore
from standoff_studies.paper.promises import OF_A_PAGE, PROMISES, Shown
from standoff_studies.paper.realisations import run as realisations
from standoff_studies.paper.simulation_a import gains as gains_a
from standoff_studies.paper.simulation_a import run as run_a
from standoff_studies.paper.simulation_b import regions as regions_b
from standoff_studies.paper.simulation_b import run as run_b
from standoff_studies.paper.simulation_c import regions as regions_c
from standoff_studies.paper.verdicts import Verdict

Tracker = so.Tracker
harder: Any = import_module(f"{PAPER}.convergence.harder")  # the package has a function of its name
FOOT, ROOTS = patches._answer, vars(roots)["sampled_roots"]
ADVANCED, STEP = normals_study.advanced, update_cost.law_step
FUNCTIONS = levels.functions
SYSTEM: Any = so.tracking.pair_system
TRY, EXACT = vars(gains_a)["try_all"], loop.exact_distances
HESSIAN, FEEDFORWARD = system.hessian, system.feedforward
B, C, RUN = vars(regions_b)["run"], regions_c.regions, nonconvex_runs.run
DISTANCE, LEAST, LAW, TIMED = so.distance, so.min_gain, methods.law_of, loop._microseconds

Within = Callable[[], AbstractContextManager[Any]]


@contextmanager
def made_again() -> Iterator[None]:
    """Within, nothing counts that the studies keep of earlier runs; afterwards it does again."""
    fresh: dict[Any, Any] = {}
    with ExitStack() as stack:
        for module in [one for name, one in sys.modules.items() if name.startswith(f"{PAPER}.")]:
            for name, value in [*vars(module).items()]:
                if hasattr(value, "cache_info"):
                    again = fresh.setdefault(value, cache(value.__wrapped__))
                    stack.enter_context(patch.object(module, name, again))
        yield


def setting(*where: Any) -> Within:
    """A change of one attribute after the other: its owner, its name, its replacement."""

    @contextmanager
    def within() -> Iterator[None]:
        with ExitStack() as stack:
            for owner, name, by in zip(where[::3], where[1::3], where[2::3], strict=True):
                stack.enter_context(patch.object(owner, name, by))
            yield

    return within


def replacing(*where: Any) -> Within:
    """The same, within which all runs are made again."""

    @contextmanager
    def within() -> Iterator[None]:
        with made_again(), setting(*where)():
            yield

    return within


def edited(old: str, new: str) -> Within:
    """Another code of a page."""
    return lambda: patch.dict(pages.EDITS, {old: new})


def following(change: Callable[[Any, float], Any]) -> type[so.Tracker]:
    """Trackers whose law, where one is given, is changed."""

    class Changed(Tracker):
        def __init__(self, a: Any, b: Any, dt: float = 1e-3, **options: Any) -> None:
            if "law" in options:
                options["law"] = change(options["law"], dt)
            super().__init__(a, b, dt, **options)

    return Changed


def gain_halved(law: Any, dt: float) -> Any:
    """Half of the gain, whatever rules it."""
    if not isinstance(law, so.PaperLaw):
        return law
    ruled = law.feedback
    if isinstance(ruled, so.feedback.Linear):
        return replace(law, feedback=replace(ruled, gain=0.5 * ruled.gain))
    if isinstance(ruled, so.feedback.PI):
        slower = so.feedback.PI(0.5 * ruled.gain, 0.25 * ruled.integral)  # of the same damping
        return replace(law, feedback=slower)
    return law if law.feedback else replace(law, gain=0.5 * (law.gain or 1.0 / dt))


def realised_otherwise(law: Any, dt: float) -> Any:
    """Fig. 3's loop of first order, Fig. 4's with half the gain."""
    if not isinstance(law, so.PaperLaw):
        return law
    return (
        replace(law, integrator="euler")
        if law.realisation == "integrated"
        else gain_halved(law, dt)
    )


def long_steps(law: Any, dt: float) -> Any:
    """K h = 1.5."""
    return replace(law, gain=1.5 / dt) if isinstance(law, so.PaperLaw) else law


def near_the_limit(law: Any, dt: float) -> Any:
    """K h = 1.9."""
    return replace(law, gain=1.9 / dt) if isinstance(law, so.PaperLaw) else law


def without_feedforward(law: Any, dt: float) -> Any:
    """The printed law without b."""
    return replace(law, feedforward=False) if isinstance(law, so.PaperLaw) else law


def otherwise_predicted(law: Any, dt: float) -> Any:
    """With a feedforward where there was none, without where there was one."""
    if isinstance(law, so.PaperLaw):
        return replace(law, feedforward=False)
    return replace(law, predictor="feedforward" if law.predictor == "none" else "none")


def covariant_and_loose(law: Any, dt: float) -> Any:
    """Another M at rest, and an online gain for twice the error."""
    if isinstance(law.feedback, so.feedback.MotionGain):
        return replace(law, feedback=so.feedback.MotionGain(2.0 * law.feedback.error, least=1.0))
    return replace(law, solve="covariant") if law.gain == 500.0 else law


LOOSE = so.PaperLaw(gain=20.0)
"""A law that lags, in place of the default, whose frames are certified."""


def defaulting(law: Any) -> type[so.Tracker]:
    """Trackers that take it where no law is given."""

    class Changed(Tracker):
        def __init__(self, a: Any, b: Any, dt: float = 1e-3, **options: Any) -> None:
            super().__init__(a, b, dt, **({"law": law} | options))

    return Changed


class LoosePoint(PointTracker):
    """A point's tracker that does so."""

    def __init__(self, body: Any, dt: float = 1e-3, law: Any = LOOSE) -> None:
        super().__init__(body, dt, law)


class Stretched(BezierPatch):
    """A patch whose jets have tangents twice as long."""

    def jet(self, u: float, v: float) -> Any:
        """The jet."""
        x, *partials = super().jet(u, v)
        return x, *(2.0 * partial for partial in partials)


def beside_the_foot(*pair: Any) -> Any:
    """The equations at a place beside the closest points."""
    answer, _ = FOOT(*pair)
    (feature_a, q_a), place_b = answer.place_a, answer.place_b
    return answer, SYSTEM(*pair, (feature_a, np.array(q_a) + 1e-3), place_b)


def half_arrived() -> tuple[Cell, ...]:
    """Half of the starts that arrived."""
    halved = ("arrived", "right", "settled", "definite", "definite_arrived", "right_arrived")
    return tuple(
        replace(cell, **{name: getattr(cell, name) // 2 for name in halved})
        for cell in cells.committed()
    )


def of_another_feature(*pair: Any) -> SimpleNamespace:
    """An answer with the other body's feature."""
    answer = DISTANCE(*pair)
    return SimpleNamespace(
        certified=answer.certified, distance=answer.distance, feature_a=answer.feature_b
    )


def without_a_line() -> Any:
    """Simulation B with one Voronoi line and one branch of the medial axis left out."""
    run = B()
    regions = replace(
        run.regions, external=run.regions.external[1:], medial_axis=run.regions.medial_axis[1:]
    )
    return run._replace(regions=regions)


def turned_inwards() -> Any:
    """Simulation C's external lines, which go inwards."""
    return tuple(
        replace(one, external=tuple(x._replace(directions=-x.directions) for x in one.external))
        for one in C()
    )


def of_other_signs(*at: Any) -> Any:
    """E with the other sign."""
    v, energy, least = FUNCTIONS(*at)
    return v, -energy, -least


def by_euler(integrator: str, *rest: Any) -> Any:
    """The roots by Euler's method."""
    return ROOTS("euler", *rest)


def half_a_step(*given: Any) -> Any:
    """From where it is, half of the way that the law goes."""
    q = given[3]
    return q + 0.5 * (STEP(*given) - q)


def hardly_moved(at: Any, points: Any, steps: Any) -> Any:
    """A fiftieth of a step."""
    return ADVANCED(at, points, 0.02 * steps)


def first_forms(*at: Any) -> Any:
    """The system with H of the first fundamental forms alone."""
    now = SYSTEM(*at)
    both = np.hstack([now.F, -now.G])
    return now._replace(H=both.T @ both)


def unmasked(jet_a: Any, jet_b: Any) -> Any:
    """H without the 1 of a missing parameter."""
    found = list(HESSIAN(jet_a, jet_b))
    for place, tangent in zip((0, 4, 7, 9), (*jet_a[1:3], *jet_b[1:3]), strict=True):
        found[place] *= float(any(tangent))
    return found


def turning_only(jet_a: Any, jet_b: Any, *motions: Any) -> Any:
    """b for rotation only, as it is printed."""
    return FEEDFORWARD(jet_a, jet_b, *((p, (0.0, 0.0, 0.0), w) for p, _, w in motions))


def unsigned(*pair: Any, **options: Any) -> Any:
    """An answer without a depth, as GJK's."""
    found = DISTANCE(*pair, **options)
    return SimpleNamespace(
        distance=max(found.distance, 0.0), depth=0.0, normal=found.normal, status=found.status
    )


def without_weights(*axes: float) -> tuple[BezierPatch, ...]:
    """An ellipsoid's patches that are polynomials."""
    return tuple(BezierPatch(one.control_points) for one in ellipsoid_patches(*axes))


def half_the_least(*pair: Any, **options: Any) -> Any:
    """Half of the least gain."""
    return 0.5 * LEAST(*pair, **options)


def one_branch(reading: str, leave_out: int | None = None) -> Any:
    """A run in which the branch that answers at the start always answers."""
    one = RUN(reading, leave_out)
    return one._replace(active=np.full_like(one.active, one.active[0]))


def many_ticks(one: Any) -> float:
    """The time of a tick with three hundred steps [µs]."""
    given = DeviceReadings.along(loop.hand_pose, 20, loop.PERIOD)
    state, began = one.start().engage(), perf_counter()
    for _ in range(300):
        one.run(state, len(given), len(given), device=given)
    return 1e6 * (perf_counter() - began) / len(given)


def a_tick_late(made: Any) -> Any:
    """The certified distances of the poses before."""
    found = EXACT(made)
    return np.append(found[:1], found[:-1])


SOFTER = replace(loop.CONTACT, stiffness=0.25 * loop.CONTACT.stiffness)
"""A contact whose stiffness explains a quarter of the forces."""
OVER_A_FACE = ((5.0, 25.0), (15.0, 25.0))
"""The first half of a hand's way over one face [degrees]."""


# Two figures show studies that were run before. Their changes act on a share that is run anew, with
# the law as it is and changed, and turn a verdict if it differs between these two.

FEW_STARTS = 4
RING = "ring and point"
TURNED, SHARPENED = {30.0: ("turning 0, 30",)}, {1000.0: ("sharp 2, 1000",)}


def few_cells(name: str) -> tuple[Cell, ...]:
    """Run a few starts of three of the harder cells."""
    assert name == harder.HARDER
    names = [("rest", x) for x in (*TURNED[30.0], *SHARPENED[1000.0])]
    names += [("moving", x) for x in TURNED[30.0]]
    return tuple(
        cells.made((x, motion, law, gain), FEW_STARTS)[0]
        for motion, x in names
        for law, gain in cells.HARDER_LAWS.items()
    )


FEW_HARDER = replacing(
    *(harder, "committed", few_cells, harder, "TURNING", TURNED, harder, "SHARP", SHARPENED),
    *(harder, "RATES", tuple(TURNED), harder, "RATIOS", tuple(SHARPENED)),
    *(harder, "KINDS", {RING: rings.KINDS[RING]}, rings, "KINDS", {RING: rings.KINDS[RING]}),
)

EXCHANGED = {
    "printed": cells.LAWS["covariant-hold"],
    "covariant-hold": cells.LAWS["printed"],
    "newton": cells.LAWS["newton"],
}
"""The printed law and the covariant one, each in place of the other,"""
RINGS_EXCHANGED = rings.RING_LAWS | {
    "as printed": rings.RING_LAWS["covariant, by principal directions"],
    "covariant, by principal directions": rings.RING_LAWS["as printed"],
}
"""and on rings."""

WORKS = (("A point", (0.3, 2.0)), ("B", (0.2, 1.1)), ("E patches", (0.5, 2.6)))
"""Work of the field, and the instants at which its frames begin [s]."""
ANEW = ("newton", "blind", "paper")
"""Methods that are run anew; of GJK a frame is."""


def few_rows() -> tuple[rows.Row, ...]:
    """Run some methods on a little work; of the others there is what was stored."""
    some = [Work(key[0], pair(key), at, frames=2, starts=12) for key, at in WORKS]
    made = rows.study(some, ANEW)
    made += rows.study([Work("A", pair("A point"), (0.3,), frames=1, starts=0)], ["gjk"])
    own = {(row.method, row.work): row for row in made}
    stored = [row for row in rows.committed() if row.work in "ABE"]
    return tuple(own.get((row.method, row.work), row) for row in stored)


FEW_ROWS = replacing(field, "committed", few_rows)
SHARES: Mapping[str, Within] = {"harder": FEW_HARDER, "field": FEW_ROWS}


def of_the_law(change: Callable[[so.PaperLaw], so.PaperLaw], step: float = STEP_OF_FIELD) -> Within:
    """The printed law of the field changed, and its frame time [s]."""

    def law_of(key: str, gain: float = 1.0 / STEP_OF_FIELD) -> Any:
        return change(LAW(key, gain)) if key == "paper" else LAW(key, gain)

    return replacing(methods, "law_of", law_of, methods, "STEP", step)


def of_a_method(key: str, step: Callable[..., Any]) -> Within:
    """Another step of a method of the field."""
    changed = methods.METHODS[key]._replace(run=lambda work: methods.on_patches(work, step))
    return lambda: patch.dict(methods.METHODS, {key: changed})


def given_up(*at: Any) -> Any:
    """A method that gives up."""
    raise support.Lost


OTHERWISE, HALVED = following(realised_otherwise), following(gain_halved)
LAGGING = replacing(pair_simulation, "Tracker", defaulting(LOOSE))
UNFED = following(without_feedforward)
CHANGES: dict[tuple[str, str], Within] = {
    ("1", "tangents twice as long"): replacing(
        patches, "curved_face", lambda: Stretched(patches._control_points())
    ),
    ("2", "a place beside the foot"): replacing(patches, "_answer", beside_the_foot),
    ("3", "Euler's method"): replacing(realisations, "Tracker", OTHERWISE),
    ("4", "Euler's method, gain halved"): replacing(realisations, "Tracker", OTHERWISE),
    ("5", "distances a tick late"): replacing(loop, "exact_distances", a_tick_late),
    ("5", "300 steps in a tick"): replacing(loop, "_microseconds", many_ticks),
    ("5", "a hand over one face"): replacing(
        loop, "WAY", OVER_A_FACE, loop, "WAY_DOWN", ((20.0, 25.0), (30.0, 25.0))
    ),
    ("5", "a quarter of the stiffness"): replacing(loop_said, "CONTACT", SOFTER),
    ("7", "K h = 1.9, another start"): replacing(
        *(run_a, "Tracker", following(near_the_limit), gains_a, "START", (0.3, 0.4)),
        *(gains_a, "try_all", lambda at, k, frames: TRY(at, 0.0 * k + 1900.0, frames)),
    ),
    ("8", "a line and a branch left out"): replacing(regions_b, "run", without_a_line),
    ("10", "the default law lags"): replacing(run_b, "PointTracker", LoosePoint),
    ("12", "lines that go inwards"): replacing(regions_c, "regions", turned_inwards),
    ("16", "the default law lags"): LAGGING,
    ("19", "the default law lags"): LAGGING,
    ("arrivals", "half as many arrive"): replacing(arrivals, "committed", half_arrived),
    ("harder", "the printed and the covariant M exchanged"): replacing(
        cells, "LAWS", EXCHANGED, rings, "RING_LAWS", RINGS_EXCHANGED
    ),
    ("voronoi", "the other body's feature"): replacing(
        voronoi_figure, "distance", of_another_feature
    ),
    ("gains", "gain halved, all limits 2"): replacing(
        so, "Tracker", HALVED, gains, "stability_limit", lambda name: 2.0
    ),
    ("lower", "an error that can be kept"): replacing(lower, "OUTRUN", lower.KEPT),
    ("lower", "half of the least gain"): replacing(so, "min_gain", half_the_least),
    ("lower", "gain halved"): replacing(so, "Tracker", HALVED),
    ("stability", "Euler's roots for all"): replacing(roots, "sampled_roots", by_euler),
    ("feedback", "gain halved"): replacing(so, "Tracker", HALVED),
    ("basin", "K h = 1.5"): replacing(so, "Tracker", following(long_steps)),
    ("lyapunov", "20 frames, −E for E"): replacing(
        levels, "FRAMES", 20, levels, "functions", of_other_signs
    ),
    ("normals", "a fiftieth of each step"): replacing(normals_study, "advanced", hardly_moved),
    ("nonconvex", "no feedforward"): replacing(nonconvex_runs, "Tracker", UNFED),
    ("nonconvex", "one branch answers"): replacing(nonconvex, "run", one_branch),
    ("nonconvex", "a pin within the evolute"): replacing(
        nonconvex, "in_bore", lambda: in_bore(0.05)
    ),
    ("nonconvex", "minima asked up to 1 length"): replacing(nonconvex_runs, "FAR", 1.0),
    ("furthest", "no feedforward"): replacing(furthest, "Tracker", UNFED),
    ("furthest", "first fundamental forms for H"): replacing(furthest, "pair_system", first_forms),
    ("furthest", "quick through contact"): replacing(furthest, "SLOW", 0.49),
    ("variants", "the covariant M, a loose gain"): replacing(
        so, "Tracker", following(covariant_and_loose)
    ),
    ("cost", "half of the law's step"): replacing(update_cost, "law_step", half_a_step),
    ("verdict", "feedforwards exchanged"): replacing(so, "Tracker", following(otherwise_predicted)),
    ("field", "two Newton steps with a test"): of_a_method("blind", newton.newton),
    ("field", "RK4"): of_the_law(lambda law: replace(law, integrator="rk4")),
    ("field", "Newton's step for the law's"): of_the_law(
        lambda law: replace(law, integrator="euler", gain=1.0 / STEP_OF_FIELD)
    ),
    ("field", "a law that lags"): of_the_law(
        lambda law: replace(law, gain=20.0, feedforward=False), step=0.05
    ),
    ("field", "a GJK that gives up"): of_a_method("gjk", given_up),
    ("../automaton.md", "a tracker that asks regions"): setting(so, "Tracker", pages.Asking),
    ("../automaton.md", "a lens for the ellipsoid"): setting(
        so.shapes, "ellipsoid", lambda *axes: so.shapes.lens(1.0, 0.45)
    ),
    ("../automaton.md", "minima asked up to 0.3 length"): edited("minima=0.75", "minima=0.3"),
    ("../benchmarks.md", "exact bodies for the hulls"): setting(pages, "FELT", pages.exact),
    ("../certificate.md", "one face turned"): setting(pages, "TILT", 0.1),
    ("../convexity.md", "a patch that bulges"): edited("-= sign * sag", "+= sign * sag"),
    ("../laws.md", "gain halved"): setting(so, "Tracker", HALVED),
    ("../pair-system.md", "b for rotation only"): setting(system, "feedforward", turning_only),
    ("../pair-system.md", "first fundamental forms for H"): setting(
        so.tracking, "pair_system", first_forms
    ),
    ("../pair-system.md", "missing parameters not held"): setting(system, "hessian", unmasked),
    ("../penetration.md", "depth='local'"): setting(pages, "DEPTH", "local"),
    ("../penetration.md", "distances without a sign"): setting(so, "distance", unsigned),
    ("../servo-loop.md", "1000 steps in a tick"): setting(pages, "STEPS", 1000),
    ("../solids.md", "a swing fifty times as fast"): edited("0.2, 101)", "0.2, 3)"),
    ("../solids.md", "bounds ten frames late"): setting(pages, "LATE", 10),
    ("../solids.md", "minima asked up to 1 length"): setting(pages, "REACH", 1.0),
    ("../surfaces.md", "no weights"): edited(
        "patches[0].jet", "type(patches[0])(patches[0].control_points).jet"
    ),
    ("../surfaces.md", "the pole outside"): edited("1/(u - 0.3)", "1/(u + 0.3)"),
    ("definite.md", "first fundamental forms for H"): setting(
        so.tracking, "pair_system", first_forms
    ),
    ("definite.md", "the second form left out"): edited("F.T @ F + second @ dR", "F.T @ F"),
} | {(figure, one.key): partial(broken, one) for one in BREAKS for figure in FIGURES}
"""By figure or page, and by the name that ``promises.toml`` has."""


class Turned(NamedTuple):
    """What a change turned.

    Attributes
    ----------
    key, by : str
        The figure or page, and the name of the change.
    turned, unturned : tuple of Shown
        Quotations that are no longer so, and those that still are.
    """

    key: str
    by: str
    turned: tuple[Shown, ...]
    unturned: tuple[Shown, ...]


def quoted(key: str, by: str = "") -> tuple[Shown, ...]:
    """Return the quotations of a figure or page, each once; those of a change if it is named."""
    every = [one for rows in PROMISES.values() for row in rows for one in row.shown]
    own = [one for one in every if one.key == key and by in ("", one.turned_by)]
    return tuple(dict.fromkeys(own))


def turned_by(key: str, by: str) -> Turned:
    """Make a change and return which quotations that name it are turned."""
    own, within = quoted(key, by), CHANGES[key, by]
    for entry in chosen([key]) if not key.endswith(OF_A_PAGE) else ():
        import_module(entry.module)  # what is imported within would keep the runs made there
    if key.endswith(OF_A_PAGE):
        with within():
            turned = {one for one in own if not pages.holds(key, one.number)}
    elif key in SHARES:
        turned = _turned_in_share(key, own, within)
    else:
        with within():
            changed = statements_of(key)
        turned = {one for one in own if one.fault(changed)}
    still = tuple(one for one in own if one not in turned)
    return Turned(key, by, tuple(one for one in own if one in turned), still)


@cache
def _in_share(key: str) -> tuple[Statement, ...]:
    """A figure's statements in the share that is run anew, with the law as it is."""
    with SHARES[key]():
        return statements_of(key)


def _turned_in_share(key: str, own: Iterable[Shown], within: Within) -> set[Shown]:
    """Of a study that was run before: whose verdict is another in a share of it, changed, and of a
    measurement of our own what is another number."""
    known, turned = _in_share(key), set()
    with SHARES[key](), within():
        changed = statements_of(key)
    for one in own:
        # without words of the paper, by its number in what is stored
        there = [one.words in x.stated for x in known]
        if not one.words:
            there = [one.is_of(x) for x in statements_of(key)]
        now, then = known[there.index(True)], changed[there.index(True)]
        if Verdict.of(now) is not one.verdict:
            raise AssertionError(f"{one.text}: the share says {now.measured}")
        number = one.verdict is Verdict.OWN and then.measured != now.measured
        if number or Verdict.of(then) is not one.verdict:
            turned.add(one)
    return turned


def markdown(found: Iterable[Turned]) -> str:
    """Return a table of changes and of what they turned."""
    lines = ["| figure or page | change | turned | still so |", "|---|---|---|---|"]
    for one in found:
        cells_of = ["; ".join(x.text for x in part) or "–" for part in (one.turned, one.unturned)]
        lines.append(f"| {one.key} | {one.by} | {cells_of[0]} | {cells_of[1]} |")
    return "\n".join(lines)
