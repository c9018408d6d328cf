"""Drawing in space: surfaces, lines and marks seen from one side, the farther ones drawn first.

Matplotlib's own 3-D axes sort whole artists, so a line that winds around a body cannot disappear
behind it and come out again. Here everything is cut into small pieces that are sorted together.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from numpy.typing import ArrayLike

from standoff.bodies import Body
from standoff.motion import Pose
from standoff.typing import Array
from standoff_studies.paper import style

PALE = ("#9FD3F2", "#F7D08A", "#7FD1B9", "#F4B8A0", "#E3B7D0", "#C9C9C9")
"""Adjacent faces can be distinguished with any colour vision, and black lines stand out on all."""

LIGHT = np.array([-0.35, 0.5, 0.8]) / np.linalg.norm([-0.35, 0.5, 0.8])
"""Where the light comes from, in the viewer's axes: right, up, towards the viewer."""

DARKEST = 0.72
"""Brightness of a surface seen against the light, as a fraction of its colour."""

GRID = 20
"""Pieces along each side of a drawn patch, by default."""

PIECE = 0.04
"""Longest piece of a line [length], by default: shorter than the patches' pieces."""

LOOKS = {"face": (style.BLUE, "o"), "edge": (style.RED, "s"), "vertex": (style.BLACK, "^")}
"""Colour and mark of a witness point by the kind of its feature."""

SHAPES = {"o": (24, 0.0), "s": (4, 45.0), "^": (3, 90.0), "D": (4, 0.0)}
"""Corners of a mark and the angle of the first [degrees]."""


class Piece(NamedTuple):
    """What is painted at once: a polygon, or a line of two points, projected to the picture.

    Lines and marks have a rank above 0: they are moved towards the viewer by that many pieces of a
    surface, so that the surface on which they lie does not cover them.
    """

    corners: Array
    depth: float
    rank: float
    face: tuple[float, ...]
    edge: tuple[float, ...]
    width: float


