"""One box of a patch's parameters: bounds on its least normal curvature and on its normals."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from standoff.bodies.proofs.forms import Forms
from standoff.bodies.proofs.tolerances import (
    FLAT_TURN,
    NORMAL_ROUNDING,
    ORTHONORMAL_FRAME,
    TIGHT_JACOBIAN,
)
from standoff.geometry import bernstein
from standoff.typing import Array

# Greatest number of halvings of one parameter; a box that small keeps its size as its bound. At a
# singular corner, size and rounding of the normals then matter equally; at a sharp apex the normals
# have no such rounding, and smaller boxes are useful.
DEEPEST = 26
DEEPEST_APEX = 44


@dataclass(frozen=True)
class DyadicBox:
    """The dyadic box [i, i + 1] / 2^m x [j, j + 1] / 2^n of the unit square: u = (m, i)."""

    u: tuple[int, int]
    v: tuple[int, int]

    @property
    def centre(self) -> tuple[float, float]:
        return (self.u[1] + 0.5) / 2.0 ** self.u[0], (self.v[1] + 0.5) / 2.0 ** self.v[0]

    @property
    def ends(self) -> tuple[float, float, float, float]:
        a, b = 0.5 ** self.u[0], 0.5 ** self.v[0]
        return self.u[1] * a, (self.u[1] + 1) * a, self.v[1] * b, (self.v[1] + 1) * b

    def halves(self, along_u: bool) -> tuple[DyadicBox, DyadicBox]:
        (m, i), (n, j) = self.u, self.v
        if along_u:
            return DyadicBox((m + 1, 2 * i), self.v), DyadicBox((m + 1, 2 * i + 1), self.v)
        return DyadicBox(self.u, (n + 1, 2 * j)), DyadicBox(self.u, (n + 1, 2 * j + 1))

    def part(self, c: Array) -> Array:
        """The coefficients on this box of a polynomial given on the unit square."""
        rows = _dyadic(c.shape[-2] - 1, *self.u)
        columns = _dyadic(c.shape[-1] - 1, *self.v)
        part: Array = rows @ c @ columns.T
        return part


ROOT = DyadicBox((0, 0), (0, 0))


@lru_cache(maxsize=1024)
def _dyadic(degree: int, level: int, index: int) -> Array:
    """The matrix to the coefficients on [index, index + 1] / 2^level."""
    if level == 0:
        return np.eye(degree + 1)
    matrix: Array = bernstein.halves(degree)[index % 2] @ _dyadic(degree, level - 1, index // 2)
    return matrix


@dataclass(frozen=True)
class CurvatureBound:
    """Bounds over one box, in units of 1 / the patch's size.

    Attributes
    ----------
    least : no normal curvature of the box is below this; -inf where unknown.
    apex : at a sharp apex, no curvature is below -apex over the distance from it.
    width : of the box's image, approximately.
    turn : the greatest angle between two normals of the box, radians.
    convex : no curvature bends inward, up to the rounding of the control points.
    tight : are `least` and `turn` close to the actual values?
    found : the least curvature at the box's centre, nan if the patch is singular there.
    along_u : should the box be halved along u?
    """

    least: float
    apex: float
    width: float
    turn: float
    convex: bool
    tight: bool
    found: float
    along_u: bool


def curvature_bound(forms: Forms, cell: DyadicBox, sense: int) -> CurvatureBound:
    """Bound the least curvature on a box; `sense` as in PatchProof."""
    u, v = cell.centre
    jacobian = bernstein.value(forms.jacobian, u, v)
    frame = _frame(jacobian)
    metric = frame.T @ (jacobian @ jacobian.T) @ frame
    off = abs(metric[0, 0] - 1.0) + abs(metric[1, 1] - 1.0) + abs(metric[0, 1])
    regular = off < ORTHONORMAL_FRAME
    second = -sense * _mapped(cell.part(forms.second), frame)
    least = float(_least(second).min())
    speed = np.linalg.norm(jacobian, axis=1) * [0.5 ** cell.u[0], 0.5 ** cell.v[0]]
    for side in forms.poles:
        speed[0 if side >= 2 else 1] *= (u, 1.0 - u, v, 1.0 - v)[side]
    width = float(np.hypot(*speed)) / float(bernstein.value(forms.weight, u, v)) ** 2
    along_u = bool(speed[0] >= speed[1])
    found = _found(forms, u, v, frame, sense) if regular else np.nan
    if least >= 0.0:
        return CurvatureBound(0.0, 0.0, width, np.pi, True, True, found, along_u)
    normal = cell.part(forms.normal)
    convex = -least <= _allowed(forms, float(np.abs(normal).max()), frame)
    size, spread = 0.0, np.inf
    if regular:
        columns = np.tensordot(frame.T, cell.part(forms.jacobian), 1)
        size, spread = _size(forms, cell, normal, columns)
    distance = _apex_distance(forms, cell.ends)
    turn = np.pi if spread <= TIGHT_JACOBIAN and distance > 0.0 else _turn(normal, forms)
    if spread > TIGHT_JACOBIAN and regular:
        along_u = _strays(columns, -2) >= _strays(columns, -1)
    apex = -least / size if size > 0.0 else np.inf
    bound = -apex / distance if distance > 0.0 else -np.inf
    tight = spread <= TIGHT_JACOBIAN or turn <= FLAT_TURN
    return CurvatureBound(bound, apex, width, turn, convex, tight, found, along_u)


def _strays(columns: Array, axis: int) -> float:
    """How much J varies along one parameter."""
    return float(np.abs(np.ptp(columns, axis=axis)).max())


def _turn(normal: Array, forms: Forms) -> float:
    """The greatest angle between two normals of a box, radians; pi if no cone contains them."""
    vectors = normal.reshape(3, -1)
    lengths = np.linalg.norm(vectors, axis=0)
    # shorter ones are only rounding: the others give the normal
    regular = lengths > NORMAL_ROUNDING * float(np.abs(forms.normal).max())
    if not regular.any():
        return float(np.pi)
    directions = vectors[:, regular] / lengths[regular]
    axis = directions.sum(axis=1)
    length = float(np.linalg.norm(axis))
    if length == 0.0:
        return float(np.pi)
    # the sine resolves small angles that a cosine would lose
    if float((axis @ directions).min()) <= 0.0:
        return float(np.pi)
    sine = float(np.linalg.norm(np.cross(directions.T, axis / length), axis=1).max())
    return 2.0 * float(np.arcsin(min(sine, 1.0)))


def deep_enough(forms: Forms, cell: DyadicBox) -> bool:
    """Has a box been halved as often as is useful?"""
    apex = _apex_distance(forms, cell.ends) == 0.0
    return max(cell.u[0], cell.v[0]) >= (DEEPEST_APEX if apex else DEEPEST)


def _frame(jacobian: Array) -> Array:
    """(2, 2) columns: parameter directions that J maps to an orthonormal pair."""
    metric = jacobian @ jacobian.T
    lengths = np.sqrt(np.diag(metric))
    if lengths.min() <= 0.0:
        return np.eye(2)
    values, vectors = np.linalg.eigh(metric / np.outer(lengths, lengths))
    values = np.maximum(values, np.finfo(np.float64).eps)
    frame: Array = (vectors / np.sqrt(values)) / lengths[:, None]
    return frame


def _mapped(second: Array, frame: Array) -> Array:
    """The entries of frame^T P frame."""
    (a, b), (c, d) = frame
    change = np.array(
        [[a * a, 2 * a * c, c * c], [a * b, a * d + b * c, c * d], [b * b, 2 * b * d, d * d]]
    )
    mapped: Array = np.tensordot(change, second, 1)
    return mapped


def _least(entries: Array) -> Array:
    """Least eigenvalues of the matrices with entries uu, uv, vv."""
    uu, uv, vv = entries
    least: Array = 0.5 * (uu + vv) - np.hypot(0.5 * (uu - vv), uv)
    return least


def _apex_distance(forms: Forms, ends: tuple[float, float, float, float]) -> float:
    """Product of a box's least distances from the sides that are sharp apexes; 1 if none is."""
    u0, u1, v0, v1 = ends
    distance = 1.0
    for side in forms.sharp:
        distance *= (u0, 1.0 - u1, v0, 1.0 - v1)[side]
    return distance


