"""Feedback for the paper's law: w = -M⁻¹(v(Psi) + b), with v to be chosen.

The errors then obey dPsi/dt = -v(Psi). The paper takes the full-state linear v = K Psi and says
that others can be synthesised; each here is a small immutable object for ``so.PaperLaw``::

    so.Tracker(a, b, law=so.PaperLaw(feedback=so.feedback.PI(500.0, 2e4)))
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import product
from numbers import Complex, Real
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from standoff.checks.names import choice
from standoff.checks.numbers import positive
from standoff.checks.real_numbers import DEEPEST, real_array, shown
from standoff.errors import GainWarning, StandoffError, StandoffTypeError, UnreadableNumbers
from standoff.kernels.paper import integrators as I
from standoff.kernels.state import arrays as K
from standoff.read_only import KeepsReadOnly
from standoff.tracking.tolerances import NEAR_LIMIT
from standoff.typing import Array

DEFAULT_LEAST = 0.1
"""`MotionGain`'s least gain, times 1/dt: errors of bodies at rest decay within some 50 steps."""

DEFAULT_MOST = 0.75
"""`MotionGain`'s greatest gain, in parts of ``so.max_gain``: the paper's 1500 of 2000 at 1 kHz."""

STABLE = 1.0
"""A sampled error loop is stable where its growth factor's magnitude is below this."""


def growth_factor(integrator: str, z: Any) -> Any:
    """R(z): what one step multiplies the solution of y' = (z/h) y by.

    Raises ValueError: unknown integrator, or `z` is not numeric.

    Parameters
    ----------
    integrator : str
    z : complex or array of complex
        The rate times the step (dimensionless); -K h for the paper's law.

    Returns
    -------
    complex or array of complex
        Of the shape of `z`; real where `z` is.

    Notes
    -----
    From the tableaux of ``standoff.kernels.paper.integrators``, stage by stage.
    """
    number = I.NAMES.index(choice(integrator, "integrator", I.NAMES))
    z = _complex(z)
    stage: Any = np.zeros_like(z)
    total: Any = np.ones_like(z)
    for i in range(int(I.STAGES[number])):
        stage = z * (1.0 + I.NODES[number, i] * stage)
        total = total + I.WEIGHTS[number, i] * stage
    return total[()]


def _complex(z: Any) -> Any:
    """z as an array of floating or complex numbers; ValueError where it is not numeric."""
    try:
        given = z if isinstance(z, np.ndarray) else np.array(z, dtype=object)
        if given.dtype.kind in "fc" and not isinstance(given, np.ma.MaskedArray):
            return given
        entries: list[Any] = given.ravel().tolist() if given.ndim <= DEEPEST else [None]
        if all(isinstance(x, Real) and not isinstance(x, bool) for x in entries):
            return given.astype(np.float64)
        if all(isinstance(x, Complex) and not isinstance(x, bool) for x in entries):
            return given.astype(np.complex128)
    except (TypeError, ValueError, OverflowError, RecursionError) as error:
        raise StandoffError(f"z = {shown(z)} is not numeric.", "z", z) from error
    raise StandoffError(f"z = {shown(z)} is not numeric.", "z", z)


def max_gain(integrator: str, dt: float) -> float:
    """The largest stable gain of the paper's law for an integrator and a step.

    The errors obey dPsi/dt = -K Psi, so the limit is that of the integrator on the negative real
    axis: K dt < 2 for Euler, Heun and midpoint, 2.785 for RK4 (docs/laws.md).

    Raises ValueError: unknown integrator, or a step that is not positive and finite.

    Parameters
    ----------
    integrator : "euler", "heun", "midpoint" or "rk4"
    dt : float
        Time from frame to frame, s, positive.

    Returns
    -------
    float
        K, 1/s; a gain must stay below it.
    """
    number = I.NAMES.index(choice(integrator, "integrator", I.NAMES))
    return I.STABILITY_LIMITS[number] / positive(dt, "dt")


@runtime_checkable
class Feedback(Protocol):
    """What `so.PaperLaw` asks of a feedback."""

    def resolved(self, integrator: str, dt: float) -> Feedback:
        """Return the feedback with the defaults that depend on integrator and step filled in."""

    def packed(self) -> tuple[int, float, Array]:
        """Return the kernels' kind of feedback, its gain K [1/s] and up to 16 numbers more."""

    def rates(self) -> Array:
        """Return the rates [1/s] of the error loop's modes, complex: -K for the linear law."""


@lru_cache(maxsize=64)
def _growth(integrator: str, z: tuple[complex, ...]) -> Array:
    """|R(z)|, kept: from frame to frame the gain and the time are mostly the same."""
    with np.errstate(over="ignore", invalid="ignore"):  # beyond float64 it is just as unstable
        return np.asarray(np.abs(growth_factor(integrator, np.array(z))))


