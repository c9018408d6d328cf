"""Growth factors from the tableaux, their limits, and steady errors with the feedforward."""

import math

import numpy as np
import pytest

import standoff as so
from standoff import control

METHODS = ("euler", "heun", "midpoint", "rk4")
DEGREE = {"euler": 1, "heun": 2, "midpoint": 2, "rk4": 4}


@pytest.mark.parametrize("method", METHODS)
def test_polynomial_is_the_exponential_to_the_order(method: str) -> None:
    """A method of order p has the first p + 1 terms of exp."""
    expected = [1.0 / math.factorial(k) for k in range(DEGREE[method] + 1)]
    np.testing.assert_allclose(control.growth_polynomial(method).coef, expected, rtol=1e-15)


@pytest.mark.parametrize("method", METHODS)
def test_polynomial_is_the_kernels_own_factor(method: str) -> None:
    z = np.random.default_rng(0).normal(size=(20, 2)) @ [1.0, 1j]
    polynomial = control.growth_polynomial(method)(z)
    np.testing.assert_allclose(polynomial, control.growth_factor(method, z), rtol=1e-13)


@pytest.mark.parametrize("method", METHODS)
def test_limit_is_that_of_max_gain(method: str) -> None:
    assert control.stability_limit(method) == pytest.approx(so.max_gain(method, 1.0), rel=1e-12)


@pytest.mark.parametrize(
    ("method", "stated"),
    [
        ("euler", lambda gain, h, a: h * a / (2 * gain)),
        ("heun", lambda gain, h, a: h**2 * a / (4 * (1 - gain * h / 2))),
    ],
)
def test_steady_errors_of_the_design(method: str, stated) -> None:
    """DESIGN 2.3: Euler's h q''/(2K), Heun's h² q''/(4 (1 - K h/2))."""
    for gain in (50.0, 700.0, 1500.0):
        found = control.steady_error(method, gain, 1e-3, 3.0)
        assert found == pytest.approx(stated(gain, 1e-3, 3.0), rel=1e-12)


@pytest.mark.parametrize("method", METHODS)
def test_steady_error_of_a_simulated_law(method: str) -> None:
    """The same from stepping q' = -K (q - q*) + q*' with q* = a t²/2 by the tableau."""
    from standoff.kernels.paper import integrators as I

    gain, h, a = 400.0, 2e-3, 1.7
    number, q = I.NAMES.index(method), 0.0
    for step in range(200):
        stage, moved = 0.0, 0.0
        for i in range(I.STAGES[number]):
            c = I.NODES[number, i]
            t = (step + c) * h
            stage = -gain * (q + c * h * stage - 0.5 * a * t * t) + a * t
            moved += h * I.WEIGHTS[number, i] * stage
        q += moved
    error = abs(q - 0.5 * a * (200 * h) ** 2)
    assert error == pytest.approx(control.steady_error(method, gain, h, a), rel=1e-6)


def test_least_gain_of_euler_keeps_its_error() -> None:
    gain = control.euler_min_gain(1e-6, 2.0, 1e-3)
    assert control.steady_error("euler", gain, 1e-3, 2.0) == pytest.approx(1e-6, rel=1e-12)
    assert control.euler_min_gain(1e-8, 2.0, 1e-3) == math.inf


def test_an_unstable_gain_has_no_steady_error() -> None:
    with pytest.raises(ValueError, match="not stable for heun"):
        control.steady_error("heun", 2000.0, 1e-3, 1.0)
    with pytest.raises(ValueError, match="integrator = 'trapezoid': give"):
        control.growth_polynomial("trapezoid")


def test_roots_of_the_sampled_pi_loop() -> None:
    """R(h s) of both roots of s² + K s + K_i; complex ones where K_i > K²/4."""
    gain, integral, h = 400.0, 9e4, 1e-3
    roots = control.sampled_roots("rk4", so.feedback.PI(gain, integral), h)
    s = np.array([-200 + 1j * math.sqrt(5e4), -200 - 1j * math.sqrt(5e4)])
    expected = [sum((x * h) ** k / math.factorial(k) for k in range(5)) for x in s]
    np.testing.assert_allclose(np.sort_complex(roots), np.sort_complex(expected), rtol=1e-12)
