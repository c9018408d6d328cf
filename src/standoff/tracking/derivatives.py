"""Exact derivatives of answers by the poses, of one or of many (``kernels.pair.derivatives``)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.errors import StandoffError
from standoff.kernels.entries import derivatives as kernels
from standoff.kernels.pair import derivatives as D
from standoff.kernels.state import arrays as K
from standoff.kernels.tolerances import SQUARE_AXIS
from standoff.tracking.contact.witness_set import poses_of, serving_pairs
from standoff.tracking.reached import packed
from standoff.tracking.rows import Answer
from standoff.tracking.status import Ordered
from standoff.tracking.threads import in_parts
from standoff.typing import Array


class Smoothness(Ordered):
    """Whether an answer has derivatives."""

    SMOOTH = "smooth"
    ONE_SIDED = "one-sided"
    PARTIAL = "partial"
    UNDEFINED = "undefined"


class Derivatives(NamedTuple):
    """Derivatives by the 12 unit twists (v_A, omega_A, v_B, omega_B), world axes.

    Attributes
    ----------
    smoothness : Smoothness
        ONE_SIDED: a witness point lies where two features meet, and the curvature jumps: a seam
        over which the surface or the edge goes on as one is none. The gradient holds on all sides,
        the rest as long as the features stay those of the answer. PARTIAL: the normal is unique,
        but the witness points are not (flat and line contact): the gradient's components by
        translation, and by turns that move all of them alike; nan in its others and in the other
        arrays. UNDEFINED: all arrays are nan.
    reason : str
        Why they are one-sided, partial or undefined; empty if they are smooth.
    gradient : (12,) array
        Of the signed distance: length per length, and length per radian.
    hessian : (12, 12) array
        Of the signed distance in the chart R <- exp(omega) R, p <- p + v; symmetric.
    normal_jacobian : (3, 12) array
    point_jacobians : pair of (3, 12) arrays
        Of the witness points on A and on B.

    Notes
    -----
    Of planar bodies the columns of twists out of the plane are zero.
    """

    smoothness: Smoothness
    reason: str
    gradient: Array
    hessian: Array
    normal_jacobian: Array
    point_jacobians: tuple[Array, Array]


class DerivativeArrays(NamedTuple):
    """`Derivatives` of n answers, in arrays of n rows.

    Attributes
    ----------
    smoothness : (n,) array of Smoothness
    reasons : dict of int to str
        Of the rows that are not smooth.
    gradient : (n, 12) array
    hessian : (n, 12, 12) array
    normal_jacobian : (n, 3, 12) array
    point_jacobians : pair of (n, 3, 12) arrays
    """

    smoothness: NDArray[np.object_]
    reasons: dict[int, str]
    gradient: Array
    hessian: Array
    normal_jacobian: Array
    point_jacobians: tuple[Array, Array]


NOT_UNIQUE = "the witness points or the normal are not unique."
REASONS = {
    D.UNDETERMINED: NOT_UNIQUE,
    D.NOT_AT_REST: "the witness points are not at rest at an optimum of their features.",
    D.NO_DISTANCE: "the answer has no distance.",
    D.EQUALLY_DEEP: NOT_UNIQUE,
}
NO_POSES = "the answer keeps no poses."


def defined(derivatives: Derivatives) -> Derivatives:
    """The same, or a StandoffError with the reason if they are undefined, or if only the gradient
    is defined."""
    if derivatives.smoothness in (Smoothness.PARTIAL, Smoothness.UNDEFINED):
        some = derivatives.smoothness is Smoothness.PARTIAL
        raise _error(derivatives.reason, "but parts of its gradient " if some else "")
    return derivatives


def _error(reason: str, but: str = "") -> StandoffError:
    return StandoffError(
        f"The distance has no derivatives {but}here: {reason} "
        "answer.derivatives() gives a flag in place of this error."
    )


def derivatives(answer: Answer) -> Derivatives:
    """See ``Proximity.derivatives``."""
    numbers = np.empty(D.N_DERIVATIVES)
    smoothness, reason = _derived(answer, numbers)
    return Derivatives(smoothness, reason, *_parts(numbers))


def gradient(answer: Answer) -> Array:
    """See ``Proximity.gradient``."""
    numbers = np.empty(12)
    smoothness, reason = _derived(answer, numbers)
    if smoothness is Smoothness.UNDEFINED:
        raise _error(reason)
    return numbers


def flagged_gradient(answer: Answer) -> tuple[Smoothness, str, Array]:
    """The gradient (12,) alone with its flag and reason: nan where it is undefined."""
    numbers = np.empty(12)
    smoothness, reason = _derived(answer, numbers)
    return smoothness, reason, numbers


class AnswerTable(Protocol):
    """A table of answers that can also give a row as an `Answer`."""

    @property
    def rows(self) -> Array: ...

    @property
    def bodies(self) -> tuple[Body, Body]: ...

    @property
    def poses(self) -> tuple[Array, Array]: ...

    @property
    def parts(self) -> Sequence[tuple[AnswerTable, NDArray[np.int64]]]: ...

    def __getitem__(self, k: int, /) -> Answer: ...


def derivative_arrays(table: AnswerTable, workers: int) -> DerivativeArrays:
    """See ``Distances.derivatives``."""
    numbers = np.empty((len(table.rows), D.N_DERIVATIVES))
    smoothness, reasons = _derived_rows(table, numbers, workers)
    return DerivativeArrays(smoothness, reasons, *_parts(numbers))


def gradients(table: AnswerTable) -> Array:
    """See ``Distances.gradient``."""
    return flagged_gradients(table)[2]


def flagged_gradients(table: AnswerTable) -> tuple[NDArray[np.object_], dict[int, str], Array]:
    """The gradients (n, 12) alone with their flags and reasons, as `flagged_gradient`."""
    numbers = np.empty((len(table.rows), 12))
    smoothness, reasons = _derived_rows(table, numbers, 1)
    return smoothness, reasons, numbers


def _derived_rows(
    table: AnswerTable, numbers: Array, workers: int
) -> tuple[NDArray[np.object_], dict[int, str]]:
    """Write derivatives into rows of `numbers`; say of each whether there are any, and why not."""
    parts = table.parts
    if len(parts) == 1:
        return _derived_rows_of_a_pair(table, numbers, workers)
    smoothness = np.empty(len(numbers), dtype=object)
    reasons: dict[int, str] = {}
    for part, at in parts:
        own = np.empty((len(at), numbers.shape[1]))
        smoothness[at], told = _derived_rows_of_a_pair(part, own, workers)
        numbers[at] = own
        reasons |= {int(at[k]): why for k, why in told.items()}
    return smoothness, dict(sorted(reasons.items()))


def _derived_rows_of_a_pair(
    table: AnswerTable, numbers: Array, workers: int
) -> tuple[NDArray[np.object_], dict[int, str]]:
    pair = packed(*table.bodies)
    kinds = np.zeros(len(numbers), dtype=np.int64)

    def part(first: int, end: int) -> None:
        kernels.derive_many(pair, *table.poses, first, end, table.rows, numbers, kinds)

    in_parts(part, len(numbers), workers)
    smoothness = np.full(len(numbers), Smoothness.SMOOTH, dtype=object)
    reasons = {}
    for k in np.flatnonzero(kinds != D.SMOOTH).tolist():
        smoothness[k], reasons[k] = _kept(partial(table.__getitem__, k), int(kinds[k]), numbers[k])
    return smoothness, reasons


def _parts(numbers: Array) -> tuple[Array, Array, Array, tuple[Array, Array]]:
    """Gradient, Hessian, Jacobian of the normal and of the points: views of (..., 264) numbers."""
    lead = numbers.shape[:-1]

    def part(first: int, rows: int) -> Array:
        return numbers[..., first : first + 12 * rows].reshape(*lead, rows, 12)

    points = part(D.POINT_JACOBIAN_A, 3), part(D.POINT_JACOBIAN_B, 3)
    gradient = numbers[..., D.GRADIENT : D.GRADIENT + 12]
    return gradient, part(D.HESSIAN, 12), part(D.NORMAL_JACOBIAN, 3), points


def _derived(answer: Answer, numbers: Array) -> tuple[Smoothness, str]:
    """Write an answer's derivatives into `numbers`; say whether there are any."""
    if len(answer._out) < K.BLOCK_EVENTS or answer.poses is None:
        numbers.fill(np.nan)
        return Smoothness.UNDEFINED, NO_POSES
    kind = kernels.derive(packed(*answer.bodies), answer._out, numbers)
    return (Smoothness.SMOOTH, "") if kind == D.SMOOTH else _kept(lambda: answer, kind, numbers)