def check_stable(feedback: Feedback, integrator: str, dt: float) -> None:
    """Raise ValueError where the sampled error loop would grow; warn where it hardly falls."""
    rates = np.asarray(feedback.rates(), dtype=complex)
    growth = _growth(integrator, tuple((rates * dt).tolist()))
    name, value = (
        ("gain", feedback.gain) if isinstance(feedback, Linear) else ("feedback", feedback)
    )
    if not (growth < STABLE).all():
        raise StandoffError(
            f"{name} = {value} is not stable for {integrator} at dt = {dt}: a step would multiply "
            f"its errors by {growth.max():.6g}. A linear gain must stay below "
            f"{max_gain(integrator, dt):.6g} (so.max_gain).",
            name,
            value,
        )
    slowest = float(growth[np.abs(rates * dt) > 1.0].max(initial=0.0))
    if slowest > NEAR_LIMIT:
        warnings.warn(
            f"{name} = {value}: with {integrator} at dt = {dt} a step multiplies small errors by "
            f"{slowest:.6g} in magnitude, and larger ones may stay for ever. They fall best near "
            f"1/dt = {1.0 / dt:.6g}; standoff.control.step_growth shows which starts settle.",
            GainWarning,
            stacklevel=9,  # from so.Tracker(...)
        )


@dataclass(frozen=True)
class Linear:
    """Full-state linear feedback, the paper's: v = K Psi.  Eqs. (12)-(14)

    Attributes
    ----------
    gain : float
        K [1/s], positive.
    """

    gain: float

    def __post_init__(self) -> None:
        positive(self.gain, "gain")

    def resolved(self, integrator: str, dt: float) -> Linear:
        return self

    def packed(self) -> tuple[int, float, Array]:
        return K.FEEDBACK_LINEAR, float(self.gain), np.zeros(0)

    def rates(self) -> Array:
        return np.array([-float(self.gain)])


class GainMatrix(KeepsReadOnly):
    """Linear feedback with a separate gain for each error, or a matrix: v = K Psi.

    Raises ValueError: another shape, not finite, or a mode of the error loop that does not decay.

    Parameters
    ----------
    gains : array-like, shape (4,) or (4, 4)
        Gains [1/s] of the errors in the order (u, v) of A, (r, s) of B; on an edge or a vertex the
        rows and columns of the parameters that it lacks are deleted.
    """

    def __init__(self, gains: ArrayLike) -> None:
        try:
            matrix = real_array(gains)
        except UnreadableNumbers as error:
            raise StandoffError(f"gains {error}: {shown(gains)}", "gains", gains) from error
        except TypeError as error:
            raise StandoffError(f"gains = {shown(gains)}: {error}", "gains", gains) from error
        if matrix.shape == (4,):
            matrix = np.diag(matrix)
        if matrix.shape != (4, 4) or not np.isfinite(matrix).all():
            raise StandoffError(
                f"gains = {np.asarray(gains).tolist()}: give four finite gains, 1/s, or a 4 x 4 "
                "matrix of them.",
                "gains",
                gains,
            )
        matrix.flags.writeable = False
        self.matrix = matrix
        if not (self.rates().real < 0.0).all():
            raise StandoffError(
                f"gains = {matrix.tolist()}: some pair of features has errors that do not decay; "
                "every matrix left when an edge's or a vertex's rows and columns are deleted must "
                "have eigenvalues with positive real parts.",
                "gains",
                gains,
            )

    def __repr__(self) -> str:
        return f"GainMatrix({self.matrix.tolist()})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, GainMatrix) and np.array_equal(self.matrix, other.matrix)

    def __hash__(self) -> int:
        return hash(self.matrix.tobytes())

    def resolved(self, integrator: str, dt: float) -> GainMatrix:
        return self

    def packed(self) -> tuple[int, float, Array]:
        return K.FEEDBACK_MATRIX, 1.0, self.matrix.ravel()

    def rates(self) -> Array:
        """Eigenvalues of -K and of what is left of it for edges and vertices."""
        found: list[complex] = []
        for n, m in product(range(3), repeat=2):
            kept = np.array([0, 1, 2, 3])[np.r_[:n, 2 : 2 + m]]
            if len(kept):
                found.extend(np.linalg.eigvals(-self.matrix[np.ix_(kept, kept)]))
        return np.asarray(found)


