"""How a distance or a depth changes with the design of its bodies.

At an optimum the witness points' own motion along the surfaces does not count, so the derivative by
a parameter p is n . (dx_B/dp - dx_A/dp) at the witness points, with the parameters of the features
held (the envelope theorem); of a face that is the speed of the surface along its normal.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple, overload

import numpy as np
from numpy.typing import NDArray

from standoff.checks.real_numbers import shown
from standoff.design.design import Design, boundary_of, radius_of
from standoff.design.points import Group, group_of, groups_of, points_of
from standoff.design.tolerances import OTHER_PLACE
from standoff.errors import StandoffError, StandoffTypeError
from standoff.kernels.state import arrays as K
from standoff.solids.answer import SolidProximity
from standoff.solids.planar.solid import PlanarSolid
from standoff.tracking.answers import Answers
from standoff.tracking.contact.witness_set import poses_of
from standoff.tracking.derivatives import (
    NOT_UNIQUE,
    Smoothness,
    flagged_gradient,
    flagged_gradients,
)
from standoff.tracking.distance_arrays import Distances
from standoff.tracking.proximity import Proximity
from standoff.typing import Array


class ShapeGradient(NamedTuple):
    """Derivatives of a signed distance by the parameters of its bodies' designs.

    Attributes
    ----------
    a, b : dict of str to float or array
        Length per unit of each parameter of A's design and of B's, in the parameter's shape. A
        negative distance is a depth, which changes by the negative.
    smoothness : Smoothness
        SMOOTH; or ONE_SIDED where a witness point lies where two features meet, or at a tie: the
        numbers are those of the features, or of the pair, that the answer tells. PARTIAL: the
        witness points are not unique (flat and line contact); the numbers are those of the points
        told, and hold for parameters that move all of them alike. UNDEFINED: nan.
    reason : str
        Why it is not smooth; empty if it is.
    """

    a: Mapping[str, float | Array]
    b: Mapping[str, float | Array]
    smoothness: Smoothness
    reason: str


class ShapeGradientArrays(NamedTuple):
    """`ShapeGradient` of n answers, in arrays of n rows; nan where there are no witness points.

    Attributes
    ----------
    a, b : dict of str to array
        Of each parameter: n rows, each in the parameter's shape.
    smoothness : (n,) array of Smoothness
    reasons : dict of int to str
        Of the rows that are not smooth.
    """

    a: Mapping[str, Array]
    b: Mapping[str, Array]
    smoothness: NDArray[np.object_]
    reasons: dict[int, str]


@overload
def shape_gradient(
    answer: Proximity | SolidProximity, *, a: Design | None = None, b: Design | None = None
) -> ShapeGradient: ...


@overload
def shape_gradient(
    answer: Distances | Answers, *, a: Design | None = None, b: Design | None = None
) -> ShapeGradientArrays: ...


def shape_gradient(
    answer: Any, *, a: Design | None = None, b: Design | None = None
) -> ShapeGradient | ShapeGradientArrays:
    """The derivatives of an answer's distance by the parameters of designs (docs/design.md).

    Raises TypeError: something else than an answer or a design. Raises ValueError: no design; an
    answer of other bodies or of a compound, or a single one without witness points; parameters
    whose neighbours make no body or one with other features.

    Parameters
    ----------
    answer : Proximity, SolidProximity, Distances or Answers
        Of ``a.body``, ``b.body``, or both; `Answers` are those of ``Tracker.run``.
    a, b : Design, optional
        How A and B are made; without one a body does not change. One design may be both.

    Returns
    -------
    ShapeGradient
        Of `Distances` and `Answers` a `ShapeGradientArrays`.

    Notes
    -----
    Rates are central differences of fourth order of the boundary's point at the witness place, in
    bodies that the design makes for neighbouring parameters, once for all answers.
    """
    if not isinstance(answer, Proximity | SolidProximity | Tables):
        raise StandoffTypeError(
            f"answer is {shown(answer)}: give the answer of two bodies or solids, `Distances`, or "
            "the `Answers` of a run.",
            "answer",
            answer,
        )
    for name, design in (("a", a), ("b", b)):
        if not isinstance(design, Design | None):
            raise StandoffTypeError(f"{name} is {shown(design)}: give a so.Design.", name, design)
    if a is None and b is None:
        raise StandoffError("No design is given: give a=, b= or both.")
    _check_bodies(answer, (a, b))
    return _of_many(answer, (a, b)) if isinstance(answer, Tables) else _of_one(answer, (a, b))


Designs = tuple[Design | None, Design | None]
Tables = Distances | Answers
SIGNS = {"a": 1.0, "b": -1.0}
"""Of the normal, which points from A to B, where it points out of a body."""


def _of_one(answer: Proximity | SolidProximity, designs: Designs) -> ShapeGradient:
    smoothness, reason = _smoothness(answer)
    found: list[dict[str, float | Array]] = []
    poses = poses_of(answer)  # type: ignore[arg-type]  # it reads `poses`
    for side, design, pose in zip("ab", designs, poses, strict=True):
        if design is None:
            found.append({})
            continue
        # of a solid inside the other's material the normal points into the outer one
        flip = -1.0 if getattr(answer, "inside", "") == "BA"["ab".index(side)] else 1.0
        outward = flip * SIGNS[side] * (pose.rotation.T @ answer.normal)
        witness = pose.rotation.T @ (getattr(answer, f"point_{side}") - pose.translation)
        # an answer that is not at an optimum has a normal along which places do not move smoothly
        defined = smoothness is not Smoothness.UNDEFINED
        groups = [_group(answer, side, design, (witness, outward))] if defined else []
        rates = design.rates_of(groups, outward[None])
        found.append({name: _single(-flip * rate[0]) for name, rate in rates.items()})
    return ShapeGradient(found[0], found[1], smoothness, reason)


def _group(answer: Any, side: str, design: Design, witness: tuple[Array, Array]) -> Group:
    """A witness point's place. Solids' answers do not keep the solids, so it is compared."""
    feature, parameters = getattr(answer, f"feature_{side}"), getattr(answer, f"parameters_{side}")
    (point, outward), boundary = witness, boundary_of(design.body)
    group = group_of(boundary, feature, parameters, point)
    found = points_of(boundary, group)[0] + radius_of(design.body) * outward
    if (
        isinstance(answer, SolidProximity)
        and not np.linalg.norm(found - point) <= OTHER_PLACE * design.body.size
    ):
        raise _of_another(side, design)
    return group


def _of_many(answers: Distances | Answers, designs: Designs) -> ShapeGradientArrays:
    poses, rows = answers.poses, answers.rows
    smoothness, reasons, _ = flagged_gradients(answers)
    undefined = (smoothness == Smoothness.UNDEFINED)[:, None]
    found: list[dict[str, Array]] = []
    for k, (design, body) in enumerate(zip(designs, answers.bodies, strict=True)):
        rates: dict[str, Array] = {}
        if design is not None:
            rotations = poses[k][:, :3, :3]
            outward = SIGNS["ab"[k]] * np.matmul(answers.normal[:, None, :], rotations)[:, 0]
            modes = np.where(undefined, np.nan, rows[:, K.OUT_MODE + 2 * k :][:, :2])
            groups = groups_of(body, modes, rows[:, K.OUT_Q + 2 * k :][:, :2])
            rates = {name: -rate for name, rate in design.rates_of(groups, outward).items()}
        found.append(rates)
    return ShapeGradientArrays(found[0], found[1], smoothness, reasons)


def _single(rate: Any) -> float | Array:
    return float(rate) if np.ndim(rate) == 0 else rate


def _check_bodies(answer: Any, designs: Designs) -> None:
    single = not isinstance(answer, Tables)
    if single and not answer.feature_a.kind:
        raise StandoffError(
            "The answer has no witness points (the bodies are beyond the horizon, or one is a "
            "half-space inside the other): it has no shape gradient."
        )
    if single and any(getattr(answer, "pieces", ())):
        raise StandoffError(
            "The answer is of a compound: ask for the distance of the piece that is designed.",
            "answer",
            answer,
        )
    for side, design, body in zip(
        "ab", designs, getattr(answer, "bodies", (None, None)), strict=True
    ):
        if design is None or body is None or body is design.body:
            continue
        own = boundary_of(design.body)
        if isinstance(own, PlanarSolid) or body.digest != own.digest:
            raise _of_another(side, design)


def _of_another(side: str, design: Design) -> StandoffError:
    return StandoffError(
        f"The answer's {side.upper()} is not the body of the design: query `{side}.body`.",
        side,
        design,
    )


def _smoothness(answer: Proximity | SolidProximity) -> tuple[Smoothness, str]:
    if isinstance(answer, Proximity):
        return flagged_gradient(answer)[:2]
    smooth = answer.smoothness is Smoothness.SMOOTH
    return answer.smoothness, "" if smooth else NOT_UNIQUE
