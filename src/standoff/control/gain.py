"""The least gain that keeps the witness points within an error while the bodies move."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import scipy
from numpy.polynomial import Polynomial

from standoff.bodies.body import Body
from standoff.checks.arrays import finite
from standoff.checks.numbers import not_negative, positive
from standoff.checks.real_numbers import real_array, shape_of, shown
from standoff.control.curvature import least_curvature
from standoff.control.growth import stability_limit
from standoff.control.tolerances import REAL_EXTREME, WHOLE_STEPS
from standoff.errors import StandoffError
from standoff.kernels.body import layout as L
from standoff.tracking.feedback import growth_factor
from standoff.tracking.inputs import check_body, check_pair
from standoff.typing import Array


def min_gain(
    a: Body,
    b: Body,
    error: float,
    speed: float,
    spin: float = 0.0,
    *,
    distance: Any,
    start: tuple[float, ...] | None = None,
    step: tuple[str, float] = ("heun", 1e-3),
) -> float:
    """The least gain of the paper's law without feedforward for an error of the witness points.

    Without the feedforward b the witness points lag by |w_ff|/K. This bounds |w_ff| from how fast
    the bodies may move and how little they may be curved (docs/laws.md). With that gain neither
    witness point is ever farther than `error` from its true place (with a start: from its time on),
    to first order in the errors over the bodies' radii of curvature. With the feedforward there is
    no such lag: give a speed of 0.

    Raises TypeError: not a body. Raises ValueError: numbers that are negative, NaN or not in order;
    a planar body with a spatial one; a start beyond its basin; a time shorter than a step. Or no
    stable gain is enough: the message has the step that would do, and the error that can be kept
    with this one.

    Parameters
    ----------
    a, b : Body
    error : float
        Greatest distance allowed between a witness point and its true place, length. For a body
        with a swept radius it is that of the core's point (that of a sphere has none).
    speed : float
        Greatest speed of B's origin as seen from A's frame, length/s. Where A itself turns with
        omega_A this is |v_B - v_A - omega_A x (p_B - p_A)|.
    spin : float
        Greatest angular speed of B relative to A, |omega_B - omega_A|, rad/s.
    distance : float or (least, most)
        The least distance of the bodies, or both ends of its range, length. A single number means a
        range without an upper end.
    start : (error, time) or (error, time, basin), optional
        Greatest distance of a witness point from its true place at the start, length; the time
        after which it must be within `error`, s; the greatest start error that is known to settle,
        such as the ``start_error`` of ``standoff.control.step_growth``, length.
    step : (integrator, dt), optional
        Of the law and of the tracker; their defaults if not given.

    Returns
    -------
    float
        K, 1/s. inf where no gain can guarantee the error: both bodies flat or straight somewhere
        (two boxes), contact, or a spin at any distance about a body with a flat place. 0 for two
        points, which have no parameters.

    See Also
    --------
    standoff.control.step_growth : from which starts a pair settles at a gain.
    max_gain : the largest stable gain of an integrator.
    standoff.control.euler_min_gain : with the feedforward.
    """
    check_pair(a, b)
    error, motion, least_most = positive(error, "error"), _motion(speed, spin), _range(distance)
    wanted = _Wanted(error, _greatest_lag(a, b, least_most, *motion), *_checked_start(start))
    integrator, dt = _pair(step, "step = (name, dt)")
    return wanted.gain(integrator, positive(dt, "dt"))


def _pair(given: Any, form: str, more: int = 0) -> tuple[Any, ...]:
    """A pair of values, or a tuple of up to so many more."""
    if not isinstance(given, tuple) or not 2 <= len(given) <= 2 + more:
        raise StandoffError(f"Give {form}, not {shown(given)}.", form.split(" ")[0], given)
    return given


def _checked_start(start: Any) -> tuple[float, float]:
    """A start's error and time; no error if there is none."""
    if start is None:
        return 0.0, math.inf
    named = zip(
        ("start's error", "start's time", "start's basin"),
        _pair(start, "start = (error, time)", 1),
        strict=False,
    )
    far, time, *basin = (positive(x, name, infinite="basin" in name) for name, x in named)
    if basin and far > basin[0]:
        raise StandoffError(
            f"start = {start}: its error is beyond {basin[0]:.6g}, up to which starts are known to "
            "settle: begin there, or by Tracker.start, which searches.",
            "start",
        )
    return far, time


