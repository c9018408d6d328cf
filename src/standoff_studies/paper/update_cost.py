"""What one update costs: the law's one time step beside iterations to the same accuracy."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.tracking.inputs import flat_pose, flat_twist
from standoff.tracking.pair_system import PairSystem, PairSystems
from standoff_studies.paper import style
from standoff_studies.paper.figure import Artwork, Statement
from standoff_studies.paper.simulation_e.runs import PATH_A, PATH_B, STEP, pair
from standoff_studies.paper.simulation_e.runs import run as simulation_e

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

FIRST, UPDATES = 50, 400
"""First frame, and number of updates: simulation E's first stay, face against face, 0 to 1.06 s."""

TARGETS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
"""Witness errors to which the iterations are taken [length]; the bodies are of size 2."""

MOST = 2000
"""Iterations after which one has not come to the accuracy."""

HALVINGS = 40
"""Of one step of a line search."""

ENOUGH = 1e-4
"""Part of the predicted decrease that a step must bring: Armijo's usual one."""

BY = "Eq. (12), Euler, K = 1000/s, M as it is, exact start; iterations from their last answer"
"""What the statements were measured with."""

ITERATIONS = ("Newton", "quasi-Newton (BFGS)", "gradient descent")
LAW = "the law's one step (Euler, K h = 1)"


class Frame(NamedTuple):
    """Poses and twists of one frame as the kernels read them, and the closest points."""

    flat_a: Array
    flat_b: Array
    xi_a: Array
    xi_b: Array
    points: Array


class Spent(NamedTuple):
    """What the updates of one method took.

    Attributes
    ----------
    evaluations : ndarray of float, shape (UPDATES,)
        Of the errors Ψ in each update; nan where it did not come to the accuracy.
    error : float
        Greatest witness error after an update [length].
    """

    evaluations: Array
    error: float


@cache
def frames() -> tuple[Frame, ...]:
    """The frames of the updates, and the one before."""
    exact, found = simulation_e().exact, []
    for k in range(FIRST, FIRST + UPDATES + 1):
        t = k * STEP
        poses = PATH_A.pose(t), PATH_B.pose(t)
        flat_a, flat_b = (flat_pose(pose) for pose in poses)
        xi_a = flat_twist(PATH_A.twist(t), poses[0])
        xi_b = flat_twist(PATH_B.twist(t), poses[1])
        points = np.array([exact.point_a[k], exact.point_b[k]])
        found.append(Frame(flat_a, flat_b, xi_a, xi_b, points))
    return tuple(found)


def start() -> tuple[PairSystems, Array]:
    """The pair's system, and the exact parameters before the first update."""
    exact = simulation_e().exact
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
    """Distance at one frame, with its evaluations counted; ``off`` asks for no evaluation."""

    def __init__(self, systems: PairSystems, frame: Frame) -> None:
        self.systems, self.frame, self.count = systems, frame, 0

    def at(self, q: Array) -> PairSystem:
        self.count += 1
        return self.systems.at(q, self.frame.flat_a, self.frame.flat_b, *self.frame[2:4])

    def off(self, q: Array) -> float:
        """How far the worse witness point is off the closest one [length]."""
        a, b = pair()
        exact = simulation_e().exact
        places = (
            (a, exact.feature_a[FIRST], q[:2], self.frame.flat_a),
            (b, exact.feature_b[FIRST], q[2:], self.frame.flat_b),
        )
        away = []
        for (body, feature, at, flat), due in zip(places, self.frame.points, strict=True):
            point = body.face_parts[feature.index].charts[0].jet(*at.tolist())[0]
            away.append(np.linalg.norm(flat[:9].reshape(3, 3) @ point + flat[9:] - due))
        return float(max(away))


def law_step(systems: PairSystems, before: Frame, q: Array) -> Array:
    """One time step of the law, Eq. (12), by Euler's method at K h = 1."""
    at = systems.at(q, *before[:4])
    return np.asarray(q + STEP * np.linalg.solve(at.M, -at.Psi / STEP - at.b))


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
def law_spent() -> Spent:
    """The law's updates."""
    systems, q = start()
    errors, answers = [], []
    for before in frames()[:-1]:
        q = law_step(systems, before, q)
        answers.append(q)
    for frame, answer in zip(frames()[1:], answers, strict=True):
        errors.append(Problem(systems, frame).off(answer))
    return Spent(np.ones(UPDATES), max(errors))


