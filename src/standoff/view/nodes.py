"""Bodies and answers as nodes of viser's scene."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy
import trimesh

from standoff.bodies.features import Feature
from standoff.motion import Pose
from standoff.typing import Array
from standoff.view.shapes import ShownShape, ShownTriangles

Colour = tuple[int, int, int]

# Light and strong, after Okabe and Ito's blue and vermilion; stronger than in the pictures of
# `so.plot`, as the light of a browser's scene pales them.
COLOURS: tuple[tuple[Colour, Colour], ...] = (
    ((110, 185, 235), (0, 80, 160)),
    ((240, 170, 90), (200, 70, 0)),
)
EDGE_COLOUR: Colour = (60, 60, 60)
WITNESS_COLOUR: Colour = (20, 20, 20)
BOUND_COLOUR: Colour = (0, 158, 115)
FORCE_COLOUR: Colour = (204, 121, 167)

OPACITY, ACTIVE_OPACITY = 0.85, 0.9
"""Of a body's surface, and of its active face: edges behind it are seen through it."""

GLASS, ACTIVE_GLASS = 0.22, 0.35
"""The same where bodies overlap: the other body and the witness points inside it are seen."""

POINT_SIZE = 0.012
"""Diameter of a drawn vertex over the body's size."""

WITNESS_RADIUS = 0.006
"""Of the balls at the witness points, over the scene's size."""

DOT_RADIUS, DOTS = 0.003, 15
"""Radius of the dots between them, over the scene's size, and their number."""

ARROW = 0.2
"""Length of the drawn normal over the scene's size."""


def quaternion(pose: Pose) -> tuple[float, float, float, float]:
    """Return a pose's rotation as viser has it, scalar first."""
    x, y, z, w = scipy.spatial.transform.Rotation.from_matrix(pose.rotation).as_quat()
    return float(w), float(x), float(y), float(z)


class BodyNodes:
    """The nodes of one body: surface, edges, vertices, and its active feature.

    Parameters
    ----------
    scene : viser.SceneApi
    name : str
        Of the node that all others hang from.
    shape : ShownShape
    colours : (Colour, Colour)
        Light and strong.
    corners : bool
        Whether vertices are drawn.
    """

    def __init__(
        self,
        scene: Any,
        name: str,
        shape: ShownShape,
        colours: tuple[Colour, Colour],
        *,
        corners: bool = True,
    ) -> None:
        self._scene, self.name, self._shape = scene, name, shape
        self._plain, self._strong = colours
        self._active: tuple[tuple[Feature, bool] | None, Any] = (None, None)
        self._glass = False
        self._clear: Any = None
        self.frame = scene.add_frame(name, show_axes=False)
        self._skin = None
        if shape.skin is not None:
            self._skin = self._mesh("skin", shape.skin, self._plain, OPACITY)
        if len(shape.drawn):
            self._lines("edges", shape.segments(), EDGE_COLOUR, 1.5)
        if corners and len(shape.vertices) and not shape.radius:
            self._points("vertices", shape.vertices, EDGE_COLOUR, 1.0)

    def place(self, pose: Pose) -> None:
        """Put the body at a pose."""
        self.frame.wxyz, self.frame.position = quaternion(pose), tuple(pose.translation)

    def glass(self, on: bool) -> None:
        """Become glass, or solid again."""
        if on == self._glass:
            return
        self._glass = on
        if self._skin is None or self._shape.skin is None:
            return
        if self._clear is None:
            self._clear = self._pane("glass", self._shape.skin, self._plain, GLASS)
        self._skin.visible, self._clear.visible = not on, on

    def highlight(self, feature: Feature, outward: Array) -> None:
        """Draw a feature in the strong colour.

        Parameters
        ----------
        feature : Feature
        outward : (3,) array
            Unit normal of the surface there, body frame: an edge or vertex of a swept body is
            shown on its skin.
        """
        known, node = self._active
        if (feature, self._glass) != known:
            if node is not None:
                node.remove()
            node = self._drawn(feature)
            self._active = (feature, self._glass), node
        if node is not None and feature.kind in ("edge", "vertex"):
            node.position = tuple(self._shape.radius * outward)

    def _drawn(self, feature: Feature) -> Any:
        part = self._shape.of(feature)
        if isinstance(part, ShownTriangles):
            if not len(part.points):
                return None
            if self._glass:
                return self._pane("active", part, self._strong, ACTIVE_GLASS)
            return self._mesh("active", part, self._strong, ACTIVE_OPACITY)
        if feature.kind == "edge":
            return self._lines("active", part, self._strong, 5.0)
        return self._points("active", part[None], self._strong, 2.0)

    def _mesh(self, name: str, mesh: ShownTriangles, colour: Colour, opacity: float) -> Any:
        return self._scene.add_mesh_simple(
            f"{self.name}/{name}",
            mesh.points,
            mesh.triangles,
            color=colour,
            opacity=opacity,
            side="double",
            cast_shadow=False,
            receive_shadow=False,
        )

    def _pane(self, name: str, mesh: ShownTriangles, colour: Colour, opacity: float) -> Any:
        # Viser's own meshes hide what is behind them, however clear they are: three.js draws them
        # into the buffer of depths. It does not for a material of glTF that blends.
        material = trimesh.visual.material.PBRMaterial(
            baseColorFactor=[*_linear(colour), opacity],
            metallicFactor=0.0,
            roughnessFactor=1.0,
            alphaMode="BLEND",
            doubleSided=True,
        )
        pane = trimesh.Trimesh(mesh.points, mesh.triangles, process=False)
        pane.visual = trimesh.visual.TextureVisuals(material=material)
        return self._scene.add_mesh_trimesh(
            f"{self.name}/{name}", pane, cast_shadow=False, receive_shadow=False
        )

    def _lines(self, name: str, pieces: Array, colour: Colour, width: float) -> Any:
        return self._scene.add_line_segments(
            f"{self.name}/{name}",
            pieces.astype(np.float32),
            colour,
            thickness=width,
            thickness_units="screen",
        )

    def _points(self, name: str, points: Array, colour: Colour, times: float) -> Any:
        return self._scene.add_point_cloud(
            f"{self.name}/{name}",
            points.astype(np.float32),
            colour,
            point_size=times * POINT_SIZE * self._shape.size,
            point_shape="circle",
            precision="float32",
        )