class _Wanted(NamedTuple):
    """What a gain is to do: lengths, length/s and s."""

    error: float
    lag: float
    start: float
    time: float

    def worst(self, z: Array, integrator: str, dt: float) -> Array:
        """The greatest error from the time on, by z = K dt: what is left turns into the lag."""
        lag = self.lag * dt / z
        if self.start <= self.error:
            return lag
        steps = math.floor(self.time / dt * (1.0 + WHOLE_STEPS))
        if steps < 1:
            raise StandoffError(
                f"start's time = {self.time} is shorter than a step of {dt}: give at least that, "
                f"or a step of {self.time} or less."
            )
        left = np.abs(growth_factor(integrator, -z)) ** steps
        return np.asarray(lag + np.maximum(left * (self.start - lag), 0.0))

    def gain(self, integrator: str, dt: float) -> float:
        """The least gain that is enough, inf if none ever is; an error with the step that would do
        if none is stable with this one."""
        # errors lag by at most |w_ff|/K: by Heun's method at all stable gains, by others up to 1/dt
        limit = stability_limit(integrator)
        z = np.linspace(0.0, limit if integrator == "heun" else 1.0, 2002)[1:-1]
        gain, short = self.least_gain(z, integrator, dt), dt
        while gain is None:
            short *= 0.5
            gain = self.least_gain(z, integrator, short)
        if short < dt:
            kept = self.worst(z, integrator, dt).min()
            raise StandoffError(
                f"error = {self.error}: no gain is enough with {integrator} at dt = {dt}, where "
                f"they end at {limit / dt:.6g} (so.max_gain). A step of {short:.3g} would do, with "
                f"a gain of {gain:.6g}; with this step one keeps {kept:.3g}."
            )
        return gain

    def least_gain(self, z: Array, integrator: str, dt: float) -> float | None:
        """The least gain that is enough among K dt = z, inf if none ever is, None if none of z."""
        if math.isinf(self.lag) or (self.lag == 0.0 and self.start <= self.error):
            return self.lag
        enough = np.flatnonzero(self.worst(z, integrator, dt) <= self.error)
        if not len(enough):
            return None
        ends = np.append(z[0] * WHOLE_STEPS, z)[enough[0] : enough[0] + 2]

        def excess(z: float) -> float:
            return float(self.worst(np.array(z), integrator, dt)) - self.error

        return float(scipy.optimize.brentq(excess, *ends, xtol=np.finfo(float).tiny)) / dt


def _greatest_lag(a: Body, b: Body, among: tuple[float, float], speed: float, spin: float) -> float:
    """The greatest speed that either witness point can have, with what a late release adds."""
    skins = a.radius + b.radius
    curvatures = least_curvature(a).value, least_curvature(b).value
    cores = among[0] + skins, among[1] + skins
    motion = speed + (spin * reach(b) if spin else 0.0), spin
    speeds, waits = witness_speeds(*curvatures, cores, *motion), (0.0, 0.0)
    if _switches(a) or _switches(b):
        waits = release_speeds(*curvatures, cores, *motion)
    return max(speed + wait for speed, wait in zip(speeds, waits, strict=True))


def witness_speeds(
    curvature_a: float,
    curvature_b: float,
    distance: tuple[float, float],
    speed: float,
    spin: float = 0.0,
) -> tuple[float, float]:
    """Bounds of the speeds with which both witness points move on their bodies.

    With kA, kB the least curvatures, d the distance, s = kA + kB + d kA kB, the tangential
    velocity of B relative to A at most v at B's witness point, hence v + d spin at A's,

        |w_A|² <= (1 + d kB) (d spin² + kB v² + kA (v + d spin)²) / (d s²)

    and |w_B| with A and B exchanged in the first factor: docs/laws.md derives it. The greatest
    value over a range of distances is returned.

    Raises ValueError: numbers that are negative, NaN or not in order, or a speed that is not
    finite.

    Parameters
    ----------
    curvature_a, curvature_b : float
        Least normal curvatures of the cores, 1/length; inf for a point.
    distance : (least, most)
        Of the cores, length.
    speed : float
        Of B's witness point as a point of B, seen from A's frame, length/s.
    spin : float
        Of B relative to A, rad/s.

    Returns
    -------
    (float, float)
        Of A's and of B's witness point, length/s; inf where there is no bound.
    """
    curvature_a, curvature_b = _curvature(curvature_a), _curvature(curvature_b)
    speed, spin = _motion(speed, spin)
    distance = _ends(distance)
    if curvature_a == curvature_b == 0.0 and (speed > 0.0 or spin > 0.0):
        return math.inf, math.inf
    v, (p_a, p_b, bottom) = Polynomial([speed, spin]), _inverse(curvature_a, curvature_b)
    (n_a, m_a), (n_b, m_b) = _fraction(curvature_a), _fraction(curvature_b)
    drift = m_a * m_b * spin**2 * D + n_b * m_a * speed**2 + n_a * m_b * v**2
    below = bottom * bottom // D
    return (
        math.sqrt(_greatest(p_a * drift, below, *distance)),
        math.sqrt(_greatest(p_b * drift, below, *distance)),
    )


