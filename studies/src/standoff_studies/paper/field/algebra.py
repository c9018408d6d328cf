"""Lin and Manocha's way: Eqs. (1)-(4) as polynomials, one unknown eliminated by Sylvester's matrix.

Its roots are the eigenvalues of a matrix polynomial. Two unknowns are solved here: a point and a
face, two curves, or the two multipliers of whole ellipsoids. Four, of two faces, are not:
`roots_of_two_faces` says why.
"""

from __future__ import annotations

from itertools import permutations, product
from math import comb
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eig
from scipy.signal import convolve2d

from standoff.typing import Array
from standoff_studies.paper.field.newton import Pair, Spots, newton
from standoff_studies.paper.field.shells import Shell, Spot

REAL = 1e-4
"""Imaginary part up to which a root counts as real, and how far it may lie outside [0, 1]: double
roots are off by the root of the roundoff. A root too many costs one point, as each is evaluated."""

VANISHES = 1e-12
"""Part of the greatest coefficient below which one is roundoff."""


def power_form(net: Array) -> Array:
    """Coefficients of powers of the first parameter, from control points along axis 0."""
    n = len(net) - 1
    turn = np.zeros((n + 1, n + 1))
    for j in range(n + 1):
        for i in range(j + 1):
            turn[j, i] = comb(n, j) * comb(j, i) * (-1.0) ** (j - i)
    return np.tensordot(turn, net, 1)


def homogeneous(shell: Shell, patch: int) -> Array:
    """A patch's polynomials X, Y, Z, W in the body's frame: (4, m + 1, n + 1), n = 0 of a curve."""
    one = shell.patches[patch]
    if shell.n == 2:
        points = one.control_points @ np.asarray(one.linear).T + one.shift
        weights = np.broadcast_to(one.weights, points.shape[:2])
    else:
        rows = one.data[1:].reshape(-1, 4)
        points, weights = rows[:, None, :3], rows[:, None, 3]
    net = power_form(np.concatenate([points * weights[..., None], weights[..., None]], axis=2))
    net = np.swapaxes(power_form(np.swapaxes(net, 0, 1)), 0, 1)
    return np.moveaxis(net, 2, 0)


def _slope(form: Array, axis: int) -> Array:
    """X' W - X W' of a patch, (3, ...): along the tangent."""
    n = form.shape[1 + axis]
    factors = np.arange(1, n).reshape((-1, 1) if axis == 0 else (1, -1))
    along = np.delete(form, 0, axis=1 + axis) * factors if n > 1 else 0.0 * form
    return np.array(
        [_sum(convolve2d(along[k], form[3]), -convolve2d(form[k], along[3])) for k in range(3)]
    )


def _sum(*terms: Array) -> Array:
    shape = np.max([t.shape for t in terms], axis=0)
    found = np.zeros(shape)
    for term in terms:
        found[: term.shape[0], : term.shape[1]] += term
    return found


def _trimmed(p: Array) -> Array:
    """A polynomial without leading coefficients that vanish."""
    there = np.abs(p) > VANISHES * np.abs(p).max(initial=1e-300)
    rows, columns = np.flatnonzero(there.any(axis=1)), np.flatnonzero(there.any(axis=0))
    return p[: rows.max(initial=0) + 1, : columns.max(initial=0) + 1]


def _from_point(form: Array, point: Array) -> list[Array]:
    """The projection errors of a point, as polynomials in (u, v)."""
    away = [form[k] - point[k] * form[3] for k in range(3)]
    errors = []
    for axis in (0, 1):
        if form.shape[1 + axis] > 1:
            along = _slope(form, axis)
            errors.append(_trimmed(_sum(*map(convolve2d, away, along))))
    return errors


def _between(a: Array, b: Array) -> list[Array]:
    """The projection errors of two curves, (4, m + 1, 1) each, as polynomials in (u, r)."""
    other = np.swapaxes(b, 1, 2)
    away = [convolve2d(a[k], other[3]) - convolve2d(a[3], other[k]) for k in range(3)]
    along = _slope(a, 0), np.swapaxes(_slope(b, 0), 1, 2)
    return [_trimmed(_sum(*map(convolve2d, away, each))) for each in along]


