"""Convex bodies given as rational Bezier patches: support by sampling and projected Newton steps.

A patch is a grid of homogeneous control points (w x, w y, w z, w), (p + 1, q + 1, 4), weighed by
Bernstein's polynomials. Every value found is that of a point of the body, so a search that
went wrong would show as a separation greater than the distance, never as a false proof.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from standoff_studies.oracles import Placed, Point, Shape

from .bounds import cut
from .loops import bernstein

Array = NDArray[Any]
Jet = tuple[Array, Array, Array, Array, Array, Array]

SAMPLES = 25
"""Samples along each side of a patch: any maximum of these degrees is seen."""
STEPS = 60
"""Projected Newton steps; a handful is enough where the patch is curved."""
RIVAL = 0.02
"""Patches whose best sample is within this of the best, over the size, are all refined."""
FLAT = 1e-13
"""Thickness of a plane patch, over its size."""
CLOSE = 1e-13
"""Distance to the boundary, over the size, at which a point is taken to lie on it."""
NEIGHBOURS = 3
"""Patches that a point near an edge or a corner may lie on."""
NEAR_STEPS = 7
"""Steps to the nearest point of a patch: quadratic where the point lies on it."""
SETTLED = 1e-10
"""Change of a parameter that ends a search: the value is then good to its square."""
HALVINGS = 40
"""Halvings of a step that does not climb."""


class BezierPatch:
    """One patch and the nets of its homogeneous partial derivatives, u along the first axis."""

    def __init__(self, control: ArrayLike) -> None:
        net = np.asarray(control, dtype=np.longdouble)
        if net.ndim != 3 or net.shape[2] != 4 or (net[:, :, 3] <= 0).any():
            raise ValueError(f"a patch needs (p + 1, q + 1, 4) points, w > 0; got {net.shape}")
        by_u, by_v = self._derivative(net, 0), self._derivative(net, 1)
        nets = [net, by_u, by_v]
        nets += [self._derivative(by_u, 0), self._derivative(by_u, 1), self._derivative(by_v, 1)]
        self.nets = {kind: [n.astype(kind) for n in nets] for kind in (np.float64, np.longdouble)}

    @staticmethod
    def _derivative(net: Array, axis: int) -> Array:
        degree = net.shape[axis] - 1
        if degree == 0:
            return np.zeros_like(net)
        return degree * np.diff(net, axis=axis)

    def _homogeneous(self, which: int, u: Array, v: Array) -> Array:
        net = self.nets[u.dtype.type][which]
        rows = bernstein(len(net) - 1, u) @ net.reshape(len(net), -1)
        across = bernstein(net.shape[1] - 1, v)[:, :, None]
        return (rows.reshape(len(u), *net.shape[1:]) * across).sum(axis=1)

    def point(self, u: Array, v: Array) -> Array:
        """Return points (k, 3)."""
        h = self._homogeneous(0, u, v)
        return h[:, :3] / h[:, 3:]

    def tangents(self, u: Array, v: Array) -> tuple[Array, Array, Array]:
        """Return the point and its two partial derivatives, each (3,), at one parameter pair."""
        h, *slopes = (self._homogeneous(which, u, v)[0] for which in range(3))
        x = h[:3] / h[3]
        return (
            x,
            (slopes[0][:3] - slopes[0][3] * x) / h[3],
            (slopes[1][:3] - slopes[1][3] * x) / h[3],
        )

    def jet(self, u: Array, v: Array) -> Jet:
        """Return points and partial derivatives x, x_u, x_v, x_uu, x_uv, x_vv, each (k, 3)."""
        h = [self._homogeneous(which, u, v) for which in range(6)]
        w = h[0][:, 3:]
        x = h[0][:, :3] / w
        first = [(h[k][:, :3] - h[k][:, 3:] * x) / w for k in (1, 2)]
        second = []
        for k, (i, j) in zip((3, 4, 5), ((0, 0), (0, 1), (1, 1)), strict=True):
            mixed = h[1 + i][:, 3:] * first[j] + h[1 + j][:, 3:] * first[i]
            second.append((h[k][:, :3] - mixed - h[k][:, 3:] * x) / w)
        return x, first[0], first[1], second[0], second[1], second[2]


def _uphill(gradient: Array, hessian: Array, at: Array) -> Array:
    """Return climbing steps (k, 2) at ``at`` (k, 2) in the unit square: Newton's where it climbs.

    A parameter at its bound that would leave is held.
    """
    held = ((at <= 0) & (gradient <= 0)) | ((at >= 1) & (gradient >= 0))
    step = np.zeros_like(gradient)
    a, b, c = hessian[:, 0, 0], hessian[:, 0, 1], hessian[:, 1, 1]
    determinant = a * c - b * b
    both = ~held.any(axis=1) & (a < 0) & (determinant > 0)
    safe = np.where(both, determinant, 1)
    step[:, 0] = np.where(both, -(c * gradient[:, 0] - b * gradient[:, 1]) / safe, 0)
    step[:, 1] = np.where(both, -(a * gradient[:, 1] - b * gradient[:, 0]) / safe, 0)
    for k, curvature in ((0, a), (1, c)):
        single = -gradient[:, k] / np.where(curvature < 0, curvature, -1)
        climb = np.where(curvature < 0, single, np.sign(gradient[:, k]) * 0.25)
        step[:, k] = np.where(both, step[:, k], climb)
    return np.where(held, 0, step)


def refine(patch: BezierPatch, normals: Array, start: Array) -> tuple[Array, Array]:
    """Return parameters (k, 2) and points (k, 3) where ``n.x`` is greatest near ``start``."""
    at = start.astype(normals.dtype)
    for _ in range(STEPS):
        jet = patch.jet(at[:, 0], at[:, 1])
        value, *slopes = ((normals * part).sum(axis=1) for part in jet)
        gradient = np.stack(slopes[:2], axis=1)
        hessian = np.stack([slopes[2], slopes[3], slopes[3], slopes[4]], axis=1).reshape(-1, 2, 2)
        step = _uphill(gradient, hessian, at)
        trial = np.clip(at + step, 0, 1)
        if np.abs(trial - at).max() <= SETTLED:
            at = trial
            break
        roundoff = 8 * np.finfo(at.dtype).eps * np.abs(value)
        share = np.ones(len(at), dtype=at.dtype)
        for _ in range(HALVINGS):
            points = patch.point(trial[:, 0], trial[:, 1])
            lower = (normals * points).sum(axis=1) < value - roundoff
            if not lower.any():
                break
            share = np.where(lower, share / 2, share)
            trial = np.where(lower[:, None], np.clip(at + share[:, None] * step, 0, 1), trial)
        else:
            trial = np.where(lower[:, None], at, trial)
        if (trial == at).all():
            break
        at = trial
    return at, patch.point(at[:, 0], at[:, 1])


class BezierBody(Shape):
    """The convex hull of a closed set of convex rational Bezier patches."""

    def __init__(self, patches: Sequence[ArrayLike]) -> None:
        self.patches = [BezierPatch(control) for control in patches]
        grid = (1 - np.cos(np.linspace(0, np.pi, SAMPLES))) / 2
        self.grid: Array = np.stack(np.meshgrid(grid, grid, indexing="ij"), axis=-1).reshape(-1, 2)
        self.samples: Array = np.stack([p.point(*self.grid.T) for p in self.patches])
        self.flat_normals = self._flat_normals()
        control = np.vstack([np.asarray(c, dtype=float).reshape(-1, 4) for c in patches])
        self.bounding_radius = float(np.linalg.norm(control[:, :3] / control[:, 3:], axis=1).max())

    def _flat_normals(self) -> Array:
        rows = []
        for samples in self.samples:
            middle = samples.mean(axis=0)
            sizes, axes = np.linalg.svd(samples - middle, full_matrices=False)[1:]
            if sizes[2] <= FLAT * sizes[0]:
                inward = self.samples.reshape(-1, 3).mean(axis=0) - middle
                rows.append(axes[2] * -np.sign(axes[2] @ inward))
        return np.array(rows).reshape(-1, 3)

    def points(self, normals: Array) -> Array:
        values = self.samples @ normals.T.astype(float)
        peaks, spots = values.max(axis=1), values.argmax(axis=1)
        lengths = np.sqrt((normals * normals).sum(axis=1)).astype(float)
        near = peaks >= peaks.max(axis=0) - RIVAL * self.bounding_radius * lengths
        best = np.full(len(normals), -np.inf, dtype=normals.dtype)
        found = np.zeros_like(normals)
        for number, patch in enumerate(self.patches):
            rows = np.flatnonzero(near[number])
            if not len(rows):
                continue
            spot = refine(patch, normals[rows], self.grid[spots[number][rows]])[1]
            height = (normals[rows] * spot).sum(axis=1)
            better = height > best[rows]
            best[rows[better]] = height[better]
            found[rows[better]] = spot[better]
        return found

    def special_normals(self, rng: np.random.Generator) -> Array:
        """Normals of patches that lie in a plane; none where all are curved."""
        del rng
        return self.flat_normals

    def maximisers(self, normal: ArrayLike, tolerance: float) -> Array:
        """Points of a flat patch that the normal belongs to, else the support point."""
        direction = np.asarray(normal, dtype=float).reshape(3)
        direction = direction / np.linalg.norm(direction)
        point = self.points(direction[None])
        heights = self.samples @ direction - direction @ point[0]
        flat = (np.abs(heights) <= tolerance * self.bounding_radius).all(axis=1)
        if not flat.any():
            return point
        rows = self.samples[flat][0].reshape(SAMPLES, SAMPLES, 3)
        return rows[[0, 0, -1, -1], [0, -1, 0, -1]]

    def nearest(self, point: Array) -> float:
        """Distance to a point of the boundary near by: Gauss and Newton's steps on each patch."""
        gaps = np.linalg.norm(self.samples - point, axis=2)
        best = float(gaps.min())
        for number in np.argsort(gaps.min(axis=1))[:NEIGHBOURS]:
            at = self.grid[gaps[number].argmin()].copy()
            for _ in range(NEAR_STEPS):
                x, by_u, by_v = self.patches[number].tangents(at[:1], at[1:])
                best = min(best, float(np.linalg.norm(x - point)))
                tangents = np.stack([by_u, by_v], axis=1)
                step = np.linalg.lstsq(tangents, point - x, rcond=1e-8)[0]
                at = np.clip(at + step, 0, 1)
            if best <= CLOSE * self.bounding_radius:
                break
        return best

    def outside(self, points: Array) -> Array:
        """How far points lie outside, or off the boundary where that is hardly anything.

        0 inside, and within the bracket of cutting planes.
        """
        return np.array([self._outside(point) for point in points])

    def _outside(self, p: Array) -> float:
        if (off := self.nearest(p)) <= CLOSE * self.bounding_radius:
            return off
        found = cut(Placed(self, np.eye(3), np.zeros(3)), Placed(Point(), np.eye(3), p), p)
        return 0.0 if found is None else max(found.value, 0.0)