def _kept(answer: Callable[[], Answer], kind: int, numbers: Array) -> tuple[Smoothness, str]:
    """What remains of derivatives that are not smooth, and why; nan for the rest of `numbers`."""
    if kind == D.SINGULAR:
        return _partial(numbers)
    if kind in REASONS:
        numbers.fill(np.nan)
        return Smoothness.UNDEFINED, REASONS[kind]
    given = answer()
    dimension, points, _ = serving_pairs(given, *poses_of(given))
    if dimension or kind == D.SINGULAR_BESIDE:
        _clear_turns(given, points, numbers)
        return _partial(numbers)
    first = kind == D.BESIDE_A
    name, feature = ("A", given.feature_a) if first else ("B", given.feature_b)
    return Smoothness.ONE_SIDED, f"the witness point on {name} lies at the boundary of {feature}."


def _partial(numbers: Array) -> tuple[Smoothness, str]:
    """Nan for all but the gradient."""
    numbers[D.NORMAL_JACOBIAN :] = np.nan
    lost = np.isnan(numbers[D.GRADIENT : D.GRADIENT + 12].reshape(4, 3))
    axes = ", ".join("xyz"[k] for k in range(3) if lost[:, k].any())
    which = f"turns about {axes} have no derivative" if axes else "only the gradient exists"
    return Smoothness.PARTIAL, f"the witness points are not unique, or barely: {which}."


def _clear_turns(answer: Answer, points: Array, numbers: Array) -> None:
    """Nan for the turns that do not move all optimal pairs of witness points equally along n.

    The kernel does this by the null directions of its system, this function by the pairs
    themselves.
    """
    n = answer.normal
    ways = np.eye(3) - np.outer(n, n)  # of one point, which has no digits
    if len(points) > 1:
        ways = points - points[0]
        ways = ways / np.linalg.norm(ways, axis=1).max()
    turned = np.abs(np.cross(ways, n)).max(axis=0) > SQUARE_AXIS
    if any(body.dimension == 2 for body in answer.bodies):
        turned &= [False, False, True]
    for turn in (D.GRADIENT + 3, D.GRADIENT + 9):
        numbers[turn : turn + 3][turned] = np.nan