class View:
    """An orthographic view of a scene, filled piece by piece and then painted.

    Parameters
    ----------
    azimuth, elevation : float
        Where the viewer stands [degrees]: about z from x, and above the x-y plane. z points up.
    """

    def __init__(self, azimuth: float, elevation: float) -> None:
        turn, rise = np.radians([azimuth, elevation])
        level = np.array([np.cos(turn), np.sin(turn), 0.0])
        self.towards: Array = np.cos(rise) * level + np.sin(rise) * np.array([0.0, 0.0, 1.0])
        right = np.array([-np.sin(turn), np.cos(turn), 0.0])
        self.across: Array = np.array([right, np.cross(self.towards, right)])
        self.pieces: list[Piece] = []
        self.coarseness = 0.0  # half the longest diagonal of an opaque surface's pieces [length]

    def flat(self, points: ArrayLike) -> Array:
        """Return the projections (..., 2) of points (..., 3) to the picture."""
        return np.asarray(np.asarray(points, dtype=float) @ self.across.T)

    def faces(self, normal: Array, least: float = 0.0) -> bool:
        """Does a surface with this outward normal face the viewer, with at least this cosine?"""
        return bool(normal @ self.towards > least * np.linalg.norm(normal))

    def surface(
        self,
        points: Array,
        colour: str,
        *,
        opacity: float = 1.0,
        shaded: bool = True,
        lines: int = 0,
    ) -> None:
        """Add a grid of points (n, m, 3) as four-sided pieces.

        Parameters
        ----------
        points : ndarray, shape (n, m, 3)
            World [length].
        colour : str
        opacity : float
            0 to 1.
        shaded : bool
            Does its brightness follow the light?
        lines : int
            Isoparametric lines in each direction, without the sides; 0 for none.
        """
        rgb = np.array(rgb_of(colour))
        corners = np.stack(
            [points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]], axis=2
        ).reshape(-1, 4, 3)
        normals = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
        if opacity == 1.0:
            diagonals = np.linalg.norm(corners[:, 2:] - corners[:, :2], axis=2)
            self.coarseness = max(self.coarseness, 0.5 * float(diagonals.max()))
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
        normals *= np.where(normals @ self.towards < 0.0, -1.0, 1.0)[:, None]
        lamp = LIGHT @ np.vstack([self.across, self.towards])
        bright = DARKEST + (1.0 - DARKEST) * np.clip(normals @ lamp, 0.0, 1.0)
        depths = corners.mean(axis=1) @ self.towards
        for flat, depth, light in zip(self.flat(corners), depths, bright, strict=True):
            shade = (*(rgb * (light if shaded else 1.0)), opacity)
            # an opaque piece is outlined in its own colour, so that no hairlines show
            outline = shade if opacity == 1.0 else (*rgb, 0.0)
            self.pieces.append(Piece(flat, float(depth), 0.0, shade, outline, 0.4))
        for k in np.linspace(0, len(points) - 1, lines + 2).round().astype(int)[1:-1]:
            self.line(points[k], style.QUIET, 0.5)
        for k in np.linspace(0, points.shape[1] - 1, lines + 2).round().astype(int)[1:-1]:
            self.line(points[:, k], style.QUIET, 0.5)

    def patch(self, points: Array, colour: str, *, opacity: float = 1.0, lines: int = 0) -> None:
        """Add a grid of points as `surface` does, with a black rim."""
        self.surface(points, colour, opacity=opacity, lines=lines)
        for rim in (points[0], points[-1], points[:, 0], points[:, -1]):
            self.line(rim, style.BLACK, 1.4)

    def body(
        self,
        body: Body,
        pose: Pose | None = None,
        *,
        colours: Sequence[str] = PALE,
        grid: int = GRID,
        lines: int = 3,
        width: float = 1.4,
    ) -> None:
        """Add a body of untrimmed patches: its faces, isoparametric lines and edges.

        Parameters
        ----------
        body : Body
            Each face must be one patch with a finite domain.
        pose : Pose, optional
            The identity by default.
        colours : sequence of str
            One per face, used in turn.
        grid, lines : int
            Pieces and isoparametric lines along each side of a patch.
        width : float
            Of the edges [points].
        """
        for number, face in enumerate(body.face_parts):
            points = patch_points(body, number, grid)
            assert len(face.charts) == 1, "every face is one patch"
            self.surface(posed(points, pose), colours[number % len(colours)], lines=lines)
        for edge in range(body.n_edges):
            self.line(posed(edge_points(body, edge), pose), style.BLACK, width)

    def line(
        self,
        points: ArrayLike,
        colour: str,
        width: float,
        *,
        dashes: tuple[float, float] | None = None,
        rank: float = 1.0,
        piece: float = PIECE,
    ) -> None:
        """Add a line through points (n, 3).

        Parameters
        ----------
        points : array_like, shape (n, 3)
            World [length].
        colour : str
        width : float
            Points.
        dashes : (float, float), optional
            Lengths of dashes and gaps [length].
        rank : float
            How far it is moved towards the viewer: see `Piece`.
        piece : float
            Longest piece [length].
        """
        along = np.asarray(points, dtype=float)
        rgb = (*rgb_of(colour), 1.0)
        arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(along, axis=0), axis=1))])
        if arc[-1] == 0.0:
            return
        cuts = _cuts(float(arc[-1]), piece, dashes)
        for start, end in cuts:
            ends = np.array(
                [[np.interp(at, arc, column) for column in along.T] for at in (start, end)]
            )
            depth = float(ends.mean(axis=0) @ self.towards)
            self.pieces.append(Piece(self.flat(ends), depth, rank, (0.0,) * 4, rgb, width))

    def mark(self, point: ArrayLike, colour: str, shape: str = "o", size: float = 0.03) -> None:
        """Add a mark that faces the viewer: "o", "s", "^" or "D", with its radius [length]."""
        corners, first = SHAPES[shape]
        angles = np.radians(first) + 2.0 * np.pi * np.arange(corners) / corners
        place = np.asarray(point, dtype=float)
        around = self.flat(place) + size * np.column_stack([np.cos(angles), np.sin(angles)])
        depth = float(place @ self.towards)
        rgb = (*rgb_of(colour), 1.0)
        self.pieces.append(Piece(around, depth, 2.0, rgb, (*rgb_of(style.BLACK), 1.0), 0.5))

    def paint(self, axes: Axes) -> None:
        """Paint everything, the farther pieces first, on axes with equal scales and no frame."""
        from matplotlib.collections import PolyCollection

        order = sorted(self.pieces, key=lambda p: p.depth + p.rank * self.coarseness)
        axes.add_collection(
            PolyCollection(
                [piece.corners for piece in order],
                facecolors=[piece.face for piece in order],
                edgecolors=[piece.edge for piece in order],
                linewidths=[piece.width for piece in order],
                capstyle="round",
                joinstyle="round",
                rasterized=True,  # thousands of pieces would make a heavy SVG
            )
        )
        everything = np.concatenate([piece.corners for piece in order])
        axes.update_datalim(everything)
        axes.set_aspect("equal")
        axes.set_axis_off()
        axes.autoscale_view()

    def text(self, axes: Axes, point: ArrayLike, words: str, **look: Any) -> None:
        """Write at a point (3,), above everything painted, with a white rim."""
        from matplotlib.patheffects import withStroke

        x, y = self.flat(point).tolist()
        rim = [withStroke(linewidth=2.5, foreground="white")]
        centred: dict[str, Any] = {"ha": "center", "va": "center", "path_effects": rim, "zorder": 5}
        axes.text(x, y, words, **(centred | look))

    def triad(self, axes: Axes, corner: tuple[float, float], length: float, unit: str) -> None:
        """Draw arrows along x, y and z, with their length [length] written below.

        Parameters
        ----------
        axes : matplotlib.axes.Axes
        corner : (float, float)
            Where in the picture they begin, in the coordinates of `flat`.
        length : float
        unit : str
        """
        start = np.array(corner)
        tips = start + length * self.flat(np.eye(3))
        for tip, name in zip(tips, "xyz", strict=True):
            arrow = {"arrowstyle": "-|>", "color": style.BLACK, "shrinkA": 0.0, "shrinkB": 0.0}
            axes.annotate("", tuple(tip), tuple(start), arrowprops=arrow)
            x, y = start + 1.25 * (tip - start)
            axes.text(x, y, name, ha="center", va="center")
        low = float(min(start[1], *tips[:, 1])) - 0.4 * length
        axes.update_datalim([start, *tips, (start[0], low)])
        axes.autoscale_view()
        axes.text(start[0], low, f"arrows: {length:g} {unit}", ha="center", va="top")


