"""The cost of an update: the law's single time step compared with iterations of equal accuracy."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from standoff.tracking.pair_system import PairSystem, PairSystems
from standoff.tracking.rows import poses_of, twists_of
from standoff.typing import Array
from standoff_studies.paper import style
from standoff_studies.paper.figure import Artwork, Statement, own_statement
from standoff_studies.paper.many_starts import motion_along
from standoff_studies.paper.simulation_e.runs import SIMULATION, pair

FIRST, UPDATES = 50, 400
"""First frame, and number of updates: simulation E's first stay, face against face, 0 to 1.06 s."""

TARGETS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
"""Witness errors at which the iterations end [length]; the bodies are of size 2."""

MOST = 2000
"""Iterations after which one counts as not having reached the accuracy."""

HALVINGS = 40
"""Greatest number of halvings of a step in a line search."""

ENOUGH = 1e-4
"""Fraction of the predicted decrease that a step must achieve: the usual one of Armijo's rule."""

BY = (
    "Eq. (12), Heun and Euler, K = 1000/s, M as it is, exact start; iterations from their last "
    "answer"
)
"""The law and the setting with which the statements were measured."""

FIRST_ORDER = 0.5
"""Cost of a first-order evaluation as a fraction of a second-order one: it needs three of a jet's
six vectors, and no M. In fact it is rather less, since nothing is factored."""

PRICES = {"Newton": 1.0, "quasi-Newton (BFGS)": FIRST_ORDER, "gradient descent": FIRST_ORDER}
"""Each iteration, and the cost of one of its evaluations."""

SPELT = {
    "Newton": "Newton's iteration",
    "quasi-Newton (BFGS)": "a quasi-Newton iteration",
    "gradient descent": "gradient descent",
}
"""The iterations, as the paper's claims name them."""

LEAST_ASKED = 1e-6
"""The finest accuracy for which one Newton step is enough in every update [length]."""

STAGES = {"heun": 2, "euler": 1}
"""Evaluations of a step: the paper integrates by the first, a second-order Runge–Kutta method."""

LAWS = {
    "heun": "the law's one step (Heun, K h = 1: the paper's integrator)",
    "euler": "the law's one step (Euler, K h = 1)",
}


class Frame(NamedTuple):
    """Poses and twists of one frame as the kernels read them, and the closest points."""

    flat_a: Array
    flat_b: Array
    xi_a: Array
    xi_b: Array
    points: Array


class Spent(NamedTuple):
    """The cost of the updates by one method.

    Attributes
    ----------
    evaluations : ndarray of float, shape (UPDATES,)
        In each update; nan if it did not reach the accuracy.
    error : float
        Greatest witness error after an update [length].
    price : float
        Cost of an evaluation: 1 with M, `FIRST_ORDER` without.
    """

    evaluations: Array
    error: float
    price: float = 1.0

    @property
    def cost(self) -> float:
        """Mean cost of an update, in second-order evaluations."""
        return self.price * float(np.nanmean(self.evaluations))


@cache
def frames() -> tuple[Frame, ...]:
    """The frames of the updates, and the one before them."""
    exact, numbers = SIMULATION.exact, np.arange(FIRST - 1, FIRST + UPDATES + 1)
    rows = motion_along(*SIMULATION.paths, np.asarray(numbers * SIMULATION.step))
    points = np.stack([exact.point_a, exact.point_b], axis=1)[numbers[1:]]
    return tuple(map(Frame, *poses_of(rows), *twists_of(rows), points))


def start() -> tuple[PairSystems, Array]:
    """The pair's system, and the exact parameters before the first update."""
    exact = SIMULATION.exact
    places = [
        (feature[FIRST], parameters[FIRST, :2])
        for feature, parameters in (
            (exact.feature_a, exact.parameters_a),
            (exact.feature_b, exact.parameters_b),
        )
    ]
    systems = PairSystems(*pair(), *places)
    return systems, systems.q.copy()


class Problem:
    """Distance at one frame, with a count of evaluations; ``off`` needs no evaluation."""

    def __init__(self, systems: PairSystems, frame: Frame) -> None:
        self.systems, self.frame, self.count = systems, frame, 0

    def at(self, q: Array) -> PairSystem:
        self.count += 1
        return self.systems.at(q, self.frame.flat_a, self.frame.flat_b, *self.frame[2:4])

    def off(self, q: Array) -> float:
        """The greater distance of a witness point from the closest point [length]."""
        a, b = pair()
        exact = SIMULATION.exact
        places = (
            (a, exact.feature_a[FIRST], q[:2], self.frame.flat_a),
            (b, exact.feature_b[FIRST], q[2:], self.frame.flat_b),
        )
        away = []
        for (body, feature, at, flat), due in zip(places, self.frame.points, strict=True):
            point = body.face_parts[feature.index].charts[0].jet(*at.tolist())[0]
            away.append(np.linalg.norm(flat[:9].reshape(3, 3) @ point + flat[9:] - due))
        return float(max(away))


