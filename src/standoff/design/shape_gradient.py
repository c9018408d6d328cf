"""How a distance or a depth changes with the design of its bodies.

At an optimum the witness points' own motion along the surfaces does not count, so the derivative by
a parameter p is n . (dx_B/dp - dx_A/dp) at the witness points, with the parameters of the features
held (the envelope theorem); of a face that is the speed of the surface along its normal.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.checks.real_numbers import shown
from standoff.design.design import Design
from standoff.errors import StandoffError, StandoffTypeError
from standoff.motion.pose import PoseLike
from standoff.solids.answer import NOT_UNIQUE, SolidProximity
from standoff.tracking.contact.witness_set import poses_of
from standoff.tracking.derivatives import Smoothness
from standoff.tracking.proximity import Proximity

Array = NDArray[np.float64]


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


def shape_gradient(
    answer: Proximity | SolidProximity,
    *,
    a: Design | None = None,
    b: Design | None = None,
    pose_a: PoseLike | None = None,
    pose_b: PoseLike | None = None,
) -> ShapeGradient:
    """The derivatives of an answer's distance by the parameters of designs.

    Parameters
    ----------
    answer : Proximity or SolidProximity
        Of ``a.body``, ``b.body``, or both.
    a, b : Design, optional
        How A and B are made; without one a body does not change. One design may be both.
    pose_a, pose_b : pose_like, optional
        Both poses, if the answer keeps none (those of solids do not).

    Returns
    -------
    ShapeGradient

    Raises
    ------
    TypeError
        Something else than an answer or a design.
    ValueError
        No design; an answer of other bodies, or without witness points; parameters whose
        neighbours make no body or one with other features.

    Notes
    -----
    Rates are central differences of fourth order of the boundary's point at the witness place, in
    bodies that the design makes for neighbouring parameters, once for all answers.
    """
    if not isinstance(answer, Proximity | SolidProximity):
        raise StandoffTypeError(
            f"answer is {shown(answer)}: give the answer of two bodies or solids.", "answer", answer
        )
    for name, design in (("a", a), ("b", b)):
        if not isinstance(design, Design | None):
            raise StandoffTypeError(f"{name} is {shown(design)}: give a so.Design.", name, design)
    if a is None and b is None:
        raise StandoffError("No design is given: give a=, b= or both.")
    _check_bodies(answer, a, b)
    smoothness, reason = _smoothness(answer)
    first, second = poses_of(answer, pose_a, pose_b)  # type: ignore[arg-type]  # it reads `poses`
    found: list[dict[str, float | Array]] = []
    for design, pose, side, sign in ((a, first, "a", 1.0), (b, second, "b", -1.0)):
        place = getattr(answer, f"feature_{side}"), getattr(answer, f"parameters_{side}")
        outward = sign * (pose.rotation.T @ answer.normal)
        found.append({} if design is None else _signed(design.rates(*place, outward), smoothness))
    return ShapeGradient(*found, smoothness, reason)


def _signed(rates: dict[str, float | Array], smoothness: Smoothness) -> dict[str, float | Array]:
    """Of the distance: a boundary that moves outward makes it smaller."""
    sign = np.nan if smoothness is Smoothness.UNDEFINED else -1.0
    return {name: sign * rate for name, rate in rates.items()}


def _check_bodies(answer: Any, a: Design | None, b: Design | None) -> None:
    if not answer.feature_a.kind:
        raise StandoffError(
            "The answer has no witness points (the bodies are beyond the horizon, or one is a "
            "half-space inside the other): it has no shape gradient."
        )
    bodies = getattr(answer, "bodies", (None, None))
    for name, design, body in zip("ab", (a, b), bodies, strict=True):
        if design is None or body is None or body is design.body:
            continue
        if body.digest != design.body.digest:
            raise StandoffError(
                f"The answer's {name.upper()} is not the body of the design: query `{name}.body`.",
                name,
                design,
            )


def _smoothness(answer: Proximity | SolidProximity) -> tuple[Smoothness, str]:
    if isinstance(answer, Proximity):
        told = answer.derivatives()
        return told.smoothness, told.reason
    smooth = answer.smoothness is Smoothness.SMOOTH
    return answer.smoothness, "" if smooth else NOT_UNIQUE