def _found(forms: Forms, u: float, v: float, frame: Array, sense: int) -> float:
    """The least curvature at a point, 1 / size; 0 where only rounding makes it negative."""
    normal = float(np.linalg.norm(bernstein.value(forms.normal, u, v)))
    normal *= _apex_distance(forms, (u, u, v, v))
    if normal <= 0.0:
        return np.nan
    least = float(_least(-sense * _mapped(bernstein.value(forms.second, u, v), frame)))
    if least < 0.0:
        least = min(least + _allowed(forms, normal, frame), 0.0)
    return least * float(bernstein.value(forms.weight, u, v)) ** 3 / normal


def _allowed(forms: Forms, normal: float, frame: Array) -> float:
    """By how much rounding of the control points may lower an eigenvalue of P in the frame."""
    return (forms.noise[0] * normal + forms.noise[1]) * float(np.linalg.norm(frame, 2)) ** 2


def _size(forms: Forms, cell: DyadicBox, normal: Array, columns: Array) -> tuple[float, float]:
    """A lower bound of |T| I / w^3 over a box, and how much J (its columns in a frame) varies.

    P over the first, and over the distance from a sharp apex, bounds the curvature.
    """
    axis = bernstein.value(normal, 0.5, 0.5)
    length = float(np.linalg.norm(axis))
    if length == 0.0:
        return 0.0, np.inf
    height = float(np.tensordot(axis / length, normal, 1).min())
    middle = bernstein.value(columns, 0.5, 0.5)
    spread = float(np.sqrt(((columns - middle[..., None, None]) ** 2).sum(axis=(0, 1)).max()))
    if height <= 0.0 or spread >= 1.0:
        return 0.0, spread
    weight = float(cell.part(forms.weight).max())
    return height * (1.0 - spread) ** 2 / weight**3, spread