def law_step(systems: PairSystems, before: Frame, now: Frame, q: Array, integrator: str) -> Array:
    """One time step of the law, Eq. (12), at K h = 1, by Euler's method or by Heun's."""

    def rates(frame: Frame, at_q: Array) -> Array:
        at = systems.at(at_q, *frame[:4])
        return np.asarray(np.linalg.solve(at.M, -at.Psi / SIMULATION.step - at.b))

    first = rates(before, q)
    trial = np.asarray(q + SIMULATION.step * first)
    if integrator == "euler":
        return trial
    return np.asarray(q + 0.5 * SIMULATION.step * (first + rates(now, trial)))


def newton(problem: Problem, q: Array, target: float, memory: dict[str, Any]) -> Array:
    """Newton's iteration from the last answer."""
    for _ in range(MOST):
        at = problem.at(q)
        if problem.off(q) <= target:
            return q
        q = q - np.linalg.solve(at.H, at.g)
    raise ArithmeticError("Newton's iteration did not come to the accuracy.")


def descent(
    problem: Problem, q: Array, target: float, memory: dict[str, Any], *, quasi: bool
) -> Array:
    """Gradient descent or BFGS with a line search; step and inverse Hessian are carried over."""
    inverse = memory.get("inverse", np.eye(4))
    size = memory.get("size", 1.0)
    at = problem.at(q)
    for _ in range(MOST):
        if problem.off(q) <= target:
            memory |= {"inverse": inverse, "size": size}
            return q
        way = -inverse @ at.g
        energy, slope = 0.5 * at.dR @ at.dR, at.g @ way
        part = 1.0 if quasi else 2.0 * size
        for _ in range(HALVINGS):
            new = problem.at(q + part * way)
            if 0.5 * new.dR @ new.dR <= energy + ENOUGH * part * slope:
                break
            part *= 0.5
        size, move, turn = part, part * way, new.g - at.g
        if quasi and move @ turn > 0.0:
            inverse = _bfgs(inverse, move, turn)
        q, at = q + move, new
    raise ArithmeticError("The descent did not come to the accuracy.")


def _bfgs(inverse: Array, move: Array, turn: Array) -> Array:
    """The inverse Hessian after one step, by Broyden, Fletcher, Goldfarb and Shanno."""
    rho = 1.0 / (move @ turn)
    left = np.eye(len(move)) - rho * np.outer(move, turn)
    return np.asarray(left @ inverse @ left.T + rho * np.outer(move, move))


METHODS: dict[str, Callable[[Problem, Array, float, dict[str, Any]], Array]] = {
    "Newton": newton,
    "quasi-Newton (BFGS)": partial(descent, quasi=True),
    "gradient descent": partial(descent, quasi=False),
}


@cache
def law_spent(integrator: str) -> Spent:
    """The law's updates."""
    systems, q = start()
    errors = []
    for before, now in zip(frames()[:-1], frames()[1:], strict=True):
        q = law_step(systems, before, now, q, integrator)
        errors.append(Problem(systems, now).off(q))
    return Spent(np.full(UPDATES, float(STAGES[integrator])), max(errors))


@cache
def spent(method: str, target: float) -> Spent:
    """An iteration's updates, each from the last answer, to a witness error [length].

    It ends as soon as it has reached that error, so no stopping test could end it earlier.
    """
    systems, q = start()
    memory: dict[str, Any] = {}
    counts: list[float] = []
    errors: list[float] = []
    for frame in frames()[1:]:
        problem = Problem(systems, frame)
        try:
            q = METHODS[method](problem, q, target, memory)
        except ArithmeticError:
            # reported as not arrived; the next update begins at this one's exact answer
            counts.append(np.nan)
            continue
        counts.append(float(problem.count))
        errors.append(problem.off(q))
    return Spent(np.array(counts), max(errors, default=np.nan), PRICES[method])


def update_cost() -> Artwork:
    """The picture, table and statements."""
    return Artwork(
        caption=(
            "What one update costs, two faces in motion at 1 kHz (simulation E's first stay, "
            f"{UPDATES} updates), against the greatest witness error that is asked for. The unit "
            "is an evaluation of second order, of Ψ and M; one of first order, of Ψ alone, counts "
            f"as {FIRST_ORDER:g}: it needs half of a jet's vectors. The iterations begin at their "
            "last answer and are told when they have come; the law takes one time step, by the "
            "paper's integrator in two evaluations or by Euler's method in one, and leaves the "
            "error that its marks stand at."
        ),
        text=(
            "A diagram of cost against accuracy. The law's marks stand at two and one, Newton's "
            "line at two and three, the quasi-Newton line at one and a little above, and gradient "
            "descent far above."
        ),
        draw=draw,
        tables={"cost": table()},
        statements=statements(),
        shown=("cost",),
    )


