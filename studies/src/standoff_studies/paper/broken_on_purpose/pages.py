"""What the promises quote of pages: is it so? What their code prints, and what their words say.

A page's Python blocks run as they stand. Words that no block prints have a check here, which
measures whether they are true. What a change needs to turn is a constant of this module.
"""

from __future__ import annotations

import io
import os
import re
import sys
import tempfile
from collections.abc import Callable, Iterable
from contextlib import chdir, redirect_stdout
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

import standoff as so
from standoff import simulation as sim
from standoff.automaton.graph import automaton
from standoff.automaton.text import automaton_text
from standoff.devices import Trace
from standoff.geometry import ellipsoid_patches
from standoff.kernels.pair import system
from standoff.motion import Pose
from standoff.servo import Servo
from standoff.solids import SolidTracker
from standoff.typing import Array
from standoff_studies.paper.bodies import lens_of_patches
from standoff_studies.paper.furthest import place_at
from standoff_studies.paper.nonconvex_scene import BALLS, chain, truth

DOCS = Path(__file__).resolve().parents[5] / "docs"
"""The pages; they are in a checkout only."""
FENCE = re.compile(r"^```(\w*|\{[^\n]*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
EDITS: dict[str, str] = {}
"""What is replaced in a page's code, by what."""
HOME = Pose.identity()
SAME = 1e-12
"""Lengths that differ by less are equal [length]: roundoff."""


def holds(page: str, words: str) -> bool:
    """Is what a row quotes of a page so? `page` is its path from the pages of the paper."""
    checks = [check for part, check in CHECKS.items() if part in words]
    return checks[0]() if checks else printed(page, words)


def printed(page: str, words: str) -> bool:
    """Does a page's code print these words?"""
    path = (DOCS / "paper" / page).resolve()
    if not path.exists():
        raise FileNotFoundError(f"{path} is missing: the pages are in a checkout, run it from one.")
    names: dict[str, Any] = {}
    with tempfile.TemporaryDirectory() as folder, chdir(folder):
        os.symlink(DOCS.parent / "examples", "examples")
        blocks = FENCE.findall(path.read_text("utf-8"))
        for (language, code), (_, promised) in pairwise([*blocks, ("", "")]):
            if language != "python":
                continue
            for old, new in EDITS.items():
                code = code.replace(old, new)
            told = io.StringIO()
            with redirect_stdout(told):
                exec(compile(code, path.name, "exec"), names)
            if words in " ".join(promised.split()):
                return words in " ".join(told.getvalue().split())
    raise LookupError(f'no block of {path.name} prints "{words}"')


class Asking(so.Tracker):
    """A tracker that asks Voronoi regions, which it computes, for the feature of each frame."""

    def step(self, *given: Any, **options: Any) -> Any:
        """Step, and ask."""
        found = super().step(*given, **options)
        so.voronoi_regions(self.a, reach=1.0).feature_at(found[1].point_b)
        return found


def no_region_is_built() -> bool:
    """Is no code of the Voronoi regions run while a point is tracked over an edge of a lens?"""
    seen: list[str] = []

    def watch(frame: Any, event: str, _: Any) -> None:
        name = str(frame.f_globals.get("__name__", ""))
        if event == "call" and "voronoi" in name:
            seen.append(name)

    tracker, switches = so.Tracker(so.shapes.lens(1.0, 0.45), so.shapes.point(), 1e-2), 0
    angles = np.arange(0.0, 1.4, 0.1)
    poses = [Pose(np.eye(3), (1.5 * np.cos(t), 1.5 * np.sin(t), 0.2)) for t in angles]
    state = tracker.start(HOME, poses[0])
    sys.setprofile(watch)
    try:
        for pose in poses[1:]:
            state, answer = tracker.step(state, HOME, pose)
            switches += len(answer.events)
    finally:
        sys.setprofile(None)
    return switches > 0 and not seen


def ellipsoid_is_one_face() -> bool:
    """Does an ellipsoid have one face, and nothing to switch?"""
    pair = so.shapes.ellipsoid(0.15, 0.3, 0.2), so.shapes.lens(1.0, 0.45)
    return "(ellipsoid): 1 face, no switches" in automaton_text(automaton(*pair), ("ellipsoid", ""))


def hull_of(surfaces: Iterable[Any], at: Array) -> so.Body:
    """Return the hull of points on patches, at these parameters along both sides."""
    return so.Body.from_points(np.array([x.jet(u, v)[0] for x in surfaces for u in at for v in at]))


def hulls(lens: so.Body, axes: Array) -> tuple[so.Body, so.Body]:
    """Return hulls of a lens of patches and of an ellipsoid."""
    at = np.linspace(0.0, 1.0, 13)
    return hull_of([face.charts[0] for face in lens.face_parts], at), hull_of(
        ellipsoid_patches(*axes), at
    )


FELT = hulls
"""The bodies that are felt in place of a lens and an ellipsoid."""


def facets_are_felt() -> bool:
    """Does the force on a tool jump, on hulls of both bodies, by more than its motion explains?

    The tool is led over a face of the exact lens at a constant depth; f = k d^1.5, and the normal
    turns by at most the way over the tool's least radius of curvature, less the depth.
    """
    lens, axes, depth = lens_of_patches(), np.array([0.3, 0.25, 0.2]), 0.05
    felt, point = FELT(lens, axes), so.shapes.point()
    forces, places = [], []
    for angle in np.linspace(-0.08, 0.08, 81):
        far = Pose(np.eye(3), (3.0 * np.cos(angle), 3.0 * np.sin(angle), 0.4))
        foot = so.distance(lens, point, HOME, far)
        n = foot.normal
        places.append(foot.point_a + axes**2 * n / np.linalg.norm(axes * n) - depth * n)
        found = so.distance(*felt, HOME, Pose(np.eye(3), places[-1]))
        forces.append(max(0.0, -found.distance) ** 1.5 * found.normal)
    steps = np.linalg.norm(np.diff(forces, axis=0), axis=1)
    way = np.linalg.norm(np.diff(places, axis=0), axis=1)
    explained = depth**1.5 * way / (axes.min() ** 2 / axes.max() - depth)
    return bool((steps > 2.0 * explained).any())


def exact(lens: so.Body, axes: Array) -> tuple[so.Body, so.Body]:
    """Return the bodies themselves."""
    return lens, so.shapes.ellipsoid(*axes)


TILT = 0.0
"""By how much one of two boxes that face each other is turned [rad]."""


def points_are_not_unique() -> bool:
    """Are two places of a box's face as far from another box as the box itself?"""
    box, point = so.shapes.box(1.0, 1.0, 1.0), so.shapes.point()
    pose = Pose.exp((TILT, 0.0, 0.0), (0.0, 0.0, 1.6))
    least = so.distance(box, box, HOME, pose).distance
    at = (Pose(np.eye(3), (0.0, y, 0.5)) for y in (-0.3, 0.2))
    return all(so.distance(point, box, each, pose).distance - least < SAME for each in at)


def one_newton_step() -> bool:
    """Is a step by Euler's method with K h = 1, at rest, −H⁻¹g?"""
    a, b = so.shapes.ellipsoid(1.0, 0.7, 0.5), so.shapes.ellipsoid(0.4, 0.9, 0.6)
    pose, off = Pose.exp((0.4, -0.1, 0.2), (2.5, 0.3, 0.2)), np.array([0.01, -0.01, 0.0])
    found = so.distance(a, b, HOME, pose)
    places: Any = [(on, tuple(at + off)) for on, at in (found.place_a, found.place_b)]
    law = so.PaperLaw(integrator="euler", gain=1e3, solve="plain", switching="none", restarts=False)
    tracker = so.Tracker(a, b, 1e-3, law=law)
    _, answer = tracker.step(tracker.start_from(HOME, pose, *places), HOME, pose)
    now = so.tracking.pair_system(a, b, HOME, pose, *places)
    q, ended = (
        np.array([x for _, at in each for x in at[:2]])
        for each in (places, (answer.place_a, answer.place_b))
    )
    return bool(np.abs(ended - (q - np.linalg.solve(now.H, now.g))).max() < SAME)


def singular_where_flat() -> bool:
    """Is H singular where both bodies are flat along a common tangent, and definite elsewhere?"""
    bodies = (
        so.shapes.ellipsoid(0.5, 0.5, 0.5),
        so.shapes.cylinder(0.5, 1.0),
        so.shapes.box(1.0, 1.0, 1.0),
    )
    flat = (), ("z",), ("y", "z")
    right = []
    for i, a in enumerate(bodies):
        for j, b in enumerate(bodies):
            for turned in (False, True):  # about x: z of B becomes y
                pose = Pose.exp((0.5 * np.pi * turned, 0.0, 0.0), (1.7, 0.0, 0.0))
                own = {"zy"["yz".index(axis)] if turned else axis for axis in flat[j]}
                x = np.array([1.0, 0.0, 0.0])
                places = place_at(a, HOME, 0.5 * x, x), place_at(b, pose, 1.2 * x, -x)
                least = np.linalg.eigvalsh(so.tracking.pair_system(a, b, HOME, pose, *places).H)[0]
                right.append((least < 1e-9) == bool(own & {*flat[i]}))
    return all(right)


def one_size_of_system() -> bool:
    """Is the system of four parameters, with those that are missing held, that of each mode?"""
    lens, pose, right = so.shapes.lens(1.0, 0.45), Pose.exp((0.1, 0.2, 0.3), (3.0, 0.2, 0.5)), []
    for a in KINDS:
        for b in KINDS:
            jets, places = zip(jet_of(lens, a, HOME), jet_of(lens, b, pose), strict=True)
            form = np.zeros((4, 4))
            form[np.triu_indices(4)] = system.hessian(*jets)
            form = form + np.triu(form, 1).T
            g = np.array(system.gradient(system.projection_errors(*jets)))
            now = so.tracking.pair_system(lens, lens, HOME, pose, *places)
            own = np.r_[: KINDS[a], 2 : 2 + KINDS[b]]
            due = np.zeros(4)
            due[own] = np.linalg.lstsq(now.H, now.g)[0]
            found = np.linalg.lstsq(form, g)[0] if np.linalg.matrix_rank(form) == 4 else np.nan
            right.append(np.abs(found - due).max() < SAME)
    return all(right)


KINDS = {"face": 2, "edge": 1, "vertex": 0}
"""Parameters of each kind of feature."""


def jet_of(body: so.Body, kind: str, pose: Pose) -> tuple[Any, Any]:
    """Return the jet of the first feature of a kind, with zeros for what it lacks; and a place."""
    none, turn = np.zeros(3), pose.rotation
    if kind == "face":
        x, *partials = body.face_parts[0].charts[0].jet(0.1, -0.2)
        at: tuple[float, ...] = (0.1, -0.2)
    elif kind == "edge":
        x, tangent, bend = body.edge_parts[0].curve.jet(0.2)
        at, partials = (0.2,), [tangent, none, bend, none, none]
    else:
        x, at, partials = body.vertex_points[0], (), [none] * 5
    jet = (tuple(pose.apply(x)), *(tuple(turn @ partial) for partial in partials))
    return jet, ((kind, 0), at)


DEPTH = "global"
"""The depth that a law tracks."""


def depth_is_the_smallest() -> bool:
    """Does a tracker tell the least depth, where another face has come to be the nearest?"""
    boxes = so.shapes.box(1.0, 1.0, 1.0), so.shapes.box(0.4, 0.3, 0.35)
    tracker = so.Tracker(*boxes, law=so.PredictorCorrector(depth=DEPTH))
    poses = [Pose.exp((0.1, 0.2, 0.05), (x, 0.03, 0.02)) for x in np.linspace(0.2, -0.2, 101)]
    state = tracker.start(HOME, poses[0])
    for pose in poses[1:]:
        state, answer = tracker.step(state, HOME, pose)
    return bool(abs(answer.distance - so.distance(*boxes, HOME, poses[-1]).distance) < 1e-9)


STEPS = 1
"""Steps of the operator in a tick."""


def ticks_keep_up() -> bool:
    """Does a tick of a servo loop take less than its millisecond, in the median?"""
    period = 1e-3
    sampling = sim.Sampling(period=period, device_damping=1.0)
    joined = sim.VirtualCoupler(
        stiffness=800.0, damping=0.5, max_force=20.0, max_age=0.01, sampling=sampling
    )
    contact = sim.HuntCrossley(stiffness=3e5, damping=4.0, depth=5e-4)

    def hand(t: float) -> Pose:
        return Pose(np.eye(3), (0.0475 * np.cos(t), 0.001, 0.0475 * np.sin(t)))

    parts = [
        sim.RigidBody.fixed(so.shapes.lens(0.05, 0.0225)),
        sim.RigidBody.free(so.shapes.sphere(0.01), mass=0.2, pose=hand(0.0)),
    ]
    scene = sim.System(parts, contact, gravity=[0, 0, 0], coupler=joined, tool=1)
    servo = Servo(sim.Operator(scene, period / STEPS), device=Trace(hand, 0.0, 0.3), seconds=0.3)
    servo.start()
    servo.wait(10.0)
    found = servo.stop().statistics
    return found.work.median < period


LATE = 0
"""Frames by which the solids have moved since the bounds were proven."""


def bounds_are_true() -> bool:
    """Are the bounds of a front that may look at little in a frame true, and loose?"""
    found = tracked_chains(deadline=1000)
    low, due = found.lower_bound, truth().distance[EVERY::EVERY][: len(found)]
    true = low[: len(due) - LATE] <= due[LATE:]
    return bool(true.all() and (found.upper_bound - low).max() > 1e-2)


EVERY, FRAMES = 10, 40
"""Every such frame of the two chains is asked, and how many of these."""
REACH = 5.0
"""Minima are asked up to this distance, beyond all there are [length]."""


def tracked_chains(**options: Any) -> Any:
    """Return the answers along the motion of two chains of balls."""
    a, b = (chain(balls) for balls in BALLS)
    tracker = SolidTracker(a, b, **options)
    poses = truth().poses[::EVERY][: FRAMES + 1]
    state = tracker.start(HOME, poses[0])
    return tracker.run(state, HOME, poses[1:])[1]


def every_minimum_is_told() -> bool:
    """Are as many minima told as there are, of two chains of balls?"""
    found = tracked_chains(minima=REACH)
    told = np.bincount(found.minima.frame, minlength=len(found))
    return bool((told == truth().alive[EVERY::EVERY].sum(axis=1)[: len(found)]).all())


CHECKS: dict[str, Callable[[], bool]] = {
    "are never built": no_region_is_built,
    "1 face, no switches": ellipsoid_is_one_face,
    "it jumps by up to": facets_are_felt,
    "they are not unique": points_are_not_unique,
    "that is one Newton step": one_newton_step,
    "flat along a common tangent": singular_where_flat,
    "nine kinds of modes": one_size_of_system,
    "the depth is the smallest": depth_is_the_smallest,
    "deadlines were missed": ticks_keep_up,
    "bounds are true": bounds_are_true,
    "in each that may hold a local minimum": every_minimum_is_told,
}
"""By words of what is quoted."""