def release_speeds(
    curvature_a: float,
    curvature_b: float,
    distance: tuple[float, float],
    speed: float,
    spin: float = 0.0,
) -> tuple[float, float]:
    """What the late release of a feature adds to `witness_speeds`, as that takes and returns it.

    A lagging pair is never at rest, and the tracker releases an edge or a vertex only when the
    slope of E across it exceeds that of the residual, |g| <= |b|/K. Until then the witness points
    stay on a feature that they should have left: farther off by up to
    sqrt(P_A max(P_A, P_B)) |b|/K, with P_A = (1 + d kB)/(d s) the greatest that A's part of the
    inverse of H can be, and |b|² at most v² + (v + d spin)².
    """
    if curvature_a == curvature_b == 0.0 and (speed > 0.0 or spin > 0.0):
        return math.inf, math.inf
    p_a, p_b, bottom = _inverse(curvature_a, curvature_b)
    b = speed**2 + Polynomial([speed, spin]) ** 2
    squares = [
        [_greatest(own * other * b, bottom**2, *distance) for other in (p_a, p_b)]
        for own in (p_a, p_b)
    ]
    return math.sqrt(max(squares[0])), math.sqrt(max(squares[1]))


D = Polynomial([0.0, 1.0])


def _inverse(curvature_a: float, curvature_b: float) -> tuple[Polynomial, Polynomial, Polynomial]:
    """(p_a, p_b, bottom) with P_X = p_X / bottom, polynomials in the distance.

    A curvature is n / m, so that a point (inf) is a number like others.
    """
    (n_a, m_a), (n_b, m_b) = _fraction(curvature_a), _fraction(curvature_b)
    bottom = Polynomial([0.0, n_a * m_b + n_b * m_a, n_a * n_b])
    return m_a * Polynomial([m_b, n_b]), m_b * Polynomial([m_a, n_a]), bottom


def _switches(body: Body) -> bool:
    """Has it a sharp edge or a vertex that can be left for another feature?"""
    sharp = body.n_edges - body.report.smooth_edges
    return sharp + body.n_vertices > 0 and body.n_faces + sharp + body.n_vertices > 1


def least_eigenvalue(curvature_a: float, curvature_b: float, distance: float) -> float:
    """The least eigenvalue that the whitened H can have at an optimum.

    1 + d (kA + kB)/2 - sqrt(1 + (d (kA - kB)/2)²), for least curvatures kA, kB and distance d;
    against a point 1 + d k. It is 0 at contact and where both bodies may be flat.

    Raises ValueError: a curvature that is negative or NaN, a distance that is negative or not
    finite.

    Parameters
    ----------
    curvature_a, curvature_b : float
        Least normal curvatures of the cores, 1/length; inf for a point.
    distance : float
        Of the cores, length.

    Returns
    -------
    float
        Dimensionless.
    """
    curvature_a, curvature_b = _curvature(curvature_a), _curvature(curvature_b)
    distance = not_negative(distance, "distance")
    point = math.isinf(curvature_a), math.isinf(curvature_b)
    if all(point):
        return 1.0  # no parameters: the masked identity
    if any(point):
        return 1.0 + distance * min(curvature_a, curvature_b)
    mean = 0.5 * distance * (curvature_a + curvature_b)
    half = 0.5 * distance * (curvature_a - curvature_b)
    # (1 + m) - sqrt(1 + h²) without cancellation
    product = distance * (curvature_a + curvature_b) + distance**2 * curvature_a * curvature_b
    return product / (1.0 + mean + math.sqrt(1.0 + half**2))