def rgb_of(colour: str) -> tuple[float, float, float]:
    """Return a colour's red, green and blue, 0 to 1."""
    return to_rgb(colour)


def patch_points(body: Body, face: int, grid: int = GRID) -> Array:
    """Return points of a face that is one untrimmed patch, body frame, (grid + 1, grid + 1, 3)."""
    (surface,) = body.face_parts[face].charts
    u0, u1, v0, v1 = surface.domain
    rows = [
        [surface.jet(u, v)[0] for v in np.linspace(v0, v1, grid + 1)]
        for u in np.linspace(u0, u1, grid + 1)
    ]
    return np.array(rows)


def edge_points(body: Body, edge: int, count: int = 49) -> Array:
    """Return points along an edge, body frame, (count, 3)."""
    curve = body.edge_parts[edge].curve
    return np.array([curve.jet(t)[0] for t in np.linspace(curve.first, curve.last, count)])


def posed(points: Array, pose: Pose | None) -> Array:
    """Return body points (..., 3) in the world."""
    if pose is None:
        return points
    return np.asarray(points @ pose.rotation.T + pose.translation)


def _cuts(
    length: float, piece: float, dashes: tuple[float, float] | None
) -> list[tuple[float, float]]:
    """Start and end of each piece along a line."""
    if dashes is None:
        ends = np.linspace(0.0, length, max(1, int(np.ceil(length / piece))) + 1).tolist()
        return list(pairwise(ends))
    drawn, left_out = dashes
    starts = np.arange(0.0, length, drawn + left_out).tolist()
    cuts = []
    for start in starts:
        part = min(start + drawn, length) - start
        cuts += [(start + a, start + b) for a, b in _cuts(part, piece, None)]
    return cuts
