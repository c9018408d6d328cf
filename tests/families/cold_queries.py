"""Cold queries of a family, judged by support functions and by what is known of the poses.

A distance between two points of the bodies is an upper bound of the true one, the separation
along any direction a lower one: where they meet, the distance is proven. Nothing of the library
takes part in the proof.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

import standoff as so
from families.pairs import Instance, draw
from families.shapes import Twin
from families.starts import random_start
from oracles.bounds import separation
from oracles.loops import PlanarLoop
from oracles.membership import outside
from oracles.poses import DrawnPose, size_of
from standoff_studies.oracles import HalfSpace, Shape

Array = NDArray[np.float64]

PER_INSTANCE = 60
"""Poses of one pair of bodies."""
GAP = 1e-9
"""Greatest gap between a distance and the independent bound, over the pair's size."""
ROUNDINGS = 32.0
"""Roundings, in eps of the span (the pair's size plus the largest coordinate and the distance),
by which a computed bound may be on the wrong side of the truth."""
OUTSIDE = 1e-11
"""How far outside its body a witness point may lie, over the pair's size: trimming and joining
are exact, so only roundoff of thin bodies is left."""
EPS = float(np.finfo(float).eps)


@dataclass
class Report:
    """What a family's queries found. Gaps are relative to the pair's size."""

    name: str
    how: str
    certificate: list[float] = field(default_factory=list)
    independent: list[float] = field(default_factory=list)
    restarts: list[int] = field(default_factory=list)
    evaluations: list[int] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)


def separations(a: Shape, b: Shape, poses: list[DrawnPose], normals: Array) -> Array:
    """Return the separation of each pose along its normal: (k,) for normals (k, 3)."""
    if isinstance(a, HalfSpace) or isinstance(b, HalfSpace):
        return np.array([separation(p.a, p.b, n) for p, n in zip(poses, normals, strict=True)])
    n = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    in_a = np.einsum("kji,kj->ki", np.array([p.a.rotation for p in poses]), n)
    in_b = np.einsum("kji,kj->ki", np.array([p.b.rotation for p in poses]), n)
    between = np.array([p.b.position - p.a.position for p in poses])
    along = np.einsum("ki,ki->k", n, between)
    return np.asarray(along - a.support_many(in_a)[0] - b.support_many(-in_b)[0])


def witness_outside(
    twin: Twin, local: Array, feature: so.Feature, parameters: tuple[float, ...]
) -> float:
    """Return how far a witness point, body frame, lies off its body."""
    if not isinstance(twin.shape, PlanarLoop):
        return outside(twin.shape, local)
    t = parameters[0] if feature.kind == "edge" else 0.0
    on_curve = twin.shape.curves[feature.index].jet(np.array([t]))[0][0]
    beyond = max(-t, t - 1.0, 0.0)
    return float(np.hypot(*(local[:2] - on_curve))) + abs(float(local[2])) + beyond


def faults(
    instance: Instance, pose: DrawnPose, answer: so.Proximity, lowest: float, size: float
) -> list[str]:
    """Return what is wrong with an answer; ``lowest`` is the separation along its normal."""
    if answer.status is not so.Status.CONVERGED:
        return [f"status {answer.status.name}, {pose.kind} distance {pose.distance}"]
    d, low = answer.distance, answer.lower_bound
    reach = max(np.abs(pose.a.position).max(), np.abs(pose.b.position).max())
    noise = ROUNDINGS * EPS * (size + d + reach)
    found = []
    if not -noise <= d - lowest <= GAP * size:
        found.append(f"distance {d!r} against the independent bound {lowest!r}")
    if not low <= d:
        found.append(f"lower bound {low!r} above the distance {d!r}")
    # Swept points follow the certificate's normal, which may turn within the certificate's gap.
    if not abs(np.linalg.norm(answer.point_b - answer.point_a) - d) <= noise + d - low:
        found.append(f"witness points are not {d!r} apart")
    if pose.distance is not None and not low - noise <= pose.distance <= d + noise:
        found.append(f"exact {pose.distance!r} outside [{low!r}, {d!r}]")
    sides = (
        (instance.a, pose.a, answer.point_a, answer.feature_a, answer.parameters_a),
        (instance.b, pose.b, answer.point_b, answer.feature_b, answer.parameters_b),
    )
    for twin, placed, point, feature, parameters in sides:
        off = witness_outside(twin, placed.local(point), feature, parameters)
        if not off <= OUTSIDE * size + noise:
            found.append(f"witness {off:.2g} outside {twin.body.name}, on {feature}")
    return found


def judge(report: Report, instance: Instance, answers: list[so.Proximity]) -> None:
    """Add the answers to the instance's poses to a report."""
    a, b = instance.a.shape, instance.b.shape
    size = size_of(a, b)
    normals = np.array([answer.normal for answer in answers])
    lowest = separations(a, b, instance.poses, normals)
    rows = zip(instance.poses, answers, lowest, strict=True)
    for number, (pose, answer, bound) in enumerate(rows):
        found = faults(instance, pose, answer, float(bound), size)
        if found:
            where = f"{instance.label}.poses[{number}] ({pose.kind}), {report.how}"
            report.failures.append(f"{where}: {'; '.join(found)}; {answer!r}")
            continue
        report.certificate.append((answer.distance - answer.lower_bound) / size)
        report.independent.append((answer.distance - float(bound)) / size)
        report.restarts.append(answer.counts.restarts)
        report.evaluations.append(answer.counts.evaluations)


def run_family(name: str, count: int, seed: int) -> tuple[Report, Report]:
    """Judge ``count`` cold queries of a family, and as many from random features and parameters.

    Both answer for the same poses, ``count`` rounded up to whole instances.
    """
    cold, given = Report(name, "cold"), Report(name, "start_from")
    for number in range(-(-count // PER_INSTANCE)):
        instance = draw(name, seed, number, PER_INSTANCE)
        a, b = instance.a.body, instance.b.body
        judge(cold, instance, [so.distance(a, b, p.pose_a, p.pose_b) for p in instance.poses])
        rng = np.random.default_rng([seed, number, 1])
        tracker = so.Tracker(a, b)
        starts = [(random_start(a, rng), random_start(b, rng)) for _ in instance.poses]
        answers = [
            tracker.start_from(p.pose_a, p.pose_b, first, second).proximity
            for p, (first, second) in zip(instance.poses, starts, strict=True)
        ]
        judge(given, instance, answers)
    return cold, given