@dataclass(frozen=True)
class PI:
    """Proportional-integral feedback: v = K Psi + K_i ∫Psi dt.

    The integral compensates for a constant disturbance, such as that of wrong twists; it restarts
    for a body whose feature or chart changes.

    Attributes
    ----------
    gain : float
        K [1/s], positive.
    integral : float
        K_i [1/s²], positive; up to K²/4 the errors do not oscillate.
    """

    gain: float
    integral: float

    def __post_init__(self) -> None:
        positive(self.gain, "gain")
        positive(self.integral, "integral")

    def resolved(self, integrator: str, dt: float) -> PI:
        return self

    def packed(self) -> tuple[int, float, Array]:
        return K.FEEDBACK_PI, float(self.gain), np.array([self.integral / self.gain])

    def rates(self) -> Array:
        return np.asarray(np.roots([1.0, float(self.gain), float(self.integral)]))


@dataclass(frozen=True)
class FiniteTime:
    """Sign-power feedback: v_i = K |Psi_i / reference|^(power - 1) Psi_i.

    In continuous time each error is zero after |Psi_i / reference|^(1 - power) / (K (1 - power)).
    Sampled, its gain grows without bound near zero, where it would chatter: it is held at `most`,
    so within a small layer the law is linear.

    Attributes
    ----------
    gain : float
        K [1/s]: that at |Psi_i| = reference.
    power : float
        Above 0 and below 1; 1 would be the linear law.
    reference : float
        [unit of Psi: length² per parameter], positive.
    most : float or None
        Greatest gain [1/s]; 1/dt by default.
    """

    gain: float
    power: float
    reference: float
    most: float | None = None

    def __post_init__(self) -> None:
        positive(self.gain, "gain")
        positive(self.reference, "reference")
        if not 0.0 < positive(self.power, "power") < 1.0:
            raise StandoffError(
                f"power = {self.power}: must be above 0 and below 1.", "power", self.power
            )
        if self.most is not None and positive(self.most, "most") < self.gain:
            raise StandoffError(f"most = {self.most} is less than gain = {self.gain}.")

    def resolved(self, integrator: str, dt: float) -> FiniteTime:
        if self.most is not None:
            return self
        return replace(self, most=max(1.0 / dt, float(self.gain)))

    def packed(self) -> tuple[int, float, Array]:
        cap = float(self.rates()[0]) / -float(self.gain)
        return K.FEEDBACK_POWER, float(self.gain), np.array([self.power, self.reference, cap])

    def rates(self) -> Array:
        """That of the layer around zero, the greatest."""
        if self.most is None:
            raise StandoffError(f"{self}: its greatest gain depends on the step; use resolved().")
        return np.array([-float(self.most)])


@dataclass(frozen=True)
class MotionGain:
    """The paper's lower gain, computed online from the motion: K = |b| / error, within bounds.

    Without feedforward the errors settle at b/K. In the metric of the tangents both are lengths,
    so this K keeps the projection error of the witness vector at `error`; where `most` cuts it,
    which ``answer.counts.saturations`` counts, it does not (``so.min_gain`` tells before a run).

    Attributes
    ----------
    error : float
        Wanted projection error [length], positive.
    least, most : float or None
        Bounds of K [1/s]; by default 0.1/dt and 0.75 ``so.max_gain``.
    """

    error: float
    least: float | None = None
    most: float | None = None

    def __post_init__(self) -> None:
        positive(self.error, "error")
        for name in ("least", "most"):
            if getattr(self, name) is not None:
                positive(getattr(self, name), name)

    def resolved(self, integrator: str, dt: float) -> MotionGain:
        least = DEFAULT_LEAST / dt if self.least is None else float(self.least)
        most = DEFAULT_MOST * max_gain(integrator, dt) if self.most is None else float(self.most)
        if least > most:
            raise StandoffError(
                f"{self}: its least gain {least:.6g} is above its greatest {most:.6g}."
            )
        return replace(self, least=least, most=most)

    def packed(self) -> tuple[int, float, Array]:
        least, most = (-float(rate) for rate in self.rates())
        return K.FEEDBACK_MOTION, most, np.array([float(self.error), least, most])

    def rates(self) -> Array:
        """Those of the least and of the greatest gain."""
        if self.least is None or self.most is None:
            raise StandoffError(f"{self}: its bounds depend on the step; use resolved().")
        return np.array([-float(self.least), -float(self.most)])


def checked_feedback(feedback: Any) -> Feedback:
    """Return a feedback, or raise TypeError if it is not one."""
    if isinstance(feedback, type) or not isinstance(feedback, Feedback):
        raise StandoffTypeError(
            f"feedback = {shown(feedback)} is not a feedback: give one of so.feedback, such as "
            "so.feedback.PI(500.0, 2e4).",
            "feedback",
            feedback,
        )
    return feedback