@cache
def spent(method: str, target: float) -> Spent:
    """An iteration's updates, each from the last answer, to a witness error [length].

    When it has come there is told to it: no stopping test could end it sooner.
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
            # told as not arrived; the next update begins at this one's exact answer
            counts.append(np.nan)
            continue
        counts.append(float(problem.count))
        errors.append(problem.off(q))
    return Spent(np.array(counts), max(errors, default=np.nan))


def update_cost() -> Artwork:
    """The picture, table and statements."""
    return Artwork(
        caption=(
            "What one update costs, two faces in motion at 1 kHz (simulation E's first stay, "
            f"{UPDATES} updates): evaluations of the errors Ψ against the greatest witness error "
            "that is asked for. The iterations begin at their last answer and are told when they "
            "have come; the law takes one time step and leaves the error that its mark stands at."
        ),
        text=(
            "A diagram of evaluations an update against accuracy. The law's mark stands at one "
            "evaluation; Newton's line at two and three, the quasi-Newton line above it, and "
            "gradient descent far above."
        ),
        draw=draw,
        tables={"cost": table()},
        statements=statements(),
        shown=("cost",),
    )


def table() -> dict[str, list[str]]:
    """Evaluations in the mean and at most, by method and accuracy."""
    rows = [(name, target, spent(name, target)) for name in ITERATIONS for target in TARGETS]
    law = law_spent()
    return {
        "method": [LAW, *(name for name, _, _ in rows)],
        "witness error": [f"{law.error:.1e}", *(f"{target:.0e}" for _, target, _ in rows)],
        "evaluations, mean": ["1", *(_mean(got) for _, _, got in rows)],
        "evaluations, most": ["1", *(_most(got) for _, _, got in rows)],
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
    return law_spent().error


def statements() -> tuple[Statement, ...]:
    """The claims on one update, with a verdict."""
    error = same_accuracy()
    own = {name: spent(name, error) for name in ITERATIONS}
    told = {
        name: f"{_mean(got)} evaluations in the mean, {_most(got)} at most"
        for name, got in own.items()
    }
    less = {name: bool(np.nanmean(got.evaluations) > 1.0) for name, got in own.items()}
    return (
        Statement(
            "Section I",
            "each update takes only one time step",
            f"one evaluation and one solve an update, no test and no loop; witness points at most "
            f"{error:.1e} length off",
            True,
            "that is what integrating with a fixed step means",
            BY,
            constructed=True,
        ),
        Statement(
            "Section I",
            "an update is cheaper than Newton's iteration to the same accuracy",
            f"to {error:.1e} length Newton takes {told['Newton']}",
            less["Newton"],
            "it must evaluate the errors to know that it has come; one blind Newton step at the "
            "new pose costs as much as the law's, and is the library's correction",
            BY,
        ),
        Statement(
            "Section I",
            "an update is cheaper than a quasi-Newton iteration to the same accuracy",
            f"to {error:.1e} length BFGS takes {told['quasi-Newton (BFGS)']}",
            less["quasi-Newton (BFGS)"],
            "its evaluations are of first order, without M",
            BY,
        ),
        Statement(
            "Section I",
            "an update is cheaper than gradient descent to the same accuracy",
            f"to {error:.1e} length it takes {told['gradient descent']}",
            less["gradient descent"],
            "its evaluations are of first order, without M",
            BY,
        ),
    )


def draw() -> Figure:
    """Evaluations an update against the accuracy."""
    with style.settings():
        figure = style.new_figure(height=4.2)
        axes = figure.subplots()
        for k, name in enumerate(ITERATIONS, start=1):
            means = [float(np.nanmean(spent(name, target).evaluations)) for target in TARGETS]
            look: dict[str, Any] = {"color": style.COLOURS[k], "linestyle": style.DASHES[k]}
            axes.plot(TARGETS, means, marker=style.MARKERS[k], label=name, **look)
        law = law_spent()
        axes.plot(law.error, 1.0, "*", color=style.BLUE, markersize=15, label=LAW)
        axes.set(xscale="log", yscale="log")
        axes.invert_xaxis()
        axes.set_xlabel("greatest witness error asked for [length]")
        axes.set_ylabel("evaluations an update, mean")
        figure.legend(loc="outside lower center", ncols=2, frameon=False)
    return figure