def unit_roots(p: Array) -> list[float]:
    """Real roots of a polynomial, lowest coefficient first, in [0, 1]."""
    return _in_unit(_real(np.roots(_trimmed(p[:, None])[::-1, 0])))


def _in_unit(roots: Array) -> list[float]:
    """Those that lie in [0, 1], but for roundoff."""
    inside = (roots > -REAL) & (roots < 1.0 + REAL)
    return [float(root) for root in np.clip(roots[inside], 0.0, 1.0)]


def common_roots(p: Array, q: Array) -> list[tuple[float, float]]:
    """Real common roots (u, v) of two polynomials in [0, 1]², and some that are none."""
    found = []
    for u in _resultant_roots(p, q):
        powers = u ** np.arange(max(p.shape[0], q.shape[0]))
        rows = [powers[: len(each)] @ each / np.abs(each).max() for each in (p, q)]
        # one may vanish all along v; the roots of the other are then too many, not too few
        found += [(u, v) for v in unit_roots(max(rows, key=lambda row: np.abs(row).max()))]
    return found


def _resultant_roots(p: Array, q: Array) -> list[float]:
    """The u in [0, 1] at which Sylvester's matrix in v is singular."""
    return _in_unit(_real(_eigenvalues(p, q)))


def _real(values: NDArray[Any]) -> Array:
    return np.asarray(values[np.abs(values.imag) < REAL].real)


def _eigenvalues(p: Array, q: Array) -> NDArray[Any]:
    """Those of the companion matrix of Sylvester's matrix in v, which are finite."""
    m, n = p.shape[1] - 1, q.shape[1] - 1
    degree = max(p.shape[0], q.shape[0]) - 1
    size = m + n
    parts = np.zeros((degree + 1, size, size))
    for k in range(n):
        parts[: p.shape[0], k, k : k + m + 1] = p / np.abs(p).max()
    for k in range(m):
        parts[: q.shape[0], n + k, k : k + n + 1] = q / np.abs(q).max()
    one = np.eye(size * degree)
    right, left = one.copy(), np.roll(one, size, axis=1)
    right[-size:, -size:] = parts[-1]
    left[-size:] = -np.concatenate(parts[:-1], axis=1)
    values = eig(left, right, right=False)
    return np.asarray(values[np.isfinite(values)])


def _places(shell: Shell) -> list[Spot]:
    """The corners of all patches."""
    ends = product((0.0, 1.0), repeat=shell.n)
    return [Spot(k, np.array(q)) for q in ends for k in range(len(shell.patches))]


def _on_sides(shell: Shell, patch: int, form: Array, point: Array) -> list[Spot]:
    """The closest points of a point on a face's sides, or on a curve."""
    if shell.n == 1:
        (error,) = _from_point(form, point)
        return [Spot(patch, np.array([t])) for t in unit_roots(error[:, 0])]
    found = []
    for axis, end in product((0, 1), (0.0, 1.0)):
        powers = end ** np.arange(form.shape[1 + axis])
        side = np.tensordot(form, powers, (1 + axis, 0))[:, :, None]
        errors = _from_point(side, point)
        for t in unit_roots(errors[0][:, 0]) if errors else []:
            q = np.full(2, t)
            q[axis] = end
            found.append(Spot(patch, q))
    return found


def _of_point(shell: Shell, forms: list[Array], x: Array) -> list[Spot]:
    """Candidates for the point of a body nearest to a point of the world."""
    point = (x - shell.shift) @ shell.rotation
    found = _places(shell)
    for k, form in enumerate(forms):
        found += _on_sides(shell, k, form, point)
        if shell.n == 2:
            roots = common_roots(*_from_point(form, point))
            found += [Spot(k, np.array(q)) for q in roots]
    return found


def _moved(shell: Shell, form: Array) -> Array:
    """A patch's polynomials in the world."""
    points = np.tensordot(shell.rotation, form[:3], 1) + shell.shift[:, None, None] * form[3]
    return np.concatenate([points, form[3:]])