class AnswerNodes:
    """The nodes of an answer: witness points and line, normal, distance and lower bound.

    Parameters
    ----------
    scene : viser.SceneApi
    size : float
        Of the scene [length].
    """

    def __init__(self, scene: Any, size: float) -> None:
        scene.add_frame("/answer", show_axes=False)
        # Straight up; turned to where it belongs.
        upright = np.array([[[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]]], dtype=np.float32)
        self._points = [
            scene.add_icosphere(f"/answer/point_{which}", WITNESS_RADIUS * size, WITNESS_COLOUR)
            for which in "ab"
        ]
        # Dots, as viser moves nodes at once, while a line that grows comes some pictures later.
        self._line = [
            scene.add_icosphere(f"/answer/dot_{k}", DOT_RADIUS * size, WITNESS_COLOUR)
            for k in range(DOTS)
        ]
        self._normal = scene.add_arrows(
            "/answer/normal",
            ARROW * size * upright,
            BOUND_COLOUR,
            shaft_radius=0.015 * ARROW * size,
            head_radius=0.05 * ARROW * size,
            head_length=0.2 * ARROW * size,
        )
        # From B's witness point to A's: its length is set along its own axis.
        self._depth = scene.add_arrows(
            "/answer/depth",
            upright,
            WITNESS_COLOUR,
            shaft_radius=0.02 * ARROW * size,
            head_radius=0.07 * ARROW * size,
            head_length=0.25,
            visible=False,
        )
        self._force = scene.add_arrows(
            "/answer/force",
            2.0 * ARROW * size * upright,
            FORCE_COLOUR,
            shaft_radius=0.04 * ARROW * size,
            head_radius=0.1 * ARROW * size,
            head_length=0.3 * ARROW * size,
            visible=False,
        )
        self._label = scene.add_label("/answer/label", "", anchor="bottom-left")

    def pull(self, at: Array, force: Array, greatest: float) -> None:
        """Draw the coupler's force (3,) on a tool whose origin is `at` (3,) [N]."""
        size = float(np.linalg.norm(force))
        self._force.visible = size > 0.0
        if size > 0.0:
            self._force.position, self._force.wxyz = tuple(at), upright_to(force / size)
            self._force.scale = max(size / greatest, 0.02)

    def show(
        self, points: tuple[Array, Array], normal: Array, text: str, *, deep: bool = False
    ) -> None:
        """Draw an answer.

        Parameters
        ----------
        points : two (3,) arrays
            Witness points, world axes; nothing is drawn where they are not known.
        normal : (3,) array
            From A to B.
        text : str
            Stands beside the witness line.
        deep : bool
            The bodies overlap: in place of line and normal an arrow along the normal, as long as
            the move of B that separates them.
        """
        known = bool(np.isfinite([*points, normal]).all())
        for node in (*self._line, self._normal):
            node.visible = known and not deep
        for node in self._points:
            node.visible = known
        self._depth.visible = known and deep
        self._label.text = text
        if not known:
            return
        for node, point in zip(self._points, points, strict=True):
            node.position = tuple(point)
        if deep:
            depth = float(np.linalg.norm(points[0] - points[1]))
            self._depth.position, self._depth.wxyz = tuple(points[1]), upright_to(normal)
            self._depth.scale = (1.0, 1.0, depth)
        self._normal.position, self._normal.wxyz = tuple(points[0]), upright_to(normal)
        for node, share in zip(self._line, np.linspace(0.0, 1.0, DOTS + 2)[1:-1], strict=True):
            node.position = tuple((1.0 - share) * points[0] + share * points[1])
        self._label.position = tuple(points[1] if deep else 0.5 * (points[0] + points[1]))


def _linear(colour: Colour) -> list[float]:
    """A colour as glTF has it, in proportion to the light: near enough the power of 2.2."""
    return [float((part / 255.0) ** 2.2) for part in colour]


def upright_to(direction: Array) -> tuple[float, float, float, float]:
    """Return a rotation, scalar first, that takes the z axis to a unit vector (3,)."""
    x, y, z = direction.tolist()
    if z <= -1.0 + np.finfo(float).eps:
        return 0.0, 1.0, 0.0, 0.0
    w = np.sqrt(0.5 * (1.0 + z))
    return float(w), float(-0.5 * y / w), float(0.5 * x / w), 0.0
