"""What a viewer sees of triangles that may hide one another: by the nearest one at each pixel."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.drawing.body_view import LIGHT, across, direction_to_viewer
from standoff.typing import Array

PIXELS = 1000
"""Of a picture's longer side: about those of a page, so that slanted sides are not jagged."""

MARGIN = 0.06
"""Around the solids, as a fraction of the picture."""

DARKEST = 0.55
"""Brightness of what is seen against the light, as a fraction of its colour."""

AT_ONCE = 1_000_000
"""Pixels of triangles that are looked at together."""

HIDDEN = 2.5
"""Pixels: a point of an edge that is farther behind what is drawn around it is hidden."""


@dataclass(frozen=True)
class Camera:
    """A view from afar, without perspective.

    Attributes
    ----------
    axes : (3, 3) array
        Unit vectors to the viewer's right, up, and towards the viewer, world axes.
    low, high : (2,) arrays
        What is seen, along right and up, length.
    pixels : int
        Of the longer side.
    """

    axes: Array
    low: Array
    high: Array
    pixels: int = PIXELS

    @property
    def wide(self) -> float:
        """The longer side of what is seen, length."""
        return float((self.high - self.low).max())

    @property
    def pixel(self) -> float:
        """Length of a pixel."""
        return self.wide / self.pixels

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of the picture."""
        wide, tall = np.ceil((self.high - self.low) / self.pixel).astype(int).tolist()
        return tall, wide

    def seen(self, points: Array) -> Array:
        """World points (..., 3) as (right, up, towards the viewer), length."""
        return np.asarray(points @ self.axes.T)

    def flat(self, points: Array) -> Array:
        """World points (..., 3) in the picture (..., 2), length."""
        return self.seen(points)[..., :2]


def camera_on(cloud: Array, view: tuple[float, float], pixels: int = PIXELS) -> Camera:
    """The camera that sees world points (n, 3) from an elevation and azimuth, degrees."""
    towards = direction_to_viewer(view)
    axes = np.stack([*across(towards), towards])
    flat = cloud @ axes[:2].T
    low, high = flat.min(axis=0), flat.max(axis=0)
    spare = MARGIN * float((high - low).max() or 1.0)
    return Camera(axes, low - spare, high + spare, pixels)


class Raster(NamedTuple):
    """The nearest triangle at each pixel.

    Attributes
    ----------
    depth : (rows, columns) array
        How far towards the viewer, length; minus infinity where nothing is.
    triangle : (rows, columns) array of int
        Its number; -1 where nothing is.
    """

    depth: Array
    triangle: NDArray[np.int64]


def rastered(camera: Camera, corners: Array) -> Raster:
    """Of triangles by their corners (n, 3, 3), world axes; those seen from behind count too."""
    tall, wide = camera.shape
    depth, number = np.full(tall * wide, -np.inf), np.full(tall * wide, -1, dtype=np.int64)
    seen = camera.seen(corners)
    seen[..., :2] = (seen[..., :2] - camera.low) / camera.pixel - 0.5
    planes = _planes(seen)
    which, row, first, last = _spans(seen, planes, (tall, wide))
    for part in _chunks(last - first + 1):
        count = (last - first + 1)[part]
        step = np.arange(int(count.sum())) - np.repeat(np.cumsum(count) - count, count)
        triangle, y = np.repeat(which[part], count), np.repeat(row[part], count)
        x = np.repeat(first[part], count) + step
        a, b, c = planes[triangle, 3].T
        near, pixel = a * x + b * y + c, y * wide + x
        np.maximum.at(depth, pixel, near)
        won = near == depth[pixel]
        number[pixel[won]] = triangle[won]
    return Raster(depth.reshape(tall, wide), number.reshape(tall, wide))


def _planes(seen: Array) -> Array:
    """Of triangles (n, 3, 3) by pixels: (n, 4, 3) factors (a, b, c) of a x + b y + c, which is the
    share of each corner, and then the depth; not finite where a triangle is seen from its side."""
    x, y, depth = np.moveaxis(seen, 2, 0)
    ahead, behind = [1, 2, 0], [2, 0, 1]
    shares = np.stack(
        [
            y[:, ahead] - y[:, behind],
            x[:, behind] - x[:, ahead],
            x[:, ahead] * y[:, behind] - x[:, behind] * y[:, ahead],
        ],
        axis=2,
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        shares /= shares[..., 2].sum(axis=1)[:, None, None]
        deep = np.einsum("ni,nik->nk", depth, shares)
    return np.concatenate([shares, deep[:, None]], axis=1)


def _spans(
    seen: Array, planes: Array, shape: tuple[int, int]
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """(triangle, row, first and last column) of each row of pixels in each triangle."""
    tall, wide = shape
    low = np.clip(np.ceil(seen[..., 1].min(axis=1)), 0, None).astype(int)
    high = np.minimum(np.floor(seen[..., 1].max(axis=1)), tall - 1).astype(int)
    count = np.maximum(high - low + 1, 0) * np.isfinite(planes).all(axis=(1, 2))
    which = np.repeat(np.arange(len(seen)), count)
    row = np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count) + low[which]
    a, b, c = np.moveaxis(planes[which, :3], 2, 0)
    rest = b * row[:, None] + c
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = -rest / a
    first = np.where(a > 0.0, ends, -np.inf).max(axis=1)
    last = np.where(a < 0.0, ends, np.inf).min(axis=1)
    first = np.ceil(np.clip(first, 0, wide)).astype(int)
    last = np.floor(np.clip(last, -1, wide - 1)).astype(int)
    held = (first <= last) & ~((a == 0.0) & (rest < 0.0)).any(axis=1)
    return which[held], row[held], first[held], last[held]


def _chunks(counts: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    """Numbers of spans in parts of about `AT_ONCE` pixels."""
    ends = np.flatnonzero(np.diff(np.cumsum(counts) // AT_ONCE)) + 1
    return [part for part in np.split(np.arange(len(counts)), ends) if len(part)]


def brightness(camera: Camera, normals: Array) -> Array:
    """Of surfaces by their normals (n, 3), world axes, with the light above the viewer's shoulder;
    from behind they are as bright as from the front."""
    lengths = np.maximum(np.linalg.norm(normals, axis=1), np.finfo(float).tiny)
    seen = camera.seen(normals) / lengths[:, None]
    seen *= np.where(seen[:, 2:] < 0.0, -1.0, 1.0)
    right, towards, up = LIGHT
    lit = np.clip(seen @ [right, up, towards], 0.0, 1.0)
    return np.asarray(DARKEST + (1.0 - DARKEST) * lit)


def visible(camera: Camera, raster: Raster, points: Array) -> NDArray[np.bool_]:
    """Which world points (n, 3) are not behind what is drawn at or beside their pixels."""
    seen = camera.seen(points)
    tall, wide = camera.shape
    column, row = np.floor((seen[:, :2] - camera.low) / camera.pixel).astype(int).T
    least = np.full(len(points), np.inf)
    for i in (-1, 0, 1):
        for j in (-1, 0, 1):
            at = np.clip(row + i, 0, tall - 1), np.clip(column + j, 0, wide - 1)
            least = np.minimum(least, raster.depth[at])
    return np.asarray(seen[:, 2] >= least - HIDDEN * camera.pixel)
