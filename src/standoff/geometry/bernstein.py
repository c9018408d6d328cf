"""Polynomials in Bernstein form on the unit interval and the unit square.

A polynomial of degrees (p, q) is an array (..., p + 1, q + 1) of its coefficients: the last two
axes belong to u and v, those before are components. Its values lie between its least and greatest
coefficients; products, derivatives, elevation and subdivision keep the form. Products are scaled
convolutions: the basis is not changed, so no digits are lost (Farouki and Rajan, CAGD 1988).
"""

from __future__ import annotations

from functools import cache
from math import comb

import numpy as np

from standoff.typing import Array


@cache
def binomials(degree: int) -> Array:
    """(degree + 1,) binomial coefficients."""
    row = np.array([comb(degree, i) for i in range(degree + 1)], dtype=np.float64)
    row.flags.writeable = False
    return row


@cache
def halves(degree: int) -> tuple[Array, Array]:
    """Matrices (n, n) that give the coefficients on [0, 1/2] and [1/2, 1] (de Casteljau)."""
    n = degree + 1
    left = np.zeros((n, n))
    for i in range(n):
        left[i, : i + 1] = binomials(i) / 2.0**i
    right = np.ascontiguousarray(left[::-1, ::-1])
    left.flags.writeable = right.flags.writeable = False
    return left, right


@cache
def elevation(degree: int, times: int) -> Array:
    """The matrix (degree + times + 1, degree + 1) that raises the degree."""
    total = degree + times
    matrix = np.zeros((total + 1, degree + 1))
    for i in range(total + 1):
        for j in range(max(0, i - times), min(degree, i) + 1):
            matrix[i, j] = comb(degree, j) * comb(times, i - j) / comb(total, i)
    matrix.flags.writeable = False
    return matrix


def elevate(c: Array, degree_u: int, degree_v: int) -> Array:
    """The same polynomial with higher degrees."""
    p, q = c.shape[-2] - 1, c.shape[-1] - 1
    left, right = elevation(p, degree_u - p), elevation(q, degree_v - q)
    raised: Array = left @ c @ right.T
    return raised


def along_u(c: Array) -> Array:
    """The partial derivative by u, of degrees (p - 1, q)."""
    derivative: Array = (c.shape[-2] - 1) * np.diff(c, axis=-2)
    return derivative


def along_v(c: Array) -> Array:
    """The partial derivative by v, of degrees (p, q - 1)."""
    derivative: Array = (c.shape[-1] - 1) * np.diff(c, axis=-1)
    return derivative


def scaled(c: Array) -> Array:
    """Coefficients times their binomials: products of these are plain convolutions."""
    weights: Array = np.outer(binomials(c.shape[-2] - 1), binomials(c.shape[-1] - 1))
    return c * weights


def unscaled(c: Array) -> Array:
    """The inverse of `scaled`."""
    weights: Array = np.outer(binomials(c.shape[-2] - 1), binomials(c.shape[-1] - 1))
    return c / weights


def convolve(a: Array, b: Array) -> Array:
    """The product of two scaled polynomials, component by component (they broadcast)."""
    shape = np.broadcast_shapes(a.shape[:-2], b.shape[:-2])
    # the components last: these are many, the coefficients few
    a = np.moveaxis(a, (-2, -1), (0, 1)).copy()
    a = a.reshape(*a.shape[:2], *(1,) * (len(shape) + 2 - a.ndim), *a.shape[2:])
    b = np.moveaxis(b, (-2, -1), (0, 1)).copy()
    rows, columns = a.shape[:2]
    whole = (rows + b.shape[0] - 1, columns + b.shape[1] - 1, *shape)
    out = np.zeros(whole, dtype=np.result_type(a, b))
    for i, j in np.ndindex(b.shape[:2]):
        out[i : i + rows, j : j + columns] += a * b[i, j]
    return np.moveaxis(out, (0, 1), (-2, -1))


def product(a: Array, b: Array) -> Array:
    """The product of two polynomials, component by component."""
    return unscaled(convolve(scaled(a), scaled(b)))


def basis(degree: int, t: Array | float) -> Array:
    """(..., degree + 1) values of the Bernstein polynomials at t in [0, 1]."""
    t = np.asarray(t, dtype=np.float64)[..., None]
    i = np.arange(degree + 1)
    values: Array = binomials(degree) * t**i * (1.0 - t) ** (degree - i)
    return values


def value(c: Array, u: float, v: float) -> Array:
    """The polynomial's components at one point of the unit square."""
    at: Array = (c @ basis(c.shape[-1] - 1, v)) @ basis(c.shape[-2] - 1, u)
    return at


def grid_values(c: Array, u: Array, v: Array) -> Array:
    """The polynomial's components, (..., len(u), len(v)), on a grid of the unit square."""
    at: Array = basis(c.shape[-2] - 1, u) @ c @ basis(c.shape[-1] - 1, v).T
    return at


def segment(degree: int, first: float, last: float) -> Array:
    """The matrix (n, n) that gives the coefficients on [first, last] within [0, 1].

    Row i is the blossom at (first, ... , last ...): none of its weights is negative.
    """
    matrix: Array = segments(degree, np.array([first]), np.array([last]))[0]
    return matrix


def segments(degree: int, first: Array, last: Array) -> Array:
    """The same, (m, n, n), for m segments at once.

    The blossom of each basis function is a sum over how many of its factors take `last`.
    """
    n = degree + 1
    starts, ends = _each_basis(degree, first), _each_basis(degree, last)
    matrices = np.zeros((len(first), n, n))
    for i in range(n):
        for k in range(i + 1):
            row = matrices[:, i, k : k + n - i]
            row += ends[i][:, k, None] * starts[degree - i]
    return matrices


@cache
def equal_segments(degree: int, count: int) -> Array:
    """The same, (count, n, n), on equal parts of [0, 1]."""
    ends = np.linspace(0.0, 1.0, count + 1)
    return segments(degree, ends[:-1], ends[1:])


def _each_basis(degree: int, t: Array) -> list[Array]:
    """Values (m, d + 1) of the Bernstein polynomials of each degree d at t (m,) in [0, 1], by sums
    of numbers that are not negative."""
    values = [np.ones((len(t), 1))]
    for d in range(1, degree + 1):
        raised = np.zeros((len(t), d + 1))
        raised[:, :-1] = (1.0 - t)[:, None] * values[-1]
        raised[:, 1:] += t[:, None] * values[-1]
        values.append(raised)
    return values
