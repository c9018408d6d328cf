"""The law of constructors: what they make holds together and answers; what not is refused."""

from __future__ import annotations

import copy
import json
from random import Random
from typing import Any

import numpy as np
from numpy.typing import NDArray

import standoff as so
from fuzz.laws import Broken, refusals
from fuzz.mutation import mutated
from fuzz.programs import BadProgram, make
from standoff.checks.numbers import GREATEST
from standoff.geometry import Curve, Surface
from standoff.motion import Path, Pose

Array = NDArray[np.float64]
WAYS = np.array([[1.0, 0.2, 0.1], [-0.3, 1.0, -0.4], [0.2, -0.5, 1.0], [-0.6, -0.5, -0.7]])
FAR = (0.6, 1.0, 30.0)
"""Distances of the asked points from the body's middle, in its sizes: in, near, and far away."""
ROUNDOFF = 1e-9
"""Part of the size and the distance by which an answer may be beyond an independent bound."""


def geometry_input(seeds: list[bytes], random: Random) -> bytes:
    """Return a mutated program."""
    try:
        tree, other = (json.loads(random.choice(seeds)) for _ in range(2))
    except ValueError:  # cut off to a greatest length, or empty
        return b"{}"
    return json.dumps(mutated([tree], random, [other])[:1]).encode()


def check_geometry(content: bytes) -> str:
    """Make what a program says, and try it.

    Raises
    ------
    Broken
        The law of constructors does not hold.
    """
    try:
        tree = json.loads(content)
    except ValueError:
        return "no program"
    tree = tree[0] if isinstance(tree, list) and tree else tree
    kept = copy.deepcopy(tree)
    made: Any = None
    with refusals((ValueError, TypeError, ImportError)) as refused:
        try:
            made = make(tree)
        except (BadProgram, RecursionError):
            return "no program"
    if json.dumps(kept) != json.dumps(tree):
        raise Broken("the arguments were changed")
    if refused:
        return "refused"
    if isinstance(made, so.Body):
        return check_body(made)
    if isinstance(made, Curve | Surface):
        return check_part(made)
    if isinstance(made, Pose):
        return check_pose(made)
    if isinstance(made, Path) and callable(getattr(made, "pose", None)):
        return check_path(made)
    return "no geometry"


def check_pose(pose: Pose) -> str:
    """A pose is a finite rotation and a finite shift."""
    if not np.isfinite(pose.matrix).all():
        raise Broken(f"a pose that is not finite: {pose.matrix}")
    if np.abs(pose.rotation.T @ pose.rotation - np.eye(3)).max() > 1e-8:
        raise Broken(f"a pose that is not a rotation: {pose.rotation}")
    return "pose"


def check_path(path: Path) -> str:
    """A path gives poses, or refuses the time."""
    last = path.end if np.isfinite(path.end) else path.start + 1.0 if path.start > -1e300 else 1.0
    for t in (0.0, 1.0, path.start, last, 0.5 * (max(path.start, -1e9) + min(last, 1e9))):
        if not np.isfinite(t):
            continue
        with refusals((ValueError,)) as refused:
            pose, twist = path.pose(t), path.twist(t)
        if not refused:
            check_pose(pose)
            if not np.isfinite([*twist.v, *twist.omega]).all():
                raise Broken(f"a twist that is not finite at {t}: {twist}")
    return "path"


def check_part(part: Curve | Surface) -> str:
    """A curve or patch has finite points over its range."""
    if isinstance(part, Curve):
        with refusals(()):
            spots = [part.jet(t)[0] for t in np.linspace(part.first, part.last, 5)]
        word = "curve"
    else:
        u0, u1, v0, v1 = np.clip(part.domain, -3.0, 3.0)
        with refusals(()):
            spots = [part.jet(u, v)[0] for u in (u0, 0.3 * u0 + 0.7 * u1, u1) for v in (v0, v1)]
        word = "surface"
    if not np.isfinite(spots).all():
        raise Broken(f"a {word} whose points are not finite: {spots}")
    return word


def check_body(body: so.Body) -> str:
    """A body's report is of numbers, and points find their distance to it."""
    report = body.check()
    numbers = [report.convexity_defect, report.slack, report.sewing_residual]
    if not (np.isfinite(numbers).all() and min(numbers) >= 0.0) or not body.size >= 0.0:
        raise Broken(f"a report that is none: {report!r}, size {body.size}")
    with refusals(()):
        str(report), repr(body), body.digest
        spots = _boundary(body)
        for way in WAYS:
            for far in FAR:
                _ask(body, spots, way, far)
    return "body"


def _boundary(body: so.Body) -> Array:
    """Points of the body: vertices and points of edges."""
    spots = [np.asarray(p) for p in body.vertex_points]
    for edge in body.edge_parts:
        curve = edge.curve
        spots += [curve.point(t) for t in np.linspace(curve.first, curve.last, 5)]
    return np.array(spots).reshape(-1, 3)


def _ask(body: so.Body, spots: Array, way: Array, far: float) -> None:
    planar = body.dimension == 2
    size = body.size if np.isfinite(body.size) and body.size > 0.0 else 1.0
    middle = 0.5 * (spots.min(axis=0) + spots.max(axis=0)) if len(spots) else np.zeros(3)
    x = middle + far * size * way / np.linalg.norm(way)
    if planar:
        x[2] = 0.0
    if np.abs(x).max() > GREATEST:
        return
    answer = so.distance(body, so.shapes.point(), np.eye(4), Pose(np.eye(3), x))
    if answer.status is so.Status.OVERLAPPING:
        return
    allowed = ROUNDOFF * (size + float(np.linalg.norm(x)))
    given = f"{answer!r} at {x.tolist()}"
    if not np.isfinite([answer.distance, answer.lower_bound, *answer.point_a]).all():
        raise Broken(f"an answer that is not finite: {given}")
    if answer.lower_bound > answer.distance + allowed:
        raise Broken(f"a lower bound above the distance: {given}")
    if len(spots):
        nearest = float(np.linalg.norm(spots - x, axis=1).min()) - body.radius
        if answer.lower_bound > nearest + allowed:
            raise Broken(f"a lower bound above the distance {nearest} of a point: {given}")
        if answer.certified and answer.distance > nearest + allowed:
            raise Broken(f"a certified distance above that of a point, {nearest}: {given}")