def table() -> dict[str, list[str]]:
    """Mean and greatest number of evaluations, and their cost, by method and accuracy."""
    rows = [
        (LAWS[integrator], f"{law_spent(integrator).error:.1e}", law_spent(integrator))
        for integrator in STAGES
    ]
    rows += [(name, f"{target:.0e}", spent(name, target)) for name in PRICES for target in TARGETS]
    return {
        "method": [name for name, _, _ in rows],
        "witness error": [error for _, error, _ in rows],
        "evaluations of": ["Ψ and M" if got.price == 1.0 else "Ψ alone" for _, _, got in rows],
        "mean": [_mean(got) for _, _, got in rows],
        "most": [_most(got) for _, _, got in rows],
        "cost, mean": [f"{got.cost:.1f}" for _, _, got in rows],
    }


def _mean(got: Spent) -> str:
    there = got.evaluations[np.isfinite(got.evaluations)]
    return f"{there.mean():.1f}" if len(there) else "–"


def _most(got: Spent) -> str:
    lost = int(np.isnan(got.evaluations).sum())
    most = np.nanmax(got.evaluations) if lost < UPDATES else np.nan
    return f"{most:.0f}" + (f", {lost} not" if lost else "")


def same_accuracy() -> float:
    """The accuracy at which the iterations are compared with the law [length]: the law's own."""
    return law_spent("heun").error


def statements() -> tuple[Statement, ...]:
    """The claims about an update, with a verdict."""
    return (_one_step(), *(_cheaper_than(name) for name in PRICES), _where_less_is_asked())


def _one_step() -> Statement:
    heun, euler = law_spent("heun"), law_spent("euler")
    return Statement(
        "Section I",
        "each update takes only one time step",
        "one step an update, no test and no loop: by the paper's integrator two evaluations and "
        f"solves, witness points at most {heun.error:.1e} length off; by Euler's method one, "
        f"{euler.error:.1e}",
        True,
        "that is what integrating with a fixed step means",
        BY,
        constructed=True,
    )


WHY = {
    "Newton": "it must evaluate the errors to know that it has come; one blind Newton step at the "
    "new pose costs as much as the law's by Euler, and is the library's correction",
    "quasi-Newton (BFGS)": "so it depends on the integrator; the law's update always costs the "
    "same, while one of BFGS may take several times its mean",
    "gradient descent": "",
}
"""A remark on each comparison."""


def _cheaper_than(name: str) -> Statement:
    """The law's update against an iteration's, by both integrators: a verdict if they agree."""
    error, laws = same_accuracy(), [law_spent(integrator) for integrator in STAGES]
    got = spent(name, error)
    cheaper = [got.cost > law.cost for law in laws]
    kind = "" if got.price == 1.0 else f" of Ψ alone, counted as {got.price:g} each"
    heun, euler = (got.cost / law.cost for law in laws)
    return Statement(
        "Section I",
        f"an update is cheaper than {SPELT[name]} to the same accuracy",
        f"to {error:.1e} length that takes in the mean {_mean(got)} and at most {_most(got)} "
        f"evaluations{kind}: {heun:.1f} times the cost of the law's update by the paper's "
        f"integrator, {euler:.1f} times that by Euler's method",
        cheaper[0] if len(set(cheaper)) == 1 else None,
        WHY[name],
        BY,
    )


def _where_less_is_asked() -> Statement:
    """Newton's cost at the accuracies at which one of its steps is enough."""
    heun, targets = law_spent("heun"), [t for t in TARGETS if t >= LEAST_ASKED]
    times = ", ".join(
        f"{spent('Newton', target).cost / heun.cost:.1f} at {target:.0e}" for target in targets
    )
    return own_statement(
        "Section I",
        "Newton's cost in parts of that of the law's update by the paper's integrator, where less "
        f"accuracy is asked: {times} length",
        "one Newton step and the evaluation that finds it enough cost as much as Heun's two stages",
        BY,
    )


def draw() -> Figure:
    """Cost of an update against the accuracy."""
    figure = style.new_figure(height=4.4)
    axes = figure.subplots()
    for k, name in enumerate(PRICES, start=1):
        costs = [spent(name, target).cost for target in TARGETS]
        axes.plot(TARGETS, costs, marker=style.MARKERS[k], label=name, **style.line(k))
    for integrator, marker in (("heun", "*"), ("euler", "P")):
        law = law_spent(integrator)
        size = 15 if marker == "*" else 10
        look: dict[str, Any] = {"color": style.BLUE, "markersize": size}
        axes.plot(law.error, law.cost, marker, label=LAWS[integrator], **look)
    axes.set(xscale="log", yscale="log")
    axes.invert_xaxis()
    axes.set_xlabel("greatest witness error asked for [length]")
    axes.set_ylabel("second-order evaluations\nan update, mean")
    axes.set_yticks([0.5, 1, 2, 5, 10, 20, 50], ["0.5", "1", "2", "5", "10", "20", "50"])
    axes.minorticks_off()
    figure.legend(loc="outside lower center", ncols=1, frameon=False)
    return figure