def reach(body: Body) -> float:
    """A bound of the distance from a body's origin to any point of its core, length.

    Exact where it is made of vertices and straight or plane parts, or of a whole ellipsoid about
    its origin; else the farthest corner of its box.

    Raises TypeError: not a body.

    Parameters
    ----------
    body : Body

    Returns
    -------
    float
        Length; inf for a half-space.
    """
    check_body(body)
    if not body.bounded:
        return math.inf
    centre = body.reals[L.BOX_CENTRE : L.BOX_CENTRE + 3]
    half = body.reals[L.BOX_HALF : L.BOX_HALF + 3]
    bounds = [float(np.linalg.norm(np.abs(centre) + half))]
    charts = [chart for face in body.face_parts for chart in face.charts]
    known = [bound for chart in charts if (bound := chart.farthest()) is not None]
    if charts and len(known) == len(charts):
        bounds.append(max(known))
    if len(body.vertex_points) and all(chart.flat for chart in charts):
        straight = all(e.curve.kind == L.LINE for e in body.edge_parts)
        if straight:
            bounds.append(float(np.linalg.norm(body.vertex_points, axis=1).max()))
    return min(bounds)


def _motion(speed: float, spin: float) -> tuple[float, float]:
    return not_negative(speed, "speed"), not_negative(spin, "spin")


def _range(distance: Any) -> tuple[float, float]:
    if shape_of(distance) == ():
        return not_negative(distance, "distance"), math.inf
    return _ends(finite(distance, "distance", (2,)))


def _ends(distance: Any) -> tuple[float, float]:
    """(least, most), both zero or above; the second may be infinite."""
    try:
        least, most = (float(x) for x in real_array(distance).reshape(2))
    except (TypeError, ValueError) as error:
        raise StandoffError(
            f"distance = {shown(distance)}: give (least, most).", "distance", distance
        ) from error
    if not (0.0 <= least <= most and least < math.inf):
        raise StandoffError(
            f"distance = {shown(distance)}: give (least, most) with 0 <= least <= most.",
            "distance",
            distance,
        )
    return least, most


def _curvature(value: Any) -> float:
    """A least curvature: zero or above, inf for a point."""
    try:
        curvature = float(real_array(value).reshape(()))
    except (TypeError, ValueError) as error:
        raise StandoffError(
            f"A least curvature of {shown(value)} is not a number.", "curvature", value
        ) from error
    if not curvature >= 0.0:
        raise StandoffError(
            f"A least curvature of {curvature}: give 0 or more, inf for a point.",
            "curvature",
            value,
        )
    return curvature


def _fraction(curvature: float) -> tuple[float, float]:
    """(n, m) with curvature = n / m: finite for a point too."""
    return (1.0, 0.0) if math.isinf(curvature) else (curvature, 1.0)


def _greatest(top: Polynomial, bottom: Polynomial, low: float, high: float) -> float:
    """The greatest value of top / bottom on [low, high], both with coefficients >= 0."""
    t, u = (np.trim_zeros(p.coef, "b") for p in (top, bottom))
    if not len(t):
        return 0.0
    if not len(u):
        return math.inf
    common = min(int(np.flatnonzero(t)[0]), int(np.flatnonzero(u)[0]))
    top, bottom = Polynomial(t[common:]), Polynomial(u[common:])
    if bottom(low) == 0.0:
        return math.inf
    slope = top.deriv() * bottom - top * bottom.deriv()
    roots = slope.trim().roots() if slope.degree() else np.zeros(0)
    real = roots.real[np.abs(roots.imag) <= REAL_EXTREME * np.abs(roots)]
    places = [low, *real[(real > low) & (real < high)].tolist()]
    values = [float(top(x)) / float(bottom(x)) for x in places]
    if math.isfinite(high):
        values.append(float(top(high) / bottom(high)))
    elif len(top.coef) > len(bottom.coef):
        return math.inf
    elif len(top.coef) == len(bottom.coef):
        values.append(float(top.coef[-1] / bottom.coef[-1]))
    return max(values)
