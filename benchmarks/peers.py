"""Other packages' answers for a pair of ellipsoids, in Standoff's conventions.

Both packages are imported only when used (``pip install standoff[peers]``). World frame, poses
``(R, p)``, semi-axes; ``normal`` is the unit vector from A to B.

Sources: Coal 3 (``coal.DistanceRequest``, GJK on support functions); MuJoCo 4
(``mj_geomDistance``, its own convex collision with ``opt.ccd_tolerance``).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Pose = tuple[Array, Array]
Query = Callable[[Pose, Pose], "PeerAnswer"]

COAL_TIGHTEST = 1e-12
"""Relative GJK tolerance (no unit) of the tight query. Measured on exact ellipsoid pairs, axes
ratios to 10: a tighter one leaves the worst witness errors as they are and makes the worst
distances less accurate; a looser one makes the witnesses less accurate."""
COAL_ITERATIONS = 10_000
"""GJK iterations of the tight query, so that the tolerance decides. EPA, which only penetration
uses, keeps its defaults: tightened alike, it fails on two spheres and reports -1.8e308."""
MUJOCO_TOLERANCE = 1e-14
"""``opt.ccd_tolerance`` (length) of the tight query. Measured as above: 1e-10 to 1e-16 give the
same errors."""
MUJOCO_ITERATIONS = 1000
"""``opt.ccd_iterations`` of the tight query, so that the tolerance decides."""
MUJOCO_FARTHEST = 1e6
"""Distance (length) up to which MuJoCo is asked for an answer at all."""


@dataclass(frozen=True)
class PeerAnswer:
    """A peer's signed distance, witness points (3,) and unit normal (3,) from A to B, in world."""

    distance: float
    point_a: Array
    point_b: Array
    normal: Array


def _require(name: str) -> Any:
    """Import a peer, or say how to get it."""
    import importlib

    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ImportError(
            f"{name} is not installed; get it with: pip install 'standoff[peers]'"
        ) from error


def _direction(point_a: Array, point_b: Array) -> Array:
    """Return the unit vector between two witness points, NaN if they coincide."""
    step = point_b - point_a
    length = float(np.linalg.norm(step))
    return step / length if length > 0 else np.full(3, np.nan)


def coal_request(tight: bool = False) -> Any:
    """Return Coal's distance request: its defaults, or the tightest that pays."""
    coal = _require("coal")
    request = coal.DistanceRequest()
    if tight:
        request.gjk_tolerance = COAL_TIGHTEST
        request.gjk_max_iterations = COAL_ITERATIONS
    return request


def coal_ellipsoids(semi_axes_a: Array, semi_axes_b: Array, tight: bool = False) -> Query:
    """Return a query of Coal for two ellipsoids.

    Parameters
    ----------
    semi_axes_a, semi_axes_b
        Semi-axes (3,) of the ellipsoids.
    tight
        The tightest tolerance that pays in place of Coal's defaults (1e-6).

    Returns
    -------
    query
        ``query(pose_a, pose_b)``; ``normal`` is the one Coal reports.

    Raises
    ------
    ImportError
        Coal is not installed.
    """
    coal = _require("coal")
    shape_a = coal.Ellipsoid(*map(float, semi_axes_a))
    shape_b = coal.Ellipsoid(*map(float, semi_axes_b))
    request, result = coal_request(tight), coal.DistanceResult()

    def query(pose_a: Pose, pose_b: Pose) -> PeerAnswer:
        result.clear()
        place_a, place_b = coal.Transform3s(*pose_a), coal.Transform3s(*pose_b)
        distance = coal.distance(shape_a, place_a, shape_b, place_b, request, result)
        return PeerAnswer(
            float(distance),
            np.array(result.getNearestPoint1()),
            np.array(result.getNearestPoint2()),
            np.array(result.normal),
        )

    return query


def mujoco_ellipsoids(semi_axes_a: Array, semi_axes_b: Array, tight: bool = True) -> Query:
    """Return a query of MuJoCo for two ellipsoids.

    Parameters
    ----------
    semi_axes_a, semi_axes_b
        Semi-axes (3,) of the ellipsoids.
    tight
        The tightest tolerance that pays in place of MuJoCo's defaults (1e-6).

    Returns
    -------
    query
        ``query(pose_a, pose_b)``. MuJoCo reports no normal: it is the direction between the
        witness points.

    Raises
    ------
    ImportError
        MuJoCo is not installed.
    """
    mujoco = _require("mujoco")
    sizes = [" ".join(repr(float(v)) for v in axes) for axes in (semi_axes_a, semi_axes_b)]
    geoms = "".join(f'<body><geom type="ellipsoid" size="{size}"/></body>' for size in sizes)
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{geoms}</worldbody></mujoco>")
    # The text form may round; what is measured must be the same ellipsoids.
    model.geom_size[:] = np.stack([semi_axes_a, semi_axes_b])
    if tight:
        model.opt.ccd_tolerance = MUJOCO_TOLERANCE
        model.opt.ccd_iterations = MUJOCO_ITERATIONS
    data = mujoco.MjData(model)
    segment = np.zeros(6)

    def query(pose_a: Pose, pose_b: Pose) -> PeerAnswer:
        for index, (rotation, position) in enumerate((pose_a, pose_b)):
            data.geom_xmat[index] = np.asarray(rotation).ravel()
            data.geom_xpos[index] = position
        distance = mujoco.mj_geomDistance(model, data, 0, 1, MUJOCO_FARTHEST, segment)
        point_a, point_b = segment[:3].copy(), segment[3:].copy()
        normal = _direction(point_a, point_b)
        return PeerAnswer(float(distance), point_a, point_b, -normal if distance < 0 else normal)

    return query


PEERS: dict[str, Callable[[Array, Array], Query]] = {
    "Coal, default": lambda a, b: coal_ellipsoids(a, b),
    "Coal, tight": lambda a, b: coal_ellipsoids(a, b, tight=True),
    "MuJoCo, default": lambda a, b: mujoco_ellipsoids(a, b, tight=False),
    "MuJoCo, tight": lambda a, b: mujoco_ellipsoids(a, b),
}
"""Name of each peer and setting: a function of both semi-axes that returns a query."""