def solve(shells: Pair, spots: Spots) -> tuple[Spots, Array]:
    """All stationary pairs by eigenvalues, the nearest of them, polished by Newton's iteration.

    For a point and any body, or two planar bodies.
    """
    a, b = shells
    forms = [[homogeneous(s, k) for k in range(len(s.patches))] if s.n else [] for s in shells]
    pairs: list[Spots] = []
    if b.n == 0:
        x = b.jet(Spot(0, np.zeros(0)), 0).x
        pairs = [(one, Spot(0, np.zeros(0))) for one in _of_point(a, forms[0], x)]
    else:
        for corner in _places(b):
            x = b.jet(corner, 0).x
            pairs += [(one, corner) for one in _of_point(a, forms[0], x)]
        for corner in _places(a):
            x = a.jet(corner, 0).x
            pairs += [(corner, one) for one in _of_point(b, forms[1], x)]
        world = [[_moved(s, f) for f in own] for s, own in zip(shells, forms, strict=True)]
        for i, j in product(range(len(a.patches)), range(len(b.patches))):
            for u, r in common_roots(*_between(world[0][i], world[1][j])):
                pairs.append((Spot(i, np.array([u])), Spot(j, np.array([r]))))
    far = [float(np.linalg.norm(a.jet(p, 0).x - b.jet(q, 0).x)) for p, q in pairs]
    return newton(shells, pairs[int(np.argmin(far))])


ROWS = 72
"""Of the companion matrix of `two_ellipsoids`: two polynomials of degree 6 in both unknowns."""


def two_ellipsoids(a: Array, b: Array, c: Array) -> Array:
    """The closest points (2, 3) of xᵀ a x = 1 and of zᵀ b z = 1 about c, two ellipsoids apart.

    With multipliers 1/s and 1/t of |x - c - z|² / 2 Lagrange's conditions are linear in x and z:
    (t a + s b + b a) x = s b c and s b z = -t a x. Put into both equations they leave two
    polynomials in (s, t), of which one positive common root is that of the closest points.
    """
    degree = 6

    def at(s: complex, t: complex) -> tuple[Any, NDArray[Any], NDArray[Any]]:
        """The determinant, and x and z times it."""
        matrix = t * a + s * b + b @ a
        below = np.linalg.det(matrix)
        x = below * np.linalg.solve(matrix, b @ c)
        return below, s * x, -t * np.linalg.solve(b, a @ x)

    def errors(s: complex, t: complex) -> NDArray[Any]:
        below, x, z = at(s, t)
        return np.array([x @ a @ x - below**2, z @ b @ z - below**2])

    unit = np.exp(2j * np.pi * np.arange(degree + 1) / (degree + 1))
    values = np.array([[errors(s, t) for t in unit] for s in unit])
    p, q = np.fft.fft2(values, axes=(0, 1), norm="forward").real.transpose(2, 0, 1)
    best, found = np.inf, np.zeros((2, 3))
    for s in _real(_eigenvalues(p, q)):
        for t in _real(np.roots((s ** np.arange(degree + 1) @ p)[::-1])):
            below, x, z = at(s, t)
            off = float(np.abs(errors(s, t)).max() / below**2)
            if min(s, t) > 0.0 and off < best:
                best, found = off, np.array([x / below, c + z / below])
    return found


def roots_of_two_faces(m: int, n: int) -> int:
    """How many roots Eqs. (1)-(4) have of two rational patches of degrees (m, n), by the degrees in
    each of the four unknowns: Bernstein's bound, a permanent."""
    # ΔR has the degrees of both patches; a tangent adds 2 m - 2 along itself, and 2 n across
    own = [[3 * m - 2, 3 * n], [3 * m, 3 * n - 2]]
    degrees = [[*row, m, n] for row in own] + [[m, n, *row] for row in own]
    return sum(
        int(np.prod([degrees[i][k] for i, k in enumerate(order)]))
        for order in permutations(range(4))
    )
